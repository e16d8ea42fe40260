//! Whole pictures: planes, tone curve, shading, progress.

use std::sync::atomic::{AtomicU64, Ordering};

use angioray::extent::ImageSize;
use angioray::frame::{DEPTH, Frame, KIND, NODES, NORMAL, STEPS, VALUE, Wanted};
use angioray::progress::{Progress, Silent};
use angioray::reference::{render, render_pixels};
use angioray::scene::{
    Brightness, Camera, Contrast, Gamma, Lens, Light, Phong, Picture, Reflection, Rgb, Scene,
    Shininess, Tone,
};
use angioray::volume::{Geometry, Volume};
use glam::DVec3;

use crate::common::*;

fn ball() -> Volume {
    volume([17, 17, 17], Geometry::default(), |p| {
        6.0 - p.distance(DVec3::splat(8.0))
    })
}

/// The ball from the −y side, orthographic, 2 pixels a mm, row 0 at the top (+z).
fn ball_scene(phong: Option<Phong>) -> Scene {
    let picture = Picture::Surface {
        iso: 0.0,
        caps: true,
        refine: Default::default(),
        color: Rgb([0.8, 0.6, 0.4]),
        phong,
    };
    let lens = Lens::Orthographic { height_mm: 20.0 };
    let middle = DVec3::splat(8.0);
    Scene {
        size: ImageSize::new(50, 40).unwrap(),
        camera: Camera::look_at(middle - DVec3::Y * 20.0, middle, DVec3::Z, lens).unwrap(),
        ..scene(picture)
    }
}

fn picture(scene: &Scene) -> Frame {
    render(&ball(), scene, Wanted::ALL, &Silent).unwrap()
}

#[test]
fn only_wanted_planes_are_filled_and_all_have_every_pixel() {
    let scene = ball_scene(None);
    let all = picture(&scene);
    let pixels = scene.size.pixels();
    assert_eq!(all.color.len(), pixels);
    assert_eq!(all.plane(DEPTH).unwrap().len(), pixels);
    assert_eq!(all.plane(NORMAL).unwrap().len(), pixels);
    assert_eq!(all.plane(VALUE).unwrap().len(), pixels);
    assert_eq!(all.plane(KIND).unwrap().len(), pixels);
    assert_eq!(all.display.as_ref().unwrap().len(), pixels);
    assert!(all.plane(STEPS).unwrap().iter().any(|&n| n > 8));
    assert!(all.plane(NODES).unwrap().iter().all(|&n| n == 0));
    let none = render(&ball(), &scene, Wanted::NONE, &Silent).unwrap();
    assert_eq!(none.color, all.color);
    assert!(none.display.is_none() && none.layers.iter().next().is_none());
}

#[test]
fn the_ball_lies_where_the_camera_looks() {
    let frame = picture(&ball_scene(None));
    let (depth, normal) = (frame.plane(DEPTH).unwrap(), frame.plane(NORMAL).unwrap());
    let (mut hits, mut upward) = (0, 0);
    for j in 0..40 {
        for i in 0..50 {
            let (x, z) = (
                (f64::from(i) + 0.5 - 25.0) / 2.0,
                (20.0 - f64::from(j) - 0.5) / 2.0,
            );
            let at = j as usize * 50 + i as usize;
            let across = x * x + z * z;
            if across < 30.0 {
                hits += 1;
                let expected = 20.0 - (36.0 - across).sqrt();
                assert!((f64::from(depth[at]) - expected).abs() < 0.15);
                let n = DVec3::new(x, expected - 20.0, z) / 6.0;
                let seen = DVec3::from_array(normal[at].map(f64::from));
                assert!(seen.distance(n) < 0.05, "{seen} {n}");
                upward += u32::from((seen.z > 0.0) == (j < 20));
            } else if across > 38.0 {
                assert_eq!(depth[at], f32::INFINITY);
                assert_eq!((normal[at], frame.color[at]), ([0.0; 3], [0.0; 4]));
            }
        }
    }
    assert!(hits > 300 && upward == hits);
}

#[test]
fn the_same_bytes_whatever_the_number_of_threads() {
    let scene = ball_scene(Some(Phong::default()));
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| picture(&scene))
    };
    assert_eq!(on(1), on(3));
    assert_ne!(on(1), picture(&ball_scene(None)));
}

/// The middle pixel of the ball's picture and its normal.
fn lit_pixel(phong: Phong, light: Light) -> ([f64; 3], DVec3) {
    let mut scene = ball_scene(Some(phong));
    scene.lights = vec![light];
    let frame = picture(&scene);
    let at = 13 * 50 + 28;
    let n = DVec3::from_array(frame.plane(NORMAL).unwrap()[at].map(f64::from));
    let [r, g, b, a] = frame.color[at].map(f64::from);
    assert_eq!(a, 1.0);
    ([r, g, b], n)
}

#[test]
fn phong_and_blinn_phong_as_their_authors_wrote_them() {
    let v = DVec3::NEG_Y;
    let side = DVec3::new(0.5, -0.6, 0.7).normalize();
    for reflection in [Reflection::Phong, Reflection::BlinnPhong] {
        let phong = Phong {
            reflection,
            shininess: Shininess::new(5.0).unwrap(),
            ..Phong::default()
        };
        for (light, l) in [
            (Light::HEADLIGHT, v),
            (Light::distant(side).unwrap(), side),
            (Light::distant(DVec3::Y).unwrap(), DVec3::Y),
        ] {
            let (seen, n) = lit_pixel(phong, light);
            let nl = n.dot(l);
            let s = match reflection {
                _ if nl <= 0.0 => 0.0,
                Reflection::Phong => (2.0 * nl * n - l).dot(v).max(0.0).powi(5),
                Reflection::BlinnPhong => n.dot((l + v).normalize()).powi(5),
            };
            let expected = [0.8, 0.6, 0.4].map(|c| c * (0.1 + 0.9 * nl.max(0.0)) + 0.2 * s);
            for c in 0..3 {
                assert!((seen[c] - expected[c]).abs() < 1e-6);
                assert!((seen[c] - expected[c] * 1.001).abs() > 1e-6);
            }
        }
    }
}

#[test]
fn the_tone_curve_in_its_documented_order() {
    let mut scene = ball_scene(None);
    scene.tone = Tone {
        background: Rgb([0.25, 0.5, 1.0]),
        brightness: Brightness::new(0.05).unwrap(),
        contrast: Contrast::new(0.8).unwrap(),
        gamma: Gamma::new(1.5).unwrap(),
    };
    let frame = picture(&scene);
    let display = frame.display.unwrap();
    let toned = |linear: f64| {
        let encoded = if linear <= 0.003_130_8 {
            12.92 * linear
        } else {
            1.055 * linear.powf(1.0 / 2.4) - 0.055
        };
        ((encoded - 0.5) * 0.8 + 0.55)
            .clamp(0.0, 1.0)
            .powf(1.0 / 1.5)
    };
    let near = |pixel: [f32; 4], linear: [f64; 3]| {
        pixel[3] == 1.0 && (0..3).all(|c| (f64::from(pixel[c]) - toned(linear[c])).abs() < 1e-6)
    };
    assert!(near(display[0], [0.25, 0.5, 1.0]));
    assert!(near(display[20 * 50 + 25], [0.8, 0.6, 0.4]));
    assert!(!near(display[0], [0.8, 0.6, 0.4]));
    // The background is the display's alone.
    assert_eq!(frame.color[0], [0.0; 4]);
}

#[derive(Default)]
struct Counter {
    total: AtomicU64,
    done: AtomicU64,
    ended: AtomicU64,
}

impl Progress for Counter {
    fn begin(&self, name: &str, total: u64) {
        assert_eq!(name, "reference");
        self.total.store(total, Ordering::Relaxed);
    }
    fn advance(&self, units: u64) {
        self.done.fetch_add(units, Ordering::Relaxed);
    }
    fn end(&self) {
        self.ended.fetch_add(1, Ordering::Relaxed);
    }
}

#[test]
fn progress_counts_every_row_once() {
    let counter = Counter::default();
    render(&ball(), &ball_scene(None), Wanted::NONE, &counter).unwrap();
    assert_eq!(counter.total.load(Ordering::Relaxed), 40);
    assert_eq!(counter.done.load(Ordering::Relaxed), 40);
    assert_eq!(counter.ended.load(Ordering::Relaxed), 1);
}

#[test]
fn some_pixels_are_those_of_the_whole_picture() {
    let scene = ball_scene(Some(Phong::default()));
    let all = picture(&scene);
    // More than are cast at a time, in no order; the first and the last among them.
    let pixels: Vec<u32> = (0..600).map(|n| 1999 - n * 637 % 2000).collect();
    let some = render_pixels(&ball(), &scene, Wanted::ALL, &pixels, &Silent).unwrap();
    assert_eq!(some, all.picked(&pixels).unwrap());
    // The control: other pixels are other pictures.
    assert_ne!(
        some,
        all.picked(&[&pixels[1..], &pixels[..1]].concat()).unwrap()
    );
    let none = render_pixels(&ball(), &scene, Wanted::ALL, &[], &Silent);
    assert!(none.unwrap_err().to_string().contains("0x1 pixels"));
}
