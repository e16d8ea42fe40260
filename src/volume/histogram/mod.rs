//! The distribution of a volume's values, with the thresholds and the chart drawn from it.

mod chart;
mod threshold;

pub(super) use threshold::between_class_share;
pub use threshold::suggested_iso;

use super::tally::{tally, tally_in};
use crate::extent::Range;
use crate::volume::{Volume, Voxels};

/// Counts of physical values in equal bins over `range`; each bin holds its lower edge, the last
/// one its upper edge too. What lies beyond the range is counted in the first and the last bin. A
/// volume of one value lies in the first bin.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// The range of physical values that the bins divide.
    pub range: Range,
    /// The number of voxels in each bin.
    pub counts: Vec<u64>,
}

impl Histogram {
    /// `bins` bins (at least one) over the whole range of `volume`.
    pub fn of(volume: &Volume, bins: usize) -> Self {
        Self::within(volume, volume.stored_range(), bins)
    }

    /// `bins` bins (at least one) over a range of stored values. Exact for whole-number voxels: no
    /// rounding at the bins' edges.
    pub(super) fn within(volume: &Volume, stored: Range, bins: usize) -> Self {
        let bins = bins.max(1);
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
                    // A width of 0 makes this NaN, which casts to bin 0, as does what lies below.
                    (((f64::from(v) - stored.min) * scale) as usize).min(bins - 1)
                })
            }
        };
        let rescale = volume.rescale();
        Self {
            range: Range {
                min: rescale.physical(stored.min),
                max: rescale.physical(stored.max),
            },
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
}

/// The counts of single whole values (the first one's value is `first`) as bins over `stored`, in
/// whole-number arithmetic.
fn fold(tally: &[u64], first: i64, stored: Range, bins: usize) -> Vec<u64> {
    let (min, max) = (stored.min as i64, stored.max as i64);
    let width = (max - min).max(1) as u128;
    let mut counts = vec![0; bins];
    for (value, &count) in (first..).zip(tally) {
        if count > 0 {
            let above = (value - min).max(0);
            let bin = above as u128 * bins as u128 / width;
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
    pub(super) fn scrambled(count: u64, modulus: u64) -> impl Iterator<Item = u64> {
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

    /// Bins of width 1 from 0.
    pub(super) fn histogram(counts: Vec<u64>) -> Histogram {
        let range = Range {
            min: 0.0,
            max: counts.len() as f64,
        };
        Histogram { range, counts }
    }
}
