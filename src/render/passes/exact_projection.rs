//! `kernels/pass/exact_projection.cl`

use crate::error::Result;
use crate::gpu::{Buffer, input, output, value};
use crate::render::abi::{ProjectionCast, RayGrid, VolumeGrid};
use crate::render::classified::Classified;
use crate::render::variant::ProjectionLoop;

use super::{Counters, DeviceClip, DeviceVolume, Run, levels, switch, voxels};

/// One value per ray in stored units, from every cell that matters; `kind` where the ray meets the volume, and the `depth` (mm from the
/// eye) at which it was found.
#[allow(clippy::too_many_arguments)]
pub fn exact_projection(
    run: &mut Run,
    which: ProjectionLoop,
    volume: &DeviceVolume,
    clip: &DeviceClip,
    classified: &Classified,
    rays: &RayGrid,
    cast: &ProjectionCast,
    kind: &mut Buffer<u32>,
    values: &mut Buffer<f32>,
    depth: Option<&mut Buffer<f32>>,
    counters: Option<&mut Counters>,
) -> Result<()> {
    let (with_layers, with_counters) = (depth.is_some(), counters.is_some());
    let variant = run.variant;
    let defines = variant
        .defines()
        .with("LANES", variant.lanes)
        .with("PROJECTION", format!("{}", which as u32))
        .with("LAYERS", switch(with_layers))
        .with("COUNTERS", switch(with_counters));
    let pass = run.built.pass("exact_projection", defines, || {
        let mut signature = vec![
            voxels(variant),
            input::<u8>("node_class"),
            input::<[f32; 2]>("node_range"),
            levels(),
            DeviceClip::planes_parameter(),
            DeviceClip::count_parameter(),
            value::<VolumeGrid>("volume"),
            value::<RayGrid>("rays"),
            value::<ProjectionCast>("cast"),
            output::<u32>("kind"),
            output::<f32>("value"),
        ];
        if with_layers {
            signature.push(output::<f32>("depth"));
        }
        signature.extend(Counters::parameters(with_counters));
        signature
    })?;
    let mut launch = run
        .voxels
        .give(pass.launch(run.device))
        .input(&classified.node_class)
        .input(&volume.node_range)
        .input(&volume.levels)
        .input(&clip.planes)
        .value(&clip.count)
        .value(&volume.grid)
        .value(rays)
        .value(cast)
        .output(kind)
        .output(values);
    if let Some(depth) = depth {
        launch = launch.output(depth);
    }
    Counters::give(counters, launch).run(run.size, run.work_group, run.timings)
}
