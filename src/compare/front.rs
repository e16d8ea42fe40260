//! Which rows are worth their time.

use crate::measure::{Tradeoff, Wrongness, front};
use crate::scene::Mode;

use super::row::Row;

/// Marks a mode's rows that are on its front, by each way of telling how wrong its pictures are.
pub fn mark_front(mode: Mode, rows: &mut [Row]) {
    for wrongness in Wrongness::of_mode(mode) {
        let point = |row: &Row| {
            let error = wrongness.of(row.error.as_ref()?)?;
            let time = row.frame_ms()?;
            Some(Tradeoff { time, error })
        };
        let placed: Vec<(usize, Tradeoff)> = (0..rows.len())
            .filter_map(|at| Some((at, point(&rows[at])?)))
            .collect();
        let points: Vec<Tradeoff> = placed.iter().map(|(_, point)| *point).collect();
        for ((at, _), on_front) in placed.iter().zip(front(&points)) {
            if on_front {
                rows[*at].on_front.push(wrongness.key);
            }
        }
    }
}
