//! Values of the volume as users write them: numbers, shares of the range, order statistics; and windows,
//! which have two of them.

use std::fmt;
use std::str::FromStr;

use super::text_form::text_form;
use crate::error::{Error, Result};
use crate::number_text::number;
use crate::subject::Subject;

/// A value of the volume: as it is, as a share of the value range, as an order statistic of the
/// voxels, or Otsu's threshold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Threshold {
    /// A physical value, as written.
    Value(f64),
    /// A share of the value range, 0 to 100 percent, as written.
    Percent(f64),
    /// The smallest voxel value that at least this percentage of the voxels do not exceed (the nearest
    /// rank), 0 to 100: 0 is the minimum.
    Percentile(f64),
    /// Otsu's threshold of the voxels (Otsu 1979).
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

/// `--window LO,HI`: the values shown black and white. The first may be the higher one: then what is
/// bright in the volume is dark in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WindowEnds {
    /// The value shown black.
    pub black: Threshold,
    /// The value shown white.
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

text_form!(Threshold, WindowEnds);
