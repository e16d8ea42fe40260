//! Extreme cameras and geometries, images of any shape, volumes of any size.

use angioray::scene::{Camera, Lens};
use angioray::volume::{Geometry, Volume};
use glam::{DMat3, DVec3};

use super::{Trial, report, size};
use crate::common::{self, hash, volume_of, volume_with};

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
