//! SSIM, FLIP and all figures at once: against closed forms, against scikit-image and NVIDIA's own
//! FLIP, and where there is nothing to compare.

use angioray::extent::ImageSize;
use angioray::frame::error::{
    PartError, Scale, color_error, depth_error, figures, flip, focus_error, normal_error,
    share_error, ssim, value_error,
};
use angioray::frame::{COC, DEPTH, Frame, KIND, Layers, NORMAL, OCCLUSION, VALUE, VISIBILITY};

fn picture(width: u32, height: u32, at: impl Fn(i64, i64, i64) -> f64) -> Frame {
    let size = ImageSize::new(width, height).unwrap();
    let pixels = size.pixels() as i64;
    let display = |pixel| {
        let (x, y) = (pixel % i64::from(width), pixel / i64::from(width));
        let [r, g, b] = [0, 1, 2].map(|c| at(x, y, c) as f32);
        [r, g, b, 1.0]
    };
    Frame {
        size,
        color: vec![[0.0; 4]; size.pixels()],
        display: Some((0..pixels).map(display).collect()),
        layers: Layers::default(),
    }
}

fn flat(width: u32, height: u32, level: f64) -> Frame {
    picture(width, height, move |_, _, _| level)
}

fn ssim_of(a: &Frame, b: &Frame) -> f64 {
    ssim(a, b).unwrap().unwrap()
}

fn flip_of(a: &Frame, b: &Frame) -> f64 {
    flip(a, b).unwrap().unwrap()
}

#[track_caller]
fn near(figure: f64, expected: f64, within: f64) {
    let off = (figure - expected).abs();
    assert!(off <= within, "{figure} is not {expected} ± {within}");
}

#[test]
fn shares_of_light_are_compared_where_both_cover() {
    let with = |occlusion: [f32; 4], alphas: [f32; 4]| {
        let mut frame = flat(4, 1, 0.5);
        frame.color = alphas.map(|alpha| [0.0, 0.0, 0.0, alpha]).to_vec();
        frame.layers.insert(OCCLUSION, occlusion.to_vec());
        frame
    };
    let reference = with([0.5, 0.25, 0.0, 0.75], [1.0, 1.0, 1.0, 0.0]);
    let frame = with([0.75, 0.125, 0.0, 0.5], [1.0; 4]);
    let error = share_error(&reference, &frame, OCCLUSION).unwrap();
    // 0.25 too dark, 0.125 too bright, and one that is right.
    assert_eq!(error.compared, 3);
    assert_eq!((error.mean, error.bias), (Some(0.125), Some(0.125 / 3.0)));
    assert_eq!((error.p99, error.max), (Some(0.25), Some(0.25)));
    // The other way round it is as far, and too bright.
    let error = share_error(&frame, &reference, OCCLUSION).unwrap();
    assert_eq!((error.mean, error.bias), (Some(0.125), Some(-0.125 / 3.0)));
    // Of what is nearly clear nothing is known, where there are kinds.
    let mut known = frame.clone();
    known.layers.insert(KIND, vec![1, 0, 1, 1]);
    let error = share_error(&reference, &known, OCCLUSION).unwrap();
    assert_eq!((error.compared, error.bias), (2, Some(0.125)));
    // Another plane of shares is another.
    assert!(share_error(&reference, &frame, VISIBILITY).is_err());
    // Where nothing is to be compared there is no figure; without the plane there is an error.
    let none = with([0.0; 4], [0.0; 4]);
    let error = share_error(&reference, &none, OCCLUSION).unwrap();
    assert_eq!((error.compared, error.mean, error.bias), (0, None, None));
    assert!(share_error(&reference, &flat(4, 1, 0.5), OCCLUSION).is_err());
}

#[test]
fn focus_parts_pixels_by_depth_and_circle() {
    let with = |level: f64, alphas: [f32; 6]| {
        let mut frame = flat(6, 1, level);
        frame.color = alphas.map(|alpha| [0.0, 0.0, 0.0, alpha]).to_vec();
        let far = f32::INFINITY;
        let depths = vec![9.0, 9.0, 5.0, 20.0, far, far];
        frame.layers.insert(DEPTH, depths);
        frame
            .layers
            .insert(COC, vec![0.5, -0.5, -0.6, 3.0, 7.0, 7.0]);
        frame
    };
    let mut reference = with(0.5, [1.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
    let mut frame = with(0.5, [1.0, 1.0, 1.0, 1.0, 0.25, 0.0]);
    // The fifth pixel is covered by the picture alone, the last by neither.
    let display = frame.display.as_mut().unwrap();
    for (pixel, by) in [(1, 0.125), (2, 0.25), (4, 0.5), (5, 0.5)] {
        display[pixel] = display[pixel].map(|channel| channel + by);
    }
    let error = focus_error(&reference, &frame).unwrap();
    let part = |part: PartError| (part.pixels, part.rmse.unwrap());
    let (pixels, rmse) = part(error.in_focus);
    assert_eq!(pixels, 2);
    near(rmse, 0.125 / 2.0_f64.sqrt(), 1e-12);
    assert_eq!(part(error.near), (1, 0.25));
    assert_eq!(part(error.far), (1, 0.0));
    assert_eq!(part(error.beside), (1, 0.5));
    near(error.near.psnr_db.unwrap(), -20.0 * 0.25_f64.log10(), 1e-12);
    assert_eq!(error.far.psnr_db, Some(f64::INFINITY));
    // The near pixel and the one beside it, of which the reference covers the first.
    let mut covered = frame.clone();
    reference.color[2][3] = 0.5;
    covered.color[2][3] = 0.375;
    covered.color[4][3] = 0.25;
    let error = focus_error(&reference, &covered).unwrap();
    near(error.silhouette.unwrap(), 0.25, 1e-12);
    // Without circles there is nothing to part them by.
    assert!(focus_error(&flat(6, 1, 0.5), &frame).is_err());
}

#[test]
fn equal_pictures_are_alike() {
    let any = picture(40, 30, |x, y, c| ((x * 7 + y * 3 + c) % 11) as f64 / 11.0);
    near(ssim_of(&any, &any), 1.0, 1e-15);
    assert_eq!(flip_of(&any, &any), 0.0);
    // One channel of one pixel by one level of 255 is seen by both.
    let mut other = any.clone();
    other.display.as_mut().unwrap()[15 * 40 + 20][1] += 1.0 / 255.0;
    assert!(ssim_of(&any, &other) < 1.0 - 1e-9);
    assert!(flip_of(&any, &other) > 1e-7);
    // The alpha of a display plane is no part of the picture.
    let mut clear = any.clone();
    clear.display.as_mut().unwrap()[0][3] = 0.0;
    assert_eq!(ssim_of(&any, &clear), ssim_of(&any, &any));
    assert_eq!(flip_of(&any, &clear), 0.0);
}

/// Flat pictures have no variance: only the luminance term is left, (2ab + C1) / (a² + b² + C1).
#[test]
fn flat_pictures_have_the_similarity_of_their_levels() {
    for (a, b) in [(0.25, 0.5), (0.0, 1.0), (0.75, 0.75), (0.125, 0.0)] {
        let c1 = 0.0001;
        let expected = (2.0 * a * b + c1) / (a * a + b * b + c1);
        near(ssim_of(&flat(20, 13, a), &flat(20, 13, b)), expected, 1e-12);
    }
}

/// a and its negative about 1/2, in a pattern whose mean under every window is 1/2 nearly: the
/// covariance is −σ², so that the similarity is (C2 − 2σ²) / (C2 + 2σ²).
#[test]
fn a_negative_is_dissimilar() {
    let checks = |sign: f64| {
        picture(32, 32, move |x, y, _| {
            0.5 + sign * if (x + y) % 2 == 0 { 0.25 } else { -0.25 }
        })
    };
    let (variance, c2) = (0.0625, 0.0009);
    let expected = (c2 - 2.0 * variance) / (c2 + 2.0 * variance);
    near(ssim_of(&checks(1.0), &checks(-1.0)), expected, 1e-6);
}

/// The mean is over the windows that lie in the picture: what no window sees as a whole counts
/// less, and a picture of one window is its one similarity.
#[test]
fn pictures_smaller_than_the_window_have_no_similarity() {
    for (width, height) in [(1, 1), (10, 200), (200, 10), (10, 10)] {
        let (a, b) = (flat(width, height, 0.25), flat(width, height, 0.5));
        assert_eq!(ssim(&a, &b).unwrap(), None, "{width}x{height}");
        // FLIP repeats the border, whatever the size.
        near(
            flip_of(&a, &b),
            flip_of(&flat(16, 16, 0.25), &flat(16, 16, 0.5)),
            1e-6,
        );
    }
    let one = |level: f64| {
        picture(
            11,
            11,
            move |x, y, _| if (x, y) == (5, 5) { level } else { 0.0 },
        )
    };
    // A point under the window's centre: mean w·v, mean of squares w·v², w the central weight.
    let axis: Vec<f64> = (-5..=5)
        .map(|x: i32| (-f64::from(x * x) / 4.5).exp())
        .collect();
    let w = (1.0 / axis.iter().sum::<f64>()).powi(2);
    let (c1, c2) = (0.0001, 0.0009);
    let (a, b) = (w * 0.5, w * 1.0);
    let (aa, bb, ab) = (w * 0.25 - a * a, w - b * b, w * 0.5 - a * b);
    let expected = (2.0 * a * b + c1) * (2.0 * ab + c2) / ((a * a + b * b + c1) * (aa + bb + c2));
    near(ssim_of(&one(0.5), &one(1.0)), expected, 1e-14);
}

/// Patterns of integers out of 1020, so that another program makes the same pictures.
mod pattern {
    pub fn rings(x: i64, y: i64, c: i64) -> i64 {
        (x * x + 2 * y * y + 97 * c) / 13 % 1021
    }
    pub fn blobs(x: i64, y: i64, c: i64) -> i64 {
        if (x / 16 + y / 11 + c) % 3 == 0 {
            900 - 5 * x
        } else {
            100 + 7 * y
        }
    }
    pub fn noisy(x: i64, y: i64, c: i64) -> i64 {
        (blobs(x, y, c) + (x * 31 + y * 57 + c * 19 + x * y) % 61 - 30).clamp(0, 1020)
    }
    pub fn shifted(x: i64, y: i64, c: i64) -> i64 {
        blobs(x + 2, y + 1, c)
    }
    pub fn grey(_: i64, _: i64, _: i64) -> i64 {
        510
    }
}

type Level = fn(i64, i64, i64) -> i64;

fn patterned(level: Level) -> Frame {
    picture(97, 83, move |x, y, c| level(x, y, c) as f64 / 1020.0)
}

/// The same pictures, as float32 of `n / 1020.0`, in scikit-image 0.26.0 (on numpy 2.4.6, after
/// `astype(float64)`): `structural_similarity(a, b, win_size=11, gaussian_weights=True, sigma=1.5,
/// use_sample_covariance=False, data_range=1, channel_axis=2)` and
/// `peak_signal_noise_ratio(a, b, data_range=1)`; and in NVIDIA's flip-evaluator 1.7 (PyPI), on the
/// float32: `np.mean(evaluate(a, b, "LDR", applyMagma=False)[0], dtype=float64)`.
#[test]
fn scikit_image_and_nvidias_flip_agree() {
    let cases: [(Level, Level, [f64; 3]); 4] = [
        (
            pattern::blobs,
            pattern::noisy,
            [0.891_836_066_721, 35.256_497_755_622, 0.040_837_056],
        ),
        (
            pattern::blobs,
            pattern::shifted,
            [0.604_974_796_218, 18.806_877_976_096, 0.271_381_591],
        ),
        (
            pattern::blobs,
            pattern::rings,
            [0.311_757_105_053, 9.839_911_551_548, 0.781_421_989],
        ),
        (
            pattern::rings,
            pattern::grey,
            [0.480_470_049_757, 10.837_890_252_236, 0.618_614_104],
        ),
    ];
    for (reference, other, [similarity, psnr, seen]) in cases {
        let (reference, other) = (patterned(reference), patterned(other));
        near(ssim_of(&reference, &other), similarity, 2e-12);
        near(
            color_error(&reference, &other).unwrap().psnr_db,
            psnr,
            1e-10,
        );
        near(flip_of(&reference, &other), seen, 1e-6);
    }
    // The relatives of these figures are other figures: sample covariance, and a uniform window of
    // 7x7 (scikit-image's defaults) for SSIM; pictures taken as linear light for FLIP.
    let (blobs, noisy) = (patterned(pattern::blobs), patterned(pattern::noisy));
    for relative in [0.891_346_700_157, 0.888_412_830_404] {
        assert!((ssim_of(&blobs, &noisy) - relative).abs() > 4e-4);
    }
    assert!((flip_of(&blobs, &noisy) - 0.036_799_435).abs() > 1e-3);
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let (a, b) = (patterned(pattern::blobs), patterned(pattern::rings));
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| (ssim_of(&a, &b).to_bits(), flip_of(&a, &b).to_bits()))
    };
    assert_eq!(with(1), with(3));
}

const SCALE: Scale = Scale {
    smallest_spacing_mm: 0.5,
    range_width: 200.0,
};

/// Two pictures of 12 x 11 with all planes that are compared.
fn complete() -> (Frame, Frame) {
    let frame = |share: f32| {
        let mut frame = picture(12, 11, move |x, _, _| f64::from(share) * x as f64 / 11.0);
        let pixels = frame.size.pixels();
        frame.color = vec![[0.0, 0.0, 0.0, 1.0]; pixels];
        frame.layers.insert(DEPTH, vec![100.0 + share; pixels]);
        frame.layers.insert(NORMAL, vec![[1.0, share, 0.0]; pixels]);
        frame.layers.insert(VALUE, vec![20.0 * share; pixels]);
        frame
    };
    let (mut reference, other) = (frame(0.5), frame(1.0));
    reference.plane_mut(DEPTH).unwrap()[7] = f32::INFINITY;
    (reference, other)
}

#[test]
fn figures_are_those_of_their_functions() {
    let (reference, other) = complete();
    let all = figures(&reference, &other, SCALE).unwrap();
    assert_eq!(all.color, color_error(&reference, &other).ok());
    assert_eq!(all.ssim, ssim(&reference, &other).unwrap());
    assert_eq!(all.flip, flip(&reference, &other).unwrap());
    assert_eq!(all.depth, depth_error(&reference, &other, 0.5).ok());
    assert_eq!(all.normal, normal_error(&reference, &other).ok());
    assert_eq!(all.value, value_error(&reference, &other, 200.0).ok());
    // Each is there, and none is nothing.
    assert!(all.ssim.unwrap() < 1.0 && all.flip.unwrap() > 0.0 && all.color.unwrap().max > 0.0);
    assert_eq!(all.depth.unwrap().mean, Some(1.0));
    assert_eq!(all.value.unwrap().max, Some(0.05));
    assert!(all.normal.unwrap().mean_deg.unwrap() > 10.0);
}

#[test]
fn a_figure_needs_its_plane_in_both_pictures() {
    let (reference, other) = complete();
    let without = |frame: &Frame| {
        let mut frame = frame.clone();
        frame.display = None;
        frame.layers.take(VALUE);
        frame
    };
    for (a, b) in [
        (&without(&reference), &other),
        (&reference, &without(&other)),
    ] {
        let all = figures(a, b, SCALE).unwrap();
        assert!(all.color.is_none() && all.ssim.is_none() && all.flip.is_none());
        assert!(all.value.is_none() && all.depth.is_some() && all.normal.is_some());
    }
    // All values of a volume equal: a share of nothing; but a unit of nonsense is an error.
    let constant = Scale {
        range_width: 0.0,
        ..SCALE
    };
    let all = figures(&reference, &other, constant).unwrap();
    assert!(all.value.is_none() && all.depth.is_some());
    for bad in [f64::NAN, -1.0, f64::INFINITY] {
        assert!(
            figures(
                &reference,
                &other,
                Scale {
                    range_width: bad,
                    ..SCALE
                }
            )
            .is_err()
        );
        assert!(
            figures(
                &reference,
                &other,
                Scale {
                    smallest_spacing_mm: bad,
                    ..SCALE
                }
            )
            .is_err()
        );
    }
}

#[test]
fn figures_have_the_contracts_names() {
    let (reference, other) = complete();
    let json = serde_json::to_value(figures(&reference, &other, SCALE).unwrap()).unwrap();
    let keys = |at: &serde_json::Value| -> Vec<String> {
        at.as_object().unwrap().keys().cloned().collect()
    };
    let sorted = |names: &[&str]| -> Vec<String> {
        let mut names: Vec<_> = names.iter().map(|n| (*n).to_owned()).collect();
        names.sort();
        names
    };
    for (part, names) in [
        ("color", &["rmse", "max", "p99", "psnr_db"] as &[_]),
        (
            "depth",
            &[
                "reference_hits",
                "missed",
                "extra",
                "missed_share",
                "extra_share",
                "compared",
                "mean",
                "p99",
                "max",
            ],
        ),
        ("normal", &["compared", "mean_deg", "p99_deg"]),
        (
            "value",
            &["compared", "missed", "extra", "mean", "rmse", "p99", "max"],
        ),
    ] {
        let mut found = keys(&json[part]);
        found.sort();
        assert_eq!(found, sorted(names), "{part}");
    }
    assert!(json["ssim"].is_f64() && json["flip"].is_f64());
    let depth = depth_error(&reference, &other, 0.5).unwrap();
    assert_eq!(depth.extra, 1);
    assert_eq!(json["depth"]["extra_share"].as_f64(), depth.extra_share());
    assert_eq!(json["depth"]["missed_share"], 0.0);

    // An infinite PSNR is null, a finite one is not.
    assert!(json["color"]["psnr_db"].is_f64());
    let same = figures(&other, &other, SCALE).unwrap();
    assert_eq!(same.color.unwrap().psnr_db, f64::INFINITY);
    let text = serde_json::to_string(&same).unwrap();
    assert!(text.contains(r#""psnr_db":null"#), "{text}");
}

#[test]
fn what_cannot_be_compared_is_an_error() {
    let good = flat(12, 12, 0.5);
    let turned = flat(12, 13, 0.5);
    let bare = Frame {
        display: None,
        ..good.clone()
    };
    type Figure = fn(&Frame, &Frame) -> angioray::Result<Option<f64>>;
    for figure in [ssim as Figure, flip] {
        assert!(figure(&good, &good).unwrap().is_some());
        assert!(figure(&good, &turned).is_err());
        let message = figure(&good, &bare).unwrap_err().to_string();
        assert!(
            message.contains("the picture has no display plane"),
            "{message}"
        );
        for poison in [f32::NAN, f32::INFINITY] {
            let mut bad = good.clone();
            bad.display.as_mut().unwrap()[12 * 3 + 4][2] = poison;
            for (a, b) in [(&good, &bad), (&bad, &good)] {
                let message = figure(a, b).unwrap_err().to_string();
                assert!(message.contains("pixel 4,3"), "{message}");
            }
        }
    }
    assert!(figures(&good, &turned, SCALE).is_err());
}
