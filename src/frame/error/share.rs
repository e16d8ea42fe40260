//! The error of a share of light: of what a surface keeps from its hits, and of what reaches them of a light.

use serde::{Deserialize, Serialize};

use crate::error::Result;

use super::entry::{Entry, Tally};
use super::pairing::{both, comparable, finite};
use crate::frame::{Frame, KIND, Key, Kind};

/// Differences of a plane of shares, from 0 to 1, over pixels in which both meet something: a kind, or, of a picture without kinds,
/// an opacity above 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ShareError {
    /// Pixels in which both meet something.
    pub compared: u64,
    /// The mean absolute difference; `None` if no pixel was compared.
    pub mean: Option<f64>,
    /// The 99th percentile of the absolute differences; `None` if no pixel was compared.
    pub p99: Option<f64>,
    /// The largest absolute difference; `None` if no pixel was compared.
    pub max: Option<f64>,
    /// The mean difference: above 0 where the shares are too large; `None` if no pixel was compared.
    pub bias: Option<f64>,
}

/// Compares two planes of shares, of what one key names.
///
/// # Errors
/// Different sizes, a missing plane, a share that is not finite.
pub fn share_error(reference: &Frame, frame: &Frame, key: Key<f32>) -> Result<ShareError> {
    let name = key.layer().name();
    let size = comparable(reference, frame)?;
    let (left, right) = both(reference, frame, name, |f| f.plane(key))?;
    let covers = |frame: &Frame, pixel: usize| match frame.plane(KIND) {
        Some(kinds) => kinds[pixel] != Kind::Nothing as u32,
        None => frame.color[pixel][3] > 0.0,
    };
    let entry = |(pixel, (&a, &b)): (usize, (&f32, &f32))| {
        Entry::of(covers(reference, pixel), covers(frame, pixel), || {
            finite(f64::from(b) - f64::from(a), name, size, pixel)
        })
    };
    let entries: Vec<Entry> =
        (left.iter().zip(right).enumerate().map(entry)).collect::<Result<_>>()?;
    let tally = Tally::of(&entries);
    let sum: f64 = entries.iter().filter_map(|entry| entry.difference()).sum();
    Ok(ShareError {
        compared: tally.compared,
        mean: tally.spread.map(|s| s.mean),
        p99: tally.spread.map(|s| s.p99),
        max: tally.spread.map(|s| s.max),
        bias: tally.spread.map(|_| sum / tally.compared as f64),
    })
}
