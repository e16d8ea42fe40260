//! Clip options: where the volume is cut open.

use super::group::group;
use super::text_form::text_form;
use crate::error::{Error, Result};
use crate::scene::ClipPlane;

text_form!(ClipPlane);

group! {
    /// Where the volume is cut open.
    #[derive(serde::Serialize)]
    #[command(next_help_heading = "Clipping")]
    pub struct ClipOptions {
        /// Keep only the points x,y,z (world, mm) where NX*x + NY*y + NZ*z + D is not negative; may be
        /// given up to 64 times, the normal may have any length; a scene file has a list of such lists
        #[arg(long, value_name = "NX,NY,NZ,D", allow_hyphen_values = true)]
        clip_plane: Vec<ClipPlane>,
    }
}

impl ClipOptions {
    /// Checks the number of planes.
    ///
    /// # Errors
    /// Usage: more planes than a scene may have.
    pub(super) fn check(&self) -> Result<()> {
        let count = self.planes().len();
        if count > ClipPlane::MAX_COUNT {
            return Err(Error::usage(format!(
                "{count} clip planes: there may be at most {}",
                ClipPlane::MAX_COUNT
            )));
        }
        Ok(())
    }

    /// Makes the planes, and the options that make the same.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub(super) fn resolve(self) -> Result<(Vec<ClipPlane>, Self)> {
        self.check()?;
        let planes = self.clip_plane.unwrap_or_default();
        let options = Self {
            clip_plane: Some(planes.clone()),
        };
        Ok((planes, options))
    }

    fn planes(&self) -> &[ClipPlane] {
        self.clip_plane.as_deref().unwrap_or_default()
    }
}
