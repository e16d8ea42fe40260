//! Values that part a volume in two: Otsu's threshold and the suggested iso value.

use super::Histogram;

impl Histogram {
    /// The edge between two bins that parts the values into the two classes with the greatest
    /// variance between them: N. Otsu, "A threshold selection method from gray-level histograms",
    /// IEEE Trans. SMC 9 (1979). Values at or above it are the upper class. Where all edges of a
    /// gap do equally well, the gap's middle one; where there is but one class, the range's
    /// middle.
    pub fn otsu(&self) -> f64 {
        let weights: Vec<f64> = self.counts.iter().map(|&count| count as f64).collect();
        match split(&weights) {
            Some(bin) => self.edge(bin),
            None => self.range.at(0.5),
        }
    }
}

/// A value at which the isosurface of an angiogram shows its vessels; a first guess.
///
/// Otsu's threshold over the counts to the power 3/4, so that the background, which outnumbers the
/// vessels a hundred to one, does not decide alone (tried on CT, MR and rotational angiograms: the
/// plain counts fall into soft tissue, the square roots lose faint vessels). Vessels fill a few
/// percent of a volume: where more than 15 % lies above, that threshold has found the body in the
/// air, and the upper part is split once more; the second threshold counts if it at least halves
/// what is above (a solid object of one value is left whole).
pub fn suggested_iso(histogram: &Histogram) -> f64 {
    const SOLID_SHARE: f64 = 0.15;
    let weights: Vec<f64> = histogram
        .counts
        .iter()
        .map(|&count| (count as f64).powf(0.75))
        .collect();
    let above = |bin: usize| histogram.counts[bin..].iter().sum::<u64>() as f64;
    let Some(first) = split(&weights) else {
        return histogram.range.at(0.5);
    };
    let second = split(&weights[first..])
        .map(|bin| first + bin)
        .filter(|&bin| above(bin) <= above(first) / 2.0);
    let is_solid = above(first) > SOLID_SHARE * histogram.total() as f64;
    histogram.edge(second.filter(|_| is_solid).unwrap_or(first))
}

/// The share of the values' variance that lies between the two classes of [`Histogram::otsu`], 0 to
/// 1: the better they are separated, the nearer to 1.
pub fn between_class_share(counts: &[u64]) -> f64 {
    let weights: Vec<f64> = counts.iter().map(|&count| count as f64).collect();
    let Some(upper) = split(&weights) else {
        return 0.0;
    };
    let mean = |bins: &[f64]| {
        let first_moment: f64 = bins.iter().zip(0..).map(|(w, i)| w * f64::from(i)).sum();
        first_moment / bins.iter().sum::<f64>()
    };
    let total: f64 = weights.iter().sum();
    let low = weights[..upper].iter().sum::<f64>() / total;
    let (all, below) = (mean(&weights), mean(&weights[..upper]));
    let above = upper as f64 + mean(&weights[upper..]);
    let scatter = |(bin, weight): (usize, &f64)| weight * (bin as f64 - all).powi(2);
    let variance = weights.iter().enumerate().map(scatter).sum::<f64>() / total;
    low * (1.0 - low) * (above - below).powi(2) / variance
}

/// The first bin of the upper of two classes with the greatest variance between them; `None` where
/// fewer than two bins are filled.
fn split(weights: &[f64]) -> Option<usize> {
    let total: f64 = weights.iter().sum();
    let first_moment: f64 = weights.iter().zip(0..).map(|(w, i)| w * f64::from(i)).sum();
    let (mut below, mut first_moment_below) = (0.0, 0.0);
    let (mut best, mut first, mut last) = (0.0, 0, 0);
    for (bin, &weight) in weights.iter().enumerate() {
        if below > 0.0 && below < total {
            let apart =
                first_moment_below / below - (first_moment - first_moment_below) / (total - below);
            let variance = below * (total - below) * apart * apart;
            if variance > best {
                (best, first) = (variance, bin);
            }
            if variance == best {
                last = bin;
            }
        }
        below += weight;
        first_moment_below += weight * bin as f64;
    }
    (best > 0.0).then_some((first + last).div_ceil(2))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{histogram, scrambled};
    use super::suggested_iso;

    #[test]
    fn otsu_parts_two_spikes_in_the_middle() {
        let mut counts = vec![0; 11];
        (counts[2], counts[8]) = (1000, 10);
        // Bins 2 and 8 end and begin at 3 and 8.
        let threshold = histogram(counts.clone()).otsu();
        assert!((5.0..=6.0).contains(&threshold), "{threshold}");
        // The check can fail: move a spike, and the threshold follows.
        counts.swap(2, 7);
        assert_eq!(histogram(counts).otsu(), 8.0);
    }

    /// Within-class variance of every threshold, from the values themselves.
    fn otsu_by_search(counts: &[u64]) -> usize {
        let values: Vec<(f64, f64)> = counts
            .iter()
            .enumerate()
            .map(|(i, &c)| (i as f64, c as f64))
            .collect();
        let scatter = |class: &[(f64, f64)]| {
            let n: f64 = class.iter().map(|&(_, c)| c).sum();
            let mean = class.iter().map(|&(v, c)| v * c).sum::<f64>() / n;
            class
                .iter()
                .map(|&(v, c)| c * (v - mean) * (v - mean))
                .sum::<f64>()
        };
        (1..counts.len())
            .min_by(|&a, &b| {
                let within = |cut: usize| scatter(&values[..cut]) + scatter(&values[cut..]);
                within(a).total_cmp(&within(b))
            })
            .unwrap()
    }

    #[test]
    fn otsu_finds_what_a_search_finds() {
        for round in 0..20 {
            let counts: Vec<u64> = scrambled(64 + round, 1000)
                .skip(round as usize)
                .map(|n| n + 1)
                .collect();
            let found = histogram(counts.clone()).otsu();
            assert_eq!(found, otsu_by_search(&counts) as f64);
            assert_ne!(found + 1.0, otsu_by_search(&counts) as f64);
        }
    }

    #[test]
    fn the_suggested_iso_finds_vessels_in_a_body_and_leaves_a_solid_whole() {
        // Air, a broad body, few bright vessels.
        let mut counts = vec![1_u64; 100];
        counts[0] = 700_000;
        counts[30..40].fill(30_000);
        counts[75..95].fill(200);
        let iso = suggested_iso(&histogram(counts.clone()));
        assert!((40.0..=75.0).contains(&iso), "{iso}");
        assert!(
            histogram(counts.clone()).otsu() < 35.0,
            "what Otsu alone would say"
        );
        // A solid of one value fills 30 %.
        let mut counts = vec![0; 100];
        (counts[0], counts[99]) = (700_000, 300_000);
        assert_eq!(suggested_iso(&histogram(counts)), 50.0);
    }
}
