//! How much of a picture's error is banding: alike in neighbouring pixels, so that the eye sees its shape.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::frame::Frame;

/// The error of a picture's brightness, parted into what neighbouring pixels share and what they do not.
///
/// The error of a pixel is the mean difference of its channels, sRGB-encoded from 0 to 1. Bands are
/// errors that change slowly along the picture: their neighbours' correlation is near 1, and the mean of a square of
/// pixels has as much of them as the pixels themselves. What changes from pixel to pixel has a correlation near 0
/// or below, and is gone in the mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Banding {
    /// The mean of the errors: how much too bright the picture is.
    pub mean: f64,
    /// The root of the mean of their squares.
    pub rmse: f64,
    /// The same of the means of squares of [`Banding::SQUARE`] pixels a side, after the picture's own mean is
    /// taken off.
    pub coarse_rmse: f64,
    /// The correlation of the errors of pixels side by side, along rows and along columns together, about the picture's
    /// mean; `None` where all errors are equal.
    pub correlation: Option<f64>,
}

impl Banding {
    /// Pixels along the edge of the squares whose means are taken. Those at the picture's right and lower edges that
    /// are not whole are left out.
    pub const SQUARE: usize = 8;

    /// The banding of a picture against another of the same scene and size.
    ///
    /// # Errors
    /// Different sizes, a display plane that is missing.
    pub fn of(reference: &Frame, frame: &Frame) -> Result<Self> {
        let (Some(left), Some(right)) = (&reference.display, &frame.display) else {
            return Err(Error::failed(
                "a picture without a display plane has no banding",
            ));
        };
        if reference.size != frame.size {
            return Err(Error::failed(format!(
                "pictures of {} and {} pixels are not compared",
                reference.size, frame.size
            )));
        }
        let brighter = |(a, b): (&[f32; 4], &[f32; 4])| {
            let sum: f64 = (0..3).map(|c| f64::from(b[c]) - f64::from(a[c])).sum();
            sum / 3.0
        };
        let errors: Vec<f64> = left.iter().zip(right).map(brighter).collect();
        Ok(Self::of_errors(&errors, frame.size.width() as usize))
    }

    /// The share of the errors' deviation from their mean that squares of pixels have in common: 1 for bands far wider
    /// than a square, 1/8 for errors that have nothing to do with each other; `None` where all errors are equal.
    pub fn coarse_share(&self) -> Option<f64> {
        let variance = self.rmse * self.rmse - self.mean * self.mean;
        (variance > 0.0).then(|| self.coarse_rmse / variance.sqrt())
    }

    /// The banding of errors, row by row.
    fn of_errors(errors: &[f64], width: usize) -> Self {
        let count = errors.len().max(1) as f64;
        let mean = errors.iter().sum::<f64>() / count;
        let squares: f64 = errors.iter().map(|error| error * error).sum();
        let off: Vec<f64> = errors.iter().map(|error| error - mean).collect();
        let rows: Vec<&[f64]> = off.chunks_exact(width.max(1)).collect();
        Self {
            mean,
            rmse: (squares / count).sqrt(),
            coarse_rmse: coarse_rmse(&rows),
            correlation: correlation(&rows),
        }
    }
}

/// The root of the mean of the squares of the means of square parts.
fn coarse_rmse(rows: &[&[f64]]) -> f64 {
    let side = Banding::SQUARE;
    let mut sum = 0.0;
    let mut count = 0;
    for band in rows.chunks_exact(side) {
        for column in 0..band[0].len() / side {
            let part = |row: &&[f64]| row[column * side..(column + 1) * side].iter().sum::<f64>();
            let mean = band.iter().map(part).sum::<f64>() / (side * side) as f64;
            sum += mean * mean;
            count += 1;
        }
    }
    (sum / f64::from(count.max(1))).sqrt()
}

/// The correlation of numbers side by side, and one above the other.
fn correlation(rows: &[&[f64]]) -> Option<f64> {
    let along = rows
        .iter()
        .flat_map(|row| row.windows(2))
        .map(|two| two[0] * two[1]);
    let down = rows.windows(2).flat_map(|two| two[0].iter().zip(two[1]));
    let down = down.map(|(above, below)| above * below);
    let (mut products, mut pairs) = (0.0, 0);
    for product in along.chain(down) {
        products += product;
        pairs += 1;
    }
    let count: usize = rows.iter().map(|row| row.len()).sum();
    let squares: f64 = rows.iter().flat_map(|row| row.iter()).map(|x| x * x).sum();
    let variance = squares / count.max(1) as f64;
    (variance > 0.0 && pairs > 0).then(|| products / f64::from(pairs) / variance)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture's errors by column and row.
    fn of(error: impl Fn(usize, usize) -> f64) -> Banding {
        let side = 64;
        let errors = (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
        let errors: Vec<f64> = errors.map(|(x, y)| error(x, y)).collect();
        Banding::of_errors(&errors, side)
    }

    #[test]
    fn bands_are_alike_from_pixel_to_pixel_and_a_checkerboard_is_not() {
        let wave = |x: usize, _| (std::f64::consts::TAU * x as f64 / 32.0).sin();
        let bands = of(wave);
        assert!(bands.mean.abs() < 1e-12 && (bands.rmse - 0.5_f64.sqrt()).abs() < 1e-12);
        // cos(2π/32) along rows, 1 along columns; a mean over a quarter of a wave keeps most of it.
        assert!(bands.correlation.unwrap() > 0.97, "{bands:?}");
        assert!(bands.coarse_rmse > 0.85 * bands.rmse, "{bands:?}");
        let board = of(|x, y| if (x + y) % 2 == 0 { 1.0 } else { -1.0 });
        assert_eq!((board.rmse, board.coarse_rmse), (1.0, 0.0));
        assert!((board.correlation.unwrap() + 1.0).abs() < 1e-12);
        // What all pixels share is no band.
        let even = of(|_, _| 0.25);
        assert_eq!((even.mean, even.rmse, even.coarse_rmse), (0.25, 0.25, 0.0));
        assert_eq!((even.correlation, even.coarse_share()), (None, None));
        assert!(bands.coarse_share().unwrap() > 0.85);
    }
}
