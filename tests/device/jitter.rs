//! Samples shifted ray by ray (`--jitter`): where they lie, what that does to a picture's error, and what never changes a
//! bit of it.

use crate::common;

use angioray::extent::ImageSize;
use angioray::frame::{CAST, DEPTH, Frame, KIND, STEPS, VALUE, Wanted};
use angioray::gpu::Device;
use angioray::render::{Lanes, Options, Renderer};
use angioray::scene::{
    AntiAliasing, Camera, ClipPlane, Emission, Filter, Homogeneity, HomogeneityLimit,
    HomogeneityRule, Jitter, Knot, Lens, Picture, Projection, Quadrature, QuadratureMethod,
    Reconstruction, Refill, Refine, RefineMethod, Rgb, Scene, Sparse, SparseGrid, StepVoxels,
    Termination, TransferFunction, Traverse, Window,
};
use angioray::volume::Volume;
use common::{hash, volume_of};
use glam::DVec3;

use super::invariance::{picture_bits, pictures, tubes};

/// No multiple of a tile.
const SIZE_PX: u32 = 53;

const JITTERS: [&str; 3] = ["interleaved:3:5", "hash:7:2", "shift:0.8125"];

fn jitter(text: &str) -> Jitter {
    text.parse().unwrap()
}

/// The scene by this jitter.
fn by(scene: &Scene, text: &str) -> Scene {
    let mut scene = scene.clone();
    scene.sampling.jitter = jitter(text);
    scene
}

fn stepped(mut scene: Scene, voxels: f64) -> Scene {
    scene.sampling.step = StepVoxels::new(voxels).unwrap();
    scene
}

/// A picture of every cast at fixed steps, emission under rules whose panels are unlike.
fn scenes(volume: &Volume, step: f64) -> Vec<Scene> {
    let all = pictures(volume.range().max);
    let mut chosen = Vec::new();
    for picture in all {
        match &picture {
            Picture::Emission(medium) if medium.phong.is_none() => {
                for method in [
                    QuadratureMethod::Riemann,
                    QuadratureMethod::Simpson,
                    QuadratureMethod::Preintegrated,
                ] {
                    chosen.push(Picture::Emission(Emission {
                        quadrature: Quadrature::of(method),
                        ..medium.clone()
                    }));
                }
            }
            Picture::Emission(_) => {}
            _ => chosen.push(picture),
        }
    }
    let scene = |picture| stepped(common::scene(volume, SIZE_PX, picture), step);
    chosen.into_iter().map(scene).collect()
}

/// Whether a picture is one of three that stand for all where nothing depends on the mode.
fn stands_for_others(picture: &Picture) -> bool {
    match picture {
        Picture::Surface { .. } => true,
        Picture::Projection { of, .. } => *of == Projection::Maximum,
        Picture::Emission(medium) => medium.quadrature.method() == QuadratureMethod::Simpson,
    }
}

/// Noise in bytes, as the tubes are.
fn noise() -> Volume {
    volume_of([19, 33, 26], |x, y, z| (255.0 * hash(x, y, z)) as u8)
}

/// A plane that cuts the volume aslant through its middle.
fn cut(volume: &Volume) -> ClipPlane {
    let (normal, middle) = (DVec3::new(0.3, 1.0, -0.2), volume.bounding_sphere().0);
    ClipPlane::new(normal, -normal.dot(middle)).unwrap()
}

fn rendered(device: &Device, volume: &Volume, scene: &Scene, options: Options) -> Frame {
    let octree = common::octree(volume);
    let mut renderer = Renderer::new(device, volume, &octree, options).unwrap();
    renderer.render(scene, Wanted::ALL).unwrap().frame
}

#[test]
fn a_shift_by_nothing_is_the_picture_without_jitter_to_the_last_bit() {
    let Some(device) = common::device() else {
        return;
    };
    for (volume, step) in [(tubes(), 0.7), (noise(), 2.3)] {
        for mut scene in scenes(&volume, step) {
            for filter in [Filter::Linear, Filter::Nearest] {
                scene.sampling.filter = filter;
                let both = [by(&scene, "none"), by(&scene, "shift:0")];
                let frames = common::on_device(&device, &volume, &both);
                let mode = scene.picture.mode();
                // Counters too: not a sample more.
                assert!(frames[0].bit_equal(&frames[1]), "{mode} {filter:?}");
                // The control.
                let shifted = by(&scene, "shift:0.5");
                let shifted = &common::on_device(&device, &volume, &[shifted])[0];
                assert!(!shifted.bit_equal(&frames[0]), "{mode} {filter:?}");
            }
        }
    }
}

/// That neither skipping nor a traversal, lanes nor work-groups change a bit of a scene.
fn assert_same_whatever_the_way(device: &Device, volume: &Volume, scene: &Scene) {
    let mut whole = scene.clone();
    whole.sampling.skip = false;
    let [one, eight, sixteen] = Lanes::ALL.map(|lanes| Options {
        lanes: Some(lanes),
        ..Options::default()
    });
    let of_group = Options {
        work_group: Some([5, 3]),
        ..eight
    };
    let expected = picture_bits(&rendered(device, volume, &whole, one));
    let mut ways: Vec<(Traverse, Options)> = Vec::new();
    ways.extend(Traverse::ALL.map(|traverse| (traverse, eight)));
    ways.extend([one, sixteen, of_group].map(|options| (Traverse::Distance, options)));
    ways.push((Traverse::Hierarchical, one));
    for (traverse, options) in ways {
        let mut scene = scene.clone();
        scene.sampling.traverse = traverse;
        let frame = rendered(device, volume, &scene, options);
        assert!(
            picture_bits(&frame) == expected,
            "{} {} {traverse} {options:?}",
            scene.picture.mode(),
            scene.sampling.jitter
        );
    }
}

#[test]
fn nothing_about_how_rays_get_there_changes_a_bit() {
    let Some(device) = common::device() else {
        return;
    };
    for (volume, step) in [(tubes(), 0.6), (noise(), 2.3)] {
        for (number, scene) in scenes(&volume, step).into_iter().enumerate() {
            let mut scene = by(&scene, JITTERS[number % JITTERS.len()]);
            assert_same_whatever_the_way(&device, &volume, &scene);
            scene.clip_planes = vec![cut(&volume)];
            scene.sampling.probe = false;
            scene.sampling.jitter = jitter(JITTERS[(number + 1) % JITTERS.len()]);
            assert_same_whatever_the_way(&device, &volume, &scene);
        }
    }
}

/// Nearest voxels on the way to a surface, parallel rays.
#[test]
fn nor_does_it_over_nearest_voxels_or_along_parallel_rays() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let (center, radius_mm) = volume.bounding_sphere();
    let eye = center + common::OBLIQUE.normalize() * (radius_mm * 3.0);
    let lens = Lens::Orthographic {
        height_mm: 2.2 * radius_mm,
    };
    let scenes = scenes(&volume, 0.6).into_iter();
    let scenes = scenes.filter(|scene| stands_for_others(&scene.picture));
    for (number, scene) in scenes.enumerate() {
        let mut scene = by(&scene, JITTERS[number % JITTERS.len()]);
        scene.camera = Camera::look_at(eye, center, DVec3::Z, lens).unwrap();
        if matches!(scene.picture, Picture::Surface { .. }) {
            scene.sampling.recon = Reconstruction::Adaptive;
            scene.sampling.probe = false;
        }
        assert_same_whatever_the_way(&device, &volume, &scene);
    }
}

/// Averages stand for leaves whether or not anything is skipped; the samples of one are still a panel.
#[test]
fn homogeneous_leaves_are_passed_alike_by_all_traversals() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = volume_of([40, 44, 36], |x, y, z| {
        let inside = [x, y, z].iter().all(|at| (5.0..33.0).contains(at));
        let value = if inside { 150.0 } else { 20.0 };
        (value + 6.0 * hash(x, y, z)) as u8
    });
    let all = scenes(&volume, 0.6).into_iter();
    let mut medium = all.filter(|scene| matches!(scene.picture, Picture::Emission(_)));
    let without = by(&medium.next().unwrap(), JITTERS[1]);
    let mut scene = without.clone();
    if let Picture::Emission(medium) = &mut scene.picture {
        medium.homogeneity = Some(Homogeneity {
            rule: HomogeneityRule::Range,
            limit: HomogeneityLimit::new(0.1).unwrap(),
        });
    }
    let bits = |scene: &Scene| picture_bits(&rendered(&device, &volume, scene, Options::default()));
    let by_traversals = Traverse::ALL.map(|traverse| {
        let mut scene = scene.clone();
        scene.sampling.traverse = traverse;
        bits(&scene)
    });
    assert!(by_traversals.iter().all(|one| *one == by_traversals[0]));
    // The controls: there are such leaves, and a shift changes where they begin.
    assert!(by_traversals[0] != bits(&without));
    assert!(by_traversals[0] != bits(&by(&scene, "none")));
}

/// A volume whose value rises evenly, most of all from the top down.
fn ramp() -> Volume {
    volume_of([32, 32, 40], |x, y, z| (0.5 * x + 0.25 * y + z) as f32)
}

/// The value of a surface across the middle of [`along_z`]'s view.
const ISO: f64 = 31.3;

/// Parallel rays nearly along z: how far a ray runs from the top to a value varies evenly over the picture.
fn along_z(picture: Picture) -> Scene {
    let volume = ramp();
    let center = volume.bounding_sphere().0;
    let eye = center - 60.0 * DVec3::new(0.07, 0.04, 1.0).normalize();
    let lens = Lens::Orthographic { height_mm: 16.0 };
    let mut scene = common::scene(&volume, 64, picture);
    scene.camera = Camera::look_at(eye, center, DVec3::Y, lens).unwrap();
    scene.sampling.probe = false;
    scene
}

fn unrefined(iso: f64) -> Picture {
    Picture::Surface {
        iso,
        caps: true,
        refine: Refine::new(RefineMethod::None, 0).unwrap(),
        color: Rgb([1.0; 3]),
        phong: None,
    }
}

fn depths(device: &Device, scene: &Scene) -> Vec<f64> {
    let frame = &common::on_device(device, &ramp(), std::slice::from_ref(scene))[0];
    let depths = frame.plane(DEPTH).unwrap().iter();
    depths.map(|&depth| f64::from(depth)).collect()
}

#[test]
fn samples_lie_at_whole_steps_and_each_rays_own_share_of_one() {
    let Some(device) = common::device() else {
        return;
    };
    let step = 1.5;
    // Everything is inside: each ray hits where it enters.
    let entries = depths(&device, &along_z(unrefined(-1.0)));
    let scene = stepped(along_z(unrefined(ISO)), step);
    for text in [
        "interleaved:4:3",
        "interleaved:7",
        "hash:9:4",
        "shift:0.3",
        "none",
    ] {
        let hits = depths(&device, &by(&scene, text));
        let off = |jitter: Jitter| {
            let (mut most, mut counted) = (0.0_f64, 0);
            for (pixel, (entry, hit)) in entries.iter().zip(&hits).enumerate() {
                let (x, y) = (pixel as u32 % 64, pixel as u32 / 64);
                let (numerator, denominator) = jitter.shift(x, y);
                let share = f64::from(numerator) / f64::from(denominator);
                let steps = (hit - entry) / step - share;
                assert!(hit.is_finite() && steps > 5.0);
                most = most.max((steps - steps.round()).abs());
                counted += 1;
            }
            assert_eq!(counted, 64 * 64);
            most
        };
        assert!(off(jitter(text)) < 1e-4, "{text}: {}", off(jitter(text)));
        // The control: by another jitter they do not.
        assert!(off(jitter("hash:10:4")) > 0.3, "{text}");
    }
}

/// The mean and the standard deviation of the means of 4 × 4 pixels.
fn of_tiles(values: &[f64]) -> [f64; 2] {
    let tile = |n: usize| {
        let (x, y) = (n % 16 * 4, n / 16 * 4);
        let rows = (y..y + 4).flat_map(|row| &values[row * 64 + x..row * 64 + x + 4]);
        rows.sum::<f64>() / 16.0
    };
    let tiles: Vec<f64> = (0..256).map(tile).collect();
    let mean = tiles.iter().sum::<f64>() / 256.0;
    let squares = tiles.iter().map(|tile| (tile - mean).powi(2)).sum::<f64>();
    [mean, (squares / 256.0).sqrt()]
}

/// An unrefined hit lies up to a step behind the surface, evenly so: half a step on average, √(1/12) of a step about
/// that.
#[test]
fn bands_become_grain_and_the_mean_stays() {
    let Some(device) = common::device() else {
        return;
    };
    let step = 2.0;
    let scene = stepped(along_z(unrefined(ISO)), step);
    let mut exact = along_z(unrefined(ISO));
    exact.sampling.method = angioray::scene::SamplingMethod::Exact;
    let truth = depths(&device, &exact);
    let errors = |text: &str| -> Vec<f64> {
        let hits = depths(&device, &by(&scene, text));
        let errors = hits.iter().zip(&truth).map(|(hit, truth)| hit - truth);
        errors.map(|error| error / step).collect()
    };
    let even = (1.0_f64 / 12.0).sqrt();
    for (text, most) in [
        ("interleaved:2", 0.4),
        ("interleaved:4", 0.15),
        ("hash:3", 0.3),
    ] {
        let errors = errors(text);
        // No hit is further off than without: none before the surface, none more than a step behind it.
        assert!(
            errors
                .iter()
                .all(|error| (-1e-4..1.0 + 1e-4).contains(error)),
            "{text}"
        );
        let [mean, deviation] = of_tiles(&errors);
        assert!((mean - 0.5).abs() < 0.02, "{text}: {mean}");
        assert!(deviation < most * even, "{text}: {deviation}");
        let squares: f64 = errors.iter().map(|error| (error - 0.5).powi(2)).sum();
        let deviation = (squares / errors.len() as f64).sqrt();
        assert!((deviation / even - 1.0).abs() < 0.1, "{text}: {deviation}");
    }
    // The controls: without jitter, and with one share for all, the bands are there.
    for text in ["none", "shift:0.5"] {
        let [mean, deviation] = of_tiles(&errors(text));
        assert!((mean - 0.5).abs() < 0.1, "{text}: {mean}");
        assert!(deviation > 0.7 * even, "{text}: {deviation}");
    }
}

/// The trapezoid rule is exact along a ramp, and a uniform medium's opacity depends on the path alone: wherever samples
/// lie, if only their panels leave nothing out.
#[test]
fn panels_tile_each_ray_from_its_entry_to_its_exit() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = ramp();
    let mean = Picture::Projection {
        of: Projection::Mean,
        window: Window::new(0.0, 40.0).unwrap(),
    };
    let uniform = |method| {
        let knot = Knot {
            value: 0.0,
            color: Rgb([0.5, 0.7, 0.2]),
            opacity: 0.02,
        };
        let transfer = TransferFunction::new(vec![knot], 1.0).unwrap();
        Picture::Emission(Emission {
            quadrature: Quadrature::of(method),
            termination: Termination::NEVER,
            ..Emission::of(transfer)
        })
    };
    let mut pictures = vec![mean];
    pictures.extend(
        QuadratureMethod::ALL
            .into_iter()
            .filter(|method| *method != QuadratureMethod::Adaptive)
            .map(uniform),
    );
    for picture in pictures {
        for camera in [
            along_z(picture.clone()),
            common::scene(&volume, 64, picture),
        ] {
            let truth = common::on_reference(&volume, &camera);
            for text in JITTERS {
                let scene = by(&stepped(camera.clone(), 3.7), text);
                let frame = &common::on_device(&device, &volume, &[scene])[0];
                let values = truth.plane(VALUE).unwrap().iter();
                let values = values.zip(frame.plane(VALUE).unwrap());
                let apart = values.fold(0.0_f32, |most, (a, b)| most.max((a - b).abs()));
                let alphas = truth.color.iter().zip(&frame.color);
                let apart_alpha =
                    alphas.fold(0.0_f32, |most, (a, b)| most.max((a[3] - b[3]).abs()));
                let is_mean = camera.picture.mode().name() == "mean";
                assert!(!is_mean || apart < 1e-3, "{text}: {apart}");
                assert!(apart_alpha < 2e-6, "{text}: {apart_alpha}");
            }
        }
    }
}

#[test]
fn frames_differ_and_each_is_made_again_the_same() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = noise();
    let scene = stepped(
        common::scene(&volume, SIZE_PX, pictures(volume.range().max).remove(1)),
        2.0,
    );
    for text in ["interleaved:4", "hash:1"] {
        let at = |frame| {
            let mut scene = scene.clone();
            scene.sampling.jitter = jitter(text).at_frame(frame);
            rendered(&device, &volume, &scene, Options::default())
        };
        let frames = [0, 1, 2].map(at);
        assert!(!frames[0].bit_equal(&frames[1]) && !frames[1].bit_equal(&frames[2]));
        assert!(frames[2].bit_equal(&at(2)));
    }
    // One share for all is that of every frame; the reference takes no samples at all.
    let shift = jitter("shift:0.25");
    assert_eq!(shift.at_frame(3), shift);
    let by_reference = |text| common::on_reference(&volume, &by(&scene, text));
    assert!(by_reference("none").bit_equal(&by_reference("hash:1")));
}

/// The rays of a pixel with 3 × 3 are those of the picture three times as large.
#[test]
fn each_ray_of_a_pixel_has_a_share_of_its_own() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = noise();
    let side = 24;
    let chosen = scenes(&volume, 2.0).into_iter().map(|scene| scene.picture);
    for picture in chosen.filter(stands_for_others) {
        let mut coarse = stepped(common::scene(&volume, side, picture), 2.0);
        coarse.sampling.probe = false;
        let large = Scene {
            size: ImageSize::new(3 * side, 3 * side).unwrap(),
            ..coarse.clone()
        };
        let many = |text: &str| Scene {
            anti_aliasing: "3".parse::<AntiAliasing>().unwrap(),
            ..by(&coarse, text)
        };
        let color = |scene: Scene| {
            common::on_device(&device, &volume, &[scene])[0]
                .color
                .clone()
        };
        let mean = |fine: &[[f32; 4]], pixel: usize| -> [f32; 4] {
            let (x, y) = (pixel % side as usize * 3, pixel / side as usize * 3);
            std::array::from_fn(|c| {
                let rows = (y..y + 3).flat_map(|row| (x..x + 3).map(move |x| row * 72 + x));
                rows.map(|at| fine[at][c]).sum::<f32>() / 9.0
            })
        };
        // The share of the pixels that are not the means of nine: a ray that grazes something may tell one from the other
        // by its last bits.
        let apart = |text: &str, fine: &str| {
            let (pixels, fine) = (color(many(text)), color(by(&large, fine)));
            let differs = |&(pixel, color): &(usize, &[f32; 4])| {
                let mean = mean(&fine, pixel);
                (0..4).any(|c| (color[c] - mean[c]).abs() > 1e-3)
            };
            let count = pixels.iter().enumerate().filter(differs).count();
            count as f64 / pixels.len() as f64
        };
        let rounded = apart("none", "none");
        for text in ["interleaved:5:1", "hash:4:2"] {
            let (same, other) = (apart(text, text), apart(text, "hash:5:2"));
            let mode = large.picture.mode();
            assert!(
                same < rounded + 0.02 && other > rounded + 0.1,
                "{mode} {text}: {same} {other} {rounded}"
            );
        }
    }
}

/// The rays of a sparse picture are those of the whole one.
#[test]
fn a_pixel_that_is_cast_alone_has_the_same_samples() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let scenes = scenes(&volume, 1.3).into_iter();
    for scene in scenes.filter(|scene| stands_for_others(&scene.picture)) {
        let mode = scene.picture.mode();
        let whole = by(&scene, "hash:3");
        let grid = SparseGrid::new(4, None).unwrap();
        let sparse = Sparse::new(Some(grid), Some(Refill::Gradient), None, mode).unwrap();
        let few = Scene {
            sparse: Some(sparse),
            ..whole.clone()
        };
        let frames = common::on_device(&device, &volume, &[whole, few]);
        let cast = frames[1].plane(CAST).unwrap();
        let mut compared = 0;
        for (pixel, _) in cast.iter().enumerate().filter(|&(_, &cast)| cast == 1) {
            assert_eq!(frames[0].color[pixel], frames[1].color[pixel], "{mode}");
            compared += 1;
        }
        assert!(
            compared > 100 && compared < cast.len(),
            "{mode}: {compared}"
        );
    }
}

/// Bands are as far off as grain is: at fine steps jitter leaves the mean error what it was, a quarter more at most.
#[test]
fn errors_stay_those_of_the_step() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    for scene in scenes(&volume, 0.5) {
        let truth = common::on_reference(&volume, &scene);
        let error = |scene: Scene| {
            let frame = &common::on_device(&device, &volume, &[scene])[0];
            common::Figure::ColorMean.of(&truth, frame, &volume)
        };
        let most = 1.25 * error(scene.clone()) + 2e-4;
        let mode = scene.picture.mode();
        for text in ["interleaved:4", "hash:1"] {
            let jittered = error(by(&scene, text));
            assert!(jittered < most, "{mode} {text}: {jittered} {most}");
        }
        // The control: a step eight times as long is worse than that.
        let coarse = error(stepped(scene.clone(), 4.0));
        assert!(coarse > most, "{mode}: {coarse} {most}");
    }
}

/// At most one sample more, of the entry, and where a ray begins in the first cells the same hits.
#[test]
fn a_shift_costs_a_sample_a_ray_at_most() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = ramp();
    let mean = Picture::Projection {
        of: Projection::Mean,
        window: Window::new(0.0, 40.0).unwrap(),
    };
    let scene = stepped(along_z(mean), 1.3);
    let both = [by(&scene, "none"), by(&scene, "hash:2")];
    let frames = common::on_device(&device, &volume, &both);
    let steps = |n: usize| frames[n].plane(STEPS).unwrap().iter();
    let more = steps(0)
        .zip(steps(1))
        .map(|(a, b)| i64::from(*b) - i64::from(*a));
    let more: Vec<i64> = more.collect();
    assert!(more.iter().all(|more| [0, 1].contains(more)));
    assert!(more.contains(&0) && more.contains(&1));
    assert_eq!(frames[0].plane(KIND), frames[1].plane(KIND));
}
