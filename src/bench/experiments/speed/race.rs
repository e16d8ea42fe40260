//! Frames of all contenders, of sampling alone and of another renderer, in turn.

use serde::{Deserialize, Serialize};

use super::contender::{Contender, Look};
use super::errors::{Sparse, Wrong};
use crate::bench::protocol::turned;
use crate::bench::{Bench, Effort, Specimen};
use crate::error::{Error, Result};
use crate::frame::{Wanted, median};
use crate::measure::{
    Counts, FrameTime, Peer, PeerScene, PeerTime, Readiness, Times, judged_planes, rounds, time,
};
use crate::progress::Stage;
use crate::render::Renderer;
use crate::report::without_folders;
use crate::scene::{Sampling, SamplingMethod, Scene, StepVoxels, Storage};

/// What one frame took, ms.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Taken {
    /// From the camera set to pixels that the host can read.
    pub frame_ms: f64,
    /// Of all threads; unknown on some systems, and of some peers.
    pub processor_ms: Option<f64>,
    /// Of the pass that follows the rays, on the device's clock; unknown of peers.
    pub cast_ms: Option<f64>,
}

/// Who made a row's frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Runner {
    Ours,
    /// Sampling alone: the most samples that a cast could take; from a buffer first, then from images.
    Sampling,
    /// A program, by its name and version.
    Peer(String),
}

/// One row: what is seen how, how wrong it is, and what its frames took.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Raced {
    pub runner: Runner,
    /// What is seen; sampling alone sees nothing.
    pub look: Option<Look>,
    pub setting: String,
    /// Of a frame from the middle of the camera's way: samples taken, or cells walked.
    pub samples: Option<u64>,
    pub wrong: Option<Wrong>,
    /// In what a peer's picture differs otherwise.
    pub note: Option<String>,
    /// A round each.
    pub taken: Vec<Taken>,
}

impl Raced {
    pub fn frame_ms(&self) -> Times {
        self.taken.iter().map(|one| one.frame_ms).collect()
    }

    /// Where it is known of every frame.
    pub fn processor_ms(&self) -> Option<Times> {
        self.taken.iter().map(|one| one.processor_ms).collect()
    }

    /// The median of the frames' shares that are not the cast's; there is nothing else in sampling alone.
    pub fn outside_cast(&self) -> Option<f64> {
        if self.runner == Runner::Sampling {
            return None;
        }
        let shares = self.taken.iter();
        let shares = shares.map(|one| Some(1.0 - one.cast_ms? / one.frame_ms));
        median(&mut shares.collect::<Option<Vec<f64>>>()?)
    }

    /// While it casts, in the frame that was disturbed least.
    pub fn samples_per_s(&self) -> Option<f64> {
        let casts = self.taken.iter().map(|one| one.cast_ms);
        let casts: Times = casts.collect::<Option<_>>()?;
        Some(1e3 * self.samples? as f64 / casts.min_ms())
    }

    /// The samples a second as a share of those of `most`: the median of the rounds' own.
    pub fn share_of(&self, most: &Self) -> Option<f64> {
        let samples = self.samples? as f64 / most.samples? as f64;
        let rounds = self.taken.iter().zip(&most.taken);
        let shares = rounds.map(|(own, most)| Some(samples * most.cast_ms? / own.cast_ms?));
        median(&mut shares.collect::<Option<Vec<f64>>>()?)
    }
}

/// Who takes part.
pub struct Entrants<'a> {
    pub bench: &'a Bench<'a>,
    pub specimen: &'a Specimen,
    pub contenders: &'a [Contender],
    pub peer: Option<&'a mut Peer>,
}

/// Between two frames the camera turns by so much: no two frames see the same cells in the same pixels.
pub const TURN_DEG: f64 = 1.7;

/// The settings of a peer that are raced, the first that it has for a mode; else its first.
const RIVALS: [&str; 2] = ["mesh", "fixed-point, step 1"];

/// Frames of a contender unless the user says how many: what takes about so long, but neither so few
/// that the median is chance nor so many that the camera comes around.
fn seconds(effort: Effort) -> f64 {
    match effort {
        Effort::Quick => 0.3,
        Effort::Usual => 3.0,
        Effort::Full => 10.0,
    }
}
const FEWEST: usize = 5;
const MOST: usize = 41;

/// Where the camera is in a round, of so many: on an arc whose middle is its place in the scene.
fn placed(specimen: &Specimen, scene: &Scene, round: usize, rounds: usize) -> Scene {
    let (center_world, _) = specimen.volume.bounding_sphere();
    let from_middle = round as f64 - (rounds / 2) as f64;
    turned(scene, center_world, TURN_DEG * from_middle)
}

/// Who has a turn in each round.
enum Turn<'a> {
    Ours(&'a Scene),
    Sampling(&'a Scene),
    Peer(PeerScene, &'a Scene),
}

/// What sampling alone samples: from a buffer first, by which casts are judged, then from images where the
/// device has them.
fn straight_rays(contenders: &[Contender], renderer: &Renderer) -> Result<Vec<Scene>> {
    let Some(first) = contenders.first() else {
        return Ok(Vec::new());
    };
    let step = StepVoxels::new(1.0)?;
    let held = Storage::ALL
        .into_iter()
        .filter(|&voxels| renderer.check_storage(voxels).is_ok());
    let straight = held.map(|voxels| Scene {
        sampling: Sampling {
            method: SamplingMethod::Fixed,
            step,
            voxels,
            ..Sampling::default()
        },
        ..first.scene.clone()
    });
    Ok(straight.collect())
}

/// All rows: of the contenders, of sampling alone, of the peer.
pub fn race(entrants: Entrants) -> Result<Vec<Raced>> {
    let Entrants {
        bench,
        specimen,
        contenders,
        mut peer,
    } = entrants;
    let octree = bench.octree(specimen)?;
    let mut renderer = bench.renderer(specimen, &octree)?;
    let mut rows = Vec::new();
    let mut turns = Vec::new();
    if let Some(peer) = peer.as_deref_mut() {
        peer.load(&specimen.volume)?;
    }
    for look in Look::ALL {
        let of_look = contenders.iter().filter(|one| one.look == look);
        let Some(first) = of_look.clone().next() else {
            continue;
        };
        let truth = Sparse::of(bench, specimen, &first.scene)?;
        for contender in of_look {
            bench.check_stop()?;
            rows.push(judged(contender, &truth, &mut renderer)?);
            turns.push(Turn::Ours(&contender.scene));
        }
        if let Some(peer) = peer.as_deref_mut()
            && let Some((row, scene)) = rival(peer, specimen, first, &truth)?
        {
            rows.push(row);
            turns.push(Turn::Peer(scene, &first.scene));
        }
    }
    let straight = straight_rays(contenders, &renderer)?;
    for scene in &straight {
        rows.push(Raced {
            runner: Runner::Sampling,
            look: None,
            setting: format!("step 1, voxels in: {}", scene.sampling.voxels),
            samples: Some(renderer.sample_field(scene)?.samples()),
            wrong: None,
            note: None,
            taken: Vec::new(),
        });
        turns.push(Turn::Sampling(scene));
    }
    let count = match bench.frames {
        Some(frames) => frames as usize,
        None => frames_of(bench.effort, contenders, &mut renderer)?,
    };
    let mut measured = 0;
    let stage = Stage::begin(bench.progress, "timing", (turns.len() * (count + 1)) as u64);
    let taken = rounds(&turns, count, |turn| {
        bench.check_stop()?;
        stage.advance(1);
        // The first round warms up.
        let round = (measured / turns.len()).saturating_sub(1);
        measured += 1;
        let there = |scene| placed(specimen, scene, round, count);
        Ok(match (turn, peer.as_deref_mut()) {
            (Turn::Ours(scene), _) => Taken::of(&time(&mut renderer, &there(scene))?),
            (Turn::Sampling(scene), _) => sampled(&mut renderer, &there(scene))?,
            (Turn::Peer(ready, scene), Some(peer)) => {
                Taken::by(peer.time_from(ready, &there(scene).camera)?)
            }
            (Turn::Peer(..), None) => return Err(Error::failed("a peer has ended too early")),
        })
    });
    drop(stage);
    for (row, taken) in rows.iter_mut().zip(taken?) {
        row.taken = taken;
    }
    if let Some(peer) = peer {
        peer.forget()?;
    }
    Ok(rows)
}

impl Taken {
    fn of(time: &FrameTime) -> Self {
        Self {
            frame_ms: time.frame_ms,
            processor_ms: time.processor_ms,
            // The rays are followed first; what comes after colours what they met.
            cast_ms: time.passes.first().map(|pass| pass.ms),
        }
    }

    fn by(time: PeerTime) -> Self {
        Self {
            frame_ms: time.ms,
            processor_ms: time.cpu_ms,
            cast_ms: None,
        }
    }
}

fn sampled(renderer: &mut Renderer, scene: &Scene) -> Result<Taken> {
    let ms = renderer.sample_field(scene)?.ms;
    Ok(Taken {
        frame_ms: ms,
        processor_ms: None,
        cast_ms: Some(ms),
    })
}

/// A contender's row, all but its times. The counters come from a frame of which nothing else is
/// wanted, as in those that are timed: wanted planes ask for more of a projection.
fn judged(contender: &Contender, truth: &Sparse, renderer: &mut Renderer) -> Result<Raced> {
    let scene = &contender.scene;
    let counting = Wanted {
        counters: true,
        ..Wanted::DISPLAY
    };
    let counted = renderer.render(scene, counting)?.frame;
    let judging = Wanted {
        counters: false,
        kind: false,
        ..judged_planes(&scene.picture)
    };
    let frame = renderer.render(scene, judging)?.frame;
    Ok(Raced {
        runner: Runner::Ours,
        look: Some(contender.look),
        setting: contender.setting.clone(),
        samples: Some(Counts::of(&counted, &scene.picture).samples),
        wrong: Some(truth.wrong(contender.look.mode(), &frame)?),
        note: None,
        taken: Vec::new(),
    })
}

/// The peer's row beside a contender, all but its times, where it draws such a picture.
fn rival(
    peer: &mut Peer,
    specimen: &Specimen,
    contender: &Contender,
    truth: &Sparse,
) -> Result<Option<(Raced, PeerScene)>> {
    let mode = contender.look.mode();
    let settings = peer.settings(&mode.to_string());
    let known = |setting: &&String| RIVALS.contains(&setting.as_str());
    let Some(setting) = settings.iter().find(known).or(settings.first()) else {
        return Ok(None);
    };
    let Readiness::Ready(scene) = peer.prepare(&specimen.volume, &contender.scene, setting)? else {
        return Ok(None);
    };
    let frame = peer.render(&scene)?.frame;
    let row = Raced {
        runner: Runner::Peer(format!("{} {}", peer.name(), peer.version())),
        look: Some(contender.look),
        setting: setting.clone(),
        samples: None,
        wrong: Some(truth.wrong(mode, &frame)?),
        note: scene.note.as_deref().map(without_folders),
        taken: Vec::new(),
    };
    Ok(Some((row, scene)))
}

/// As many frames as take the contenders about [`seconds`] each, on average.
fn frames_of(effort: Effort, contenders: &[Contender], renderer: &mut Renderer) -> Result<usize> {
    let mut round_ms = 0.0;
    for contender in contenders {
        // The first frame builds.
        time(renderer, &contender.scene)?;
        round_ms += time(renderer, &contender.scene)?.frame_ms;
    }
    let wanted = 1e3 * seconds(effort) * contenders.len() as f64 / round_ms;
    Ok((wanted as usize).clamp(FEWEST, MOST))
}
