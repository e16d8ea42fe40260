//! The rules that sum light along a ray: their order of convergence, what they keep of a spike, labels and
//! layers, and whether the adaptive one keeps its bound.

mod adaptive;
mod convergence;
mod labels;
mod layers;
mod spike;
mod unlike;

use angioray::gpu::Device;
use angioray::lab::bench::convergence::{self as convergence_of, apart};
use angioray::scene::{Emission, Knot, Rgb, Scene};
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
    convergence_of::through(volume, point, toward, emission).unwrap()
}

/// The colours of a volume's scenes, the first pixel of each.
fn colors(device: &Device, volume: &Volume, scenes: &[Scene]) -> Vec<[f64; 4]> {
    convergence_of::colors(device, volume, scenes).unwrap()
}
