//! The error figures against hand-computed cases and against numpy and scikit-image.

use angioray::extent::ImageSize;
use angioray::frame::error::{color_error, depth_error, normal_error, value_error};
use angioray::frame::{DEPTH, Frame, Layers, NORMAL, VALUE};

/// A picture in which no ray met anything, with the planes that are compared.
fn frame(width: u32, height: u32) -> Frame {
    let size = ImageSize::new(width, height).unwrap();
    let pixels = size.pixels();
    let mut layers = Layers::default();
    layers.insert(DEPTH, vec![f32::INFINITY; pixels]);
    layers.insert(NORMAL, vec![[0.0; 3]; pixels]);
    layers.insert(VALUE, vec![0.0; pixels]);
    Frame {
        size,
        color: vec![[0.0; 4]; pixels],
        display: Some(vec![[0.0, 0.0, 0.0, 1.0]; pixels]),
        layers,
    }
}

fn with_display(width: u32, height: u32, at: impl Fn(usize) -> [f32; 3]) -> Frame {
    let mut frame = frame(width, height);
    for (pixel, display) in frame.display.as_mut().unwrap().iter_mut().enumerate() {
        let [r, g, b] = at(pixel);
        *display = [r, g, b, 1.0];
    }
    frame
}

fn with_depth(depth: &[f32]) -> Frame {
    let mut frame = frame(depth.len() as u32, 1);
    frame.layers.insert(DEPTH, depth.to_vec());
    frame
}

fn with_normals(normal: &[[f32; 3]]) -> Frame {
    let mut frame = frame(normal.len() as u32, 1);
    frame.layers.insert(NORMAL, normal.to_vec());
    frame
}

/// `None`: not covered.
fn with_values(values: &[Option<f32>]) -> Frame {
    let mut frame = frame(values.len() as u32, 1);
    for (pixel, value) in values.iter().enumerate() {
        if let Some(value) = value {
            frame.color[pixel] = [0.0, 0.0, 0.0, 1.0];
            frame.plane_mut(VALUE).unwrap()[pixel] = *value;
        }
    }
    frame
}

#[track_caller]
fn near(figure: f64, expected: f64) {
    let off = (figure - expected).abs();
    assert!(
        off <= 1e-11 * expected.abs().max(1.0),
        "{figure} is not {expected}"
    );
}

const INF: f32 = f32::INFINITY;

#[test]
fn a_constant_offset_is_its_own_error() {
    let reference = with_display(16, 8, |_| [0.25, 0.5, 0.75]);
    let moved = with_display(16, 8, |_| [0.375, 0.375, 0.875]);
    let error = color_error(&reference, &moved).unwrap();
    assert_eq!((error.rmse, error.max, error.p99), (0.125, 0.125, 0.125));
    // 20 log10 8.
    near(error.psnr_db, 18.061_799_739_838_87);
    assert_eq!(color_error(&moved, &reference).unwrap(), error);
    // One level of 255 more would be seen.
    let more = with_display(16, 8, |_| [0.375, 0.375, 0.875 + 1.0 / 255.0]);
    assert_ne!(color_error(&reference, &more).unwrap(), error);
}

#[test]
fn equal_pictures_have_no_error() {
    let picture = with_display(7, 3, |pixel| [pixel as f32 / 21.0; 3]);
    let error = color_error(&picture, &picture).unwrap();
    assert_eq!((error.rmse, error.max, error.p99), (0.0, 0.0, 0.0));
    assert_eq!(error.psnr_db, f64::INFINITY);
}

#[test]
fn an_outlier_shows_in_the_maximum_and_not_in_the_percentile() {
    let reference = with_display(10, 10, |_| [0.5; 3]);
    let spoiled = |channels: usize| {
        with_display(10, 10, move |pixel| {
            [0, 1, 2].map(|c| if 3 * pixel + c < channels { 1.0 } else { 0.5 })
        })
    };
    let one = color_error(&reference, &spoiled(1)).unwrap();
    near(one.rmse, 0.5 / 300.0_f64.sqrt());
    assert_eq!((one.max, one.p99), (0.5, 0.0));
    // Of 300 channels rank 297 is the percentile: the fourth worst.
    assert_eq!(color_error(&reference, &spoiled(3)).unwrap().p99, 0.0);
    assert_eq!(color_error(&reference, &spoiled(4)).unwrap().p99, 0.5);
    // The alpha of a display plane is no part of it.
    let mut clear = reference.clone();
    clear.display.as_mut().unwrap()[0][3] = 0.0;
    assert_eq!(color_error(&reference, &clear).unwrap().max, 0.0);
}

#[test]
fn hits_are_counted_and_depth_is_in_voxels() {
    let reference = with_depth(&[10.0, 20.0, 30.0, 40.0, INF, INF, INF]);
    let other = with_depth(&[10.5, 19.0, INF, INF, INF, 7.0, INF]);
    let error = depth_error(&reference, &other, 0.5).unwrap();
    assert_eq!(error.reference_hits, 4);
    assert_eq!((error.missed, error.extra, error.compared), (2, 1, 2));
    assert_eq!(
        (error.mean, error.p99, error.max),
        (Some(1.5), Some(2.0), Some(2.0))
    );
    assert_eq!(error.missed_share(), Some(0.5));
    assert_eq!(error.extra_share(), Some(0.25));
    // Missed and extra are not each other.
    let swapped = depth_error(&other, &reference, 0.5).unwrap();
    assert_eq!((swapped.missed, swapped.extra), (1, 2));
    assert_eq!(swapped.reference_hits, 3);
}

#[test]
fn the_percentile_of_a_hundred_depths_is_the_ninety_ninth() {
    let reference = with_depth(&[1000.0; 100]);
    let depths: Vec<_> = (1..=100).rev().map(|k| 1000.0 + k as f32).collect();
    let error = depth_error(&reference, &with_depth(&depths), 1.0).unwrap();
    assert_eq!(
        (error.mean, error.p99, error.max),
        (Some(50.5), Some(99.0), Some(100.0))
    );
}

#[test]
fn nothing_to_compare_is_reported_and_passes_nothing() {
    let (hit, none) = (with_depth(&[1.0, 2.0]), with_depth(&[INF, INF]));
    let error = depth_error(&hit, &none, 1.0).unwrap();
    assert_eq!((error.missed, error.compared), (2, 0));
    assert_eq!((error.mean, error.p99, error.max), (None, None, None));
    let both_empty = depth_error(&none, &none, 1.0).unwrap();
    assert_eq!(both_empty.missed_share(), None);

    let error = normal_error(&hit, &hit).unwrap();
    assert_eq!(
        (error.compared, error.mean_deg, error.p99_deg),
        (0, None, None)
    );

    let error = value_error(&with_values(&[Some(1.0)]), &with_values(&[None]), 1.0).unwrap();
    assert_eq!((error.compared, error.missed, error.extra), (0, 1, 0));
    assert_eq!((error.mean, error.rmse, error.max), (None, None, None));
    // In a report the figures are absent, not zero.
    let json = serde_json::to_value(error).unwrap();
    assert!(json["p99"].is_null());
}

#[test]
fn angles_between_normals() {
    let sin_cos = |deg: f64| {
        let (sin, cos) = deg.to_radians().sin_cos();
        [cos as f32, sin as f32, 0.0]
    };
    let x = [1.0, 0.0, 0.0];
    let cases = [
        (x, x, 0.0),
        (x, sin_cos(60.0), 60.0),
        (x, [0.0, 0.0, -1.0], 90.0),
        (x, [-1.0, 0.0, 0.0], 180.0),
        (x, [3.0, 3.0, 0.0], 45.0),
        // Where the arc cosine of the dot product has lost every digit.
        (x, [1.0, 1e-6, 0.0], 1e-6_f64.to_degrees()),
    ];
    for (a, b, expected) in cases {
        let error = normal_error(&with_normals(&[a]), &with_normals(&[b])).unwrap();
        assert_eq!(error.compared, 1);
        let mean = error.mean_deg.unwrap();
        let off = (mean - expected).abs();
        assert!(off <= 1e-6 * expected, "{mean} is not {expected}");
        assert_eq!(error.p99_deg, error.mean_deg);
    }
    // Pixels without a normal in either picture take no part.
    let reference = with_normals(&[x, [0.0; 3], x, [0.0; 3]]);
    let other = with_normals(&[sin_cos(30.0), x, [0.0; 3], [0.0; 3]]);
    let error = normal_error(&reference, &other).unwrap();
    assert_eq!(error.compared, 1);
    assert!((error.mean_deg.unwrap() - 30.0).abs() < 1e-5);
}

#[test]
fn values_are_shares_of_the_range() {
    let reference = with_values(&[Some(0.0), Some(100.0), Some(50.0), None, None]);
    let other = with_values(&[Some(3.0), Some(96.0), None, Some(9.0), None]);
    let error = value_error(&reference, &other, 200.0).unwrap();
    assert_eq!((error.compared, error.missed, error.extra), (2, 1, 1));
    near(error.mean.unwrap(), 0.0175);
    near(error.rmse.unwrap(), 12.5_f64.sqrt() / 200.0);
    near(error.max.unwrap(), 0.02);
    near(error.p99.unwrap(), 0.02);
    // A value of 0 that was seen is compared; a wider range makes the error smaller.
    let wider = value_error(&reference, &other, 400.0).unwrap();
    near(wider.max.unwrap(), 0.01);
}

#[test]
fn what_cannot_be_compared_is_an_error() {
    let good = with_display(4, 2, |_| [0.5; 3]);
    let other_size = with_display(2, 4, |_| [0.5; 3]);
    let bare = Frame {
        display: None,
        layers: Layers::default(),
        ..good.clone()
    };
    let compare = |a: &Frame, b: &Frame| {
        [
            color_error(a, b).err(),
            depth_error(a, b, 1.0).err(),
            normal_error(a, b).err(),
            value_error(a, b, 1.0).err(),
        ]
    };
    assert!(compare(&good, &good).iter().all(Option::is_none));
    for (a, b) in [(&good, &other_size), (&good, &bare), (&bare, &good)] {
        for error in compare(a, b) {
            assert_eq!(error.unwrap().exit_code(), 1);
        }
    }
    let planes = ["display", "depth", "normal", "value"];
    for (error, plane) in compare(&good, &bare).into_iter().zip(planes) {
        let message = error.unwrap().to_string();
        assert!(
            message.contains(plane) && message.contains("the picture"),
            "{message}"
        );
    }
    let mut short = good.clone();
    let mut values = short.layers.take(VALUE).unwrap();
    values.pop();
    short.layers.insert(VALUE, values);
    assert!(compare(&good, &short).iter().all(Option::is_some));

    for unit in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(depth_error(&good, &good, unit).is_err(), "{unit}");
        assert!(value_error(&good, &good, unit).is_err(), "{unit}");
    }
}

#[test]
fn a_nan_pixel_is_named_not_skipped() {
    let good = frame(4, 2);
    for poison in [f32::NAN, f32::NEG_INFINITY] {
        let mut bad = good.clone();
        bad.display.as_mut().unwrap()[6][1] = poison;
        bad.plane_mut(DEPTH).unwrap()[6] = poison;
        bad.plane_mut(NORMAL).unwrap()[6][2] = poison;
        bad.plane_mut(VALUE).unwrap()[6] = poison;
        for (a, b) in [(&good, &bad), (&bad, &good)] {
            let errors = [
                color_error(a, b).err(),
                depth_error(a, b, 1.0).err(),
                normal_error(a, b).err(),
                value_error(a, b, 1.0).err(),
            ];
            for error in errors {
                let message = error.unwrap().to_string();
                assert!(message.contains("pixel 2,1"), "{message}");
            }
        }
    }
}

/// Two frames of 32 x 24 made of integer patterns, so that another program can make the same.
fn patterns() -> (Frame, Frame) {
    let (mut reference, mut other) = (frame(32, 24), frame(32, 24));
    let share = |n: usize, modulus: usize, of: f64| (n % modulus) as f64 / of;
    for k in 0..768 {
        for c in 0..3 {
            let i = 3 * k + c;
            let base = share(i * 7919, 1000, 999.0);
            let added = (share(i * 104_729, 2311, 2311.0) - 0.5) * 0.1;
            reference.display.as_mut().unwrap()[k][c] = base as f32;
            other.display.as_mut().unwrap()[k][c] = (base + added) as f32;
        }
        let depth = (100.0 + share(k * 37, 101, 7.0)) as f32;
        let moved = (f64::from(depth) + share(k * 331, 769, 770.0)) as f32;
        let value = (k * 31 % 251) as f32;
        let shifted = (f64::from(value) + (share(k * 173, 769, 1.0) - 384.0) / 40.0) as f32;
        let angle = share(k * 13, 360, 1.0).to_radians();
        let turned = angle + share(k * 29, 769, 769.0).to_radians();
        let along = |angle: f64| [angle.cos() as f32, angle.sin() as f32, 0.0];
        if !k.is_multiple_of(5) {
            reference.color[k][3] = 1.0;
            reference.plane_mut(DEPTH).unwrap()[k] = depth;
            reference.plane_mut(VALUE).unwrap()[k] = value;
            reference.plane_mut(NORMAL).unwrap()[k] = along(angle);
        }
        if !k.is_multiple_of(7) {
            other.color[k][3] = 1.0;
            other.plane_mut(DEPTH).unwrap()[k] = moved;
            other.plane_mut(VALUE).unwrap()[k] = shifted;
            other.plane_mut(NORMAL).unwrap()[k] = along(turned);
        }
    }
    (reference, other)
}

/// The same patterns in numpy 2.4.6 and scikit-image 0.26.0: `mean_squared_error`,
/// `peak_signal_noise_ratio(data_range=1)`, `np.percentile(method="inverted_cdf")`.
#[test]
fn numpy_and_scikit_image_agree() {
    let (reference, other) = patterns();
    let color = color_error(&reference, &other).unwrap();
    near(color.rmse, 0.028_869_408_221);
    near(color.max, 0.050_000_000_745);
    near(color.p99, 0.049_480_747_432);
    near(color.psnr_db, 30.791_242_368_008);
    // What numpy's default percentile gives: interpolated between ranks.
    assert!((color.p99 - 0.049_480_747_096).abs() > 1e-10);

    let depth = depth_error(&reference, &other, 0.4).unwrap();
    assert_eq!(depth.reference_hits, 614);
    assert_eq!((depth.missed, depth.extra, depth.compared), (88, 132, 526));
    near(depth.mean.unwrap(), 1.281_905_845_091);
    near(depth.p99.unwrap(), 2.464_294_433_594);
    near(depth.max.unwrap(), 2.483_768_463_135);

    let value = value_error(&reference, &other, 250.0).unwrap();
    assert_eq!((value.missed, value.extra, value.compared), (88, 132, 526));
    near(value.mean.unwrap(), 0.019_141_634_978);
    near(value.rmse.unwrap(), 0.022_076_290_333);
    near(value.p99.unwrap(), 0.037_700_012_207);
    near(value.max.unwrap(), 0.038_299_999_952);

    let normal = normal_error(&reference, &other).unwrap();
    assert_eq!(normal.compared, 526);
    assert!((normal.mean_deg.unwrap() - 0.499_987_635).abs() < 1e-6);
    assert!((normal.p99_deg.unwrap() - 0.989_597_937).abs() < 1e-5);
}
