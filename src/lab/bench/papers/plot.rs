//! Cases as a plot of time against error.

use crate::lab::measure::{Tradeoff, front};
use crate::lab::report::{Axis, Point, Scatter, Section};

use super::Measurement;

/// A group's part of the page: its cases as time against error.
pub fn section(volume: &str, series: &str, group: &[Measurement]) -> Section {
    let error = |one: &Measurement| match (&one.surface, &one.light) {
        (Some(surface), _) => surface.missed_share.map(|share| 100.0 * share),
        (None, Some(light)) => Some(100.0 * light.rmse),
        (None, None) => None,
    };
    let with_error: Vec<(&Measurement, f64)> = group
        .iter()
        .filter_map(|one| Some((one, error(one)?)))
        .collect();
    let tradeoffs: Vec<Tradeoff> = with_error
        .iter()
        .map(|&(one, error)| Tradeoff {
            time: one.times.median_ms(),
            error,
        })
        .collect();
    let points = with_error.iter().zip(&tradeoffs).zip(front(&tradeoffs));
    let points = points.map(|(((one, error), at), on_front)| Point {
        label: one.name.clone(),
        group: series.to_owned(),
        x: at.time,
        y: *error,
        on_front,
        details: vec![("samples a ray".into(), format!("{:.1}", one.samples))],
    });
    let is_surface = group.iter().any(|one| one.surface.is_some());
    let (label, unit) = match is_surface {
        true => ("missed hits", "%"),
        false => ("colour rmse", "% of white"),
    };
    Section {
        title: format!("{volume}, {series}"),
        scatters: vec![Scatter {
            title: format!("time against {label}"),
            x: axis("time", "ms"),
            y: axis(label, unit),
            points: points.collect(),
        }],
        ..Section::default()
    }
}

/// An axis of a plot.
pub fn axis(label: &str, unit: &str) -> Axis {
    Axis {
        label: label.into(),
        unit: unit.into(),
    }
}
