//! Which options of a scene contradict each other, and which of a scene file's give way to a flag beside
//! those that lose what they need ([`super::rules`]).

use super::enum_names::{GradientMethod, Switch};
use super::shade_from::ShadeFrom;
use super::{SceneOptions, Shading};
use crate::scene::{
    Filter, Mode, QuadratureMethod, Reconstruction, Refill, SamplingMethod, Storage, View,
};

/// Two options of one scene that cannot both be meant.
pub(super) struct Contradiction {
    pub is_in: fn(&SceneOptions) -> bool,
    pub sentence: &'static str,
    pub hint: &'static str,
}

/// The options of a scene that contradict each other.
pub(super) const CONTRADICTIONS: &[Contradiction] = &[
    Contradiction {
        is_in: |all| all.camera.fov.is_some() && all.camera.ortho.is_some(),
        sentence: "'fov' and 'ortho' cannot be combined: a picture is perspective or orthographic",
        hint: "",
    },
    Contradiction {
        is_in: |all| all.camera.eye.is_some() && all.camera.view.is_some(),
        sentence: "'eye' and 'view' cannot be combined: both place the eye",
        hint: TURNED,
    },
    Contradiction {
        is_in: |all| all.camera.eye.is_some() && all.camera.carm.is_some(),
        sentence: "'eye' and 'carm' cannot be combined: both place the eye",
        hint: TURNED,
    },
    Contradiction {
        is_in: |all| all.camera.eye.is_some() && all.camera.fit.is_some(),
        sentence: "'eye' and 'fit' cannot be combined: both say how far away the eye is",
        hint: "leave one of them out; 'zoom' magnifies what an eye sees",
    },
    Contradiction {
        is_in: |all| {
            let from_elsewhere = all.camera.view.is_some_and(|view| view != View::Anterior);
            all.camera.carm.is_some() && from_elsewhere
        },
        sentence: "'carm' and 'view' cannot be combined: 'carm' is azimuth and elevation from the anterior view",
        hint: "",
    },
    Contradiction {
        is_in: |all| all.camera.carm.is_some() && all.camera.azimuth.is_some(),
        sentence: "'carm' and 'azimuth' cannot be combined: 'carm' is azimuth and elevation from the anterior view",
        hint: "",
    },
    Contradiction {
        is_in: |all| all.camera.carm.is_some() && all.camera.elevation.is_some(),
        sentence: "'carm' and 'elevation' cannot be combined: 'carm' is azimuth and elevation from the anterior view",
        hint: "",
    },
    Contradiction {
        is_in: |all| {
            let many_rays = all.sampling.aa.is_some_and(|aa| aa.rays() > 1);
            many_rays && all.sampling.is_sparse()
        },
        sentence: "'aa' cannot be combined with 'sparse' or 'screen-error': one casts many rays in a pixel, the other none in most",
        hint: "",
    },
    Contradiction {
        is_in: |all| {
            let is_stepped = all.mode() != Mode::Dvr && all.method() == SamplingMethod::Fixed;
            is_stepped && all.sampling.screen_error.is_some()
        },
        sentence: "'screen-error' cannot be combined with fixed steps: what they find is not proven to be what there is",
        hint: "choose sampling exact, or leave screen-error out",
    },
    Contradiction {
        is_in: |all| all.sampling.is_jittered() && all.method() == SamplingMethod::Exact,
        sentence: "'jitter' cannot be combined with exact sampling or quad adaptive, which take no samples at steps and need none",
        hint: "choose sampling fixed, or another quad, or leave jitter out",
    },
    Contradiction {
        is_in: |all| marches_nearest(all) && is_exact(all),
        sentence: "'recon' adaptive cannot be combined with exact sampling, which solves the field and takes no samples",
        hint: "choose sampling fixed",
    },
    Contradiction {
        is_in: |all| marches_nearest(all) && all.sampling.filter == Some(Filter::Nearest),
        sentence: "'recon' adaptive cannot be combined with 'filter' nearest, of which every sample already is",
        hint: "leave one of the two out",
    },
    Contradiction {
        is_in: |all| marches_nearest(all) && all.sampling.probe == Some(Switch::On),
        sentence: "'recon' adaptive cannot be combined with 'probe' on: between nearest voxels the field has no slope",
        hint: "leave one of the two out",
    },
    Contradiction {
        is_in: |all| all.effects.ao.is_some() && all.sampling.filter == Some(Filter::Nearest),
        sentence: "'ao' cannot be combined with 'filter' nearest, whose surface is the voxels' faces",
        hint: "leave one of the two out",
    },
    Contradiction {
        is_in: |all| all.effects.ssao.is_some() && all.sampling.filter == Some(Filter::Nearest),
        sentence: "'ssao' cannot be combined with 'filter' nearest, whose surface is the voxels' faces",
        hint: "leave one of the two out",
    },
    Contradiction {
        is_in: |all| {
            let nearest = all.sampling.filter == Some(Filter::Nearest);
            all.effects.shadows.is_some() && nearest && all.mode() == Mode::Iso
        },
        sentence: "'shadows' cannot be combined with 'filter' nearest, whose surface is the voxels' faces",
        hint: "leave one of the two out",
    },
    Contradiction {
        is_in: |all| all.effects.ao.is_some() && all.effects.ssao.is_some(),
        sentence: "'ao' cannot be combined with 'ssao': both find how much of the light from everywhere is occluded",
        hint: "leave one of the two out: 'ao' follows rays, 'ssao' looks at the picture",
    },
    Contradiction {
        is_in: |all| all.effects.dof.is_some() && all.effects.draws_edges(),
        sentence: "'dof' cannot be combined with the cues halo and contour, which are drawn at sharp edges",
        hint: "leave one of them out; fog and chromadepth go with 'dof'",
    },
    Contradiction {
        is_in: |all| all.effects.cue.is_some() && is_certified(all) && all.mode() != Mode::Iso,
        sentence: "'cue' cannot be combined with certified pixels but in mode iso: their colours are within an error, their depths are not",
        hint: "choose refill gradient or flood, or leave 'cue' out",
    },
    Contradiction {
        is_in: |all| averages(all) && all.picture.is_shaded(),
        sentence: "'homogeneity' cannot be combined with shading: normals differ inside a node",
        hint: "choose shading none, or leave homogeneity out",
    },
    Contradiction {
        is_in: |all| averages(all) && !all.quadrature().is_stepped(),
        sentence: "'homogeneity' cannot be combined with quad 'adaptive', which keeps a bound of its own",
        hint: "choose another quad, or leave homogeneity out",
    },
    Contradiction {
        is_in: |all| weighs_gradients(all) && is_precomputed(all),
        sentence: "'shade-from' cannot be combined with precomputed gradients, of which only the direction is stored",
        hint: "choose another gradient, or leave shade-from out",
    },
];

/// Whether a medium's shading depends on the gradient's magnitude.
fn weighs_gradients(options: &SceneOptions) -> bool {
    let gradient = options.picture.shade_from;
    gradient.is_some_and(|gradient| gradient != ShadeFrom::default())
}

fn is_precomputed(options: &SceneOptions) -> bool {
    options.picture.gradient == Some(GradientMethod::Precomputed)
}

/// Whether the averages of nodes are used.
fn averages(options: &SceneOptions) -> bool {
    options.mode() == Mode::Dvr && options.picture.homogeneity.is_some()
}

/// Whether pixels without rays are proven to be within an error.
fn is_certified(options: &SceneOptions) -> bool {
    let sampling = &options.sampling;
    sampling.screen_error.is_some() || sampling.refill == Some(Refill::Certified)
}

/// Whether the march toward a surface takes the nearest voxels.
fn marches_nearest(options: &SceneOptions) -> bool {
    options.sampling.recon == Some(Reconstruction::Adaptive)
}

const TURNED: &str = "'azimuth', 'elevation', 'roll' and 'zoom' turn and zoom either";

/// Options of a scene file that flags replace, beside those of the flags' own keys and those that no
/// longer have what they need.
pub(super) struct Replaced {
    /// Whether these flags replace options of this file.
    pub by: fn(&SceneOptions, &SceneOptions) -> bool,
    /// The file's options that are dropped.
    pub options: &'static [&'static str],
}

/// All flags that win over other options of a scene file.
pub(super) const REPLACED: &[Replaced] = &[
    // An integral is not sampled as a surface is: neither's sampling is the other's.
    Replaced {
        by: |flags, file| {
            let is_dvr = |options: &SceneOptions| options.mode() == Mode::Dvr;
            flags.picture.mode.is_some() && is_dvr(flags) != is_dvr(file)
        },
        options: &["sampling", "step", "jitter", "probe", "recon", "refine"],
    },
    // Light of which the file's own mode made no use is not another mode's.
    Replaced {
        by: |flags, file| is_other_mode(flags, file) && !file.mode().is_lit(),
        options: &["shading"],
    },
    Replaced {
        by: |flags, file| {
            let was_lit = file.mode().is_lit() && file.picture.is_shaded();
            is_other_mode(flags, file) && flags.picture.shading.is_none() && !was_lit
        },
        options: &[
            "ambient",
            "ambient-color",
            "diffuse",
            "diffuse-color",
            "specular",
            "specular-color",
            "shininess",
            "light",
            "shade-from",
        ],
    },
    // What implies steps wins over a sampling.
    Replaced {
        by: |flags, _| {
            let of_rules = flags.picture.quad.is_some() || flags.picture.homogeneity.is_some();
            flags.sampling.sampling.is_none() && (flags.steps_given() || of_rules)
        },
        options: &["sampling"],
    },
    // A sampling wins over what implies another.
    Replaced {
        by: |flags, file| {
            let methods = flags.sampling.sampling.zip(file.picture.quad);
            methods.is_some_and(|(method, quad)| quad.sampling() != method)
        },
        options: &["quad"],
    },
    Replaced {
        by: |flags, _| is_exact(flags),
        options: &[
            "step",
            "jitter",
            "probe",
            "recon",
            "refine",
            "homogeneity",
            "homogeneity-rule",
        ],
    },
    // The adaptive quadrature takes no samples that could be shifted.
    Replaced {
        by: |flags, _| is_adaptive(flags),
        options: &["jitter"],
    },
    Replaced {
        by: |flags, file| flags.sampling.is_jittered() && is_adaptive(file),
        options: &["quad"],
    },
    // Nearest voxels on the way to a hit are neither probed between nor all there is.
    Replaced {
        by: |flags, _| marches_nearest(flags),
        options: &["probe"],
    },
    Replaced {
        by: |flags, file| marches_nearest(flags) && file.sampling.filter == Some(Filter::Nearest),
        options: &["filter"],
    },
    Replaced {
        by: |flags, _| {
            let sampling = &flags.sampling;
            sampling.filter == Some(Filter::Nearest) || sampling.probe == Some(Switch::On)
        },
        options: &["recon"],
    },
    Replaced {
        by: |flags, _| flags.sampling.filter == Some(Filter::Nearest),
        options: &["ao", "ssao"],
    },
    Replaced {
        by: |flags, file| {
            flags.effects.occlusion().is_some() && file.sampling.filter == Some(Filter::Nearest)
        },
        options: &["filter"],
    },
    Replaced {
        by: |flags, file| flags.sampling.filter == Some(Filter::Nearest) && is_surface(flags, file),
        options: &["shadows", "light-size"],
    },
    Replaced {
        by: |flags, file| {
            let nearest = file.sampling.filter == Some(Filter::Nearest);
            flags.effects.shadows.is_some() && nearest && is_surface(flags, file)
        },
        options: &["filter"],
    },
    // One way to find what is occluded replaces the other.
    Replaced {
        by: |flags, _| flags.effects.ao.is_some(),
        options: &["ssao"],
    },
    Replaced {
        by: |flags, _| flags.effects.ssao.is_some(),
        options: &["ao"],
    },
    // Sharp edges and a lens replace each other.
    Replaced {
        by: |flags, file| flags.effects.dof.is_some() && file.effects.draws_edges(),
        options: &["cue", "cue-range"],
    },
    Replaced {
        by: |flags, _| flags.effects.draws_edges(),
        options: &["dof", "dof-method"],
    },
    // So do colours by depths and depths that are within no error.
    Replaced {
        by: |flags, file| is_certified(flags) && !is_surface(flags, file),
        options: &["cue", "cue-range"],
    },
    Replaced {
        by: |flags, file| {
            flags.effects.cue.is_some() && is_certified(file) && !is_surface(flags, file)
        },
        options: &["screen-error", "refill"],
    },
    Replaced {
        by: |flags, file| is_exact(flags) && file.sampling.voxels == Some(Storage::Filtered),
        options: &["voxels"],
    },
    // Homogeneous nodes have neither normals nor an error bound.
    Replaced {
        by: |flags, _| {
            let shading = flags.picture.shading;
            shading.is_some_and(|shading| shading != Shading::None) || is_adaptive(flags)
        },
        options: &["homogeneity", "homogeneity-rule"],
    },
    Replaced {
        by: |flags, _| flags.picture.homogeneity.is_some(),
        options: &["shading"],
    },
    // Of precomputed gradients there is no magnitude.
    Replaced {
        by: |flags, file| weighs_gradients(flags) && is_precomputed(file),
        options: &["gradient", "gradient-scale", "gradient-smooth"],
    },
    Replaced {
        by: |flags, _| is_precomputed(flags),
        options: &["shade-from"],
    },
    Replaced {
        by: |flags, file| flags.picture.homogeneity.is_some() && is_adaptive(file),
        options: &["quad"],
    },
    // Many rays in a pixel replace rays in few pixels, and the other way round.
    Replaced {
        by: |flags, _| flags.sampling.aa.is_some_and(|aa| aa.rays() > 1),
        options: &["sparse", "refill", "screen-error"],
    },
    Replaced {
        by: |flags, _| flags.sampling.is_sparse(),
        options: &["aa"],
    },
    // Fixed steps keep no error on the screen; an error replaces other refills and their threshold, and the other way
    // round.
    Replaced {
        by: |flags, file| {
            let mode = flags.clone().or(file.clone()).mode();
            mode != Mode::Dvr
                && flags.method() == SamplingMethod::Fixed
                && flags.sampling.screen_error.is_none()
        },
        options: &["screen-error"],
    },
    Replaced {
        by: |flags, file| {
            let mode = flags.clone().or(file.clone()).mode();
            flags.sampling.screen_error.is_some() && mode != Mode::Dvr
        },
        options: &["sampling", "step", "jitter", "probe", "refine", "recon"],
    },
    Replaced {
        by: |flags, _| {
            flags
                .sampling
                .refill
                .is_some_and(|refill| refill != Refill::Certified)
        },
        options: &["screen-error"],
    },
    Replaced {
        by: |flags, _| {
            let grid = flags.sampling.sparse;
            grid.is_some_and(|grid| grid.threshold().is_some())
        },
        options: &["screen-error"],
    },
    Replaced {
        by: |flags, _| flags.sampling.screen_error.is_some(),
        options: &["refill"],
    },
    Replaced {
        by: |flags, file| {
            let grid = file.sampling.sparse;
            let has_threshold = grid.is_some_and(|grid| grid.threshold().is_some());
            flags.sampling.screen_error.is_some() && has_threshold
        },
        options: &["sparse"],
    },
    // An eye replaces a view and a view an eye, each with what turns it.
    Replaced {
        by: |flags, _| flags.camera.eye.is_some(),
        options: &["fit", "view", "carm", "azimuth", "elevation", "roll"],
    },
    Replaced {
        by: |flags, file| {
            let by_view = flags.camera.view.is_some() || flags.camera.carm.is_some();
            file.camera.eye.is_some() && by_view
        },
        options: &["eye", "up", "view", "carm", "azimuth", "elevation", "roll"],
    },
    // What is to fit the picture replaces an eye and what that looks at, which may have been found for another.
    Replaced {
        by: |flags, file| flags.camera.fit.is_some() && file.camera.eye.is_some(),
        options: &["eye", "target", "up", "azimuth", "elevation", "roll"],
    },
    Replaced {
        by: |flags, _| flags.camera.carm.is_some(),
        options: &["view", "azimuth", "elevation"],
    },
    Replaced {
        by: |flags, _| {
            let camera = &flags.camera;
            camera.view.is_some() || camera.azimuth.is_some() || camera.elevation.is_some()
        },
        options: &["carm"],
    },
    // One lens replaces the other.
    Replaced {
        by: |flags, _| flags.camera.fov.is_some(),
        options: &["ortho"],
    },
    Replaced {
        by: |flags, _| flags.camera.ortho.is_some(),
        options: &["fov"],
    },
];

/// Whether the flags name another mode than the file's.
pub(super) fn is_other_mode(flags: &SceneOptions, file: &SceneOptions) -> bool {
    flags.picture.mode.is_some_and(|mode| mode != file.mode())
}

/// Whether flags over a file make a picture of a surface.
fn is_surface(flags: &SceneOptions, file: &SceneOptions) -> bool {
    let mode = flags.picture.mode.or(file.picture.mode);
    mode.unwrap_or_default() == Mode::Iso
}

fn is_exact(options: &SceneOptions) -> bool {
    options.sampling.sampling == Some(SamplingMethod::Exact)
}

fn is_adaptive(options: &SceneOptions) -> bool {
    let method = options.picture.quad.map(|quad| quad.method());
    method == Some(QuadratureMethod::Adaptive)
}

#[cfg(test)]
mod tests {
    use clap::Args;

    use super::*;
    use crate::options::flag_names;

    #[test]
    fn what_is_replaced_is_an_option() {
        let names = flag_names(&SceneOptions::augment_args(clap::Command::new("scene")));
        for replaced in REPLACED {
            for option in replaced.options {
                assert!(names.iter().any(|name| name == option), "{option}");
            }
        }
    }
}
