//! The passes of a picture's own kind, for whichever rays a run has.

use crate::error::{Error, Result};
use crate::gpu::Buffer;
use crate::render::abi::Filling;
use crate::render::passes::{Blocks, Fill, Run, fill_uncast};
use crate::scene::ScreenError;

use super::planes::{Centers, Planes};

/// The passes of one kind of picture, with everything uploaded that they read beside the view.
pub trait Schedule {
    /// Room for the planes that the passes fill.
    ///
    /// # Errors
    /// The device has no room.
    fn planes(&self, run: &Run) -> Result<Planes>;

    /// Puts the launches that fill the planes for the rays of the run at the end of the frame's.
    ///
    /// # Errors
    /// As [`Run::cast`].
    fn cast(&self, run: &mut Run, planes: &mut Planes) -> Result<()>;

    /// Puts the launches at the end that show what only the whole picture tells, when its planes are full. Returns whether they
    /// change what pixels show that were cast.
    ///
    /// # Errors
    /// As [`Run::screen`].
    fn finish(&self, _run: &mut Run, _planes: &mut Planes) -> Result<bool> {
        Ok(false)
    }

    /// Whether what rays show that pass pixels beside their centres depends on the whole picture of those.
    fn needs_centers(&self) -> bool {
        false
    }

    /// As [`Schedule::cast`], of several rays in each of some pixels, beside those of the `centers` of all, which is finished.
    ///
    /// # Errors
    /// As [`Run::cast`].
    fn cast_between(&self, run: &mut Run, _centers: Centers, planes: &mut Planes) -> Result<()> {
        self.cast(run, planes)
    }

    /// Puts the launch at the end that marks the pixels to be cast next, because interpolation in their blocks is not proven
    /// to keep an error; blocks' corners among them.
    ///
    /// # Errors
    /// As [`Run::squares`].
    fn mark_unproven(
        &self,
        run: &mut Run,
        blocks: Blocks,
        error: ScreenError,
        marks: &mut Buffer<u32>,
    ) -> Result<()>;

    /// Puts the launch at the end that marks what becomes of pixels that have had one ray, which the planes hold: to be cast next
    /// where something may pass the pixel that the ray did not see, to be filled where it is proven that many would see
    /// what it did, as cast where what is seen beside it decides.
    ///
    /// # Errors
    /// As [`Run::squares`].
    fn mark_hidden(&self, run: &mut Run, planes: &Planes, marks: &mut Buffer<u32>) -> Result<()>;

    /// Puts the launches at the end that fill the pixels that were not cast, which `marks` tells from others.
    ///
    /// # Errors
    /// As [`Run::screen`].
    fn fill(
        &self,
        run: &mut Run,
        fill: Fill,
        marks: &Buffer<u32>,
        planes: &mut Planes,
    ) -> Result<()> {
        let Planes {
            color,
            layers,
            screen,
            ..
        } = planes;
        let spans = screen.as_mut().map(|screen| &mut screen.spans);
        fill_uncast(run, fill, marks, Some(color), spans, layers)
    }

    /// What pixels are filled with whose blocks [`Schedule::mark_unproven`] has left out.
    fn proven_filling(&self) -> Filling {
        Filling::Blocks
    }

    /// Puts the launches at the end that fill the planes for the rays of the run from hits at the corners of their blocks,
    /// of a kind of picture that blocks are not filled of.
    ///
    /// # Errors
    /// As [`Run::cast`]; the picture has no hits.
    fn interpolate(
        &self,
        _run: &mut Run,
        _marks: &Buffer<u32>,
        _planes: &mut Planes,
    ) -> Result<()> {
        Err(Error::failed("only a surface is interpolated by its hits"))
    }

    /// Room for the planes of what first surfaces hide; `None`: the picture has no surfaces.
    ///
    /// # Errors
    /// The device has no room.
    fn hidden_planes(&self, _run: &Run) -> Result<Option<Planes>> {
        Ok(None)
    }

    /// Puts the launches at the end that fill `hidden` with what the rays of the run see behind the exit of the first vessel that
    /// they meet in `planes`, where `reaches` says that something uneven is near.
    ///
    /// # Errors
    /// As [`Run::cast`]; the picture has no surfaces.
    fn cast_hidden(
        &self,
        _run: &mut Run,
        _reaches: &Buffer<[f32; 4]>,
        _planes: &Planes,
        _hidden: &mut Planes,
    ) -> Result<()> {
        Err(Error::failed("only a surface hides another"))
    }
}
