//! Camera options: an eye given in world space, or a named view turned and zoomed.

use glam::DVec3;

use super::group::group;
use super::numbers::{AngleDeg, FovDeg, HeightMm, Zoom};
use super::subject::Subject;
use super::values::{CArm, Triple};
use super::words::View;
use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::scene::view::{Orientation, fit_distance_mm};
use crate::scene::{Camera, Lens};

group! {
    /// Where the eye is and how it looks. Lengths in mm, world space LPS.
    #[derive(serde::Serialize)]
    #[command(next_help_heading = "Camera")]
    pub struct CameraOptions {
        /// Width and height of the picture in pixels [default: 512x512]
        #[arg(long, value_name = "WxH")]
        size: ImageSize,

        /// The eye's position in world space, mm (LPS: x to the patient's left, y to posterior, z
        /// to superior)
        #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
        eye: Triple,

        /// The point in the picture's centre [default: the volume's centre]
        #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
        target: Triple,

        /// The direction that is up in the picture, with --eye [default: 0,0,1; 0,-1,0 when
        /// looking along z]
        #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
        up: Triple,

        /// Vertical field of view in degrees, before --zoom [default: 30]
        #[arg(long, value_name = "DEG")]
        fov: FovDeg,

        /// Orthographic projection; the picture's height in mm, before --zoom
        #[arg(long, value_name = "HEIGHT_MM")]
        ortho: HeightMm,

        /// The side of the patient on which the eye is: anterior, posterior, left, right, superior
        /// or inferior [default: anterior]
        #[arg(long, value_name = "NAME")]
        view: View,

        /// Turn the eye about the view's up axis: from the anterior view, positive moves it to the
        /// patient's left [default: 0]
        #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
        azimuth: AngleDeg,

        /// Then raise the eye: positive moves it toward the head [default: 0]
        #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
        elevation: AngleDeg,

        /// Then turn the camera clockwise about its line of sight, the picture anticlockwise
        /// [default: 0]
        #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
        roll: AngleDeg,

        /// Magnify the picture; at 1 the whole volume's bounding sphere fits [default: 1]
        #[arg(long, value_name = "F")]
        zoom: Zoom,

        /// A C-arm's angulation, such as 'LAO 30 CRA 20' (azimuth 30, elevation 20); RAO and CAU
        /// are negative
        #[arg(long, value_name = "ANGLES")]
        carm: CArm,
    }
}

impl CameraOptions {
    const DEFAULT_FOV_DEG: f64 = 30.0;
    /// How far out the eye and the target may be: their distance squared is a number still.
    const FAR_MM: f64 = 1e30;

    /// The keys given that place the eye by a view.
    fn view_keys(&self) -> Vec<&'static str> {
        let given = [
            ("view", self.view.is_some()),
            ("azimuth", self.azimuth.is_some()),
            ("elevation", self.elevation.is_some()),
            ("roll", self.roll.is_some()),
            ("zoom", self.zoom.is_some()),
            ("carm", self.carm.is_some()),
        ];
        given
            .iter()
            .filter(|(_, is)| *is)
            .map(|(key, _)| *key)
            .collect()
    }

    /// What of a scene file's camera still applies when these are the flags: an eye replaces a
    /// view, a view replaces an eye, one lens the other.
    pub(super) fn keep_of(&self, mut file: Self) -> Self {
        if self.eye.is_some() {
            file = Self {
                view: None,
                azimuth: None,
                elevation: None,
                roll: None,
                zoom: None,
                carm: None,
                ..file
            };
        }
        if !self.view_keys().is_empty() {
            (file.eye, file.up) = (None, None);
        }
        if self.carm.is_some() {
            (file.view, file.azimuth, file.elevation) = (None, None, None);
        }
        if self.view.is_some() || self.azimuth.is_some() || self.elevation.is_some() {
            file.carm = None;
        }
        if self.fov.is_some() {
            file.ortho = None;
        }
        if self.ortho.is_some() {
            file.fov = None;
        }
        file
    }

    /// # Errors
    /// Options that contradict each other, a point too far away.
    pub(super) fn check(&self) -> Result<()> {
        for (key, point) in [("eye", self.eye), ("target", self.target)] {
            if point.is_some_and(|Triple(p)| p.abs().max_element() > Self::FAR_MM) {
                return Err(Error::usage(format!(
                    "'{key}' is too far away: each coordinate must be within -1e30 to 1e30 mm"
                )));
            }
        }
        if self.fov.is_some() && self.ortho.is_some() {
            return Err(Error::usage(
                "'fov' and 'ortho' exclude each other: a picture is perspective or orthographic",
            ));
        }
        if self.eye.is_some()
            && let Some(key) = self.view_keys().first()
        {
            return Err(Error::usage(format!(
                "'eye' and '{key}' exclude each other: '{key}' places the eye by a view"
            ))
            .hint("with an eye, 'up' rolls the camera and 'fov' or 'ortho' zooms"));
        }
        if self.up.is_some() && self.eye.is_none() {
            return Err(
                Error::usage("'up' goes with 'eye' alone: a view has an up of its own")
                    .hint("'roll' turns a view about its line of sight"),
            );
        }
        if self.carm.is_some() {
            let given = [
                ("view", self.view.is_some_and(|view| view != View::Anterior)),
                ("azimuth", self.azimuth.is_some()),
                ("elevation", self.elevation.is_some()),
            ];
            if let Some((key, _)) = given.iter().find(|(_, is)| *is) {
                return Err(Error::usage(format!(
                    "'carm' and '{key}' exclude each other: 'carm' is azimuth and elevation from the anterior view"
                )));
            }
        }
        Ok(())
    }

    /// With the eye, target, up and lens worked out and everything else dropped: filling again
    /// changes nothing.
    pub(super) fn filled(self, subject: &Subject) -> Result<Self> {
        self.check()?;
        let size = match self.size {
            Some(size) => size,
            None => ImageSize::new(512, 512)?,
        };
        let target = self.target.map_or(subject.center_world, |Triple(p)| p);
        let zoom = self.zoom.map_or(1.0, Zoom::get);
        let fov_deg = self.fov.map_or(Self::DEFAULT_FOV_DEG, FovDeg::get);
        let (eye, up) = match self.eye {
            Some(Triple(eye)) => {
                let up = match self.up {
                    Some(Triple(up)) => up,
                    None => default_up(target - eye),
                };
                (eye, up)
            }
            None => {
                let orientation = self.orientation();
                let distance_mm = match self.ortho {
                    // The eye plane clears the volume.
                    Some(_) => 2.0 * subject.radius_mm,
                    None => fit_distance_mm(subject.radius_mm, fov_deg, size),
                };
                let eye = target + orientation.toward_eye * distance_mm;
                (eye, orientation.up)
            }
        };
        let (fov, ortho) = match self.ortho {
            Some(height) => (None, Some(HeightMm::new(height.get() / zoom)?)),
            None if zoom == 1.0 => (Some(FovDeg::new(fov_deg)?), None),
            None => {
                let half = (fov_deg.to_radians() / 2.0).tan() / zoom;
                (Some(FovDeg::new(2.0 * half.atan().to_degrees())?), None)
            }
        };
        Ok(Self {
            size: Some(size),
            eye: Some(Triple(eye)),
            target: Some(Triple(target)),
            up: Some(Triple(up)),
            fov,
            ortho,
            ..Self::default()
        })
    }

    fn orientation(&self) -> Orientation {
        let degrees = |angle: Option<AngleDeg>| angle.map_or(0.0, AngleDeg::get);
        let (azimuth_deg, elevation_deg) = match self.carm {
            Some(carm) => (carm.azimuth_deg, carm.elevation_deg),
            None => (degrees(self.azimuth), degrees(self.elevation)),
        };
        Orientation::of(self.view.unwrap_or_default())
            .azimuth(azimuth_deg)
            .elevation(elevation_deg)
            .roll(degrees(self.roll))
    }

    /// From filled options.
    pub(super) fn camera(&self) -> Result<Camera> {
        let lens = match self.ortho {
            Some(height) => Lens::Orthographic {
                height_mm: height.get(),
            },
            None => Lens::Perspective {
                fov_deg: self.fov.map_or(Self::DEFAULT_FOV_DEG, FovDeg::get),
            },
        };
        let point = |triple: Option<Triple>| triple.map_or(DVec3::ZERO, |Triple(p)| p);
        Camera::look_at(point(self.eye), point(self.target), point(self.up), lens)
    }
}

/// The head is up; looking along the body's axis, the patient's front is.
fn default_up(line_of_sight: DVec3) -> DVec3 {
    let across = line_of_sight.normalize_or_zero().cross(DVec3::Z).length();
    if across < 1e-6 {
        DVec3::NEG_Y
    } else {
        DVec3::Z
    }
}
