//! The passes of `iso`: straight-line code, the order of lines is the schedule.

use crate::error::Result;
use crate::frame::Layer;
use crate::render::abi::{KernelEnum, StoredIso, SurfaceCast, shading};
use crate::render::passes::{Run, cast_surface, exact_surface, shade_surface, surface_normal};
use crate::render::resources::DeviceLayers;
use crate::scene::{Phong, Refine, Rgb, SamplingMethod};

use super::planes::Planes;
use super::view::View;

/// How a scene's surface is found and seen, but for its iso value.
pub struct Surface {
    /// Whether the volume's faces are closed with caps where they are above the iso value.
    pub caps: bool,
    /// How a crossing between two samples is refined.
    pub refine: Refine,
    /// The surface's own colour.
    pub color: Rgb,
    /// How it reflects light; `None`: it shows its colour.
    pub phong: Option<Phong>,
}

/// Casts, finds normals where they are needed, shades.
pub fn surface(run: &mut Run, view: &View, iso: StoredIso, surface: &Surface) -> Result<Planes> {
    let shaded = surface.phong.is_some();
    let method = view.scene.sampling.method;
    let mut layers = DeviceLayers::default();
    layers.allocate(run.device, &run.rays, &layers_written(view, method))?;

    let cast = surface_cast(view, iso, surface);
    let mut hit_mm = run.plane("hit plane", f32::INFINITY)?;
    let find = match method {
        SamplingMethod::Fixed => cast_surface,
        SamplingMethod::Exact => exact_surface,
    };
    find(run, view.inputs, &cast, &mut hit_mm, &mut layers)?;

    if view.wanted.has(Layer::Normal) || shaded {
        layers.allocate(run.device, &run.rays, &[Layer::Normal])?;
        surface_normal(run, view.inputs, view.gradient, &hit_mm, &mut layers)?;
    }

    let light = shading(surface.color, surface.phong, view.scene.light);
    let mut color = run.plane("colour plane", [0.0; 4])?;
    shade_surface(run, &light, shaded, &layers, &mut color)?;
    Ok(Planes {
        color,
        display: None,
        layers,
        other_bytes: hit_mm.bytes(),
    })
}

/// The layers that the cast writes: what is wanted, and what later passes read.
fn layers_written(view: &View, method: SamplingMethod) -> Vec<Layer> {
    let wanted = view.wanted;
    let mut layers = vec![Layer::Kind];
    if wanted.has_any([Layer::Depth, Layer::Value]) {
        layers.extend([Layer::Depth, Layer::Value]);
    }
    if wanted.has_any(Layer::COUNTERS) {
        layers.extend(Layer::COUNTERS);
    }
    if wanted.has(Layer::Certificate) && method == SamplingMethod::Exact {
        layers.push(Layer::Certificate);
    }
    layers
}

fn surface_cast(view: &View, iso: StoredIso, surface: &Surface) -> SurfaceCast {
    SurfaceCast {
        iso: iso.value,
        step_mm: view.step_mm(),
        caps: u32::from(surface.caps),
        refine: surface.refine.method().number(),
        iterations: surface.refine.iterations(),
        traverse: view.traverse(),
        probe: u32::from(view.scene.sampling.probe),
        iso_error: iso.error,
    }
}
