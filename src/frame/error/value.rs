//! The projected value's error.

use serde::{Deserialize, Serialize};

use crate::error::Result;

use super::entry::{Entry, Tally};
use super::pairing::{both, comparable, finite, positive};
use crate::frame::{Frame, VALUE};

/// Absolute differences of the value plane over pixels that both cover (colour's alpha > 0), as a
/// share of the volume's value range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ValueError {
    /// Pixels that both cover.
    pub compared: u64,
    /// Pixels that only the reference covers.
    pub missed: u64,
    /// Pixels that only the other picture covers.
    pub extra: u64,
    /// The mean difference, as a share of the value range; `None` if no pixel was compared.
    pub mean: Option<f64>,
    /// The root mean square of the differences, as a share of the value range; `None` if no pixel was
    /// compared.
    pub rmse: Option<f64>,
    /// The 99th percentile of the differences, as a share of the value range; `None` if no pixel was
    /// compared.
    pub p99: Option<f64>,
    /// The largest difference, as a share of the value range; `None` if no pixel was compared.
    pub max: Option<f64>,
}

/// Compares the value planes; `range_width` is the volume's largest minus its smallest value.
///
/// # Errors
/// Different sizes, a missing value plane, a value that is not finite, a range width that is not
/// positive and finite.
pub fn value_error(reference: &Frame, frame: &Frame, range_width: f64) -> Result<ValueError> {
    let tally = Tally::of(&value_entries(reference, frame, range_width)?);
    Ok(ValueError {
        compared: tally.compared,
        missed: tally.missed,
        extra: tally.extra,
        mean: tally.spread.map(|s| s.mean),
        rmse: tally.spread.map(|s| s.rmse),
        p99: tally.spread.map(|s| s.p99),
        max: tally.spread.map(|s| s.max),
    })
}

/// How much larger the picture's values are, as a share of the range.
pub(super) fn value_entries(
    reference: &Frame,
    frame: &Frame,
    range_width: f64,
) -> Result<Vec<Entry>> {
    let size = comparable(reference, frame)?;
    let unit = positive(range_width, "width of the value range")?;
    let (left, right) = both(reference, frame, "value", |f| f.plane(VALUE))?;
    let covers = |frame: &Frame, pixel: usize| frame.color[pixel][3] > 0.0;
    let entry = |(pixel, (&a, &b)): (usize, (&f32, &f32))| {
        let difference = finite(f64::from(b) - f64::from(a), "value", size, pixel)?;
        Entry::of(covers(reference, pixel), covers(frame, pixel), || {
            finite(difference / unit, "value", size, pixel)
        })
    };
    left.iter().zip(right).enumerate().map(entry).collect()
}
