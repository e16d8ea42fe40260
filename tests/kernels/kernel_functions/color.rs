//! The sRGB curve, both ways.

use angioray::gpu::Args;
use angioray::scene::Filter;

use super::{U8, build, common, room, run, upload, variant};

/// Each value linearised and encoded on the device.
fn on_device(values: &[f32]) -> Option<(Vec<f32>, Vec<f32>)> {
    let device = common::device()?;
    let pass = build("color", variant(U8, Filter::Linear, 8));
    let mut linear = room(&device, values.len());
    let mut srgb = room(&device, values.len());
    run(
        &device,
        &pass,
        Args::new()
            .value("count", &(values.len() as u32))
            .read("values", &upload(&device, values))
            .write("linear", &mut linear)
            .write("srgb", &mut srgb),
        values.len(),
    );
    Some((
        linear.download(&device).unwrap(),
        srgb.download(&device).unwrap(),
    ))
}

// IEC 61966-2-1.
fn linearised(v: f64) -> f64 {
    if v <= 0.04045 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    }
}

fn encoded(v: f64) -> f64 {
    if v <= 0.003_130_8 {
        12.92 * v
    } else {
        1.055 * v.powf(1.0 / 2.4) - 0.055
    }
}

/// The largest difference, relative to the expected value or to 0.01 where that is smaller.
fn worst(values: &[f32], got: &[f32], expected: impl Fn(f64) -> f64) -> f64 {
    let error = |(&v, &got): (&f32, &f32)| {
        let expected = expected(f64::from(v));
        (f64::from(got) - expected).abs() / expected.abs().max(0.01)
    };
    values.iter().zip(got).map(error).fold(0.0, f64::max)
}

#[test]
fn both_curves_follow_the_standard() {
    let mut values: Vec<f32> = (0..=2000).map(|i| i as f32 / 1000.0).collect();
    values.extend([
        1e-30,
        1e-6,
        0.003_130_8,
        0.003_130_9,
        0.040_45,
        0.040_46,
        100.0,
    ]);
    let Some((linear, srgb)) = on_device(&values) else {
        return;
    };
    let limit = 1e-5;
    assert!(worst(&values, &linear, linearised) < limit);
    assert!(worst(&values, &srgb, encoded) < limit);
    // A plain gamma of 2.2, and the curves exchanged, are seen.
    assert!(worst(&values, &linear, |v| v.powf(2.2)) > limit);
    assert!(worst(&values, &linear, encoded) > limit);
    assert!(worst(&values, &srgb, linearised) > limit);
}

#[test]
fn encoding_undoes_linearising() {
    let values: Vec<f32> = (0..=4095).map(|i| i as f32 / 4095.0).collect();
    let Some((linear, _)) = on_device(&values) else {
        return;
    };
    let Some((_, back)) = on_device(&linear) else {
        return;
    };
    let apart = |others: &[f32]| {
        let each = values.iter().zip(others).map(|(a, b)| (a - b).abs());
        each.fold(0.0, f32::max)
    };
    // 16 bits a channel hold steps of 1.5e-5.
    assert!(apart(&back) < 2e-6);
    assert!(apart(&linear) > 2e-6);
}
