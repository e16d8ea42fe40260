//! The passes of a picture's own kind, for whichever rays a run has.

use crate::error::Result;
use crate::gpu::Buffer;
use crate::render::passes::{Filling, Run, fill_uncast};

use super::planes::Planes;

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

    /// Puts the launches at the end that fill the pixels that were not cast, which `marks` tells from others.
    ///
    /// # Errors
    /// As [`Run::screen`].
    fn fill(
        &self,
        run: &mut Run,
        filling: Filling,
        marks: &Buffer<u32>,
        planes: &mut Planes,
    ) -> Result<()> {
        let Planes { color, layers, .. } = planes;
        fill_uncast(run, filling, marks, Some(color), layers)
    }
}
