//! The pass that only samples, against which casts are measured: it takes the samples that it claims to
//! take. Without a device the test says so and passes, unless REQUIRE_OPENCL=1.

use crate::common;

use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::render::{Lanes, Options, Renderer, Sampled};
use angioray::scene::{Picture, Projection, Scene, StepVoxels, Window};
use angioray::volume::Volume;
use glam::DVec3;

const DIMS: [u64; 3] = [17, 15, 13];
const STEP_MM: f64 = 0.75;

/// Linear, so that the mean of samples on a straight path is the value in its middle.
fn linear(p: DVec3) -> f64 {
    5.0 + p.dot(DVec3::new(1.0, -0.5, 2.0))
}

fn volume() -> Volume {
    common::volume_of(DIMS, |x, y, z| linear(DVec3::new(x, y, z)) as f32)
}

fn scene(volume: &Volume, toward_eye: DVec3) -> Scene {
    let picture = Picture::Projection {
        of: Projection::Mean,
        window: Window::new(0.0, 50.0).unwrap(),
    };
    let mut scene = common::scene(volume, 29, picture);
    scene.camera = common::camera(volume, toward_eye);
    scene.sampling.step = StepVoxels::new(STEP_MM).unwrap();
    scene
}

/// Where a pixel's ray enters and leaves the volume, in lengths of its direction.
fn path(scene: &Scene, pixel: usize) -> (DVec3, DVec3, f64, f64) {
    let width = scene.size.width() as usize;
    let (x, y) = ((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5);
    let ray = scene.camera.ray(scene.size, x, y);
    let (origin, dir) = (ray.origin_world, ray.dir_world);
    let (mut enter, mut exit) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let to = |face: f64| (face - origin[axis]) / dir[axis];
        let (a, b) = (to(0.0), to((DIMS[axis] - 1) as f64));
        enter = enter.max(a.min(b));
        exit = exit.min(a.max(b));
    }
    (origin, dir, enter, exit)
}

/// Pixels in which the means or the counts are not those of the scene's rays.
fn wrong_pixels(sampled: &Sampled, scene: &Scene) -> usize {
    (0..scene.size.pixels())
        .filter(|&pixel| {
            let (origin, dir, enter, exit) = path(scene, pixel);
            let steps = ((exit - enter) / STEP_MM).max(0.0);
            let count = sampled.counts[pixel];
            // Where the path is a whole number of steps rounding decides on the last.
            let right_count = (f64::from(count) - steps.floor()).abs() < 0.5
                || (steps - steps.round()).abs() < 1e-4
                    && (f64::from(count) - steps.round()).abs() < 1.5;
            let middle = origin + dir * (enter + 0.5 * f64::from(count) * STEP_MM);
            let mean = if count > 0 { linear(middle) } else { 0.0 };
            !right_count || (sampled.means[pixel] - mean).abs() > 1e-4
        })
        .count()
}

#[test]
fn every_ray_is_sampled_from_end_to_end() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = volume();
    let octree = Octree::build(&volume, Leaf::default(), &Silent).unwrap();
    let here = scene(&volume, DVec3::new(1.0, 0.4, 0.7));
    let sampled = Lanes::ALL.map(|lanes| {
        let options = Options {
            lanes: Some(lanes),
            ..Options::default()
        };
        let mut renderer = Renderer::new(&device, &volume, &octree, options).unwrap();
        renderer.sample_field(&here).unwrap()
    });
    for one in &sampled {
        assert_eq!(wrong_pixels(one, &here), 0);
        assert_eq!(one.means, sampled[0].means);
        assert_eq!(one.counts, sampled[0].counts);
    }
    let max = (DIMS.iter().sum::<u64>() as f64 / STEP_MM) as u32;
    let hit = sampled[0].counts.iter().filter(|&&n| n > 0).count();
    assert!(hit > 200 && hit < here.size.pixels(), "{hit}");
    assert!(sampled[0].counts.iter().all(|&n| n < max));
    assert_eq!(
        sampled[0].samples(),
        sampled[0].counts.iter().map(|&n| u64::from(n)).sum::<u64>()
    );
    // The control: of a camera elsewhere nearly all would be wrong.
    let elsewhere = scene(&volume, DVec3::new(1.0, 0.5, 0.7));
    assert!(wrong_pixels(&sampled[0], &elsewhere) > hit / 2);
}
