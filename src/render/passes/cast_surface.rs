//! `kernels/pass/cast_surface.cl`

use crate::error::Result;
use crate::gpu::{Buffer, input, output, value};
use crate::render::abi::{RayGrid, SurfaceCast, VolumeGrid};
use crate::render::classified::Classified;

use super::{Counters, DeviceClip, DeviceVolume, Run, levels, switch, voxels};

/// Depth (mm from the eye) and value at the hit (stored units).
pub type Layers<'a> = (&'a mut Buffer<f32>, &'a mut Buffer<f32>);

/// The first point of each ray where Φ − iso changes sign: `hit_mm` from the base plane, `kind`.
#[allow(clippy::too_many_arguments)]
pub fn cast_surface(
    run: &mut Run,
    volume: &DeviceVolume,
    clip: &DeviceClip,
    classified: &Classified,
    rays: &RayGrid,
    cast: &SurfaceCast,
    hit_mm: &mut Buffer<f32>,
    kind: &mut Buffer<u32>,
    layers: Option<Layers>,
    counters: Option<&mut Counters>,
) -> Result<()> {
    let (with_layers, with_counters) = (layers.is_some(), counters.is_some());
    let variant = run.variant;
    let defines = variant
        .defines()
        .with("LANES", variant.lanes)
        .with("LAYERS", switch(with_layers))
        .with("COUNTERS", switch(with_counters));
    let pass = run.built.pass("cast_surface", defines, || {
        let mut signature = vec![
            voxels(variant),
            input::<u8>("node_class"),
            levels(),
            input::<u64>("cells"),
            DeviceClip::planes_parameter(),
            DeviceClip::count_parameter(),
            value::<VolumeGrid>("volume"),
            value::<RayGrid>("rays"),
            value::<SurfaceCast>("cast"),
            output::<f32>("hit_mm"),
            output::<u32>("kind"),
        ];
        if with_layers {
            signature.extend([output::<f32>("depth"), output::<f32>("value")]);
        }
        signature.extend(Counters::parameters(with_counters));
        signature
    })?;
    let mut launch = run
        .voxels
        .give(pass.launch(run.device))
        .input(&classified.node_class)
        .input(&volume.levels)
        .input(&classified.cells)
        .input(&clip.planes)
        .value(&clip.count)
        .value(&volume.grid)
        .value(rays)
        .value(cast)
        .output(hit_mm)
        .output(kind);
    if let Some((depth, value)) = layers {
        launch = launch.output(depth).output(value);
    }
    Counters::give(counters, launch).run(run.size, run.work_group, run.timings)
}
