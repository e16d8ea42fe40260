//! Named views of the patient, and how the camera turns from them.

use glam::{DQuat, DVec3};

use crate::extent::ImageSize;

/// The side of the patient on which the eye is (`--view`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum View {
    /// From the patient's front.
    #[default]
    Anterior,
    /// From the patient's back.
    Posterior,
    /// From the patient's left.
    Left,
    /// From the patient's right.
    Right,
    /// From above the head.
    Superior,
    /// From below the feet.
    Inferior,
}

/// Where the eye is as seen from the target, and what is up: both unit, orthogonal, world space
/// (LPS).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orientation {
    /// The unit direction from the target to the eye.
    pub toward_eye: DVec3,
    /// The unit direction to the picture's top.
    pub up: DVec3,
}

impl Orientation {
    /// The head is up; from above the patient's back is, from below the front: as if the eye had
    /// gone there from the anterior view (and as in 3D Slicer), so that the patient's left is to
    /// the right of the picture.
    pub fn of(view: View) -> Self {
        let (toward_eye, up) = match view {
            View::Anterior => (DVec3::NEG_Y, DVec3::Z),
            View::Posterior => (DVec3::Y, DVec3::Z),
            View::Left => (DVec3::X, DVec3::Z),
            View::Right => (DVec3::NEG_X, DVec3::Z),
            View::Superior => (DVec3::Z, DVec3::Y),
            View::Inferior => (DVec3::NEG_Z, DVec3::NEG_Y),
        };
        Self { toward_eye, up }
    }

    /// The view of an eye in this direction from the target, its `up` made orthogonal; `None` if they
    /// are zero or parallel.
    pub fn looking(toward_eye: DVec3, up: DVec3) -> Option<Self> {
        let toward_eye = toward_eye.try_normalize()?;
        let across = up.try_normalize()?.cross(toward_eye);
        if across.length() < 1e-9 {
            return None;
        }
        Some(Self {
            toward_eye,
            up: toward_eye.cross(across.normalize()),
        })
    }

    /// The up of an eye for which none is given: the head; straight from above or below, where that
    /// is no direction in the picture, as in the views superior and inferior.
    pub fn default_up(toward_eye: DVec3) -> DVec3 {
        let toward_eye = toward_eye.normalize_or_zero();
        if toward_eye.cross(DVec3::Z).length() >= 1e-6 {
            DVec3::Z
        } else if toward_eye.z > 0.0 {
            Self::of(View::Superior).up
        } else {
            Self::of(View::Inferior).up
        }
    }

    /// The eye turned about `up`, to the picture's right when positive: from the anterior view,
    /// to the patient's left.
    #[must_use]
    pub fn azimuth(self, degrees: f64) -> Self {
        let right = self.up.cross(self.toward_eye);
        let (sin, cos) = sin_cos_deg(degrees);
        Self {
            toward_eye: self.toward_eye * cos + right * sin,
            up: self.up,
        }
    }

    /// The eye moved toward `up`, which turns along: no angle is singular.
    #[must_use]
    pub fn elevation(self, degrees: f64) -> Self {
        let (sin, cos) = sin_cos_deg(degrees);
        Self {
            toward_eye: self.toward_eye * cos + self.up * sin,
            up: self.up * cos - self.toward_eye * sin,
        }
    }

    /// The camera turned about its line of sight, clockwise as the eye sees it.
    #[must_use]
    pub fn roll(self, degrees: f64) -> Self {
        let turn = DQuat::from_axis_angle(-self.toward_eye, degrees.to_radians());
        let up = if degrees == 0.0 {
            self.up
        } else {
            turn * self.up
        };
        Self { up, ..self }
    }
}

/// Exact at multiples of 90°.
pub(super) fn sin_cos_deg(degrees: f64) -> (f64, f64) {
    match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    }
}

/// The distance from the eye at which a sphere just fits the picture's smaller side.
pub fn fit_distance_mm(radius_mm: f64, fov_deg: f64, size: ImageSize) -> f64 {
    let half_height = (fov_deg.to_radians() / 2.0).tan();
    let half_side = half_height * size.aspect().min(1.0);
    radius_mm / half_side.atan().sin()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: DVec3, b: DVec3) -> bool {
        a.distance(b) < 1e-12
    }

    #[test]
    fn turning_from_the_front_reaches_the_named_views() {
        let front = Orientation::of(View::Anterior);
        let reached = |o: Orientation, view| {
            let named = Orientation::of(view);
            close(o.toward_eye, named.toward_eye) && close(o.up, named.up)
        };
        assert!(reached(front.azimuth(90.0), View::Left));
        assert!(reached(front.azimuth(-90.0), View::Right));
        assert!(reached(front.azimuth(180.0), View::Posterior));
        assert!(reached(front.elevation(90.0), View::Superior));
        assert!(reached(front.elevation(-90.0), View::Inferior));
        // The control: the other way round is somewhere else.
        assert!(!reached(front.azimuth(-90.0), View::Left));
        assert!(!reached(front.elevation(-90.0), View::Superior));
    }

    #[test]
    fn a_roll_turns_up_toward_the_right() {
        // From the front, the picture's right is the patient's left, +x.
        let rolled = Orientation::of(View::Anterior).roll(90.0);
        assert!(close(rolled.up, DVec3::X));
        assert!(!close(
            Orientation::of(View::Anterior).roll(-90.0).up,
            DVec3::X
        ));
    }

    #[test]
    fn no_elevation_is_singular() {
        for degrees in [-180.0, -90.0, -89.999_999, 0.0, 90.0, 91.0, 180.0, 720.0] {
            let o = Orientation::of(View::Anterior)
                .azimuth(30.0)
                .elevation(degrees);
            assert!((o.toward_eye.length() - 1.0).abs() < 1e-12);
            assert!((o.up.length() - 1.0).abs() < 1e-12);
            assert!(o.up.dot(o.toward_eye).abs() < 1e-12);
        }
    }
}
