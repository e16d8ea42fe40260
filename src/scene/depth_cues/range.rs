//! Where near begins and far ends.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;

use super::super::camera::{Camera, Lens};
use crate::error::{Error, Result};
use crate::number_text::number;
use crate::subject::{Content, Corners};

/// The depths between which cues tell near from far, mm: of what is nearest, and of what is farthest and lies behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthRange {
    near_mm: f64,
    far_mm: f64,
}

impl DepthRange {
    /// Constructs it from two distances along rays, from the eye or from the eye plane of a parallel camera.
    ///
    /// # Errors
    /// Usage: a negative or infinite distance; nothing between them.
    pub fn new(near_mm: f64, far_mm: f64) -> Result<Self> {
        if near_mm >= 0.0 && far_mm > near_mm && far_mm.is_finite() {
            return Ok(Self { near_mm, far_mm });
        }
        Err(Error::usage(format!(
            "no depths lie between {near_mm} and {far_mm} mm: write NEAR,FAR, the smaller first, from 0"
        )))
    }

    /// Between the ends of what a picture can show, as far as it lies in front of the eye: the nearest and the farthest depth that
    /// both its sphere and its box may have.
    ///
    /// # Errors
    /// Usage: it lies behind the eye or is a point.
    pub fn of_content(content: Content, camera: &Camera) -> Result<Self> {
        let axial_mm = |point: DVec3| (point - camera.eye_world()).dot(camera.forward());
        // Along a ray the depth is at least that along the view axis.
        let depth_mm = |point: DVec3| match camera.lens() {
            Lens::Perspective { .. } => point.distance(camera.eye_world()),
            Lens::Orthographic { .. } => axial_mm(point),
        };
        let Content {
            sphere,
            corners: Corners(corners),
        } = content;
        let center_mm = depth_mm(sphere.center_world);
        let of_sphere = [center_mm - sphere.radius_mm, center_mm + sphere.radius_mm];
        let nearest_mm = corners
            .map(axial_mm)
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        let farthest_mm = corners.map(depth_mm).into_iter().fold(0.0, f64::max);
        let near_mm = of_sphere[0].max(nearest_mm).max(0.0);
        Self::new(near_mm, of_sphere[1].min(farthest_mm)).map_err(|_| {
            Error::usage("nothing that the picture can show lies in front of the eye, so that depth cues have no range")
                .hint("give one with 'cue-range', or turn the camera")
        })
    }

    /// The depth where near begins, mm.
    pub fn near_mm(self) -> f64 {
        self.near_mm
    }

    /// The depth where far ends, mm.
    pub fn far_mm(self) -> f64 {
        self.far_mm
    }

    /// The share of the way from near to far that a depth has, from 0 to 1.
    pub fn share(self, depth_mm: f64) -> f64 {
        ((depth_mm - self.near_mm) / (self.far_mm - self.near_mm)).clamp(0.0, 1.0)
    }
}

impl FromStr for DepthRange {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let Some((near, far)) = text.split_once(',') else {
            return Err(Error::usage(format!(
                "'{text}' is no range of depths: write NEAR,FAR in mm"
            )));
        };
        Self::new(number(near)?, number(far)?)
    }
}

impl fmt::Display for DepthRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}", self.near_mm, self.far_mm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::subject::Sphere;

    #[test]
    fn ranges_go_from_near_to_far() {
        let range: DepthRange = "10,20.5".parse().unwrap();
        assert_eq!(range.to_string(), "10,20.5");
        for (wrong, why) in [
            ("5", "'5' is no range of depths"),
            ("7,5", "no depths lie between 7 and 5 mm"),
            ("-1,5", "no depths lie between -1 and 5 mm"),
            ("5,5", "no depths lie between"),
        ] {
            let refused = wrong.parse::<DepthRange>().unwrap_err().to_string();
            assert!(refused.contains(why), "{wrong}: {refused}");
        }
    }

    #[test]
    fn the_range_of_content_is_what_lies_of_it_in_front() {
        let eye = DVec3::new(0.0, -100.0, 0.0);
        let looking = |lens| Camera::look_at(eye, DVec3::ZERO, DVec3::Z, lens).unwrap();
        let camera = looking(Lens::Perspective { fov_deg: 30.0 });
        let around = |y: f64, radius_mm: f64| {
            Content::around(Sphere {
                center_world: DVec3::new(0.0, y, 0.0),
                radius_mm,
            })
        };
        let ends = |content, camera| {
            let range = DepthRange::of_content(content, camera).unwrap();
            (range.near_mm(), range.far_mm())
        };
        assert_eq!(ends(around(0.0, 30.0), &camera), (70.0, 130.0));
        assert_eq!(ends(around(0.0, 130.0), &camera), (0.0, 230.0));
        // A flat box in the sphere is nearer to what is seen of it.
        let (half, place) = (DVec3::new(20.0, 5.0, 20.0), |corner| corner);
        let flat = Content {
            corners: Corners::between(-half, half, place),
            ..around(0.0, 30.0)
        };
        let (near, far) = ends(flat, &camera);
        assert_eq!(near, 95.0);
        assert!((far - DVec3::new(20.0, 105.0, 20.0).length()).abs() < 1e-9);
        let parallel = looking(Lens::Orthographic { height_mm: 10.0 });
        assert_eq!(ends(flat, &parallel), (95.0, 105.0));
        assert!(DepthRange::of_content(around(-200.0, 30.0), &parallel).is_err());
    }
}
