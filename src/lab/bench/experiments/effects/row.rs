//! The table.

use super::effect::Shown;
use super::measure::{FocusRmse, Tried};
use crate::frame::error::ShareError;
use crate::lab::report::{Cell, Shown as As, Table};

pub const COLUMNS: [(&str, &str, As); 16] = [
    ("volume", "volume", As::Short),
    ("mode", "mode", As::Short),
    ("effect", "effect", As::Short),
    ("setting", "setting", As::Short),
    ("mean", "share of light, mean error", As::Short),
    ("p99", "p99", As::Short),
    ("max", "max", As::Short),
    ("bias", "bias", As::Short),
    ("rmse", "colour rmse, %", As::Percent(2)),
    ("in_focus_rmse", "in focus", As::Percent(2)),
    ("near_rmse", "near", As::Percent(2)),
    ("far_rmse", "far", As::Percent(2)),
    ("beside_rmse", "beside", As::Percent(2)),
    ("min_ms", "ms, min", As::Fixed(2)),
    ("median_ms", "median", As::Fixed(2)),
    ("ratio", "to without", As::Fixed(2)),
];

/// Appends an effect's rows, that of the picture without it first.
pub fn tabulate(table: &mut Table, volume: &str, (shown, effect): (Shown, &str), tried: &[Tried]) {
    for one in tried {
        let share = |of: fn(&ShareError) -> Option<f64>| Cell::from(one.error.share().and_then(of));
        let color = |of: fn(&FocusRmse) -> Option<f64>| Cell::from(one.error.colors().and_then(of));
        table.push(vec![
            volume.into(),
            shown.name().into(),
            effect.into(),
            one.name().into(),
            share(|error| error.mean),
            share(|error| error.p99),
            share(|error| error.max),
            share(|error| error.bias),
            color(|error| error.all),
            color(|error| error.in_focus),
            color(|error| error.near),
            color(|error| error.far),
            color(|error| error.beside),
            one.times.min_ms().into(),
            one.times.median_ms().into(),
            one.times.over(&tried[0].times).into(),
        ]);
    }
}
