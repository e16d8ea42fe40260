//! The fastest setting of a medium whose picture is right to two steps of eight bits.

use serde::{Deserialize, Serialize};

use super::errors::{SparseReference, checked_pixels};
use super::picture::{PictureKind, scene};
use crate::error::Result;
use crate::frame::Wanted;
use crate::lab::bench::{Bench, Dataset, Preset};
use crate::lab::measure::time;
use crate::lab::report::figure;
use crate::render::Renderer;
use crate::scene::{Quadrature, Sampling, SamplingMethod, Scene, StepVoxels};

/// The largest error that a channel of a pixel may have.
const BOUND: f64 = 2.0 / 255.0;

/// Rules on panels of fixed steps, each tried at ever smaller ones until it keeps the bound.
fn rules(preset: Preset) -> &'static [&'static str] {
    match preset {
        Preset::Quick => &["simpson"],
        Preset::Usual | Preset::Full => &["preintegrated", "midpoint", "simpson"],
    }
}
/// The steps that are tried, in voxels.
const STEPS: [f64; 7] = [1.0, 0.75, 0.5, 0.33, 0.25, 0.16, 0.12];
/// The rule that is taken where none of them does: it has no step.
const SUREST: &str = "adaptive:0.001";

/// A medium in the setting that was chosen for it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Medium {
    shaded: bool,
    quadrature: String,
    /// The step in voxels, without meaning if the rule takes no steps.
    step_voxels: f64,
    /// The error in the pixels that were checked when it was chosen.
    color_max: f64,
    checked: usize,
    tried: usize,
}

impl Medium {
    pub fn kind(&self) -> PictureKind {
        match self.shaded {
            true => PictureKind::ShadedMedium,
            false => PictureKind::Medium,
        }
    }

    pub fn setting(&self) -> String {
        match self.quadrature.as_str() {
            SUREST => SUREST.to_owned(),
            rule => format!("{rule}, step {}", self.step_voxels),
        }
    }

    pub fn scene(&self, dataset: &Dataset, side_px: u32) -> Result<Scene> {
        let quadrature: Quadrature = self.quadrature.parse()?;
        let sampling = Sampling {
            method: SamplingMethod::Fixed,
            step: StepVoxels::new(self.step_voxels)?,
            ..Sampling::default()
        };
        scene(dataset, self.kind(), side_px, sampling, quadrature)
    }

    /// A sentence for the findings.
    pub fn finding(&self, volume: &str) -> String {
        let why = match self.color_max <= BOUND {
            true => "the fastest of those tried that stay within an error of 0.784 % (2 of 255)",
            false => {
                "none of those tried stays within an error of 0.784 % (2 of 255), this one comes nearest"
            }
        };
        format!(
            "{volume}, {}: {} ({} % of white in {} pixels), {why} ({} tried)",
            self.kind().name(),
            self.setting(),
            figure(100.0 * self.color_max),
            self.checked,
            self.tried
        )
    }
}

/// A setting that was tried.
struct Tried {
    medium: Medium,
    /// The time of a frame, ms, if it is within the bound.
    ms: f64,
}

/// The media, plain and shaded, in pictures of one size.
pub fn choose(bench: &Bench, dataset: &Dataset, side_px: u32) -> Result<Vec<Medium>> {
    let octree = bench.octree(dataset)?;
    let mut renderer = bench.renderer(dataset, &octree)?;
    let mut chosen = Vec::new();
    for shaded in [false, true] {
        let all = try_all(bench, dataset, shaded, side_px, &mut renderer)?;
        let tried = all.len();
        let fastest = all
            .iter()
            .filter(|one| one.medium.color_max <= BOUND)
            .min_by(|a, b| a.ms.total_cmp(&b.ms));
        let nearest = || {
            let error_of = |one: &&Tried| one.medium.color_max;
            all.iter()
                .min_by(|a, b| error_of(a).total_cmp(&error_of(b)))
        };
        if let Some(one) = fastest.or_else(nearest) {
            let mut medium = one.medium.clone();
            medium.tried = tried;
            chosen.push(medium);
        }
    }
    Ok(chosen)
}

fn try_all(
    bench: &Bench,
    dataset: &Dataset,
    shaded: bool,
    side_px: u32,
    renderer: &mut Renderer,
) -> Result<Vec<Tried>> {
    let of = |rule: &str, step_voxels| Medium {
        shaded,
        quadrature: rule.to_owned(),
        step_voxels,
        color_max: f64::INFINITY,
        checked: 0,
        tried: 0,
    };
    let seen = of(SUREST, STEPS[0]).scene(dataset, side_px)?;
    let reference = SparseReference::of(bench, dataset, &seen)?;
    let mut all = Vec::new();
    let mut try_one = |mut medium: Medium| -> Result<bool> {
        bench.check_stop()?;
        let scene = medium.scene(dataset, side_px)?;
        let rendering = renderer.render(&scene, Wanted::DISPLAY)?;
        let error = reference.error(medium.kind().mode(), &rendering.frame)?;
        medium.color_max = error.color_max.unwrap_or(f64::INFINITY);
        medium.checked = checked_pixels(bench.preset).min(scene.size.pixels());
        let keeps = medium.color_max <= BOUND;
        let ms = match keeps {
            true => time(renderer, &scene)?.frame_ms,
            false => f64::INFINITY,
        };
        all.push(Tried { medium, ms });
        Ok(keeps)
    };
    let mut kept = false;
    for rule in rules(bench.preset) {
        for step_voxels in STEPS {
            if try_one(of(rule, step_voxels))? {
                kept = true;
                break;
            }
        }
    }
    if !kept {
        try_one(of(SUREST, STEPS[0]))?;
    }
    Ok(all)
}
