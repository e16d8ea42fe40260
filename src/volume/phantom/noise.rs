//! Noise: the same bytes for the same seed, whatever the thread count.

use rand::{Rng, RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::PhantomSpec;
use super::stored::{Stored, at_fraction, uniform, with_type};
use crate::error::Result;
use crate::volume::Voxels;

/// Uniform white noise: voxel number n (x fastest) takes the n-th draw of the generator.
pub(super) fn white(spec: &PhantomSpec) -> Result<(Voxels, String)> {
    fn of_type<T: Stored>(spec: &PhantomSpec) -> Result<Vec<T>> {
        let [nx, ny, _] = spec.dims.usize();
        let values = spec.values();
        let mut voxels = uniform(spec.dims, T::nearest(values.min))?;
        voxels
            .par_chunks_mut(nx * ny)
            .enumerate()
            .for_each(|(k, slice)| {
                let mut rng = Pcg64::seed_from_u64(spec.seed);
                rng.advance(k as u128 * (nx * ny) as u128);
                for voxel in slice {
                    // The upper 53 bits: every multiple of 2^-53 in [0, 1) equally likely.
                    let fraction = (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
                    *voxel = at_fraction(values, fraction);
                }
            });
        Ok(voxels)
    }
    let voxels = with_type!(spec.voxel_type, T => of_type::<T>(spec))?;
    let definition = format!(
        "the field is an independent, uniformly distributed number from 0 to 1 at every voxel (PCG64, seed {})",
        spec.seed
    );
    Ok((voxels, definition))
}

/// Adds Gaussian noise of `spec.noise` times the value range (nothing, where that is 0); slice k
/// draws from the generator's sequence from draw (k + 1) · 2^64 on, which does not overlap those of
/// other slices.
pub(super) fn add_gaussian<T: Stored>(spec: &PhantomSpec, voxels: &mut [T]) {
    if spec.noise == 0.0 {
        return;
    }
    let [nx, ny, _] = spec.dims.usize();
    let sigma = spec.noise * spec.values().width();
    voxels
        .par_chunks_mut(nx * ny)
        .enumerate()
        .for_each(|(k, slice)| {
            let mut rng = Pcg64::seed_from_u64(spec.seed);
            rng.advance((k as u128 + 1) << 64);
            for voxel in slice {
                let normal: f64 = rng.sample(StandardNormal);
                let value: f64 = (*voxel).into();
                *voxel = T::nearest(value + sigma * normal);
            }
        });
}
