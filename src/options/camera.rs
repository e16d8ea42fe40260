//! Camera options: an eye given in world space, or a named view turned and zoomed.

use glam::DVec3;

use super::carm::CArm;
use super::enum_names::Fit;
use super::group::group;
use super::quantities::{AngleDeg, Zoom};
use super::text_form::text_form;
use super::triple::Triple;
use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::scene::{Camera, FovDeg, HeightMm, Lens, Orientation, View, fit_distance_mm};
use crate::subject::{Sphere, Subject};

text_form!(FovDeg, HeightMm, View);

group! {
    /// Where the eye is and how it looks. Lengths in mm, world space LPS.
    #[derive(serde::Serialize)]
    #[command(next_help_heading = "Camera")]
    pub struct CameraOptions {
        /// Width and height of the picture in pixels
        #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
        size: ImageSize,

        /// The eye's position in world space, mm (LPS: x to the patient's left, y to posterior, z to
        /// superior)
        #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
        eye: Triple,

        /// The point in the picture's centre
        #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
        target: Triple,

        /// The direction that is up in the picture
        #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
        up: Triple,

        /// Vertical field of view in degrees, before --zoom
        #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
        fov: FovDeg,

        /// Orthographic projection; the picture's height in mm, before --zoom
        #[arg(long, value_name = "HEIGHT_MM", allow_hyphen_values = true)]
        ortho: HeightMm,

        /// What fits the picture at zoom 1: volume, the volume's bounding sphere; or content, that of the cells
        /// that can show something: which the surface passes or a cap closes, which absorb (dvr), whose
        /// greatest value is above the window's lower end (mip, lmip); in minip and mean, and where nothing
        /// shows, the volume's. Clip planes do not change it. The eye is as far from the target as the
        /// sphere's radius needs; with --ortho only the target depends on it, with --eye nothing (refused)
        #[arg(long, value_name = "volume|content")]
        fit: Fit,

        /// The side of the patient on which the eye is: anterior, posterior, left, right, superior or
        /// inferior
        #[arg(long, value_name = "NAME")]
        view: View,

        /// Turn the eye about the target and the camera's up axis, to the picture's right: from the
        /// anterior view, positive moves it to the patient's left
        #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
        azimuth: AngleDeg,

        /// Then raise the eye toward the picture's top: from the sides, positive moves it toward the head
        #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
        elevation: AngleDeg,

        /// Then turn the camera clockwise about its line of sight, the picture anticlockwise
        #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
        roll: AngleDeg,

        /// Magnify the picture by narrowing the lens; without --eye what --fit names fits at 1
        #[arg(long, value_name = "F", allow_hyphen_values = true)]
        zoom: Zoom,

        /// A C-arm's angulation, such as 'LAO 30 CRA 20' (azimuth 30, elevation 20); RAO and CAU are
        /// negative
        #[arg(long, value_name = "ANGLES")]
        carm: CArm,
    }
}

impl CameraOptions {
    /// How far out the eye and the target may be.
    const FAR_MM: f64 = 1e12;
    /// How far from the volume's centre the eye may be, in radii of the bounding sphere: from
    /// farther away rays differ by less than their numbers resolve.
    const FAR_RADII: f64 = 1e9;

    /// Checks that no point is too far away.
    ///
    /// # Errors
    /// Usage: one is.
    pub(super) fn check(&self) -> Result<()> {
        for (key, point) in [("eye", self.eye), ("target", self.target)] {
            if point.is_some_and(|Triple(p)| p.abs().max_element() > Self::FAR_MM) {
                return Err(Error::usage(format!(
                    "'{key}' is too far away: each coordinate must be within -{far:e} to {far:e} mm",
                    far = Self::FAR_MM
                )));
            }
        }
        Ok(())
    }

    /// Makes the picture's size and the camera, and the options that make the same: the eye, target, up and
    /// lens worked out and everything else dropped.
    ///
    /// # Errors
    /// Usage: a point too far away; an impossible camera.
    pub(super) fn resolve(self, subject: &Subject) -> Result<(ImageSize, Camera, Self)> {
        self.check()?;
        let size = self.size.unwrap_or(ImageSize::DEFAULT);
        let fitting = self.fitting(subject);
        let target = self.target.map_or(fitting.center_world, |Triple(p)| p);
        let (eye, up) = self.placed(target, fitting, subject.sphere, size);
        Self::check_distance(eye, subject.sphere)?;
        let (lens, of_lens) = self.lens()?;
        let camera = Camera::look_at(eye, target, up, lens)?;
        let options = Self {
            size: Some(size),
            eye: Some(Triple(eye)),
            target: Some(Triple(target)),
            up: Some(Triple(up)),
            ..of_lens
        };
        Ok((size, camera, options))
    }

    /// The sphere that fits the picture at zoom 1 where no eye is given.
    fn fitting(&self, subject: &Subject) -> Sphere {
        match self.fit.unwrap_or_default() {
            Fit::Volume => subject.sphere,
            Fit::Content => subject.content.sphere,
        }
    }

    /// The eye and its up: those given, or of a view, turned, so far away that a sphere of the radius of
    /// `fitting` about the target fits.
    fn placed(
        &self,
        target: DVec3,
        fitting: Sphere,
        volume: Sphere,
        size: ImageSize,
    ) -> (DVec3, DVec3) {
        match self.eye {
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
                    Some(_) => 2.0 * volume.radius_mm + target.distance(volume.center_world),
                    None => {
                        let fov_deg = self.fov.unwrap_or_default().get();
                        fit_distance_mm(fitting.radius_mm, fov_deg, size)
                    }
                };
                let eye = target + orientation.toward_eye * distance_mm;
                (eye, orientation.up)
            }
        }
    }

    /// Checks that an eye is so near that its rays differ.
    fn check_distance(eye: DVec3, volume: Sphere) -> Result<()> {
        let far_mm = Self::FAR_RADII * volume.radius_mm;
        let distance_mm = eye.distance(volume.center_world);
        if distance_mm > far_mm {
            return Err(Error::usage(format!(
                "the eye is {distance_mm:.1e} mm away from a volume of {:.1e} mm radius: it must be within {far_mm:.1e} mm",
                volume.radius_mm
            ))
            .hint("'ortho' looks from infinitely far away"));
        }
        Ok(())
    }

    /// The lens, narrowed by the zoom, and the options that make the same.
    fn lens(&self) -> Result<(Lens, Self)> {
        let zoom = self.zoom.unwrap_or_default().get();
        let none = Self::default();
        if let Some(height) = self.ortho {
            let height = HeightMm::new(height.get() / zoom)?;
            let height_mm = height.get();
            let ortho = Some(height);
            return Ok((Lens::Orthographic { height_mm }, Self { ortho, ..none }));
        }
        let mut fov = self.fov.unwrap_or_default();
        if zoom != 1.0 {
            let half = (fov.get().to_radians() / 2.0).tan() / zoom;
            fov = FovDeg::new(2.0 * half.atan().to_degrees())?;
        }
        let fov_deg = fov.get();
        let fov = Some(fov);
        Ok((Lens::Perspective { fov_deg }, Self { fov, ..none }))
    }

    /// Turns an orientation by `azimuth`, `elevation` and `roll`, in this order.
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
}
