//! Clip options: where the volume is cut open.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;

use super::group::group;
use super::numbers::{concise, number};
use super::plain::plain;
use super::subject::Subject;
use crate::error::{Error, Result};
use crate::scene::ClipPlane;

group! {
    /// Where the volume is cut open.
    #[derive(serde::Serialize)]
    #[command(next_help_heading = "Clipping")]
    pub struct ClipOptions {
        /// Keep only the points x,y,z (world, mm) where NX*x + NY*y + NZ*z + D is not negative; may
        /// be given up to 64 times, the normal may have any length; a scene file has a list of such
        /// lists [default: the whole volume]
        #[arg(long, value_name = "NX,NY,NZ,D", allow_hyphen_values = true)]
        clip_plane: Vec<ClipPlane>,
    }
}

impl FromStr for ClipPlane {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::usage(format!(
                "'{text}' is not a clip plane: write nx,ny,nz,d, such as 0,0,1,-20 to keep z >= 20 mm"
            ))
        };
        let numbers: Result<Vec<f64>> = text.split(',').map(number).collect();
        match numbers.map_err(|_| wrong())?[..] {
            [x, y, z, d] => Self::new(DVec3::new(x, y, z), d),
            _ => Err(wrong()),
        }
    }
}

impl fmt::Display for ClipPlane {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let DVec3 { x, y, z } = self.normal_world();
        write!(f, "{x},{y},{z},{}", self.offset())
    }
}

plain!(ClipPlane);

impl ClipOptions {
    /// # Errors
    /// More planes than a scene may have.
    pub(super) fn check(&self) -> Result<()> {
        let count = self.planes().len();
        if count > ClipPlane::MOST {
            return Err(Error::usage(format!(
                "{count} clip planes: there may be at most {}",
                ClipPlane::MOST
            )));
        }
        Ok(())
    }

    /// With the default in its place.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub(super) fn filled(self) -> Result<Self> {
        self.check()?;
        Ok(Self {
            clip_plane: Some(self.clip_plane.unwrap_or_default()),
        })
    }

    pub(super) fn planes(&self) -> &[ClipPlane] {
        self.clip_plane.as_deref().unwrap_or_default()
    }

    /// One sentence for each plane that alone cuts all of the volume away.
    pub(super) fn notes(&self, subject: &Subject) -> impl Iterator<Item = String> {
        let cuts_all = |plane: &&ClipPlane| {
            let inmost = subject.center_world - plane.outward_world() * subject.radius_mm;
            let space = glam::DAffine3::from_translation(inmost);
            plane.in_space(space).1 < 0.0
        };
        let planes = self.planes().iter().filter(cuts_all);
        planes.map(|plane| {
            let DVec3 { x, y, z } = plane.normal_world();
            let numbers = [x, y, z, plane.offset()].map(concise).join(",");
            format!("clip-plane = {numbers} keeps nothing of the volume")
        })
    }
}
