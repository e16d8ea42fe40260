//! A plane, whose normal is known everywhere, under lights of every kind.

use angioray::extent::ImageSize;
use angioray::frame::Frame;
use angioray::scene::{Camera, Lens, Light, Phong, Reflectance, SamplingMethod, Scene};
use angioray::volume::Volume;
use glam::DVec3;

use super::{COLOR, apart, both, light, matt, surface};
use crate::common::{scene, volume_of};

/// The height of the plane above the volume's origin.
const HEIGHT: f64 = 9.5;
const SIDE_PX: u32 = 40;
/// A pixel's edge, mm.
const PIXEL: f64 = 0.5;

/// Φ falls with z; so the normal is +z, toward the eye.
fn plane() -> Volume {
    volume_of([24, 24, 20], |_, _, z| (20.0 - z) as f32)
}

/// The plane from above: parallel rays, x to the right and y upward.
fn from_above(lights: Vec<Light>, phong: Phong) -> Scene {
    let center = DVec3::new(11.5, 11.5, HEIGHT);
    let lens = Lens::Orthographic {
        height_mm: PIXEL * f64::from(SIDE_PX),
    };
    let mut scene = scene(&plane(), SIDE_PX, surface(20.0 - HEIGHT, phong));
    scene.size = ImageSize::new(SIDE_PX, SIDE_PX).unwrap();
    scene.camera = Camera::look_at(center + DVec3::Z * 100.0, center, DVec3::Y, lens).unwrap();
    scene.sampling.method = SamplingMethod::Exact;
    scene.lights = lights;
    scene
}

/// The plane's point in a pixel's centre.
fn place(pixel: usize) -> DVec3 {
    let (i, j) = (pixel % SIDE_PX as usize, pixel / SIDE_PX as usize);
    let middle = f64::from(SIDE_PX) / 2.0;
    let x = (i as f64 + 0.5 - middle) * PIXEL;
    let y = (middle - j as f64 - 0.5) * PIXEL;
    DVec3::new(11.5 + x, 11.5 + y, HEIGHT)
}

/// The greatest difference from the light that a formula gives each point.
fn worst(frame: &Frame, expected: impl Fn(DVec3) -> [f64; 3]) -> f64 {
    let colors = frame.color.iter().enumerate();
    colors.fold(0.0, |worst, (pixel, color)| {
        assert_eq!(color[3], 1.0, "the plane fills the picture");
        worst.max(apart(*color, expected(place(pixel))))
    })
}

#[test]
fn a_plane_is_lit_from_a_point_as_geometry_says() {
    let point = DVec3::new(7.0, 13.25, HEIGHT + 3.0);
    let scene = from_above(vec![Light::point(point).unwrap()], matt());
    let Some(frames) = both(&plane(), &scene) else {
        return;
    };
    let facing = |at: DVec3, point: DVec3| {
        let away = point - at;
        COLOR.map(|c| c * away.z / away.length())
    };
    for frame in frames {
        assert!(worst(&frame, |at| facing(at, point)) < 2e-6);
        // The controls: a light a tenth of a millimetre beside, and one far away.
        let beside = point + DVec3::X * 0.1;
        assert!(worst(&frame, |at| facing(at, beside)) > 1e-3);
        assert!(worst(&frame, |_| COLOR) > 0.1);
    }
}

#[test]
fn a_highlight_is_where_the_point_is_mirrored() {
    let point = DVec3::new(14.0, 9.0, HEIGHT + 6.0);
    let phong = Phong {
        specular: Reflectance::new(0.5).unwrap(),
        diffuse: Reflectance::new(0.0).unwrap(),
        specular_color: angioray::scene::Rgb([1.0, 0.25, 0.5]),
        ..matt()
    };
    let Some(frames) = both(
        &plane(),
        &from_above(vec![Light::point(point).unwrap()], phong),
    ) else {
        return;
    };
    // Mirrored at the plane, the light's direction meets the upward viewer at n·l.
    let lobe = |at: DVec3, point: DVec3| {
        let away = point - at;
        let lobe = (away.z / away.length()).powf(phong.shininess.get());
        [0.5, 0.125, 0.25].map(|share| share * lobe)
    };
    for frame in frames {
        assert!(worst(&frame, |at| lobe(at, point)) < 2e-6);
        assert!(worst(&frame, |at| lobe(at, point + DVec3::Y * 0.1)) > 1e-3);
    }
}

#[test]
fn lights_are_added_channel_by_channel() {
    let phong = Phong::default();
    let lights = [
        light("point:7,13,12@1,0.5,0"),
        light("0.3,0.2,1@blue@0.7"),
        light("camera:-1,0.5,1@0.4"),
        light("headlight@#204080"),
    ];
    let frame = |lights: Vec<Light>| both(&plane(), &from_above(lights, phong));
    let (Some(all), Some(none)) = (frame(lights.to_vec()), frame(Vec::new())) else {
        return;
    };
    let each = lights.map(|light| frame(vec![light]).unwrap());
    for (n, frame) in all.iter().enumerate() {
        let sum = |pixel: usize, of: usize| {
            let alone = |c: usize| f64::from(none[n].color[pixel][c]);
            let added =
                |light: &[Frame; 2], c: usize| f64::from(light[n].color[pixel][c]) - alone(c);
            std::array::from_fn(|c| {
                alone(c)
                    + each
                        .iter()
                        .take(of)
                        .map(|light| added(light, c))
                        .sum::<f64>()
            })
        };
        let worst = |of: usize| {
            let colors = frame.color.iter().enumerate();
            colors.fold(0.0, |worst: f64, (pixel, color)| {
                worst.max(apart(*color, sum(pixel, of)))
            })
        };
        assert!(worst(4) < 2e-6, "{}", worst(4));
        assert!(worst(3) > 1e-3);
        // A blue light leaves red and green as they were.
        for (blue, without) in each[1][n].color.iter().zip(&none[n].color) {
            assert_eq!(blue[..2], without[..2]);
            assert!(blue[2] > without[2]);
        }
    }
}

#[test]
fn a_material_has_a_colour_for_each_term() {
    let phong = Phong {
        ambient_color: angioray::scene::Rgb([0.5, 1.0, 0.0]),
        diffuse_color: angioray::scene::Rgb([0.25, 0.0, 1.0]),
        specular_color: angioray::scene::Rgb([0.0, 0.5, 1.0]),
        ..Phong::default()
    };
    let Some(frames) = both(&plane(), &from_above(vec![Light::HEADLIGHT], phong)) else {
        return;
    };
    // Under a headlight n·l and the specular term are 1.
    let expected = [
        COLOR[0] * (0.1 * 0.5 + 0.9 * 0.25),
        COLOR[1] * 0.1 + 0.2 * 0.5,
        COLOR[2] * 0.9 + 0.2,
    ];
    for frame in frames {
        assert!(worst(&frame, |_| expected) < 2e-6);
        let white = COLOR.map(|c| c + 0.2);
        assert!(worst(&frame, |_| white) > 0.1);
    }
}

/// A light on the surface itself: it grazes all other points. (What it gives the point itself is a matter of the last
/// bit; `kernel_functions::reflection` has it exactly there.)
#[test]
fn a_light_in_a_hit_grazes_all_others() {
    let pixel = 13 * SIDE_PX as usize + 22;
    let point = place(pixel);
    let scene = from_above(vec![Light::point(point).unwrap()], matt());
    let Some(frames) = both(&plane(), &scene) else {
        return;
    };
    for frame in frames {
        assert!(
            frame
                .color
                .iter()
                .flatten()
                .all(|channel| channel.is_finite())
        );
        let others = (0..frame.color.len()).filter(|&other| other != pixel);
        for other in others {
            let seen = apart(frame.color[other], [0.0; 3]);
            assert!(seen < 1e-5, "{other}: {seen}");
        }
    }
}

/// Far from the world's origin and from a far eye a light keeps its place.
#[test]
fn a_far_eye_moves_no_light() {
    let point = DVec3::new(7.0, 13.25, HEIGHT + 3.0);
    let near = from_above(vec![Light::point(point).unwrap()], matt());
    let mut far = near.clone();
    let center = DVec3::new(11.5, 11.5, HEIGHT);
    far.camera = Camera::look_at(
        center + DVec3::Z * 1e6,
        center,
        DVec3::Y,
        near.camera.lens(),
    )
    .unwrap();
    let (Some([near, _]), Some([far, _])) = (both(&plane(), &near), both(&plane(), &far)) else {
        return;
    };
    for (near, far) in near.color.iter().zip(&far.color) {
        assert!(apart(*near, [0, 1, 2].map(|c| f64::from(far[c]))) < 2e-6);
    }
}
