//! Student's t: how far a mean of few samples may be from the true one.

/// The share of cases in which an upper confidence limit holds.
pub const CONFIDENCE: f64 = 0.99;

/// The normal distribution's quantile at [`CONFIDENCE`].
const Z: f64 = 2.326_347_874_040_841;

/// The quantile of Student's distribution at [`CONFIDENCE`], of at least 3 degrees of freedom: the
/// first terms of its series in 1/ν (Abramowitz and Stegun 1964, 26.7.5), within 0.5 % of it.
pub fn quantile(degrees: usize) -> f64 {
    let nu = degrees as f64;
    let z = |k: i32| Z.powi(k);
    let terms = [
        Z,
        (z(3) + z(1)) / 4.0,
        (5.0 * z(5) + 16.0 * z(3) + 3.0 * z(1)) / 96.0,
        (3.0 * z(7) + 19.0 * z(5) + 17.0 * z(3) - 15.0 * z(1)) / 384.0,
        (79.0 * z(9) + 776.0 * z(7) + 1482.0 * z(5) - 1920.0 * z(3) - 945.0 * z(1)) / 92160.0,
    ];
    let term = |sum: f64, term: &f64| sum / nu + term;
    terms.iter().rev().fold(0.0, term)
}

/// A mean per pixel, from tiles that were drawn at random.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    pub mean: f64,
    /// How much greater the true one may be, at [`CONFIDENCE`].
    pub margin: f64,
}

impl Mean {
    /// The mean over tiles, each given as its sum and its number of pixels (a ratio estimate; Cochran
    /// 1977, §6.4). Neighbouring pixels are no independent samples; tiles are, and the fact that every
    /// stratum has its own only makes the margin too wide. The margin of too few tiles is infinite.
    pub fn of(tiles: &[(f64, usize)]) -> Self {
        let count = tiles.len();
        let pixels: f64 = tiles.iter().map(|&(_, pixels)| pixels as f64).sum();
        let total: f64 = tiles.iter().map(|&(sum, _)| sum).sum();
        if count < 4 {
            let mean = if count == 0 { 0.0 } else { total / pixels };
            return Self {
                mean,
                margin: f64::INFINITY,
            };
        }
        let mean = total / pixels;
        let squares = tiles.iter().map(|&(sum, pixels)| {
            let residual = sum - mean * pixels as f64;
            residual * residual
        });
        let degrees = count - 1;
        let variance = squares.sum::<f64>() / degrees as f64;
        let mean_pixels = pixels / count as f64;
        let deviation = (variance / count as f64).sqrt() / mean_pixels;
        Self {
            mean,
            margin: quantile(degrees) * deviation,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // NIST/SEMATECH e-Handbook of Statistical Methods, §1.3.6.7.2, column 0.99.
        for (degrees, t) in [
            (3, 4.541),
            (5, 3.365),
            (10, 2.764),
            (30, 2.457),
            (63, 2.387),
            (100, 2.364),
        ] {
            let got = quantile(degrees);
            assert!((got / t - 1.0).abs() < 5e-3, "{degrees}: {got} {t}");
        }
        // The control: the normal distribution's differs from all of them.
        assert!((Z / quantile(10) - 1.0).abs() > 0.1);
    }

    #[test]
    fn the_limit_holds_in_99_of_100_cases() {
        let mut rng = Pcg64::seed_from_u64(1);
        // The mean of twelve uniform numbers: nearly normal about 1/2.
        let mut sample = |count: usize| -> Vec<(f64, usize)> {
            let mut unit = || (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
            (0..count)
                .map(|_| ((0..12).map(|_| unit()).sum::<f64>(), 12))
                .collect()
        };
        let (mut held, mut held_by_mean) = (0, 0);
        const CASES: usize = 20_000;
        for _ in 0..CASES {
            let Mean { mean, margin } = Mean::of(&sample(8));
            held += usize::from(mean + margin >= 0.5);
            held_by_mean += usize::from(mean >= 0.5);
        }
        let share = held as f64 / CASES as f64;
        // Binomial: a standard deviation of 0.0007.
        assert!((share - 0.99).abs() < 0.003, "{share}");
        // The control: a mean alone is no limit.
        assert!((held_by_mean as f64 / CASES as f64) < 0.6);
    }

    #[test]
    fn few_tiles_and_unequal_ones() {
        assert_eq!(Mean::of(&[]).margin, f64::INFINITY);
        assert_eq!(Mean::of(&[(1.0, 2), (1.0, 2)]).mean, 0.5);
        // The same mean in tiles of all sizes: nothing is uncertain.
        let even = Mean::of(&[(2.0, 4), (32.0, 64), (16.0, 32), (4.0, 8)]);
        assert_eq!((even.mean, even.margin), (0.5, 0.0));
        let uneven = Mean::of(&[(2.0, 4), (32.0, 64), (16.0, 32), (0.0, 8)]);
        assert!(uneven.margin > 0.0);
    }
}
