//! `kernels/pass/compare_samples.cl`

use crate::error::Result;
use crate::gpu::{Args, Buffer};

use super::mean_of_samples::SampledPixels;
use super::run::Run;

/// How much the means of pixels' rays differ from their `color`: per pixel of the list the sum of three channels' squared
/// differences, sRGB-encoded, and the greatest difference.
pub fn compare_samples(
    run: &mut Run,
    pixels: &SampledPixels,
    sample_color: &Buffer<[f32; 4]>,
    color: &Buffer<[f32; 4]>,
    apart: &mut Buffer<[f32; 2]>,
) -> Result<()> {
    let args = Args::new()
        .with(pixels)
        .read("sample_color", sample_color)
        .read("color", color)
        .write("apart", apart);
    run.items(
        "compare_samples",
        run.scalar_defines(),
        args,
        pixels.items()?,
    )
}
