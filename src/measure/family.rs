//! What a scene's way of following rays is called in plots.

use crate::scene::{Picture, QuadratureMethod, SamplingMethod, Scene};

/// The rule of quadrature of an integral, how anything else is sampled.
pub fn family(scene: &Scene) -> String {
    let sampling = &scene.sampling;
    match &scene.picture {
        Picture::Emission(medium) => match medium.quadrature.method {
            QuadratureMethod::Adaptive => "adaptive".into(),
            method => method.to_string(),
        },
        _ if sampling.method == SamplingMethod::Exact => "exact".into(),
        _ if sampling.probe => "steps".into(),
        _ => "plain steps".into(),
    }
}
