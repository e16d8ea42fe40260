//! Ways as a plot.

use crate::measure::{Tradeoff, front};
use crate::report::{Axis, Point, Scatter, Section};

use super::Found;

/// A group's part of the page: its ways as time against error.
pub fn section(volume: &str, case: &str, group: &[Found]) -> Section {
    let error = |found: &Found| match (&found.surface, &found.light) {
        (Some(surface), _) => surface.missed_share.map(|share| 100.0 * share),
        (None, Some(light)) => Some(100.0 * light.rmse),
        (None, None) => None,
    };
    let judged: Vec<(&Found, f64)> = group
        .iter()
        .filter_map(|found| Some((found, error(found)?)))
        .collect();
    let tradeoffs: Vec<Tradeoff> = judged
        .iter()
        .map(|&(found, error)| Tradeoff {
            time: found.times.median_ms(),
            error,
        })
        .collect();
    let points = judged.iter().zip(&tradeoffs).zip(front(&tradeoffs));
    let points = points.map(|(((found, error), at), on_front)| Point {
        label: found.name.clone(),
        group: case.to_owned(),
        x: at.time,
        y: *error,
        on_front,
        details: vec![("samples a ray".into(), format!("{:.1}", found.samples))],
    });
    let is_surface = group.iter().any(|found| found.surface.is_some());
    let (label, unit) = match is_surface {
        true => ("missed hits", "%"),
        false => ("colour rmse", "% of white"),
    };
    Section {
        title: format!("{volume}, {case}"),
        scatters: vec![Scatter {
            title: format!("time against {label}"),
            x: axis("time", "ms"),
            y: axis(label, unit),
            points: points.collect(),
        }],
        ..Section::default()
    }
}

/// Of a plot.
pub fn axis(label: &str, unit: &str) -> Axis {
    Axis {
        label: label.into(),
        unit: unit.into(),
    }
}
