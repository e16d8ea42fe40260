//! The rows of one picture size as plots.

use super::super::super::ways::axis;
use super::contender::Look;
use super::race::Raced;
use super::row::renderer;
use crate::measure::{Tradeoff, front};
use crate::report::{Point, Scatter, Section};

/// A plot for all that is seen in more than one way.
pub fn section(place: &str, rows: &[Raced]) -> Section {
    let of = |&look: &Look| {
        let same: Vec<&Raced> = rows.iter().filter(|row| row.look == Some(look)).collect();
        (same.len() > 1).then(|| scatter(look, &same))
    };
    Section {
        title: place.to_owned(),
        scatters: Look::ALL.iter().filter_map(of).collect(),
        ..Section::default()
    }
}

/// Time against the colour's error, of rows that show the same.
fn scatter(look: Look, rows: &[&Raced]) -> Scatter {
    let judged: Vec<(&Raced, Tradeoff)> = rows
        .iter()
        .filter_map(|&row| {
            let time = row.frame_ms().median_ms();
            let error = row.wrong?.color_rmse?;
            Some((row, Tradeoff { time, error }))
        })
        .collect();
    let tradeoffs: Vec<Tradeoff> = judged.iter().map(|&(_, at)| at).collect();
    let points = judged.iter().zip(front(&tradeoffs));
    let points = points.map(|(&(row, at), on_front)| Point {
        label: format!("{}, {}", renderer(row), row.setting),
        group: renderer(row).to_owned(),
        x: at.time,
        y: 100.0 * at.error,
        on_front,
        ..Point::default()
    });
    Scatter {
        title: format!("{}: time against error of the colour", look.name()),
        x: axis("whole frame, median", "ms"),
        y: axis("colour rmse", "% of white"),
        points: points.collect(),
    }
}
