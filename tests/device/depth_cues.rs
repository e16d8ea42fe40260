//! Depth cues against closed forms, on the device and in the reference, and one against the other.

use angioray::Subject;
use angioray::extent::{Dims, ImageSize};
use angioray::frame::{Frame, KIND, Kind, Wanted};
use angioray::gpu::Device;
use angioray::render::{Lanes, Options, Renderer};
use angioray::scene::{
    AntiAliasing, Camera, DepthCue, DepthCues, DepthOfField, DepthRange, DofMethod, Lens, Mode,
    Picture, Ramp, Rgb, Scene, Sparse, SparseGrid,
};
use angioray::volume::{PhantomKind, PhantomSpec, Volume, phantom};
use glam::DVec3;

use crate::common::{self, Figure, on_device, on_reference, volume_of};

/// The axes of two tubes along z, and their radius.
const TUBES: [(f64, f64); 2] = [(10.0, 8.0), (21.0, 24.0)];
const RADIUS: f64 = 3.25;

fn two_tubes() -> Volume {
    volume_of([32, 32, 12], |x, y, _| {
        let inside = |(cx, cy): (f64, f64)| RADIUS - f64::hypot(x - cx, y - cy);
        TUBES.map(inside).into_iter().fold(f64::MIN, f64::max) as f32
    })
}

/// The tubes from the front, in parallel: y is the depth less that of the eye plane.
const EYE_Y: f64 = -100.0;

fn scene(cues: &[&str]) -> Scene {
    let size = ImageSize::new(96, 36).unwrap();
    let lens = Lens::Orthographic { height_mm: 12.0 };
    let target = DVec3::new(15.5, 16.0, 5.5);
    let eye = DVec3::new(target.x, EYE_Y, target.z);
    let camera = Camera::look_at(eye, target, DVec3::Z, lens).unwrap();
    let picture = Picture::Surface {
        iso: 0.0,
        caps: true,
        refine: Default::default(),
        color: Rgb([0.5; 3]),
        phong: None,
    };
    let volume = two_tubes();
    Scene {
        size,
        camera,
        sampling: Default::default(),
        depth_cues: Some(depth_cues(cues, [100.0, 132.0], size)),
        ..common::scene(&volume, 36, picture)
    }
}

fn depth_cues(cues: &[&str], [near, far]: [f64; 2], size: ImageSize) -> DepthCues {
    let cues: Vec<DepthCue> = cues.iter().map(|text| text.parse().unwrap()).collect();
    DepthCues::new(&cues, DepthRange::new(near, far).unwrap(), size).unwrap()
}

/// The colour where a tube is nearest to the eye.
fn at_tube(frame: &Frame, tube: usize) -> [f64; 4] {
    let (width, height) = (frame.size.width(), frame.size.height());
    let px_per_mm = f64::from(height) / 12.0;
    // The pixel whose centre is nearest to the axis.
    let column = (f64::from(width) / 2.0 + (TUBES[tube].0 - 15.5) * px_per_mm) as u32;
    let pixel = (height / 2 * width + column) as usize;
    frame.color[pixel].map(f64::from)
}

/// The share of the way from near to far at which a tube is nearest.
fn share(tube: usize) -> f64 {
    (TUBES[tube].1 - RADIUS) / 32.0
}

fn both(device: &Device, volume: &Volume, scene: &Scene) -> [Frame; 2] {
    let of_device = on_device(device, volume, std::slice::from_ref(scene)).remove(0);
    [of_device, on_reference(volume, scene)]
}

#[test]
fn two_tubes_have_the_colours_of_their_depths() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = two_tubes();
    let near = |color: [f64; 4], expected: [f64; 4]| {
        color
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < 0.01)
    };
    let fog = scene(&["fog:0.75"]);
    let colors = scene(&["chromadepth:1"]);
    let coarse = scene(&["chromadepth:1,ramp=red-white-blue,steps=4"]);
    let rim = scene(&["chromadepth:1,rim=3"]);
    for tube in [0, 1] {
        let kept = 1.0 - 0.75 * share(tube);
        for frame in both(&device, &volume, &fog) {
            let expected = [0.5 * kept, 0.5 * kept, 0.5 * kept, kept];
            assert!(near(at_tube(&frame, tube), expected), "{expected:?}");
            // The control: not those of the other tube.
            assert!(!near(at_tube(&frame, 1 - tube), expected));
        }
        let [r, g, b] = Ramp::Full.color(share(tube)).map(|channel| 0.5 * channel);
        for frame in both(&device, &volume, &colors) {
            assert!(near(at_tube(&frame, tube), [r, g, b, 1.0]));
        }
        // Four depths, 0.125, 0.375, ..: the tubes are in the first and the third.
        let told = [0.125, 0.625][tube];
        let [r, g, b] = Ramp::RedWhiteBlue.color(told).map(|channel| 0.5 * channel);
        for frame in both(&device, &volume, &coarse) {
            assert!(near(at_tube(&frame, tube), [r, g, b, 1.0]));
        }
        // What is faced is not at the rim.
        for frame in both(&device, &volume, &rim) {
            assert!(near(at_tube(&frame, tube), [0.5, 0.5, 0.5, 1.0]));
        }
    }
}

#[test]
fn halos_and_contours_lie_beside_the_tubes_edges() {
    let Some(device) = common::device() else {
        return;
    };
    // A far wall behind both tubes, so that there is something to dim.
    let volume = volume_of([32, 32, 12], |x, y, _| {
        let inside = |(cx, cy): (f64, f64)| RADIUS - f64::hypot(x - cx, y - cy);
        TUBES.map(inside).into_iter().fold(y - 29.5, f64::max) as f32
    });
    let (halo, contour) = (scene(&["halo:1,width=6"]), scene(&["contour:1,width=1"]));
    for frame in both(&device, &volume, &halo) {
        let row = 18 * 96;
        // The first tube's left edge lies 10 - 3.25 mm from x = 0, which is at column 48 - 15.5 * 3.
        let edge = 48.0 + (10.0 - RADIUS - 15.5) * 3.0;
        let last = edge as usize; // the last column of the wall before it
        let dark = |column: usize| 1.0 - f64::from(frame.color[row + column][0]) / 0.5;
        for beside in 0..6 {
            let expected = 1.0 - (beside + 1) as f64 / 7.0;
            assert!((dark(last - 1 - beside) - expected).abs() < 1.0 / 6.9);
        }
        assert_eq!(dark(last - 9), 0.0);
        // Nothing is nearer than the tube's axis.
        assert!((at_tube(&frame, 0)[0] - 0.5).abs() < 1e-4);
    }
    for frame in both(&device, &volume, &contour) {
        let row = &frame.color[18 * 96..19 * 96];
        let dark = |column: &usize| row[*column][3] == 1.0 && row[*column][0] < 0.005;
        let columns: Vec<usize> = (0..96).filter(dark).collect();
        // A line a pixel wide on either side of each tube, and where the wall ends.
        assert_eq!(columns, [1, 22, 40, 55, 73, 94]);
        // Their round sides, which are made of cells, have next to none.
        let least = |least: f32, column: usize| least.min(row[column][0]);
        let darkest = (23..40).chain(56..73).fold(1.0, least);
        assert!(darkest > 0.4, "{darkest}");
    }
}

/// All cues at once, as far as a mode has them.
fn all_cues(mode: Mode) -> Vec<&'static str> {
    let colors = match mode {
        Mode::Iso | Mode::Dvr => "chromadepth:0.7,rim=1.5",
        _ => "chromadepth:0.7,steps=5",
    };
    vec!["fog:0.6", colors, "halo:0.6,width=3", "contour:0.5"]
}

fn tree() -> Volume {
    let dims = Dims::new([32; 3]).unwrap();
    phantom(&PhantomSpec::new(PhantomKind::Vessels, dims))
        .unwrap()
        .volume
}

fn of_mode(volume: &Volume, mode: Mode, cues: &[&str]) -> Scene {
    let subject = Subject::of(volume);
    let scene = Scene::of_mode(mode, &subject).unwrap();
    let size = ImageSize::new(64, 64).unwrap();
    let range = DepthRange::of_content(subject.content, &scene.camera).unwrap();
    let cues = depth_cues(cues, [range.near_mm(), range.far_mm()], size);
    Scene {
        size,
        depth_cues: Some(cues),
        ..scene
    }
}

#[test]
fn cues_agree_with_the_reference_in_every_mode() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tree();
    for (mode, limit) in [
        (Mode::Iso, 0.002),
        (Mode::Mip, 0.002),
        (Mode::Lmip, 0.004),
        (Mode::Dvr, 0.003),
    ] {
        let scene = of_mode(&volume, mode, &all_cues(mode));
        let [frame, reference] = both(&device, &volume, &scene);
        let error = Figure::ColorMean.of(&reference, &frame, &volume);
        assert!(error < limit, "{mode}: {error}");
        // The controls: without any one of them, it is another picture.
        for without in 0..4 {
            let mut cues = all_cues(mode);
            cues.remove(without);
            let other = of_mode(&volume, mode, &cues);
            let other = on_device(&device, &volume, &[other]).remove(0);
            let apart = Figure::ColorMean.of(&reference, &other, &volume);
            assert!(
                apart > 1.5 * error && apart > 0.0005,
                "{mode} {without}: {apart} {error}"
            );
        }
    }
}

#[test]
fn cues_go_with_many_rays_few_rays_and_a_lens() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tree();
    let tinted = ["fog:0.6", "chromadepth:0.7"];
    let whole = of_mode(&volume, Mode::Iso, &all_cues(Mode::Iso));
    let aa = |text: &str| Scene {
        anti_aliasing: text.parse::<AntiAliasing>().unwrap(),
        ..whole.clone()
    };
    let grid = SparseGrid::new(4, None).unwrap();
    let sparse = Scene {
        sparse: Some(Sparse::new(Some(grid), None, None, Mode::Iso).unwrap()),
        ..whole.clone()
    };
    let mut lens = of_mode(&volume, Mode::Iso, &tinted);
    lens.depth_of_field = Some("focus=auto,aperture=1.5".parse::<DepthOfField>().unwrap());
    let mut many = lens.clone();
    many.sampling.dof = "lens:64".parse::<DofMethod>().unwrap();
    for (what, scene) in [
        ("aa", aa("3")),
        ("adaptive", aa("3:adaptive")),
        ("sparse", sparse),
        ("many lens rays", many),
        ("gather", lens),
    ] {
        let error = |scene: &Scene| {
            let [frame, reference] = both(&device, &volume, scene);
            Figure::ColorMean.of(&reference, &frame, &volume)
        };
        let plain = Scene {
            depth_cues: None,
            ..scene.clone()
        };
        let (with, without) = (error(&scene), error(&plain));
        assert!(with < 1.1 * without + 0.0005, "{what}: {with} {without}");
        // The control: they are different pictures.
        let [cued, plain] = [scene, plain].map(|scene| on_reference(&volume, &scene));
        let apart = Figure::ColorMean.of(&cued, &plain, &volume);
        assert!(apart > 0.005, "{what}: {apart}");
    }
}

#[test]
fn lanes_change_no_bit_and_no_cue_is_no_pass() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tree();
    let octree = common::octree(&volume);
    let scene = of_mode(&volume, Mode::Iso, &all_cues(Mode::Iso));
    let render = |lanes, scene: &Scene| {
        let options = Options {
            lanes: Some(lanes),
            ..Options::default()
        };
        let mut renderer = Renderer::new(&device, &volume, &octree, options).unwrap();
        renderer.render(scene, Wanted::ALL).unwrap()
    };
    let passes = |rendering: &angioray::render::Rendering| {
        let names = rendering.passes.iter().map(|pass| pass.name.to_string());
        names.collect::<Vec<String>>()
    };
    let one = render(Lanes::ONE, &scene);
    assert!(passes(&one).contains(&"tint_by_depth".to_owned()));
    assert!(passes(&one).contains(&"dim_at_edges".to_owned()));
    for lanes in Lanes::ALL {
        let frame = render(lanes, &scene).frame;
        assert!(frame.color == one.frame.color, "{lanes} lanes");
    }
    let plain = Scene {
        depth_cues: None,
        ..scene
    };
    let plain = render(Lanes::ONE, &plain);
    assert!(!passes(&plain).contains(&"tint_by_depth".to_owned()));
    assert!(!passes(&plain).contains(&"dim_at_edges".to_owned()));
    assert!(plain.frame.color != one.frame.color);
}

/// Fog takes opacity, but what is there is there still.
#[test]
fn what_fog_hides_keeps_its_layers() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tree();
    let mut scene = of_mode(&volume, Mode::Dvr, &["fog:1"]);
    let cues = scene.depth_cues.as_mut().unwrap();
    cues.range = DepthRange::new(0.0, 1.0).unwrap(); // all is far
    for frame in both(&device, &volume, &scene) {
        let kinds = frame.plane(KIND).unwrap().iter();
        let pixels = kinds.zip(&frame.color);
        let there = pixels.filter(|(kind, _)| **kind == Kind::Surface as u32);
        let colors: Vec<&[f32; 4]> = there.map(|(_, color)| color).collect();
        assert!(colors.len() > 100);
        assert!(colors.iter().all(|color| **color == [0.0; 4]));
    }
}

/// What is parallel looks the same from the front and, mirrored, from behind: a maximum does not say which is which.
#[test]
fn a_parallel_maximum_is_ambiguous_and_a_cue_is_not() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tree();
    let from = |toward_eye: DVec3, cues: &[&str]| {
        let mut scene = of_mode(&volume, Mode::Mip, &[]);
        let (center, radius_mm) = volume.bounding_sphere();
        let eye = center + toward_eye * 3.0 * radius_mm;
        let lens = Lens::Orthographic {
            height_mm: 2.0 * radius_mm,
        };
        scene.camera = Camera::look_at(eye, center, DVec3::Z, lens).unwrap();
        let ends = [2.0 * radius_mm, 4.0 * radius_mm];
        scene.depth_cues = (!cues.is_empty()).then(|| depth_cues(cues, ends, scene.size));
        scene
    };
    let mirrored = |frame: &Frame| {
        let mut color = frame.color.clone();
        let width = frame.size.width() as usize;
        color.chunks_mut(width).for_each(|row| row.reverse());
        color
    };
    let apart = |a: &[[f32; 4]], b: &[[f32; 4]]| {
        let channels = a.as_flattened().iter().zip(b.as_flattened());
        let differences = channels.map(|(a, b)| f64::from((a - b).abs()));
        differences.sum::<f64>() / (4 * a.len()) as f64
    };
    for (cues, same) in [(&[][..], true), (&["chromadepth:1"][..], false)] {
        let front = both(&device, &volume, &from(DVec3::NEG_Y, cues));
        let behind = both(&device, &volume, &from(DVec3::Y, cues));
        for (front, behind) in front.iter().zip(&behind) {
            let difference = apart(&front.color, &mirrored(behind));
            assert_eq!(difference < 1e-5, same, "{cues:?}: {difference}");
            // The control: not without mirroring.
            assert!(apart(&front.color, &behind.color) > 1e-3);
        }
    }
}
