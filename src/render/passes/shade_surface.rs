//! `kernels/pass/shade_surface.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::{Args, Buffer};
use crate::render::abi::Shading;
use crate::render::resources::DeviceLayers;

use super::run::Run;

/// How a surface is lit.
#[derive(Clone, Copy)]
pub struct Lit<'a> {
    /// Its colour, its lights, and how it reflects them.
    pub shading: &'a Shading,
    /// Where it reflects them, by the normals there; `None`: it shows its colour.
    pub hit_mm: Option<&'a Buffer<f32>>,
    /// What reaches the hits of each light; `None`: all of it.
    pub lights_reached: Option<&'a Buffer<[f32; 4]>>,
    /// How strongly the occlusion of light from everywhere shows, 0 to 1; `None`: it is not known.
    pub occlusion: Option<f32>,
}

/// The `color` of each hit. Reads the kind.
pub fn shade_surface(
    run: &mut Run,
    lit: Lit,
    layers: &DeviceLayers,
    color: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let is_shaded = lit.hit_mm.is_some();
    let strength = lit.occlusion.filter(|_| is_shaded);
    let lights_reached = lit.lights_reached.filter(|_| is_shaded);
    let defines = run
        .defines()
        .with("SHADED", u32::from(is_shaded))
        .with("OCCLUSION", u32::from(strength.is_some()))
        .with("VISIBILITY", u32::from(lights_reached.is_some()));
    let normal: &[Layer] = if is_shaded { &[Layer::Normal] } else { &[] };
    let args = Args::new()
        .with(&run.rays)
        .value("shading", lit.shading)
        .read_some("hit_mm", lit.hit_mm)
        .with(layers.reading(&[Layer::Kind]))
        .with(layers.reading(normal));
    let args = match &strength {
        Some(strength) => args
            .value("strength", strength)
            .with(layers.reading(&[Layer::Occlusion])),
        None => args,
    };
    let args = args.read_some("lights_reached", lights_reached);
    run.cast("shade_surface", defines, args.write("color", color))
}
