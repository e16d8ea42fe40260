//! Sparse casting: rays through some of the pixels, and how the others are filled.

use std::str::FromStr;

use super::Mode;
use crate::error::{Error, Result};

/// How blocks are found that must not be interpolated (`--refill`); their pixels are all cast.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refill {
    /// None is: every pixel off the grid is interpolated.
    None,
    /// Those whose corners differ, once (Lesar et al. 2015, §III-D).
    Gradient,
    /// Those whose corners differ, or whose edges, where a neighbouring block was cast, differ from what would be
    /// interpolated; until there is no further one.
    Flood,
    /// Those that are not proven to be what they would be filled with.
    Certified,
}

impl Refill {
    /// The refill of a mode where neither it nor a threshold is given.
    pub fn of(mode: Mode) -> Self {
        match mode {
            Mode::Iso => Self::Certified,
            _ => Self::Gradient,
        }
    }
}

/// The grid of pixels that are cast whatever they show, and the threshold that may be given with it:
/// `K[:THRESHOLD]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SparseGrid {
    spacing: u32,
    threshold: Option<f64>,
}

impl SparseGrid {
    /// The spacings that a grid may have, in pixels.
    pub const SPACINGS: [u32; 4] = [2, 3, 4, 8];

    /// Makes a grid of every `spacing`-th pixel; the threshold is a difference of channels, from 0 to 1.
    ///
    /// # Errors
    /// Usage: a spacing that is not one of [`Self::SPACINGS`]; a threshold outside its domain.
    pub fn new(spacing: u32, threshold: Option<f64>) -> Result<Self> {
        if !Self::SPACINGS.contains(&spacing) {
            return Err(Error::usage(format!(
                "a grid of every {spacing}th pixel: its spacing must be 2, 3, 4 or 8 pixels"
            )));
        }
        if threshold.is_some_and(|threshold| !(0.0..=1.0).contains(&threshold)) {
            return Err(Error::usage(
                "a threshold of sparse casting is a difference of channels: it must be from 0 to 1",
            ));
        }
        Ok(Self { spacing, threshold })
    }

    /// The threshold, where one is given.
    pub fn threshold(self) -> Option<f64> {
        self.threshold
    }
}

impl FromStr for SparseGrid {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::usage(format!(
                "'{text}' is not a sparse grid: write K or K:THRESHOLD, K being 2, 3, 4 or 8 pixels and THRESHOLD \
                 from 0 to 1"
            ))
        };
        let (spacing, threshold) = match text.split_once(':') {
            Some((spacing, threshold)) => {
                let threshold = threshold.trim().parse().map_err(|_| wrong())?;
                (spacing, Some(threshold))
            }
            None => (text, None),
        };
        let spacing = spacing.trim().parse().map_err(|_| wrong())?;
        Self::new(spacing, threshold).map_err(|_| wrong())
    }
}

impl std::fmt::Display for SparseGrid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.threshold {
            Some(threshold) => write!(f, "{}:{threshold}", self.spacing),
            None => write!(f, "{}", self.spacing),
        }
    }
}

/// Sparse casting (`--sparse`, `--refill`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sparse {
    /// Pixels from one grid line to the next; blocks lie between them.
    pub spacing: u32,
    /// The greatest difference of channels, sRGB-encoded from 0 to 1, by which pixels do not differ.
    pub threshold: f64,
    /// How blocks are found that must not be interpolated.
    pub refill: Refill,
}

impl Sparse {
    /// The threshold where none is given.
    pub const THRESHOLD: f64 = 0.05;

    /// Sparse casting by a grid. Where no refill is given it is gradient for a grid with a threshold, and
    /// otherwise that of the mode ([`Refill::of`]).
    ///
    /// # Errors
    /// Usage: a certified refill in another mode than iso, or with a threshold, of which it has no use.
    pub fn new(grid: SparseGrid, refill: Option<Refill>, mode: Mode) -> Result<Self> {
        let implied = if grid.threshold.is_some() {
            Refill::Gradient
        } else {
            Refill::of(mode)
        };
        let refill = refill.unwrap_or(implied);
        if refill == Refill::Certified && mode != Mode::Iso {
            return Err(Error::usage(format!(
                "'refill' certified cannot be combined with mode '{mode}': only of a surface is it proven what a block shows"
            ))
            .hint("choose gradient or flood"));
        }
        let has_threshold = matches!(refill, Refill::Gradient | Refill::Flood);
        if grid.threshold.is_some() && !has_threshold {
            return Err(Error::usage(format!(
                "'sparse' {grid} has a threshold, of which 'refill' {refill} makes no use"
            ))
            .hint("leave the threshold out, or choose gradient or flood"));
        }
        Ok(Self {
            spacing: grid.spacing,
            threshold: grid.threshold.unwrap_or(Self::THRESHOLD),
            refill,
        })
    }

    /// The grid that makes the same, with its threshold where the refill has one.
    pub fn grid(self) -> SparseGrid {
        let has_threshold = matches!(self.refill, Refill::Gradient | Refill::Flood);
        SparseGrid {
            spacing: self.spacing,
            threshold: has_threshold.then_some(self.threshold),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sparse(grid: &str, refill: Option<Refill>, mode: Mode) -> Result<Sparse> {
        Sparse::new(grid.parse()?, refill, mode)
    }

    #[test]
    fn a_threshold_implies_gradient_and_a_surface_certified() {
        let refill = |grid, mode| sparse(grid, None, mode).unwrap().refill;
        assert_eq!(refill("4", Mode::Iso), Refill::Certified);
        assert_eq!(refill("4:0.1", Mode::Iso), Refill::Gradient);
        assert_eq!(refill("4", Mode::Dvr), Refill::Gradient);
        let flood = sparse("8", Some(Refill::Flood), Mode::Iso).unwrap();
        assert_eq!((flood.spacing, flood.threshold), (8, 0.05));
        assert_eq!(flood.grid().to_string(), "8:0.05");
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        for wrong in ["1", "5", "4:2", "4:", ":0.1", "four", "4:-0.1", "4:NaN"] {
            assert!(wrong.parse::<SparseGrid>().is_err(), "{wrong}");
        }
        assert!(sparse("4", Some(Refill::Certified), Mode::Mip).is_err());
        assert!(sparse("4:0.1", Some(Refill::Certified), Mode::Iso).is_err());
        assert!(sparse("4:0.1", Some(Refill::None), Mode::Iso).is_err());
        // The control.
        assert!(sparse("4", Some(Refill::None), Mode::Mip).is_ok());
    }
}
