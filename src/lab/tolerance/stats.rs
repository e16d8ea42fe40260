//! A choice as statistics and results store it.

use serde::Serialize;

use super::{CONFIDENCE, Choice};

/// A choice, for programs. Errors are in the metric's own unit, `null` where there is no number
/// for them: the depth error of a picture that misses hits.
#[derive(Serialize)]
pub struct ToleranceStats {
    metric: &'static str,
    bound: f64,
    /// The chosen setting, as flags.
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
    evaluated: bool,
}

#[derive(Serialize)]
struct CostStats {
    ms: f64,
    build_ms: f64,
    reference_rays: u64,
    renderings: usize,
}

impl ToleranceStats {
    /// The statistics of a choice.
    pub fn of(choice: &Choice) -> Self {
        let bound = choice.bound;
        let tried = choice.tried.iter().map(|tried| TriedStats {
            setting: tried.setting.flags(),
            ms: tried.ms,
            error: tried.error,
            evaluated: tried.evaluated,
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
