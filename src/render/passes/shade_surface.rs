//! `kernels/pass/shade_surface.cl`

use crate::error::Result;
use crate::gpu::{Buffer, input, output, value};
use crate::render::abi::{RayGrid, Shading};

use super::{Run, switch};

/// The `color` of each hit: shaded where a `normal` is given, else the base colour.
pub fn shade_surface(
    run: &mut Run,
    rays: &RayGrid,
    shading: &Shading,
    kind: &Buffer<u32>,
    normal: Option<&Buffer<[f32; 4]>>,
    color: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let shaded = normal.is_some();
    let variant = run.variant;
    let defines = variant
        .defines()
        .with("LANES", variant.lanes)
        .with("SHADED", switch(shaded));
    let pass = run.built.pass("shade_surface", defines, || {
        let mut signature = vec![
            value::<RayGrid>("rays"),
            value::<Shading>("shading"),
            input::<u32>("kind"),
        ];
        if shaded {
            signature.push(input::<[f32; 4]>("normal"));
        }
        signature.push(output::<[f32; 4]>("color"));
        signature
    })?;
    let mut launch = pass
        .launch(run.device)
        .value(rays)
        .value(shading)
        .input(kind);
    if let Some(normal) = normal {
        launch = launch.input(normal);
    }
    launch
        .output(color)
        .run(run.size, run.work_group, run.timings)
}
