//! The rows of one picture size as plots.

use super::super::super::papers::axis;
use super::picture::PictureKind;

use super::row::renderer;
use super::timing::TimedRow;
use crate::lab::measure::{Tradeoff, front};
use crate::lab::report::{Point, Scatter, Section};

/// A plot for all that is seen in more than one setting.
pub fn section(place: &str, rows: &[TimedRow]) -> Section {
    let of = |&kind: &PictureKind| {
        let same: Vec<&TimedRow> = rows.iter().filter(|row| row.kind == Some(kind)).collect();
        (same.len() > 1).then(|| scatter(kind, &same))
    };
    Section {
        title: place.to_owned(),
        scatters: PictureKind::ALL.iter().filter_map(of).collect(),
        ..Section::default()
    }
}

/// Time against the colour's error, of rows that show the same.
fn scatter(kind: PictureKind, rows: &[&TimedRow]) -> Scatter {
    let with_error: Vec<(&TimedRow, Tradeoff)> = rows
        .iter()
        .filter_map(|&row| {
            let time = row.frame_ms().median_ms();
            let error = row.error?.color_rmse?;
            Some((row, Tradeoff { time, error }))
        })
        .collect();
    let tradeoffs: Vec<Tradeoff> = with_error.iter().map(|&(_, at)| at).collect();
    let points = with_error.iter().zip(front(&tradeoffs));
    let points = points.map(|(&(row, at), on_front)| Point {
        label: format!("{}, {}", renderer(row), row.setting),
        group: renderer(row).to_owned(),
        x: at.time,
        y: 100.0 * at.error,
        on_front,
        ..Point::default()
    });
    Scatter {
        title: format!("{}: time against error of the colour", kind.name()),
        x: axis("whole frame, median", "ms"),
        y: axis("colour rmse", "% of white"),
        points: points.collect(),
    }
}
