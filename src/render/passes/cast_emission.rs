//! `kernels/pass/cast_emission.cl`

use crate::error::Result;
use crate::gpu::Buffer;
use crate::render::abi::KernelEnum;
use crate::render::resources::DeviceLayers;
use crate::scene::QuadratureMethod;

use super::emission_inputs::EmissionInputs;
use super::run::Run;

/// Emission and absorption along each ray by `method`, at fixed steps.
pub fn cast_emission(
    run: &mut Run,
    method: QuadratureMethod,
    inputs: &EmissionInputs,
    color: &mut Buffer<[f32; 4]>,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let defines = inputs.defines(run, layers);
    let defines = (inputs.cast_inputs)
        .define_steps(defines)
        .with("QUADRATURE", method.number())
        .with("HOMOGENEOUS", u32::from(inputs.node_average.is_some()));
    let args = inputs.args(run, color, layers);
    run.cast("cast_emission", defines, args)
}
