//! Timings that can be compared although the machine is shared: every setting once a round.

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::frame::{median, percentile};

/// The times of the repeats of one setting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// The times, one a round, ms.
    rounds: Vec<f64>,
}

impl Times {
    /// The 95th percentile of the rounds, ms: 19 of 20 take no longer.
    pub fn p95_ms(&self) -> f64 {
        percentile(&mut self.rounds.clone(), 95).unwrap_or(f64::NAN)
    }

    /// The time of the fastest round, which was disturbed least, ms.
    pub fn min_ms(&self) -> f64 {
        self.rounds.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The median of the rounds, ms.
    pub fn median_ms(&self) -> f64 {
        median_of(self.rounds.iter().copied())
    }

    /// The median of the rounds' absolute deviations from their median, ms.
    pub fn mad_ms(&self) -> f64 {
        let median = self.median_ms();
        median_of(self.rounds.iter().map(|ms| (ms - median).abs()))
    }

    /// These rounds and then `later` ones.
    #[must_use]
    pub fn and(mut self, later: Self) -> Self {
        self.rounds.extend(later.rounds);
        self
    }

    /// The number of rounds.
    pub fn repeats(&self) -> usize {
        self.rounds.len()
    }

    /// How many times as long these rounds took as `other`: the median of the ratios of each round, which
    /// a disturbance of a whole round does not change.
    pub fn over(&self, other: &Self) -> f64 {
        let rounds = self.rounds.iter().zip(&other.rounds);
        median_of(rounds.map(|(own, other)| own / other))
    }
}

impl FromIterator<f64> for Times {
    fn from_iter<I: IntoIterator<Item = f64>>(rounds: I) -> Self {
        Self {
            rounds: rounds.into_iter().collect(),
        }
    }
}

/// The median; NaN of nothing.
fn median_of(entries: impl Iterator<Item = f64>) -> f64 {
    median(&mut entries.collect::<Vec<_>>()).unwrap_or(f64::NAN)
}

/// Runs each of `settings` once to warm up, then all of them in turn, `repeats` times (at least once): what
/// disturbs a round disturbs all settings alike.
///
/// Returns what `once` returned, one value a round for every setting, without the warm-up.
///
/// # Errors
/// Those of `once`.
pub fn rounds<S, T>(
    settings: &[S],
    repeats: usize,
    mut once: impl FnMut(&S) -> Result<T>,
) -> Result<Vec<Vec<T>>> {
    let mut results: Vec<Vec<T>> = settings.iter().map(|_| Vec::new()).collect();
    for round in 0..=repeats.max(1) {
        for (setting, of_setting) in settings.iter().zip(&mut results) {
            let one = once(setting)?;
            if round > 0 {
                of_setting.push(one);
            }
        }
    }
    Ok(results)
}

/// Times each of `settings` in [`rounds`]; `once` gives the time of one, ms.
///
/// # Errors
/// Those of `once`.
pub fn interleaved<S>(
    settings: &[S],
    repeats: usize,
    once: impl FnMut(&S) -> Result<f64>,
) -> Result<Vec<Times>> {
    let rounds = rounds(settings, repeats, once)?;
    Ok(rounds.into_iter().map(Times::from_iter).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_take_turns_and_the_first_round_does_not_count() {
        let mut order = Vec::new();
        let times = interleaved(&['a', 'b'], 3, |&setting| {
            order.push(setting);
            Ok(match order.len() {
                1 | 2 => 100.0,
                n => n as f64,
            })
        })
        .unwrap();
        assert_eq!(order.iter().collect::<String>(), "abababab");
        assert_eq!((times[0].min_ms(), times[0].median_ms()), (3.0, 5.0));
        // Of 2, 0 and 2.
        assert_eq!((times[0].mad_ms(), times[0].repeats()), (2.0, 3));
        assert_eq!((times[1].min_ms(), times[1].median_ms()), (4.0, 6.0));
        // Of 4/3, 6/5 and 8/7.
        assert!((times[1].over(&times[0]) - 1.2).abs() < 1e-12);
    }
}
