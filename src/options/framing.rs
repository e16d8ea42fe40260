//! What a camera without an eye is placed about.

use super::{Fit, SceneOptions};
use crate::error::Result;
use crate::scene::{Filter, Picture};
use crate::subject::Subject;

impl SceneOptions {
    /// Whether the camera depends on what is shown of the volume ([`Subject::content`]).
    pub fn fits_content(&self) -> bool {
        let camera = &self.camera;
        camera.eye.is_none() && camera.fit.unwrap_or_default() == Fit::Content
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
