//! Order statistics.

/// The `percent`-th percentile by nearest rank: the smallest entry that at least `percent` in a
/// hundred of the entries do not exceed, always an entry itself. `None` of nothing. Reorders
/// `entries`; NaN counts as largest.
pub fn percentile(entries: &mut [f64], percent: u8) -> Option<f64> {
    let rank = (entries.len() as u128 * u128::from(percent.min(100))).div_ceil(100);
    let index = (rank as usize).max(1) - 1;
    if entries.is_empty() {
        return None;
    }
    Some(*entries.select_nth_unstable_by(index, f64::total_cmp).1)
}

/// The middle one of an odd number of entries, the mean of the two in the middle of an even one. `None`
/// of nothing. Reorders `entries`; NaN counts as largest.
pub fn median(entries: &mut [f64]) -> Option<f64> {
    entries.sort_unstable_by(f64::total_cmp);
    let half = entries.len() / 2;
    match entries.len() % 2 {
        _ if entries.is_empty() => None,
        1 => Some(entries[half]),
        _ => Some(f64::midpoint(entries[half - 1], entries[half])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_ranks_of_one_to_a_hundred() {
        let mut entries: Vec<_> = (1..=100).rev().map(f64::from).collect();
        for (percent, expected) in [(0, 1.0), (1, 1.0), (50, 50.0), (99, 99.0), (100, 100.0)] {
            assert_eq!(percentile(&mut entries, percent), Some(expected));
        }
        entries.push(101.0);
        // ⌈0.99 · 101⌉ = 100. Interpolating between ranks would give a median of 50.5 above.
        assert_eq!(percentile(&mut entries, 99), Some(100.0));
    }

    #[test]
    fn medians_of_odd_and_even_numbers() {
        assert_eq!(median(&mut []), None);
        assert_eq!(median(&mut [7.0]), Some(7.0));
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), Some(2.0));
        // The nearest rank would give 2.
        assert_eq!(median(&mut [10.0, 1.0, 3.0, 2.0]), Some(2.5));
    }

    #[test]
    fn small_sets() {
        assert_eq!(percentile(&mut [], 99), None);
        assert_eq!(percentile(&mut [7.0], 99), Some(7.0));
        assert_eq!(percentile(&mut [3.0, 1.0, 2.0], 50), Some(2.0));
        assert_eq!(percentile(&mut [3.0, 1.0, 2.0, 9.0], 50), Some(2.0));
        assert!(percentile(&mut [f64::NAN, 1.0], 99).unwrap().is_nan());
    }
}
