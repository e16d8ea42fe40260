//! The rows of one picture size as a plot.

use super::super::super::ways::axis;
use super::race::Raced;
use super::row::renderer;
use crate::measure::{Tradeoff, front};
use crate::report::{Point, Scatter, Section};

/// Time against the colour's error, of all rows that have a picture; what shows the same is a group.
pub fn section(place: &str, rows: &[Raced]) -> Section {
    let judged: Vec<(&Raced, Tradeoff)> = rows
        .iter()
        .filter_map(|row| {
            let time = row.frame_ms().median_ms();
            let error = row.wrong?.color_rmse?;
            Some((row, Tradeoff { time, error }))
        })
        .collect();
    let points = judged.iter().map(|&(row, at)| {
        let same: Vec<Tradeoff> = judged
            .iter()
            .filter(|(other, _)| other.look == row.look)
            .map(|&(_, at)| at)
            .collect();
        let place = same.iter().position(|&other| other == at);
        Point {
            label: format!("{}, {}", renderer(row), row.setting),
            group: row
                .look
                .map(|look| look.name().to_owned())
                .unwrap_or_default(),
            x: at.time,
            y: 100.0 * at.error,
            on_front: place.is_some_and(|place| front(&same)[place]),
            ..Point::default()
        }
    });
    Section {
        title: place.to_owned(),
        scatters: vec![Scatter {
            title: "Time against error of the colour".into(),
            x: axis("whole frame, median", "ms"),
            y: axis("colour rmse", "%"),
            points: points.collect(),
        }],
        ..Section::default()
    }
}
