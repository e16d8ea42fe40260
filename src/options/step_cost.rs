//! What fixed steps cost, and where dvr does without them unless they are wanted.

use super::SceneOptions;
use crate::number_text::concise;
use crate::scene::{
    Mode, Quadrature, QuadratureMethod, SamplingMethod, Scene, StepVoxels, Storage,
};
use crate::subject::Subject;

/// Spacings further apart than this make the step, a share of the smallest, far too fine along the largest.
pub(super) const UNLIKE_SPACINGS: f64 = 100.0;

/// Samples along a volume's longest path beyond which fixed steps are not taken unless they are wanted,
/// and are reported where they are.
pub(super) const MANY_SAMPLES: f64 = 16_384.0;

/// The greatest number of samples that a ray takes at a step.
fn samples_along(subject: &Subject, step: StepVoxels) -> f64 {
    2.0 * subject.sphere.radius_mm / (step.get() * subject.spacing_mm.min_element())
}

impl SceneOptions {
    /// dvr's quadrature where neither it nor anything about steps was given, and fixed steps at their default
    /// would cost out of proportion: the adaptive one, and why.
    pub(super) fn without_costly_steps(&self, subject: &Subject) -> Option<(Quadrature, String)> {
        let sampling = &self.sampling;
        let wants_steps = sampling.sampling.is_some()
            || sampling.step.is_some()
            || sampling.is_jittered()
            || sampling.probe.is_some()
            || sampling.voxels == Some(Storage::Filtered);
        let picture = &self.picture;
        let wants_rule = picture.quad.is_some() || picture.homogeneity.is_some();
        if self.mode() != Mode::Dvr || wants_steps || wants_rule {
            return None;
        }
        let spacing = subject.spacing_mm;
        let apart = spacing.max_element() / spacing.min_element();
        let samples = samples_along(subject, StepVoxels::default());
        if apart <= UNLIKE_SPACINGS && samples <= MANY_SAMPLES {
            return None;
        }
        let quad = Quadrature::of(QuadratureMethod::Adaptive);
        let note = format!(
            "quad = {quad}: fixed steps, a share of the smallest spacing ({} mm; the largest is {} mm), would take up to {} samples per ray; --quad chooses another",
            concise(spacing.min_element()),
            concise(spacing.max_element()),
            rounded(samples)
        );
        Some((quad, note))
    }
}

/// A sentence on what a scene's fixed steps cost, where that is much.
pub(super) fn cost_note(scene: &Scene, subject: &Subject) -> Option<String> {
    let step = scene.sampling.step;
    let samples = samples_along(subject, step);
    if scene.sampling.method != SamplingMethod::Fixed || samples <= MANY_SAMPLES {
        return None;
    }
    let pixels = scene.size.pixels() as f64;
    let instead = match scene.picture.mode() {
        Mode::Dvr => "--quad adaptive takes only as many as its error bound needs",
        _ => "--sampling exact takes no steps",
    };
    Some(format!(
        "steps of {step} voxels of the smallest spacing take up to {} samples per ray, {} in all: {instead}",
        rounded(samples),
        rounded(samples * pixels)
    ))
}

/// Prints a number to two digits.
fn rounded(number: f64) -> String {
    let two: f64 = format!("{number:.1e}").parse().unwrap_or(number);
    concise(two)
}
