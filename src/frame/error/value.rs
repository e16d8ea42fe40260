//! The projected value's error.

use serde::{Deserialize, Serialize};

use crate::error::Result;

use super::pairing::{both, comparable, finite, positive};
use super::spread::Spread;
use crate::frame::Frame;

/// Absolute differences of the value plane over pixels that both cover (colour's alpha > 0), as a
/// share of the volume's value range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ValueError {
    pub compared: u64,
    /// Pixels that only the reference covers.
    pub missed: u64,
    /// Pixels that only the other picture covers.
    pub extra: u64,
    pub mean: Option<f64>,
    pub rmse: Option<f64>,
    pub p99: Option<f64>,
    pub max: Option<f64>,
}

/// Compares the value planes; `range_width` is the volume's largest minus its smallest value.
///
/// # Errors
/// Different sizes, a missing value plane, a value that is not finite, a range width that is not
/// positive and finite.
pub fn value_error(reference: &Frame, frame: &Frame, range_width: f64) -> Result<ValueError> {
    let size = comparable(reference, frame)?;
    let unit = positive(range_width, "width of the value range")?;
    let (left, right) = both(reference, frame, "value", |f| f.value.as_deref())?;
    let covers = |frame: &Frame, pixel: usize| frame.color[pixel][3] > 0.0;
    let mut differences = Vec::new();
    let (mut missed, mut extra) = (0, 0);
    for (pixel, (&a, &b)) in left.iter().zip(right).enumerate() {
        let difference = finite((f64::from(a) - f64::from(b)).abs(), "value", size, pixel)?;
        match (covers(reference, pixel), covers(frame, pixel)) {
            (true, true) => differences.push(difference / unit),
            (true, false) => missed += 1,
            (false, true) => extra += 1,
            (false, false) => {}
        }
    }
    let spread = Spread::of(&mut differences);
    Ok(ValueError {
        compared: differences.len() as u64,
        missed,
        extra,
        mean: spread.map(|s| s.mean),
        rmse: spread.map(|s| s.rmse),
        p99: spread.map(|s| s.p99),
        max: spread.map(|s| s.max),
    })
}
