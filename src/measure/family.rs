//! What a scene's way of following rays is called in plots.

use crate::scene::{Filter, Picture, QuadratureMethod, SamplingMethod, Scene, Storage};

/// The rule of quadrature of an integral, how anything else is sampled; before both the nearest filter
/// and the device's own, whose pictures are of other fields.
pub fn family(scene: &Scene) -> String {
    let sampling = &scene.sampling;
    if sampling.filter == Filter::Nearest {
        return "nearest".into();
    }
    if sampling.voxels == Storage::Filtered {
        return "filtered".into();
    }
    match &scene.picture {
        Picture::Emission(medium) => match medium.quadrature.method() {
            QuadratureMethod::Adaptive => "adaptive".into(),
            method => method.to_string(),
        },
        _ if sampling.method == SamplingMethod::Exact => "exact".into(),
        _ if sampling.probe => "steps".into(),
        _ => "plain steps".into(),
    }
}
