//! Sparse casting: rays through some of the pixels, and how the others are filled.

use std::str::FromStr;

use super::{Mode, ScreenError};
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
    /// Those that are not proven to be, within an error, what they would be filled with.
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

    /// Whether blocks are found by how much pixels differ.
    fn has_threshold(self) -> bool {
        matches!(self, Self::Gradient | Self::Flood)
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

/// Sparse casting (`--sparse`, `--refill`, `--screen-error`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sparse {
    /// Pixels from one grid line to the next, or where the refill is certified along the edge of the widest blocks that
    /// are interpolated.
    pub spacing: u32,
    /// The greatest difference of channels, sRGB-encoded from 0 to 1, by which pixels do not differ.
    pub threshold: f64,
    /// How blocks are found that must not be interpolated.
    pub refill: Refill,
    /// How much pixels may be wrong that a certified refill interpolates.
    pub screen_error: ScreenError,
}

impl Sparse {
    /// The threshold where none is given.
    pub const THRESHOLD: f64 = 0.05;

    /// The widest blocks of a certified refill where no grid is given, in pixels.
    pub const WIDEST: u32 = 8;

    /// The error of a surface's depth where none is given, in voxels.
    pub const SURFACE_ERROR: f64 = 0.05;

    /// Sparse casting by a grid, or by an error alone. Where no refill is given it is certified within an error that is
    /// given, otherwise gradient for a grid with a threshold, otherwise that of the mode ([`Refill::of`]).
    ///
    /// # Errors
    /// Usage: a certified refill in another mode than iso without an error, an error with another refill, or a threshold
    /// of which the refill has no use.
    pub fn new(
        grid: Option<SparseGrid>,
        refill: Option<Refill>,
        error: Option<ScreenError>,
        mode: Mode,
    ) -> Result<Self> {
        let threshold = grid.and_then(SparseGrid::threshold);
        let implied = match (error, threshold) {
            (Some(_), _) => Refill::Certified,
            (None, Some(_)) => Refill::Gradient,
            (None, None) => Refill::of(mode),
        };
        let refill = refill.unwrap_or(implied);
        if refill == Refill::Certified && mode != Mode::Iso && error.is_none() {
            return Err(Error::usage(format!(
                "'refill' certified in mode '{mode}' needs 'screen-error', the error within which blocks are interpolated"
            ))
            .hint("give it, or choose gradient or flood"));
        }
        if refill != Refill::Certified && error.is_some() {
            return Err(Error::usage(format!(
                "'screen-error' and 'refill' {refill} cannot be combined: only what is certified keeps an error"
            ))
            .hint("leave one of the two out"));
        }
        if let (Some(grid), Some(_)) = (grid, threshold)
            && !refill.has_threshold()
        {
            return Err(Error::usage(format!(
                "'sparse' {grid} has a threshold, of which 'refill' {refill} makes no use"
            ))
            .hint("leave the threshold out, or choose gradient or flood"));
        }
        let of_surface = ScreenError::new(Self::SURFACE_ERROR)?;
        Ok(Self {
            spacing: grid.map_or(Self::WIDEST, |grid| grid.spacing),
            threshold: threshold.unwrap_or(Self::THRESHOLD),
            refill,
            screen_error: error.unwrap_or(of_surface),
        })
    }

    /// The grid that makes the same, with its threshold where the refill has one.
    pub fn grid(self) -> SparseGrid {
        SparseGrid {
            spacing: self.spacing,
            threshold: self.refill.has_threshold().then_some(self.threshold),
        }
    }

    /// The error that makes the same, where the refill keeps one.
    pub fn kept_error(self) -> Option<ScreenError> {
        (self.refill == Refill::Certified).then_some(self.screen_error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sparse(grid: &str, refill: Option<Refill>, mode: Mode) -> Result<Sparse> {
        Sparse::new(Some(grid.parse()?), refill, None, mode)
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

    #[test]
    fn an_error_implies_certified_and_nothing_else_keeps_it() {
        let error = Some(ScreenError::new(0.01).unwrap());
        let of = |grid: Option<&str>, refill, mode| {
            let grid = grid.map(str::parse).transpose()?;
            Sparse::new(grid, refill, error, mode)
        };
        for mode in [Mode::Iso, Mode::Mip, Mode::Dvr] {
            let alone = of(None, None, mode).unwrap();
            assert_eq!((alone.spacing, alone.refill), (8, Refill::Certified));
            assert_eq!(alone.kept_error(), error);
            assert_eq!(of(Some("4"), None, mode).unwrap().spacing, 4);
            assert!(of(Some("4"), Some(Refill::Flood), mode).is_err());
            assert!(of(Some("4:0.1"), None, mode).is_err());
        }
        let surface = sparse("4", None, Mode::Iso).unwrap();
        assert_eq!(surface.kept_error().unwrap().get(), 0.05);
        assert_eq!(sparse("4", None, Mode::Mip).unwrap().kept_error(), None);
    }
}
