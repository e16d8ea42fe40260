//! What each option belongs to, which options contradict each other, and which of a scene file's give way
//! to a flag: all rules between options stand here.
//!
//! An option is named by its flag, which is its key in scene files. Refusals ([`super::check`]), what is
//! left of a scene file beside flags ([`super::precedence`]), what goes with a mode ([`super::of_mode`]),
//! what settings and error bounds may say ([`super::Setting`], [`super::ToleranceOptions`]) are made of these
//! tables. Options of other groups than the scene's are looked up by [`unmet`].

use super::{SceneOptions, Shading};
use crate::scene::{Mode, QuadratureMethod, SamplingMethod, Storage, View};

/// The options among which a name is unique.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Group {
    Scene,
    Device,
    Output,
    Orbit,
    Bench,
}

/// The part of a picture that an option decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Decides {
    /// The volume, the picture of it and the camera, or something beside the scene.
    What,
    /// How rays are followed. An error bound leaves it alone: it changes no picture (skipping), or changes
    /// what the reference is (filter, gradient).
    How,
    /// How rays are followed; an error bound decides it.
    HowWithinBound,
}

use Decides::{How, HowWithinBound, What};

/// Another choice that an option needs in order to mean something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Need {
    /// One of these modes; why no other.
    Modes(&'static [Mode], &'static str),
    /// One of these modes. In the others the option has no effect, and is not refused.
    IdleBeside(&'static [Mode]),
    /// Samples at fixed steps, which the option therefore implies. Beside exact sampling it has no effect,
    /// which is reported.
    Steps,
    /// A shading.
    Shading,
    /// A place for normals.
    Normals,
    /// Precomputed gradients; why no others.
    Precomputed(&'static str),
    /// An eye.
    Eye,
    /// A limit of homogeneity.
    Homogeneity,
    /// An OpenCL device: the reference has none.
    OpenCl,
    /// A picture file that holds layers.
    Layered,
    /// A .png file.
    Png,
    /// A .jpg file.
    Jpeg,
    /// One file with a rate of frames.
    Animation,
    /// An experiment that aims rays.
    AimedRays,
    /// An experiment that times frames of a camera that it does not move itself.
    TimedFrames,
    /// An experiment that times modes in rounds, beside other programs.
    Rounds,
    /// Volumes that are named.
    Volumes,
    /// A folder for the results.
    ResultsFolder,
}

/// An option, what it decides and what it needs.
pub(crate) struct Rule {
    pub group: Group,
    pub option: &'static str,
    pub decides: Decides,
    pub needs: &'static [Need],
}

const ISO: &[Mode] = &[Mode::Iso];
const LMIP: &[Mode] = &[Mode::Lmip];
const DVR: &[Mode] = &[Mode::Dvr];
const LIT: &[Mode] = &[Mode::Iso, Mode::Dvr];
const PROJECTIONS: &[Mode] = &[Mode::Mip, Mode::Lmip, Mode::Minip, Mode::Mean];
/// The modes whose rays look for a crossing or an extremum, which may lie between two samples.
const PEAKED: &[Mode] = &[Mode::Iso, Mode::Mip, Mode::Lmip, Mode::Minip];

const LIGHT: Need = Need::Modes(LIT, "a projection has no surface to light");
const NORMALS: Need = Need::Modes(LIT, "a projection has no normals");
const AVERAGED: Need = Need::Modes(DVR, "only dvr takes a node for its average");
const SPARSE: Need = Need::Precomputed("only precomputed gradients are stored at every N-th voxel");
const SMOOTHED: Need = Need::Precomputed(
    "only precomputed gradients are smoothed by themselves; 'smooth' is for the volume",
);

const fn scene(option: &'static str, decides: Decides, needs: &'static [Need]) -> Rule {
    Rule {
        group: Group::Scene,
        option,
        decides,
        needs,
    }
}

const fn beside(group: Group, option: &'static str, needs: &'static [Need]) -> Rule {
    Rule {
        group,
        option,
        decides: What,
        needs,
    }
}

/// Every option of a scene, and those options beside it that need something.
#[rustfmt::skip]
pub(crate) const RULES: &[Rule] = &[
    scene("volume", What, &[]),
    scene("frame", What, &[]),
    scene("smooth", What, &[]),
    scene("non-finite", What, &[]),
    scene("raw-size", What, &[]),
    scene("raw-type", What, &[]),
    scene("raw-spacing", What, &[]),
    scene("raw-offset", What, &[]),
    scene("octree-leaf", What, &[]),

    scene("sampling", HowWithinBound, &[]),
    scene("step", HowWithinBound, &[Need::Steps]),
    scene("filter", How, &[]),
    scene("traverse", How, &[]),
    scene("skip", How, &[]),
    scene("probe", HowWithinBound, &[Need::Steps, Need::IdleBeside(PEAKED)]),
    scene("voxels", How, &[]),

    scene("mode", What, &[]),
    scene("iso", What, &[Need::Modes(ISO, "only a surface has an iso value")]),
    scene("caps", What, &[Need::Modes(ISO, "only a surface is closed where the volume ends")]),
    scene("refine", HowWithinBound, &[Need::Modes(ISO, "only a surface has a hit to refine"), Need::Steps]),
    scene("color", What, &[Need::Modes(ISO, "a projection is grey, and dvr takes its colours from the transfer function")]),
    scene("window", What, &[Need::Modes(PROJECTIONS, "only a projection shows values as grey")]),
    scene("lmip-threshold", What, &[Need::Modes(LMIP, "only lmip looks for a local maximum")]),
    scene("tf", What, &[Need::Modes(DVR, "only dvr maps values to opacity; a surface has 'color', a projection 'window'")]),
    scene("quad", HowWithinBound, &[Need::Modes(DVR, "only dvr sums light along the ray")]),
    scene("homogeneity", HowWithinBound, &[AVERAGED]),
    scene("homogeneity-rule", HowWithinBound, &[AVERAGED, Need::Homogeneity]),
    scene("termination", HowWithinBound, &[Need::Modes(DVR, "only dvr gathers opacity along the ray")]),
    scene("shading", What, &[LIGHT]),
    scene("ambient", What, &[LIGHT, Need::Shading]),
    scene("diffuse", What, &[LIGHT, Need::Shading]),
    scene("specular", What, &[LIGHT, Need::Shading]),
    scene("shininess", What, &[LIGHT, Need::Shading]),
    scene("light", What, &[LIGHT, Need::Shading]),
    scene("gradient", How, &[NORMALS, Need::Normals]),
    scene("gradient-scale", How, &[NORMALS, Need::Normals, SPARSE]),
    scene("gradient-smooth", How, &[NORMALS, Need::Normals, SMOOTHED]),

    scene("size", What, &[]),
    scene("eye", What, &[]),
    scene("target", What, &[]),
    scene("up", What, &[Need::Eye]),
    scene("fov", What, &[]),
    scene("ortho", What, &[]),
    scene("view", What, &[]),
    scene("azimuth", What, &[]),
    scene("elevation", What, &[]),
    scene("roll", What, &[]),
    scene("zoom", What, &[]),
    scene("carm", What, &[]),

    scene("clip-plane", What, &[]),

    scene("background", What, &[]),
    scene("brightness", What, &[]),
    scene("contrast", What, &[]),
    scene("gamma", What, &[]),

    beside(Group::Device, "work-group", &[Need::OpenCl]),
    beside(Group::Device, "lanes", &[Need::OpenCl]),

    beside(Group::Output, "aov", &[Need::Layered]),
    beside(Group::Output, "bit-depth", &[Need::Png]),
    beside(Group::Output, "quality", &[Need::Jpeg]),

    beside(Group::Orbit, "fps", &[Need::Animation]),

    beside(Group::Bench, "rays", &[Need::AimedRays]),
    beside(Group::Bench, "seed", &[Need::AimedRays]),
    beside(Group::Bench, "protocol", &[Need::TimedFrames]),
    beside(Group::Bench, "frames", &[Need::Rounds]),
    beside(Group::Bench, "peer", &[Need::Rounds]),
    beside(Group::Bench, "iso", &[Need::Volumes]),
    beside(Group::Bench, "restart", &[Need::ResultsFolder]),
];

/// The rule of an option, where there is one.
pub(crate) fn rule(group: Group, option: &str) -> Option<&'static Rule> {
    let is_it = |rule: &&Rule| rule.group == group && rule.option == option;
    RULES.iter().find(is_it)
}

/// Whether all needs of an option are met.
pub(crate) fn has_needs(group: Group, option: &str, is_met: impl Fn(Need) -> bool) -> bool {
    let needs = rule(group, option).map_or(&[][..], |rule| rule.needs);
    needs.iter().all(|need| is_met(*need))
}

/// The first of `options` that needs something that is not there, and what.
pub(crate) fn unmet(
    group: Group,
    options: &[String],
    is_met: impl Fn(Need) -> bool,
) -> Option<(&'static str, Need)> {
    let given = |rule: &&Rule| options.iter().any(|option| option == rule.option);
    let rules = RULES
        .iter()
        .filter(|rule| rule.group == group)
        .filter(given);
    let mut needs = rules.flat_map(|rule| rule.needs.iter().map(|need| (rule.option, *need)));
    needs.find(|(_, need)| !is_met(*need))
}

/// The options of a scene that decide something of this kind.
pub(super) fn deciding(decides: impl Fn(Decides) -> bool) -> impl Iterator<Item = &'static str> {
    let rules = RULES.iter().filter(|rule| rule.group == Group::Scene);
    rules
        .filter(move |rule| decides(rule.decides))
        .map(|rule| rule.option)
}

/// Whether an option of a scene has this need.
pub(super) fn needs(option: &str, need: Need) -> bool {
    rule(Group::Scene, option).is_some_and(|rule| rule.needs.contains(&need))
}

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
        is_in: |all| averages(all) && all.picture.is_shaded(),
        sentence: "'homogeneity' cannot be combined with shading: normals differ inside a node",
        hint: "choose shading none, or leave homogeneity out",
    },
    Contradiction {
        is_in: |all| averages(all) && !all.quadrature().is_stepped(),
        sentence: "'homogeneity' cannot be combined with quad 'adaptive', which keeps a bound of its own",
        hint: "choose another quad, or leave homogeneity out",
    },
];

/// Whether the averages of nodes are used.
fn averages(options: &SceneOptions) -> bool {
    options.mode() == Mode::Dvr && options.picture.homogeneity.is_some()
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
        options: &["sampling", "step", "probe", "refine"],
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
        options: &["ambient", "diffuse", "specular", "shininess", "light"],
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
        options: &["step", "probe", "refine", "homogeneity", "homogeneity-rule"],
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
    Replaced {
        by: |flags, file| flags.picture.homogeneity.is_some() && is_adaptive(file),
        options: &["quad"],
    },
    // An eye replaces a view and a view an eye, each with what turns it.
    Replaced {
        by: |flags, _| flags.camera.eye.is_some(),
        options: &["view", "carm", "azimuth", "elevation", "roll"],
    },
    Replaced {
        by: |flags, file| {
            let by_view = flags.camera.view.is_some() || flags.camera.carm.is_some();
            file.camera.eye.is_some() && by_view
        },
        options: &["eye", "up", "view", "carm", "azimuth", "elevation", "roll"],
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

    fn names_of_options() -> Vec<String> {
        let mut names = flag_names(&SceneOptions::augment_args(clap::Command::new("scene")));
        names.sort();
        names
    }

    #[test]
    fn every_option_of_a_scene_has_one_rule() {
        let of_scene = RULES.iter().filter(|rule| rule.group == Group::Scene);
        let mut ruled: Vec<&str> = of_scene.map(|rule| rule.option).collect();
        ruled.sort_unstable();
        assert_eq!(ruled, names_of_options());
        // The control: a rule of no option, and an option without a rule, would be seen.
        assert!(!ruled.contains(&"lmip_threshold"));
    }

    #[test]
    fn what_is_replaced_is_an_option() {
        let names = names_of_options();
        for replaced in REPLACED {
            for option in replaced.options {
                assert!(names.iter().any(|name| name == option), "{option}");
            }
        }
    }

    #[test]
    fn helps_name_the_modes_of_the_table_first() {
        let command = SceneOptions::augment_args(clap::Command::new("scene"));
        let named = |help: &str| -> Option<Vec<Mode>> {
            let (modes, _) = help.split_once(": ")?;
            if modes == "Projections" {
                return Some(PROJECTIONS.to_vec());
            }
            let modes = modes
                .split(", ")
                .map(|mode| mode.trim_start_matches("shaded "));
            modes.map(|mode| mode.parse().ok()).collect()
        };
        let mut compared = 0;
        for argument in command.get_arguments() {
            let option = flag_names(&clap::Command::new("one").arg(argument.clone()));
            let help = argument.get_help().map(ToString::to_string);
            let (Some(modes), Some(rule)) = (
                help.as_deref().and_then(named),
                rule(Group::Scene, &option[0]),
            ) else {
                continue;
            };
            let needs = rule.needs.iter();
            let ruled = needs.filter_map(|need| match need {
                Need::Modes(modes, _) => Some(modes.to_vec()),
                _ => None,
            });
            assert_eq!(ruled.collect::<Vec<_>>(), [modes], "{}", option[0]);
            compared += 1;
        }
        assert!(compared > 10, "{compared}");
    }
}
