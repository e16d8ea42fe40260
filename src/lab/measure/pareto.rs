//! Which settings are worth their time.

/// One setting: what it costs and how wrong it is; both finite and not negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tradeoff {
    /// The time of a frame, in any unit.
    pub time: f64,
    /// The error, in any unit; less is better.
    pub error: f64,
}

/// Times nearer to each other than this share are equal: which is what interleaved repeats on a
/// shared machine can resolve.
pub const TIME_NOISE: f64 = 0.1;

/// The Pareto front of `points`: for each, whether it is on it.
///
/// A point is on the front when no other is at most as wrong and as fast. Times are measured, so a
/// point must be faster by more than [`TIME_NOISE`] than all of the front that are less wrong; of points
/// equally wrong and, within the noise, equally fast, the first stands for all. Without this every
/// run would have another front, full of settings that are there by chance.
pub fn front(points: &[Tradeoff]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    // Stable: equal errors stay in the order given.
    order.sort_by(|&a, &b| points[a].error.total_cmp(&points[b].error));
    let mut on_front = vec![false; points.len()];
    let mut fastest = f64::INFINITY;
    for equally_wrong in order.chunk_by(|&a, &b| points[a].error == points[b].error) {
        let times = equally_wrong.iter().map(|&at| points[at].time);
        let best = times.fold(f64::INFINITY, f64::min);
        if best * (1.0 + TIME_NOISE) >= fastest {
            continue;
        }
        fastest = best;
        let as_fast = |&&at: &&usize| points[at].time <= best * (1.0 + TIME_NOISE);
        if let Some(&first) = equally_wrong.iter().find(as_fast) {
            on_front[first] = true;
        }
    }
    on_front
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(points: &[(f64, f64)]) -> Vec<usize> {
        let points: Vec<Tradeoff> = points
            .iter()
            .map(|&(time, error)| Tradeoff { time, error })
            .collect();
        let on_front = front(&points);
        (0..points.len()).filter(|&at| on_front[at]).collect()
    }

    #[test]
    fn what_is_slower_and_more_wrong_is_not_on_the_front() {
        assert_eq!(
            of(&[(1.0, 9.0), (2.0, 4.0), (3.0, 5.0), (4.0, 0.0)]),
            [0, 1, 3]
        );
        assert_eq!(of(&[]), [] as [usize; 0]);
        assert_eq!(of(&[(2.0, 0.0)]), [0]);
    }

    #[test]
    fn noise_makes_no_front() {
        // As fast within 10 %: the less wrong stands alone.
        assert_eq!(of(&[(1.00, 2.0), (1.08, 1.0)]), [1]);
        assert_eq!(of(&[(1.00, 2.0), (1.12, 1.0)]), [0, 1]);
        // Equally wrong: the first of those as fast as the fastest.
        assert_eq!(of(&[(1.2, 1.0), (1.08, 1.0), (1.0, 1.0)]), [1]);
    }

    #[test]
    fn no_point_off_the_front_is_clearly_better_than_one_on_it() {
        let points: Vec<Tradeoff> = (0..200_u32)
            .map(|i| Tradeoff {
                time: f64::from(i.wrapping_mul(2_654_435_761) % 97) + 1.0,
                error: f64::from(i.wrapping_mul(40_503) % 89),
            })
            .collect();
        let on_front = front(&points);
        let clearly_better = |a: &Tradeoff, b: &Tradeoff| {
            a.error <= b.error && a.time * (1.0 + TIME_NOISE).powi(2) < b.time
        };
        for (one, _) in points.iter().zip(&on_front).filter(|(_, on)| **on) {
            assert!(!points.iter().any(|other| clearly_better(other, one)));
        }
        for (one, _) in points.iter().zip(&on_front).filter(|(_, on)| !**on) {
            let beaten = points.iter().zip(&on_front).any(|(other, on)| {
                *on && other.error <= one.error
                    && other.time <= one.time * (1.0 + TIME_NOISE).powi(2)
            });
            assert!(beaten, "{one:?}");
        }
    }
}
