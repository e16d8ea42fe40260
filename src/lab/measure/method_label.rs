//! What a scene's method of following rays is called in plots.

use crate::scene::{
    Filter, Picture, QuadratureMethod, Reconstruction, SamplingMethod, Scene, Storage,
};

/// The label: of an integral its quadrature rule, of anything else how it is sampled; of the nearest
/// filter and the device's own, whose pictures are of other fields, the filter's name.
pub fn method_label(scene: &Scene) -> String {
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
        Picture::Surface { .. } if sampling.recon == Reconstruction::Adaptive => {
            "nearest, linear at hits".into()
        }
        _ if sampling.probe => "steps".into(),
        _ => "plain steps".into(),
    }
}
