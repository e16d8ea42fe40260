//! Anti-aliasing: many rays in every pixel.

use std::str::FromStr;

use crate::error::{Error, Result};

/// Rays in every pixel (`--aa N[:adaptive]`): N × N of them, at the centres of as many equal squares; a
/// pixel's colour is their mean, a box filter over its area.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AntiAliasing {
    per_side: u32,
    is_adaptive: bool,
}

impl AntiAliasing {
    /// One ray, through the pixel's centre.
    pub const OFF: Self = Self {
        per_side: 1,
        is_adaptive: false,
    };

    /// The most rays along a pixel's side.
    pub const MAX_PER_SIDE: u32 = 8;

    /// Makes it of the number of rays along a pixel's side, and of whether pixels that look like their
    /// neighbours have one ray alone.
    ///
    /// # Errors
    /// Usage: a number outside 1 to [`Self::MAX_PER_SIDE`].
    pub fn new(per_side: u32, is_adaptive: bool) -> Result<Self> {
        if !(1..=Self::MAX_PER_SIDE).contains(&per_side) {
            return Err(Error::usage(format!(
                "{per_side} x {per_side} rays in a pixel: there may be 1 to {} along each side",
                Self::MAX_PER_SIDE
            )));
        }
        Ok(Self {
            per_side,
            is_adaptive: is_adaptive && per_side > 1,
        })
    }

    /// The number of rays along a pixel's side.
    pub const fn per_side(self) -> u32 {
        self.per_side
    }

    /// The number of rays in a pixel.
    pub const fn rays(self) -> u32 {
        self.per_side * self.per_side
    }

    /// Whether pixels that look like their neighbours have one ray alone.
    pub const fn is_adaptive(self) -> bool {
        self.is_adaptive
    }

    /// Where the rays of a pixel pass it: from its upper left corner, in pixels, row by row.
    pub fn places_px(self) -> impl Iterator<Item = [f64; 2]> {
        let n = self.per_side;
        let at = move |k: u32| (f64::from(k) + 0.5) / f64::from(n);
        (0..n * n).map(move |k| [at(k % n), at(k / n)])
    }
}

impl Default for AntiAliasing {
    fn default() -> Self {
        Self::OFF
    }
}

impl FromStr for AntiAliasing {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::usage(format!(
                "'{text}' is not an anti-aliasing: write N or N:adaptive, N from 1 to {}",
                Self::MAX_PER_SIDE
            ))
        };
        let (number, adaptive) = match text.split_once(':') {
            Some((number, how)) if how.trim().eq_ignore_ascii_case("adaptive") => (number, true),
            Some(_) => return Err(wrong()),
            None => (text, false),
        };
        let per_side = number.trim().parse().map_err(|_| wrong())?;
        Self::new(per_side, adaptive).map_err(|_| wrong())
    }
}

impl std::fmt::Display for AntiAliasing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.per_side)?;
        if self.is_adaptive {
            f.write_str(":adaptive")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_stand_in_the_middles_of_equal_squares() {
        let places: Vec<[f64; 2]> = AntiAliasing::new(2, false).unwrap().places_px().collect();
        assert_eq!(
            places,
            [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]]
        );
        assert_eq!(
            AntiAliasing::OFF.places_px().collect::<Vec<_>>(),
            [[0.5, 0.5]]
        );
    }

    #[test]
    fn what_is_written_is_read_and_nothing_else() {
        for text in ["1", "4", "8:adaptive"] {
            assert_eq!(text.parse::<AntiAliasing>().unwrap().to_string(), text);
        }
        assert_eq!(
            "1:adaptive".parse::<AntiAliasing>().unwrap(),
            AntiAliasing::OFF
        );
        for wrong in ["0", "9", "4:", "4:fast", "-1", "two", "1.5"] {
            assert!(wrong.parse::<AntiAliasing>().is_err(), "{wrong}");
        }
    }
}
