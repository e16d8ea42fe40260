//! Phantoms against their closed forms, written out here a second time.

mod nrrd;
mod vessels;

use std::f64::consts::PI;

use angioray::error::ErrorKind;
use angioray::extent::Dims;
use angioray::volume::{Phantom, PhantomKind, PhantomSpec, Volume, VoxelType, phantom};
use glam::DVec3;
use proptest::prelude::*;

pub fn spec(kind: PhantomKind, dims: [u64; 3]) -> PhantomSpec {
    PhantomSpec::new(kind, Dims::new(dims).unwrap())
}

pub fn stored(volume: &Volume, [i, j, k]: [u32; 3]) -> f64 {
    let [nx, ny, _] = volume.dims().usize();
    volume
        .voxels()
        .stored((k as usize * ny + j as usize) * nx + i as usize)
}

/// Trilinear interpolation at an index inside the domain.
pub fn trilinear(volume: &Volume, p_index: DVec3) -> f64 {
    let n = volume.dims().array();
    let mut value = 0.0;
    for corner in 0..8_u32 {
        let mut weight = 1.0;
        let mut at = [0; 3];
        for axis in 0..3 {
            let low = (p_index[axis].floor() as u32).min(n[axis].saturating_sub(2));
            let t = p_index[axis] - f64::from(low);
            let up = corner >> axis & 1;
            at[axis] = (low + up).min(n[axis] - 1);
            weight *= if up == 1 { t } else { 1.0 - t };
        }
        value += weight * stored(volume, at);
    }
    value
}

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

/// Every voxel type, in an anisotropic volume: `closed(size)` must hold with the size asked for,
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

fn fractions(spec: &PhantomSpec) -> Vec<f64> {
    let volume = phantom(spec).unwrap().volume;
    (0..volume.voxels().len())
        .map(|n| (volume.voxels().stored(n) - spec.values().min) / spec.values().width())
        .collect()
}

/// Mean, variance, and correlation with the neighbour `lag` voxels on.
fn moments(values: &[f64], lag: usize) -> [f64; 3] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
    let together: f64 = values
        .iter()
        .zip(&values[lag..])
        .map(|(a, b)| (a - mean) * (b - mean))
        .sum();
    [mean, variance, together / n / variance]
}

#[test]
fn noise_is_white_uniform_and_decided_by_its_seed() {
    for voxel_type in VoxelType::ALL {
        let mut spec = spec(PhantomKind::Noise, [64, 64, 24]);
        spec.voxel_type = voxel_type;
        let values = fractions(&spec);
        assert_eq!(values, fractions(&spec));
        // Five standard deviations of each estimate over 98,304 voxels.
        let is_white = |values: &[f64]| {
            [1, 64, 64 * 64].into_iter().all(|lag| {
                let [mean, variance, correlation] = moments(values, lag);
                (mean - 0.5).abs() < 5e-3
                    && (variance - 1.0 / 12.0).abs() < 1.3e-3
                    && correlation.abs() < 0.016
            })
        };
        assert!(is_white(&values), "{voxel_type}");
        let blurred: Vec<f64> = values.windows(2).map(|v| (v[0] + v[1]) / 2.0).collect();
        assert!(!is_white(&blurred));
        spec.seed = 2;
        assert_ne!(values, fractions(&spec));
        assert!(is_white(&fractions(&spec)));
    }
}

#[test]
fn added_noise_has_the_asked_deviation() {
    let mut spec = spec(PhantomKind::Ramp, [64, 64, 24]);
    spec.voxel_type = VoxelType::F32;
    let clean = fractions(&spec);
    spec.noise = 0.05;
    let noisy = fractions(&spec);
    assert_eq!(noisy, fractions(&spec));
    let added: Vec<f64> = noisy.iter().zip(&clean).map(|(a, b)| a - b).collect();
    for lag in [1, 64, 64 * 64] {
        let [mean, variance, correlation] = moments(&added, lag);
        assert!(
            mean.abs() < 8e-4 && correlation.abs() < 0.016,
            "{mean} {correlation}"
        );
        assert!((variance.sqrt() - 0.05).abs() < 6e-4, "{}", variance.sqrt());
        assert!((variance.sqrt() - 0.06).abs() > 6e-4);
    }
    spec.seed = 9;
    assert_ne!(noisy, fractions(&spec));
}

#[test]
fn senseless_shapes_are_refused() {
    let refused = |kind, change: &dyn Fn(&mut PhantomSpec)| {
        let mut spec = spec(kind, [8, 8, 8]);
        change(&mut spec);
        phantom(&spec).err().map(|error| error.kind())
    };
    use PhantomKind::{Blob, Noise, Slab, Sphere, Vessels};
    let usage = Some(ErrorKind::Usage);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(refused(Sphere, &|s| s.radius_mm = Some(bad)), usage);
        assert_eq!(refused(Slab, &|s| s.thickness_mm = Some(bad)), usage);
        assert_eq!(refused(Blob, &|s| s.sigma_mm = Some(bad)), usage);
        assert_eq!(refused(Vessels, &|s| s.tip_radius_mm = Some(bad)), usage);
        assert_eq!(refused(Sphere, &|s| s.spacing_mm.y = bad), usage);
    }
    assert_eq!(refused(Sphere, &|s| s.noise = -0.1), usage);
    assert_eq!(refused(Noise, &|s| s.noise = 0.1), usage);
    assert_eq!(refused(Slab, &|s| s.axis = Some(3)), usage);
    assert_eq!(refused(Sphere, &|s| s.axis = Some(1)), usage);
    assert_eq!(refused(Slab, &|s| s.radius_mm = Some(1.0)), usage);
    assert_eq!(refused(Vessels, &|s| s.radius_mm = Some(5.0)), usage);
    assert_eq!(refused(Vessels, &|s| s.tip_radius_mm = Some(3.0)), usage);
    assert_eq!(refused(Vessels, &|s| s.tip_radius_mm = Some(1e-9)), usage);
    assert_eq!(refused(Sphere, &|s| s.radius_mm = Some(1e300)), None);
    let huge = PhantomSpec::new(Sphere, Dims::new([1 << 13; 3]).unwrap());
    assert_eq!(phantom(&huge).unwrap_err().kind(), ErrorKind::Failed);
}

#[test]
fn kinds_are_known_by_their_names() {
    for kind in PhantomKind::ALL {
        assert_eq!(kind.name().parse(), Ok(kind));
        assert!(kind.description().ends_with('.'));
    }
    let error = "cube".parse::<PhantomKind>().unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Usage);
    assert!(error.hint_text().unwrap().contains("marschner-lobb"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Any size, spacing and voxel type makes every phantom, with its values in the stated range.
    #[test]
    fn any_grid_will_do(
        dims in prop::array::uniform3(prop_oneof![Just(1_u64), 1_u64..5, 5_u64..14]),
        spacing in prop::array::uniform3(prop_oneof![Just(1.0), 1e-6..1e-3, 0.2..5.0, 1e3..1e6]),
        seed: u64,
        noise in prop_oneof![Just(0.0), 0.0..2.0],
    ) {
        for kind in PhantomKind::ALL {
            for voxel_type in VoxelType::ALL {
                let mut spec = spec(kind, dims);
                spec.spacing_mm = spacing.into();
                spec.voxel_type = voxel_type;
                spec.seed = seed;
                spec.noise = if kind == PhantomKind::Noise { 0.0 } else { noise };
                let made = phantom(&spec).unwrap();
                prop_assert!(!made.truth.is_empty());
                prop_assert_eq!(made.tree.is_some(), kind == PhantomKind::Vessels);
                let centre = DVec3::from_array(dims.map(|n| (n - 1) as f64 / 2.0));
                let world = made.volume.geometry().world_from_index().transform_point3(centre);
                prop_assert!(world.length() <= 1e-9 * spec.spacing_mm.max_element());
                if spec.noise == 0.0 {
                    prop_assert!(made.volume.range().min >= spec.values().min);
                    prop_assert!(made.volume.range().max <= spec.values().max);
                }
            }
        }
    }
}
