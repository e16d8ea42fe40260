//! What depends on what the picture shows of the volume: a camera without an eye, and depth cues without a range.

use super::{Fit, SceneOptions};
use crate::error::Result;
use crate::scene::{Filter, Picture};
use crate::subject::Subject;

impl SceneOptions {
    /// Whether the camera, or where near ends and far begins, depends on what is shown of the volume ([`Subject::content`]).
    pub fn depends_on_content(&self) -> bool {
        let camera = &self.camera;
        let is_placed_by_it =
            camera.eye.is_none() && camera.fit.unwrap_or_default() == Fit::Content;
        is_placed_by_it || (self.effects.cue.is_some() && self.effects.cue_range.is_none())
    }

    /// What is shown: the picture, of the field that the filter makes of the voxels.
    ///
    /// # Errors
    /// As those of [`SceneOptions::resolve`] that the picture has.
    pub fn shown(&self, subject: &Subject) -> Result<(Picture, Filter)> {
        let picture = self.picture.clone();
        let resolved = picture.resolve(self.quadrature(), self.effects.phong(), subject)?;
        Ok((resolved.picture, self.sampling.filter.unwrap_or_default()))
    }
}
