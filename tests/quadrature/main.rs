//! The rules that sum light along a ray: their order of convergence, what they keep of a spike, and
//! whether the adaptive one keeps its bound.

#[path = "../common/mod.rs"]
mod common;

mod adaptive;
mod convergence;
mod spike;

use angioray::extent::ImageSize;
use angioray::frame::Wanted;
use angioray::gpu::Device;
use angioray::render::{Options, Renderer};
use angioray::scene::{Camera, Emission, Knot, Lens, Picture, Rgb, Scene};
use angioray::volume::Volume;
use glam::DVec3;

fn knot(value: f64, color: [f64; 3], opacity: f64) -> Knot {
    Knot {
        value,
        color: Rgb(color),
        opacity,
    }
}

/// One pixel that looks along `toward` through a point.
fn through(volume: &Volume, point: DVec3, toward: DVec3, emission: Emission) -> Scene {
    let (_, radius_mm) = volume.bounding_sphere();
    let toward = toward.normalize();
    let mut scene = common::scene(volume, 1, Picture::Emission(emission));
    scene.size = ImageSize::new(1, 1).unwrap();
    scene.camera = Camera::look_at(
        point - toward * (4.0 * radius_mm),
        point,
        toward.any_orthonormal_vector(),
        Lens::Orthographic { height_mm: 1e-6 },
    )
    .unwrap();
    scene
}

/// The colours of a volume's scenes, the first pixel of each.
fn colors(device: &Device, volume: &Volume, scenes: &[Scene]) -> Vec<[f64; 4]> {
    let octree = common::octree(volume);
    let mut renderer = Renderer::new(device, volume, &octree, Options::default()).unwrap();
    let wanted = Wanted::default();
    let color = |scene| renderer.render(scene, wanted).unwrap().frame.color[0].map(f64::from);
    scenes.iter().map(color).collect()
}

/// The largest difference of any channel.
fn apart(a: [f64; 4], b: [f64; 4]) -> f64 {
    (0..4).fold(0.0, |most, c| f64::max(most, (a[c] - b[c]).abs()))
}
