//! What a scene's way of following rays is called in plots.

use crate::scene::{Filter, Picture, QuadratureMethod, SamplingMethod, Scene};

/// The rule of quadrature of an integral, how anything else is sampled; the nearest filter, whose
/// picture is of another field, before both.
pub fn family(scene: &Scene) -> String {
    let sampling = &scene.sampling;
    if sampling.filter == Filter::Nearest {
        return "nearest".into();
    }
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
