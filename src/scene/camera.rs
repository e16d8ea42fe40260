//! The camera: where the eye is, and the world-space ray of a pixel.

use glam::DVec3;

use super::FovDeg;
use super::view::{Orientation, View, fit_distance_mm, sin_cos_deg};
use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::subject::Subject;

/// How rays leave the eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lens {
    /// Rays leave one point.
    Perspective {
        /// The vertical field of view in degrees, in (0, 180).
        fov_deg: f64,
    },
    /// Rays are parallel, and start on the eye plane.
    Orthographic {
        /// The height of the image in mm.
        height_mm: f64,
    },
}

/// A point and a unit direction in world space; `t` along it is mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// The point where the ray starts, mm.
    pub origin_world: DVec3,
    /// The unit direction.
    pub dir_world: DVec3,
}

impl Ray {
    /// The point of the ray at a depth along the view axis of its camera, mm from the eye plane.
    pub fn at_depth(self, camera: &Camera, axial_mm: f64) -> DVec3 {
        let from_eye = self.origin_world - camera.eye_world;
        let ahead = axial_mm - from_eye.dot(camera.forward);
        self.origin_world + self.dir_world * (ahead / self.dir_world.dot(camera.forward))
    }
}

/// A point of a thin lens, by the ray through it: of the rays of a pixel, all of which meet on the focal plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LensPoint {
    /// What its ray gains aside of the pinhole's, to the right and up, per mm along the view axis.
    pub slope: [f64; 2],
    /// How far from the eye the focal plane is along the view axis, mm.
    pub focus_mm: f64,
}

/// An eye with an orthonormal basis: `right = normalize(forward × up)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    eye_world: DVec3,
    target_world: DVec3,
    up_given: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    lens: Lens,
}

impl Camera {
    /// Constructs the camera of a named view in whose picture the subject's content fits, as the command line
    /// places it where nothing else is given. The content is the whole volume unless it was measured
    /// ([`Subject::content`]).
    ///
    /// # Errors
    /// Usage: a volume without extent.
    pub fn of_view(view: View, subject: &Subject, size: ImageSize) -> Result<Self> {
        let orientation = Orientation::of(view);
        let fov_deg = FovDeg::default().get();
        let target = subject.content.sphere.center_world;
        let distance_mm = fit_distance_mm(subject.content.sphere.radius_mm, fov_deg, size);
        let eye = target + orientation.toward_eye * distance_mm;
        Self::look_at(eye, target, orientation.up, Lens::Perspective { fov_deg })
    }

    /// Constructs a camera at an eye that looks at a target, `up` being upward in the picture.
    ///
    /// # Errors
    /// Eye = target, `up` parallel to the view direction, anything not finite, a field of view
    /// outside (0, 180)°, a height that is not positive.
    pub fn look_at(eye_world: DVec3, target_world: DVec3, up: DVec3, lens: Lens) -> Result<Self> {
        if !(eye_world.is_finite() && target_world.is_finite() && up.is_finite()) {
            return Err(Error::usage(
                "the camera's eye, target and up must be finite",
            ));
        }
        let forward = (target_world - eye_world).normalize_or_zero();
        if forward == DVec3::ZERO {
            return Err(Error::usage(format!(
                "the camera's eye and target are the same point {eye_world}"
            )));
        }
        let right = forward.cross(up.normalize_or_zero());
        if right.length() < 1e-9 {
            return Err(Error::usage(format!(
                "the camera's up {up} is zero or parallel to its view direction {forward}"
            )));
        }
        match lens {
            Lens::Perspective { fov_deg } if !(fov_deg > 0.0 && fov_deg < 180.0) => {
                return Err(Error::usage(format!(
                    "the field of view {fov_deg} must lie between 0 and 180 degrees"
                )));
            }
            Lens::Orthographic { height_mm } if !(height_mm > 0.0 && height_mm.is_finite()) => {
                return Err(Error::usage(format!(
                    "the orthographic height {height_mm} mm must be positive"
                )));
            }
            _ => {}
        }
        let right = right.normalize();
        Ok(Self {
            eye_world,
            target_world,
            up_given: up,
            right,
            up: right.cross(forward),
            forward,
            lens,
        })
    }

    /// Turned right-handed by `degrees` about the line through `about_world` along `axis`, a unit
    /// direction in world space (Rodrigues' formula). Quarter turns are exact, and a whole turn is
    /// no turn, to the last bit.
    #[must_use]
    pub fn turned(&self, axis: DVec3, about_world: DVec3, degrees: f64) -> Self {
        let (sin, cos) = sin_cos_deg(degrees);
        if (sin, cos) == (0.0, 1.0) {
            return *self;
        }
        let turned = |v: DVec3| v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos));
        Self {
            eye_world: about_world + turned(self.eye_world - about_world),
            target_world: about_world + turned(self.target_world - about_world),
            up_given: turned(self.up_given),
            right: turned(self.right),
            up: turned(self.up),
            forward: turned(self.forward),
            lens: self.lens,
        }
    }

    /// The point from which the camera sees, world space, mm.
    pub fn eye_world(&self) -> DVec3 {
        self.eye_world
    }

    /// Returns the point that was given for the picture's centre.
    pub fn target_world(&self) -> DVec3 {
        self.target_world
    }

    /// Returns the direction that was given as up: of any length, not at a right angle to the line of sight.
    pub fn up_given(&self) -> DVec3 {
        self.up_given
    }

    /// The unit direction to the picture's right, world space.
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// The unit direction to the picture's top, world space, orthogonal to [`Self::forward`].
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// The unit direction in which the camera looks, world space.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// How rays leave the eye.
    pub fn lens(&self) -> Lens {
        self.lens
    }

    /// Offset of a point of the image from its centre, along right and up, as a multiple of the
    /// lens's half height: tan(fov/2) per mm of forward distance, or height/2 in mm.
    /// `x_px`, `y_px` count from the top left corner; a pixel's centre is at +½.
    fn image_offset(&self, size: ImageSize, x_px: f64, y_px: f64) -> (f64, f64) {
        let half_height = match self.lens {
            Lens::Perspective { fov_deg } => (fov_deg.to_radians() / 2.0).tan(),
            Lens::Orthographic { height_mm } => height_mm / 2.0,
        };
        let height = f64::from(size.height());
        let u = (2.0 * x_px - f64::from(size.width())) / height;
        let v = (height - 2.0 * y_px) / height;
        (u * half_height, v * half_height)
    }

    /// What a point of the lens adds to the rays of the pinhole: to where they leave the eye plane, and to their directions
    /// per mm along the view axis; world space.
    pub fn lens_shift(&self, point: LensPoint) -> [DVec3; 2] {
        let [across, up] = point.slope;
        let slope = self.right * across + self.up * up;
        [slope * -point.focus_mm, slope]
    }

    /// The ray of a point of the image through a point of the lens, as [`Camera::ray`]; it starts on the eye plane.
    pub fn ray_through(&self, size: ImageSize, x_px: f64, y_px: f64, point: LensPoint) -> Ray {
        let Ray {
            origin_world,
            dir_world,
        } = self.ray(size, x_px, y_px);
        let [aside, slope] = self.lens_shift(point);
        let per_mm = dir_world / dir_world.dot(self.forward);
        Ray {
            origin_world: origin_world + aside,
            dir_world: (per_mm + slope).normalize(),
        }
    }

    /// The ray through a point of the image, in pixels from its top left corner: pixel (i,j)'s
    /// own ray is `ray(size, i + 0.5, j + 0.5)`. In perspective it starts at the eye, in
    /// orthographic projection on the eye plane.
    pub fn ray(&self, size: ImageSize, x_px: f64, y_px: f64) -> Ray {
        let (u, v) = self.image_offset(size, x_px, y_px);
        let across = self.right * u + self.up * v;
        match self.lens {
            Lens::Perspective { .. } => Ray {
                origin_world: self.eye_world,
                dir_world: (self.forward + across).normalize(),
            },
            Lens::Orthographic { .. } => Ray {
                origin_world: self.eye_world + across,
                dir_world: self.forward,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn size() -> ImageSize {
        ImageSize::new(200, 100).unwrap()
    }

    #[test]
    fn the_top_row_is_up_and_the_last_column_is_right() {
        let lens = Lens::Perspective { fov_deg: 90.0 };
        let c = Camera::look_at(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, lens).unwrap();
        let top = c.ray(size(), 100.0, 0.0).dir_world;
        assert!(top.distance(DVec3::new(0.0, 1.0, 1.0).normalize()) < 1e-12);
        let right = c.ray(size(), 200.0, 50.0).dir_world;
        assert!(right.distance(DVec3::new(2.0, 1.0, 0.0).normalize()) < 1e-12);
        let middle = c.ray(size(), 100.0, 50.0);
        assert!(middle.dir_world.distance(DVec3::Y) < 1e-12);
    }

    #[test]
    fn orthographic_rays_are_parallel_and_start_on_the_eye_plane() {
        let lens = Lens::Orthographic { height_mm: 10.0 };
        let c = Camera::look_at(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, lens).unwrap();
        let corner = c.ray(size(), 0.0, 100.0);
        assert!(corner.origin_world.distance(DVec3::new(-10.0, -5.0, -5.0)) < 1e-12);
        assert_eq!(corner.dir_world, DVec3::Y);
    }

    #[test]
    fn impossible_cameras_are_refused() {
        let lens = Lens::Perspective { fov_deg: 30.0 };
        assert!(Camera::look_at(DVec3::ONE, DVec3::ONE, DVec3::Z, lens).is_err());
        assert!(Camera::look_at(DVec3::ZERO, DVec3::Z, DVec3::Z, lens).is_err());
        assert!(Camera::look_at(DVec3::NAN, DVec3::Z, DVec3::X, lens).is_err());
        for lens in [
            Lens::Perspective { fov_deg: 0.0 },
            Lens::Perspective { fov_deg: 180.0 },
            Lens::Perspective { fov_deg: f64::NAN },
            Lens::Orthographic { height_mm: 0.0 },
        ] {
            assert!(Camera::look_at(DVec3::ZERO, DVec3::Z, DVec3::X, lens).is_err());
        }
    }
}
