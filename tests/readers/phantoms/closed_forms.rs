//! The phantoms given by a formula: their voxels, isosurfaces and integrals.

use std::f64::consts::PI;

use angioray::volume::{Phantom, PhantomKind, PhantomSpec, VoxelType, phantom};
use glam::DVec3;

use super::{spec, stored, trilinear};

/// The largest difference between the phantom and `closed`, which gives the fraction at a position
/// in mm from the centre and an index, over a scatter of voxels; as a share of the value range.
fn worst(made: &Phantom, spec: &PhantomSpec, closed: impl Fn(DVec3, [u32; 3]) -> f64) -> f64 {
    let n = spec.dims.array();
    let values = spec.values();
    let mut state = 7_u64;
    let mut pick = |n: u32| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        ((state >> 33) % u64::from(n)) as u32
    };
    let mut worst: f64 = 0.0;
    for _ in 0..20_000 {
        let at = [pick(n[0]), pick(n[1]), pick(n[2])];
        let mut p = DVec3::ZERO;
        for axis in 0..3 {
            p[axis] = (f64::from(at[axis]) - f64::from(n[axis] - 1) / 2.0) * spec.spacing_mm[axis];
        }
        let fraction = (stored(&made.volume, at) - values.min) / (values.max - values.min);
        worst = worst.max((fraction - closed(p, at)).abs());
    }
    worst
}

/// Half a step of the voxel type, as a share of the value range.
fn rounding(voxel_type: VoxelType) -> f64 {
    match voxel_type {
        VoxelType::U8 => 0.5 / 200.0,
        VoxelType::U16 => 0.5 / 50_000.0,
        VoxelType::I16 => 0.5 / 4_000.0,
        VoxelType::F32 => 1e-7,
    }
}

/// Every voxel type, in an anisotropic volume: `closed(size)` must hold with the requested size,
/// and not with 1.1 times that.
fn holds(
    kind: PhantomKind,
    shape: impl Fn(&mut PhantomSpec),
    closed: impl Fn(f64, DVec3, [u32; 3]) -> f64,
    size: f64,
) {
    for voxel_type in VoxelType::ALL {
        let mut spec = spec(kind, [40, 31, 22]);
        spec.spacing_mm = DVec3::new(0.5, 0.75, 1.5);
        spec.voxel_type = voxel_type;
        shape(&mut spec);
        let made = phantom(&spec).unwrap();
        let allowed = rounding(voxel_type) + 1e-9;
        let found = worst(&made, &spec, |p, at| closed(size, p, at));
        assert!(found <= allowed, "{kind} {voxel_type}: {found}");
        let wrong = worst(&made, &spec, |p, at| closed(size * 1.1, p, at));
        assert!(
            wrong > 4.0 * allowed,
            "{kind} {voxel_type}: the check cannot fail"
        );
    }
}

#[test]
fn a_sphere_is_its_closed_form() {
    let closed =
        |radius: f64, p: DVec3, _: [u32; 3]| (0.5 + (radius - p.length()) / 6.0).clamp(0.0, 1.0);
    holds(
        PhantomKind::Sphere,
        |s| s.radius_mm = Some(7.0),
        closed,
        7.0,
    );
    // By default 0.35 of the smallest extent, 40 voxels of 0.5 mm.
    holds(PhantomKind::Sphere, |_| (), closed, 7.0);
}

#[test]
fn a_slab_is_its_closed_form() {
    for axis in 0..3 {
        let h = [0.5, 0.75, 1.5][axis];
        holds(
            PhantomKind::Slab,
            |s| {
                s.thickness_mm = Some(8.3);
                s.axis = Some(axis);
            },
            |thickness, p, _| (0.5 + (thickness / 2.0 - p[axis].abs()) / (2.0 * h)).clamp(0.0, 1.0),
            8.3,
        );
    }
}

#[test]
fn a_gaussian_is_its_closed_form() {
    holds(
        PhantomKind::Blob,
        |s| s.sigma_mm = Some(4.0),
        |sigma, p, _| (-p.length_squared() / (2.0 * sigma * sigma)).exp(),
        4.0,
    );
}

#[test]
fn the_marschner_lobb_signal_is_its_closed_form() {
    holds(
        PhantomKind::MarschnerLobb,
        |_| (),
        |frequency, _, at| {
            let unit =
                |axis: usize| 2.0 * f64::from(at[axis]) / f64::from([40, 31, 22][axis] - 1) - 1.0;
            let r = unit(0).hypot(unit(1));
            let rho = (2.0 * PI * frequency * (PI * r / 2.0).cos()).cos();
            (1.0 - (PI * unit(2) / 2.0).sin() + 0.25 * (1.0 + rho)) / 2.5
        },
        6.0,
    );
}

#[test]
fn a_single_voxel_stands_alone() {
    let spec = spec(PhantomKind::Voxel, [8, 5, 1]);
    let volume = phantom(&spec).unwrap().volume;
    for (i, j) in (0..8).flat_map(|i| (0..5).map(move |j| (i, j))) {
        let expected = if (i, j) == (4, 2) { 200.0 } else { 0.0 };
        assert_eq!(stored(&volume, [i, j, 0]), expected, "{i} {j}");
    }
    assert_eq!(volume.range().max, 200.0);
}

#[test]
fn a_ramp_is_linear_to_the_last_bit_in_whole_numbers() {
    for (voxel_type, nx, step) in [
        (VoxelType::U8, 41, 5.0),
        (VoxelType::U8, 128, 1.0),
        (VoxelType::U16, 128, 393.0),
        (VoxelType::I16, 128, 31.0),
    ] {
        let mut spec = spec(PhantomKind::Ramp, [nx, 3, 2]);
        spec.voxel_type = voxel_type;
        let volume = phantom(&spec).unwrap().volume;
        let is_linear = |step: f64| {
            (0..nx as u32)
                .all(|i| stored(&volume, [i, 2, 1]) == spec.values().min + step * f64::from(i))
        };
        assert!(is_linear(step), "{voxel_type} {nx}");
        assert!(!is_linear(step + 1.0));
        let middle = trilinear(&volume, DVec3::new(7.3, 0.4, 0.9));
        assert!((middle - spec.values().min - 7.3 * step).abs() < 1e-9);
    }
    let mut spec = spec(PhantomKind::Ramp, [128, 3, 2]);
    spec.voxel_type = VoxelType::F32;
    let made = phantom(&spec).unwrap();
    assert!(worst(&made, &spec, |_, at| f64::from(at[0]) / 127.0) < 1e-7);
    assert!(worst(&made, &spec, |_, at| f64::from(at[0]) / 128.0) > 1e-3);
}

/// How far the mid-value isosurface of the trilinear field lies from a sphere of `radius` voxels,
/// at the most, over a scatter of directions.
fn sphere_error(n: u64, voxel_type: VoxelType, radius: f64) -> f64 {
    let mut spec = spec(PhantomKind::Sphere, [n; 3]);
    spec.voxel_type = voxel_type;
    spec.radius_mm = Some(0.35 * n as f64);
    let volume = phantom(&spec).unwrap().volume;
    let centre = DVec3::splat((n - 1) as f64 / 2.0);
    let mid = spec.values().at(0.5);
    let mut worst: f64 = 0.0;
    for sample in 0..500 {
        let z = 2.0 * (f64::from(sample) + 0.5) / 500.0 - 1.0;
        let (sin, cos) = (2.399_963 * f64::from(sample)).sin_cos();
        let side = (1.0 - z * z).sqrt();
        let direction = DVec3::new(side * cos, side * sin, z);
        let (mut inside, mut outside) = (0.0, n as f64 * 0.49);
        for _ in 0..50 {
            let middle = (inside + outside) / 2.0;
            if trilinear(&volume, centre + middle * direction) >= mid {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        worst = worst.max((inside - radius).abs());
    }
    worst
}

#[test]
fn a_spheres_isosurface_is_the_sphere() {
    // Linear interpolation of the distance overestimates it by h²/(4 R) at most, and a little by
    // higher orders.
    for n in [16, 32, 64] {
        let radius = 0.35 * n as f64;
        let bound = 1.05 / (4.0 * radius);
        assert!(sphere_error(n, VoxelType::F32, radius) < bound + 1e-5);
        assert!(sphere_error(n, VoxelType::F32, radius + 0.2) > bound);
        // Half a step of 1/200 over a ramp of 4 voxels, on either side.
        assert!(sphere_error(n, VoxelType::U8, radius) < bound + 0.02);
    }
}

#[test]
fn a_sphere_holds_the_volume_of_a_ball() {
    let mut spec = spec(PhantomKind::Sphere, [64; 3]);
    spec.voxel_type = VoxelType::F32;
    let volume = phantom(&spec).unwrap().volume;
    let values: Vec<f64> = (0..volume.voxels().len())
        .map(|n| volume.voxels().stored(n))
        .collect();
    let ball = |radius: f64| 4.0 / 3.0 * PI * radius.powi(3);
    let inside = values.iter().filter(|&&v| v >= 0.5).count() as f64;
    let share_off = |radius: f64| (inside / ball(radius) - 1.0).abs();
    assert!(share_off(22.4) < 5e-3, "{}", share_off(22.4));
    assert!(share_off(22.6) > 5e-3);
    // The ramp is a mean over balls from R − w to R + w.
    let sum: f64 = values.iter().sum();
    let mean = ball(22.4) + 4.0 / 3.0 * PI * 22.4 * 4.0;
    assert!((sum / mean - 1.0).abs() < 1e-4, "{}", sum / mean);
}

#[test]
fn a_slabs_faces_and_integral_are_exact() {
    for thickness in [2.0, 2.3, 7.77, 11.5] {
        let mut spec = spec(PhantomKind::Slab, [3, 4, 33]);
        spec.voxel_type = VoxelType::F32;
        spec.thickness_mm = Some(thickness);
        let volume = phantom(&spec).unwrap().volume;
        let sum: f64 = (0..33).map(|k| stored(&volume, [1, 1, k])).sum();
        assert!((sum - thickness).abs() < 1e-5, "{sum} for {thickness}");
        let at = |z: f64| trilinear(&volume, DVec3::new(1.2, 0.7, 16.0 + z));
        for face in [-thickness / 2.0, thickness / 2.0] {
            assert!((at(face) - 0.5).abs() < 1e-6, "{thickness}");
            assert!((at(face * 1.02) - 0.5).abs() > 1e-3);
        }
    }
}
