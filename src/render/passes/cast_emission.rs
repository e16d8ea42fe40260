//! `kernels/pass/cast_emission.cl`

use crate::error::Result;
use crate::gpu::{Buffer, input, value};
use crate::render::abi::{EmissionCast, RayGrid, Shading, VolumeGrid};
use crate::render::classified::Classified;
use crate::render::variant::quadrature_constant;
use crate::scene::{Filter, QuadratureMethod};

use super::{
    DeviceClip, DeviceGradient, DeviceVolume, EmissionPlanes, Run, levels, switch, voxels,
};

/// A transfer function on the device, knots ascending in stored units.
pub struct DeviceTransfer {
    pub values: Buffer<f32>,
    /// Linear light, opacity of the unit length in the last channel.
    pub colors: Buffer<[f32; 4]>,
    /// As `KnotSums` of `preintegrated.clh` has them; empty where no rule wants them.
    pub sums: Buffer<[f32; 4]>,
    pub value_sums: Buffer<f32>,
    pub knots: u32,
    /// The most by which the knots' colours differ in a channel.
    pub color_spread: f32,
    /// Stored units; outside nothing absorbs.
    pub absorbing: [f32; 2],
}

impl DeviceTransfer {
    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.values.bytes() + self.colors.bytes() + self.sums.bytes() + self.value_sums.bytes()
    }
}

/// Whether a rule at fixed steps integrates the transfer function between two samples' values: with the
/// nearest filter no value lies between them.
pub fn integrates(method: QuadratureMethod, filter: Filter) -> bool {
    method == QuadratureMethod::Preintegrated && filter == Filter::Linear
}

/// Emission and absorption along each ray by `method`. `gradient`, where normals are made use of;
/// `node_average`, what stands for each leaf, where some are homogeneous.
#[allow(clippy::too_many_arguments)]
pub fn cast_emission(
    run: &mut Run,
    method: QuadratureMethod,
    shaded: bool,
    gradient: DeviceGradient,
    volume: &DeviceVolume,
    clip: &DeviceClip,
    classified: &Classified,
    node_average: Option<&Buffer<f32>>,
    transfer: &DeviceTransfer,
    rays: &RayGrid,
    cast: &EmissionCast,
    shading: &Shading,
    planes: &mut EmissionPlanes,
) -> Result<()> {
    let variant = run.variant;
    let integrates = integrates(method, variant.filter);
    let sums_values = integrates && planes.place.is_some();
    let defines = gradient
        .define(variant.defines())
        .with("LANES", variant.lanes)
        .with("QUADRATURE", quadrature_constant(method))
        .with("HOMOGENEOUS", switch(node_average.is_some()))
        .with("SHADED", switch(shaded));
    let defines = planes.define(defines);
    let pass = run.built.pass("cast_emission", defines, || {
        let mut signature = vec![
            voxels(variant),
            input::<u8>("node_class"),
            levels(),
            input::<u64>("cells"),
            input::<f32>("knot_values"),
            input::<[f32; 4]>("knot_colors"),
        ];
        signature.extend(integrates.then(|| input::<[f32; 4]>("knot_sums")));
        signature.extend(sums_values.then(|| input::<f32>("knot_value_sums")));
        signature.extend(node_average.map(|_| input::<f32>("node_average")));
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
        .input(&transfer.colors);
    if integrates {
        launch = launch.input(&transfer.sums);
    }
    if sums_values {
        launch = launch.input(&transfer.value_sums);
    }
    if let Some(node_average) = node_average {
        launch = launch.input(node_average);
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
