//! Values with a text form of their own: thresholds, points, colours, windows, angulations.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;

use super::numbers::number;
use super::plain::plain;
use super::subject::Subject;
use crate::error::{Error, Result};
use crate::scene::Light;

/// A value of the volume: as it is, as a share of the value range, as an order statistic of the
/// voxels, or Otsu's threshold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Threshold {
    Value(f64),
    /// A share of the value range, 0 to 100 percent, as written.
    Percent(f64),
    /// The smallest voxel value that at least this percentage of the voxels do not exceed (the nearest
    /// rank), 0 to 100: 0 is the minimum.
    Percentile(f64),
    Otsu,
}

impl Threshold {
    /// The percentage, where it is an order statistic.
    pub fn percentile(self) -> Option<f64> {
        match self {
            Self::Percentile(percent) => Some(percent),
            _ => None,
        }
    }

    /// The physical value.
    ///
    /// # Errors
    /// Usage: an order statistic, which takes the voxels: [`SceneOptions::measured`] puts its value in
    /// its place.
    ///
    /// [`SceneOptions::measured`]: super::SceneOptions::measured
    pub fn resolve(self, subject: &Subject) -> Result<f64> {
        match self {
            Self::Value(value) => Ok(value),
            Self::Percent(percent) => Ok(subject.range.at(percent / 100.0)),
            Self::Percentile(_) => Err(Error::usage(format!(
                "'{self}' is an order statistic of the voxels, which are not known here"
            ))),
            Self::Otsu => Ok(subject.otsu),
        }
    }
}

impl FromStr for Threshold {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let text = text.trim();
        if text.eq_ignore_ascii_case("otsu") {
            return Ok(Self::Otsu);
        }
        let percentage = |text: &str| {
            let percent = number(text).ok();
            percent.filter(|percent| (0.0..=100.0).contains(percent))
        };
        if let Some(percent) = text.strip_suffix('%') {
            return percentage(percent).map(Self::Percent).ok_or_else(|| {
                Error::usage(format!(
                    "'{text}' is not a share of the value range: write 0% to 100%"
                ))
            });
        }
        if let Some(percent) = text.strip_prefix(['p', 'P']) {
            return percentage(percent).map(Self::Percentile).ok_or_else(|| {
                Error::usage(format!(
                    "'{text}' is not a percentile of the voxels: write p0 to p100, such as p99.5"
                ))
            });
        }
        let value = number(text).map_err(|_| {
            Error::usage(format!(
                "'{text}' is not a value: write a number, a share of the value range such as 50%, a percentile of the voxels such as p99.5, or otsu"
            ))
        })?;
        // As far as single precision goes: no voxel lies beyond.
        if value.abs() > f64::from(f32::MAX) {
            return Err(Error::usage(format!(
                "'{text}' is beyond every volume's values: write a number within -3.4e38 to 3.4e38"
            )));
        }
        Ok(Self::Value(value))
    }
}

impl fmt::Display for Threshold {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value(value) => write!(f, "{value}"),
            Self::Percent(percent) => write!(f, "{percent}%"),
            Self::Percentile(percent) => write!(f, "p{percent}"),
            Self::Otsu => f.write_str("otsu"),
        }
    }
}

/// Three finite numbers `x,y,z`: a point or direction in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triple(pub DVec3);

impl FromStr for Triple {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || Error::usage(format!("'{text}' is not three numbers x,y,z"));
        let numbers: Result<Vec<f64>> = text.split(',').map(number).collect();
        match numbers.map_err(|_| wrong())?[..] {
            [x, y, z] => Ok(Self(DVec3::new(x, y, z))),
            _ => Err(wrong()),
        }
    }
}

impl fmt::Display for Triple {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{},{}", self.0.x, self.0.y, self.0.z)
    }
}

/// An sRGB-encoded colour, channels 0..1: `r,g,b`, `#rrggbb`, `#rgb`, or one of CSS's colour names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SrgbColor(pub [f64; 3]);

impl FromStr for SrgbColor {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::usage(format!(
                "'{text}' is not a colour: write r,g,b from 0 to 1, #rrggbb, #rgb, or a colour's CSS name such as white"
            ))
        };
        let text = text.trim();
        let is_hex = text.starts_with('#') && matches!(text.len(), 4 | 7);
        let is_name = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_alphabetic());
        if is_hex || is_name {
            // Of what CSS writes more than that, nothing is an opaque colour by its name.
            let color = text.parse::<csscolorparser::Color>().map_err(|_| wrong())?;
            let [r, g, b, alpha] = color.to_rgba8();
            let opaque = alpha == u8::MAX;
            let channels = opaque.then_some([r, g, b]).ok_or_else(wrong)?;
            return Ok(Self(channels.map(|byte| f64::from(byte) / 255.0)));
        }
        let Triple(rgb) = text.parse().map_err(|_| wrong())?;
        if rgb.min_element() < 0.0 || rgb.max_element() > 1.0 {
            return Err(wrong());
        }
        Ok(Self(rgb.to_array()))
    }
}

impl fmt::Display for SrgbColor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "{r},{g},{b}")
    }
}

/// `--light`: `headlight`, or the direction toward a distant light, of any length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightChoice {
    Headlight,
    Toward(DVec3),
}

impl LightChoice {
    pub fn light(self) -> Light {
        match self {
            Self::Headlight => Light::Headlight,
            Self::Toward(direction) => Light::Distant {
                toward_light: direction.normalize(),
            },
        }
    }
}

impl FromStr for LightChoice {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if text.trim().eq_ignore_ascii_case("headlight") {
            return Ok(Self::Headlight);
        }
        let direction = text.parse::<Triple>().map(|Triple(d)| d);
        match direction {
            Ok(d) if d.try_normalize().is_some() => Ok(Self::Toward(d)),
            _ => Err(Error::usage(format!(
                "'{text}' is not a light: write headlight, or the direction x,y,z toward it"
            ))),
        }
    }
}

impl fmt::Display for LightChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Headlight => f.write_str("headlight"),
            Self::Toward(direction) => Triple(*direction).fmt(f),
        }
    }
}

/// `--window LO,HI`: the values shown black and white. The first may be the higher one: then what is
/// bright in the volume is dark in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WindowEnds {
    pub black: Threshold,
    pub white: Threshold,
}

impl FromStr for WindowEnds {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let Some((black, white)) = text.split_once(',') else {
            return Err(Error::usage(format!(
                "'{text}' is not a window: write LO,HI, such as 100,500, 5%,60% or p1,p99.5"
            )));
        };
        Ok(Self {
            black: black.parse()?,
            white: white.parse()?,
        })
    }
}

impl fmt::Display for WindowEnds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}", self.black, self.white)
    }
}

/// `--carm`: a C-arm's angulation, such as `LAO 30 CRA 20`. LAO and CRA are positive, RAO and CAU
/// negative: the eye's azimuth and elevation from the anterior view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CArm {
    pub azimuth_deg: f64,
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

plain!(
    Threshold,
    Triple,
    SrgbColor,
    LightChoice,
    WindowEnds,
    CArm,
    SpacingMm
);
