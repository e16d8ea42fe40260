//! The structural similarity of two pictures.

use rayon::prelude::*;

use crate::error::Result;
use crate::frame::Frame;

use super::pairing::displays;

/// The Gaussian window's radius and standard deviation, in pixels, and the constants against small
/// denominators, K1² and K2² times the data range's square (Wang et al. 2004, sections III-B and
/// III-C).
const RADIUS: usize = 5;
const SIGMA: f64 = 1.5;
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

const WINDOW: usize = 2 * RADIUS + 1;

/// Rows of the result that are computed together. Fixed, so that the sums are the same whatever
/// the number of threads.
const BAND: usize = 32;

/// The mean structural similarity, at most 1 (equal), of the display planes' R, G and B (Wang,
/// Bovik, Sheikh, Simoncelli, "Image Quality Assessment: From Error Visibility to Structural
/// Similarity", IEEE TIP 2004): a Gaussian window of 11x11 pixels, σ = 1.5; K1 = 0.01, K2 = 0.03,
/// a data range of 1; population variances; the mean over the windows that lie in the picture,
/// then over the channels. `None` where no window fits: a side of less than 11 pixels.
///
/// # Errors
/// Different sizes, a missing display plane, a channel that is not finite.
pub fn ssim(reference: &Frame, frame: &Frame) -> Result<Option<f64>> {
    let (left, right) = displays(reference, frame)?;
    let size = frame.size;
    let (width, height) = (size.width() as usize, size.height() as usize);
    if width < WINDOW || height < WINDOW {
        return Ok(None);
    }
    let (columns, rows) = (width - WINDOW + 1, height - WINDOW + 1);
    let weights = gaussian();
    let bands: Vec<(usize, usize)> = (0..3)
        .flat_map(|channel| (0..rows).step_by(BAND).map(move |row| (channel, row)))
        .collect();
    let sums: Vec<f64> = bands
        .into_par_iter()
        .map(|(channel, first)| {
            let last = (first + BAND).min(rows);
            let moments: Vec<_> = (first..last + WINDOW - 1)
                .map(|y| {
                    let row = y * width..(y + 1) * width;
                    row_moments(&left[row.clone()], &right[row], channel, &weights)
                })
                .collect();
            moments
                .windows(WINDOW)
                .map(|rows| similarity_of_row(rows, &weights))
                .sum()
        })
        .collect();
    Ok(Some(sums.iter().sum::<f64>() / (3 * rows * columns) as f64))
}

/// The means under a window of a, b, a², b² and ab.
type Moments = [f64; 5];

/// The moments of a row of `channel` under the window's horizontal part, one entry for each
/// place where it fits.
fn row_moments(
    left: &[[f32; 4]],
    right: &[[f32; 4]],
    channel: usize,
    weights: &[f64; WINDOW],
) -> Vec<Moments> {
    let products: Vec<Moments> = left
        .iter()
        .zip(right)
        .map(|(a, b)| {
            let (a, b) = (f64::from(a[channel]), f64::from(b[channel]));
            [a, b, a * a, b * b, a * b]
        })
        .collect();
    products
        .windows(WINDOW)
        .map(|window| weighted(window.iter(), weights))
        .collect()
}

/// The sum of the similarities of a row of windows, from the moments of the rows that they cover.
fn similarity_of_row(rows: &[Vec<Moments>], weights: &[f64; WINDOW]) -> f64 {
    (0..rows[0].len())
        .map(|x| similarity(weighted(rows.iter().map(|row| &row[x]), weights)))
        .sum()
}

fn weighted<'a>(moments: impl Iterator<Item = &'a Moments>, weights: &[f64; WINDOW]) -> Moments {
    let mut sum = [0.0; 5];
    for (moment, weight) in moments.zip(weights) {
        for (sum, moment) in sum.iter_mut().zip(moment) {
            *sum += weight * moment;
        }
    }
    sum
}

/// Equation 13.
fn similarity([a, b, aa, bb, ab]: Moments) -> f64 {
    let (variance_a, variance_b, covariance) = (aa - a * a, bb - b * b, ab - a * b);
    ((2.0 * a * b + C1) * (2.0 * covariance + C2))
        / ((a * a + b * b + C1) * (variance_a + variance_b + C2))
}

/// The window's weights along one axis; their sum is 1.
fn gaussian() -> [f64; WINDOW] {
    let mut weights = [0.0; WINDOW];
    for (k, weight) in weights.iter_mut().enumerate() {
        let x = k as f64 - RADIUS as f64;
        *weight = (-x * x / (2.0 * SIGMA * SIGMA)).exp();
    }
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}
