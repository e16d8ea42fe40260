//! The f64 renderer on the host: every picture by its definition, cell by cell, without an
//! acceleration structure. It is what the device's pictures are compared with.
//!
//! Along a ray the trilinear field is a cubic polynomial in every cell, and so is each component of
//! the gradient by differences (a shift by a whole voxel keeps the cell faces where they are).
//! Surfaces and projections are solved from these cubics to machine precision; emission–absorption
//! is integrated adaptively between the points where its integrand is not smooth.

mod bernstein;
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
pub use tracer::{RayResult, Tracer};

use glam::DVec3;
use rayon::prelude::*;

use crate::error::Result;
use crate::extent::ImageSize;
use crate::frame::{
    CERTIFICATE, COVERAGE, Certificate, DEPTH, Frame, KIND, Key, Kind, Layers, NORMAL, PlaneEntry,
    STEPS, VALUE, Wanted,
};
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
    let tracer = Tracer::new(volume, scene)?.wanting(wanted);
    let (size, width) = (scene.size, scene.size.width());
    let mut frame = Frame::blank(size, wanted)?;
    progress.begin("reference", u64::from(size.height()));
    for first in (0..size.height()).step_by(BAND_ROWS as usize) {
        let rows = BAND_ROWS.min(size.height() - first);
        let band: Vec<PixelResult> = (first * width..(first + rows) * width)
            .into_par_iter()
            .map(|pixel| cast_pixel(&tracer, scene, pixel))
            .collect();
        for (result, pixel) in band.iter().zip((first * width) as usize..) {
            fill(&mut frame, pixel, result, scene);
        }
        progress.advance(u64::from(rows));
    }
    progress.end();
    Ok(frame)
}

/// Renders some pixels of the picture of `scene`, given by their numbers row by row: a picture of one
/// row, whose pixels are they, in this order. Reports one unit of progress a pixel.
///
/// # Errors
/// As [`Tracer::new`]; no pixel, or more than a row has.
pub fn render_pixels(
    volume: &Volume,
    scene: &Scene,
    wanted: Wanted,
    pixels: &[u32],
    progress: &dyn Progress,
) -> Result<Frame> {
    /// The number of pixels between two reports of progress.
    const AT_A_TIME: usize = 256;
    let tracer = Tracer::new(volume, scene)?.wanting(wanted);
    let mut frame = Frame::blank(ImageSize::row(pixels.len())?, wanted)?;
    progress.begin("reference", pixels.len() as u64);
    for (first, some) in (0..).step_by(AT_A_TIME).zip(pixels.chunks(AT_A_TIME)) {
        let results: Vec<PixelResult> = some
            .par_iter()
            .map(|&pixel| cast_pixel(&tracer, scene, pixel))
            .collect();
        for (result, pixel) in results.iter().zip(first..) {
            fill(&mut frame, pixel, result, scene);
        }
        progress.advance(some.len() as u64);
    }
    progress.end();
    Ok(frame)
}

/// What is seen in a pixel.
struct PixelResult {
    /// The ray through its centre, which its layers are of.
    center: RayResult,
    /// The mean of its rays: linear light, premultiplied.
    color: [f64; 4],
    /// The share of its rays that meet something.
    coverage: f64,
}

/// Casts the rays of a pixel, the pixels counted row by row: that of its centre, and where there is
/// anti-aliasing as many as that asks for, whether it is adaptive or not.
fn cast_pixel(tracer: &Tracer, scene: &Scene, pixel: u32) -> PixelResult {
    let width = scene.size.width();
    let (x, y) = (f64::from(pixel % width), f64::from(pixel / width));
    let cast = |[dx, dy]: [f64; 2]| tracer.cast(scene.camera.ray(scene.size, x + dx, y + dy));
    let center = cast([0.5, 0.5]);
    let aa = scene.anti_aliasing;
    let (mut sum, mut met) = ([0.0; 4], 0);
    for place in aa.places_px() {
        let ray = if aa.rays() == 1 { center } else { cast(place) };
        for (sum, channel) in sum.iter_mut().zip(ray.color) {
            *sum += channel;
        }
        met += u32::from(ray.kind != Kind::Nothing);
    }
    let rays = f64::from(aa.rays());
    PixelResult {
        center,
        color: sum.map(|channel| channel / rays),
        coverage: f64::from(met) / rays,
    }
}

/// Double precision decides every ray but those whose own cubics touch the iso value to the last bit;
/// its answer is the one that others are compared with.
fn certificate(result: &RayResult, scene: &Scene) -> Certificate {
    match (&scene.picture, result.kind) {
        (Picture::Surface { .. }, Kind::Nothing) => Certificate::Miss,
        (Picture::Surface { .. }, _) => Certificate::Hit,
        _ => Certificate::Undecided,
    }
}

/// Fills one pixel of every plane that is there.
fn fill(frame: &mut Frame, pixel: usize, seen: &PixelResult, scene: &Scene) {
    fn set<T: PlaneEntry>(layers: &mut Layers, key: Key<T>, pixel: usize, entry: T) {
        if let Some(plane) = layers.plane_mut(key) {
            plane[pixel] = entry;
        }
    }
    let narrowed = |v: DVec3| v.to_array().map(|c| c as f32);
    frame.color[pixel] = seen.color.map(|c| c as f32);
    if let Some(plane) = &mut frame.display {
        plane[pixel] = display(seen.color, &scene.tone).map(|c| c as f32);
    }
    let result = &seen.center;
    let layers = &mut frame.layers;
    set(layers, DEPTH, pixel, result.depth_mm as f32);
    set(layers, NORMAL, pixel, narrowed(result.normal_world));
    set(layers, VALUE, pixel, result.value as f32);
    set(layers, STEPS, pixel, result.cells);
    set(layers, KIND, pixel, result.kind as u32);
    set(layers, COVERAGE, pixel, seen.coverage as f32);
    set(
        layers,
        CERTIFICATE,
        pixel,
        certificate(result, scene) as u32,
    );
}
