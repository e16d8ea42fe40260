//! The passes of `mip`, `minip`, `mean` and `lmip`: straight-line code, the order of lines is the schedule.

use crate::error::Result;
use crate::frame::Layer;
use crate::render::abi::{ProjectionCast, ProjectionLoop, stored, stored_window};
use crate::render::occupancy::Floor;
use crate::render::passes::{Run, cast_maximum, exact_projection, window_value};
use crate::render::resources::DeviceLayers;
use crate::scene::{Projection, SamplingMethod, Window};

use super::planes::Planes;
use super::view::View;

/// Casts, then shows the values through the window.
pub fn projection(
    run: &mut Run,
    view: &View,
    of: Projection,
    window: Window,
    floor: Floor,
) -> Result<Planes> {
    let mut layers = DeviceLayers::default();
    layers.allocate(run.device, &run.rays, &layers_written(view))?;

    let (which, threshold) = match of {
        Projection::Maximum | Projection::Minimum => (ProjectionLoop::Extremum, 0.0),
        Projection::Mean => (ProjectionLoop::Mean, 0.0),
        Projection::LocalMaximum { threshold } => (
            ProjectionLoop::Local,
            stored(view.volume.rescale(), threshold),
        ),
    };
    let cast = ProjectionCast {
        step_mm: view.step_mm(),
        sign: floor.sign,
        threshold,
        traverse: view.traverse(),
        probe: u32::from(view.scene.sampling.probe),
        floor: floor.floor,
        pad_0: 0,
        pad_1: 0,
    };
    let project = match view.scene.sampling.method {
        SamplingMethod::Fixed => cast_maximum,
        SamplingMethod::Exact => exact_projection,
    };
    project(run, which, view.inputs, &cast, &mut layers)?;

    let mut color = run.plane("colour plane", [0.0; 4])?;
    let ends = stored_window(view.volume.rescale(), window);
    window_value(run, ends, &layers, &mut color)?;
    Ok(Planes {
        color,
        display: None,
        layers,
        other_bytes: 0,
    })
}

/// The layers that the cast writes: what is wanted, and what the window reads.
fn layers_written(view: &View) -> Vec<Layer> {
    let mut layers = vec![Layer::Kind, Layer::Value];
    if view.wanted.has(Layer::Depth) {
        layers.push(Layer::Depth);
    }
    if view.wanted.has_any(Layer::COUNTERS) {
        layers.extend(Layer::COUNTERS);
    }
    layers
}
