//! The distribution of a volume's values, and the thresholds read from it.

use rayon::prelude::*;

use super::{Volume, Voxel, Voxels};
use crate::extent::Range;

/// Counts of physical values in equal bins over `range`; each bin holds its lower edge, the last
/// one its upper edge too. A volume of one value lies in the first bin.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    pub range: Range,
    pub counts: Vec<u64>,
}

impl Histogram {
    /// `bins` bins (at least one) over the range of `volume`. Exact for whole-number voxels: no
    /// rounding at the bins' edges.
    pub fn of(volume: &Volume, bins: usize) -> Self {
        let bins = bins.max(1);
        let stored = volume.stored_range();
        let counts = match volume.voxels() {
            Voxels::U8(voxels) => fold(&tally(voxels, usize::from), 0, stored, bins),
            Voxels::U16(voxels) => fold(&tally(voxels, usize::from), 0, stored, bins),
            Voxels::I16(voxels) => fold(
                &tally(voxels, |v| (i32::from(v) - i32::from(i16::MIN)) as usize),
                i64::from(i16::MIN),
                stored,
                bins,
            ),
            Voxels::F32(voxels) => {
                let scale = bins as f64 / stored.width();
                tally_in(voxels, bins, |v: f32| {
                    // A width of 0 makes this NaN, which casts to bin 0.
                    (((f64::from(v) - stored.min) * scale) as usize).min(bins - 1)
                })
            }
        };
        Self {
            range: volume.range(),
            counts,
        }
    }

    /// The number of voxels.
    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// The lower edge of bin `bin`; of bin N, the upper edge of the last.
    pub fn edge(&self, bin: usize) -> f64 {
        self.range.at(bin as f64 / self.counts.len() as f64)
    }

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

    /// The value below which `percent` (0 to 100) of the voxels lie, values taken as evenly spread
    /// within their bin.
    pub fn percentile(&self, percent: f64) -> f64 {
        let wanted = percent.clamp(0.0, 100.0) / 100.0 * self.total() as f64;
        let mut below = 0.0;
        for (bin, &count) in self.counts.iter().enumerate() {
            let count = count as f64;
            if count > 0.0 && below + count >= wanted {
                let (lo, hi) = (self.edge(bin), self.edge(bin + 1));
                return lo + (hi - lo) * ((wanted - below) / count).max(0.0);
            }
            below += count;
        }
        self.range.max
    }

    /// A bar chart of `width` columns (at least 40), up to 16 lines, each with the lower edge of
    /// its values, their share of the voxels, and a bar as long as the logarithm of their count:
    /// sparse volumes are nearly all background.
    pub fn text(&self, width: usize) -> String {
        const LINES: usize = 16;
        const LABELS: usize = 24;
        let group = self.counts.len().div_ceil(LINES);
        let sums: Vec<u64> = self.counts.chunks(group).map(|c| c.iter().sum()).collect();
        let height = |count: u64| (1.0 + count as f64).ln();
        let tallest = sums.iter().map(|&sum| height(sum)).fold(1.0, f64::max);
        let room = (width.max(40) - LABELS) as f64;
        let total = self.total().max(1) as f64;
        let mut text = String::new();
        for (line, &sum) in sums.iter().enumerate() {
            let bar = "█".repeat((room * height(sum) / tallest).round() as usize);
            let share = format!("{:.3}%", 100.0 * sum as f64 / total);
            let edge = short(self.edge(line * group), self.range);
            text.push_str(format!("{edge:>12} {share:>9}  {bar}").trim_end());
            text.push('\n');
        }
        text
    }
}

/// `value` with as many decimals as tell 1/1000 of the range apart.
fn short(value: f64, range: Range) -> String {
    let decimals = if range.width() > 0.0 {
        (3.0 - range.width().log10()).ceil().clamp(0.0, 9.0) as usize
    } else {
        3
    };
    let magnitude = range.min.abs().max(range.max.abs());
    if magnitude >= 1e9 || (magnitude > 0.0 && magnitude < 1e-6) {
        format!("{value:.3e}")
    } else {
        format!("{value:.decimals$}")
    }
}

/// A value at which the isosurface of an angiogram shows its vessels; a first guess.
///
/// Otsu's threshold over the counts to the power 3/4, so that the background, which outnumbers the
/// vessels a hundred to one, does not decide alone (tried on CT, MR and rotational angiograms: the
/// plain counts fall into soft tissue, the square roots lose faint vessels). Vessels fill a few percent of a volume:
/// where more than 15 % lies above, that threshold has found the body in the air, and the upper
/// part is split once more; the second threshold counts if it at least halves what is above (a
/// solid object of one value is left whole).
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

/// The first bin of the upper of two classes with the greatest variance between them; `None` where
/// fewer than two bins are filled.
fn split(weights: &[f64]) -> Option<usize> {
    let total: f64 = weights.iter().sum();
    let moment: f64 = weights.iter().zip(0..).map(|(w, i)| w * f64::from(i)).sum();
    let (mut below, mut moment_below) = (0.0, 0.0);
    let (mut best, mut first, mut last) = (0.0, 0, 0);
    for (bin, &weight) in weights.iter().enumerate() {
        if below > 0.0 && below < total {
            let apart = moment_below / below - (moment - moment_below) / (total - below);
            let variance = below * (total - below) * apart * apart;
            if variance > best {
                (best, first) = (variance, bin);
            }
            if variance == best {
                last = bin;
            }
        }
        below += weight;
        moment_below += weight * bin as f64;
    }
    (best > 0.0).then_some((first + last).div_ceil(2))
}

/// How often each stored value occurs, by its key.
fn tally<T: Voxel>(voxels: &[T], key: impl Fn(T) -> usize + Sync) -> Vec<u64> {
    tally_in(voxels, 1 << (8 * size_of::<T>()), key)
}

fn tally_in<T: Voxel>(voxels: &[T], keys: usize, key: impl Fn(T) -> usize + Sync) -> Vec<u64> {
    // Four tables by turns: runs of one value, such as background, would otherwise wait for their
    // own last increment. Chunks are long against a table of 2^16 counts.
    const TABLES: usize = 4;
    voxels
        .par_chunks(1 << 22)
        .map(|chunk| {
            let mut tables = vec![0_u32; TABLES * keys];
            for quad in chunk.chunks(TABLES) {
                for (table, &voxel) in quad.iter().enumerate() {
                    tables[table * keys + key(voxel)] += 1;
                }
            }
            let mut counts = vec![0_u64; keys];
            for table in tables.chunks_exact(keys) {
                for (count, &more) in counts.iter_mut().zip(table) {
                    *count += u64::from(more);
                }
            }
            counts
        })
        .reduce(
            || vec![0; keys],
            |mut sum, part| {
                for (sum, part) in sum.iter_mut().zip(part) {
                    *sum += part;
                }
                sum
            },
        )
}

/// The counts of single whole values (the first one's value is `first`) as bins over `stored`, in
/// whole-number arithmetic.
fn fold(tally: &[u64], first: i64, stored: Range, bins: usize) -> Vec<u64> {
    let (min, max) = (stored.min as i64, stored.max as i64);
    let width = (max - min).max(1) as u128;
    let mut counts = vec![0; bins];
    for (value, &count) in (first..).zip(tally) {
        if count > 0 {
            let bin = (value - min) as u128 * bins as u128 / width;
            counts[(bin as usize).min(bins - 1)] += count;
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extent::Dims;
    use crate::volume::{Geometry, NonFinite, Rescale};

    fn volume(voxels: impl Into<Voxels>, rescale: Rescale) -> Volume {
        let voxels = voxels.into();
        let dims = Dims::new([voxels.len() as u64, 1, 1]).unwrap();
        Volume::new(
            dims,
            voxels,
            Geometry::default(),
            rescale,
            NonFinite::Refuse,
        )
        .unwrap()
    }

    /// Whole numbers of a sequence without a pattern.
    fn scrambled(count: u64, modulus: u64) -> impl Iterator<Item = u64> {
        (1..=count)
            .map(move |n| n.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 20)
            .map(move |n| n % modulus)
    }

    /// Bin by bin, from each bin's definition in whole numbers.
    fn by_definition(values: &[i64], bins: i64) -> Vec<u64> {
        let (min, max) = (*values.iter().min().unwrap(), *values.iter().max().unwrap());
        let mut counts = vec![0; bins as usize];
        for &value in values {
            let bin = (0..bins)
                .rev()
                .find(|&bin| (value - min) * bins >= bin * (max - min))
                .unwrap();
            counts[bin as usize] += 1;
        }
        counts
    }

    #[test]
    fn whole_number_histograms_are_exact() {
        for bins in [1, 7, 100, 256, 1000] {
            let i16s: Vec<i16> = scrambled(5000, 3001).map(|n| n as i16 - 1500).collect();
            let u8s: Vec<u8> = scrambled(5000, 251).map(|n| n as u8 + 3).collect();
            let u16s: Vec<u16> = scrambled(5000, 60_000).map(|n| n as u16).collect();
            let wide = |v: &[i16]| v.iter().map(|&v| i64::from(v)).collect::<Vec<_>>();
            let expected = by_definition(&wide(&i16s), bins);
            let of = |voxels: Voxels| {
                Histogram::of(&volume(voxels, Rescale::IDENTITY), bins as usize).counts
            };
            assert_eq!(of(i16s.clone().into()), expected);
            let expected =
                by_definition(&u8s.iter().map(|&v| i64::from(v)).collect::<Vec<_>>(), bins);
            assert_eq!(of(u8s.into()), expected);
            let expected = by_definition(
                &u16s.iter().map(|&v| i64::from(v)).collect::<Vec<_>>(),
                bins,
            );
            assert_eq!(of(u16s.into()), expected);
            // The check can fail: one voxel more.
            let mut more = i16s;
            more.push(0);
            assert_ne!(
                of(more.clone().into()),
                by_definition(&wide(&more[..5000]), bins)
            );
        }
    }

    #[test]
    fn floats_and_calibrated_values_are_counted_in_physical_units() {
        let floats = volume(vec![0.0_f32, 0.25, 0.5, 0.99, 1.0], Rescale::IDENTITY);
        assert_eq!(Histogram::of(&floats, 2).counts, [2, 3]);
        assert_ne!(Histogram::of(&floats, 2).counts, [3, 2]);
        let hounsfield = Rescale {
            slope: 2.0,
            intercept: -1000.0,
        };
        let calibrated = volume(vec![0_u8, 100], hounsfield);
        let histogram = Histogram::of(&calibrated, 4);
        assert_eq!(
            histogram.range,
            Range {
                min: -1000.0,
                max: -800.0
            }
        );
        assert_eq!(histogram.counts, [1, 0, 0, 1]);
        assert_eq!(histogram.edge(1), -950.0);
        let uniform = volume(vec![3.0_f32; 9], Rescale::IDENTITY);
        assert_eq!(Histogram::of(&uniform, 4).counts, [9, 0, 0, 0]);
        assert_eq!(Histogram::of(&uniform, 4).otsu(), 3.0);
        assert_eq!(suggested_iso(&Histogram::of(&uniform, 4)), 3.0);
    }

    fn histogram(counts: Vec<u64>) -> Histogram {
        let range = Range {
            min: 0.0,
            max: counts.len() as f64,
        };
        Histogram { range, counts }
    }

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
    fn percentiles_follow_the_counts() {
        let h = histogram(vec![90, 0, 5, 5]);
        assert_eq!(h.percentile(0.0), 0.0);
        assert_eq!(h.percentile(45.0), 0.5);
        assert_eq!(h.percentile(90.0), 1.0);
        assert!((h.percentile(92.5) - 2.5).abs() < 1e-12);
        assert_eq!(h.percentile(100.0), 4.0);
        assert_ne!(
            h.percentile(45.0),
            histogram(vec![90, 0, 5, 500]).percentile(45.0)
        );
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

    #[test]
    fn the_chart_keeps_to_its_width() {
        let chart = histogram((0..256).map(|n| n * n).collect()).text(72);
        assert_eq!(chart.lines().count(), 16);
        let longest = |chart: &str| chart.lines().map(|line| line.chars().count()).max();
        assert_eq!(longest(&chart), Some(72));
        assert!(longest(&histogram(vec![1; 3]).text(100)) > Some(72));
        assert_eq!(histogram(vec![0]).text(0).lines().count(), 1);
    }
}
