//! The plots: error over the number of rays, as Kratz et al. 2011 plot it, and over time.

use super::measure::WayRow;
use super::way::Family;
use crate::lab::bench::Protocol;
use crate::lab::bench::papers::axis;
use crate::lab::measure::{Tradeoff, front};
use crate::lab::report::{Point, Scatter, Section};

/// An error of a row, in percent.
type Error = fn(&WayRow) -> Option<f64>;

const LOST: (&str, Error) = ("lost vessel pixels", |row| {
    Some(100.0 * row.lost.lost_share()?)
});
const COLOR: (&str, Error) = ("colour rmse", |row| Some(100.0 * row.rmse?));

const ALONE: &str = "Compared with a ray in every pixel.";
const BESIDE_RIVAL: &str = "Compared with a ray in every pixel; rays one by one, and those from their neighbours' \
                            depth, find the surface alone and colour nothing, so that their times stand beside each \
                            other only.";

/// A picture's part of the page.
pub fn section(place: &str, measured: &[(Protocol, Vec<WayRow>)]) -> Section {
    let mut scatters = Vec::new();
    // The rays and what they lose are the same however the frames were timed.
    if let Some((_, rows)) = measured.first() {
        for (label, error) in [LOST, COLOR] {
            let rays = |row: &WayRow| 100.0 * row.rays_share;
            let title = format!("{label} over rays");
            scatters.push(scatter(
                title,
                ("rays cast", "% of pixels"),
                (label, error),
                rows,
                rays,
            ));
        }
    }
    for (protocol, rows) in measured {
        for (label, error) in [LOST, COLOR] {
            let ms = |row: &WayRow| row.times.median_ms();
            let title = format!("{label} over time, {protocol}");
            scatters.push(scatter(title, ("time", "ms"), (label, error), rows, ms));
        }
    }
    let mut rows = measured.iter().flat_map(|(_, rows)| rows);
    let has_rival = rows.any(|row| row.family == Family::OneByOne);
    Section {
        title: place.to_owned(),
        about: if has_rival { BESIDE_RIVAL } else { ALONE }.into(),
        scatters,
        ..Section::default()
    }
}

fn scatter(
    title: String,
    (x_label, x_unit): (&str, &str),
    (label, error): (&str, Error),
    rows: &[WayRow],
    x: impl Fn(&WayRow) -> f64,
) -> Scatter {
    let rows: Vec<(&WayRow, f64)> = rows
        .iter()
        .filter_map(|row| Some((row, error(row)?)))
        .collect();
    let tradeoff = |(row, error): &(&WayRow, f64)| Tradeoff {
        time: x(row),
        error: *error,
    };
    let on_front = front(&rows.iter().map(tradeoff).collect::<Vec<_>>());
    let points = rows
        .iter()
        .zip(on_front)
        .map(|((row, error), on_front)| Point {
            label: row.name(),
            group: row.family.name().to_owned(),
            x: x(row),
            y: *error,
            on_front,
            details: vec![(
                "rays cast".into(),
                format!("{:.1} %", 100.0 * row.rays_share),
            )],
        });
    Scatter {
        title,
        x: axis(x_label, x_unit),
        y: axis(label, "%"),
        points: points.collect(),
    }
}
