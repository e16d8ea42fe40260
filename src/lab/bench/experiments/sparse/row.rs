//! The table.

use super::measure::WayRow;
use super::way;
use crate::lab::bench::Protocol;
use crate::lab::report::{Shown, Table};

pub const COLUMNS: [(&str, &str, Shown); 16] = [
    ("volume", "volume", Shown::Short),
    ("mode", "mode", Shown::Short),
    ("protocol", "protocol", Shown::Short),
    ("setting", "setting", Shown::Short),
    ("spacing_px", "K, pixels", Shown::Fixed(0)),
    ("screen_error", "E", Shown::Short),
    ("rays_share", "rays cast, %", Shown::Percent(1)),
    ("lost_share", "lost vessel pixels, %", Shown::Percent(3)),
    ("extra_share", "extra, %", Shown::Percent(3)),
    ("displaced_share", "wrong depth, %", Shown::Percent(3)),
    ("rmse", "colour rmse, %", Shown::Percent(3)),
    ("min_ms", "ms, min", Shown::Fixed(2)),
    ("median_ms", "median", Shown::Fixed(2)),
    ("ratio", "to every ray", Shown::Fixed(2)),
    ("lost", "lost", Shown::Fixed(0)),
    ("hits", "of pixels", Shown::Fixed(0)),
];

/// Appends a picture's rows.
pub fn tabulate(
    table: &mut Table,
    volume: &str,
    shown: way::Shown,
    protocol: Protocol,
    rows: &[WayRow],
) {
    for row in rows {
        table.push(vec![
            volume.into(),
            shown.name().into(),
            protocol.name().into(),
            row.family.name().into(),
            row.spacing.map(f64::from).into(),
            row.screen_error.into(),
            row.rays_share.into(),
            row.lost.lost_share().into(),
            row.lost.extra_share().into(),
            row.lost.displaced_share().into(),
            row.rmse.into(),
            row.times.min_ms().into(),
            row.times.median_ms().into(),
            row.times.over(&rows[row.base].times).into(),
            (row.lost.lost as u64).into(),
            (row.lost.hits as u64).into(),
        ]);
    }
}
