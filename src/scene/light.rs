//! The light and how a surface reflects it.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;

use super::{Reflectance, Shininess};
use crate::error::{Error, Result};
use crate::number_text::numbers;

/// A direction in world space, as it was given: of any length but 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction(DVec3);

impl Direction {
    /// Constructs a direction from a vector along it.
    ///
    /// # Errors
    /// Usage: a vector without direction: 0, NaN or infinite.
    pub fn new(vector: DVec3) -> Result<Self> {
        match vector.try_normalize() {
            Some(_) => Ok(Self(vector)),
            None => Err(Error::usage(format!(
                "the vector {vector} has no direction"
            ))),
        }
    }

    /// Returns the unit vector.
    pub fn unit(self) -> DVec3 {
        self.0.normalize()
    }
}

/// One distant white light (`--light`): `headlight`, or the direction toward it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Light {
    /// The light is at the eye: every ray is lit along itself.
    #[default]
    Headlight,
    /// The light is far away.
    Distant {
        /// Points from the scene toward the light.
        toward_light: Direction,
    },
}

impl Light {
    /// Constructs a light far away; `toward_light` points from the scene toward it, in world space.
    ///
    /// # Errors
    /// As [`Direction::new`].
    pub fn distant(toward_light: DVec3) -> Result<Self> {
        Ok(Self::Distant {
            toward_light: Direction::new(toward_light)?,
        })
    }
}

impl FromStr for Light {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if text.trim().eq_ignore_ascii_case("headlight") {
            return Ok(Self::Headlight);
        }
        let toward_light = numbers(text).and_then(|d| Self::distant(d.into()).ok());
        toward_light.ok_or_else(|| {
            Error::usage(format!(
                "'{text}' is not a light: write headlight, or the direction x,y,z toward it"
            ))
        })
    }
}

impl fmt::Display for Light {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Headlight => f.write_str("headlight"),
            Self::Distant {
                toward_light: Direction(DVec3 { x, y, z }),
            } => write!(f, "{x},{y},{z}"),
        }
    }
}

/// The specular term.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reflection {
    /// Phong 1975: `max(r·v, 0)^shininess`, r the mirrored light direction.
    Phong,
    /// Blinn 1977: `max(n·h, 0)^shininess`, h half way between light and viewer.
    BlinnPhong,
}

/// Shading of a point with base colour c: `c·(ambient + diffuse·max(n·l, 0)) + specular·s`.
///
/// Two-sided: the normal is turned to the viewer before anything else.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phong {
    /// The specular term.
    pub reflection: Reflection,
    /// The share of the base colour that is there without light.
    pub ambient: Reflectance,
    /// The share of the base colour that is reflected diffusely.
    pub diffuse: Reflectance,
    /// The strength of the highlight.
    pub specular: Reflectance,
    /// The exponent of the highlight: the larger, the smaller.
    pub shininess: Shininess,
}

impl Default for Phong {
    fn default() -> Self {
        Self {
            reflection: Reflection::Phong,
            ambient: Reflectance::AMBIENT,
            diffuse: Reflectance::DIFFUSE,
            specular: Reflectance::SPECULAR,
            shininess: Shininess::default(),
        }
    }
}
