//! The error of what a surface keeps from its hits.

use serde::{Deserialize, Serialize};

use crate::error::Result;

use super::entry::{Entry, Tally};
use super::pairing::{both, comparable, finite};
use crate::frame::{Frame, OCCLUSION};

/// Differences of the occlusion plane over pixels that both cover (colour's alpha > 0). Occlusion is a share of the light
/// from everywhere, from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OcclusionError {
    /// Pixels that both cover.
    pub compared: u64,
    /// The mean absolute difference; `None` if no pixel was compared.
    pub mean: Option<f64>,
    /// The 99th percentile of the absolute differences; `None` if no pixel was compared.
    pub p99: Option<f64>,
    /// The largest absolute difference; `None` if no pixel was compared.
    pub max: Option<f64>,
    /// The mean difference: above 0 the picture is too dark; `None` if no pixel was compared.
    pub bias: Option<f64>,
}

/// Compares the occlusion planes.
///
/// # Errors
/// Different sizes, a missing occlusion plane, an occlusion that is not finite.
pub fn occlusion_error(reference: &Frame, frame: &Frame) -> Result<OcclusionError> {
    let size = comparable(reference, frame)?;
    let (left, right) = both(reference, frame, "occlusion", |f| f.plane(OCCLUSION))?;
    let covers = |frame: &Frame, pixel: usize| frame.color[pixel][3] > 0.0;
    let entry = |(pixel, (&a, &b)): (usize, (&f32, &f32))| {
        Entry::of(covers(reference, pixel), covers(frame, pixel), || {
            finite(f64::from(b) - f64::from(a), "occlusion", size, pixel)
        })
    };
    let entries: Vec<Entry> =
        (left.iter().zip(right).enumerate().map(entry)).collect::<Result<_>>()?;
    let tally = Tally::of(&entries);
    let sum: f64 = entries.iter().filter_map(|entry| entry.difference()).sum();
    Ok(OcclusionError {
        compared: tally.compared,
        mean: tally.spread.map(|s| s.mean),
        p99: tally.spread.map(|s| s.p99),
        max: tally.spread.map(|s| s.max),
        bias: tally.spread.map(|_| sum / tally.compared as f64),
    })
}
