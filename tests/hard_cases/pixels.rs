//! Pixels: case 27, of lines as thin as pixels, and what sparse casting and anti-aliasing make of them.

use angioray::frame::{CAST, COVERAGE, DEPTH, Frame, KIND, Wanted};
use angioray::lab::hardcases::{HardCase, LINE_RADIUS_MM, line_axes};
use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::render::{Options, Renderer};
use angioray::scene::{AntiAliasing, Mode, Refill, Scene, Sparse, SparseGrid};
use angioray::volume::Volume;
use glam::DVec3;

use crate::common;
use crate::mutant::Mutant;
use crate::trial::{Seen, check, is, resolved};

pub const CASES: &[&str] = &["pixel-lines"];

/// Where the field's surface may lie beside the vessels' own, in mm: it is interpolated between voxels.
const SURFACE_MM: f64 = 0.25;
/// Where two vessels cross, the corner between them is filled.
const FILLED_MM: f64 = 0.5;

fn sparse(spacing: u32, refill: Refill) -> Sparse {
    let grid = SparseGrid::new(spacing, None).unwrap();
    Sparse::new(Some(grid), Some(refill), None, Mode::Iso).unwrap()
}

/// The distance of a ray from the nearest centreline, in mm, and where it comes so near.
fn nearest(seen: &Seen, pixel: usize) -> (f64, DVec3) {
    let ray = seen.ray(pixel);
    let of = |(on, along): &(DVec3, DVec3)| {
        let normal = ray.dir_world.cross(*along);
        let apart = *on - ray.origin_world;
        let t = apart.cross(*along).dot(normal) / normal.length_squared();
        let distance = apart.dot(normal).abs() / normal.length();
        (distance, ray.origin_world + t * ray.dir_world)
    };
    let each = line_axes().iter().map(of).collect::<Vec<_>>();
    each.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
}

#[test]
fn pixel_lines() {
    fn expected(seen: &Seen) -> Vec<String> {
        let sides = seen.volume.dims().array();
        let mut wrong = is("something is hit", seen.hits() > 0);
        for pixel in 0..seen.pixels() {
            let (distance, at) = nearest(seen, pixel);
            // Where the whole vessel lies in the slab.
            let sides = DVec3::from_array(sides.map(|n| n as f64 - 1.0));
            let inside = at.cmpge(DVec3::splat(1.5)).all() && at.cmple(sides - 1.5).all();
            let hit = seen.kind(pixel) != 0;
            if inside && !hit && distance < LINE_RADIUS_MM - SURFACE_MM {
                wrong.push(format!(
                    "pixel {pixel}: a line {distance} mm away is not hit"
                ));
            }
            if hit && distance > LINE_RADIUS_MM + FILLED_MM {
                wrong.push(format!("pixel {pixel}: {distance} mm from any line"));
            }
        }
        wrong
    }
    let sparsely = |scene: &mut Scene| scene.sparse = Some(sparse(4, Refill::Gradient));
    check(
        "pixels::pixel_lines",
        "pixel-lines",
        expected,
        &[Mutant::Scene(sparsely)],
    );
}

/// The case's volume, and its scenes with the vessels' width in each, in pixels.
fn lines() -> (Volume, Vec<(f64, Scene)>) {
    let (case, _) = HardCase::named("pixel-lines").unwrap();
    let volume = case.volume(0).unwrap().volume;
    let scenes = resolved(case, &volume).into_iter().map(|(name, scene)| {
        let width = name.split('-').nth(1).unwrap();
        (width.parse().unwrap(), scene)
    });
    let scenes = scenes.collect();
    (volume, scenes)
}

/// Hits of the whole picture, those of them that a sparse one has not, and the rays that it cast.
#[derive(Debug, Default, Clone, Copy)]
struct Lost {
    hits: usize,
    lost: usize,
    pixels: usize,
    cast: usize,
}

impl Lost {
    fn add(&mut self, whole: &Frame, sparse: &Frame) {
        let kinds = whole
            .plane(KIND)
            .unwrap()
            .iter()
            .zip(sparse.plane(KIND).unwrap());
        let hits = kinds.filter(|(whole, _)| **whole != 0);
        let hits: Vec<bool> = hits.map(|(_, sparse)| *sparse != 0).collect();
        self.hits += hits.len();
        self.lost += hits.iter().filter(|&&kept| !kept).count();
        self.pixels += whole.size.pixels();
        let cast = sparse.plane(CAST).unwrap().iter();
        self.cast += cast.filter(|&&cast| cast == 1).count();
    }
}

#[test]
fn certified_loses_no_pixel_of_a_line_and_the_others_do() {
    let Some(device) = common::device() else {
        return;
    };
    let (volume, scenes) = lines();
    let octree = Octree::build(&volume, Leaf::default(), &Silent).unwrap();
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let mut render = |scene: &Scene| renderer.render(scene, Wanted::ALL).unwrap().frame;
    for by_width in scenes.chunk_by(|(a, _), (b, _)| a == b) {
        let width = by_width[0].0;
        for spacing in [2, 4, 8] {
            for refill in [
                Refill::Certified,
                Refill::Flood,
                Refill::Gradient,
                Refill::None,
            ] {
                let mut of = Lost::default();
                for (_, scene) in by_width {
                    let whole = render(scene);
                    let mut sparsely = scene.clone();
                    sparsely.sparse = Some(sparse(spacing, refill));
                    let frame = render(&sparsely);
                    of.add(&whole, &frame);
                    if refill == Refill::Certified {
                        let bits = |frame: &Frame| -> Vec<u32> {
                            let depth = frame.plane(DEPTH).unwrap().iter();
                            depth.map(|depth| depth.to_bits()).collect()
                        };
                        assert!(bits(&whole) == bits(&frame), "{width} {spacing}");
                    }
                }
                let share = |n: usize, of: usize| 100.0 * n as f64 / of as f64;
                println!(
                    "{width} pixels wide, K = {spacing}, {refill}: {:.2} % of {} lost, {:.1} % cast",
                    share(of.lost, of.hits),
                    of.hits,
                    share(of.cast, of.pixels)
                );
                if refill == Refill::Certified {
                    assert_eq!(of.lost, 0, "{width} {spacing}");
                }
                // The control: a line of one pixel passes between the corners of blocks.
                if refill == Refill::Gradient && spacing == 4 && width == 1.0 {
                    assert!(of.lost * 10 > of.hits, "{of:?}");
                }
            }
        }
    }
}

/// Where a line is in a picture: columns of a quarter pixel across its flatter axis, and of each the middle of the
/// line and half its extent along the column, in pixels.
struct Column {
    across_px: f64,
    along_px: f64,
    half_px: f64,
    /// Whether the picture's columns are its rows.
    steep: bool,
}

impl Column {
    fn pixel(&self, side: f64, offset_px: f64) -> Option<usize> {
        let (a, b) = (self.across_px, self.along_px + offset_px);
        let (x, y) = if self.steep { (b, a) } else { (a, b) };
        let inside = [x, y].iter().all(|at| (0.0..side).contains(at));
        inside.then(|| y as usize * side as usize + x as usize)
    }
}

fn columns(scene: &Scene, volume: &Volume, (on, along): (DVec3, DVec3)) -> Vec<Column> {
    let side = f64::from(scene.size.width());
    let pixel_mm = (scene.camera.ray(scene.size, 1.0, 0.0).origin_world
        - scene.camera.ray(scene.size, 0.0, 0.0).origin_world)
        .length();
    let corner = scene.camera.ray(scene.size, 0.0, 0.0).origin_world;
    let right = scene.camera.ray(scene.size, 1.0, 0.0).origin_world - corner;
    let down = scene.camera.ray(scene.size, 0.0, 1.0).origin_world - corner;
    let px = |v: DVec3| [v.dot(right), v.dot(down)].map(|mm2| mm2 / (pixel_mm * pixel_mm));
    let ([x0, y0], [dx, dy]) = (px(on - corner), px(along));
    let steep = dy.abs() > dx.abs();
    let (a0, b0, da, db) = if steep {
        (y0, x0, dy, dx)
    } else {
        (x0, y0, dx, dy)
    };
    let half_px = LINE_RADIUS_MM / pixel_mm * dx.hypot(dy) / da.abs();
    let quarter = |n: usize| {
        let across_px = (n as f64 + 0.5) / 4.0;
        let s = (across_px - a0) / da;
        let at = on + s * along;
        let sides = DVec3::from_array(volume.dims().array().map(|n| n as f64 - 1.0));
        let inside = at.truncate().cmpge(DVec3::splat(4.0).truncate()).all()
            && at.truncate().cmple((sides - 4.0).truncate()).all();
        inside.then_some(Column {
            across_px,
            along_px: b0 + s * db,
            half_px,
            steep,
        })
    };
    (0..4 * side as usize).filter_map(quarter).collect()
}

/// Columns of a line in which no pixel that it touches is covered, and pixels that it passes from side to side of
/// its width, in some column, without covering them.
fn gaps(scene: &Scene, volume: &Volume, covered: impl Fn(usize) -> bool) -> (usize, usize, usize) {
    let side = f64::from(scene.size.width());
    let (mut columns_in_all, mut broken, mut uncovered) = (0, 0, 0);
    for line in line_axes() {
        for column in columns(scene, volume, line) {
            let ends = [-column.half_px, column.half_px].map(|at| column.pixel(side, at));
            let [Some(low), Some(high)] = ends else {
                continue;
            };
            columns_in_all += 1;
            broken += usize::from(!covered(low) && !covered(high));
            uncovered += usize::from(low == high && !covered(low));
        }
    }
    (columns_in_all, broken, uncovered)
}

#[test]
fn a_line_of_a_quarter_pixel_has_no_gap_where_there_are_sixteen_rays_in_a_pixel() {
    let Some(device) = common::device() else {
        return;
    };
    let (volume, scenes) = lines();
    let octree = Octree::build(&volume, Leaf::default(), &Silent).unwrap();
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    for (_, scene) in scenes.iter().filter(|(width, _)| *width == 0.25) {
        let mut many = scene.clone();
        many.anti_aliasing = AntiAliasing::new(4, false).unwrap();
        let many = renderer.render(&many, Wanted::ALL).unwrap().frame;
        let coverage = many.plane(COVERAGE).unwrap();
        let (all, broken, uncovered) = gaps(scene, &volume, |pixel| coverage[pixel] > 0.0);
        let one = renderer.render(scene, Wanted::ALL).unwrap().frame;
        let kinds = one.plane(KIND).unwrap();
        let (_, broken_by_one, _) = gaps(scene, &volume, |pixel| kinds[pixel] != 0);
        println!("{all} columns: {broken} gaps, {uncovered} uncovered; by one ray {broken_by_one}");
        assert!(all > 500, "{all}");
        assert_eq!((broken, uncovered), (0, 0));
        // The control: through the centres of pixels most of the line is not seen.
        assert!(2 * broken_by_one > all, "{broken_by_one} of {all}");
    }
}
