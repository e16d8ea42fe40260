//! Scenes at the edge: rays along the grid, eyes on it, extreme cameras, geometries, images, sizes
//! and values. On the device and on the reference: no NaN, no hang, the same answer.

mod common;

use angioray::extent::{Dims, ImageSize};
use angioray::gpu::Device;
use angioray::scene::{
    Camera, Filter, Knot, Lens, Picture, Projection, Refine, Rgb, Scene, TransferFunction, Window,
};
use angioray::volume::{Geometry, NonFinite, Rescale, Volume, Voxels};
use common::Figure::{AlphaMax, DepthP99, Kind, ValueMax};
use common::{
    Figure, assert_sound, differing_pixels, hash, moved_by_a_pixel, on_device, on_reference,
    volume_of, volume_with,
};
use glam::{DMat3, DVec3};

/// How far device and reference may be apart. Steps are a sixteenth of a voxel here, so that what
/// is left is rounding, and of white noise one pixel of 17² that a ridge grazes.
#[rustfmt::skip]
const LIMITS: &[(Mode, &[(Figure, f64)])] = &[
    (Mode::Iso, &[(Kind, 0.0), (DepthP99, 0.01)]),
    (Mode::Uncapped, &[(Kind, 0.0035), (DepthP99, 0.01)]),
    (Mode::Mip, &[(Kind, 0.0), (ValueMax, 0.005)]),
    (Mode::Minip, &[(Kind, 0.0), (ValueMax, 0.005)]),
    (Mode::Mean, &[(Kind, 0.0), (ValueMax, 0.005)]),
    (Mode::Lmip, &[(Kind, 0.0)]),
    (Mode::Dvr, &[(AlphaMax, 0.002)]),
];
const STEP_VOXELS: f64 = 0.0625;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Mode {
    Iso,
    Uncapped,
    Mip,
    Minip,
    Mean,
    Lmip,
    Dvr,
}

fn surface(iso: f64, caps: bool) -> Picture {
    Picture::Surface {
        iso,
        caps,
        refine: "bisection:12".parse::<Refine>().unwrap(),
        color: Rgb([0.9; 3]),
        phong: None,
    }
}

fn emission(knots: &[(f64, f64)], unit_mm: f64) -> Picture {
    let knot = |&(value, opacity)| Knot {
        value,
        color: Rgb([0.8, 0.5, 0.3]),
        opacity,
    };
    Picture::Emission {
        transfer: TransferFunction::new(knots.iter().map(knot).collect(), unit_mm).unwrap(),
        phong: None,
        termination: 1.0,
    }
}

/// Each mode over the volume's own range.
fn picture(mode: Mode, volume: &Volume) -> Picture {
    let range = volume.range();
    let high = if range.width() > 0.0 {
        range.max
    } else {
        range.min + 1.0
    };
    let window = Window::new(range.min, high).unwrap();
    let projection = |of| Picture::Projection { of, window };
    let unit_mm = 4.0 * volume.geometry().smallest_spacing_mm();
    match mode {
        Mode::Iso => surface(range.at(0.45), true),
        Mode::Uncapped => surface(range.at(0.45), false),
        Mode::Mip => projection(Projection::Maximum),
        Mode::Minip => projection(Projection::Minimum),
        Mode::Mean => projection(Projection::Mean),
        Mode::Lmip => projection(Projection::LocalMaximum {
            threshold: range.at(0.5),
        }),
        Mode::Dvr => emission(&[(range.at(0.1), 0.0), (range.at(0.9), 0.5)], unit_mm),
    }
}

/// All modes of one volume from many cameras, and what is wrong with them.
struct Trial<'a> {
    device: &'a Device,
    volume: &'a Volume,
    name: String,
}

impl Trial<'_> {
    fn scene(&self, picture: Picture, camera: Camera, size: ImageSize) -> Scene {
        let mut scene = common::scene(self.volume, 1, picture);
        scene.camera = camera;
        scene.size = size;
        scene.sampling.step_voxels = STEP_VOXELS;
        scene
    }

    /// Renders every mode both ways; gives the figures above their limits.
    fn failures(&self, cameras: &[(String, Camera, ImageSize)]) -> Vec<String> {
        let mut told = Vec::new();
        let mut scenes = Vec::new();
        for (from, camera, size) in cameras {
            for (mode, limits) in LIMITS {
                told.push((format!("{} from {from}: {mode:?}", self.name), *limits));
                scenes.push(self.scene(picture(*mode, self.volume), *camera, *size));
            }
        }
        let frames = on_device(self.device, self.volume, &scenes);
        let mut wrong = Vec::new();
        for (((what, limits), scene), frame) in told.iter().zip(&scenes).zip(&frames) {
            let truth = on_reference(self.volume, scene);
            assert_sound(what, frame);
            assert_sound(what, &truth);
            for &(figure, limit) in *limits {
                let measured = figure.of(&truth, frame, self.volume);
                if measured > limit {
                    wrong.push(format!("{what}: {figure:?} {measured:.3e} > {limit}"));
                }
            }
        }
        wrong
    }
}

/// Every limit is broken by a picture moved by one pixel.
#[test]
fn the_limits_see_a_pixel() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = noise();
    let trial = Trial {
        device: &device,
        volume: &volume,
        name: "control".into(),
    };
    let camera = common::camera(&volume, common::OBLIQUE);
    let scene = |(mode, _): &(Mode, _)| trial.scene(picture(*mode, &volume), camera, size(21, 21));
    let scenes: Vec<Scene> = LIMITS.iter().map(scene).collect();
    let frames = on_device(&device, &volume, &scenes);
    for (((mode, limits), scene), frame) in LIMITS.iter().zip(&scenes).zip(&frames) {
        let truth = on_reference(&volume, scene);
        for &(figure, limit) in *limits {
            let control = figure.of(&truth, &moved_by_a_pixel(frame), &volume);
            assert!(control > limit, "{mode:?}: {figure:?} {control}");
        }
    }
}

fn size(width: u32, height: u32) -> ImageSize {
    ImageSize::new(width, height).unwrap()
}

fn report(wrong: &[String]) {
    assert!(
        wrong.is_empty(),
        "{} wrong:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

fn noise() -> Volume {
    volume_of([9, 9, 9], |x, y, z| (255.0 * hash(x, y, z)) as u8)
}

const DIRECTIONS: [DVec3; 7] = [
    DVec3::X,
    DVec3::NEG_X,
    DVec3::Y,
    DVec3::NEG_Y,
    DVec3::Z,
    DVec3::NEG_Z,
    DVec3::new(1.0, 1.0, 0.0),
];

/// Orthographic, every half voxel a ray: in the volume's faces, beside them, through voxel centres,
/// in cell faces, along cell edges. Along (1,1,0) rays pass from cell to cell through edges.
#[test]
fn rays_along_the_grid() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = noise();
    let trial = Trial {
        device: &device,
        volume: &volume,
        name: "grid".into(),
    };
    let center = DVec3::splat(4.0);
    let camera = |toward_eye: DVec3| {
        let up = if toward_eye.z == 0.0 {
            DVec3::Z
        } else {
            DVec3::Y
        };
        let lens = Lens::Orthographic { height_mm: 9.5 };
        let camera = Camera::look_at(center + toward_eye * 16.0, center, up, lens).unwrap();
        (format!("{toward_eye}"), camera, size(19, 19))
    };
    report(&trial.failures(&DIRECTIONS.map(camera)));
}

#[test]
fn rays_through_corners_along_the_diagonal() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = noise();
    let trial = Trial {
        device: &device,
        volume: &volume,
        name: "diagonal".into(),
    };
    let lens = Lens::Orthographic { height_mm: 1e-3 };
    let mut cameras = Vec::new();
    for toward in [
        DVec3::ONE,
        DVec3::new(1.0, -1.0, 1.0),
        DVec3::new(-1.0, -1.0, 1.0),
    ] {
        let center = DVec3::splat(4.0);
        let camera = Camera::look_at(center + toward * 16.0, center, DVec3::Z, lens).unwrap();
        cameras.push((format!("{toward}"), camera, size(1, 1)));
    }
    report(&trial.failures(&cameras));
}

#[test]
fn eyes_on_the_grid() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = noise();
    let trial = Trial {
        device: &device,
        volume: &volume,
        name: "eye".into(),
    };
    let eyes = [
        ("a face", DVec3::new(0.0, 3.3, 4.7)),
        ("a far face", DVec3::new(8.0, 3.3, 4.7)),
        ("an edge", DVec3::new(0.0, 0.0, 4.7)),
        ("a corner", DVec3::ZERO),
        ("the far corner", DVec3::splat(8.0)),
        ("a voxel's centre", DVec3::splat(4.0)),
        ("a cell's face", DVec3::new(4.0, 3.3, 5.2)),
        ("inside a cell", DVec3::new(3.4, 4.3, 5.2)),
    ];
    let mut cameras = Vec::new();
    for (name, eye) in eyes {
        for target in [DVec3::new(4.1, 3.7, 4.2), eye + DVec3::X, eye - DVec3::Y] {
            let lens = Lens::Perspective { fov_deg: 70.0 };
            let camera = Camera::look_at(eye, target, DVec3::Z, lens).unwrap();
            cameras.push((format!("{name} to {target}"), camera, size(15, 15)));
        }
    }
    report(&trial.failures(&cameras));
}

/// Smooth, so that grazing rays see nothing sudden.
fn ball(dims: [u64; 3], geometry: Geometry) -> Volume {
    let middle = DVec3::from_array(dims.map(|n| (n - 1) as f64)) / 2.0;
    volume_with(dims, geometry, |x, y, z| {
        let q = (DVec3::new(x, y, z) - middle) / middle.max(DVec3::ONE);
        (250.0 * (-1.5 * q.length_squared()).exp()) as u8
    })
}

#[test]
fn extreme_cameras() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = ball([17, 15, 16], Geometry::default());
    let trial = Trial {
        device: &device,
        volume: &volume,
        name: "camera".into(),
    };
    let (center, radius_mm) = volume.bounding_sphere();
    let from = |distance: f64, fov_deg: f64| {
        let eye = center + common::OBLIQUE.normalize() * (distance * radius_mm);
        let lens = Lens::Perspective { fov_deg };
        let camera = Camera::look_at(eye, center, DVec3::Z, lens).unwrap();
        (
            format!("{distance} radii, {fov_deg} degrees"),
            camera,
            size(21, 21),
        )
    };
    // Depth from a hundred thousand extents has a float's digits left: none of a voxel.
    let wrong = trial.failures(&[
        from(600.0, 0.1),
        from(1e5, 1e-3),
        from(1.2, 175.0),
        from(0.0001, 175.0),
    ]);
    let wrong: Vec<_> = wrong
        .into_iter()
        .filter(|w| !(w.contains("100000") && w.contains("Depth")))
        .collect();
    report(&wrong);
}

#[test]
fn extreme_geometries() {
    let Some(device) = common::device() else {
        return;
    };
    let geometry = |origin: f64, spacing: DVec3| {
        Geometry::new(DVec3::splat(origin), DMat3::IDENTITY, spacing).unwrap()
    };
    let mut wrong = Vec::new();
    for (name, geometry) in [
        ("far origin", geometry(1e6, DVec3::ONE)),
        ("micro", geometry(0.0, DVec3::splat(1e-6))),
        ("mega", geometry(0.0, DVec3::splat(1e6))),
        ("micro far", geometry(1.0, DVec3::splat(1e-6))),
        ("needle", geometry(0.0, DVec3::new(1.0, 1.0, 100.0))),
    ] {
        let volume = ball([13, 14, 15], geometry);
        let trial = Trial {
            device: &device,
            volume: &volume,
            name: name.into(),
        };
        let camera = common::camera(&volume, common::OBLIQUE);
        wrong.extend(trial.failures(&[("oblique".into(), camera, size(21, 21))]));
    }
    report(&wrong);
}

#[test]
fn images_of_any_shape() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = ball([13, 14, 15], Geometry::default());
    let trial = Trial {
        device: &device,
        volume: &volume,
        name: "image".into(),
    };
    let camera = common::camera(&volume, common::OBLIQUE);
    let shapes = [(1, 1), (1, 33), (33, 1), (2, 2), (17, 31), (65, 3)];
    let cameras = shapes.map(|(w, h)| (format!("{w}x{h}"), camera, size(w, h)));
    report(&trial.failures(&cameras));
}

#[test]
fn volumes_of_any_size() {
    let Some(device) = common::device() else {
        return;
    };
    let mut wrong = Vec::new();
    let sizes = [
        [1, 1, 1],
        [1, 9, 9],
        [9, 1, 9],
        [9, 9, 1],
        [1, 1, 9],
        [9, 1, 1],
        [2, 2, 2],
        [3, 5, 7],
        [15, 16, 17],
        [31, 7, 8],
        [9, 33, 2],
    ];
    for dims in sizes {
        for volume in [
            volume_of(dims, |x, y, z| (255.0 * hash(x, y, z)) as u8),
            volume_of(dims, |_, _, _| 77u8),
        ] {
            let trial = Trial {
                device: &device,
                volume: &volume,
                name: format!("{dims:?} {:?}", volume.range()),
            };
            let camera = common::camera(&volume, common::OBLIQUE);
            wrong.extend(trial.failures(&[("oblique".into(), camera, size(17, 17))]));
        }
    }
    report(&wrong);
}

#[test]
fn values_of_any_magnitude() {
    let Some(device) = common::device() else {
        return;
    };
    let mut wrong = Vec::new();
    for scale in [1e-30, 1e-38, 1e30, 3e38, -1e30] {
        let volume = volume_of([9, 8, 7], |x, y, z| (scale * hash(x, y, z)) as f32);
        let trial = Trial {
            device: &device,
            volume: &volume,
            name: format!("{scale:e}"),
        };
        let camera = common::camera(&volume, common::OBLIQUE);
        wrong.extend(trial.failures(&[("oblique".into(), camera, size(17, 17))]));
    }
    report(&wrong);
}

/// The iso value at a voxel's value, a plateau, the ends of the range, beyond them. Caps make what
/// lies at the iso value itself visible.
#[test]
fn iso_values_of_any_kind() {
    let Some(device) = common::device() else {
        return;
    };
    // A plateau of 100 in the middle, a single voxel of 200, 20 outside.
    let volume = volume_of([12, 13, 11], |x, y, z| {
        if [x, y, z] == [6.0, 6.0, 5.0] {
            200u8
        } else if (3.0..9.0).contains(&x) && (3.0..9.0).contains(&y) && (3.0..8.0).contains(&z) {
            100
        } else {
            20
        }
    });
    let trial = Trial {
        device: &device,
        volume: &volume,
        name: "iso".into(),
    };
    let (center, _) = volume.bounding_sphere();
    let cameras = [
        common::camera(&volume, common::OBLIQUE),
        Camera::look_at(
            center + DVec3::Y * 40.0,
            center,
            DVec3::Z,
            Lens::Orthographic { height_mm: 10.0 },
        )
        .unwrap(),
    ];
    let isos = [
        20.0, 20.001, 60.0, 99.999, 100.0, 100.001, 199.999, 200.0, 200.001, 19.999, -1e30, 1e30,
        0.0,
    ];
    let mut scenes = Vec::new();
    for camera in cameras {
        for iso in isos {
            for caps in [true, false] {
                scenes.push((
                    iso,
                    caps,
                    trial.scene(surface(iso, caps), camera, size(31, 31)),
                ));
            }
        }
    }
    let only: Vec<Scene> = scenes.iter().map(|s| s.2.clone()).collect();
    let mut wrong = Vec::new();
    for ((iso, caps, scene), frame) in scenes.iter().zip(on_device(&device, &volume, &only)) {
        let truth = on_reference(&volume, scene);
        assert_sound("iso", &frame);
        let differ = differing_pixels(&truth, &frame);
        let depth = DepthP99.of(&truth, &frame, &volume);
        if differ > 0 || depth > 0.01 {
            wrong.push(format!(
                "iso {iso} caps {caps} {:?}: {differ} pixels, depth {depth}",
                scene.camera.lens()
            ));
        }
        let hits = truth.kind.iter().flatten().filter(|k| **k != 0).count();
        // By definition: nothing above the maximum, nothing changes sign at or below the minimum.
        if *iso > 200.0 || (*iso <= 20.0 && !caps) {
            assert_eq!(hits, 0, "iso {iso} caps {caps}");
        } else if *iso < 199.0 {
            assert!(hits > 0, "iso {iso} caps {caps}");
        }
        if *iso == 60.0 {
            assert!(differing_pixels(&truth, &moved_by_a_pixel(&frame)) > 0);
        }
    }
    report(&wrong);
}

/// Found by a ray through its centre, wherever in the octree it is: at the corners of leaves, of
/// nodes of every level, and of the volume.
#[test]
fn one_bright_voxel_is_found_at_every_kind_of_corner() {
    let Some(device) = common::device() else {
        return;
    };
    let places = [
        0.0, 1.0, 7.0, 8.0, 9.0, 15.0, 16.0, 17.0, 31.0, 32.0, 33.0, 39.0,
    ];
    for (n, &x) in places.iter().enumerate() {
        let at = DVec3::new(
            x,
            places[(n + 3) % places.len()],
            places[(2 * n + 1) % places.len()],
        );
        let volume = volume_of([40, 40, 40], |x, y, z| {
            if DVec3::new(x, y, z) == at { 255u8 } else { 0 }
        });
        let trial = Trial {
            device: &device,
            volume: &volume,
            name: format!("{at}"),
        };
        let through = |to: DVec3, toward_eye: DVec3| {
            let lens = Lens::Orthographic { height_mm: 1e-4 };
            let up = toward_eye.any_orthonormal_vector();
            Camera::look_at(to + toward_eye * 100.0, to, up, lens).unwrap()
        };
        // Toward the eye, and the least maximum. Across two or three axes the field about a voxel
        // is a cusp with hollow sides, of which probing between samples finds nine tenths.
        let ways = [
            (DVec3::X, 254.9),
            (DVec3::NEG_Y, 254.9),
            (DVec3::Z, 254.9),
            (DVec3::new(0.6, 0.0, 0.8), 254.0),
            (DVec3::new(-0.48, 0.6, -0.64), 254.0),
        ];
        let mut scenes = Vec::new();
        for (toward_eye, _) in ways {
            for mode in [Mode::Mip, Mode::Iso, Mode::Dvr] {
                let camera = through(at, toward_eye);
                let mut scene = trial.scene(picture(mode, &volume), camera, size(1, 1));
                scene.sampling.step_voxels = 0.5;
                scenes.push(scene);
            }
        }
        // The control: two voxels beside it there is nothing.
        let beside = at + DVec3::new(if at.x < 20.0 { 2.0 } else { -2.0 }, 0.0, 0.0);
        scenes.push(trial.scene(
            picture(Mode::Mip, &volume),
            through(beside, DVec3::Z),
            size(1, 1),
        ));
        let frames = on_device(&device, &volume, &scenes);
        let (control, found) = frames.split_last().unwrap();
        assert_eq!(control.value.as_ref().unwrap()[0], 0.0);
        for (seen, (toward_eye, least)) in found.chunks(3).zip(ways) {
            let value = seen[0].value.as_ref().unwrap()[0];
            assert!(
                value > least,
                "{at} along {toward_eye}: the maximum is {value}"
            );
            assert_ne!(
                seen[1].kind.as_ref().unwrap()[0],
                0,
                "{at}: the surface is missed"
            );
            assert!(
                seen[2].color[0][3] > 0.05,
                "{at}: opacity {}",
                seen[2].color[0][3]
            );
        }
    }
}

#[test]
fn transfer_functions_of_any_kind() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = volume_of([12, 13, 11], |x, y, z| {
        (20.0 * x + 3.0 * y + 2.0 * (z * 0.7).sin() * z) as u8
    });
    let trial = Trial {
        device: &device,
        volume: &volume,
        name: "transfer".into(),
    };
    let camera = common::camera(&volume, common::OBLIQUE);
    // Name, points, unit length, limit of opacity. An opaque mm absorbs 13.8: rays that graze an
    // edge of the volume feel a path that is wrong by a millionth of it.
    type Case<'a> = (&'a str, &'a [(f64, f64)], f64, f64);
    let cases: [Case; 11] = [
        ("transparent", &[(0.0, 0.0), (255.0, 0.0)], 1.0, 0.0),
        ("one clear knot", &[(50.0, 0.0)], 1.0, 0.0),
        ("opaque", &[(0.0, 1.0), (255.0, 1.0)], 1.0, 1e-4),
        ("opaque at once", &[(50.0, 1.0)], 1e-6, 1e-6),
        ("one knot", &[(50.0, 0.1)], 2.0, 1e-5),
        ("faint", &[(50.0, 1e-6)], 1.0, 1e-8),
        ("beyond the range", &[(1e6, 0.0), (2e6, 1.0)], 1.0, 0.0),
        ("below the range", &[(-2e6, 1.0), (-1e6, 0.2)], 4.0, 1e-5),
        ("a ramp", &[(0.0, 0.0), (255.0, 0.3)], 1.0, 0.001),
        ("a jump", &[(120.0, 0.0), (120.0, 0.3)], 4.0, 0.01),
        (
            "stairs",
            &[
                (60.0, 0.0),
                (60.0, 0.1),
                (120.0, 0.1),
                (120.0, 0.3),
                (180.0, 0.3),
                (180.0, 0.05),
            ],
            4.0,
            0.01,
        ),
    ];
    let scenes = cases
        .map(|(_, knots, unit_mm, _)| trial.scene(emission(knots, unit_mm), camera, size(25, 25)));
    let frames = on_device(&device, &volume, &scenes);
    let mut wrong = Vec::new();
    for (((name, _, _, limit), scene), frame) in cases.iter().zip(&scenes).zip(&frames) {
        let truth = on_reference(&volume, scene);
        assert_sound(name, frame);
        let measured = AlphaMax.of(&truth, frame, &volume);
        println!("{name}: {measured:.2e}");
        if measured > *limit {
            wrong.push(format!("{name}: {measured:.3e} > {limit}"));
        }
        // Where there is something to see, a pixel's move is seen.
        if *limit > 0.0 {
            assert!(
                AlphaMax.of(&truth, &moved_by_a_pixel(frame), &volume) > *limit,
                "{name}"
            );
        }
    }
    report(&wrong);
}

#[test]
fn nearest_voxels_along_the_grid() {
    let Some(device) = common::device() else {
        return;
    };
    // Off the walls between voxels, where a tie is anyone's.
    let volume = noise();
    let trial = Trial {
        device: &device,
        volume: &volume,
        name: "nearest".into(),
    };
    let center = DVec3::splat(4.1);
    for toward_eye in [DVec3::X, DVec3::NEG_Y, DVec3::Z] {
        let up = if toward_eye.z == 0.0 {
            DVec3::Z
        } else {
            DVec3::Y
        };
        let lens = Lens::Orthographic { height_mm: 8.0 };
        let camera = Camera::look_at(center + toward_eye * 16.0, center, up, lens).unwrap();
        let mut scene = trial.scene(picture(Mode::Mip, &volume), camera, size(16, 16));
        scene.sampling.filter = Filter::Nearest;
        let frame = &on_device(&device, &volume, std::slice::from_ref(&scene))[0];
        let truth = on_reference(&volume, &scene);
        assert_eq!(truth.value, frame.value, "{toward_eye}");
        assert_ne!(truth.value, moved_by_a_pixel(frame).value);
    }
}

/// Negative and mixed values: physical 0 is nothing special.
#[test]
fn denormal_and_signed_values() {
    let Some(device) = common::device() else {
        return;
    };
    let mut wrong = Vec::new();
    for (name, low, high) in [
        ("denormal", 1e-42, 1e-40),
        ("signed", -1.0, 1.0),
        ("shifted", 1e6, 1e6 + 64.0),
    ] {
        let voxels: Vec<f32> = (0..9 * 8 * 7)
            .map(|i| {
                (low + (high - low)
                    * hash(f64::from(i % 9), f64::from(i / 9 % 8), f64::from(i / 72)))
                    as f32
            })
            .collect();
        let volume = Volume::new(
            Dims::new([9, 8, 7]).unwrap(),
            Voxels::from(voxels),
            Geometry::default(),
            Rescale::IDENTITY,
            NonFinite::Refuse,
        )
        .unwrap();
        let trial = Trial {
            device: &device,
            volume: &volume,
            name: name.into(),
        };
        let camera = common::camera(&volume, common::OBLIQUE);
        wrong.extend(trial.failures(&[("oblique".into(), camera, size(17, 17))]));
    }
    report(&wrong);
}
