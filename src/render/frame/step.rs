//! Whether a sampling step can be counted.

use crate::error::{Error, Result};
use crate::render::abi::{MAX_SAMPLES, step_mm};
use crate::scene::Scene;
use crate::volume::Volume;

/// Checks that no ray of the scene has more than [`MAX_SAMPLES`] samples, which single precision counts.
///
/// # Errors
/// A step so small that a ray has more.
pub fn check_step(scene: &Scene, volume: &Volume) -> Result<()> {
    let (_, radius_mm) = volume.bounding_sphere();
    let samples = 2.0 * radius_mm / step_mm(&scene.sampling, volume);
    if samples < f64::from(MAX_SAMPLES) {
        return Ok(());
    }
    Err(Error::usage(format!(
        "a step of {} voxels of the smallest spacing gives up to {samples:.3e} samples per ray, more than 2^24",
        scene.sampling.step
    ))
    .hint("choose a larger --step, or in dvr --quad adaptive, else --sampling exact, which take none"))
}
