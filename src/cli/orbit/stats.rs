//! The statistics of an orbit (`--stats`): of every frame that was made, and of all together.

use crate::VERSION;
use crate::batch::Written;
use crate::error::Result;
use crate::frame::{self, Frame};
use crate::measure::Counts;
use crate::render::GradientFigures;
use crate::scene::Picture;
use crate::tolerance::{Cost, ToleranceStats};

use super::super::engine::Rendered;
use super::super::stats::{
    self, FrameStats, Memory, OrbitFigures, OrbitStats, PassStats, Stats, Times, VolumeStats,
};

use super::making::{Made, Making};
use super::plan::Plan;

/// What is remembered of a frame.
pub struct Taken {
    pub times_ms: Times,
    pub passes: Vec<PassStats>,
    /// Where statistics are wanted.
    pub counts: Option<Counts>,
    pub gradients: Option<GradientFigures>,
    pub device_bytes: u64,
    pub uploaded_bytes: u64,
}

impl Taken {
    /// What is remembered, and the frame itself.
    pub fn of(rendered: Rendered, picture: &Picture, plan: &Plan) -> (Self, Frame) {
        let counted = plan.stats.as_ref();
        let taken = Self {
            times_ms: rendered.times_ms,
            passes: rendered.passes,
            counts: counted.map(|_| Counts::of(&rendered.frame, picture)),
            gradients: rendered.gradients,
            device_bytes: rendered.device_bytes,
            uploaded_bytes: rendered.uploaded_bytes,
        };
        (taken, rendered.frame)
    }
}

/// Writes them where they are wanted, of no frames too: `kept` were there already.
pub fn write(making: &Making<'_>, made: &Made, kept: usize) -> Result<()> {
    let (plan, loaded) = (making.plan, making.loaded);
    let Some(path) = &plan.stats else {
        return Ok(());
    };
    let written = &made.written;
    let first = made.frames.first();
    let choosing = (made.chosen.as_ref()).map_or(Cost::default(), |choice| choice.cost);
    let most_held = written.iter().map(|w| w.about.device_bytes).max();
    let gradients = written.last().and_then(|w| w.about.gradients);
    let uploaded_bytes: u64 = written.iter().map(|w| w.about.uploaded_bytes).sum();
    let times_ms = times_of_all(written);
    let stats = OrbitStats {
        all: Stats {
            version: VERSION,
            command: "orbit",
            scene: &first.options,
            volume: VolumeStats::of(&making.job.source.path, &loaded.volume, loaded.non_finite),
            device: making.engine.device(),
            channels: frame::channels(&plan.encoding),
            times_ms: Times {
                read: loaded.read_ms,
                smooth: loaded.smooth_ms,
                build: times_ms.build + choosing.build_ms,
                upload: times_ms.upload + choosing.upload_ms,
                ..times_ms
            },
            passes: passes_of_all(written),
            counts: written.iter().filter_map(|w| w.about.counts).sum(),
            memory: Memory::now(
                most_held.unwrap_or(0),
                gradients.map_or(0, |figures| figures.bytes),
                uploaded_bytes + choosing.uploaded_bytes,
            ),
            max_error: made.chosen.as_ref().map(ToleranceStats::of),
        },
        orbit: OrbitFigures {
            frames: plan.frames.get(),
            degrees: plan.degrees,
            axis: made.frames.orbit.axis().to_array(),
            kept,
            shard: plan.shard.to_string(),
        },
        frames: written
            .iter()
            .filter_map(|w| {
                Some(FrameStats {
                    index: w.index,
                    degrees: made.frames.orbit.degrees_at(w.index),
                    render_ms: w.about.times_ms.render,
                    read_back_ms: w.about.times_ms.read_back,
                    encode_ms: w.encode_ms,
                    counts: w.about.counts?,
                })
            })
            .collect(),
    };
    stats::write(&stats, path)
}

/// Sums over the frames; what was done once for all is counted once.
fn times_of_all(written: &[Written<Taken>]) -> Times {
    let sum = |of: fn(&Times) -> f64| written.iter().map(|w| of(&w.about.times_ms)).sum();
    let once = |of: fn(&Times) -> f64| written.first().map_or(0.0, |w| of(&w.about.times_ms));
    Times {
        octree: once(|times| times.octree),
        gradient: once(|times| times.gradient),
        classify: sum(|times| times.classify),
        build: sum(|times| times.build),
        upload: sum(|times| times.upload),
        render: sum(|times| times.render),
        read_back: sum(|times| times.read_back),
        encode: written.iter().map(|w| w.encode_ms).sum(),
        ..Times::default()
    }
}

/// Every pass's sum over the frames, in the order in which they first ran.
fn passes_of_all(written: &[Written<Taken>]) -> Vec<PassStats> {
    let mut sums: Vec<PassStats> = Vec::new();
    for pass in written.iter().flat_map(|w| &w.about.passes) {
        match sums.iter_mut().find(|sum| sum.name == pass.name) {
            Some(sum) => sum.ms += pass.ms,
            None => sums.push(pass.clone()),
        }
    }
    sums
}
