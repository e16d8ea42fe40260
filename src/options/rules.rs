//! What each option belongs to, what it needs, and what applies where it is not given.
//!
//! An option is named by its flag, which is its key in scene files. Refusals ([`super::check`]), what is
//! left of a scene file beside flags ([`super::precedence`]), what goes with a mode ([`super::of_mode`]),
//! what settings and error bounds may say ([`super::Setting`], [`super::ToleranceOptions`]), and where an
//! option's help begins and ends ([`super::help`]) are made of this table. Options of other groups than the
//! scene's are looked up by [`unmet`].

use std::fmt::Display;

use super::enum_names::{Fit, GradientMethod, NonFiniteRule, Shading, Switch};
use super::quantities::{AngleDeg, GradientScale, SigmaMm, SigmaVoxels, Zoom};
use super::shade_from::ShadeFrom;
use super::step_cost::{MANY_SAMPLES, UNLIKE_SPACINGS};
use crate::extent::ImageSize;
use crate::octree::Leaf;
use crate::scene::{
    AntiAliasing, Brightness, Contrast, DofMethod, Filter, FovDeg, Gamma, HomogeneityRule, Jitter,
    Light, LightSizeDeg, Mode, Picture, Quadrature, Reconstruction, Refill, Refine, Reflectance,
    Sampling, SamplingMethod, Shininess, Sparse, SrgbColor, StepVoxels, Storage, Termination,
    TransferFile, View,
};

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
    /// How rays are followed. An error bound leaves it alone: it changes no picture (skipping), changes
    /// what the reference is (filter, gradient), or goes with whichever steps are chosen (jitter).
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
    /// Sparse casting.
    Sparse,
    /// Depth of field.
    Lens,
    /// Depth cues.
    Cues,
    /// Shadows.
    Shadows,
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

/// An option, what it decides, what it needs, and what applies without it.
pub(crate) struct Rule {
    pub group: Group,
    pub option: &'static str,
    pub decides: Decides,
    pub needs: &'static [Need],
    /// What applies where a scene's option is not given, as its help says it: the value that
    /// [`super::SceneOptions::resolve`] takes, or how it is found; where nothing is said, nothing applies.
    pub default: Option<fn() -> String>,
}

const ISO: &[Mode] = &[Mode::Iso];
const LMIP: &[Mode] = &[Mode::Lmip];
const DVR: &[Mode] = &[Mode::Dvr];
const LIT: &[Mode] = &[Mode::Iso, Mode::Dvr];
pub(super) const PROJECTIONS: &[Mode] = &[Mode::Mip, Mode::Lmip, Mode::Minip, Mode::Mean];
/// The modes whose rays look for a crossing or an extremum, which may lie between two samples.
const PEAKED: &[Mode] = &[Mode::Iso, Mode::Mip, Mode::Lmip, Mode::Minip];

const LIGHT: Need = Need::Modes(LIT, "a projection has no surface to light");
const NORMALS: Need = Need::Modes(LIT, "a projection has no normals");
const CUED: Need = Need::Modes(
    &[Mode::Iso, Mode::Mip, Mode::Lmip, Mode::Dvr],
    "what it shows lies all along the ray",
);
const FOCUSES: Need = Need::Modes(LIT, "a projection has no depth to focus on");
const OCCLUDES: Need = Need::Modes(ISO, "only a surface is in the way of light from everywhere");
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
        default: None,
    }
}

impl Rule {
    const fn default(mut self, text: fn() -> String) -> Self {
        self.default = Some(text);
        self
    }
}

/// The default of a type, as a user would write it.
fn text<T: Default + Display>() -> String {
    T::default().to_string()
}

const fn beside(group: Group, option: &'static str, needs: &'static [Need]) -> Rule {
    Rule {
        group,
        option,
        decides: What,
        needs,
        default: None,
    }
}

/// Every option of a scene, and those options beside it that need something.
#[rustfmt::skip]
pub(crate) const RULES: &[Rule] = &[
    scene("volume", What, &[]),
    scene("frame", What, &[])
        .default(|| 0.to_string()),
    scene("smooth", What, &[])
        .default(|| format!("{}, not at all", text::<SigmaMm>())),
    scene("non-finite", What, &[])
        .default(text::<NonFiniteRule>),
    scene("raw-size", What, &[]),
    scene("raw-type", What, &[]),
    scene("raw-spacing", What, &[])
        .default(|| 1.to_string()),
    scene("raw-offset", What, &[])
        .default(|| 0.to_string()),
    scene("octree-leaf", What, &[])
        .default(text::<Leaf>),

    scene("sampling", HowWithinBound, &[])
        .default(default_sampling),
    scene("step", HowWithinBound, &[Need::Steps])
        .default(text::<StepVoxels>),
    scene("jitter", How, &[Need::Steps])
        .default(text::<Jitter>),
    scene("filter", How, &[])
        .default(text::<Filter>),
    scene("recon", HowWithinBound, &[Need::Modes(ISO, "only a surface has a hit at which to change the filter"), Need::Steps])
        .default(text::<Reconstruction>),
    scene("traverse", How, &[])
        .default(|| Sampling::default().traverse.to_string()),
    scene("skip", How, &[])
        .default(|| Switch::from(Sampling::default().skip).to_string()),
    scene("probe", HowWithinBound, &[Need::Steps, Need::IdleBeside(PEAKED)])
        .default(default_probe),
    scene("voxels", How, &[])
        .default(text::<Storage>),

    scene("aa", What, &[]).default(text::<AntiAliasing>),
    scene("sparse", HowWithinBound, &[]).default(|| "every pixel".to_owned()),
    scene("refill", HowWithinBound, &[Need::Sparse]).default(default_refill),
    scene("screen-error", HowWithinBound, &[]).default(default_screen_error),

    scene("mode", What, &[])
        .default(text::<Mode>),
    scene("iso", What, &[Need::Modes(ISO, "only a surface has an iso value")])
        .default(|| "suggested by the volume's histogram".to_owned()),
    scene("caps", What, &[Need::Modes(ISO, "only a surface is closed where the volume ends")])
        .default(|| Switch::from(Picture::CAPS).to_string()),
    scene("refine", HowWithinBound, &[Need::Modes(ISO, "only a surface has a hit to refine"), Need::Steps])
        .default(text::<Refine>),
    scene("color", What, &[Need::Modes(ISO, "a projection is grey, and dvr takes its colours from the transfer function")])
        .default(|| format!("warm ivory, {}", SrgbColor::IVORY)),
    scene("window", What, &[Need::Modes(PROJECTIONS, "only a projection shows values as grey")])
        .default(|| "the value range, without a few far-away values and padding".to_owned()),
    scene("lmip-threshold", What, &[Need::Modes(LMIP, "only lmip looks for a local maximum")])
        .default(|| "the suggested iso value".to_owned()),
    scene("tf", What, &[Need::Modes(DVR, "only dvr maps values to opacity; a surface has 'color', a projection 'window'")])
        .default(|| TransferFile::DEFAULT_PRESET.to_owned()),
    scene("quad", HowWithinBound, &[Need::Modes(DVR, "only dvr sums light along the ray")])
        .default(default_quadrature),
    scene("homogeneity", HowWithinBound, &[AVERAGED])
        .default(|| "never".to_owned()),
    scene("homogeneity-rule", HowWithinBound, &[AVERAGED, Need::Homogeneity])
        .default(text::<HomogeneityRule>),
    scene("termination", HowWithinBound, &[Need::Modes(DVR, "only dvr gathers opacity along the ray")])
        .default(text::<Termination>),
    scene("shading", What, &[LIGHT])
        .default(default_shading),
    scene("ambient", What, &[LIGHT, Need::Shading])
        .default(|| occluded(Reflectance::AMBIENT)),
    scene("ambient-color", What, &[LIGHT, Need::Shading])
        .default(white),
    scene("diffuse", What, &[LIGHT, Need::Shading])
        .default(|| occluded(Reflectance::DIFFUSE)),
    scene("diffuse-color", What, &[LIGHT, Need::Shading])
        .default(white),
    scene("specular", What, &[LIGHT, Need::Shading])
        .default(|| Reflectance::SPECULAR.to_string()),
    scene("specular-color", What, &[LIGHT, Need::Shading])
        .default(white),
    scene("shininess", What, &[LIGHT, Need::Shading])
        .default(text::<Shininess>),
    scene("light", What, &[LIGHT, Need::Shading])
        .default(text::<Light>),
    scene("shade-from", What, &[Need::Modes(DVR, "only a medium has points where the field hardly changes"), Need::Shading])
        .default(|| format!("{}, all of it", text::<ShadeFrom>())),
    scene("ao", What, &[OCCLUDES, Need::Shading])
        .default(|| "none".to_owned()),
    scene("shadows", What, &[LIGHT, Need::Shading])
        .default(|| "none".to_owned()),
    scene("light-size", What, &[LIGHT, Need::Shading, Need::Shadows])
        .default(text::<LightSizeDeg>),
    scene("ssao", What, &[OCCLUDES, Need::Shading])
        .default(|| "none".to_owned()),
    scene("dof", What, &[FOCUSES])
        .default(|| "none, a pinhole".to_owned()),
    scene("dof-method", How, &[FOCUSES, Need::Lens])
        .default(text::<DofMethod>),
    scene("cue", What, &[CUED])
        .default(|| "none".to_owned()),
    scene("cue-range", What, &[CUED, Need::Cues])
        .default(|| "the ends of what the picture can show, in front of the eye".to_owned()),
    scene("gradient", How, &[NORMALS, Need::Normals])
        .default(text::<GradientMethod>),
    scene("gradient-scale", How, &[NORMALS, Need::Normals, SPARSE])
        .default(text::<GradientScale>),
    scene("gradient-smooth", How, &[NORMALS, Need::Normals, SMOOTHED])
        .default(|| format!("{}, none", text::<SigmaVoxels>())),

    scene("size", What, &[])
        .default(|| ImageSize::DEFAULT.to_string()),
    scene("eye", What, &[]),
    scene("target", What, &[])
        .default(|| "the centre of what --fit names".to_owned()),
    scene("up", What, &[Need::Eye])
        .default(|| "0,0,1; when looking along z that of the views superior and inferior".to_owned()),
    scene("fov", What, &[])
        .default(text::<FovDeg>),
    scene("ortho", What, &[]),
    scene("fit", What, &[])
        .default(text::<Fit>),
    scene("view", What, &[])
        .default(text::<View>),
    scene("azimuth", What, &[])
        .default(text::<AngleDeg>),
    scene("elevation", What, &[])
        .default(text::<AngleDeg>),
    scene("roll", What, &[])
        .default(text::<AngleDeg>),
    scene("zoom", What, &[])
        .default(text::<Zoom>),
    scene("carm", What, &[]),

    scene("clip-plane", What, &[])
        .default(|| "the whole volume".to_owned()),

    scene("background", What, &[])
        .default(|| SrgbColor::BLACK.to_string()),
    scene("brightness", What, &[])
        .default(text::<Brightness>),
    scene("contrast", What, &[])
        .default(text::<Contrast>),
    scene("gamma", What, &[])
        .default(text::<Gamma>),

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

fn white() -> String {
    SrgbColor::WHITE.to_string()
}

fn default_sampling() -> String {
    let (default, steps) = (SamplingMethod::default(), SamplingMethod::Fixed);
    let implying = RULES
        .iter()
        .filter(|rule| rule.needs.contains(&Need::Steps));
    let implying: Vec<String> = implying.map(|rule| format!("--{}", rule.option)).collect();
    format!(
        "{default}; {steps} where {} is given; in dvr exact is --quad adaptive, fixed all others",
        either(&implying)
    )
}

fn default_quadrature() -> String {
    format!(
        "{}; adaptive where --sampling exact is given, and where no option for steps is and they would \
         cost out of proportion: spacings more than {UNLIKE_SPACINGS} times apart, or more than \
         {MANY_SAMPLES} samples per ray",
        Quadrature::default()
    )
}

fn default_probe() -> String {
    let probe = Switch::from(Sampling::default().probe);
    format!("{probe}; off with --recon {}", Reconstruction::Adaptive)
}

fn default_refill() -> String {
    format!(
        "{3} with --screen-error, {0} where --sparse has a threshold, otherwise {1} in iso, {2} elsewhere",
        Refill::Gradient,
        Refill::of(Mode::Iso),
        Refill::of(Mode::Mip),
        Refill::Certified
    )
}

fn default_screen_error() -> String {
    format!(
        "{} where the refill of iso is certified, else none",
        Sparse::SURFACE_ERROR
    )
}

/// The default of a reflectance that is another where ambient light is occluded.
fn occluded(without: Reflectance) -> String {
    format!("{without}; {} with --ao or --ssao", Reflectance::OCCLUDED)
}

fn default_shading() -> String {
    let of_modes = LIT
        .iter()
        .map(|mode| format!("{} for {mode}", Shading::of(*mode)));
    of_modes.collect::<Vec<_>>().join(", ")
}

/// A list whose last two items are joined by "or".
fn either(items: &[String]) -> String {
    match items {
        [items @ .., last] if !items.is_empty() => format!("{} or {last}", items.join(", ")),
        _ => items.concat(),
    }
}

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

#[cfg(test)]
mod tests {
    use clap::Args;

    use super::*;
    use crate::options::{SceneOptions, flag_names};

    #[test]
    fn every_option_of_a_scene_has_one_rule() {
        let mut names = flag_names(&SceneOptions::augment_args(clap::Command::new("scene")));
        names.sort();
        let of_scene = RULES.iter().filter(|rule| rule.group == Group::Scene);
        let mut ruled: Vec<&str> = of_scene.map(|rule| rule.option).collect();
        ruled.sort_unstable();
        assert_eq!(ruled, names);
        // The control: a rule of no option, and an option without a rule, would be seen.
        assert!(!ruled.contains(&"lmip_threshold"));
    }
}
