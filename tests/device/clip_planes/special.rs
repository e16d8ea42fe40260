//! Planes along the rays, through the eye, redundant, contradictory, many, of any length, and far
//! from the origin.

use angioray::frame::{CERTIFICATE, KIND, Kind};
use angioray::lab::measure::HitChecker;

use super::*;

/// A cube from −4 to 4 mm along each axis.
fn cube() -> Volume {
    let origin = DVec3::splat(-4.0);
    let geometry = Geometry::new(origin, DMat3::IDENTITY, DVec3::ONE).unwrap();
    uniform([9, 9, 9], geometry)
}

/// The rows of an 8 x 8 picture that see anything; all pixels of a row must agree.
fn rows_seen(frame: &Frame) -> Vec<bool> {
    let kinds = frame.plane(KIND).unwrap();
    let rows = kinds.chunks(frame.size.width() as usize);
    rows.map(|row| {
        assert!(row.iter().all(|kind| *kind == row[0]), "{row:?}");
        row[0] != 0
    })
    .collect()
}

/// Rays at z = 3.5, 2.5, … −3.5, all along y.
#[test]
fn rays_in_above_and_below_a_parallel_plane() {
    let volume = cube();
    let view = straight(DVec3::ZERO, 8, 8.0);
    let above = |z: f64| -> Vec<bool> { (0..8).map(|row| 3.5 - f64::from(row) >= z).collect() };
    let up = |z: f64| plane(DVec3::Z * 7.3, -7.3 * z);
    let down = |z: f64| plane(DVec3::NEG_Z * 1e-3, 1e-3 * z);
    let cases = [
        // In the plane: kept. A little above or below it: kept or not.
        (vec![up(0.5)], above(0.5)),
        (vec![up(0.5 + 1e-4)], above(1.5)),
        (vec![up(0.5 - 1e-4)], above(0.5)),
        (vec![up(9.0)], vec![false; 8]),
        (vec![up(-9.0)], vec![true; 8]),
        // From both sides, the rays in both planes alone are left.
        (
            vec![up(0.5), down(0.5)],
            (0..8).map(|row| row == 3).collect(),
        ),
        (vec![up(0.5 + 1e-4), down(0.5)], vec![false; 8]),
    ];
    let scenes: Vec<Scene> = (cases.iter())
        .map(|(planes, _)| scene(&volume, maximum(), view, planes))
        .collect();
    for engine in engines() {
        let frames = engine.frames(&volume, &scenes);
        for ((planes, rows), frame) in cases.iter().zip(&frames) {
            assert_eq!(rows_seen(frame), *rows, "{}: {planes:?}", engine.name);
            // A parallel plane moves no depth.
            for depth_mm in depths_mm(frame).into_iter().filter(|d| d.is_finite()) {
                assert!((depth_mm - 96.0).abs() < engine.depth_voxels);
            }
        }
        // The control: the rows of the first case are not those of the second.
        assert_ne!(rows_seen(&frames[0]), rows_seen(&frames[1]));
    }
}

/// Planes of any direction through the eye, inside the volume: each ray lies on one side for good,
/// so that it is seen as without planes or not at all; those near the plane may do either.
#[test]
fn planes_through_the_eye_keep_whole_rays_and_are_never_capped() {
    let volume = oblique(DVec3::ZERO);
    let size = ImageSize::new(24, 24).unwrap();
    let mut random = Random(5);
    let (mut kept, mut dropped) = (0, 0);
    for _ in 0..12 {
        let eye = DVec3::new(0.6, -0.3, 0.9);
        let normal = random.direction() * 0.37;
        let lens = Lens::Perspective { fov_deg: 90.0 };
        let up = random.direction();
        let camera = Camera::look_at(eye, eye + random.direction(), up, lens).unwrap();
        let planes = [plane_at(eye, normal)];
        let scenes = [
            scene(&volume, medium(), (camera, size), &planes),
            scene(&volume, medium(), (camera, size), &[]),
            scene(&volume, surface(true), (camera, size), &planes),
        ];
        for engine in engines() {
            let frames = engine.frames(&volume, &scenes);
            let all: Vec<f64> = lengths_mm(&frames[1]).collect();
            for (pixel, length_mm) in lengths_mm(&frames[0]).enumerate() {
                let (i, j) = (pixel as u32 % 24, pixel as u32 / 24);
                let ray = camera.ray(size, f64::from(i) + 0.5, f64::from(j) + 0.5);
                let side = normal.dot(ray.dir_world);
                if side.abs() < 1e-4 {
                    continue;
                }
                kept += usize::from(side > 0.0);
                dropped += usize::from(side < 0.0);
                let expected_mm = if side > 0.0 { all[pixel] } else { 0.0 };
                assert!(
                    (length_mm - expected_mm).abs() < 1e-3,
                    "{}: {length_mm}, not {expected_mm}",
                    engine.name
                );
            }
            assert!(all.iter().all(|&mm| mm > 0.5));
            let kinds = frames[2].plane(KIND).unwrap();
            assert!(kinds.iter().all(|&kind| kind == 0), "{}", engine.name);
        }
    }
    assert!(kept > 1000 && dropped > 1000, "{kept} kept, {dropped} not");
}

#[test]
fn redundant_contradictory_and_many_planes() {
    let volume = oblique(DVec3::ZERO);
    let (_, radius_mm) = volume.bounding_sphere();
    let camera = common::camera(&volume, common::OBLIQUE);
    let view = (camera, ImageSize::new(32, 32).unwrap());
    let cut = plane_at(DVec3::new(0.2, 0.1, -0.3), DVec3::new(0.5, 0.8, -0.3));
    let scaled = |by: f64| plane(cut.normal_world() * by, cut.offset() * by);
    let wide = |i: u32| {
        let angle = f64::from(i) * 0.7;
        let normal = DVec3::new(angle.cos(), angle.sin(), (angle * 1.3).sin());
        plane_at(-normal.normalize() * (1.01 * radius_mm), normal)
    };
    // 63 planes that touch nothing, the one that cuts in the middle of them.
    let mut many: Vec<ClipPlane> = (0..63).map(wide).collect();
    many.insert(31, cut);
    let contradictory = [cut, plane(-cut.normal_world(), -cut.offset() - 0.5)];
    let sets: [&[ClipPlane]; 6] = [
        &[cut],
        &[cut, scaled(1024.0), cut, scaled(0.125)],
        &[scaled(3.7e250)],
        &many,
        &contradictory,
        &[],
    ];
    let scenes: Vec<Scene> = (sets.iter())
        .map(|planes| scene(&volume, maximum(), view, planes))
        .collect();
    for engine in engines() {
        let frames = engine.frames(&volume, &scenes);
        let depths: Vec<Vec<f64>> = frames.iter().map(depths_mm).collect();
        let apart = |a: &[f64], b: &[f64]| {
            let pairs = a.iter().zip(b).filter(|(a, b)| a != b);
            pairs.fold(0.0, |max, (a, b)| f64::max(max, (a - b).abs()))
        };
        assert!(depths[0].iter().filter(|d| d.is_finite()).count() > 100);
        assert_eq!(depths[1], depths[0], "{}", engine.name);
        assert!(apart(&depths[2], &depths[0]) < engine.depth_voxels);
        assert_eq!(depths[3], depths[0], "{}", engine.name);
        let nothing = (frames[4].plane(KIND), &frames[4].color);
        assert!(nothing.0.into_iter().flatten().all(|&kind| kind == 0));
        assert!(nothing.1.iter().flatten().all(|&c| c == 0.0));
        // The control: the plane cuts.
        assert!(apart(&depths[5], &depths[0]) > 1.0);
    }
}

/// The same scene about the origin and a kilometre from it: the file's own numbers hold 1e-10 mm
/// there, single precision but 0.06 mm.
#[test]
fn planes_far_from_the_origin_cut_as_near_it() {
    let far = DVec3::new(1e6, -1e6, 1e6);
    let normal = DVec3::new(0.3, 1.0, 0.2);
    let cut_at = |middle: DVec3, beside_mm: f64| {
        let volume = oblique(middle);
        let point = middle + DVec3::new(0.4, -0.2, 0.1) + normal.normalize() * beside_mm;
        let view = straight(middle, 16, 9.0);
        let scene = scene(&volume, surface(true), view, &[plane_at(point, normal)]);
        (volume, scene)
    };
    for engine in engines() {
        let depths = |middle, beside_mm| {
            let (volume, scene) = cut_at(middle, beside_mm);
            depths_mm(&engine.frames(&volume, &[scene])[0])
        };
        let near = depths(DVec3::ZERO, 0.0);
        let apart = |other: Vec<f64>| {
            let pairs = near.iter().zip(other).filter(|(a, b)| *a != b);
            pairs.fold(0.0, |max, (a, b)| f64::max(max, (a - b).abs()))
        };
        let max = apart(depths(far, 0.0));
        assert!(max < engine.depth_voxels, "{}: {max}", engine.name);
        // The control: a hundredth of a millimetre beside.
        assert!(apart(depths(far, 0.01)) > 5e-3, "{}", engine.name);
    }
}

#[test]
fn a_plane_without_direction_or_number_is_wrong_usage() {
    for (normal, offset) in [
        (DVec3::ZERO, 1.0),
        (DVec3::NAN, 1.0),
        (DVec3::X * f64::INFINITY, 0.0),
        (DVec3::X, f64::NAN),
    ] {
        assert_eq!(ClipPlane::new(normal, offset).unwrap_err().exit_code(), 2);
    }
    assert!(ClipPlane::new(DVec3::X * 5e-324, 1e300).is_ok());
}

/// A plane too far for a number keeps all or nothing.
#[test]
fn a_plane_beyond_all_numbers_keeps_all_or_nothing() {
    let volume = cube();
    let view = straight(DVec3::ZERO, 8, 6.0);
    for (offset, seen) in [(1e300, true), (-1e300, false)] {
        let planes = [plane(DVec3::new(1e-20, 2e-20, 0.0), offset)];
        let scene = scene(&volume, maximum(), view, &planes);
        for engine in engines() {
            let frame = &engine.frames(&volume, std::slice::from_ref(&scene))[0];
            assert_eq!(rows_seen(frame), vec![seen; 8], "{}", engine.name);
        }
    }
}

/// Planes that cut a hair before and behind the faces between cells, where the voxels are the iso value
/// itself: what the certificate proves of a clipped ray is so.
#[test]
fn what_is_proven_of_clipped_rays_is_so() {
    let Some(device) = common::device() else {
        return;
    };
    // Along x again and again the iso value, more, less.
    let volume = common::volume_of([13, 12, 12], |x, _, _| [2u8, 3, 0][x as usize % 3]);
    let size = ImageSize::new(24, 24).unwrap();
    let mut counted = Proven::default();
    for face in [3.0, 6.0, 9.0_f32] {
        for ulps in -4..=4 {
            let cut = f64::from(f32::from_bits((face.to_bits() as i32 + ulps) as u32));
            let face = f64::from(face);
            // Kept from the cut on and to the middle of a cell; and the other way.
            let slabs = [
                [plane(DVec3::X, -cut), plane(DVec3::NEG_X, face + 1.5)],
                [plane(DVec3::NEG_X, cut), plane(DVec3::X, 0.75 - face)],
            ];
            for planes in slabs {
                for toward_eye in [DVec3::NEG_X, DVec3::new(-3.0, 1.0, 0.7), DVec3::X] {
                    let picture = Picture::Surface {
                        iso: 2.0,
                        caps: false,
                        refine: Refine::default(),
                        color: Rgb([0.8; 3]),
                        phong: None,
                    };
                    let view = (common::camera(&volume, toward_eye), size);
                    let mut scene = scene(&volume, picture, view, &planes);
                    scene.sampling.method = SamplingMethod::Exact;
                    counted.add(&device, &volume, &scene);
                }
            }
        }
    }
    assert_eq!(counted.wrong, 0, "{counted:?}");
    // The controls: rounding does decide many of them, and most others are proven.
    assert!(counted.differing > 500, "{counted:?}");
    assert!(counted.proven * 3 > counted.rays, "{counted:?}");
}

/// Rays of the device held against the reference.
#[derive(Debug, Default)]
struct Proven {
    rays: usize,
    proven: usize,
    /// Proven, and not so.
    wrong: usize,
    /// Only one of them hits.
    differing: usize,
}

impl Proven {
    fn add(&mut self, device: &Device, volume: &Volume, scene: &Scene) {
        let checker = HitChecker::new(volume, scene).unwrap();
        let frame = on_device(device, volume, std::slice::from_ref(scene)).remove(0);
        let kinds = frame.plane(KIND).unwrap();
        let certificates = frame.plane(CERTIFICATE).unwrap();
        let width = scene.size.width() as usize;
        for (pixel, (&kind, &certificate)) in kinds.iter().zip(certificates).enumerate() {
            let [x, y] = [pixel % width, pixel / width].map(|at| at as f64 + 0.5);
            let ray = scene.camera.ray(scene.size, x, y);
            let reference = checker.reference(ray);
            let hits = reference.kind != Kind::Nothing;
            let says = [Some(false), Some(true), None][certificate as usize];
            self.rays += 1;
            self.differing += usize::from(hits != (kind != Kind::Nothing as u32));
            self.proven += usize::from(says.is_some());
            let is_wrong = says.is_some_and(|says| says != hits);
            self.wrong += usize::from(is_wrong && checker.is_certain(ray, reference));
        }
    }
}
