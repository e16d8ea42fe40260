//! Rays along the voxel grid and through its corners, and eyes on it.

use angioray::frame::{KIND, VALUE};
use angioray::gpu::Device;
use angioray::scene::{Camera, Filter, Lens, StepVoxels};
use glam::DVec3;

use super::{Mode, Trial, noise, picture, report, size};
use crate::common::{self, moved_by_a_pixel, on_device, on_reference, volume_of};

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
        check_bright_voxel(&device, at);
    }
}

/// That one bright voxel is found from every side.
fn check_bright_voxel(device: &Device, at: DVec3) {
    let volume = volume_of([40, 40, 40], |x, y, z| {
        if DVec3::new(x, y, z) == at { 255u8 } else { 0 }
    });
    let trial = Trial {
        device,
        volume: &volume,
        name: format!("{at}"),
    };
    let through = |to: DVec3, toward_eye: DVec3| {
        let lens = Lens::Orthographic { height_mm: 1e-4 };
        let up = toward_eye.any_orthonormal_vector();
        Camera::look_at(to + toward_eye * 100.0, to, up, lens).unwrap()
    };
    // Toward the eye, and the smallest maximum. Across two or three axes the field about a voxel
    // is a cusp with hollow sides, of which probing between samples finds nine tenths.
    let directions = [
        (DVec3::X, 254.9),
        (DVec3::NEG_Y, 254.9),
        (DVec3::Z, 254.9),
        (DVec3::new(0.6, 0.0, 0.8), 254.0),
        (DVec3::new(-0.48, 0.6, -0.64), 254.0),
    ];
    let mut scenes = Vec::new();
    for (toward_eye, _) in directions {
        for mode in [Mode::Mip, Mode::Iso, Mode::Dvr] {
            let camera = through(at, toward_eye);
            let mut scene = trial.scene(picture(mode, &volume), camera, size(1, 1));
            scene.sampling.step = StepVoxels::new(0.5).unwrap();
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
    let frames = on_device(device, &volume, &scenes);
    let (control, found) = frames.split_last().unwrap();
    assert_eq!(control.plane(VALUE).unwrap()[0], 0.0);
    for (seen, (toward_eye, min)) in found.chunks(3).zip(directions) {
        let value = seen[0].plane(VALUE).unwrap()[0];
        assert!(
            value > min,
            "{at} along {toward_eye}: the maximum is {value}"
        );
        assert_ne!(
            seen[1].plane(KIND).unwrap()[0],
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

#[test]
fn nearest_voxels_along_the_grid() {
    let Some(device) = common::device() else {
        return;
    };
    // Off the faces between voxels, where a tie may go either way.
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
        let reference = on_reference(&volume, &scene);
        let expected = reference.plane(VALUE).unwrap();
        assert_eq!(frame.plane(VALUE).unwrap(), expected, "{toward_eye}");
        assert_ne!(moved_by_a_pixel(frame).plane(VALUE).unwrap(), expected);
    }
}
