//! The launches of one frame: the data that all its passes share.

use std::collections::HashMap;
use std::sync::Arc;

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::gpu::{Args, Buffer, Defines, Device, Element, Pass, Timings};
use crate::render::abi::{KernelEnum, Lanes, RayGrid, Variant};
use crate::render::resources::{DeviceVoxels, RaySource};

/// The passes of a renderer: each variant is built once, before its first launch.
#[derive(Default)]
pub struct Passes(HashMap<(&'static str, Defines), Arc<Pass>>);

impl Passes {
    /// The pass `name` of `kernels/pass` with these constants; a work-item takes a `tile` of pixels.
    pub fn get(&mut self, name: &'static str, defines: Defines, tile: [usize; 2]) -> &Arc<Pass> {
        let pass = self.0.entry((name, defines));
        pass.or_insert_with_key(|(name, defines)| Pass::new("pass", name, defines.clone(), tile))
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
    /// Whether launches are only announced: their passes are built before the frame's first launch, but not
    /// launched.
    pub announcing: bool,
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

    /// Puts a launch of a cast at the end of the frame's: the pass `name`, for every ray of the source.
    ///
    /// # Errors
    /// The arguments are not those of the pass's first launch.
    pub fn cast(&mut self, name: &'static str, defines: Defines, args: Args) -> Result<()> {
        let (size, tile) = self.rays.launch_size(self.variant.lanes)?;
        let defines = defines.with("RAYS", self.rays.kind().number());
        self.launch(name, defines, args, size, tile)
    }

    /// The same where a work-item takes one ray, whatever the variant's number.
    ///
    /// # Errors
    /// As [`Run::cast`].
    pub fn cast_singly(&mut self, name: &'static str, defines: Defines, args: Args) -> Result<()> {
        let (size, tile) = self.rays.launch_size(Lanes::ONE)?;
        let defines = defines.with("RAYS", self.rays.kind().number());
        self.launch(name, defines, args, size, tile)
    }

    /// Begins the arguments of a screen pass: one that runs over all pixels of the picture, whichever have
    /// rays.
    ///
    /// # Errors
    /// The rays belong to no picture.
    pub fn screen_args(&self) -> Result<Args> {
        let (grid, _) = self.picture()?;
        Ok(Args::new().value("rays", grid))
    }

    /// Puts a launch of a screen pass at the end of the frame's.
    ///
    /// # Errors
    /// As [`Run::cast`]; the rays belong to no picture.
    pub fn screen(&mut self, name: &'static str, defines: Defines, args: Args) -> Result<()> {
        let (_, size) = self.picture()?;
        self.launch(name, defines, args, size, self.variant.lanes.tile())
    }

    /// The constants of the variant, for work-items that are no tiles of rays.
    pub fn scalar_defines(&self) -> Defines {
        self.variant.defines().with("LANES", Lanes::ONE)
    }

    /// Puts a launch at the end of the frame's whose work-items each take a square of `side` pixels of the picture.
    ///
    /// # Errors
    /// As [`Run::screen`].
    pub fn squares(
        &mut self,
        name: &'static str,
        defines: Defines,
        args: Args,
        side: u32,
    ) -> Result<()> {
        let (_, size) = self.picture()?;
        let count = |pixels: u32| pixels.div_ceil(side);
        let squares = ImageSize::new(count(size.width()), count(size.height()))?;
        self.items(name, defines, args, squares)
    }

    /// Puts a launch at the end of the frame's of so many work-items.
    ///
    /// # Errors
    /// The arguments are not those of the pass's first launch.
    pub fn items(
        &mut self,
        name: &'static str,
        defines: Defines,
        args: Args,
        items: ImageSize,
    ) -> Result<()> {
        self.launch(name, defines, args, items, [1, 1])
    }

    /// The rays of all pixels of the picture, and its size.
    ///
    /// # Errors
    /// The rays belong to no picture.
    pub fn picture(&self) -> Result<(&RayGrid, ImageSize)> {
        let none = || Error::failed("rays that are given one by one make no picture");
        self.rays.picture().ok_or_else(none)
    }

    fn launch(
        &mut self,
        name: &'static str,
        defines: Defines,
        args: Args,
        size: ImageSize,
        tile: [usize; 2],
    ) -> Result<()> {
        let pass = self.passes.get(name, defines, tile);
        let launch = pass.launch(self.device, args, size, self.work_group)?;
        if self.announcing {
            self.timings.announce(&launch);
        } else {
            self.timings.add(launch);
        }
        Ok(())
    }

    /// Room for one plane of the frame; `what` names it in errors. Where no ray writes it, it is `empty`.
    ///
    /// # Errors
    /// The device has no room.
    pub fn plane<T: Element>(&self, what: &str, empty: T) -> Result<Buffer<T>> {
        self.rays.plane(self.device, what, empty)
    }
}
