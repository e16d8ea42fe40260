//! Where a lens is in focus, and what is not.

use crate::error::Result;
use crate::frame::{Layer, PlaneEntry};
use crate::gpu::Buffer;
use crate::render::passes::{Circles, Run, circles_of_confusion};
use crate::render::resources::DeviceLayers;
use crate::scene::{DepthOfField, Scene};

use super::planes::Planes;

/// How far away the focal plane is, mm; waits for the depths where they decide it.
///
/// # Errors
/// Nothing is seen in the pixel that is to be in focus; the device failed.
pub fn focus_mm(run: &mut Run, scene: &Scene, dof: DepthOfField, planes: &Planes) -> Result<f64> {
    if !dof.focus.is_seen() {
        return dof.focus.distance_mm(&[], scene.size);
    }
    run.timings.start(run.device)?;
    let depths = planes.layers.download(run.device, Layer::Depth)?;
    let depths: Vec<f32> = depths.and_then(PlaneEntry::out_of).unwrap_or_default();
    let width = scene.size.width();
    let axial = |(pixel, depth): (u32, f32)| {
        let (x, y) = (
            f64::from(pixel % width) + 0.5,
            f64::from(pixel / width) + 0.5,
        );
        let ray = scene.camera.ray(scene.size, x, y);
        f64::from(depth) * ray.dir_world.dot(scene.camera.forward())
    };
    let axial_mm: Vec<f64> = (0..).zip(depths).map(axial).collect();
    dof.focus.distance_mm(&axial_mm, scene.size)
}

/// The circles of confusion of layers that have depths, and the `color` darkened by them.
///
/// # Errors
/// As [`Run::screen`].
pub fn circles(
    run: &mut Run,
    scene: &Scene,
    dof: DepthOfField,
    focus_mm: f64,
    layers: &mut DeviceLayers,
    color: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let [from_inverse, from_depth] = dof.growth_px(&scene.camera, scene.size);
    let circles = Circles {
        focus_mm: focus_mm as f32,
        from_inverse: from_inverse as f32,
        from_depth: from_depth as f32,
        darken: dof.darken.get() as f32,
    };
    circles_of_confusion(run, circles, layers, color)
}
