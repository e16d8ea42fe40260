//! Depth of field that is gathered, and mixed, from one picture: against closed forms, the reference, and itself.

use angioray::extent::{Dims, ImageSize};
use angioray::frame::error::{FocusError, PartError, color_error, focus_error};
use angioray::frame::{COC, DEPTH, Frame, Wanted};
use angioray::gpu::Device;
use angioray::render::{Lanes, Options, Renderer};
use angioray::scene::{
    AntiAliasing, Camera, ClipPlane, DofMethod, Lens, Mode, Phong, Picture, RayCount, Sampling,
    Scene, Sparse, SparseGrid, Traverse,
};
use angioray::volume::{PhantomKind, PhantomSpec, Volume, phantom};
use glam::DVec3;

use crate::common::{self, on_device, on_reference};
use crate::lens::{apart, block};

fn gathered(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.sampling.dof = DofMethod::Gather;
    scene
}

fn pinhole(scene: &Scene) -> Scene {
    Scene {
        depth_of_field: None,
        ..scene.clone()
    }
}

/// The phantom of vessels, `size` pixels wide.
fn vessels(mode: Mode, size: u32, dof: &str) -> (Volume, Scene) {
    let dims = Dims::new([48; 3]).unwrap();
    let volume = phantom(&PhantomSpec::new(PhantomKind::Vessels, dims))
        .unwrap()
        .volume;
    let picture = Picture::of_mode(mode, &angioray::Subject::of(&volume)).unwrap();
    let mut scene = common::scene(&volume, size, picture);
    scene.sampling = Sampling {
        dof: DofMethod::Gather,
        ..Sampling::default()
    };
    scene.depth_of_field = Some(dof.parse().unwrap());
    (volume, scene)
}

#[test]
fn an_edge_is_blurred_as_the_closed_form_says() {
    let Some(device) = common::device() else {
        return;
    };
    let fov_deg = 2.0 * (0.25_f64 / 100.0).atan().to_degrees();
    let perspective = Lens::Perspective { fov_deg };
    let parallel = Lens::Orthographic { height_mm: 0.5 };
    let tan = 2.0_f64.to_radians().tan();
    for (lens, dof, circle_px) in [
        (
            perspective,
            "focus=50,aperture=4",
            4.0 * (0.02 - 0.01) * 200.0,
        ),
        (
            perspective,
            "focus=200,aperture=8",
            8.0 * (0.005 - 0.01) * 200.0,
        ),
        (
            perspective,
            "focus=50,aperture=9",
            9.0 * (0.02 - 0.01) * 200.0,
        ),
        (parallel, "focus=60,aperture=2deg", 2.0 * 40.0 * tan * 2.0),
        (parallel, "focus=130,aperture=2deg", 2.0 * -30.0 * tan * 2.0),
    ] {
        let (block, scene) = block(lens, dof);
        let frames = on_device(&device, &block, &[gathered(&scene)]);
        let found = apart(&frames[0], circle_px.abs());
        // The discs of pixels are discs of points but for their rims, and are gathered from fewer places farther out.
        let most = if circle_px.abs() < 13.0 { 0.03 } else { 0.05 };
        assert!(found < most, "{dof}: {found}");
        // The control: a circle of another size.
        assert!(apart(&frames[0], 1.4 * circle_px.abs()) > 0.03, "{dof}");
        let coc = f64::from(frames[0].plane(COC).unwrap()[30]);
        assert!((coc - circle_px).abs() < 1e-3, "{dof}: {coc}");
    }
}

/// A white plate that fills the picture, tilted, and the camera before it.
fn plate(tilt_deg: f64, lens: Lens, dof: &str) -> (Volume, Scene) {
    let plate = common::volume_of([65, 2, 65], |_, _, _| 1.0_f32);
    let picture = Picture::Surface {
        iso: 0.5,
        caps: true,
        refine: Default::default(),
        color: angioray::scene::Rgb([1.0; 3]),
        phong: None,
    };
    let mut scene = common::scene(&plate, 40, picture);
    let (sin, cos) = tilt_deg.to_radians().sin_cos();
    let target = DVec3::new(32.0, 0.0, 32.0);
    let eye = target + DVec3::new(sin, -cos, 0.0) * 100.0;
    scene.size = ImageSize::new(40, 33).unwrap();
    scene.camera = Camera::look_at(eye, target, DVec3::Z, lens).unwrap();
    scene.depth_of_field = Some(dof.parse().unwrap());
    scene.sampling = Sampling {
        dof: DofMethod::Gather,
        ..Sampling::default()
    };
    (plate, scene)
}

#[test]
fn a_white_plate_stays_white() {
    let Some(device) = common::device() else {
        return;
    };
    let perspective = Lens::Perspective { fov_deg: 8.0 };
    let parallel = Lens::Orthographic { height_mm: 16.0 };
    let darkest = |frame: &Frame| {
        let channels = frame.color.iter().flatten();
        channels.fold(1.0, |least: f32, &channel| least.min(channel))
    };
    for (lens, dof) in [
        (perspective, "focus=80,aperture=5"),
        (perspective, "focus=130,aperture=8"),
        (perspective, "focus=100,aperture=8"),
        (parallel, "focus=80,aperture=5deg"),
    ] {
        for (tilt_deg, most) in [(0.0, 1e-5), (45.0, 0.04)] {
            let (plate, mut scene) = plate(tilt_deg, lens, dof);
            for per_side in [1, 2] {
                scene.anti_aliasing = AntiAliasing::new(per_side, false).unwrap();
                let frames = on_device(&device, &plate, std::slice::from_ref(&scene));
                let least = darkest(&frames[0]);
                assert!((1.0 - least) < most, "{dof} {tilt_deg} {per_side}: {least}");
                let brightest = frames[0]
                    .color
                    .iter()
                    .flatten()
                    .fold(0.0, |a: f32, &b| a.max(b));
                assert!(brightest < 1.0 + 1e-5, "{dof} {tilt_deg}: {brightest}");
            }
        }
    }
    // The control: a plate that ends in the picture.
    let (plate, mut scene) = plate(0.0, parallel, "focus=80,aperture=5deg");
    scene.camera = Camera::look_at(
        DVec3::new(0.0, -100.0, 32.0),
        DVec3::new(0.0, 0.0, 32.0),
        DVec3::Z,
        parallel,
    )
    .unwrap();
    let frames = on_device(&device, &plate, &[scene]);
    assert!(darkest(&frames[0]) < 0.5);
}

/// A bright plate, 100 mm away, in focus, whose edge runs across the picture, and a rod before it, 60 mm away, as wide as a few
/// pixels, whose faces are turned away by 45°.
fn rod_before_plate(dof: &str) -> (Volume, Scene) {
    let field = |x: f64, y: f64, z: f64| {
        let plate = if z >= 12.0 { y - 47.5 } else { -1.0 };
        let rod = 3.0 - (x - 24.0).abs() - (y - 8.0).abs();
        plate.max(rod).clamp(-2.0, 2.0) as f32
    };
    let volume = common::volume_of([49, 52, 33], field);
    let picture = Picture::Surface {
        iso: 0.0,
        caps: false,
        refine: Default::default(),
        color: angioray::scene::Rgb([0.9; 3]),
        phong: Some(Phong::default()),
    };
    let mut scene = common::scene(&volume, 80, picture);
    scene.camera = Camera::look_at(
        DVec3::new(24.0, -52.5, 16.0),
        DVec3::new(24.0, 0.0, 16.0),
        DVec3::Z,
        Lens::Perspective { fov_deg: 16.0 },
    )
    .unwrap();
    scene.depth_of_field = Some(dof.parse().unwrap());
    scene.sampling = Sampling {
        dof: DofMethod::Gather,
        ..Sampling::default()
    };
    (volume, scene)
}

#[test]
fn a_line_before_a_sharp_background_is_blurred_and_the_background_is_not() {
    let Some(device) = common::device() else {
        return;
    };
    let (volume, scene) = rod_before_plate("focus=100,aperture=4");
    let reference = on_reference(&volume, &scene);
    let frames = on_device(&device, &volume, &[scene.clone(), pinhole(&scene)]);
    let [gathered, sharp] = &frames[..] else {
        return;
    };
    let error = focus_error(&reference, gathered).unwrap();
    assert!(error.in_focus.rmse.unwrap() < 0.02, "{error:?}");
    assert!(error.near.rmse.unwrap() < 0.03, "{error:?}");
    assert!(error.silhouette.unwrap().abs() < 0.02, "{error:?}");
    // The control: the pinhole's picture keeps none of these.
    let without = focus_error(&reference, sharp).unwrap();
    assert!(without.in_focus.rmse.unwrap() > 0.02, "{without:?}");
    assert!(without.near.rmse.unwrap() > 0.03, "{without:?}");
    // Under the rod the plate is seen, which the pinhole never does: all of it is as opaque as a plate alone.
    let plates_row = 20 * 80..21 * 80;
    assert!(
        gathered.color[plates_row]
            .iter()
            .all(|color| color[3] > 0.995)
    );
    // And the plate's edge is as sharp as it was: beside the rod no pixel but is opaque or clear.
    let column = |frame: &Frame, x: usize| -> Vec<f32> {
        (0..80).map(|y| frame.color[80 * y + x][3]).collect()
    };
    assert_eq!(column(gathered, 5), column(sharp, 5));
}

/// Whether a nearer pixel's disc reaches each pixel that is in focus; `None` where it is not in focus.
fn reached(frame: &Frame, circles: &[f32]) -> Vec<Option<bool>> {
    let (width, height) = (frame.size.width() as i64, frame.size.height() as i64);
    let at = |x: i64, y: i64| (y * width + x) as usize;
    let mut reached = Vec::new();
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let own = circles[at(x, y)];
        let is_reached = || {
            (-33..=33).any(|dy| {
                (-33..=33).any(|dx| {
                    // Beyond the edge lie the pixels at the edge.
                    let there = at((x + dx).clamp(0, width - 1), (y + dy).clamp(0, height - 1));
                    let reach = 0.5 * circles[there].abs() + 0.5;
                    circles[there] < own && ((dx * dx + dy * dy) as f32).sqrt() < reach
                })
            })
        };
        reached.push((own.abs() <= 0.5).then(is_reached));
    }
    reached
}

#[test]
fn what_is_in_focus_keeps_its_bits_where_nothing_nearer_reaches_it() {
    let Some(device) = common::device() else {
        return;
    };
    for (mode, dof) in [
        (Mode::Iso, "focus=auto,aperture=40"),
        (Mode::Iso, "focus=percentile:80,aperture=30"),
        (Mode::Dvr, "focus=auto,aperture=30"),
    ] {
        let (volume, scene) = vessels(mode, 96, dof);
        let frames = on_device(&device, &volume, &[scene.clone(), pinhole(&scene)]);
        let circles = frames[0].plane(COC).unwrap();
        let (mut kept, mut covered, mut changed) = (0, 0, 0);
        for (pixel, reached) in reached(&frames[0], circles).into_iter().enumerate() {
            let bits = |frame: &Frame| frame.color[pixel].map(f32::to_bits);
            let same = bits(&frames[0]) == bits(&frames[1]);
            match reached {
                Some(false) => {
                    assert!(same, "{mode} {dof}: pixel {pixel}");
                    kept += 1;
                }
                Some(true) => covered += usize::from(!same),
                None => changed += usize::from(!same),
            }
        }
        // The controls: there are such pixels, and others in focus do not keep theirs.
        assert!(kept > 20, "{mode} {dof}: {kept}");
        assert!(covered > 3 || mode == Mode::Dvr, "{mode} {dof}: {covered}");
        assert!(changed > 100, "{mode} {dof}: {changed}");
    }
}

fn error_of(device: &Device, volume: &Volume, scene: &Scene, reference: &Frame) -> [FocusError; 2] {
    let frames = on_device(device, volume, &[scene.clone(), pinhole(scene)]);
    let error = |frame| focus_error(reference, frame).unwrap();
    [error(&frames[0]), error(&frames[1])]
}

/// What so many rays through the lens see: their own picture is held against the reference in `lens`.
fn seen_by_256_rays(device: &Device, volume: &Volume, scene: &Scene) -> Frame {
    let mut through = scene.clone();
    through.sampling.dof = DofMethod::Lens(RayCount::new(256).unwrap());
    on_device(device, volume, &[through]).remove(0)
}

#[test]
fn what_is_gathered_is_what_256_rays_see() {
    let Some(device) = common::device() else {
        return;
    };
    for (mode, dof) in [
        (Mode::Iso, "focus=auto,aperture=30"),
        (Mode::Iso, "focus=percentile:10,aperture=25,darken=0.7"),
        (Mode::Iso, "focus=percentile:90,aperture=25"),
        (Mode::Dvr, "focus=auto,aperture=30"),
    ] {
        let (volume, mut scene) = vessels(mode, 160, dof);
        scene.anti_aliasing = AntiAliasing::new(2, false).unwrap();
        let truth = seen_by_256_rays(&device, &volume, &scene);
        let [error, without] = error_of(&device, &volume, &scene, &truth);
        // A medium's picture is one layer, which hides nothing that could be shown.
        let share = if mode == Mode::Dvr { 0.7 } else { 0.5 };
        assert_closer(error, without, share, &format!("{mode} {dof}"));
    }
}

/// Out of focus what is gathered is at most a share as far from the truth as the pinhole's picture, and in focus not farther; where few
/// pixels are out of focus they hardly are.
fn assert_closer(error: FocusError, without: FocusError, share: f64, of: &str) {
    let rmse = |part: PartError| part.rmse.unwrap_or(0.0);
    let pairs = [
        (error.near, without.near),
        (error.far, without.far),
        (error.beside, without.beside),
    ];
    for (part, without) in pairs {
        assert!(
            part.pixels < 200 || rmse(part) < share * rmse(without),
            "{of}: {error:?} {without:?}"
        );
    }
    let [part, without_in_focus] = [error.in_focus, without.in_focus].map(rmse);
    assert!(part < 1.1 * without_in_focus, "{of}: {error:?} {without:?}");
}

/// How the rays are followed, which rays there are and what ends them.
#[test]
fn fewer_and_more_rays_caps_and_clip_planes_are_gathered_too() {
    let Some(device) = common::device() else {
        return;
    };
    let (volume, scene) = vessels(Mode::Iso, 160, "focus=auto,aperture=40");
    let mut scenes = Vec::new();
    let mut fewer = scene.clone();
    let grid: SparseGrid = "4".parse().unwrap();
    fewer.sparse = Some(Sparse::new(Some(grid), None, None, Mode::Iso).unwrap());
    scenes.push(fewer);
    let mut many = scene.clone();
    many.anti_aliasing = AntiAliasing::new(3, false).unwrap();
    scenes.push(many);
    let mut clipped = scene.clone();
    let (center, _) = volume.bounding_sphere();
    let half = ClipPlane::new(common::OBLIQUE, -common::OBLIQUE.dot(center)).unwrap();
    clipped.clip_planes = vec![half];
    scenes.push(clipped);
    for scene in scenes {
        let truth = seen_by_256_rays(&device, &volume, &scene);
        let [error, without] = error_of(&device, &volume, &scene, &truth);
        assert_closer(
            error,
            without,
            0.5,
            &format!("{:?} {:?}", scene.sparse, scene.anti_aliasing),
        );
    }
}

#[test]
fn how_rays_are_followed_changes_no_bit() {
    let Some(device) = common::device() else {
        return;
    };
    let (volume, scene) = vessels(Mode::Iso, 48, "focus=auto,aperture=40");
    let octree = common::octree(&volume);
    let render = |scene: &Scene, lanes| {
        let options = Options {
            lanes,
            ..Options::default()
        };
        let mut renderer = Renderer::new(&device, &volume, &octree, options).unwrap();
        renderer.render(scene, Wanted::ALL).unwrap().frame
    };
    for method in [DofMethod::Gather, DofMethod::Mix] {
        let mut scene = scene.clone();
        scene.sampling.dof = method;
        let plain = render(&scene, None);
        for lanes in Lanes::ALL {
            assert!(
                render(&scene, Some(lanes)).color == plain.color,
                "{lanes:?} {method}"
            );
        }
        for traverse in Traverse::ALL {
            let mut other = scene.clone();
            other.sampling.traverse = traverse;
            assert!(
                render(&other, None).color == plain.color,
                "{traverse:?} {method}"
            );
        }
    }
}

/// The pinhole's picture mixed with itself under a Gaussian, by the definition: double precision, place by place.
fn mixed(frame: &Frame, circles: &[f32]) -> Vec<[f64; 4]> {
    let (width, height) = (frame.size.width() as i64, frame.size.height() as i64);
    let depths = frame.plane(DEPTH).unwrap().iter();
    let widest = depths
        .zip(circles)
        .filter(|(depth, _)| depth.is_finite())
        .fold(0.0, |most: f64, (_, &circle)| {
            most.max(f64::from(circle).abs())
        });
    let deviation = widest / 4.0;
    let reach = (3.0 * deviation).ceil() as i64;
    let weight = |n: i64| (-0.5 * (n as f64 / deviation).powi(2)).exp();
    let whole: f64 = (-reach..=reach).map(weight).sum();
    let blurred = |colors: &[[f64; 4]], columns: bool| -> Vec<[f64; 4]> {
        let at = |x: i64, y: i64, n: i64| {
            let (x, y) = if columns { (x, y + n) } else { (x + n, y) };
            colors[(y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize]
        };
        let sum = |x, y| {
            [0, 1, 2, 3].map(|c| {
                (-reach..=reach)
                    .map(|n| weight(n) * at(x, y, n)[c])
                    .sum::<f64>()
                    / whole
            })
        };
        (0..width * height)
            .map(|pixel| sum(pixel % width, pixel / width))
            .collect()
    };
    let sharp: Vec<[f64; 4]> = frame
        .color
        .iter()
        .map(|color| color.map(f64::from))
        .collect();
    let soft = blurred(&blurred(&sharp, false), true);
    let mix = |((sharp, soft), &circle): ((&[f64; 4], &[f64; 4]), &f32)| {
        let share = (f64::from(circle).abs() / widest).min(1.0);
        [0, 1, 2, 3].map(|c| sharp[c] + share * (soft[c] - sharp[c]))
    };
    sharp.iter().zip(&soft).zip(circles).map(mix).collect()
}

#[test]
fn mixing_is_as_defined() {
    let Some(device) = common::device() else {
        return;
    };
    for (mode, dof) in [
        (Mode::Iso, "focus=auto,aperture=30"),
        (Mode::Dvr, "focus=percentile:20,aperture=30"),
    ] {
        let (volume, mut scene) = vessels(mode, 64, dof);
        scene.sampling.dof = DofMethod::Mix;
        let frames = on_device(&device, &volume, &[scene.clone(), pinhole(&scene)]);
        let circles = frames[0].plane(COC).unwrap();
        let expected = mixed(&frames[1], circles);
        let apart = |frame: &Frame| {
            let pairs = frame.color.iter().flatten().zip(expected.iter().flatten());
            pairs.fold(0.0, |most: f64, (&a, &b)| {
                most.max((f64::from(a) - b).abs())
            })
        };
        assert!(apart(&frames[0]) < 1e-5, "{mode}: {}", apart(&frames[0]));
        // The control: the sharp picture.
        assert!(apart(&frames[1]) > 0.05, "{mode}");
    }
}

#[test]
fn a_lens_of_one_point_in_focus_is_the_pinhole() {
    let Some(device) = common::device() else {
        return;
    };
    // So small an aperture blurs nothing: every method leaves the picture.
    let (volume, mut scene) = vessels(Mode::Iso, 48, "focus=auto,aperture=0.001");
    let frames = on_device(&device, &volume, &[pinhole(&scene), scene.clone()]);
    assert!(frames[0].color == frames[1].color);
    scene.sampling.dof = DofMethod::Lens(RayCount::new(2).unwrap());
    let frames = on_device(&device, &volume, &[pinhole(&scene), scene.clone()]);
    assert!(color_error(&frames[0], &frames[1]).unwrap().rmse < 1e-3);
}
