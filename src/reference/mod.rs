//! The f64 renderer on the host: every picture by its definition, cell by cell, without an
//! acceleration structure. It is what the device's pictures are compared with.
//!
//! Along a ray the trilinear field is a cubic polynomial in every cell, and so is each component of
//! the gradient by differences (a shift by a whole voxel keeps the cell faces where they are).
//! Surfaces and projections are solved from these cubics to machine precision; emission–absorption
//! is integrated adaptively between the points where its integrand is not smooth.

mod cells;
mod clip;
mod collocation;
mod cubic;
mod emission;
mod field;
mod gradient;
mod interval;
mod medium;
mod projection;
mod shade;
mod surface;
mod tone;
mod tracer;

pub use tone::display;
pub use tracer::{Sight, Tracer};

use rayon::prelude::*;

use crate::error::Result;
use crate::frame::{Certificate, Frame, Kind, Wanted};
use crate::progress::Progress;
use crate::scene::{Picture, Scene};
use crate::volume::Volume;

/// Rows whose f64 results are held at a time, before they are narrowed to the planes' f32.
const BAND_ROWS: u32 = 16;

/// The picture of `scene`, in double precision until the planes are filled. Reports one unit of
/// progress a row. The same bytes whatever the number of threads.
///
/// # Errors
/// As [`Tracer::new`].
pub fn render(
    volume: &Volume,
    scene: &Scene,
    wanted: Wanted,
    progress: &dyn Progress,
) -> Result<Frame> {
    let tracer = Tracer::new(volume, scene)?;
    let (size, width) = (scene.size, scene.size.width());
    let mut frame = empty_frame(scene, wanted);
    progress.begin("reference", u64::from(size.height()));
    for first in (0..size.height()).step_by(BAND_ROWS as usize) {
        let rows = BAND_ROWS.min(size.height() - first);
        let band: Vec<Sight> = (0..rows * width)
            .into_par_iter()
            .map(|i| {
                let (x, y) = (i % width, first + i / width);
                let (x_px, y_px) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                tracer.cast(scene.camera.ray(size, x_px, y_px))
            })
            .collect();
        for sight in &band {
            push(&mut frame, sight, scene);
        }
        progress.advance(u64::from(rows));
    }
    progress.end();
    Ok(frame)
}

/// Double precision decides every ray but those whose own cubics touch the iso value to the last bit;
/// its answer is the one that others are compared with.
fn certificate(sight: &Sight, scene: &Scene) -> Certificate {
    match (&scene.picture, sight.kind) {
        (Picture::Surface { .. }, Kind::Nothing) => Certificate::Miss,
        (Picture::Surface { .. }, _) => Certificate::Hit,
        _ => Certificate::Undecided,
    }
}

/// A frame with the wanted planes, each with room for its pixels.
fn empty_frame(scene: &Scene, wanted: Wanted) -> Frame {
    fn plane<T>(wanted: bool, pixels: usize) -> Option<Vec<T>> {
        wanted.then(|| Vec::with_capacity(pixels))
    }
    let pixels = scene.size.pixels();
    Frame {
        size: scene.size,
        color: Vec::with_capacity(pixels),
        display: plane(wanted.display, pixels),
        depth: plane(wanted.depth, pixels),
        normal: plane(wanted.normal, pixels),
        value: plane(wanted.value, pixels),
        steps: plane(wanted.counters, pixels),
        nodes: plane(wanted.counters, pixels),
        kind: plane(wanted.kind, pixels),
        certificate: plane(wanted.certificate, pixels),
    }
}

/// Appends one pixel to every plane.
fn push(frame: &mut Frame, sight: &Sight, scene: &Scene) {
    fn append<T>(plane: &mut Option<Vec<T>>, value: impl FnOnce() -> T) {
        if let Some(plane) = plane {
            plane.push(value());
        }
    }
    frame.color.push(sight.color.map(|c| c as f32));
    append(&mut frame.display, || {
        display(sight.color, &scene.tone).map(|c| c as f32)
    });
    append(&mut frame.depth, || sight.depth_mm as f32);
    append(&mut frame.normal, || {
        sight.normal_world.to_array().map(|c| c as f32)
    });
    append(&mut frame.value, || sight.value as f32);
    append(&mut frame.steps, || sight.cells);
    append(&mut frame.nodes, || 0);
    append(&mut frame.kind, || sight.kind as u32);
    append(&mut frame.certificate, || certificate(sight, scene) as u32);
}
