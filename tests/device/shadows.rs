//! Shadows against closed forms, on the device and in the reference, and one against the other.

use std::f64::consts::PI;
use std::sync::Arc;

use angioray::Subject;
use angioray::extent::{Dims, ImageSize};
use angioray::frame::error::share_error;
use angioray::frame::{CERTIFICATE, Frame, KIND, Kind, VISIBILITY};
use angioray::gpu::Device;
use angioray::render::{Lanes, Options, Renderer};
use angioray::scene::{
    AntiAliasing, Camera, ClipPlane, Emission, Knot, Lens, Light, LightSizeDeg, Mode, Phong,
    Picture, Quadrature, Rgb, Sampling, Scene, Shadows, Sparse, SparseGrid, TransferFunction,
};
use angioray::volume::{PhantomKind, PhantomSpec, Volume, phantom};
use glam::DVec3;

use crate::common::{self, on_device, on_reference};
use crate::occlusion_cases::{scene as of_point, volume};

fn shadows(method: &str, size_deg: f64) -> Option<Shadows> {
    Some(Shadows {
        method: method.parse().unwrap(),
        light_size: LightSizeDeg::new(size_deg).unwrap(),
    })
}

fn toward(light: DVec3) -> Light {
    Light::distant(light).unwrap()
}

/// The visibility of the first light in the first pixel: on the device, and in the reference.
fn visibility(device: &Device, volume: &Volume, scene: &Scene) -> [f64; 2] {
    let device = on_device(device, volume, std::slice::from_ref(scene)).remove(0);
    let reference = on_reference(volume, scene);
    [device, reference].map(|frame| {
        assert_ne!(frame.plane(KIND).unwrap()[0], Kind::Nothing as u32);
        f64::from(frame.plane(VISIBILITY).unwrap()[0])
    })
}

/// A ball above a floor: its centre and radius, and the floor's height.
const BALL: (DVec3, f64) = (DVec3::new(20.0, 20.0, 14.0), 6.0);
const FLOOR: f64 = 3.25;

fn ball_above_floor() -> Arc<Volume> {
    let (center, radius) = BALL;
    volume([41, 41, 26], |p| {
        (FLOOR - p.z).max(radius - p.distance(center))
    })
}

/// A point of the floor, seen from beside the ball.
fn on_floor(x: f64, y: f64, light: Light) -> Scene {
    let point = DVec3::new(x, y, FLOOR);
    let eye = point + DVec3::new(2.0, -30.0, 6.0);
    Scene {
        ambient_occlusion: None,
        shadows: shadows("on", 0.0),
        lights: vec![light],
        ..of_point(eye, point, 1.0)
    }
}

#[test]
fn a_balls_shadow_lies_where_lines_to_the_light_meet_it() {
    let Some(device) = common::device() else {
        return;
    };
    let (volume, (center, radius)) = (ball_above_floor(), BALL);
    let mut seen = [0; 2];
    for (x, y) in [
        (20.0, 6.0),
        (14.0, 9.5),
        (23.0, 3.0),
        (31.0, 10.0),
        (11.3, 4.4),
    ] {
        let point = DVec3::new(x, y, FLOOR);
        for light in [
            toward(DVec3::new(0.0, 1.0, 0.9)),
            toward(DVec3::new(0.3, 0.7, 0.9)),
            toward(DVec3::Z),
            Light::point(DVec3::new(20.0, 36.0, 24.0)).unwrap(),
            // Before the ball: nothing lies between.
            Light::point(DVec3::new(20.0, 9.0, 7.0)).unwrap(),
            // Beyond the volume.
            Light::point(DVec3::new(20.0, 136.0, 124.0)).unwrap(),
        ] {
            let scene = on_floor(x, y, light);
            let from = light.shines_from(&scene.camera);
            let dir = from.toward(point, DVec3::Z);
            let nearest = (center - point)
                .dot(dir)
                .clamp(0.0, from.distance_mm(point));
            let passes = (point + nearest * dir).distance(center) - radius;
            if passes.abs() < 0.3 {
                continue; // the ball's own field is no ball's there
            }
            let expected = f64::from(u8::from(passes > 0.0));
            seen[expected as usize] += 1;
            assert_eq!(
                visibility(&device, &volume, &scene),
                [expected; 2],
                "{x} {y} {light}"
            );
        }
    }
    assert!(seen[0] > 4 && seen[1] > 8, "{seen:?}");
}

#[test]
fn a_light_with_a_size_is_seen_in_part_over_an_edge() {
    let Some(device) = common::device() else {
        return;
    };
    // A floor and a wall that ends with the volume: over its upper edge the sky is seen.
    let (floor, wall) = (10.25, 12.5);
    let corner = volume([40, 40, 60], |p| (floor - p.z).max(wall - p.x));
    let point = DVec3::new(wall + 12.0, 20.0, floor);
    let edge = ((59.0 - floor) / 12.0_f64).atan();
    let radius = 5.0_f64.to_radians();
    let mut partly = 0;
    for share in [-1.2_f64, -0.7, -0.3, 0.0, 0.4, 0.8, 1.1] {
        let elevation = edge + share * radius;
        let light = toward(DVec3::new(-elevation.cos(), 0.0, elevation.sin()));
        let scene = Scene {
            ambient_occlusion: None,
            shadows: shadows("on", 10.0),
            lights: vec![light],
            ..of_point(point + DVec3::new(9.0, 2.0, 9.0), point, 1.0)
        };
        let c = share.clamp(-1.0, 1.0);
        let expected = 0.5 + (c.asin() + c * (1.0 - c * c).sqrt()) / PI;
        let [device, reference] = visibility(&device, &corner, &scene);
        // 32 directions and 256: a line parts them within these.
        assert!(
            (device - expected).abs() < 0.05,
            "{share}: {device} {expected}"
        );
        assert!(
            (reference - expected).abs() < 0.015,
            "{share}: {reference} {expected}"
        );
        partly += u32::from(reference > 0.05 && reference < 0.95);
    }
    assert!(partly >= 4);
}

#[test]
fn no_surface_shades_itself_and_a_light_behind_it_is_none() {
    let Some(device) = common::device() else {
        return;
    };
    let (center, radius) = (DVec3::splat(16.2), 9.0);
    let ball = volume([33; 3], |p| radius - p.distance(center));
    let light = toward(DVec3::new(0.4, -0.5, 0.8));
    let mut scene = common::scene(&ball, 64, of_point(DVec3::ZERO, center, 1.0).picture);
    scene.sampling = Sampling::default();
    scene.shadows = shadows("on", 0.0);
    scene.lights = vec![light];
    let reference = on_reference(&ball, &scene);
    let device = on_device(&device, &ball, std::slice::from_ref(&scene)).remove(0);
    let dir = DVec3::new(0.4, -0.5, 0.8).normalize();
    let normals = reference.plane(angioray::frame::NORMAL).unwrap();
    let mut counts = [0; 2];
    for frame in [&reference, &device] {
        let visible = frame.plane(VISIBILITY).unwrap();
        for (pixel, kind) in frame.plane(KIND).unwrap().iter().enumerate() {
            let facing = DVec3::from_array(normals[pixel].map(f64::from)).dot(dir);
            if *kind == Kind::Nothing as u32 || facing.abs() < 0.15 {
                continue;
            }
            let lit = usize::from(facing > 0.0);
            counts[lit] += 1;
            assert_eq!(visible[pixel], lit as f32, "{pixel}: {facing}");
        }
    }
    assert!(counts[0] > 10 && counts[1] > 300, "{counts:?}");
}

#[test]
fn caps_and_clip_planes_are_as_for_the_eyes_rays() {
    let Some(device) = common::device() else {
        return;
    };
    let (center, _) = BALL;
    let volume = ball_above_floor();
    let above = toward(DVec3::new(0.0, 0.0, 1.0));
    let below = on_floor(center.x, center.y - 1.0, above);
    assert_eq!(visibility(&device, &volume, &below), [0.0; 2]);
    // What is cut away is in nobody's way.
    let mut cut = below.clone();
    cut.clip_planes = vec![ClipPlane::new(DVec3::NEG_Z, 6.0).unwrap()];
    assert_eq!(visibility(&device, &volume, &cut), [1.0; 2]);
    // A cap faces a light before it and not one behind it.
    let point = DVec3::new(center.x, center.y, center.z + 1.0);
    let mut cap = Scene {
        ambient_occlusion: None,
        shadows: shadows("on", 0.0),
        lights: vec![above],
        ..of_point(point + DVec3::new(1.0, 2.0, 30.0), point, 1.0)
    };
    cap.clip_planes = vec![ClipPlane::new(DVec3::NEG_Z, point.z).unwrap()];
    assert_eq!(visibility(&device, &volume, &cap), [1.0; 2]);
    cap.lights = vec![toward(DVec3::new(0.0, 0.3, -1.0))];
    assert_eq!(visibility(&device, &volume, &cap), [0.0; 2]);
    // A headlight casts none.
    let head = on_floor(center.x, center.y - 1.0, Light::HEADLIGHT);
    assert_eq!(visibility(&device, &volume, &head), [1.0; 2]);
}

fn knot(value: f64, opacity: f64) -> Knot {
    Knot {
        value,
        color: Rgb([0.9, 0.5, 0.1]),
        opacity,
    }
}

fn medium(opacity: f64, quadrature: Quadrature) -> Picture {
    let knots = vec![knot(0.0, 0.0), knot(1.0, opacity)];
    Picture::Emission(Emission {
        phong: Some(Phong::default()),
        quadrature,
        ..Emission::of(TransferFunction::new(knots, 1.0).unwrap())
    })
}

/// What a ramp of opacity a absorbs in all: the integral of -ln(1 - a u) for u from 0 to 1.
fn depth_of_ramp(a: f64) -> f64 {
    ((1.0 - a) * (1.0 - a).ln() + a) / a
}

#[test]
fn a_slabs_shadow_is_what_it_lets_through_at_every_angle() {
    let Some(device) = common::device() else {
        return;
    };
    // A slab across z, and far below it a thin sheet that shows what reaches it.
    let slab = |z: f64| f64::from(u8::from((16.0..=19.0).contains(&z)));
    let sheet = |z: f64| f64::from(u8::from(z == 3.0)) * 0.05;
    let volume = volume([160, 5, 24], |p| slab(p.z) + sheet(p.z));
    let a: f64 = 0.2;
    // Three whole cells and a ramp at either side.
    let depth = -3.0 * (1.0 - a).ln() + 2.0 * depth_of_ramp(a);
    for degrees in [0.0_f64, 20.0, 40.0, 60.0, 70.0, 80.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let light = toward(DVec3::new(sin, 0.0, cos));
        let (eye, point) = (DVec3::new(30.0, -20.0, 3.0), DVec3::new(30.0, 2.0, 3.0));
        let in_medium = |quadrature, method: &str| Scene {
            ambient_occlusion: None,
            picture: medium(a, quadrature),
            shadows: shadows(method, 0.0),
            lights: vec![light],
            ..of_point(eye, point, 1.0)
        };
        let sheet_depth = depth_of_ramp(a * 0.05) / cos;
        let expected = (-depth / cos - sheet_depth).exp();
        for (quadrature, method) in [
            (Quadrature::default(), "on"),
            ("adaptive".parse().unwrap(), "on"),
            ("adaptive".parse().unwrap(), "step=0.25"),
            (Quadrature::default(), "step=0.25"),
            (Quadrature::default(), "cached:40"),
        ] {
            let scene = in_medium(quadrature, method);
            let [on_device, reference] = visibility(&device, &volume, &scene);
            assert!(
                (reference - expected).abs() < 2e-4,
                "{degrees}: {reference} {expected}"
            );
            let limit = if method == "on" { 2e-3 } else { 6e-3 };
            assert!(
                (on_device - expected).abs() < limit,
                "{degrees} {quadrature} {method}: {on_device} {expected}"
            );
        }
        // The control: along the normal it would let more through.
        assert!(degrees < 30.0 || (-depth - sheet_depth).exp() - expected > 0.05);
    }
}

fn vessels() -> Volume {
    let dims = Dims::new([32; 3]).unwrap();
    phantom(&PhantomSpec::new(PhantomKind::Vessels, dims))
        .unwrap()
        .volume
}

fn of_vessels(volume: &Volume, mode: Mode, size_px: u32) -> Scene {
    let mut picture = Picture::of_mode(mode, &Subject::of(volume)).unwrap();
    if let Picture::Emission(emission) = &mut picture {
        emission.phong = Some(Phong::default());
    }
    let mut scene = common::scene(volume, size_px, picture);
    scene.sampling = Sampling::default();
    scene.shadows = shadows("on", 0.0);
    scene.lights = vec![
        "camera:-1,1.5,0.7".parse().unwrap(),
        Light::HEADLIGHT,
        "point:30,-10,60@0.5".parse().unwrap(),
    ];
    scene
}

/// How far a picture's visibility and colour are from the reference's, in the mean.
fn apart(reference: &Frame, frame: &Frame) -> [f64; 2] {
    let of_light = share_error(reference, frame, VISIBILITY).unwrap();
    assert!(of_light.compared > 20, "{}", of_light.compared);
    let color = reference.color.iter().zip(&frame.color);
    let sum: f64 = color.map(|(a, b)| f64::from((a[0] - b[0]).abs())).sum();
    [of_light.mean.unwrap(), sum / reference.color.len() as f64]
}

#[test]
fn vessels_have_the_references_shadows() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = vessels();
    for (mode, size_px, limits) in [(Mode::Iso, 64, [2e-3, 1e-3]), (Mode::Dvr, 24, [5e-3, 2e-3])] {
        let scene = of_vessels(&volume, mode, size_px);
        let reference = on_reference(&volume, &scene);
        let frame = on_device(&device, &volume, std::slice::from_ref(&scene)).remove(0);
        let errors = apart(&reference, &frame);
        assert!(
            errors[0] < limits[0] && errors[1] < limits[1],
            "{mode}: {errors:?}"
        );
        // The control: without shadows the picture is another.
        let lit = Scene {
            shadows: None,
            ..scene.clone()
        };
        let lit = on_reference(&volume, &lit);
        let change = reference.color.iter().zip(&lit.color);
        let change: f64 = change.map(|(a, b)| f64::from((a[0] - b[0]).abs())).sum();
        assert!(
            change / reference.color.len() as f64 > 3.0 * errors[1],
            "{mode}"
        );
        let visible = reference.plane(VISIBILITY).unwrap();
        assert!(
            visible.iter().any(|v| *v > 0.9)
                && visible
                    .iter()
                    .any(|v| *v > 0.0 && *v < 0.5 || mode == Mode::Iso)
        );
    }
}

/// A grid's shares are those of feelers but for what it takes for smooth.
#[test]
fn a_grid_in_the_light_is_hardly_wrong() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = vessels();
    let exact = of_vessels(&volume, Mode::Dvr, 48);
    let scenes = ["cached:4", "cached:16", "cached:64", "on"].map(|method| Scene {
        shadows: shadows(method, 0.0),
        ..exact.clone()
    });
    let mut frames = on_device(&device, &volume, &scenes);
    let exact = frames.pop().unwrap();
    let errors: Vec<[f64; 2]> = frames.iter().map(|frame| apart(&exact, frame)).collect();
    assert!(
        errors
            .iter()
            .all(|[light, color]| *light < 2e-3 && *color < 1e-3),
        "{errors:?}"
    );
    // The control: the finest is asked; where coarse ones see different things there are feelers.
    assert!(errors[2][0] > 0.0, "{errors:?}");
}

#[test]
fn lanes_lists_and_lenses_change_no_shadow() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = vessels();
    let octree = common::octree(&volume);
    let mut base = of_vessels(&volume, Mode::Iso, 64);
    base.shadows = shadows("on", 8.0);
    let render = |scene: &Scene, lanes| {
        let options = Options {
            lanes,
            ..Options::default()
        };
        let mut renderer = Renderer::new(&device, &volume, &octree, options).unwrap();
        let wanted = angioray::frame::Wanted::ALL;
        renderer.render(scene, wanted).unwrap().frame
    };
    let plain = render(&base, None);
    for lanes in Lanes::ALL {
        let frame = render(&base, Some(lanes));
        assert!(frame.color == plain.color, "{lanes:?}");
        assert!(
            frame.plane(VISIBILITY) == plain.plane(VISIBILITY),
            "{lanes:?}"
        );
    }
    let sparse = Scene {
        sparse: Some(
            Sparse::new(
                Some(SparseGrid::new(4, None).unwrap()),
                None,
                None,
                Mode::Iso,
            )
            .unwrap(),
        ),
        ..base.clone()
    };
    let sparse = render(&sparse, None);
    let visible = [&plain, &sparse].map(|frame| frame.plane(VISIBILITY).unwrap());
    let differing = (0..plain.color.len()).filter(|&n| (visible[0][n] - visible[1][n]).abs() > 0.2);
    assert!(differing.count() < plain.color.len() / 50);
    assert!(sparse.plane(CERTIFICATE).is_some());
    let many = Scene {
        anti_aliasing: AntiAliasing::new(2, false).unwrap(),
        ..base.clone()
    };
    let sum = |frame: &Frame| frame.color.iter().map(|c| f64::from(c[0])).sum::<f64>();
    assert!((sum(&render(&many, None)) / sum(&plain) - 1.0).abs() < 0.1);
    let flat = Camera::look_at(
        base.camera.eye_world(),
        volume.bounding_sphere().0,
        DVec3::Z,
        Lens::Orthographic { height_mm: 30.0 },
    );
    let parallel = Scene {
        camera: flat.unwrap(),
        size: ImageSize::new(48, 48).unwrap(),
        shadows: shadows("on", 0.0),
        ..base
    };
    let errors = apart(&on_reference(&volume, &parallel), &render(&parallel, None));
    assert!(errors[0] < 2e-3, "{errors:?}");
}
