//! Shading where the gradient says something alone: noise makes no speckles, and a surface keeps its light.

use angioray::frame::Frame;
use angioray::scene::{
    Emission, Knot, Light, Phong, Picture, Quadrature, Rgb, Scene, ShadedFrom, TransferFunction,
};
use angioray::volume::Volume;

use super::{COLOR, both};
use crate::common::{self, hash, on_device, volume_of};

const NOISE: f64 = 8.0;

/// A medium of one value, but for noise.
fn fog() -> Volume {
    volume_of([32, 32, 32], |x, y, z| {
        (100.0 + NOISE * (hash(x, y, z) - 0.5)) as f32
    })
}

/// A ball in less dense fog, both with noise: its edge rises by 180 in two voxels.
fn ball() -> Volume {
    volume_of([32, 32, 32], |x, y, z| {
        let from_center = ((x - 15.5).powi(2) + (y - 15.5).powi(2) + (z - 15.5).powi(2)).sqrt();
        let edge = ((11.0 - from_center) / 2.0 + 0.5).clamp(0.0, 1.0);
        (10.0 + 180.0 * edge + NOISE * (hash(x, y, z) - 0.5)) as f32
    })
}

/// One colour, and between two values an opacity that noise does not change.
fn scene(
    volume: &Volume,
    (from, to): (f64, f64),
    opacity: f64,
    phong: Option<Phong>,
    shaded_from: f64,
) -> Scene {
    let knot = |value, opacity| Knot {
        value,
        color: Rgb(COLOR),
        opacity,
    };
    let knots = vec![
        knot(from, 0.0),
        knot(from + 10.0, opacity),
        knot(to - 10.0, opacity),
        knot(to, 0.0),
    ];
    let medium = Emission {
        phong,
        shaded_from: ShadedFrom::new(shaded_from).unwrap(),
        quadrature: Quadrature::adaptive(1e-3).unwrap(),
        ..Emission::of(TransferFunction::new(knots, 1.0).unwrap())
    };
    Scene {
        lights: vec![Light::distant(glam::DVec3::new(0.6, -0.7, 0.5)).unwrap()],
        ..common::scene(volume, 64, Picture::Emission(medium))
    }
}

/// The variance of the colours, over their opacity, of the pixels in the picture's middle.
fn variance(frame: &Frame) -> f64 {
    let side = frame.size.width() as usize;
    let middle = side * 3 / 8..side * 5 / 8;
    let mut reds = Vec::new();
    for j in middle.clone() {
        for i in middle.clone() {
            let [red, _, _, alpha] = frame.color[j * side + i].map(f64::from);
            assert!(alpha > 0.9);
            reds.push(red / alpha);
        }
    }
    let mean = reds.iter().sum::<f64>() / reds.len() as f64;
    reds.iter().map(|red| (red - mean).powi(2)).sum::<f64>() / reds.len() as f64
}

#[test]
fn noise_makes_no_speckles_where_its_gradients_are_not_shaded() {
    // Thick enough that few voxels decide a pixel.
    let of = |phong, shaded_from| scene(&fog(), (20.0, 500.0), 0.5, phong, shaded_from);
    let Some(speckled) = both(&fog(), &of(Some(Phong::default()), 0.0)) else {
        return;
    };
    let calm = both(&fog(), &of(Some(Phong::default()), 60.0)).unwrap();
    let unshaded = both(&fog(), &of(None, 0.0)).unwrap();
    for n in 0..2 {
        let [speckled, calm, unshaded] =
            [&speckled, &calm, &unshaded].map(|frames| variance(&frames[n]));
        assert!(calm < 0.02 * speckled, "{calm} {speckled}");
        // The controls: speckles that can be seen, and none without shading.
        assert!(speckled > 1e-3, "{speckled}");
        assert!(unshaded < 1e-8, "{unshaded}");
    }
}

#[test]
fn a_surface_keeps_its_light_where_only_steep_gradients_are_shaded() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = ball();
    let of = |phong, shaded_from| scene(&volume, (60.0, 500.0), 0.99, phong, shaded_from);
    let lit = Some(Phong::default());
    let scenes = [of(lit, 0.0), of(lit, 40.0), of(None, 0.0)];
    let frames = on_device(&device, &volume, &scenes);
    let differ = |other: &Frame| {
        let pixels = frames[0].color.iter().zip(&other.color);
        let opaque: Vec<f64> = pixels
            .filter(|(a, _)| a[3] > 0.99)
            .map(|(a, b)| f64::from((a[0] - b[0]).abs()))
            .collect();
        assert!(opaque.len() > 200, "{}", opaque.len());
        opaque.iter().sum::<f64>() / opaque.len() as f64
    };
    let (weighed, unshaded) = (differ(&frames[1]), differ(&frames[2]));
    assert!(weighed < 0.05 * unshaded, "{weighed} {unshaded}");
    assert!(unshaded > 0.1, "{unshaded}");
}

#[test]
fn the_share_that_is_shaded_is_the_gradients() {
    // Φ = 10 x: of 40 values per mm a quarter. Where the volume ends differences are smaller: nothing is seen there.
    let ramp = volume_of([24, 8, 8], |x, _, _| (10.0 * x) as f32);
    let of = |phong, shaded_from| scene(&ramp, (20.0, 200.0), 0.5, phong, shaded_from);
    let shaded = both(&ramp, &of(Some(Phong::default()), 0.0));
    let (Some(shaded), Some(unshaded)) = (shaded, both(&ramp, &of(None, 0.0))) else {
        return;
    };
    for (gradient, share) in [(40.0, 0.25), (20.0, 0.5), (9.0, 1.0), (1e9, 0.0)] {
        let mixed = both(&ramp, &of(Some(Phong::default()), gradient)).unwrap();
        for n in 0..2 {
            // The adaptive rule's bound, of two pictures.
            let limit = [2e-3, 1e-5][n];
            let pixels = (0..mixed[n].color.len()).flat_map(|pixel| [(pixel, 0), (pixel, 2)]);
            let (mut worst, mut control) = (0.0_f64, 0.0_f64);
            for (pixel, c) in pixels {
                let [mixed, shaded, unshaded] =
                    [&mixed, &shaded, &unshaded].map(|frames| f64::from(frames[n].color[pixel][c]));
                let off = |share: f64| (mixed - unshaded - share * (shaded - unshaded)).abs();
                worst = worst.max(off(share));
                control = control.max(off(share - 0.1));
            }
            assert!(worst < limit, "{gradient}: {worst}");
            assert!(control > limit, "{gradient}: {control}");
        }
    }
}
