//! The search for a setting: screening, evaluating, verifying.

use std::collections::VecDeque;

use super::candidate::Candidate;
use super::candidates::candidates;
use super::deviation::{Deviation, Figure};
use super::evidence::{Estimate, Evidence, Sample};
use super::{Choice, Cost, Task, Tried, Verified};
use crate::error::Result;
use crate::extent::ImageSize;
use crate::frame::{Layer, Wanted};
use crate::lab::measure::interleaved;
use crate::render::{Renderer, Rendering};
use crate::scene::{Picture, Scene};

/// Pictures of more pixels are screened in a smaller one of about as many.
const SCREENED_PIXELS: usize = 128 * 128;
/// Reference rays for evaluating, and again for verifying: a share of the pixels within limits.
const RAYS_SHARE: f64 = 0.05;
const RAYS: [usize; 2] = [4096, 16384];
/// Reference rays where the error of a chosen picture is largest.
const MAX_ERROR_RAYS: usize = 256;
/// How much a mean error in the small picture may exceed the bound, and the real one yet keep it.
const SCREEN_SLACK: f64 = 1.2;
/// Candidates up to this many times as slow as the fastest that keeps the bound are timed beside
/// it: times of small pictures are not those of large ones.
const ABOUT_AS_FAST: f64 = 1.4;
/// The most candidates that are timed together.
const TIMED_TOGETHER: usize = 5;
/// Times are taken for equal within this factor.
const EQUALLY_FAST: f64 = 1.05;
/// The multiple of the fastest's time, each timed once, beyond which a candidate is not timed again.
const MAYBE_FASTEST: f64 = 2.0;
/// Repeats in turn: as many as fit into so much time, within limits.
const REPEATS: [usize; 2] = [1, 7];
const TIMING_MS: f64 = 400.0;

/// The candidate that was chosen, its error as verified, and upon what it was verified.
struct Chosen {
    at: usize,
    met: bool,
    estimate: Estimate,
    verified: Verified,
}

/// Another place of the camera, and what is known there once it was visited.
struct View<'a> {
    /// The scene under the surest setting.
    scene: &'a Scene,
    evidence: Option<Evidence<'a>>,
}

impl<'a> View<'a> {
    fn unseen(scene: &'a Scene) -> Self {
        Self {
            scene,
            evidence: None,
        }
    }
}

/// The pictures by which a choice is verified.
struct Verifying<'v, 'e> {
    evidence: &'v mut Evidence<'e>,
    views: &'v mut [View<'e>],
    rays: usize,
}

/// The candidates that may yet be evaluated in the real picture.
struct Waiting {
    /// The fastest first, by their times in the small picture.
    queue: VecDeque<usize>,
    /// The size of the small picture.
    size: ImageSize,
    /// The time beyond which a candidate is no better than the surest in this picture, ms.
    slowest_ms: f64,
}

pub struct Search<'s, 'a> {
    task: &'s Task<'s>,
    deviation: Deviation,
    renderer: &'s mut Renderer<'a>,
    candidates: Vec<Candidate>,
    cost: Cost,
}

impl<'s, 'a> Search<'s, 'a> {
    /// Prepares the search for a setting.
    ///
    /// # Errors
    /// Usage: the mode has no such metric, the options contradict each other.
    pub fn new(task: &'s Task<'s>, renderer: &'s mut Renderer<'a>) -> Result<Self> {
        let mode = task.options.mode();
        task.bound.check(mode)?;
        let deviation = Deviation::new(task.bound, task.volume)?;
        let own = task.options.how().undecided();
        let one_ray = (task.options.sampling.aa).is_none_or(|aa| aa.rays() == 1);
        let mut all = Vec::new();
        for chain in candidates(mode, deviation.limit(), one_ray)? {
            let finest = chain.len() - 1;
            for (at, setting) in chain.iter().enumerate() {
                all.push(Candidate::new(setting, at, finest, &own, task)?);
            }
        }
        Ok(Self {
            task,
            deviation,
            renderer,
            candidates: all,
            cost: Cost::default(),
        })
    }

    /// Searches for the cheapest setting that meets the bound.
    ///
    /// # Errors
    /// The device fails.
    pub fn run(mut self) -> Result<Choice> {
        let waiting = self.screen()?;
        let chosen = self.choose(waiting)?;
        Ok(self.choice(chosen))
    }

    /// The index of the surest candidate.
    fn surest(&self) -> usize {
        self.candidates.len() - 1
    }

    /// A candidate's picture in some size.
    fn render(&mut self, at: usize, size: ImageSize, wanted: Wanted) -> Result<Rendering> {
        let scene = Scene {
            size,
            ..self.candidates[at].resolved.scene.clone()
        };
        self.cast(&scene, wanted)
    }

    fn cast(&mut self, scene: &Scene, wanted: Wanted) -> Result<Rendering> {
        let rendering = self.renderer.render(scene, wanted)?;
        self.cost.renderings += 1;
        self.cost.build_ms += rendering.build_ms;
        self.cost.upload_ms += rendering.upload_ms;
        self.cost.uploaded_bytes += rendering.uploaded_bytes;
        Ok(rendering)
    }

    fn size(&self) -> ImageSize {
        self.candidates[self.surest()].resolved.scene.size
    }

    /// The candidates for the real picture, the fastest first: of each chain the coarsest
    /// within the bound in a small picture, where it is no slower than the surest.
    fn screen(&mut self) -> Result<Waiting> {
        let size = screened(self.size())?;
        let wanted = self.deviation.wanted();
        let surest = self.render(self.surest(), size, wanted)?.frame;
        let slack = match self.deviation.figure() {
            Figure::RootMean | Figure::ShareOfHits | Figure::Percentile99 => SCREEN_SLACK,
            Figure::Greatest => 1.0,
        };
        let mut within = Vec::new();
        let mut is_decided = false;
        for at in 0..self.candidates.len() {
            is_decided &= !self.candidates[at].is_coarsest;
            if is_decided {
                continue;
            }
            let frame = self.render(at, size, wanted)?.frame;
            let error = self.deviation.between(&surest, &frame);
            self.candidates[at].error = Some(error);
            if error <= slack * self.deviation.limit() {
                within.push(at);
                is_decided = true;
            }
        }
        if !within.contains(&self.surest()) {
            within.push(self.surest());
        }
        self.time(&within, size)?;
        let slowest_ms = self.ms(self.surest()) * EQUALLY_FAST;
        within.retain(|&at| at == self.surest() || self.ms(at) <= slowest_ms);
        within.sort_by(|&a, &b| self.ms(a).total_cmp(&self.ms(b)));
        Ok(Waiting {
            queue: within.into(),
            size,
            slowest_ms,
        })
    }

    /// Infinite before it was timed.
    fn ms(&self, at: usize) -> f64 {
        self.candidates[at].ms.unwrap_or(f64::INFINITY)
    }

    /// Queues the next finer candidate of the chain of one that failed, unless it is slower than the
    /// surest.
    fn refine(&mut self, failed: usize, waiting: &mut Waiting) -> Result<()> {
        let finer = failed + 1;
        if self.candidates[failed].is_finest || self.candidates[finer].ms.is_some() {
            return Ok(());
        }
        self.time(&[finer], waiting.size)?;
        if self.ms(finer) <= waiting.slowest_ms {
            let is_faster = |&at: &usize| self.ms(at) <= self.ms(finer);
            let place = waiting.queue.partition_point(is_faster);
            waiting.queue.insert(place, finer);
        }
        Ok(())
    }

    /// Times candidates: all once, then in turn those that may be the fastest.
    fn time(&mut self, group: &[usize], size: ImageSize) -> Result<()> {
        let wanted = self.task.wanted;
        for &at in group {
            let cold = self.render(at, size, wanted)?.render_ms;
            self.candidates[at].ms = Some(if cold < TIMING_MS / 8.0 {
                self.render(at, size, wanted)?.render_ms
            } else {
                cold // what comes first is a small part of it
            });
        }
        let ms = |at: usize| self.ms(at);
        let fastest = group.iter().map(|&at| ms(at)).fold(f64::INFINITY, f64::min);
        let fast = group.iter().copied();
        let fast: Vec<usize> = fast
            .filter(|&at| ms(at) <= MAYBE_FASTEST * fastest)
            .collect();
        if fast.len() < 2 {
            return Ok(());
        }
        let once: f64 = fast.iter().map(|&at| ms(at)).sum();
        let repeats = (TIMING_MS / once).clamp(REPEATS[0] as f64, REPEATS[1] as f64);
        let times = interleaved(&fast, repeats as usize, |&at| {
            Ok(self.render(at, size, wanted)?.render_ms)
        })?;
        for (&at, times) in fast.iter().zip(&times) {
            self.candidates[at].ms = Some(times.min_ms());
        }
        Ok(())
    }

    /// Evaluates and verifies candidates until one keeps the bound.
    fn choose(&mut self, mut waiting: Waiting) -> Result<Chosen> {
        let task = self.task;
        let size = self.size();
        let surest = self.surest();
        let surest_scene = self.candidates[surest].resolved.scene.clone();
        let elsewhere = task.elsewhere.iter().map(|&camera| Scene {
            camera,
            ..surest_scene.clone()
        });
        let elsewhere: Vec<Scene> = elsewhere.collect();
        let mut evidence = self.evidence(&surest_scene)?;
        let mut views: Vec<View> = elsewhere.iter().map(View::unseen).collect();
        let rays = (RAYS_SHARE * size.pixels() as f64) as usize;
        let rays = rays.clamp(RAYS[0], RAYS[1]);
        let sample = evidence.draw(rays);
        let mut verifying = Verifying {
            evidence: &mut evidence,
            views: &mut views,
            rays,
        };

        let mut chosen = None;
        while chosen.is_none() && !waiting.queue.is_empty() {
            let mut group: Vec<usize> = Vec::new();
            while let Some(&at) = waiting.queue.front() {
                let first = group.first().map(|&first| self.ms(first));
                let is_late = first.is_some_and(|first| self.ms(at) > ABOUT_AS_FAST * first);
                if is_late || group.len() == TIMED_TOGETHER {
                    break;
                }
                waiting.queue.pop_front();
                let frame = self.render(at, size, self.deviation.wanted())?.frame;
                let estimate = verifying.evidence.evaluate(&frame, &sample);
                self.candidates[at].error = Some(estimate.figure);
                self.candidates[at].evaluated = true;
                if estimate.upper <= self.deviation.limit() {
                    group.push(at);
                } else {
                    self.refine(at, &mut waiting)?;
                }
            }
            if group.len() > 1 {
                self.time(&group, size)?;
            }
            for at in self.ranked(group) {
                let candidate = self.verify(at, &mut verifying)?;
                if candidate.met {
                    chosen = Some(candidate);
                    break;
                }
                self.refine(at, &mut waiting)?;
            }
        }
        let chosen = match chosen {
            Some(chosen) => chosen,
            // It was beyond the bound on some tiles, whatever these say.
            None => Chosen {
                met: false,
                ..self.verify(surest, &mut verifying)?
            },
        };
        let seen = views.iter().filter_map(|view| view.evidence.as_ref());
        self.cost.rays = evidence.rays() + seen.map(Evidence::rays).sum::<u64>();
        Ok(chosen)
    }

    /// The evidence from a scene, as the surest candidate and the reference show it.
    fn evidence<'e>(&mut self, scene: &'e Scene) -> Result<Evidence<'e>>
    where
        's: 'e,
    {
        let is_surface = matches!(scene.picture, Picture::Surface { .. });
        let wanted = (self.deviation.wanted()).with_if(is_surface, Layer::Certificate);
        let frame = self.cast(scene, wanted)?.frame;
        Evidence::new(
            self.deviation,
            self.task.volume,
            scene,
            frame,
            self.task.seed,
        )
    }

    /// The fastest first; of those that are equally fast as the fastest left, the one of the smallest
    /// error.
    fn ranked(&self, mut group: Vec<usize>) -> Vec<usize> {
        let ms = |at: usize| self.ms(at);
        let mut ranked = Vec::with_capacity(group.len());
        while let Some(fastest) = group.iter().map(|&at| ms(at)).min_by(f64::total_cmp) {
            let equals = (0..group.len()).filter(|&k| ms(group[k]) <= EQUALLY_FAST * fastest);
            let error = |k: &usize| self.candidates[group[*k]].error.unwrap_or(f64::INFINITY);
            let Some(best) = equals.min_by(|a, b| error(a).total_cmp(&error(b))) else {
                break;
            };
            ranked.push(group.remove(best));
        }
        ranked
    }

    /// Verifies a candidate by rays that took no part in choosing it, at every place of the camera: the
    /// error where it is greatest. Ends where it is beyond the bound.
    fn verify<'e>(&mut self, at: usize, by: &mut Verifying<'_, 'e>) -> Result<Chosen>
    where
        's: 'e,
    {
        let scene = self.candidates[at].resolved.scene.clone();
        let limit = self.deviation.limit();
        let mut verified = Verified::default();
        let mut estimate = self.verify_in(&scene, by.evidence, by.rays, &mut verified)?;
        for view in by.views.iter_mut() {
            if estimate.upper > limit {
                break;
            }
            let scene = Scene {
                camera: view.scene.camera,
                ..scene.clone()
            };
            let evidence = match &mut view.evidence {
                Some(evidence) => evidence,
                unseen => unseen.insert(self.evidence(view.scene)?),
            };
            let there = self.verify_in(&scene, evidence, by.rays, &mut verified)?;
            estimate.figure = estimate.figure.max(there.figure);
            estimate.upper = estimate.upper.max(there.upper);
        }
        let candidate = &mut self.candidates[at];
        candidate.error = Some(estimate.figure);
        candidate.evaluated = true;
        Ok(Chosen {
            at,
            met: estimate.upper <= limit,
            estimate,
            verified,
        })
    }

    /// Verifies at one place of the camera.
    fn verify_in(
        &mut self,
        scene: &Scene,
        evidence: &mut Evidence,
        rays: usize,
        verified: &mut Verified,
    ) -> Result<Estimate> {
        let frame = self.cast(scene, self.deviation.wanted())?.frame;
        let sample: Sample = evidence.draw(rays);
        evidence.cast_worst(&frame, MAX_ERROR_RAYS);
        verified.views += 1;
        verified.tiles += sample.len();
        verified.rays += sample.iter().map(Vec::len).sum::<usize>();
        Ok(evidence.evaluate(&frame, &sample))
    }

    fn choice(self, chosen: Chosen) -> Choice {
        let shown = |figure| self.deviation.shown(figure);
        let tried = self.candidates.iter().filter_map(|candidate| {
            Some(Tried {
                setting: candidate.setting.clone(),
                ms: candidate.ms,
                error: shown(candidate.error?),
                evaluated: candidate.evaluated,
            })
        });
        let tried = tried.collect();
        let mut candidates = self.candidates;
        let candidate = candidates.swap_remove(chosen.at);
        Choice {
            bound: self.task.bound,
            setting: candidate.setting,
            resolved: candidate.resolved,
            met: chosen.met,
            estimate: self.deviation.shown(chosen.estimate.figure),
            upper: self.deviation.shown(chosen.estimate.upper),
            verified: chosen.verified,
            tried,
            cost: self.cost,
        }
    }
}

/// A picture of the same shape of at most about [`SCREENED_PIXELS`]; a picture up to twice as large
/// is its own.
fn screened(size: ImageSize) -> Result<ImageSize> {
    let pixels = size.pixels();
    if pixels <= 2 * SCREENED_PIXELS {
        return Ok(size);
    }
    let scale = (SCREENED_PIXELS as f64 / pixels as f64).sqrt();
    let side = |px: u32| ((f64::from(px) * scale).round() as u32).max(1);
    ImageSize::new(side(size.width()), side(size.height()))
}
