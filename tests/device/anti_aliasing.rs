//! Many rays in a pixel: against the reference's, whose pixels are means of as many rays; adaptive against
//! all of them; and what no ray count changes.

use angioray::frame::{CAST, COVERAGE, DEPTH, Frame, KIND, NODES, NORMAL, STEPS, VALUE, Wanted};
use angioray::render::{Lanes, Options, Renderer};
use angioray::scene::{AntiAliasing, Picture, SamplingMethod, Scene, srgb_from_linear};
use angioray::volume::Volume;

use super::invariance::{pictures, tubes};
use crate::common;

const SIZE_PX: u32 = 41;
/// Of a picture of which one pixel in 256 are enough to judge by.
const ADAPTIVE_PX: u32 = 400;

fn aa(text: &str) -> AntiAliasing {
    text.parse().unwrap()
}

fn scenes(volume: &Volume, size_px: u32) -> Vec<Scene> {
    let scene = |picture| {
        let mut scene = common::scene(volume, size_px, picture);
        if !matches!(scene.picture, Picture::Emission(_)) {
            scene.sampling.method = SamplingMethod::Exact;
        }
        scene
    };
    let pictures = pictures(volume.range().max).into_iter();
    pictures.map(scene).collect()
}

fn with(scene: &Scene, text: &str) -> Scene {
    Scene {
        anti_aliasing: aa(text),
        ..scene.clone()
    }
}

fn rmse(a: &Frame, b: &Frame) -> f64 {
    let squares = a.color.iter().zip(&b.color).flat_map(|(a, b)| {
        let channels = a.iter().zip(b);
        channels
            .map(|(a, b)| f64::from(a - b).powi(2))
            .collect::<Vec<_>>()
    });
    (squares.sum::<f64>() / (4 * a.color.len()) as f64).sqrt()
}

/// The differences of red, green and blue, sRGB-encoded.
fn encoded_apart(a: &Frame, b: &Frame) -> Vec<f64> {
    let encoded = |c: f32| srgb_from_linear(f64::from(c).max(0.0));
    let pixels = a.color.iter().zip(&b.color);
    let apart = pixels.flat_map(|(a, b)| [0, 1, 2].map(|c| (encoded(a[c]) - encoded(b[c])).abs()));
    apart.collect()
}

fn rmse_encoded(a: &Frame, b: &Frame) -> f64 {
    let apart = encoded_apart(a, b);
    (apart.iter().map(|d| d * d).sum::<f64>() / apart.len() as f64).sqrt()
}

fn max_encoded(a: &Frame, b: &Frame) -> f64 {
    encoded_apart(a, b).into_iter().fold(0.0, f64::max)
}

#[test]
fn a_pixel_is_the_mean_of_its_rays() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    for scene in scenes(&volume, SIZE_PX) {
        let mode = scene.picture.mode();
        for text in ["2", "3"] {
            let scene = with(&scene, text);
            let expected = common::on_reference(&volume, &scene);
            let frame = &common::on_device(&device, &volume, std::slice::from_ref(&scene))[0];
            assert!(
                rmse(frame, &expected) < 2e-3,
                "{mode} {text}: {}",
                rmse(frame, &expected)
            );
            let coverage = |frame: &Frame| frame.plane(COVERAGE).unwrap().to_vec();
            let pairs = coverage(frame).into_iter().zip(coverage(&expected));
            let differ = pairs.filter(|(a, b)| (a - b).abs() > 1e-6).count();
            assert!(differ * 200 < frame.color.len(), "{mode} {text}: {differ}");
            // The layers are those of one ray, through the centre.
            let one = &common::on_device(&device, &volume, &[with(&scene, "1")])[0];
            for key in [DEPTH, VALUE] {
                assert_eq!(frame.plane(key), one.plane(key), "{mode}");
            }
            assert_eq!(frame.plane(NORMAL), one.plane(NORMAL));
            // The control: one ray a pixel is another picture.
            assert!(
                rmse(one, &expected) > 3.0 * rmse(frame, &expected),
                "{mode} {text}"
            );
        }
    }
}

#[test]
fn coverage_of_one_ray_is_whether_it_met_something() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    for scene in scenes(&volume, SIZE_PX) {
        for frame in [
            common::on_reference(&volume, &scene),
            common::on_device(&device, &volume, std::slice::from_ref(&scene)).remove(0),
        ] {
            let pairs = frame
                .plane(COVERAGE)
                .unwrap()
                .iter()
                .zip(frame.plane(KIND).unwrap());
            assert!(
                pairs
                    .into_iter()
                    .all(|(&share, &kind)| share == f32::from(u8::from(kind != 0)))
            );
        }
    }
}

#[test]
fn adaptive_rays_give_the_picture_of_all_rays_at_a_share_of_them() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let scene = with(&scenes(&volume, ADAPTIVE_PX)[0], "4");
    let all = renderer.render(&scene, Wanted::ALL).unwrap();
    let adaptive = renderer
        .render(&with(&scene, "4:adaptive"), Wanted::ALL)
        .unwrap();
    let one = renderer.render(&with(&scene, "1"), Wanted::ALL).unwrap();
    let error = rmse(&adaptive.frame, &all.frame);
    assert!(error < 0.5 / 255.0, "{}", error * 255.0);
    assert!(rmse(&one.frame, &all.frame) > 10.0 * error);
    let pixels = u64::from(ADAPTIVE_PX).pow(2);
    assert_eq!(adaptive.rays_per_round[0], pixels);
    let share = adaptive.rays_per_round[1] as f64 / (16 * pixels) as f64;

    assert!(share < 0.6, "{share}");
    // How wrong it is, is known from a few pixels that are checked.
    let check = adaptive.sample_check.unwrap();
    let encoded = rmse_encoded(&adaptive.frame, &all.frame);
    assert!(check.pixels > 10, "{check:?}");
    assert!(
        (0.2..5.0).contains(&(check.rmse / encoded)),
        "{check:?} {encoded}"
    );
    assert!(check.max <= max_encoded(&adaptive.frame, &all.frame) + 1e-5);
    assert_eq!(one.sample_check, None);
    assert_eq!(all.rays_per_round, [pixels, 16 * pixels]);
    // A pixel that shows nothing to any ray has none more, and one that shows nothing to its first has all its
    // rays where any other may meet something: nothing thin is lost.
    let thin = |frame: &Frame| {
        let pairs = frame
            .plane(COVERAGE)
            .unwrap()
            .iter()
            .zip(frame.plane(KIND).unwrap());
        pairs
            .map(|(&share, &kind)| kind == 0 && share > 0.0)
            .collect::<Vec<bool>>()
    };
    assert_eq!(thin(&adaptive.frame), thin(&all.frame));
    assert!(thin(&all.frame).iter().filter(|&&thin| thin).count() > 100);
}

#[test]
fn nothing_else_changes_a_bit_of_an_antialiased_picture() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let octree = common::octree(&volume);
    let picture = |options, scene: &Scene, wanted| {
        let mut renderer = Renderer::new(&device, &volume, &octree, options).unwrap();
        let mut frame = renderer.render(scene, wanted).unwrap().frame;
        for key in [STEPS, NODES, CAST] {
            frame.layers.take(key);
        }
        frame
    };
    // A surface, a projection and a medium.
    let all = scenes(&volume, SIZE_PX).into_iter().enumerate();
    for (n, scene) in all.filter(|(n, _)| [0, 1, 5].contains(n)) {
        for text in ["3", "3:adaptive"] {
            let scene = with(&scene, text);
            let base = picture(Options::default(), &scene, Wanted::ALL);
            let options = Options {
                lanes: Some(Lanes::ONE),
                work_group: Some([3, 1]),
            };
            let other = picture(options, &scene, Wanted::ALL);
            assert!(base.bit_equal(&other), "{n} {text}");
            // Wanting layers changes no colour.
            assert_eq!(
                base.color,
                picture(Options::default(), &scene, Wanted::NONE).color
            );
        }
    }
}
