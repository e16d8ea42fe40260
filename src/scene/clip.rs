//! Planes that cut the volume open.

use std::fmt;
use std::str::FromStr;

use glam::{DAffine3, DVec3};

use crate::error::{Error, Result};
use crate::number_text::numbers;

/// A half-space that is kept: the points p (world, mm) with `n·p + d ≥ 0`, those of the plane
/// itself included. The normal n points to the kept side and has any length (Yuan 2009, §3.4).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClipPlane {
    normal_world: DVec3,
    offset: f64,
}

impl ClipPlane {
    /// The maximum number of planes of a scene.
    pub const MAX_COUNT: usize = 64;

    /// Makes a half-space of a normal of any length and an offset, mm times the normal's length.
    ///
    /// # Errors
    /// A normal without direction; a number that is not finite.
    pub fn new(normal_world: DVec3, offset: f64) -> Result<Self> {
        if !(normal_world.is_finite() && offset.is_finite()) {
            return Err(Error::usage(
                "a clip plane's numbers nx,ny,nz,d must be finite",
            ));
        }
        if normal_world == DVec3::ZERO {
            return Err(Error::usage(
                "a clip plane's normal 0,0,0 has no direction: nx,ny,nz must point to the side that is kept",
            ));
        }
        Ok(Self {
            normal_world,
            offset,
        })
    }

    /// n, as it was given.
    pub fn normal_world(self) -> DVec3 {
        self.normal_world
    }

    /// d, as it was given.
    pub fn offset(self) -> f64 {
        self.offset
    }

    /// The unit normal of a cap: away from the kept side.
    pub fn outward_world(self) -> DVec3 {
        -self.scaled().0.normalize()
    }

    /// The plane's n and d in another space, n's largest component ±1. A plane too far away for a
    /// number is infinitely far, on its own side.
    pub fn in_space(self, world_from_space: DAffine3) -> (DVec3, f64) {
        let (normal, offset) = self.scaled();
        let height = normal.dot(world_from_space.translation) + offset;
        let normal = world_from_space.matrix3.transpose() * normal;
        let largest = normal.abs().max_element();
        (normal / largest, height / largest)
    }

    /// The plane scaled so that n's largest component is ±1: no square of it vanishes or overflows.
    fn scaled(self) -> (DVec3, f64) {
        let largest = self.normal_world.abs().max_element();
        (self.normal_world / largest, self.offset / largest)
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
        match numbers(text) {
            Some([x, y, z, d]) => Self::new(DVec3::new(x, y, z), d),
            None => Err(wrong()),
        }
    }
}

impl fmt::Display for ClipPlane {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let DVec3 { x, y, z } = self.normal_world();
        write!(f, "{x},{y},{z},{}", self.offset())
    }
}
