//! `kernels/pass/thickness.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::{Args, Buffer};
use crate::render::abi::SurfaceCast;
use crate::render::resources::{DeviceGradient, DeviceLayers, Spans};

use super::inputs::CastInputs;
use super::run::Run;

/// How thick what a ray hits is.
#[derive(Clone, Copy)]
pub enum Thickness<'a> {
    /// As far as the ray goes on to the next crossing of the surface.
    Exact {
        /// What its march reads.
        inputs: CastInputs<'a>,
        /// How the surface is found.
        cast: &'a SurfaceCast,
        /// How far behind the hit it begins, mm.
        start_mm: f32,
    },
    /// So many mm.
    Constant(f32),
}

/// How far each ray goes on behind its hit: the layer, where it `has_layer`, and the spans of depths, where they are given. Reads
/// the kind.
pub fn thickness(
    run: &mut Run,
    thickness: Thickness,
    hit_mm: &Buffer<f32>,
    spans: Option<&mut Spans>,
    has_layer: bool,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let is_exact = matches!(thickness, Thickness::Exact { .. });
    let defines = run
        .defines()
        .with("CERTIFICATE", 0)
        .with("MARCHED", u32::from(is_exact))
        .with("SPANS", u32::from(spans.is_some()))
        .with("LAYERS", u32::from(has_layer));
    let args = match &thickness {
        Thickness::Exact {
            inputs,
            cast,
            start_mm,
        } => inputs
            .along_rays(inputs.by_cells(run), run, DeviceGradient::NONE)
            .value("cast", *cast)
            .value("start_mm", start_mm),
        Thickness::Constant(mm) => Args::new().with(&run.rays).value("constant_mm", mm),
    };
    let args = args
        .read("hit_mm", hit_mm)
        .with(layers.reading(&[Layer::Kind]));
    let args = match spans {
        Some(spans) => args
            .value("forward", &spans.screen.forward)
            .write("spans", &mut spans.depths),
        None => args,
    };
    let layer: &[Layer] = if has_layer { &[Layer::Thick] } else { &[] };
    let args = args.with(layers.writing(layer));
    run.cast("thickness", defines, args)
}
