//! `kernels/pass/adaptive_emission.cl`

use crate::error::Result;
use crate::gpu::{Buffer, input, output, value};
use crate::render::abi::{EmissionCast, RayGrid, Shading, VolumeGrid};
use crate::render::classified::Classified;

use super::{
    Counters, DeviceClip, DeviceGradient, DeviceTransfer, DeviceVolume, Run, levels, switch, voxels,
};

/// Emission and absorption along each ray within an error bound: `color`, linear light,
/// premultiplied.
#[allow(clippy::too_many_arguments)]
pub fn adaptive_emission(
    run: &mut Run,
    shaded_by: Option<DeviceGradient>,
    volume: &DeviceVolume,
    clip: &DeviceClip,
    classified: &Classified,
    transfer: &DeviceTransfer,
    rays: &RayGrid,
    cast: &EmissionCast,
    shading: &Shading,
    color: &mut Buffer<[f32; 4]>,
    counters: Option<&mut Counters>,
) -> Result<()> {
    let with_counters = counters.is_some();
    let variant = run.variant;
    let gradient = shaded_by.unwrap_or(DeviceGradient::none());
    let defines = gradient
        .define(variant.defines())
        .with("LANES", variant.lanes)
        .with("SHADED", switch(shaded_by.is_some()))
        .with("COUNTERS", switch(with_counters));
    let pass = run.built.pass("adaptive_emission", defines, || {
        let mut signature = vec![
            voxels(variant),
            input::<u8>("node_class"),
            levels(),
            input::<u64>("cells"),
            input::<f32>("knot_values"),
            input::<[f32; 4]>("knot_colors"),
            input::<[f32; 4]>("knot_sums"),
            DeviceClip::planes_parameter(),
            DeviceClip::count_parameter(),
        ];
        signature.extend(gradient.parameters());
        signature.extend([
            value::<VolumeGrid>("volume"),
            value::<RayGrid>("rays"),
            value::<EmissionCast>("cast"),
            value::<Shading>("shading"),
            output::<[f32; 4]>("color"),
        ]);
        signature.extend(Counters::parameters(with_counters));
        signature
    })?;
    let launch = run
        .voxels
        .give(pass.launch(run.device))
        .input(&classified.node_class)
        .input(&volume.levels)
        .input(&classified.cells)
        .input(&transfer.values)
        .input(&transfer.colors)
        .input(&transfer.sums)
        .input(&clip.planes)
        .value(&clip.count);
    let launch = gradient
        .give(launch)
        .value(&volume.grid)
        .value(rays)
        .value(cast)
        .value(shading)
        .output(color);
    Counters::give(counters, launch).run(run.size, run.work_group, run.timings)
}
