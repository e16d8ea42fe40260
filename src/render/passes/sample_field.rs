//! `kernels/pass/sample_field.cl`

use crate::error::Result;
use crate::gpu::{Args, Buffer};
use crate::render::resources::DeviceVolume;

use super::run::Run;

/// The mean of each ray's samples in stored units, and their number.
pub fn sample_field(
    run: &mut Run,
    volume: &DeviceVolume,
    step_mm: f32,
    means: &mut Buffer<f32>,
    counts: &mut Buffer<u32>,
) -> Result<()> {
    let args = Args::new()
        .with(run.voxels)
        .value("volume", &volume.grid)
        .with(&run.rays)
        .value("step_mm", &step_mm)
        .write("value", means)
        .write("steps", counts);
    run.cast("sample_field", run.defines(), args)
}
