//! Shadows: how much of each light reaches a point past the volume itself.

use std::fmt;
use std::str::FromStr;

use super::Mode;
use super::quantities::{LightSizeDeg, ShadowStep};
use crate::error::{Error, Result};

/// Shadows (`--shadows`): what a point reflects of a light, diffusely and as a highlight, is multiplied by the light's
/// visibility V from there.
///
/// V of a surface's point is 0 where the surface lies between it and the light, or where the light is behind the surface,
/// else 1; of a light with a size it is the mean over the disc of directions that the light fills. V of a medium's point
/// is exp(−∫κ) from there to the light or to where the light enters the volume, whichever is nearer. A light at the eye
/// casts no shadow: V = 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shadows {
    /// How visibility is found on a device.
    pub method: ShadowMethod,
    /// The angle that each light fills, seen from any point; of a surface's picture.
    pub light_size: LightSizeDeg,
}

/// How the visibility of a light is found on a device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ShadowMethod {
    /// A ray toward the light, from cell to cell.
    Exact,
    /// A ray toward the light that takes samples so many times as far apart as a ray of the eye does.
    Stepped(ShadowStep),
    /// Optical depths from the light on, interpolated from a grid of so many points a side that is aligned with
    /// the light; a ray toward the light where they are not smooth.
    Cached(GridSide),
}

/// The number of points along the longest side of a grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GridSide(u32);

impl GridSide {
    /// The fewest and the most of them.
    pub const LIMITS: [u32; 2] = [2, 1024];

    /// Returns the number.
    pub const fn get(self) -> u32 {
        self.0
    }
}

impl FromStr for GridSide {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let [least, most] = Self::LIMITS;
        let side = text.trim().parse().ok();
        let side = side.filter(|side| (least..=most).contains(side));
        side.map(Self).ok_or_else(|| {
            Error::usage(format!(
                "'{text}' is not a grid of shadows: write its points along the longest side, from {least} to {most}"
            ))
        })
    }
}

impl Shadows {
    /// Checks that shadows can be found so in a mode.
    ///
    /// # Errors
    /// Usage: they can not.
    pub fn check(self, mode: Mode) -> Result<()> {
        if mode == Mode::Iso && self.method != ShadowMethod::Exact {
            return Err(Error::usage(format!(
                "'shadows' = {} is for mode 'dvr': the shadows of a surface are exact",
                self.method
            ))
            .hint("write --shadows on"));
        }
        if mode != Mode::Iso && self.light_size.get() > 0.0 {
            return Err(Error::usage(format!(
                "'light-size' cannot be combined with mode '{mode}': only a surface's shadows have soft edges"
            ))
            .hint("it belongs to mode iso"));
        }
        Ok(())
    }
}

impl FromStr for ShadowMethod {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let text = text.trim();
        let wrong = || {
            Error::usage(format!(
                "'{text}' is no way to find shadows: write on, step=K, K times the sample step, or cached:N, N points along a grid"
            ))
        };
        if text.eq_ignore_ascii_case("on") {
            return Ok(Self::Exact);
        }
        let is = |name: &str, wanted: &str| name.trim().eq_ignore_ascii_case(wanted);
        match (text.split_once('='), text.split_once(':')) {
            (Some((name, step)), _) if is(name, "step") => Ok(Self::Stepped(step.parse()?)),
            (_, Some((name, side))) if is(name, "cached") => Ok(Self::Cached(side.parse()?)),
            _ => Err(wrong()),
        }
    }
}

impl fmt::Display for ShadowMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exact => f.write_str("on"),
            Self::Stepped(step) => write!(f, "step={step}"),
            Self::Cached(GridSide(side)) => write!(f, "cached:{side}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_nothing_else() {
        for text in ["on", "step=2", "step=0.5", "cached:128"] {
            assert_eq!(text.parse::<ShadowMethod>().unwrap().to_string(), text);
        }
        for (wrong, why) in [
            ("off", "'off' is no way to find shadows"),
            ("step", "no way to find shadows"),
            ("step=0", "a shadow step of 0 is out of its domain"),
            ("step=x", "'x' is not a number"),
            ("cached:1", "'1' is not a grid of shadows"),
            ("cached:2000", "from 2 to 1024"),
            ("cached=64", "no way to find shadows"),
        ] {
            let refused = wrong.parse::<ShadowMethod>().unwrap_err().to_string();
            assert!(refused.contains(why), "{wrong}: {refused}");
        }
    }

    #[test]
    fn a_surface_has_exact_shadows_and_a_medium_no_soft_ones() {
        let of = |method: &str, size| Shadows {
            method: method.parse().unwrap(),
            light_size: LightSizeDeg::new(size).unwrap(),
        };
        assert!(of("on", 5.0).check(Mode::Iso).is_ok());
        assert!(of("cached:64", 0.0).check(Mode::Dvr).is_ok());
        let refused = |shadows: Shadows, mode| shadows.check(mode).unwrap_err().to_string();
        assert!(refused(of("step=2", 0.0), Mode::Iso).contains("step=2 is for mode 'dvr'"));
        assert!(refused(of("on", 5.0), Mode::Dvr).contains("'light-size' cannot be combined"));
    }
}
