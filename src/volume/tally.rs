//! How often each value of a volume occurs.

use rayon::prelude::*;

use super::Voxel;

/// How often each stored value of at most 16 bits occurs, by its key.
pub fn tally<T: Voxel>(voxels: &[T], key: impl Fn(T) -> usize + Sync) -> Vec<u64> {
    tally_in(voxels, 1 << (8 * size_of::<T>()), key)
}

/// How often each of `keys` keys occurs; `key` returns a voxel's.
pub fn tally_in<T: Voxel>(voxels: &[T], keys: usize, key: impl Fn(T) -> usize + Sync) -> Vec<u64> {
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
