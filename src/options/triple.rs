//! Three numbers: points, directions, spacings.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;

use super::text_form::text_form;
use crate::error::{Error, Result};
use crate::number_text::{number, numbers};

/// Three finite numbers `x,y,z`: a point or direction in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triple(pub DVec3);

impl FromStr for Triple {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let [x, y, z] = numbers(text)
            .ok_or_else(|| Error::usage(format!("'{text}' is not three numbers x,y,z")))?;
        Ok(Self(DVec3::new(x, y, z)))
    }
}

impl fmt::Display for Triple {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{},{}", self.0.x, self.0.y, self.0.z)
    }
}

/// `--raw-spacing`: one positive spacing for all axes, or three.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpacingMm(pub [f64; 3]);

impl FromStr for SpacingMm {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let spacing = match number(text) {
            Ok(all) => Ok(DVec3::splat(all)),
            Err(_) => text.parse::<Triple>().map(|Triple(each)| each),
        };
        match spacing {
            Ok(s) if s.min_element() > 0.0 => Ok(Self(s.to_array())),
            _ => Err(Error::usage(format!(
                "'{text}' is not a spacing: write one positive number of mm, or three x,y,z"
            ))),
        }
    }
}

impl fmt::Display for SpacingMm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Triple(self.0.into()).fmt(f)
    }
}

text_form!(Triple, SpacingMm);
