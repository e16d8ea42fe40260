//! The plots: error over time, of an effect each.

use super::effect::Effect;
use super::measure::Tried;
use crate::lab::bench::papers::axis;
use crate::lab::measure::{Tradeoff, front};
use crate::lab::report::{Point, Scatter};

pub const ABOUT: &str = "Each effect over its settings: how far it is from the reference's, and how many times as long the \
                         picture takes as without it.";

/// An effect's plot: its settings, and the picture without it.
pub fn scatter(effect: &Effect, tried: &[Tried]) -> Scatter {
    let with_error: Vec<(&Tried, Tradeoff)> = tried
        .iter()
        .filter_map(|one| {
            let at = Tradeoff {
                time: one.times.over(&tried[0].times),
                error: one.error.whole()?,
            };
            Some((one, at))
        })
        .collect();
    let tradeoffs: Vec<Tradeoff> = with_error.iter().map(|&(_, at)| at).collect();
    let points = with_error.iter().zip(front(&tradeoffs));
    let points = points.map(|((one, at), on_front)| Point {
        label: one.name(),
        group: one.option.clone().unwrap_or_else(|| one.setting.clone()),
        x: at.time,
        y: at.error,
        on_front,
        details: vec![("median".into(), format!("{:.2} ms", one.times.median_ms()))],
    });
    let judged_by = effect.judged_by;
    Scatter {
        title: format!("{}: {} over time", effect.name, judged_by.error_name()),
        x: axis("time", "times as long as without"),
        y: axis(
            &format!("{}, {}", judged_by.name(), judged_by.error_name()),
            "",
        ),
        points: points.collect(),
    }
}
