//! A C-arm's angulation.

use std::fmt;
use std::str::FromStr;

use super::text_form::text_form;
use crate::error::{Error, Result};
use crate::number_text::number;

/// `--carm`: a C-arm's angulation, such as `LAO 30 CRA 20`. LAO and CRA are positive, RAO and CAU
/// negative: the eye's azimuth and elevation from the anterior view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CArm {
    /// The angle toward the patient's left, degrees: LAO is positive, RAO negative.
    pub azimuth_deg: f64,
    /// The angle toward the head, degrees: CRA is positive, CAU negative.
    pub elevation_deg: f64,
}

impl FromStr for CArm {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::usage(format!(
                "'{text}' is not a C-arm angulation: write LAO or RAO and CRA or CAU, each with degrees from 0 to 180, such as 'LAO 30 CRA 20'"
            ))
        };
        let mut azimuth_deg = None;
        let mut elevation_deg = None;
        let mut rest = text.trim();
        while !rest.is_empty() {
            let is_letter = |c: char| c.is_ascii_alphabetic();
            let (name, after) = rest.split_at(rest.find(|c| !is_letter(c)).ok_or_else(wrong)?);
            let after = after.trim_start();
            let (degrees, after) = after.split_at(after.find(is_letter).unwrap_or(after.len()));
            let degrees = number(degrees.trim_end_matches([' ', ',', '/', '°'])).ok();
            let degrees = degrees
                .filter(|d| (0.0..=180.0).contains(d))
                .ok_or_else(wrong)?;
            let (axis, signed) = match name.to_ascii_uppercase().as_str() {
                "LAO" => (&mut azimuth_deg, degrees),
                "RAO" => (&mut azimuth_deg, -degrees),
                "CRA" | "CRAN" => (&mut elevation_deg, degrees),
                "CAU" | "CAUD" => (&mut elevation_deg, -degrees),
                _ => return Err(wrong()),
            };
            if axis.replace(signed).is_some() {
                return Err(wrong());
            }
            rest = after;
        }
        if azimuth_deg.is_none() && elevation_deg.is_none() {
            return Err(wrong());
        }
        Ok(Self {
            azimuth_deg: azimuth_deg.unwrap_or(0.0),
            elevation_deg: elevation_deg.unwrap_or(0.0),
        })
    }
}

impl fmt::Display for CArm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = if self.azimuth_deg < 0.0 { "RAO" } else { "LAO" };
        let end = if self.elevation_deg < 0.0 {
            "CAU"
        } else {
            "CRA"
        };
        let (azimuth, elevation) = (self.azimuth_deg.abs(), self.elevation_deg.abs());
        write!(f, "{side} {azimuth} {end} {elevation}")
    }
}

text_form!(CArm);
