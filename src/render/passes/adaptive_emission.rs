//! `kernels/pass/adaptive_emission.cl`

use crate::error::Result;
use crate::gpu::Buffer;
use crate::render::resources::DeviceLayers;

use super::emission_inputs::EmissionInputs;
use super::run::Run;

/// Emission and absorption along each ray, its colour within an error bound.
pub fn adaptive_emission(
    run: &mut Run,
    inputs: &EmissionInputs,
    color: &mut Buffer<[f32; 4]>,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let defines = inputs.defines(run, layers).with("JITTERED", 0);
    let args = inputs.args(run, color, layers);
    run.cast("adaptive_emission", defines, args)
}
