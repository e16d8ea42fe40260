//! `kernels/pass/window_value.cl`

use crate::error::Result;
use crate::gpu::{Buffer, input, output, value};
use crate::render::abi::RayGrid;

use super::Run;

/// The grey of each projected value between the `window`'s low and high end (stored units).
pub fn window_value(
    run: &mut Run,
    rays: &RayGrid,
    window: [f32; 2],
    kind: &Buffer<u32>,
    values: &Buffer<f32>,
    color: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let variant = run.variant;
    let defines = variant.defines().with("LANES", variant.lanes);
    let pass = run.built.pass("window_value", defines, || {
        vec![
            value::<RayGrid>("rays"),
            value::<[f32; 2]>("window"),
            input::<u32>("kind"),
            input::<f32>("value"),
            output::<[f32; 4]>("color"),
        ]
    })?;
    pass.launch(run.device)
        .value(rays)
        .value(&window)
        .input(kind)
        .input(values)
        .output(color)
        .run(run.size, run.work_group, run.timings)
}
