//! Percentiles of a volume's values, by order statistics.

use super::tally::tally_in;
use super::{Volume, Voxels};

/// Values of a key's upper or lower half.
const HALF: usize = 1 << 16;

/// The physical value at the nearest rank of each of `percents` (0 to 100): the smallest voxel value
/// that at least so many percent of the voxels do not exceed. It is always the value of some voxel,
/// whatever the voxel type and however far away the extremes lie.
///
/// Nothing is sorted or copied: keys that are ordered as the values are counted by their upper 16
/// bits, then, where a key has more, those that share a wanted rank's upper half by their lower.
/// Each distinct upper half needs tables of 1 MiB per thread meanwhile.
pub fn percentiles(volume: &Volume, percents: &[f64]) -> Vec<f64> {
    let ranks: Vec<u64> = percents
        .iter()
        .map(|&percent| rank(percent, volume.dims().voxels()))
        .collect();
    let rescale = volume.rescale();
    let stored = stored_at_ranks(volume.voxels(), &ranks);
    stored.into_iter().map(|v| rescale.physical(v)).collect()
}

/// The stored values at ranks, each from 1 to the number of voxels.
pub(super) fn stored_at_ranks(voxels: &Voxels, ranks: &[u64]) -> Vec<f64> {
    let whole = |counts: Vec<u64>, first: f64| -> Vec<f64> {
        let stored = |&rank: &u64| first + at_rank(&counts, rank).0 as f64;
        ranks.iter().map(stored).collect()
    };
    match voxels {
        Voxels::U8(voxels) => whole(tally_in(voxels, 1 << 8, usize::from), 0.0),
        Voxels::U16(voxels) => whole(tally_in(voxels, HALF, usize::from), 0.0),
        Voxels::I16(voxels) => {
            let first = i32::from(i16::MIN);
            let key = |v| (i32::from(v) - first) as usize;
            whole(tally_in(voxels, HALF, key), f64::from(first))
        }
        Voxels::F32(voxels) => floats(voxels, ranks),
    }
}

/// The nearest rank of a percentile among `total` values, from 1.
fn rank(percent: f64, total: u64) -> u64 {
    let rank = (percent.clamp(0.0, 100.0) * total as f64 / 100.0).ceil() as u64;
    rank.clamp(1, total.max(1))
}

/// The key at a rank, and the rank among the voxels of that key.
fn at_rank(counts: &[u64], rank: u64) -> (usize, u64) {
    let mut below = 0;
    for (key, &count) in counts.iter().enumerate() {
        if below + count >= rank {
            return (key, rank - below);
        }
        below += count;
    }
    (counts.len() - 1, 1)
}

/// The values at the ranks: upper halves first, then the lower halves of those that were met.
fn floats(voxels: &[f32], ranks: &[u64]) -> Vec<f64> {
    let upper = |v: f32| (ordered(v) >> 16) as usize;
    let counts = tally_in(voxels, HALF, upper);
    let found: Vec<(usize, u64)> = ranks.iter().map(|&rank| at_rank(&counts, rank)).collect();
    let mut wanted: Vec<usize> = found.iter().map(|&(upper, _)| upper).collect();
    wanted.sort_unstable();
    wanted.dedup();
    // All other voxels share one key more.
    let others = wanted.len() * HALF;
    let mut first_key = vec![others; HALF];
    for (place, &upper) in wanted.iter().enumerate() {
        first_key[upper] = place * HALF;
    }
    let counts = tally_in(voxels, others + 1, |v: f32| match first_key[upper(v)] {
        first if first == others => others,
        first => first + (ordered(v) & 0xffff) as usize,
    });
    let value = |(upper, rank): (usize, u64)| {
        let first = first_key[upper];
        let (lower, _) = at_rank(&counts[first..first + HALF], rank);
        f64::from(float((upper << 16 | lower) as u32))
    };
    found.into_iter().map(value).collect()
}

/// The bits of a finite float as a number that is ordered as the floats are.
fn ordered(value: f32) -> u32 {
    let bits = value.to_bits();
    if bits >> 31 == 0 {
        bits | 1 << 31
    } else {
        !bits
    }
}

/// The float of an ordered key.
fn float(key: u32) -> f32 {
    f32::from_bits(if key >> 31 == 1 {
        key & !(1 << 31)
    } else {
        !key
    })
}

#[cfg(test)]
mod tests {
    use super::super::{Geometry, NonFinite, Rescale, Voxel};
    use super::*;
    use crate::extent::Dims;

    const PERCENTS: [f64; 9] = [0.0, 0.1, 1.0, 25.0, 50.0, 90.0, 99.0, 99.9, 100.0];

    fn volume(voxels: Voxels, rescale: Rescale) -> Volume {
        let dims = Dims::new([voxels.len() as u64, 1, 1]).unwrap();
        let geometry = Geometry::default();
        Volume::new(dims, voxels, geometry, rescale, NonFinite::Refuse).unwrap()
    }

    /// The percentiles by their definition: sorted, then looked up.
    fn by_sorting(values: &[f64], percents: &[f64]) -> Vec<f64> {
        let mut sorted = values.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let at = |percent: f64| {
            let min_count = percent * values.len() as f64 / 100.0;
            let enough = |&index: &usize| (index + 1) as f64 >= min_count;
            sorted[(0..values.len()).find(enough).unwrap()]
        };
        percents.iter().map(|&percent| at(percent)).collect()
    }

    fn check<T: Voxel>(voxels: Vec<T>)
    where
        Voxels: From<Vec<T>>,
    {
        let values: Vec<f64> = voxels.iter().map(|&v| v.into()).collect();
        let volume = volume(voxels.into(), Rescale::IDENTITY);
        assert_eq!(
            percentiles(&volume, &PERCENTS),
            by_sorting(&values, &PERCENTS),
            "{}",
            T::TYPE
        );
    }

    #[test]
    fn every_voxel_type_has_the_ranks_that_sorting_finds() {
        // Scrambled: multiples of an odd number modulo 2^16, of which a power leans to small ones.
        let scrambled: Vec<u16> = (0..40_000_u32)
            .map(|i| (i * 40_503 % 65_536) as u16)
            .collect();
        let lean = |v: &u16| (f64::from(*v) / 65_535.0).powi(6);
        check::<u16>(scrambled.clone());
        check::<u8>(scrambled.iter().map(|v| (v >> 8) as u8).collect());
        check::<i16>(scrambled.iter().map(|&v| v as i16).collect());
        check::<f32>(scrambled.iter().map(|v| (lean(v) - 0.2) as f32).collect());
        // A whole range of exponents, either sign; and values that share all their upper bits.
        check::<f32>(
            (scrambled.iter())
                .map(|&v| (-1.0_f32).powi(i32::from(v % 2)) * (f32::from(v) / 2000.0 - 16.0).exp2())
                .collect(),
        );
        check::<f32>(
            scrambled
                .iter()
                .map(|&v| 1.0 + f32::from(v) * 1e-7)
                .collect(),
        );
        check::<f32>(vec![-0.0, 0.0, -1.0]);
        check::<f32>(vec![7.0]);
    }

    #[test]
    fn one_extreme_voxel_moves_no_rank_but_its_own() {
        let mut values: Vec<f32> = (1..=1000).map(|i| i as f32 / 100.0).collect();
        let calm = volume(values.clone().into(), Rescale::IDENTITY);
        values[123] = 1e6;
        let wild = volume(values.into(), Rescale::IDENTITY);
        let of = |volume: &Volume| percentiles(volume, &[1.0, 50.0, 99.0, 100.0]);
        assert_eq!(of(&calm)[..3], [0.1, 5.0, 9.9].map(|v| f64::from(v as f32)));
        // Where that voxel was taken from the middle moves by one rank.
        assert_eq!(
            of(&wild)[..3],
            [0.1, 5.01, 9.91].map(|v| f64::from(v as f32))
        );
        // The control: the last rank is the extreme voxel's.
        assert_eq!(of(&wild)[3], 1e6);
    }

    #[test]
    fn values_are_physical_and_ranks_are_the_nearest() {
        // The textbook's list: 15, 20, 35, 40, 50.
        let rescale = Rescale {
            slope: 2.0,
            intercept: -1000.0,
        };
        let list = volume(vec![35_u8, 20, 15, 50, 40].into(), rescale);
        let found = percentiles(&list, &[0.0, 5.0, 30.0, 40.0, 40.1, 50.0, 100.0]);
        let stored = [15.0, 15.0, 20.0, 20.0, 35.0, 35.0, 50.0];
        assert_eq!(found, stored.map(|v| rescale.physical(v)));
    }
}
