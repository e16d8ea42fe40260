//! How fast the device can sample a volume, for measuring casts.

use crate::error::Result;
use crate::gpu::Timings;
use crate::render::passes::{Run, sample_field};
use crate::render::rays::ray_grid;
use crate::render::twins;
use crate::render::variant::Variant;
use crate::scene::{SamplingMethod, Scene};

use super::{Renderer, check_step};

/// Straight rays sampled from end to end.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    /// Of each ray's samples, physical; row by row.
    pub means: Vec<f64>,
    /// Samples of each ray.
    pub counts: Vec<u32>,
    /// On the device's clock.
    pub ms: f64,
}

impl Sampled {
    /// Of all rays.
    pub fn samples(&self) -> u64 {
        self.counts.iter().map(|&n| u64::from(n)).sum()
    }
}

impl Renderer<'_> {
    /// Samples the field along the rays of `scene`'s camera at its step, in the middle of each, from
    /// the volume's one side to the other: no picture, nothing skipped, clip planes disregarded. No
    /// cast that takes samples can take more of them in the same time.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn sample_field(&mut self, scene: &Scene) -> Result<Sampled> {
        check_step(scene, self.volume)?;
        let storage = scene.sampling.voxels;
        storage.check(SamplingMethod::Fixed, scene.sampling.filter)?;
        self.upload_voxels(storage)?;
        let mut timings = Timings::default();
        let mut run = Run {
            device: self.device,
            built: &mut self.built,
            timings: &mut timings,
            size: scene.size,
            work_group: self.work_group,
            variant: Variant::of(self.volume, self.octree, &scene.sampling, self.lanes),
            voxels: self.voxels.held(self.device, self.volume, storage)?,
        };
        let rays = ray_grid(&scene.camera, scene.size, self.volume);
        let step_mm = twins::step_mm(&scene.sampling, self.volume) as f32;
        let (mut means, mut counts) = (run.plane("means")?, run.plane("counts")?);
        sample_field(
            &mut run,
            &self.uploaded,
            &rays,
            step_mm,
            &mut means,
            &mut counts,
        )?;
        let (_, ms) = timings.finish(self.device)?;
        let physical = |stored: f32| self.volume.rescale().physical(f64::from(stored));
        let means = means.download(self.device)?.into_iter();
        Ok(Sampled {
            means: means.map(physical).collect(),
            counts: counts.download(self.device)?,
            ms,
        })
    }
}
