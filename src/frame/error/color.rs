//! The colour's error.

use serde::{Serialize, Serializer};

use crate::error::{Error, Result};

use super::entry::Entry;
use super::pairing::displays;
use super::spread::Spread;
use crate::frame::Frame;

/// The error of colours, over the sRGB-encoded R, G and B of all pixels, in 0..1, before rounding to a
/// file's levels: three differences a pixel, each of them one entry.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ColorError {
    /// The root mean square of the differences.
    pub rmse: f64,
    /// The largest absolute difference.
    pub max: f64,
    /// The 99th percentile of the absolute differences.
    pub p99: f64,
    /// −20 log₁₀ rmse: the peak is 1. +∞ for equal pictures; `null` in JSON, which has no infinity.
    #[serde(serialize_with = "null_if_infinite")]
    pub psnr_db: f64,
}

/// Compares the display planes.
///
/// # Errors
/// Different sizes, a missing display plane, a channel that is not finite.
pub fn color_error(reference: &Frame, frame: &Frame) -> Result<ColorError> {
    let (left, right) = displays(reference, frame)?;
    let mut differences = Vec::with_capacity(3 * left.len());
    for (a, b) in left.iter().zip(right) {
        for channel in 0..3 {
            differences.push((f64::from(a[channel]) - f64::from(b[channel])).abs());
        }
    }
    // A picture has at least one pixel.
    let spread = Spread::of(&mut differences)
        .ok_or_else(|| Error::failed("a picture without pixels has no error"))?;
    Ok(ColorError {
        rmse: spread.rmse,
        max: spread.max,
        p99: spread.p99,
        psnr_db: -20.0 * spread.rmse.log10(),
    })
}

/// The share of the pixels of which a channel of the display planes differs by more than `level`.
///
/// # Errors
/// As [`color_error`].
pub fn differing_share(reference: &Frame, frame: &Frame, level: f64) -> Result<f64> {
    let (left, right) = displays(reference, frame)?;
    let differs = |(a, b): &(&[f32; 4], &[f32; 4])| {
        (0..3).any(|c| (f64::from(a[c]) - f64::from(b[c])).abs() > level)
    };
    let count = left.iter().zip(right).filter(differs).count();
    Ok(count as f64 / left.len().max(1) as f64)
}

/// The mean of the three channels' differences: how much brighter the picture is.
pub(super) fn color_entries(reference: &Frame, frame: &Frame) -> Result<Vec<Entry>> {
    let (left, right) = displays(reference, frame)?;
    let brighter = |(a, b): (&[f32; 4], &[f32; 4])| {
        let sum: f64 = (0..3).map(|c| f64::from(b[c]) - f64::from(a[c])).sum();
        Entry::Difference(sum / 3.0)
    };
    Ok(left.iter().zip(right).map(brighter).collect())
}

fn null_if_infinite<S: Serializer>(figure: &f64, to: S) -> std::result::Result<S::Ok, S::Error> {
    figure.is_finite().then_some(figure).serialize(to)
}
