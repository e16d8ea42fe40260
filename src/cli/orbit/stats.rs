//! The statistics of an orbit (`--stats`): of every frame that was made, and of all together.

use crate::VERSION;
use crate::batch::Written;
use crate::error::Result;
use crate::frame;
use crate::lab::tolerance::{Cost, ToleranceStats};

use super::super::stats::{
    self, FrameStats, Memory, OrbitFigures, OrbitStats, PassStats, Stats, Times, VolumeStats,
};

use super::frame_record::FrameRecord;
use super::runner::{OrbitOutcome, OrbitRunner};

/// Writes statistics where they are wanted, of no frames too: `existing` frames were finished before.
pub fn write(runner: &OrbitRunner<'_>, outcome: &OrbitOutcome, existing: usize) -> Result<()> {
    let (plan, loaded) = (runner.plan, runner.loaded);
    let Some(path) = &plan.stats else {
        return Ok(());
    };
    let written = &outcome.written;
    let first = outcome.frames.first();
    let choosing = (outcome.chosen.as_ref()).map_or(Cost::default(), |choice| choice.cost);
    let max_device_bytes = written.iter().map(|w| w.about.device_bytes).max();
    let gradients = written.last().and_then(|w| w.about.gradients);
    let uploaded_bytes: u64 = written.iter().map(|w| w.about.uploaded_bytes).sum();
    let times_ms = times_of_all(written);
    let stats = OrbitStats {
        all: Stats {
            version: VERSION,
            command: "orbit",
            scene: &first.options,
            volume: VolumeStats::of(&runner.job.source.path, &loaded.volume, loaded.non_finite),
            device: runner.backend.device(),
            channels: frame::channels(&plan.encoding),
            times_ms: Times {
                read: loaded.read_ms,
                smooth: loaded.smooth_ms,
                build: times_ms.build + choosing.build_ms,
                upload: times_ms.upload + choosing.upload_ms,
                ..times_ms
            },
            passes: passes_of_all(written),
            rays_per_round: Vec::new(),
            occlusion_bound: None,
            sample_check: None,
            focus_mm: None,
            sampling_check: None,
            counts: written.iter().filter_map(|w| w.about.counts).sum(),
            memory: Memory::now(
                max_device_bytes.unwrap_or(0),
                gradients.map_or(0, |figures| figures.bytes),
                uploaded_bytes + choosing.uploaded_bytes,
            ),
            max_error: outcome.chosen.as_ref().map(ToleranceStats::of),
        },
        orbit: OrbitFigures {
            frames: plan.frames.get(),
            degrees: plan.degrees,
            axis: outcome.frames.orbit.axis().to_array(),
            kept: existing,
            shard: plan.shard.to_string(),
        },
        frames: written
            .iter()
            .filter_map(|w| {
                Some(FrameStats {
                    index: w.index,
                    degrees: outcome.frames.orbit.degrees_at(w.index),
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
fn times_of_all(written: &[Written<FrameRecord>]) -> Times {
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
fn passes_of_all(written: &[Written<FrameRecord>]) -> Vec<PassStats> {
    let mut sums: Vec<PassStats> = Vec::new();
    for pass in written.iter().flat_map(|w| &w.about.passes) {
        match sums.iter_mut().find(|sum| sum.name == pass.name) {
            Some(sum) => sum.ms += pass.ms,
            None => sums.push(pass.clone()),
        }
    }
    sums
}
