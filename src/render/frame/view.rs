//! The scene and its data, as a picture's schedule of passes gets them.

use crate::error::Result;
use crate::frame::{Layer, Wanted};
use crate::octree::Octree;
use crate::render::abi::{KernelEnum, step_mm};
use crate::render::passes::{CastInputs, Run};
use crate::render::resources::DeviceGradient;
use crate::scene::{Lens, Scene};
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

impl<'a> View<'a> {
    /// The view of rays beside those of the pixels' centres, of whose planes nothing is wanted but what their colours need.
    pub fn of_other_rays(&self) -> Self {
        Self {
            wanted: with_cues(self.scene, Wanted::NONE),
            ..*self
        }
    }

    /// The sampling step, single precision.
    pub fn step_mm(&self) -> f32 {
        step_mm(&self.scene.sampling, self.volume) as f32
    }

    /// The distance of neighbouring rays, mm, at t = 0 and its growth per mm.
    pub fn footprint(&self, run: &Run) -> Result<[f32; 2]> {
        let height = f64::from(self.scene.size.height());
        let (grid, _) = run.picture()?;
        Ok(match self.scene.camera.lens() {
            Lens::Perspective { fov_deg } => {
                let growth = 2.0 * (fov_deg.to_radians() / 2.0).tan() / height;
                [growth * f64::from(grid.base_mm), growth].map(|mm| mm as f32)
            }
            Lens::Orthographic { height_mm } => [(height_mm / height) as f32, 0.0],
        })
    }

    /// How kernels are to traverse: without skipping they sample everything.
    pub fn traverse(&self) -> u32 {
        let sampling = &self.scene.sampling;
        sampling.skip.then_some(sampling.traverse).number()
    }
}

/// Adds the planes that the colours of a scene's rays need: depths, and for colours at the rim of things normals.
pub fn with_cues(scene: &Scene, wanted: Wanted) -> Wanted {
    let cues = scene.depth_cues;
    wanted
        .with_if(cues.is_some(), Layer::Depth)
        .with_if(cues.is_some_and(|cues| cues.rim().is_some()), Layer::Normal)
}
