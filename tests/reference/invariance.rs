//! What must not change: the scene moved, turned, scaled or mirrored as a whole.

use angioray::frame::Kind;
use angioray::reference::{RayResult, Tracer};
use angioray::scene::{
    Camera, Knot, Lens, Phong, Picture, Projection, Rgb, Scene, TransferFunction,
};
use angioray::volume::{Geometry, Volume};
use glam::{DMat3, DQuat, DVec3};

use crate::common::*;

/// Smooth, without symmetry, so that no two directions agree by chance.
fn blobs(geometry: Geometry) -> Volume {
    volume([12, 10, 9], geometry, field)
}

fn field(p: DVec3) -> f64 {
    let blob = |x: f64, y: f64, z: f64, w: f64| {
        (-p.distance_squared(DVec3::new(x, y, z)) / (2.0 * w * w)).exp()
    };
    10.0 * (blob(4.0, 4.0, 4.0, 2.0) + 0.7 * blob(8.0, 6.0, 3.0, 1.5)) + 0.01 * p.x
}

fn transfer(unit_length_mm: f64) -> TransferFunction {
    let knot = |value, color, opacity| Knot {
        value,
        color: Rgb(color),
        opacity,
    };
    let knots = vec![
        knot(1.0, [0.1, 0.3, 0.9], 0.0),
        knot(5.0, [0.9, 0.3, 0.1], 0.4),
        knot(9.0, [1.0, 0.9, 0.8], 0.8),
    ];
    TransferFunction::new(knots, unit_length_mm).unwrap()
}

fn pictures(unit_length_mm: f64) -> Vec<Picture> {
    let mut lit = iso(4.0, true);
    if let Picture::Surface { phong, .. } = &mut lit {
        *phong = Some(Phong::default());
    }
    vec![
        lit,
        projection(Projection::Maximum),
        projection(Projection::Mean),
        projection(Projection::LocalMaximum { threshold: 3.0 }),
        dvr(transfer(unit_length_mm), None),
        dvr(transfer(unit_length_mm), Some(Phong::default())),
    ]
}

fn results(volume: &Volume, picture: Picture, camera: Camera) -> Vec<RayResult> {
    let scene = Scene {
        camera,
        ..scene(picture)
    };
    let tracer = Tracer::new(volume, &scene).unwrap();
    let pixels = (0..64).map(|i| (f64::from(i % 8) + 0.5, f64::from(i / 8) + 0.5));
    pixels
        .map(|(x, y)| tracer.cast(scene.camera.ray(scene.size, x, y)))
        .collect()
}

/// The largest difference of two pictures, depths divided by `scale`, normals turned by `turn`.
fn difference(a: &[RayResult], b: &[RayResult], turn: DMat3, scale: f64) -> f64 {
    let mut worst = 0.0_f64;
    for (a, b) in a.iter().zip(b) {
        worst = worst.max((a.value - b.value).abs());
        worst = worst.max((turn * a.normal_world).distance(b.normal_world));
        for c in 0..4 {
            worst = worst.max((a.color[c] - b.color[c]).abs());
        }
        if a.depth_mm.is_finite() || b.depth_mm.is_finite() {
            worst = worst.max((a.depth_mm - b.depth_mm / scale).abs());
        }
    }
    assert!(a.iter().any(|s| s.color[3] > 0.0));
    worst
}

fn camera(eye: DVec3, target: DVec3, up: DVec3) -> Camera {
    Camera::look_at(eye, target, up, Lens::Perspective { fov_deg: 25.0 }).unwrap()
}

const EYE: DVec3 = DVec3::new(30.0, -25.0, 14.0);
const TARGET: DVec3 = DVec3::new(5.0, 5.0, 4.0);
const UP: DVec3 = DVec3::new(0.1, 0.2, 1.0);

#[test]
fn turning_volume_and_camera_together_changes_nothing() {
    let turn = DMat3::from_quat(DQuat::from_axis_angle(
        DVec3::new(2.0, -1.0, 0.6).normalize(),
        1.1,
    ));
    let shift = DVec3::new(-40.0, 13.0, 77.0);
    let plain = Geometry::new(DVec3::ZERO, DMat3::IDENTITY, DVec3::new(1.0, 1.25, 0.75)).unwrap();
    let turned = Geometry::new(shift, turn, plain.spacing_mm()).unwrap();
    for picture in pictures(1.0) {
        let still = results(&blobs(plain), picture.clone(), camera(EYE, TARGET, UP));
        let to = |p: DVec3| turn * p + shift;
        let moved = camera(to(EYE), to(TARGET), turn * UP);
        let moved = results(&blobs(turned), picture.clone(), moved);
        // The integrator may split elsewhere: it answers for 1e-8.
        let limit = if picture.mode().name() == "dvr" {
            2e-8
        } else {
            1e-9
        };
        assert!(
            difference(&still, &moved, turn, 1.0) < limit,
            "{}",
            picture.mode()
        );
        let tilted = camera(to(EYE), to(TARGET) + 1e-4, turn * UP);
        let tilted = results(&blobs(turned), picture, tilted);
        assert!(difference(&still, &tilted, turn, 1.0) > limit);
    }
}

#[test]
fn a_left_handed_file_of_the_same_object_gives_the_same_picture() {
    let plain = Geometry::default();
    let mirrored = Geometry::new(
        DVec3::new(11.0, 0.0, 0.0),
        DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)),
        DVec3::ONE,
    )
    .unwrap();
    let reversed = volume([12, 10, 9], mirrored, |p| {
        field(DVec3::new(11.0 - p.x, p.y, p.z))
    });
    for picture in pictures(1.0) {
        let a = results(&blobs(plain), picture.clone(), camera(EYE, TARGET, UP));
        let b = results(&reversed, picture.clone(), camera(EYE, TARGET, UP));
        assert!(
            difference(&a, &b, DMat3::IDENTITY, 1.0) < 2e-8,
            "{}",
            picture.mode()
        );
        let wrong = results(&blobs(mirrored), picture, camera(EYE, TARGET, UP));
        assert!(difference(&a, &wrong, DMat3::IDENTITY, 1.0) > 1e-3);
    }
}

#[test]
fn scaling_everything_scales_depth_alone() {
    for scale in [2.0, 1e-6, 1e6] {
        let scaled = Geometry::new(DVec3::ZERO, DMat3::IDENTITY, DVec3::splat(scale)).unwrap();
        for (small, large) in pictures(1.0).into_iter().zip(pictures(scale)) {
            let a = results(&blobs(Geometry::default()), small, camera(EYE, TARGET, UP));
            let far = camera(EYE * scale, TARGET * scale, UP);
            let mode = large.mode().name();
            let b = results(&blobs(scaled), large, far);
            assert!(
                difference(&a, &b, DMat3::IDENTITY, scale) < 2e-8,
                "{mode} {scale}"
            );
            assert!(
                difference(&a, &b, DMat3::IDENTITY, scale * 1.001) > 2e-8
                    || mode == "dvr"
                    || mode == "mean"
            );
        }
    }
}

#[test]
fn a_far_origin_and_a_far_eye_cost_few_digits() {
    let away = DVec3::new(1e6, -2e6, 5e5);
    let there = Geometry::new(away, DMat3::IDENTITY, DVec3::ONE).unwrap();
    let a = results(
        &blobs(Geometry::default()),
        iso(4.0, true),
        camera(EYE, TARGET, UP),
    );
    let b = results(
        &blobs(there),
        iso(4.0, true),
        camera(EYE + away, TARGET + away, UP),
    );
    assert!(difference(&a, &b, DMat3::IDENTITY, 1.0) < 1e-7);
    assert!(difference(&a, &b, DMat3::IDENTITY, 1.001) > 1e-7);
    // The same ray from 1e6 mm behind: the hit stays where it is.
    let near = cast(&blobs(Geometry::default()), iso(4.0, true), EYE, TARGET);
    let dir = (TARGET - EYE).normalize();
    let far = cast(
        &blobs(Geometry::default()),
        iso(4.0, true),
        EYE - dir * 1e6,
        TARGET,
    );
    assert_eq!(near.kind, Kind::Surface);
    assert!((far.depth_mm - 1e6 - near.depth_mm).abs() < 1e-8);
}
