//! `kernels/pass/sample_field.cl`

use crate::error::Result;
use crate::gpu::{Buffer, output, value};
use crate::render::abi::{RayGrid, VolumeGrid};

use super::{DeviceVolume, Run, voxels};

/// The mean of each ray's samples in stored units, and their number.
pub fn sample_field(
    run: &mut Run,
    volume: &DeviceVolume,
    rays: &RayGrid,
    step_mm: f32,
    means: &mut Buffer<f32>,
    counts: &mut Buffer<u32>,
) -> Result<()> {
    let variant = run.variant;
    let defines = variant.defines().with("LANES", variant.lanes);
    let pass = run.built.pass("sample_field", defines, || {
        vec![
            voxels(variant),
            value::<VolumeGrid>("volume"),
            value::<RayGrid>("rays"),
            value::<f32>("step_mm"),
            output::<f32>("value"),
            output::<u32>("steps"),
        ]
    })?;
    run.voxels
        .give(pass.launch(run.device))
        .value(&volume.grid)
        .value(rays)
        .value(&step_mm)
        .output(means)
        .output(counts)
        .run(run.size, run.work_group, run.timings)
}
