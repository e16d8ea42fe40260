//! `kernels/pass/sum_counts.cl`

use crate::error::Result;
use crate::extent::ImageSize;
use crate::gpu::{Args, Buffer};

use super::run::Run;

/// Replaces `counts` by the sums of those before each, and writes the sum of all to `total`.
pub fn sum_counts(run: &mut Run, counts: &mut Buffer<u32>, total: &mut Buffer<u32>) -> Result<()> {
    let squares = counts.count() as u32;
    let args = Args::new()
        .value("squares", &squares)
        .write("counts", counts)
        .write("total", total);
    let one = ImageSize::new(1, 1)?;
    run.items("sum_counts", run.scalar_defines(), args, one)
}
