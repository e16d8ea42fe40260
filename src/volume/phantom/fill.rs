//! The voxels of a field that is known everywhere.

use rayon::prelude::*;

use super::PhantomSpec;
use super::noise::add_gaussian;
use super::stored::{Stored, at_fraction, uniform, with_type};
use crate::error::Result;
use crate::volume::Voxels;

/// Every voxel from the field's fraction at its index, slices in parallel.
pub(super) fn sampled(
    spec: &PhantomSpec,
    fraction: impl Fn([u32; 3]) -> f64 + Sync,
) -> Result<Voxels> {
    fn of_type<T: Stored>(
        spec: &PhantomSpec,
        fraction: impl Fn([u32; 3]) -> f64 + Sync,
    ) -> Result<Vec<T>> {
        let [nx, ny, _] = spec.dims.usize();
        let values = spec.values();
        let mut voxels = uniform(spec.dims, T::nearest(values.min))?;
        voxels
            .par_chunks_mut(nx)
            .enumerate()
            .for_each(|(row, voxels)| {
                let (j, k) = ((row % ny) as u32, (row / ny) as u32);
                for (i, voxel) in (0..).zip(voxels) {
                    *voxel = at_fraction(values, fraction([i, j, k]));
                }
            });
        add_gaussian(spec, &mut voxels);
        Ok(voxels)
    }
    with_type!(spec.voxel_type, T => of_type::<T>(spec, fraction))
}
