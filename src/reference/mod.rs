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
mod leaving;
mod medium;
mod occlusion;
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
    CERTIFICATE, COC, COVERAGE, Certificate, DEPTH, Frame, KIND, Key, Kind, Layer, Layers, NORMAL,
    OCCLUSION, PlaneEntry, STEPS, THICK, VALUE, VISIBILITY, Wanted,
};
use crate::progress::Progress;
use crate::scene::{DepthOfField, LensPoint, Picture, RayCount, Scene};
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
    let seer = Seer::new(volume, scene, wanted)?;
    let (size, width) = (scene.size, scene.size.width());
    let mut frame = Frame::blank(size, wanted)?;
    progress.begin("reference", u64::from(size.height()));
    for first in (0..size.height()).step_by(BAND_ROWS as usize) {
        let rows = BAND_ROWS.min(size.height() - first);
        let band: Vec<PixelResult> = (first * width..(first + rows) * width)
            .into_par_iter()
            .map(|pixel| seer.see(pixel))
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
    let seer = Seer::new(volume, scene, wanted)?;
    let mut frame = Frame::blank(ImageSize::row(pixels.len())?, wanted)?;
    progress.begin("reference", pixels.len() as u64);
    for (first, some) in (0..).step_by(AT_A_TIME).zip(pixels.chunks(AT_A_TIME)) {
        let results: Vec<PixelResult> = some.par_iter().map(|&pixel| seer.see(pixel)).collect();
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
    /// The diameter of its circle of confusion, pixels; 0 without a lens.
    circle_px: f64,
}

/// The lens of a scene, in focus.
struct FocusedLens {
    dof: DepthOfField,
    focus_mm: f64,
}

/// What casts the rays of pixels.
struct Seer<'a> {
    tracer: Tracer<'a>,
    scene: &'a Scene,
    lens: Option<FocusedLens>,
    /// The depths of all pixels, mm, where colours depend on those beside them.
    depths_mm: Option<Vec<f64>>,
}

/// Rays of a pixel through the lens.
const LENS_RAYS: RayCount = RayCount::of(256);

/// The share of a turn by which the lens's points are turned from pixel to pixel: the golden ratio's fractional part.
const TURN: f64 = 0.618_033_988_749_894_9;

impl<'a> Seer<'a> {
    /// Prepares a scene; where what is seen decides the focus, by casting all pixels once.
    ///
    /// # Errors
    /// As [`Tracer::new`]; nothing is seen in the pixel that is to be in focus.
    fn new(volume: &'a Volume, scene: &'a Scene, wanted: Wanted) -> Result<Self> {
        let dof = scene.depth_of_field;
        // A lens is focused, and its circles of confusion found, by the depths, which cues show.
        let cues = scene.depth_cues;
        let wanted = wanted
            .with_if(dof.is_some() || cues.is_some(), Layer::Depth)
            .with_if(cues.is_some_and(|cues| cues.rim().is_some()), Layer::Normal);
        let mut seer = Self {
            tracer: Tracer::new(volume, scene)?.wanting(wanted),
            scene,
            lens: None,
            depths_mm: None,
        };
        if cues.is_some_and(|cues| cues.draws_edges()) {
            let depth_mm = |pixel| seer.cast(pixel, [0.5; 2], None).depth_mm;
            let pixels = (0..scene.size.pixels() as u32).into_par_iter();
            seer.depths_mm = Some(pixels.map(depth_mm).collect());
        }
        if let Some(dof) = dof {
            let pixels = match dof.focus.is_seen() {
                true => scene.size.pixels() as u32,
                false => 0,
            };
            let axial = |pixel| seer.axial_mm(&seer.cast(pixel, [0.5; 2], None), pixel);
            let axial_mm: Vec<f64> = (0..pixels).into_par_iter().map(axial).collect();
            let focus_mm = dof.focus.distance_mm(&axial_mm, scene.size)?;
            seer.lens = Some(FocusedLens { dof, focus_mm });
        }
        Ok(seer)
    }

    /// Casts the rays of a pixel, the pixels counted row by row: that of its centre; where there is anti-aliasing as many as that
    /// asks for, whether it is adaptive or not; and where there is a lens 256 through it.
    fn see(&self, pixel: u32) -> PixelResult {
        let center = self.cast(pixel, [0.5; 2], None);
        let aa = self.scene.anti_aliasing;
        let (color, coverage) = match aa.rays() {
            1 => mean([center].into_iter()),
            _ => mean(aa.places_px().map(|place| self.cast(pixel, place, None))),
        };
        let mut seen = PixelResult {
            center,
            color,
            coverage,
            circle_px: 0.0,
        };
        if let Some(lens) = &self.lens {
            let points = lens
                .dof
                .lens_points(LENS_RAYS, lens.focus_mm, f64::from(pixel) * TURN);
            let places = std::iter::repeat_with(|| aa.places_px()).flatten();
            let rays = points.zip(places);
            (seen.color, _) = mean(rays.map(|(point, place)| self.cast(pixel, place, Some(point))));
            let Scene { camera, size, .. } = self.scene;
            let axial_mm = self.axial_mm(&center, pixel);
            seen.circle_px = (lens.dof).circle_px(camera, *size, lens.focus_mm, axial_mm);
            let kept = lens.dof.kept(seen.circle_px);
            let [r, g, b, a] = seen.color;
            seen.color = [r * kept, g * kept, b * kept, a];
        }
        let kept = self.kept_at_edges(pixel);
        let [r, g, b, a] = seen.color;
        seen.color = [r * kept, g * kept, b * kept, a];
        seen
    }

    /// The share of a pixel's light that halos and contours keep.
    fn kept_at_edges(&self, pixel: u32) -> f64 {
        let (Some(cues), Some(depths_mm)) = (self.scene.depth_cues, &self.depths_mm) else {
            return 1.0;
        };
        let [width, height] = [self.scene.size.width(), self.scene.size.height()].map(i64::from);
        let (i, j) = (i64::from(pixel) % width, i64::from(pixel) / width);
        cues.kept(|x, y| {
            let inside = (0..width).contains(&(i + x)) && (0..height).contains(&(j + y));
            inside.then(|| depths_mm[((j + y) * width + i + x) as usize])
        })
    }

    /// Casts the ray through a place in a pixel, from its upper left corner, and a point of the lens or the pinhole.
    fn cast(&self, pixel: u32, [dx, dy]: [f64; 2], point: Option<LensPoint>) -> RayResult {
        let Scene { camera, size, .. } = self.scene;
        let width = size.width();
        let (x, y) = (f64::from(pixel % width) + dx, f64::from(pixel / width) + dy);
        let ray = match point {
            Some(point) => camera.ray_through(*size, x, y, point),
            None => camera.ray(*size, x, y),
        };
        let seen = self.tracer.cast(ray);
        let Some(cues) = self.scene.depth_cues else {
            return seen;
        };
        let cosine = seen.normal_world.dot(ray.dir_world);
        RayResult {
            color: cues.tinted(seen.color, seen.depth_mm, cosine),
            ..seen
        }
    }

    /// How far along the view axis what the ray of a pixel's centre met lies, mm; +∞: it met nothing.
    fn axial_mm(&self, center: &RayResult, pixel: u32) -> f64 {
        let Scene { camera, size, .. } = self.scene;
        let width = size.width();
        let (x, y) = (
            f64::from(pixel % width) + 0.5,
            f64::from(pixel / width) + 0.5,
        );
        center.depth_mm * camera.ray(*size, x, y).dir_world.dot(camera.forward())
    }
}

/// The mean colour of rays, and the share of them that met something.
fn mean(rays: impl Iterator<Item = RayResult>) -> ([f64; 4], f64) {
    let (mut sum, mut met, mut count) = ([0.0; 4], 0, 0);
    for ray in rays {
        for (sum, channel) in sum.iter_mut().zip(ray.color) {
            *sum += channel;
        }
        met += u32::from(ray.kind != Kind::Nothing);
        count += 1;
    }
    let count = f64::from(count);
    (sum.map(|channel| channel / count), f64::from(met) / count)
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
    set(layers, OCCLUSION, pixel, result.occlusion as f32);
    set(layers, VISIBILITY, pixel, result.visibility as f32);
    set(layers, THICK, pixel, result.thick_mm as f32);
    set(layers, COC, pixel, seen.circle_px as f32);
    set(
        layers,
        CERTIFICATE,
        pixel,
        certificate(result, scene) as u32,
    );
}
