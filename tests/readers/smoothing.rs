//! Gaussian smoothing against the analytic Gaussian.

use angioray::error::ErrorKind;
use angioray::extent::Dims;
use angioray::progress::Silent;
use angioray::volume::{
    Geometry, NonFinite, PhantomKind, PhantomSpec, Rescale, Volume, VoxelType, phantom, smooth,
};
use glam::{DMat3, DVec3};

const DIMS: [u32; 3] = [41, 33, 27];
const SPACING_MM: [f64; 3] = [0.5, 1.0, 2.0];

fn impulse(voxel_type: VoxelType) -> Volume {
    let dims = Dims::new(DIMS.map(u64::from)).unwrap();
    let mut spec = PhantomSpec::new(PhantomKind::Voxel, dims);
    spec.spacing_mm = SPACING_MM.into();
    spec.voxel_type = voxel_type;
    phantom(&spec).unwrap().volume
}

fn index([i, j, k]: [u32; 3]) -> usize {
    ((k * DIMS[1] + j) * DIMS[0] + i) as usize
}

fn physical(volume: &Volume, index: usize) -> f64 {
    volume.rescale().physical(volume.voxels().stored(index))
}

/// The largest difference between the response at every voxel and the density of a Gaussian of
/// `sigma_mm` at it, as a share of the response's peak.
fn worst(response: &Volume, full: f64, sigma_mm: f64) -> f64 {
    let centre = DIMS.map(|n| n / 2);
    let mut worst: f64 = 0.0;
    let mut peak: f64 = 0.0;
    for k in 0..DIMS[2] {
        for j in 0..DIMS[1] {
            for i in 0..DIMS[0] {
                let at = [i, j, k];
                let mut density = full;
                for axis in 0..3 {
                    let h = SPACING_MM[axis];
                    let x = (f64::from(at[axis]) - f64::from(centre[axis])) * h / sigma_mm;
                    density *=
                        (-0.5 * x * x).exp() * h / (sigma_mm * (2.0 * std::f64::consts::PI).sqrt());
                }
                peak = peak.max(density);
                worst = worst.max((physical(response, index(at)) - density).abs());
            }
        }
    }
    worst / peak
}

#[test]
fn an_impulse_becomes_the_gaussian_in_millimetres() {
    // Sampled at 1, 2 and 4 points per sigma of 2 mm, a Gaussian sums to 1 within 6e-9; what
    // remains is the cut at 4 sigma (6e-5 a side).
    for voxel_type in VoxelType::ALL {
        let volume = impulse(voxel_type);
        let base = volume.stored_range().min;
        let full = volume.stored_range().max - base;
        let smoothed = smooth(&volume, 2.0, &Silent).unwrap();
        assert_eq!(smoothed.voxels().voxel_type(), VoxelType::F32);
        assert_eq!(smoothed.geometry(), volume.geometry());
        if base == 0.0 {
            assert!(worst(&smoothed, full, 2.0) < 4e-4, "{voxel_type}");
            assert!(worst(&smoothed, full, 2.1) > 1e-2, "a wrong sigma");
        }
        let shifted: f64 = (0..volume.voxels().len())
            .map(|n| physical(&smoothed, n) - base)
            .sum();
        assert!(
            (shifted / full - 1.0).abs() < 1e-3,
            "{voxel_type}: {shifted}"
        );
    }
}

#[test]
fn a_uniform_volume_stays_itself_to_the_last_bit() {
    let dims = Dims::new([9, 1, 6]).unwrap();
    let geometry = Geometry::new(DVec3::ZERO, DMat3::IDENTITY, DVec3::new(0.3, 1.0, 4.0)).unwrap();
    let rescale = Rescale {
        slope: 0.1,
        intercept: -7.0,
    };
    let make = |voxels: Vec<f32>| {
        Volume::new(dims, voxels.into(), geometry, rescale, NonFinite::Refuse).unwrap()
    };
    let value = 0.1_f32;
    let smoothed = smooth(&make(vec![value; 54]), 3.3, &Silent).unwrap();
    assert_eq!(smoothed.rescale(), rescale);
    let is_uniform = |v: &Volume| (0..54).all(|n| v.voxels().stored(n) == f64::from(value));
    assert!(is_uniform(&smoothed));
    let mut uneven = vec![value; 54];
    uneven[20] += 0.01;
    assert!(!is_uniform(&smooth(&make(uneven), 3.3, &Silent).unwrap()));
}

/// The definition, one axis: every tap, the index clamped.
fn by_definition(row: &[f64], sigma: f64) -> Vec<f64> {
    let radius = (4.0 * sigma).ceil() as i64;
    let weight = |d: i64| (-0.5 * (d as f64 / sigma).powi(2)).exp();
    let sum: f64 = (-radius..=radius).map(weight).sum();
    (0..row.len() as i64)
        .map(|at| {
            (-radius..=radius)
                .map(|d| weight(d) / sum * row[(at + d).clamp(0, row.len() as i64 - 1) as usize])
                .sum()
        })
        .collect()
}

#[test]
fn the_border_continues_outward_on_every_axis() {
    let row: Vec<f32> = vec![5.0, -2.0, 0.5, 9.0, 4.0, 4.0, -8.0];
    let wide: Vec<f64> = row.iter().map(|&v| f64::from(v)).collect();
    for axis in 0..3 {
        for sigma in [0.4, 1.0, 3.0, 50.0] {
            let mut n = [1; 3];
            n[axis] = row.len() as u64;
            let volume = Volume::new(
                Dims::new(n).unwrap(),
                row.clone().into(),
                Geometry::default(),
                Rescale::IDENTITY,
                NonFinite::Refuse,
            )
            .unwrap();
            let smoothed = smooth(&volume, sigma, &Silent).unwrap();
            let distance = |sigma: f64| {
                by_definition(&wide, sigma)
                    .iter()
                    .enumerate()
                    .map(|(n, v)| (v - physical(&smoothed, n)).abs())
                    .fold(0.0, f64::max)
            };
            assert!(distance(sigma) < 1e-5, "axis {axis}, sigma {sigma}");
            assert!(distance(sigma * 1.5) > 1e-3, "a wrong sigma");
        }
    }
}

#[test]
fn sigma_zero_keeps_every_value() {
    let volume = impulse(VoxelType::I16);
    let same = smooth(&volume, 0.0, &Silent).unwrap();
    assert_eq!(same.voxels().voxel_type(), VoxelType::F32);
    let equal = |a: &Volume, b: &Volume| {
        (0..a.voxels().len()).all(|n| a.voxels().stored(n) == b.voxels().stored(n))
    };
    assert!(equal(&volume, &same));
    assert!(!equal(&volume, &smooth(&volume, 1.0, &Silent).unwrap()));
}

#[test]
fn unusable_sigmas_are_refused() {
    let volume = impulse(VoxelType::U8);
    for sigma in [-1.0, f64::NAN, f64::INFINITY, 1e9] {
        let error = smooth(&volume, sigma, &Silent).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage, "{sigma}");
    }
    assert!(smooth(&volume, 1e3, &Silent).is_ok());
}
