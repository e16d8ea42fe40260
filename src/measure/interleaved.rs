//! Timings that can be compared although the machine is shared: every setting once a round.

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::frame::percentile;

/// What the repeats of one setting took.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// One a round, ms.
    rounds: Vec<f64>,
}

impl Times {
    /// 19 of 20 rounds take no longer than this, ms.
    pub fn p95_ms(&self) -> f64 {
        percentile(&mut self.rounds.clone(), 95).unwrap_or(f64::NAN)
    }

    /// What the setting takes when nothing else disturbs it.
    pub fn min_ms(&self) -> f64 {
        self.rounds.iter().copied().fold(f64::INFINITY, f64::min)
    }

    pub fn median_ms(&self) -> f64 {
        middle(self.rounds.clone())
    }

    /// How many times as long as `other`: the middle one of the rounds' own ratios, which what
    /// disturbs a whole round leaves as they are.
    pub fn over(&self, other: &Self) -> f64 {
        let rounds = self.rounds.iter().zip(&other.rounds);
        middle(rounds.map(|(own, other)| own / other).collect())
    }
}

/// The median, of an even number the upper of the two in the middle.
fn middle(mut entries: Vec<f64>) -> f64 {
    entries.sort_by(f64::total_cmp);
    entries.get(entries.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Runs each of `settings` once to warm up, then all of them in turn, `repeats` times (at least
/// once): what disturbs a round disturbs all settings alike. `once` gives a setting's ms.
///
/// # Errors
/// Those of `once`.
pub fn interleaved<S>(
    settings: &[S],
    repeats: usize,
    mut once: impl FnMut(&S) -> Result<f64>,
) -> Result<Vec<Times>> {
    let mut times = vec![Times { rounds: Vec::new() }; settings.len()];
    for round in 0..=repeats.max(1) {
        for (setting, times) in settings.iter().zip(&mut times) {
            let ms = once(setting)?;
            if round > 0 {
                times.rounds.push(ms);
            }
        }
    }
    Ok(times)
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
        assert_eq!((times[1].min_ms(), times[1].median_ms()), (4.0, 6.0));
        // Of 4/3, 6/5 and 8/7.
        assert!((times[1].over(&times[0]) - 1.2).abs() < 1e-12);
    }
}
