//! How fast the device can sample a volume, for measuring casts.

use crate::error::Result;
use crate::gpu::Timings;
use crate::render::abi::{Variant, step_mm};
use crate::render::passes::{Run, sample_field};
use crate::render::resources::RaySource;
use crate::scene::{SamplingMethod, Scene};

use super::renderer::Renderer;
use super::step::check_step;

/// Straight rays sampled from end to end.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    /// The mean of each ray's samples, physical; row by row.
    pub means: Vec<f64>,
    /// Samples of each ray.
    pub counts: Vec<u32>,
    /// Time on the device's clock.
    pub ms: f64,
}

impl Sampled {
    /// The samples of all rays.
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
        let (device, volume, octree) = (self.device, self.volume, self.octree);
        let (on_device, voxels) = self.held.upload(device, volume, octree, storage)?;
        let mut timings = Timings::default();
        let mut run = Run {
            device,
            passes: &mut self.passes,
            timings: &mut timings,
            announcing: false,
            rays: RaySource::of_camera(&scene.camera, scene.size, volume),
            work_group: self.work_group,
            variant: Variant::of(volume, octree, &scene.sampling, self.lanes),
            voxels,
        };
        let step_mm = step_mm(&scene.sampling, volume) as f32;
        let (mut means, mut counts) = (run.plane("means", 0.0)?, run.plane("counts", 0)?);
        sample_field(&mut run, on_device, step_mm, &mut means, &mut counts)?;
        let ms = timings.finish(device)?.device_ms;
        let physical = |stored: f32| volume.rescale().physical(f64::from(stored));
        let means = means.download(device)?.into_iter();
        Ok(Sampled {
            means: means.map(physical).collect(),
            counts: counts.download(device)?,
            ms,
        })
    }
}
