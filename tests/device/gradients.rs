//! Normals by every method of computing gradients, by the reference and on the device, against closed
//! forms; and what precomputed gradients cost. `--no-capture | grep '|'` prints what is measured.

use crate::common;

use angioray::extent::ImageSize;
use angioray::frame::{DEPTH, Frame, KIND, Kind, NORMAL};
use angioray::octree::Octree;
use angioray::render::{Directions, Options, Renderer};
use angioray::scene::{Camera, Gradient, Lens, Phong, Picture, Precomputed, Refine, Rgb, Scene};
use angioray::volume::{Geometry, Volume};
use common::{on_device, on_reference, volume_with};
use glam::{DMat3, DQuat, DVec3};

const DIFFERENCES: [Gradient; 3] = [Gradient::Forward, Gradient::Central, Gradient::FourthOrder];

fn precomputed(scale: u32, sigma_voxels: f64) -> Gradient {
    Gradient::Precomputed(Precomputed::new(scale, sigma_voxels).unwrap())
}

fn surface(iso: f64) -> Picture {
    Picture::Surface {
        iso,
        caps: false,
        refine: Refine::default(),
        color: Rgb([0.8; 3]),
        phong: Some(Phong::default()),
    }
}

/// The frames by the reference and, where there is one, by the device.
fn frames(volume: &Volume, scenes: &[Scene]) -> Vec<(&'static str, Vec<Frame>)> {
    let of_reference = scenes.iter().map(|s| on_reference(volume, s)).collect();
    let mut all = vec![("reference", of_reference)];
    if let Some(device) = common::device() {
        all.push(("device", on_device(&device, volume, scenes)));
    }
    all
}

/// World coordinates where the rays of a frame hit, with their normals.
fn hits(scene: &Scene, frame: &Frame) -> Vec<(DVec3, DVec3)> {
    let width = scene.size.width();
    let kinds = frame.plane(KIND).into_iter().flatten();
    let planes = frame
        .plane(DEPTH)
        .into_iter()
        .flatten()
        .zip(frame.plane(NORMAL).into_iter().flatten());
    let pixels = kinds.zip(planes).enumerate();
    let hits = pixels.filter(|(_, (kind, _))| **kind == Kind::Surface as u32);
    hits.map(|(pixel, (_, (&depth_mm, normal)))| {
        let (i, j) = (pixel as u32 % width, pixel as u32 / width);
        let ray = scene
            .camera
            .ray(scene.size, f64::from(i) + 0.5, f64::from(j) + 0.5);
        let p_world = ray.origin_world + ray.dir_world * f64::from(depth_mm);
        (p_world, DVec3::from_array(normal.map(f64::from)))
    })
    .collect()
}

fn angle_deg(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

fn smooth(p: DVec3) -> f64 {
    (0.9 * p.x + 0.3).sin() + 0.7 * (1.1 * p.y).cos() + 0.5 * (0.8 * p.z + 0.2).sin()
}

fn smooth_gradient(p: DVec3) -> DVec3 {
    DVec3::new(
        0.9 * (0.9 * p.x + 0.3).cos(),
        -0.77 * (1.1 * p.y).sin(),
        0.4 * (0.8 * p.z + 0.2).cos(),
    )
}

/// Along a row of voxel centres the field is hit at the centre of one of them: there Φ is the smooth
/// field itself, so that the normal's error is that of the differences.
fn angle_at_a_voxel(gradient: Gradient, h: f64) -> Vec<(&'static str, f64)> {
    let n = (3.2 / h).round() as u64 + 1;
    let origin = DVec3::new(-0.8, 0.0, 0.0);
    let geometry = Geometry::new(origin, DMat3::IDENTITY, DVec3::splat(h)).unwrap();
    let volume = volume_with([n, n, n], geometry, |x, y, z| {
        smooth(origin + DVec3::new(x, y, z) * h) as f32
    });
    let hit = DVec3::new(0.0, 1.6, 1.6); // a voxel's centre for every h; sin rises around it
    let iso = f64::from(smooth(hit) as f32);
    let lens = Lens::Orthographic { height_mm: 1e-3 };
    let mut scene = common::scene(&volume, 1, surface(iso));
    scene.camera = Camera::look_at(hit - DVec3::X * 10.0, hit, DVec3::Z, lens).unwrap();
    scene.size = ImageSize::new(1, 1).unwrap();
    scene.gradient = gradient;
    let reference = -smooth_gradient(hit).normalize();
    let all = frames(&volume, std::slice::from_ref(&scene));
    all.into_iter()
        .map(|(renderer, frames)| {
            let hits = hits(&scene, &frames[0]);
            let [(at, normal)] = hits[..] else {
                panic!("{renderer} misses at {h}")
            };
            assert!(at.distance(hit) < 1e-3, "{renderer} {h}: {at}");
            (renderer, angle_deg(normal, reference))
        })
        .collect()
}

#[test]
fn normals_converge_with_the_order_of_their_differences() {
    for (gradient, order) in DIFFERENCES.into_iter().zip([1.0, 2.0, 4.0]) {
        let coarse = angle_at_a_voxel(gradient, 0.4);
        let fine = angle_at_a_voxel(gradient, 0.2);
        for ((renderer, coarse), (_, fine)) in coarse.into_iter().zip(fine) {
            let observed = (coarse / fine).log2();
            println!("| {renderer} | {gradient:?} | {coarse:.2e}° | {fine:.2e}° | {observed:.2} |");
            // The device's hit lies within 1e-5 voxel of the centre, its planes hold f32.
            assert!(
                (observed - order).abs() < 0.4,
                "{renderer} {gradient:?}: {observed}"
            );
        }
    }
}

/// Spacing 0.3 : 0.55 : 0.9 mm, turned about no axis of the grid.
fn oblique(dims: [u64; 3]) -> Geometry {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.7);
    let direction = DMat3::from_quat(turn);
    let spacing_mm = DVec3::new(0.3, 0.55, 0.9);
    let middle = DVec3::from_array(dims.map(|n| (n as f64 - 1.0) / 2.0));
    let origin = -(direction * (spacing_mm * middle));
    Geometry::new(origin, direction, spacing_mm).unwrap()
}

/// A ball of 7 mm about the origin: 1 at its surface, falling outward by `profile` of the mm beyond.
fn ball(profile: impl Fn(f64) -> f64) -> Volume {
    let dims = [61, 35, 23];
    let geometry = oblique(dims);
    let world_from_index = geometry.world_from_index();
    volume_with(dims, geometry, |x, y, z| {
        let p = world_from_index.transform_point3(DVec3::new(x, y, z));
        (1.0 + profile(p.length() - 7.0)) as f32
    })
}

fn linear(beyond_mm: f64) -> f64 {
    -0.1 * beyond_mm
}

/// An edge blurred over a few mm: gradients are strong about the surface alone.
fn edge(beyond_mm: f64) -> f64 {
    -(beyond_mm / 1.2).tanh()
}

fn ball_scene(volume: &Volume, gradient: Gradient) -> Scene {
    let mut scene = common::scene(volume, 64, surface(1.0));
    scene.gradient = gradient;
    scene
}

/// The largest angle, degrees, between normals and radii. A forward difference is the gradient half a
/// voxel ahead, its error at a radius R up to h (1 − n²) / 2R along each axis: with a voxel's diagonal
/// of 1.1 mm at 7 mm, 4.5°.
#[test]
fn a_ball_has_radial_normals_in_an_oblique_anisotropic_volume() {
    let volume = ball(linear);
    let limits = [
        (Gradient::Forward, 4.5),
        (Gradient::Central, 0.5),
        (Gradient::FourthOrder, 0.5),
        (precomputed(1, 0.0), 0.6),
        (precomputed(2, 0.0), 2.0),
        (precomputed(2, 1.0), 2.0),
    ];
    let scenes = limits.map(|(gradient, _)| ball_scene(&volume, gradient));
    for (renderer, frames) in frames(&volume, &scenes) {
        for (((gradient, limit), scene), frame) in limits.iter().zip(&scenes).zip(&frames) {
            let hits = hits(scene, frame);
            assert!(hits.len() > 300, "{renderer}: {}", hits.len());
            let angles = hits.iter().map(|(p, normal)| angle_deg(*p, *normal));
            let max = angles.fold(0.0, f64::max);
            println!("| {renderer} | {gradient:?} | {max:.3}° | {limit}° |");
            assert!(max < *limit, "{renderer} {gradient:?}: {max}°");
            // The control: gradients taken for vectors, not mapped by the inverse transpose.
            let m = volume.geometry().world_from_index().matrix3;
            let wrong = hits.iter().map(|(p, normal)| {
                let mistaken = (m * (m.transpose() * *p)).normalize();
                angle_deg(mistaken, *normal)
            });
            assert!(wrong.fold(0.0, f64::max) > 20.0);
        }
    }
}

/// What is reported of precomputed gradients is what their normals show.
#[test]
fn precomputed_gradients_report_how_far_off_they_are() {
    let volume = ball(edge);
    let mut before = [0.0; 3];
    for scale in [1, 2, 4, 8] {
        for (k, sigma) in [0.0, 1.0, 2.0].into_iter().enumerate() {
            let how = Precomputed::new(scale, sigma).unwrap();
            let directions = Directions::compute(&volume, how).unwrap();
            let kilobytes = directions.packed.len() as f64 * 2e-3;
            let error = directions.angle_error(&volume).unwrap();
            println!(
                "| ball | {scale} | {sigma} | {kilobytes:.1} kB | {:.3}° | {:.3}° | {} |",
                error.mean_deg, error.p99_deg, error.places
            );
            assert!(error.places > 5_000 && error.p99_deg >= error.mean_deg);
            // Coarser is worse.
            assert!(error.mean_deg > before[k], "{scale} {sigma}");
            before[k] = error.mean_deg;
        }
    }
    let Some(device) = common::device() else {
        return;
    };
    let octree: Octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let wanted = angioray::frame::Wanted::ALL;
    let central = renderer
        .render(&ball_scene(&volume, Gradient::Central), wanted)
        .unwrap();
    assert_eq!(central.gradients, None);
    let mut reported_before = 0.0;
    for scale in [2, 4] {
        let scene = ball_scene(&volume, precomputed(scale, 0.0));
        let rendering = renderer.render(&scene, wanted).unwrap();
        let figures = rendering.gradients.unwrap();
        let grid = [61u64, 35, 23].map(|n| (n - 1).div_ceil(u64::from(scale)) + 1);
        assert_eq!(figures.bytes, 6 * grid.iter().product::<u64>());
        assert!(rendering.device_bytes >= central.device_bytes + figures.bytes);
        let pairs = central.frame.plane(NORMAL).into_iter().flatten();
        let pairs = pairs.zip(rendering.frame.plane(NORMAL).into_iter().flatten());
        let angles: Vec<f64> = pairs
            .map(|(a, b)| [a, b].map(|n| DVec3::from_array(n.map(f64::from))))
            .filter(|[a, _]| *a != DVec3::ZERO)
            .map(|[a, b]| angle_deg(a, b))
            .collect();
        let mean = angles.iter().sum::<f64>() / angles.len() as f64;
        let reported = figures.angle.unwrap().mean_deg;
        println!("| ball, device | {scale} | reported {reported:.3}° | seen {mean:.3}° |");
        // The surface lies in the middle of the places.
        assert!(
            (0.4..2.5).contains(&(mean / reported)),
            "{scale}: {mean}, {reported}"
        );
        // The control: what was reported of the scale before does not fit.
        assert!(mean / reported_before > 2.5 && mean > 0.01);
        reported_before = reported;
    }
    // A picture without normals needs none.
    let mut bare = ball_scene(&volume, precomputed(2, 0.0));
    bare.picture = Picture::Projection {
        of: angioray::scene::Projection::Maximum,
        window: angioray::scene::Window::new(0.0, 2.0).unwrap(),
    };
    assert_eq!(renderer.render(&bare, wanted).unwrap().gradients, None);
}

/// Sheets of alternating values: one voxel to either side Φ is the same, and two voxels too, so that
/// gradients by symmetric differences vanish between them, but for the border's.
#[test]
fn where_the_gradient_vanishes_normals_face_the_eye() {
    let volume = common::volume_of([9, 7, 7], |x, _, _| ((x as u32 % 2) * 10) as f32);
    let lens = Lens::Perspective { fov_deg: 40.0 };
    let methods = [
        Gradient::Central,
        Gradient::FourthOrder,
        precomputed(1, 0.0),
        precomputed(3, 0.0),
    ];
    let from = |x: f64, gradient| {
        let eye = DVec3::new(x, 3.0, 3.0);
        let mut scene = common::scene(&volume, 6, surface(5.0));
        scene.camera = Camera::look_at(eye, eye + DVec3::X, DVec3::Z, lens).unwrap();
        scene.gradient = gradient;
        scene
    };
    let scenes: Vec<Scene> = (methods.iter())
        .flat_map(|method| [from(4.2, *method), from(0.2, *method)])
        .collect();
    for (renderer, frames) in frames(&volume, &scenes) {
        for (scene, frame) in scenes.iter().zip(&frames) {
            let eye = scene.camera.eye_world();
            let hits = hits(scene, frame);
            assert_eq!(hits.len(), 36, "{renderer} {:?}", scene.gradient);
            let facing = |(p, n): &&(DVec3, DVec3)| angle_deg(eye - *p, *n) < 1e-2;
            let facing = hits.iter().filter(facing).count();
            // The control: at the border there is a gradient, across the sheets.
            let expected = if eye.x > 1.0 { 36 } else { 0 };
            assert_eq!(facing, expected, "{renderer} {:?}", scene.gradient);
        }
    }
}
