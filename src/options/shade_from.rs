//! `--shade-from`: a gradient, as a number or as a share of the volume's range.

use std::fmt;
use std::str::FromStr;

use super::text_form::text_form;
use crate::error::{Error, Result};
use crate::number_text::number;
use crate::scene::ShadedFrom;
use crate::subject::Subject;

/// The gradient from which a medium is shaded fully.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ShadeFrom {
    /// Its magnitude, values per mm; 0: all is shaded fully.
    PerMm(ShadedFrom),
    /// A share of the value range per voxel of the smallest spacing, 0 to 100 percent, as written.
    Percent(f64),
}

impl ShadeFrom {
    /// Returns the gradient of a volume.
    ///
    /// # Errors
    /// Usage: a share of a range that is too steep for a number.
    pub(super) fn resolve(self, subject: &Subject) -> Result<ShadedFrom> {
        match self {
            Self::PerMm(gradient) => Ok(gradient),
            Self::Percent(percent) => {
                let per_mm = subject.range.width() / subject.spacing_mm.min_element();
                ShadedFrom::new(percent / 100.0 * per_mm)
            }
        }
    }
}

impl Default for ShadeFrom {
    fn default() -> Self {
        Self::PerMm(ShadedFrom::default())
    }
}

impl FromStr for ShadeFrom {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let text = text.trim();
        if let Some(percent) = text.strip_suffix('%') {
            let percent = number(percent).ok();
            let percent = percent.filter(|percent| (0.0..=100.0).contains(percent));
            return percent.map(Self::Percent).ok_or_else(|| {
                Error::usage(format!(
                    "'{text}' is not a share of the value range per voxel: write 0% to 100%"
                ))
            });
        }
        let gradient = number(text).map_err(|_| {
            Error::usage(format!(
                "'{text}' is not a gradient: write a number of values per mm, or a share of the value range per voxel such as 5%"
            ))
        })?;
        ShadedFrom::new(gradient).map(Self::PerMm)
    }
}

impl fmt::Display for ShadeFrom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PerMm(gradient) => write!(f, "{gradient}"),
            Self::Percent(percent) => write!(f, "{percent}%"),
        }
    }
}

text_form!(ShadeFrom);
