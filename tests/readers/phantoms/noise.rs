//! White noise and added noise: their moments, and that a seed decides them.

use angioray::volume::{PhantomKind, PhantomSpec, VoxelType, phantom};

use super::spec;

fn fractions(spec: &PhantomSpec) -> Vec<f64> {
    let volume = phantom(spec).unwrap().volume;
    (0..volume.voxels().len())
        .map(|n| (volume.voxels().stored(n) - spec.values().min) / spec.values().width())
        .collect()
}

/// Mean, variance, and correlation with the neighbour `lag` voxels on.
fn statistics(values: &[f64], lag: usize) -> [f64; 3] {
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
                let [mean, variance, correlation] = statistics(values, lag);
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
fn added_noise_has_the_requested_deviation() {
    let mut spec = spec(PhantomKind::Ramp, [64, 64, 24]);
    spec.voxel_type = VoxelType::F32;
    let clean = fractions(&spec);
    spec.noise = 0.05;
    let noisy = fractions(&spec);
    assert_eq!(noisy, fractions(&spec));
    let added: Vec<f64> = noisy.iter().zip(&clean).map(|(a, b)| a - b).collect();
    for lag in [1, 64, 64 * 64] {
        let [mean, variance, correlation] = statistics(&added, lag);
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
