//! `--max-error`: what was chosen, for the statistics.

use serde::Serialize;

use crate::error::Result;
use crate::frame::Wanted;
use crate::scene::{Camera, ErrorBound, SceneOptions};
use crate::tolerance::{self, CONFIDENCE, Choice, Task};

use super::engine::Caster;
use super::load::Loaded;
use super::progress::Bars;
use super::terminal::note;

/// Of the random tiles: the same in every run.
const SEED: u64 = 1;

/// The cheapest way of following rays that keeps a bound. The reference has but one way, which is
/// what all errors are taken against: it needs no choice, whatever the bound. Told to the user.
pub fn choose(
    bound: ErrorBound,
    options: &SceneOptions,
    loaded: &Loaded,
    wanted: Wanted,
    elsewhere: &[Camera],
    caster: &mut Caster,
    bars: &Bars,
) -> Result<Option<Choice>> {
    let Caster::Device { renderer, .. } = caster else {
        note(format_args!(
            "max-error {bound}: the reference is what errors are held against, nothing is chosen"
        ));
        return Ok(None);
    };
    let task = Task {
        volume: &loaded.volume,
        subject: &loaded.subject,
        options,
        bound,
        wanted,
        seed: SEED,
        elsewhere,
    };
    let choice = tolerance::choose(&task, renderer, bars)?;
    note(&choice);
    Ok(Some(choice))
}

/// A choice in the statistics. Errors are in the metric's own unit, `null` where there is no number
/// for them: the depth error of a picture that misses hits.
#[derive(Serialize)]
pub struct ToleranceStats {
    metric: &'static str,
    bound: f64,
    /// As flags.
    chosen: String,
    estimate: f64,
    upper: f64,
    confidence: f64,
    verified: VerifiedStats,
    met: bool,
    tried: Vec<TriedStats>,
    cost: CostStats,
}

#[derive(Serialize)]
struct VerifiedStats {
    views: usize,
    tiles: usize,
    rays: usize,
}

#[derive(Serialize)]
struct TriedStats {
    setting: String,
    ms: Option<f64>,
    error: f64,
    judged: bool,
}

#[derive(Serialize)]
struct CostStats {
    ms: f64,
    build_ms: f64,
    reference_rays: u64,
    renderings: usize,
}

impl ToleranceStats {
    pub fn of(choice: &Choice) -> Self {
        let bound: ErrorBound = choice.bound;
        let tried = choice.tried.iter().map(|tried| TriedStats {
            setting: tried.setting.flags(),
            ms: tried.ms,
            error: tried.error,
            judged: tried.judged,
        });
        Self {
            metric: bound.metric().name(),
            bound: bound.bound(),
            chosen: choice.setting.flags(),
            estimate: choice.estimate,
            upper: choice.upper,
            confidence: CONFIDENCE,
            verified: VerifiedStats {
                views: choice.verified.views,
                tiles: choice.verified.tiles,
                rays: choice.verified.rays,
            },
            met: choice.met,
            tried: tried.collect(),
            cost: CostStats {
                ms: choice.cost.ms,
                build_ms: choice.cost.build_ms,
                reference_rays: choice.cost.rays,
                renderings: choice.cost.renderings,
            },
        }
    }
}
