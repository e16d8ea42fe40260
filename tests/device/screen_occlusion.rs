//! Ambient occlusion estimated from the picture: against closed forms, and against the reference.

use std::sync::Arc;

use angioray::Subject;
use angioray::extent::{Dims, ImageSize};
use angioray::frame::error::{ShareError, color_error, share_error};
use angioray::frame::{CAST, Frame, KIND, Kind, Layer, OCCLUSION, THICK, Wanted};
use angioray::gpu::Device;
use angioray::render::{Lanes, Options, Renderer};
use angioray::scene::{
    AntiAliasing, Aperture, Camera, ClipPlane, DepthOfField, DistanceMm, DofMethod, Focus, Lens,
    Mode, Occlusion, Phong, Picture, RayCount, Reflectance, Sampling, SamplingMethod, Scene,
    ScreenError, Share, Sparse, SparseGrid, Traverse,
};
use angioray::volume::{PhantomKind, PhantomSpec, Volume, phantom};
use glam::DVec3;

use crate::common::{self, on_device, on_reference};
use crate::mutated::{CAUGHT, assert_caught, is_mutant};
use crate::occlusion_cases::{self, Case, inside_edge, planes, tubes};

fn screen(text: &str) -> Option<Occlusion> {
    Some(Occlusion::Screen(text.parse().unwrap()))
}

/// A case seen by a parallel camera, its point in the middle; a pixel is as wide as a voxel.
fn on_screen(case: &Case, toward_eye: DVec3, point: DVec3, size: u32, ssao: &str) -> Scene {
    let mut scene = case.scene.clone();
    let eye = point + 60.0 * toward_eye.normalize();
    let up = toward_eye.any_orthonormal_vector();
    let height_mm = f64::from(size);
    scene.camera = Camera::look_at(eye, point, up, Lens::Orthographic { height_mm }).unwrap();
    scene.size = ImageSize::new(size, size).unwrap();
    scene.ambient_occlusion = screen(ssao);
    scene
}

/// The accessibility of the middle pixel.
fn accessibility(device: &Device, case: &Case, scene: &Scene) -> f64 {
    let frames = on_device(device, &case.volume, std::slice::from_ref(scene));
    let middle = scene.size.pixels() / 2;
    let kind = frames[0].plane(KIND).unwrap()[middle];
    assert_eq!(kind, Kind::Surface as u32, "{}", case.name);
    1.0 - f64::from(frames[0].plane(OCCLUSION).unwrap()[middle])
}

/// Where estimates are not what closed forms say, a line each.
fn wrong(device: &Device) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut check = |case: &Case, toward_eye: DVec3, point, ssao: &str| {
        let scene = on_screen(case, toward_eye, point, 161, ssao);
        let found = accessibility(device, case, &scene);
        println!(
            "{}, {ssao}: {found:.4}, not {:.4}",
            case.name, case.accessibility
        );
        if (found - case.accessibility).abs() > 0.05 {
            wrong.push(format!(
                "{}: {found}, not {}",
                case.name, case.accessibility
            ));
        }
    };
    // The tubes of the table: from above, or where they hide the point from there, from aside; as far as the picture goes.
    for case in tubes() {
        let point = middle_of(&case);
        let above = if case.name.contains(" 0 beside") {
            DVec3::new(1.0, 0.0, 0.5)
        } else {
            DVec3::Z
        };
        check(&case, above, point, "radius=200,samples=1024");
        check(&case, above + DVec3::X, point, "radius=200,samples=1024");
    }
    for case in inside_edge() {
        let within = case.scene.ambient_occlusion.unwrap().distance();
        let ssao = format!("radius={within},samples=64");
        let point = middle_of(&case);
        check(&case, DVec3::new(1.0, 0.3, 1.5), point, &ssao);
        check(&case, DVec3::new(2.0, 0.3, 0.7), point, &ssao);
    }
    wrong
}

/// The point that a case's own camera looks at.
fn middle_of(case: &Case) -> DVec3 {
    let ray = case.scene.camera.ray(case.scene.size, 0.5, 0.5);
    let frame = on_reference(&case.volume, &case.scene);
    let depth_mm = frame.plane(angioray::frame::DEPTH).unwrap()[0];
    ray.origin_world + ray.dir_world * f64::from(depth_mm)
}

#[test]
fn accessibility_is_that_of_closed_forms() {
    let Some(device) = common::device() else {
        return;
    };
    let lines = wrong(&device);
    assert!(lines.is_empty(), "{CAUGHT}: {}", lines.join("\n"));
    if is_mutant() {
        return;
    }
    let of_test = |changes| {
        let test = "screen_occlusion::accessibility_is_that_of_closed_forms";
        assert_caught(test, "lib/light/section.clh", changes);
    };
    // The integral that is in circulation: without |sin| of the solid angle.
    of_test(&[(
        "fabs(section.cosine * sectors[n].x + section.sine * sectors[n].y)",
        "0.5f * fabs(sectors[n].y)",
    )]);
    // What is seen taken for a wall down to the background.
    let wall = [("min_of(half_of - b, span.y - span.x)", "half_of - b")];
    let test = "screen_occlusion::accessibility_is_that_of_closed_forms";
    assert_caught(test, "pass/screen_occlusion.cl", &wall);
}

#[test]
fn nothing_is_in_the_way_of_a_plane() {
    let Some(device) = common::device() else {
        return;
    };
    for (case, degrees) in planes().iter().zip([0.0, 10.0, 30.0, 45.0, 60.0, 80.0]) {
        for fov_deg in [None, Some(50.0)] {
            let center = DVec3::splat(15.3);
            let ray = case.scene.camera.ray(case.scene.size, 0.5, 0.5);
            // Seen at this angle from its normal.
            let [normal, aside] = plane_axes(case, -ray.dir_world);
            let angle: f64 = f64::to_radians(degrees);
            let toward_eye = angle.cos() * normal + angle.sin() * aside;
            let mut scene = on_screen(case, toward_eye, center, 96, "radius=8");
            if let Some(fov_deg) = fov_deg {
                let eye = center + 30.0 * toward_eye;
                let lens = Lens::Perspective { fov_deg };
                scene.camera = Camera::look_at(eye, center, aside, lens).unwrap();
            }
            let frame = &on_device(&device, &case.volume, &[scene])[0];
            let occluded = frame.plane(OCCLUSION).unwrap();
            let worst = occluded
                .iter()
                .fold(0.0, |worst: f32, share| worst.max(*share));
            assert!(worst < 0.01, "{}, seen at {degrees}: {worst}", case.name);
        }
    }
}

/// A plane's unit normal on this side of it, and a direction along it.
fn plane_axes(case: &Case, toward_eye: DVec3) -> [DVec3; 2] {
    let frame = on_reference(&case.volume, &case.scene);
    let normal = frame.plane(angioray::frame::NORMAL).unwrap()[0];
    let normal = DVec3::from_array(normal.map(f64::from)).normalize();
    let normal = normal * normal.dot(toward_eye).signum();
    [normal, normal.any_orthonormal_vector()]
}

fn vessels() -> Volume {
    let dims = Dims::new([64; 3]).unwrap();
    phantom(&PhantomSpec::new(PhantomKind::Vessels, dims))
        .unwrap()
        .volume
}

fn scene(volume: &Volume, ssao: &str) -> Scene {
    let picture = Picture::of_mode(Mode::Iso, &Subject::of(volume)).unwrap();
    let mut scene = common::scene(volume, 128, picture);
    scene.sampling = Sampling::default();
    scene.ambient_occlusion = screen(ssao);
    scene
}

fn error(reference: &Frame, frame: &Frame) -> [f64; 2] {
    let error: ShareError = share_error(reference, frame, OCCLUSION).unwrap();
    assert!(error.compared > 300);
    [error.mean.unwrap(), error.bias.unwrap()]
}

#[test]
fn it_is_near_the_references() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = vessels();
    let base = scene(&volume, "radius=8");
    let reference = on_reference(&volume, &base);
    let texts = [
        "radius=8",
        "radius=8,samples=128",
        "radius=8,thickness=100",
        "radius=3",
    ];
    let scenes = texts.map(|text| scene(&volume, text));
    let frames = on_device(&device, &volume, &scenes);
    let found: Vec<[f64; 2]> = frames
        .iter()
        .map(|frame| error(&reference, frame))
        .collect();
    println!("{found:?}");
    let [mean, bias] = found[0];
    assert!(mean < 0.04 && bias.abs() < 0.02, "{found:?}");
    assert!(found[1][0] < mean + 0.002, "{found:?}");
    // The controls: vessels are no walls, and another radius is another accessibility.
    assert!(found[2][1] > bias + 0.01 && found[2][0] > mean, "{found:?}");
    assert!(found[3][0] > 1.3 * mean, "{found:?}");
}

#[test]
fn it_is_that_of_any_camera_and_of_what_clip_planes_leave() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = vessels();
    let (center, radius_mm) = volume.bounding_sphere();
    let eye = center + 3.0 * radius_mm * DVec3::new(0.4, -0.7, 0.5);
    let parallel = Lens::Orthographic {
        height_mm: 1.6 * radius_mm,
    };
    let wide = Lens::Perspective { fov_deg: 90.0 };
    let near = center + 1.1 * radius_mm * DVec3::new(0.4, -0.7, 0.5);
    for camera in [
        Camera::look_at(eye, center, DVec3::Z, parallel).unwrap(),
        Camera::look_at(near, center, DVec3::Z, wide).unwrap(),
    ] {
        let mut scene = scene(&volume, "radius=8");
        scene.camera = camera;
        scene.clip_planes = vec![ClipPlane::new(DVec3::Y, -center.y + 0.5 * radius_mm).unwrap()];
        let reference = on_reference(&volume, &scene);
        let frames = on_device(&device, &volume, &[scene]);
        let [mean, bias] = error(&reference, &frames[0]);
        assert!(mean < 0.045 && bias.abs() < 0.025, "{mean} {bias}");
        // On caps nothing is occluded.
        let caps = frames[0].plane(KIND).unwrap().iter();
        let mut caps = caps.zip(frames[0].plane(OCCLUSION).unwrap());
        assert!(caps.all(|(kind, share)| *kind != Kind::Cap as u32 || *share == 0.0));
    }
}

#[test]
fn skipping_and_lanes_change_nothing() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = vessels();
    let octree = common::octree(&volume);
    let base = scene(&volume, "radius=8");
    let render = |scene: &Scene, lanes| {
        let options = Options {
            lanes,
            ..Options::default()
        };
        let mut renderer = Renderer::new(&device, &volume, &octree, options).unwrap();
        renderer.render(scene, Wanted::ALL).unwrap().frame
    };
    let plain = render(&base, None);
    let occluded = plain.plane(OCCLUSION).unwrap();
    assert!(occluded.iter().any(|share| *share > 0.3));
    for lanes in Lanes::ALL {
        let frame = render(&base, Some(lanes));
        assert!(frame.plane(OCCLUSION).unwrap() == occluded, "{lanes:?}");
        assert!(frame.color == plain.color, "{lanes:?}");
    }
    for traverse in Traverse::ALL {
        let mut scene = base.clone();
        scene.sampling.traverse = traverse;
        let frame = render(&scene, None);
        assert!(frame.plane(OCCLUSION).unwrap() == occluded, "{traverse:?}");
    }
    // The control: from elsewhere it is another picture.
    let mut turned = base.clone();
    turned.camera = common::camera(&volume, DVec3::NEG_X);
    assert!(render(&turned, None).plane(OCCLUSION).unwrap() != occluded);
}

#[test]
fn few_rays_or_many_see_the_same() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = vessels();
    let whole = scene(&volume, "radius=8");
    let sparse = |spacing: Option<&str>, error: Option<f64>| {
        let grid = spacing.map(|text| text.parse::<SparseGrid>().unwrap());
        let error = error.map(|error| ScreenError::new(error).unwrap());
        Scene {
            sparse: Some(Sparse::new(grid, None, error, Mode::Iso).unwrap()),
            ..whole.clone()
        }
    };
    let mut fixed = whole.clone();
    fixed.sampling.method = SamplingMethod::Fixed;
    let scenes = [
        whole.clone(),
        sparse(None, Some(0.0)),
        sparse(None, Some(1.0)),
        sparse(Some("2:0.05"), None),
        fixed,
    ];
    let frames = on_device(&device, &volume, &scenes);
    // Certified to be the whole picture.
    assert!(frames[1].plane(OCCLUSION) == frames[0].plane(OCCLUSION));
    assert!(frames[1].color == frames[0].color);
    for (frame, limit) in frames[2..].iter().zip([0.01, 0.02, 0.01]) {
        let [mean, bias] = error(&frames[0], frame);
        assert!(mean < limit && bias.abs() < limit / 2.0, "{mean} {bias}");
    }
    let cast = frames[3].plane(CAST).unwrap();
    assert!(cast.contains(&0) && cast.contains(&1));
}

/// The error of a picture's colour, as a share of that of the picture without occlusion.
fn error_left(renderer: &mut Renderer, reference: &Frame, scene: &Scene) -> f64 {
    let without = Scene {
        ambient_occlusion: None,
        ..scene.clone()
    };
    let [with, without] = [scene, &without].map(|scene| {
        let frame = renderer.render(scene, Wanted::ALL).unwrap().frame;
        color_error(reference, &frame).unwrap().rmse
    });
    with / without
}

#[test]
fn many_rays_in_a_pixel_are_occluded_as_their_neighbours_are() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = vessels();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    // What rays beside centres take from these adds little to what is wrong of the centres' own.
    let mut one = scene(&volume, "radius=8");
    one.size = ImageSize::new(96, 96).unwrap();
    if let Picture::Surface { phong, .. } = &mut one.picture {
        *phong = Some(Phong {
            ambient: Reflectance::OCCLUDED,
            diffuse: Reflectance::OCCLUDED,
            ..Phong::default()
        });
    }
    let of_one = error_left(&mut renderer, &on_reference(&volume, &one), &one);
    assert!(of_one < 0.65, "{of_one}");
    for adaptive in [false, true] {
        let mut many = one.clone();
        many.anti_aliasing = AntiAliasing::new(3, adaptive).unwrap();
        let of_many = error_left(&mut renderer, &on_reference(&volume, &many), &many);
        assert!(of_many < 1.25 * of_one, "{of_many} {of_one}");
    }
    // A lens sees pictures, each with its own occlusion.
    let mut lens = one.clone();
    lens.depth_of_field = Some(DepthOfField {
        focus: Focus::Auto,
        aperture: Aperture::Diameter(DistanceMm::new(2.0).unwrap()),
        darken: Share::NONE,
    });
    lens.sampling.dof = DofMethod::Lens(RayCount::new(64).unwrap());
    lens.size = ImageSize::new(48, 48).unwrap();
    let of_lens = error_left(&mut renderer, &on_reference(&volume, &lens), &lens);
    let small = Scene {
        size: lens.size,
        ..one
    };
    let of_small = error_left(&mut renderer, &on_reference(&volume, &small), &small);
    assert!(of_lens < 1.25 * of_small, "{of_lens} {of_small}");
}

#[test]
fn wanting_the_thickness_changes_nothing() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = vessels();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let mut render = |text: &str, wanted| {
        let rendering = renderer.render(&scene(&volume, text), wanted).unwrap();
        rendering.frame
    };
    let layer = Wanted::NONE.with([Layer::Thick]);
    let exact = render("radius=8", layer);
    assert!(render("radius=8", Wanted::NONE).color == exact.color);
    let taken = render("radius=8,thickness=50", layer);
    assert!(render("radius=8,thickness=50", Wanted::NONE).color == taken.color);
    // The layer is as thick as it is, whatever is taken for it.
    assert!(taken.plane(THICK) == exact.plane(THICK));
    assert!(taken.color != exact.color);
}

#[test]
fn a_picture_is_needed() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = vessels();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let scene = scene(&volume, "radius=8");
    let refused = renderer.render_pixels(&scene, Wanted::ALL, &[5]);
    let sentence = refused.err().unwrap().to_string();
    assert!(sentence.contains("needs all of its pixels"), "{sentence}");
}

#[test]
fn what_is_smaller_than_a_pixel_is_not_seen() {
    let Some(device) = common::device() else {
        return;
    };
    let block = occlusion_cases::volume([40, 40, 12], |p| {
        (4.0 - p.z).max(1.4 - (p.x - 19.6).hypot(p.z - 5.0))
    });
    let case = Case {
        name: "a ridge".to_owned(),
        volume: Arc::clone(&block),
        scene: occlusion_cases::scene(DVec3::splat(30.0), DVec3::splat(10.0), 1.0),
        accessibility: 1.0,
    };
    let center = DVec3::new(19.6, 19.6, 4.0);
    for (radius, is_seen) in [(0.4, false), (5.0, true)] {
        let scene = on_screen(&case, DVec3::Z, center, 30, &format!("radius={radius}"));
        let frame = &on_device(&device, &block, &[scene])[0];
        let shares = frame.plane(OCCLUSION).unwrap();
        assert_eq!(
            shares.iter().any(|share| *share > 0.05),
            is_seen,
            "{radius}"
        );
    }
}
