//! Which rows are worth their time.

use crate::lab::measure::{RankingMetric, Tradeoff, front};
use crate::scene::Mode;

use super::row::Row;

/// Marks the rows of a mode that are on its front, by each of its ranking metrics.
pub fn mark_front(mode: Mode, rows: &mut [Row]) {
    for metric in RankingMetric::of_mode(mode) {
        let point = |row: &Row| {
            let error = metric.of(row.error.as_ref()?)?;
            let time = row.frame_ms()?;
            Some(Tradeoff { time, error })
        };
        let placed: Vec<(usize, Tradeoff)> = (0..rows.len())
            .filter_map(|at| Some((at, point(&rows[at])?)))
            .collect();
        let points: Vec<Tradeoff> = placed.iter().map(|(_, point)| *point).collect();
        for ((at, _), on_front) in placed.iter().zip(front(&points)) {
            if on_front {
                rows[*at].on_front.push(metric.key);
            }
        }
    }
}
