//! The scene and its data, as a picture's schedule of passes gets them.

use crate::frame::Wanted;
use crate::octree::Octree;
use crate::render::abi::{KernelEnum, step_mm};
use crate::render::passes::CastInputs;
use crate::render::resources::DeviceGradient;
use crate::scene::Scene;
use crate::volume::Volume;

/// A scene with its data on host and device, and the planes that are wanted of it.
pub struct View<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The planes that its picture is to have.
    pub wanted: Wanted,
    /// The volume on the host.
    pub volume: &'a Volume,
    /// Its octree on the host.
    pub octree: &'a Octree,
    /// The view on the device, as casts read it.
    pub inputs: CastInputs<'a>,
    /// How normals are found.
    pub gradient: DeviceGradient<'a>,
}

impl View<'_> {
    /// The sampling step, single precision.
    pub fn step_mm(&self) -> f32 {
        step_mm(&self.scene.sampling, self.volume) as f32
    }

    /// How kernels are to traverse: without skipping they sample everything.
    pub fn traverse(&self) -> u32 {
        let sampling = &self.scene.sampling;
        sampling.skip.then_some(sampling.traverse).number()
    }
}
