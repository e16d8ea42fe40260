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
        #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
        size: ImageSize,

        /// The eye's position in world space, mm (LPS: x to the patient's left, y to posterior, z
        /// to superior)
        #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
        eye: Triple,

        /// The point in the picture's centre [default: the volume's centre]
        #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
        target: Triple,

        /// The direction that is up in the picture, with --eye [default: 0,0,1; when looking along
        /// z that of the views superior and inferior]
        #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
        up: Triple,

        /// Vertical field of view in degrees, before --zoom [default: 30]
        #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
        fov: FovDeg,

        /// Orthographic projection; the picture's height in mm, before --zoom
        #[arg(long, value_name = "HEIGHT_MM", allow_hyphen_values = true)]
        ortho: HeightMm,

        /// The side of the patient on which the eye is: anterior, posterior, left, right, superior
        /// or inferior [default: anterior]
        #[arg(long, value_name = "NAME")]
        view: View,

        /// Turn the eye about the target and the camera's up axis, to the picture's right: from the
        /// anterior view, positive moves it to the patient's left [default: 0]
        #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
        azimuth: AngleDeg,

        /// Then raise the eye toward the picture's top: from the sides, positive moves it toward
        /// the head [default: 0]
        #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
        elevation: AngleDeg,

        /// Then turn the camera clockwise about its line of sight, the picture anticlockwise
        /// [default: 0]
        #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
        roll: AngleDeg,

        /// Magnify the picture by narrowing the lens; without --eye the whole volume's bounding
        /// sphere fits at 1 [default: 1]
        #[arg(long, value_name = "F", allow_hyphen_values = true)]
        zoom: Zoom,

        /// A C-arm's angulation, such as 'LAO 30 CRA 20' (azimuth 30, elevation 20); RAO and CAU
        /// are negative
        #[arg(long, value_name = "ANGLES")]
        carm: CArm,
    }
}

impl CameraOptions {
    const DEFAULT_FOV_DEG: f64 = 30.0;
    /// How far out the eye and the target may be.
    const FAR_MM: f64 = 1e12;
    /// How far from the volume's centre the eye may be, in radii of the bounding sphere: from
    /// farther away rays differ by less than their numbers tell apart.
    const FAR_RADII: f64 = 1e9;

    /// What of a scene file's camera still applies when these are the flags: an eye replaces a
    /// view and a view an eye, each with what turns it; one lens replaces the other. Turning and
    /// zooming go with either.
    pub(super) fn keep_of(&self, mut file: Self) -> Self {
        let replaces_view = self.eye.is_some();
        let replaces_eye = file.eye.is_some() && (self.view.is_some() || self.carm.is_some());
        if replaces_view || replaces_eye {
            file = Self {
                view: None,
                carm: None,
                azimuth: None,
                elevation: None,
                roll: None,
                ..file
            };
        }
        if replaces_eye {
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

    /// The picture's size.
    pub(super) fn size(&self) -> Result<ImageSize> {
        match self.size {
            Some(size) => Ok(size),
            None => ImageSize::new(512, 512),
        }
    }

    /// # Errors
    /// Options that contradict each other, a point too far away.
    pub(super) fn check(&self) -> Result<()> {
        for (key, point) in [("eye", self.eye), ("target", self.target)] {
            if point.is_some_and(|Triple(p)| p.abs().max_element() > Self::FAR_MM) {
                return Err(Error::usage(format!(
                    "'{key}' is too far away: each coordinate must be within -{far:e} to {far:e} mm",
                    far = Self::FAR_MM
                )));
            }
        }
        if self.fov.is_some() && self.ortho.is_some() {
            return Err(Error::usage(
                "'fov' and 'ortho' exclude each other: a picture is perspective or orthographic",
            ));
        }
        let by_view = [("view", self.view.is_some()), ("carm", self.carm.is_some())];
        if self.eye.is_some()
            && let Some((key, _)) = by_view.iter().find(|(_, is)| *is)
        {
            return Err(Error::usage(format!(
                "'eye' and '{key}' exclude each other: both place the eye"
            ))
            .hint("'azimuth', 'elevation', 'roll' and 'zoom' turn and zoom either"));
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
        let size = self.size()?;
        let target = self.target.map_or(subject.center_world, |Triple(p)| p);
        let zoom = self.zoom.map_or(1.0, Zoom::get);
        let fov_deg = self.fov.map_or(Self::DEFAULT_FOV_DEG, FovDeg::get);
        let (eye, up) = match self.eye {
            Some(Triple(eye)) => {
                let up = match self.up {
                    Some(Triple(up)) => up,
                    None => Orientation::default_up(eye - target),
                };
                self.turned(eye, target, up)
            }
            None => {
                let orientation = self.turn(match self.carm {
                    Some(carm) => Orientation::of(View::Anterior)
                        .azimuth(carm.azimuth_deg)
                        .elevation(carm.elevation_deg),
                    None => Orientation::of(self.view.unwrap_or_default()),
                });
                let distance_mm = match self.ortho {
                    // The eye plane clears the volume, wherever the target is.
                    Some(_) => 2.0 * subject.radius_mm + target.distance(subject.center_world),
                    None => fit_distance_mm(subject.radius_mm, fov_deg, size),
                };
                let eye = target + orientation.toward_eye * distance_mm;
                (eye, orientation.up)
            }
        };
        let far_mm = Self::FAR_RADII * subject.radius_mm;
        let distance_mm = eye.distance(subject.center_world);
        if distance_mm > far_mm {
            return Err(Error::usage(format!(
                "the eye is {distance_mm:.1e} mm away from a volume of {:.1e} mm radius: it must be within {far_mm:.1e} mm",
                subject.radius_mm
            ))
            .hint("'ortho' looks from infinitely far away"));
        }
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

    /// By `azimuth`, `elevation` and `roll`, in this order.
    fn turn(&self, orientation: Orientation) -> Orientation {
        let degrees = |angle: Option<AngleDeg>| angle.map_or(0.0, AngleDeg::get);
        orientation
            .azimuth(degrees(self.azimuth))
            .elevation(degrees(self.elevation))
            .roll(degrees(self.roll))
    }

    /// An eye and its up turned about the target; as they are where nothing turns them, or where
    /// they make no camera.
    fn turned(&self, eye: DVec3, target: DVec3, up: DVec3) -> (DVec3, DVec3) {
        let is_still = |angle: Option<AngleDeg>| angle.is_none_or(|angle| angle.get() == 0.0);
        let Some(before) = Orientation::looking(eye - target, up) else {
            return (eye, up);
        };
        let after = self.turn(before);
        match (
            is_still(self.azimuth) && is_still(self.elevation),
            is_still(self.roll),
        ) {
            (true, true) => (eye, up),
            (true, false) => (eye, after.up),
            (false, _) => (target + after.toward_eye * eye.distance(target), after.up),
        }
    }

    /// From filled options.
    pub(in crate::scene) fn camera(&self) -> Result<Camera> {
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
