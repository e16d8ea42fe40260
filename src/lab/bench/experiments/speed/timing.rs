//! The times of all candidates, of sampling alone and of another renderer, in turn.

use serde::{Deserialize, Serialize};

use super::candidate::Candidate;
use super::errors::{PictureError, SparseReference};
use super::picture::PictureKind;
use crate::error::{Error, Result};
use crate::frame::{Layer, Wanted, median};
use crate::lab::bench::protocol::turned;
use crate::lab::bench::{Bench, Dataset, Preset};
use crate::lab::measure::{
    Counts, FrameTime, Peer, PeerScene, PeerTime, Readiness, Times, evaluated_planes, rounds, time,
};
use crate::lab::report::without_folders;
use crate::progress::Stage;
use crate::render::Renderer;
use crate::scene::{Sampling, SamplingMethod, Scene, StepVoxels, Storage};

/// The times of one frame, ms.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Taken {
    /// The time from the camera set to pixels that the host can read, ms.
    pub frame_ms: f64,
    /// Processor time of all threads, ms; unknown on some systems, and for some peers.
    pub processor_ms: Option<f64>,
    /// Time of the pass that follows the rays, ms on the device's clock; unknown for peers.
    pub cast_ms: Option<f64>,
}

/// The renderer of a row's frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Runner {
    Ours,
    /// Sampling alone: the most samples that a cast could take; from a buffer first, then from images.
    Sampling,
    /// A program, by its name and version.
    Peer(String),
}

/// One row: what is seen, its setting, its error and the times of its frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TimedRow {
    pub runner: Runner,
    /// The kind of picture; `None` for sampling alone.
    pub kind: Option<PictureKind>,
    pub setting: String,
    /// Samples taken, or cells visited, in a frame from the middle of the camera's path.
    pub samples: Option<u64>,
    pub error: Option<PictureError>,
    /// How a peer's picture differs otherwise.
    pub note: Option<String>,
    /// The times, one a round.
    pub taken: Vec<Taken>,
}

impl TimedRow {
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

    /// The samples a second while it casts, in the frame that was disturbed least.
    pub fn samples_per_s(&self) -> Option<f64> {
        let casts = self.taken.iter().map(|one| one.cast_ms);
        let casts: Times = casts.collect::<Option<_>>()?;
        Some(1e3 * self.samples? as f64 / casts.min_ms())
    }

    /// The samples a second as a share of those of `max`: the median of the rounds' own.
    pub fn share_of(&self, max: &Self) -> Option<f64> {
        let samples = self.samples? as f64 / max.samples? as f64;
        let rounds = self.taken.iter().zip(&max.taken);
        let shares = rounds.map(|(own, max)| Some(samples * max.cast_ms? / own.cast_ms?));
        median(&mut shares.collect::<Option<Vec<f64>>>()?)
    }
}

/// Everything that is timed together.
pub struct Lineup<'a> {
    pub bench: &'a Bench<'a>,
    pub dataset: &'a Dataset,
    pub candidates: &'a [Candidate],
    pub peer: Option<&'a mut Peer>,
}

/// The angle by which the camera turns between two frames: no two frames see the same cells in the same
/// pixels.
pub const TURN_DEG: f64 = 1.7;

/// The settings of a peer that are timed, the first that it has for a mode; else its first.
const PEER_SETTINGS: [&str; 2] = ["mesh", "fixed-point, step 1"];

/// The time of a candidate's frames unless the user says how many: neither so few
/// that the median is chance nor so many that the camera comes around.
fn seconds(preset: Preset) -> f64 {
    match preset {
        Preset::Quick => 0.3,
        Preset::Usual => 3.0,
        Preset::Full => 10.0,
    }
}
const MIN_FRAMES: usize = 5;
const MAX_FRAMES: usize = 41;

/// Where the camera is in a round, of so many: on an arc whose middle is its place in the scene.
fn placed(dataset: &Dataset, scene: &Scene, round: usize, rounds: usize) -> Scene {
    let (center_world, _) = dataset.volume.bounding_sphere();
    let from_middle = round as f64 - (rounds / 2) as f64;
    turned(scene, center_world, TURN_DEG * from_middle)
}

/// A turn in each round.
enum Turn<'a> {
    Ours(&'a Scene),
    Sampling(&'a Scene),
    Peer(PeerScene, &'a Scene),
}

/// The scenes of sampling alone: from a buffer first, with which casts are compared, then from images
/// where the device has them.
fn straight_rays(candidates: &[Candidate], renderer: &Renderer) -> Result<Vec<Scene>> {
    let Some(first) = candidates.first() else {
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

/// Times everything: the rows of the candidates, of sampling alone, of the peer.
pub fn time_all(lineup: Lineup) -> Result<Vec<TimedRow>> {
    let Lineup {
        bench,
        dataset,
        candidates,
        mut peer,
    } = lineup;
    let octree = bench.octree(dataset)?;
    let mut renderer = bench.renderer(dataset, &octree)?;
    let mut rows = Vec::new();
    let mut turns = Vec::new();
    if let Some(peer) = peer.as_deref_mut() {
        peer.load(&dataset.volume)?;
    }
    for kind in PictureKind::ALL {
        let of_kind = candidates.iter().filter(|one| one.kind == kind);
        let Some(first) = of_kind.clone().next() else {
            continue;
        };
        let reference = SparseReference::of(bench, dataset, &first.scene)?;
        for candidate in of_kind {
            bench.check_stop()?;
            rows.push(evaluated(candidate, &reference, &mut renderer)?);
            turns.push(Turn::Ours(&candidate.scene));
        }
        if let Some(peer) = peer.as_deref_mut()
            && let Some((row, scene)) = peer_row(peer, dataset, first, &reference)?
        {
            rows.push(row);
            turns.push(Turn::Peer(scene, &first.scene));
        }
    }
    let straight = straight_rays(candidates, &renderer)?;
    for scene in &straight {
        rows.push(sampling_row(scene, &mut renderer)?);
        turns.push(Turn::Sampling(scene));
    }
    let count = match bench.frames {
        Some(frames) => frames as usize,
        None => frames_of(bench.preset, candidates, &mut renderer)?,
    };
    let taken = take_turns(
        bench,
        dataset,
        &turns,
        count,
        &mut renderer,
        peer.as_deref_mut(),
    )?;
    for (row, taken) in rows.iter_mut().zip(taken) {
        row.taken = taken;
    }
    if let Some(peer) = peer {
        peer.forget()?;
    }
    Ok(rows)
}

/// All turns, `count` rounds after one to warm up.
fn take_turns(
    bench: &Bench,
    dataset: &Dataset,
    turns: &[Turn],
    count: usize,
    renderer: &mut Renderer,
    mut peer: Option<&mut Peer>,
) -> Result<Vec<Vec<Taken>>> {
    let mut measured = 0;
    let stage = Stage::begin(bench.progress, "timing", (turns.len() * (count + 1)) as u64);
    rounds(turns, count, |turn| {
        bench.check_stop()?;
        stage.advance(1);
        // The first round warms up.
        let round = (measured / turns.len()).saturating_sub(1);
        measured += 1;
        let there = |scene| placed(dataset, scene, round, count);
        Ok(match (turn, peer.as_deref_mut()) {
            (Turn::Ours(scene), _) => Taken::of(&time(renderer, &there(scene))?),
            (Turn::Sampling(scene), _) => sampled(renderer, &there(scene))?,
            (Turn::Peer(ready, scene), Some(peer)) => {
                Taken::by(peer.time_from(ready, &there(scene).camera)?)
            }
            (Turn::Peer(..), None) => return Err(Error::failed("a peer has ended too early")),
        })
    })
}

/// The row of sampling alone, all but its times.
fn sampling_row(scene: &Scene, renderer: &mut Renderer) -> Result<TimedRow> {
    Ok(TimedRow {
        runner: Runner::Sampling,
        kind: None,
        setting: format!("step 1, voxels in: {}", scene.sampling.voxels),
        samples: Some(renderer.sample_field(scene)?.samples()),
        error: None,
        note: None,
        taken: Vec::new(),
    })
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

/// A candidate's row, all but its times. The counters come from a frame without other planes, as in
/// those that are timed: a projection needs more for some planes.
fn evaluated(
    candidate: &Candidate,
    reference: &SparseReference,
    renderer: &mut Renderer,
) -> Result<TimedRow> {
    let scene = &candidate.scene;
    let counting = Wanted::DISPLAY.with(Layer::COUNTERS);
    let counted = renderer.render(scene, counting)?.frame;
    let compared = evaluated_planes(scene)
        .without(Layer::COUNTERS)
        .without([Layer::Kind]);
    let frame = renderer.render(scene, compared)?.frame;
    Ok(TimedRow {
        runner: Runner::Ours,
        kind: Some(candidate.kind),
        setting: candidate.setting.clone(),
        samples: Some(Counts::of(&counted, &scene.picture, counted.size.pixels() as u64).samples),
        error: Some(reference.error(candidate.kind.mode(), &frame)?),
        note: None,
        taken: Vec::new(),
    })
}

/// The peer's row beside a candidate, all but its times, where it draws such a picture.
fn peer_row(
    peer: &mut Peer,
    dataset: &Dataset,
    candidate: &Candidate,
    reference: &SparseReference,
) -> Result<Option<(TimedRow, PeerScene)>> {
    let mode = candidate.kind.mode();
    let settings = peer.settings(&mode.to_string());
    let preferred = |setting: &&String| PEER_SETTINGS.contains(&setting.as_str());
    let Some(setting) = settings.iter().find(preferred).or(settings.first()) else {
        return Ok(None);
    };
    let Readiness::Ready(scene) = peer.prepare(&dataset.volume, &candidate.scene, setting)? else {
        return Ok(None);
    };
    let frame = peer.render(&scene)?.frame;
    let row = TimedRow {
        runner: Runner::Peer(format!("{} {}", peer.name(), peer.version())),
        kind: Some(candidate.kind),
        setting: setting.clone(),
        samples: None,
        error: Some(reference.error(mode, &frame)?),
        note: scene.note.as_deref().map(without_folders),
        taken: Vec::new(),
    };
    Ok(Some((row, scene)))
}

/// The number of frames that take the candidates about [`seconds`] each, on average.
fn frames_of(preset: Preset, candidates: &[Candidate], renderer: &mut Renderer) -> Result<usize> {
    let mut round_ms = 0.0;
    for candidate in candidates {
        // The first frame builds.
        time(renderer, &candidate.scene)?;
        round_ms += time(renderer, &candidate.scene)?.frame_ms;
    }
    let wanted = 1e3 * seconds(preset) * candidates.len() as f64 / round_ms;
    Ok((wanted as usize).clamp(MIN_FRAMES, MAX_FRAMES))
}
