//! `kernels/pass/sum_counts.cl`

use crate::error::Result;
use crate::extent::ImageSize;
use crate::gpu::{Args, Buffer};

use super::run::Run;

/// Replaces `counts` by the sums of those before each; `totals` become the sums of the first half, and of all.
pub fn sum_counts(run: &mut Run, counts: &mut Buffer<u32>, totals: &mut Buffer<u32>) -> Result<()> {
    let squares = counts.count() as u32 / 2;
    let args = Args::new()
        .value("squares", &squares)
        .write("counts", counts)
        .write("totals", totals);
    let one = ImageSize::new(1, 1)?;
    run.items("sum_counts", run.scalar_defines(), args, one)
}
