//! The launches of one frame: the data that all its passes share.

use std::collections::HashMap;
use std::sync::Arc;

use crate::error::Result;
use crate::gpu::{Args, Buffer, Defines, Device, Element, Pass, Timings};
use crate::render::abi::Variant;
use crate::render::resources::{DeviceVoxels, RaySource};

/// The passes of a renderer: each variant is built once, before its first launch.
#[derive(Default)]
pub struct Passes(HashMap<(&'static str, Defines), Arc<Pass>>);

impl Passes {
    /// The pass `name` of `kernels/<folder>` with these constants; a work-item takes a `tile` of pixels.
    pub fn get(
        &mut self,
        folder: &'static str,
        name: &'static str,
        defines: Defines,
        tile: [usize; 2],
    ) -> &Arc<Pass> {
        let pass = self.0.entry((name, defines));
        pass.or_insert_with_key(|(name, defines)| Pass::new(folder, name, defines.clone(), tile))
    }
}

/// The launches of one frame, and the data that all its passes share.
pub struct Run<'a> {
    /// The device that runs them.
    pub device: &'a Device,
    /// Every pass that was launched before.
    pub passes: &'a mut Passes,
    /// The launches of this frame.
    pub timings: &'a mut Timings,
    /// The rays of every launch.
    pub rays: RaySource,
    /// Work-items along x and y of a group; `None`: small square tiles of pixels.
    pub work_group: Option<[usize; 2]>,
    /// The switches that the passes are built for.
    pub variant: Variant,
    /// The voxels, in the variant's storage.
    pub voxels: &'a DeviceVoxels,
}

impl Run<'_> {
    /// The constants of the variant, for work-items that follow its number of rays.
    pub fn defines(&self) -> Defines {
        let lanes = self.variant.lanes;
        self.variant.defines().with("LANES", lanes)
    }

    /// Puts a launch of the pass `name` at the end of the frame's, a ray for every pixel.
    ///
    /// # Errors
    /// The arguments are not those of the pass's first launch.
    pub fn launch(&mut self, name: &'static str, defines: Defines, args: Args) -> Result<()> {
        let tile = self.variant.lanes.tile();
        let pass = self.passes.get("pass", name, defines, tile);
        let launch = pass.launch(self.device, args, self.rays.size(), self.work_group)?;
        self.timings.add(launch);
        Ok(())
    }

    /// Room for one plane of the frame; `what` names it in errors.
    pub fn plane<T: Element>(&self, what: &str) -> Result<Buffer<T>> {
        Buffer::new(self.device, what, self.rays.size().pixels())
    }
}
