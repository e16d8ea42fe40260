//! Maximum, minimum, mean and first local maximum.

use angioray::frame::Kind;
use angioray::scene::{Projection, linear_from_srgb};
use angioray::volume::Geometry;
use glam::DVec3;

use crate::common::*;

#[test]
fn a_ramp_has_its_extremes_at_the_ends_and_its_mean_between() {
    let b = DVec3::new(3.0, -2.0, 0.5);
    for geometry in [Geometry::default(), oblique(true)] {
        let ramp = volume([9, 7, 5], geometry, |p| b.dot(p));
        let mut random = Random(1);
        for _ in 0..200 {
            let (eye, toward) = random_ray(&mut random, &ramp);
            let dir = (toward - eye).normalize();
            let (enter, leave) = path(&ramp, eye, toward, toward);
            let value = |t: f64| b.dot(geometry.index_from_world().transform_point3(eye + dir * t));
            let (a, z) = (value(enter), value(leave));
            let (high_mm, low_mm) = if a > z {
                (enter, leave)
            } else {
                (leave, enter)
            };
            let seen = |of| cast(&ramp, projection(of), eye, toward);
            let maximum = seen(Projection::Maximum);
            let off = |value: f64, at_mm: f64| {
                (maximum.value - value).abs() + (maximum.depth_mm - at_mm).abs()
            };
            assert!(off(a.max(z), high_mm) < 1e-10);
            assert!(off(a.max(z), low_mm) > 1e-10 && off(a.max(z) - 1e-9, high_mm) > 1e-10);
            let minimum = seen(Projection::Minimum);
            assert!((minimum.value - a.min(z)).abs() < 1e-10);
            assert!((minimum.depth_mm - low_mm).abs() < 1e-10);
            let mean = seen(Projection::Mean);
            assert!((mean.value - (a + z) / 2.0).abs() < 1e-11);
            assert_eq!(mean.depth_mm, f64::INFINITY);
        }
    }
}

#[test]
fn turning_points_inside_a_cell_are_exact() {
    let (eye, toward) = (DVec3::splat(-1.0), DVec3::ONE);
    // 12 s (1 − s).
    let arch = diagonal([0.0, 4.0, 4.0, 0.0]);
    let maximum = cast(&arch, projection(Projection::Maximum), eye, toward);
    assert!((maximum.value - 3.0).abs() < 1e-14);
    assert!((maximum.depth_mm - 1.5 * DIAGONAL_MM).abs() < 1e-7);
    let mean = cast(&arch, projection(Projection::Mean), eye, toward);
    assert!((mean.value - 2.0).abs() < 1e-14);
    // 96 (s − 1/4)(s − 1/2)(s − 3/4) turns at 1/2 ± √(1/48).
    let wave = diagonal([-9.0, 13.0, -13.0, 9.0]);
    let f = |s: f64| 96.0 * (s - 0.25) * (s - 0.5) * (s - 0.75);
    let turn = 0.5 - (1.0_f64 / 48.0).sqrt();
    // The end of the cell, 9, is higher than the turning point; the start is lower than the other.
    assert!(f(turn) < 9.0);
    let maximum = cast(&wave, projection(Projection::Maximum), eye, toward);
    assert!((maximum.value - 9.0).abs() < 1e-13);
    let local = Projection::LocalMaximum {
        threshold: f(turn) - 1e-9,
    };
    let local = cast(&wave, projection(local), eye, toward);
    assert!((local.value - f(turn)).abs() < 1e-13);
    assert!((local.depth_mm - (1.0 + turn) * DIAGONAL_MM).abs() < 1e-7);
    let above = Projection::LocalMaximum {
        threshold: f(turn) + 1e-9,
    };
    assert!((cast(&wave, projection(above), eye, toward).value - 9.0).abs() < 1e-13);
    let mean = cast(&wave, projection(Projection::Mean), eye, toward);
    assert!(mean.value.abs() < 1e-14);
}

#[test]
fn in_noise_samples_stay_within_the_extremes_and_come_close() {
    let mut random = Random(21);
    for case in 0..60 {
        let noise = random.noise(5, oblique(case % 2 == 0), 10.0);
        let (eye, toward) = random_ray(&mut random, &noise);
        let dir = (toward - eye).normalize();
        let (enter, leave) = path(&noise, eye, toward, toward);
        let seen = |of| cast(&noise, projection(of), eye, toward);
        let (high, low) = (seen(Projection::Maximum), seen(Projection::Minimum));
        let mean = seen(Projection::Mean).value;
        let (mut top, mut bottom, mut sum) = (f64::MIN, f64::MAX, 0.0);
        const SAMPLES: u32 = 4000;
        for i in 0..SAMPLES {
            let t = enter + (leave - enter) * (f64::from(i) + 0.5) / f64::from(SAMPLES);
            let p = noise
                .geometry()
                .index_from_world()
                .transform_point3(eye + dir * t);
            let value = phi(&noise, p.clamp(DVec3::ZERO, last(&noise)));
            (top, bottom, sum) = (top.max(value), bottom.min(value), sum + value);
            assert!(t >= high.depth_mm || value <= high.value - 1e-13 || t > high.depth_mm - 1e-6);
        }
        // An end's slope may cost half a sample's step.
        let off = |a: f64, b: f64| (-1e-12..0.05).contains(&(a - b));
        assert!(off(high.value, top) && off(bottom, low.value));
        assert!(!off(high.value - 0.1, top) && !off(bottom, low.value + 0.1));
        assert!((mean - sum / f64::from(SAMPLES)).abs() < 1e-4);
    }
}

/// Value and depth of the first local maximum along a profile.
fn local(values: &[f64], threshold: f64) -> (f64, f64) {
    let at = |x: f64| DVec3::new(x, 0.5, 0.5);
    let of = Projection::LocalMaximum { threshold };
    let seen = cast(&profile(values), projection(of), at(-1.0), at(9.0));
    (seen.value, seen.depth_mm - 1.0)
}

#[test]
fn the_first_local_maximum_above_the_threshold() {
    let bumps = [0.0, 3.0, 1.0, 5.0, 0.0];
    assert_eq!(local(&bumps, 2.0), (3.0, 1.0));
    assert_eq!(local(&bumps, 3.0), (3.0, 1.0));
    assert_eq!(local(&bumps, 3.0_f64.next_up()), (5.0, 3.0));
    assert_eq!(local(&bumps, 9.0), (5.0, 3.0));
    // Both ends count, when the value falls away from them.
    assert_eq!(local(&[4.0, 1.0, 5.0], 3.0), (4.0, 0.0));
    assert_eq!(local(&[4.0, 1.0, 5.0], 4.5), (5.0, 2.0));
    // A plateau counts at its start, when the value falls after it; not when it rises.
    assert_eq!(local(&[1.0, 5.0, 5.0, 2.0, 9.0], 3.0), (5.0, 1.0));
    assert_eq!(local(&[1.0, 5.0, 5.0, 6.0, 2.0], 3.0), (6.0, 3.0));
    assert_eq!(local(&[7.0, 7.0, 7.0], 3.0), (7.0, 0.0));
    assert_eq!(local(&[2.0, 7.0, 7.0], 3.0), (7.0, 1.0));
}

#[test]
fn a_plateau_is_reached_where_it_begins() {
    let at = |x: f64| DVec3::new(x, 0.25, 0.75);
    let flat = profile(&[1.0, 8.0, 8.0, 8.0, 2.0, 0.0, 0.0, 3.0]);
    let seen = |of| cast(&flat, projection(of), at(-1.0), at(9.0));
    assert_eq!(seen(Projection::Maximum).depth_mm, 2.0);
    assert_eq!(seen(Projection::Minimum).depth_mm, 6.0);
}

#[test]
fn the_nearest_filter_projects_the_voxels_boxes() {
    let steps = profile(&[0.0, 4.0, 8.0]);
    let at = |x: f64| DVec3::new(x, 0.5, 0.5);
    let seen = |of| cast_nearest(&steps, projection(of), at(-1.0), at(9.0));
    // Half a voxel of 0, one of 4, half of 8.
    assert_eq!(seen(Projection::Mean).value, 4.0);
    assert_eq!(seen(Projection::Maximum).value, 8.0);
    assert_eq!(seen(Projection::Maximum).depth_mm, 2.5);
    let linear = cast(&steps, projection(Projection::Maximum), at(-1.0), at(9.0));
    assert_eq!(linear.depth_mm, 3.0);
}

#[test]
fn the_window_makes_the_grey() {
    let half = profile(&[5.0, 5.0]);
    let at = |x: f64, y: f64| DVec3::new(x, y, 0.5);
    let seen = cast(
        &half,
        projection(Projection::Maximum),
        at(-1.0, 0.5),
        at(9.0, 0.5),
    );
    let grey = linear_from_srgb(0.5);
    assert_eq!(seen.color, [grey, grey, grey, 1.0]);
    assert_eq!(seen.kind, Kind::Surface);
    let beside = cast(
        &half,
        projection(Projection::Maximum),
        at(-1.0, 1.5),
        at(9.0, 1.5),
    );
    assert_eq!(
        (beside.color, beside.kind, beside.value),
        ([0.0; 4], Kind::Nothing, 0.0)
    );
    assert_eq!(beside.depth_mm, f64::INFINITY);
}
