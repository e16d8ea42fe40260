//! `kernels/pass/surface_normal.cl`

use crate::error::Result;
use crate::gpu::{Buffer, input, output, value};
use crate::render::abi::{RayGrid, VolumeGrid};

use super::{DeviceClip, DeviceGradient, DeviceVolume, Run, voxels};

/// The unit world-space `normal` where each ray hit, toward lower values; zero elsewhere.
#[allow(clippy::too_many_arguments)]
pub fn surface_normal(
    run: &mut Run,
    volume: &DeviceVolume,
    gradient: DeviceGradient,
    clip: &DeviceClip,
    rays: &RayGrid,
    hit_mm: &Buffer<f32>,
    kind: &Buffer<u32>,
    normal: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let variant = run.variant;
    let defines = gradient.define(variant.defines().with("LANES", variant.lanes));
    let pass = run.built.pass("surface_normal", defines, || {
        let mut signature: Vec<_> = gradient.parameters().collect();
        if gradient.reads_voxels() {
            signature.push(voxels(variant));
        }
        signature.extend([
            DeviceClip::planes_parameter(),
            DeviceClip::count_parameter(),
            value::<VolumeGrid>("volume"),
            value::<RayGrid>("rays"),
            input::<f32>("hit_mm"),
            input::<u32>("kind"),
            output::<[f32; 4]>("normal"),
        ]);
        signature
    })?;
    let mut launch = gradient.give(pass.launch(run.device));
    if gradient.reads_voxels() {
        launch = run.voxels.give(launch);
    }
    launch
        .input(&clip.planes)
        .value(&clip.count)
        .value(&volume.grid)
        .value(rays)
        .input(hit_mm)
        .input(kind)
        .output(normal)
        .run(run.size, run.work_group, run.timings)
}
