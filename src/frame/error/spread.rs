//! The mean, the root mean square, the percentile and the maximum of a set of differences.

use crate::frame::percentile;

/// Statistics of finite entries that are not negative.
#[derive(Clone, Copy)]
pub(super) struct Spread {
    /// The mean.
    pub mean: f64,
    /// The root mean square.
    pub rmse: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// The maximum.
    pub max: f64,
}

impl Spread {
    /// `None` of nothing; reorders `entries`.
    pub(super) fn of(entries: &mut [f64]) -> Option<Self> {
        let p99 = percentile(entries, 99)?;
        let count = entries.len() as f64;
        Some(Self {
            mean: entries.iter().sum::<f64>() / count,
            rmse: (entries.iter().map(|e| e * e).sum::<f64>() / count).sqrt(),
            p99,
            max: entries.iter().copied().fold(0.0, f64::max),
        })
    }
}
