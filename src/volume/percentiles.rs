//! Percentiles of a volume's values.

use rayon::prelude::*;

use super::{Volume, Voxels};

/// For each of `percents` (0 to 100) the physical value that the nearest rank has: the smallest value of
/// a voxel such that so many percent of the voxels are not above it.
pub fn percentiles(volume: &Volume, percents: &[f64]) -> Vec<f64> {
    let (counts, lowest) = match volume.voxels() {
        Voxels::U8(voxels) => (tally(voxels, |&v| usize::from(v)), 0.0),
        Voxels::U16(voxels) => (tally(voxels, |&v| usize::from(v)), 0.0),
        Voxels::I16(voxels) => (
            tally(voxels, |&v| (i32::from(v) - i32::from(i16::MIN)) as usize),
            f64::from(i16::MIN),
        ),
        Voxels::F32(voxels) => {
            let mut sorted = voxels.to_vec();
            sorted.par_sort_unstable_by(f32::total_cmp);
            let value = |percent: &f64| {
                let at = rank(sorted.len() as u64, *percent) - 1;
                volume.rescale().physical(f64::from(sorted[at as usize]))
            };
            return percents.iter().map(value).collect();
        }
    };
    let value = |percent: &f64| {
        let stored = lowest + nearest_rank(&counts, *percent) as f64;
        volume.rescale().physical(stored)
    };
    percents.iter().map(value).collect()
}

/// How often each of 2^16 keys occurs.
fn tally<T: Sync>(voxels: &[T], key: impl Fn(&T) -> usize + Sync) -> Vec<u64> {
    const KEYS: usize = 1 << 16;
    const CHUNK: usize = 1 << 22;
    let chunk = |voxels: &[T]| {
        let mut counts = vec![0; KEYS];
        voxels.iter().for_each(|voxel| counts[key(voxel)] += 1);
        counts
    };
    let sum = |mut a: Vec<u64>, b: Vec<u64>| {
        a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        a
    };
    voxels
        .par_chunks(CHUNK)
        .map(chunk)
        .reduce(|| vec![0; KEYS], sum)
}

/// Which of so many voxels in ascending order it is, from 1.
fn rank(total: u64, percent: f64) -> u64 {
    let rank = (percent.clamp(0.0, 100.0) / 100.0 * total as f64).ceil();
    (rank as u64).clamp(1, total.max(1))
}

fn nearest_rank(counts: &[u64], percent: f64) -> usize {
    let rank = rank(counts.iter().sum(), percent);
    let mut up_to = 0;
    let reached = counts.iter().position(|count| {
        up_to += count;
        up_to >= rank
    });
    reached.unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_rank_is_a_value_that_occurs() {
        // The textbook's list: 15, 20, 35, 40, 50.
        let counts = tally(&[35_u8, 20, 15, 50, 40], |&v| usize::from(v));
        for (percent, value) in [(5.0, 15), (30.0, 20), (40.0, 20), (50.0, 35), (100.0, 50)] {
            assert_eq!(nearest_rank(&counts, percent), value, "{percent}");
        }
        assert_eq!(nearest_rank(&counts, 0.0), 15);
        // The control: just above a rank the next value is reached.
        assert_eq!(nearest_rank(&counts, 40.1), 35);
    }
}
