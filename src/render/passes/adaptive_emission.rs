//! `kernels/pass/adaptive_emission.cl`

use crate::error::Result;
use crate::gpu::{input, value};
use crate::render::abi::{EmissionCast, RayGrid, Shading, VolumeGrid};
use crate::render::classified::Classified;

use super::{
    DeviceClip, DeviceGradient, DeviceTransfer, DeviceVolume, EmissionPlanes, Run, levels, switch,
    voxels,
};

/// Emission and absorption along each ray, its colour within an error bound. `gradient`, where normals
/// are made use of.
#[allow(clippy::too_many_arguments)]
pub fn adaptive_emission(
    run: &mut Run,
    shaded: bool,
    gradient: DeviceGradient,
    volume: &DeviceVolume,
    clip: &DeviceClip,
    classified: &Classified,
    transfer: &DeviceTransfer,
    rays: &RayGrid,
    cast: &EmissionCast,
    shading: &Shading,
    planes: &mut EmissionPlanes,
) -> Result<()> {
    let variant = run.variant;
    let sums_values = planes.place.is_some();
    let defines = gradient
        .define(variant.defines())
        .with("LANES", variant.lanes)
        .with("SHADED", switch(shaded));
    let defines = planes.define(defines);
    let pass = run.built.pass("adaptive_emission", defines, || {
        let mut signature = vec![
            voxels(variant),
            input::<u8>("node_class"),
            levels(),
            input::<u64>("cells"),
            input::<f32>("knot_values"),
            input::<[f32; 4]>("knot_colors"),
            input::<[f32; 4]>("knot_sums"),
        ];
        signature.extend(sums_values.then(|| input::<f32>("knot_value_sums")));
        signature.extend([
            DeviceClip::planes_parameter(),
            DeviceClip::count_parameter(),
        ]);
        signature.extend(gradient.parameters());
        signature.extend([
            value::<VolumeGrid>("volume"),
            value::<RayGrid>("rays"),
            value::<EmissionCast>("cast"),
            value::<Shading>("shading"),
        ]);
        signature.extend(planes.parameters());
        signature
    })?;
    let mut launch = run
        .voxels
        .give(pass.launch(run.device))
        .input(&classified.node_class)
        .input(&volume.levels)
        .input(&classified.cells)
        .input(&transfer.values)
        .input(&transfer.colors)
        .input(&transfer.sums);
    if sums_values {
        launch = launch.input(&transfer.value_sums);
    }
    let launch = launch.input(&clip.planes).value(&clip.count);
    let launch = gradient
        .give(launch)
        .value(&volume.grid)
        .value(rays)
        .value(cast)
        .value(shading);
    planes
        .give(launch)
        .run(run.size, run.work_group, run.timings)
}
