//! What a light is fixed to, and that lanes, rays in a pixel and pixels that are not cast leave it where it is.

use angioray::frame::{Frame, Wanted};
use angioray::reference::Tracer;
use angioray::render::{Lanes, Options, Renderer};
use angioray::scene::{
    AntiAliasing, Camera, Emission, Lens, Light, Mode, Phong, Picture, Quadrature, Rgb, Scene,
    ScreenError, ShadedFrom, Sparse,
};
use angioray::volume::Volume;
use glam::DVec3;

use super::super::invariance::{pictures, tubes};
use super::{light, surface};
use crate::common::{self, Figure, on_device, on_reference, volume_of};

/// A ball in the middle of a cube of voxels: a quarter turn about z leaves it as it is.
fn ball() -> Volume {
    volume_of([21, 21, 21], |x, y, z| {
        let from_center = DVec3::new(x - 10.0, y - 10.0, z - 10.0).length();
        (8.0 - from_center) as f32
    })
}

/// The ball from four sides, a quarter turn apart.
fn around(light: Light) -> Option<Vec<Frame>> {
    let device = common::device()?;
    let center = DVec3::splat(10.0);
    let lens = Lens::Perspective { fov_deg: 30.0 };
    let first = Camera::look_at(center - DVec3::Y * 40.0, center, DVec3::Z, lens).unwrap();
    let scenes = [0.0, 90.0, 180.0, 270.0].map(|degrees| Scene {
        camera: first.turned(DVec3::Z, center, degrees),
        lights: vec![light],
        ..common::scene(&ball(), 48, surface(0.0, Phong::default()))
    });
    Some(on_device(&device, &ball(), &scenes))
}

fn greatest_difference(a: &Frame, b: &Frame) -> f64 {
    let channels = a.color.iter().flatten().zip(b.color.iter().flatten());
    let differences = channels.map(|(a, b)| f64::from((a - b).abs()));
    differences.fold(0.0, f64::max)
}

#[test]
fn a_light_of_the_camera_turns_with_it_and_one_of_the_patient_does_not() {
    for (text, turns_with_camera) in [
        ("headlight", true),
        ("camera:-0.6,0.5,0.4", true),
        ("camera-point:-20,15,-9", true),
        ("0.8,-0.5,0.3", false),
        ("point:30,-10,20", false),
    ] {
        let Some(frames) = around(light(text)) else {
            return;
        };
        for turned in &frames[1..] {
            let differ = greatest_difference(&frames[0], turned);
            if turns_with_camera {
                assert!(differ < 1e-3, "{text}: {differ}");
            } else {
                assert!(differ > 0.1, "{text}: {differ}");
            }
        }
    }
}

#[test]
fn too_many_lights_are_refused_by_device_and_reference() {
    let Some(device) = common::device() else {
        return;
    };
    let (volume, octree) = (ball(), common::octree(&ball()));
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let with = |count: usize| Scene {
        lights: vec![Light::HEADLIGHT; count],
        ..common::scene(&volume, 8, surface(0.0, Phong::default()))
    };
    let refused = renderer.render(&with(5), Wanted::NONE).err().unwrap();
    let says = "5 lights: there may be at most 4";
    assert!(refused.to_string().contains(says), "{refused}");
    let refused = Tracer::new(&volume, &with(5)).err().unwrap();
    assert!(refused.to_string().contains(says), "{refused}");
    assert!(renderer.render(&with(4), Wanted::NONE).is_ok());
}

/// Lights of every kind, on a material with colours, and in a medium a gradient to shade from.
fn lit(volume: &Volume) -> Vec<Scene> {
    let (center, radius_mm) = volume.bounding_sphere();
    let near = Light::point(center + DVec3::new(0.1, -0.4, 0.3) * radius_mm).unwrap();
    let lights = vec![
        Light {
            color: "orange".parse().unwrap(),
            ..near
        },
        light("camera:-1,0.5,1@0.4"),
        light("0.3,-0.6,0.7@0.5,0.7,1"),
        light("headlight@0.3"),
    ];
    let tinted = Phong {
        ambient_color: Rgb([0.2, 0.5, 1.0]),
        specular_color: Rgb([1.0, 0.8, 0.3]),
        ..Phong::default()
    };
    let shown = |mut picture: Picture| {
        match &mut picture {
            Picture::Surface { phong, .. } => *phong = Some(tinted),
            Picture::Emission(medium) => {
                medium.phong = Some(tinted);
                medium.shaded_from = ShadedFrom::new(30.0).unwrap();
            }
            Picture::Projection { .. } => {}
        }
        Scene {
            lights: lights.clone(),
            ..common::scene(volume, 72, picture)
        }
    };
    let all = pictures(volume.range().max).into_iter();
    let lit = all.filter(|picture| picture.mode().is_lit()).map(shown);
    let mut scenes: Vec<Scene> = lit.take(2).collect();
    if let Some(Picture::Emission(medium)) = scenes.last().map(|scene| scene.picture.clone()) {
        scenes.push(Scene {
            picture: Picture::Emission(Emission {
                quadrature: Quadrature::adaptive(1e-4).unwrap(),
                ..medium
            }),
            ..scenes[0].clone()
        });
    }
    scenes
}

#[test]
fn lanes_change_no_byte_under_any_light() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let octree = common::octree(&volume);
    for scene in lit(&volume) {
        let frame = |lanes, scene: &Scene| {
            let options = Options {
                lanes: Some(lanes),
                ..Options::default()
            };
            let mut renderer = Renderer::new(&device, &volume, &octree, options).unwrap();
            renderer.render(scene, Wanted::ALL).unwrap().frame
        };
        let [one, eight, sixteen] = Lanes::ALL.map(|lanes| frame(lanes, &scene));
        assert!(one.bit_equal(&eight) && one.bit_equal(&sixteen));
        // The control: fewer lights are another picture.
        let mut fewer = scene.clone();
        fewer.lights.pop();
        assert!(!one.bit_equal(&frame(Lanes::ALL[1], &fewer)));
    }
}

#[test]
fn rays_in_a_pixel_are_lit_where_they_hit() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let iso = lit(&volume).swap_remove(0);
    let many = Scene {
        anti_aliasing: AntiAliasing::new(3, false).unwrap(),
        ..iso.clone()
    };
    let frames = on_device(&device, &volume, &[many.clone(), iso]);
    let reference = on_reference(&volume, &many);
    let off = |frame: &Frame| Figure::ColorP99.of(&reference, frame, &volume);
    assert!(off(&frames[0]) < 1e-3, "{}", off(&frames[0]));
    // The control: one ray in a pixel.
    assert!(off(&frames[1]) > 1e-2);
}

/// The bounds of light are bounds under lights that are brighter than white, in channels that differ.
#[test]
fn pixels_of_a_medium_that_are_not_cast_are_within_the_error() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = volume_of([48, 44, 40], |x, y, _| {
        (110.0 + 1.4 * x + 8.0 * (0.1 * y).sin()) as f32
    });
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let mut scene = lit(&volume).swap_remove(2);
    scene.lights.truncate(3);
    scene.lights.push(light("headlight@#ff2040@1.5"));
    let whole = renderer.render(&scene, Wanted::ALL).unwrap().frame;
    let (mut filled, mut brightest) = (0, 0.0f32);
    for error in [0.02, 0.3] {
        let within = Some(ScreenError::new(error).unwrap());
        let sparse = Scene {
            sparse: Some(Sparse::new(None, None, within, Mode::Dvr).unwrap()),
            ..scene.clone()
        };
        let frame = renderer.render(&sparse, Wanted::ALL).unwrap().frame;
        let differ = greatest_difference(&frame, &whole);
        assert!(differ <= error + 2e-4, "{error}: {differ}");
        let cast = frame.plane(angioray::frame::CAST).unwrap();
        filled += cast.iter().filter(|&&cast| cast == 0).count();
        brightest = frame.color.iter().map(|c| c[0]).fold(brightest, f32::max);
    }
    assert!(filled > 500, "{filled}");
    assert!(brightest > 0.5, "{brightest}");
}
