//! From a field between 0 and 1 to voxels of a type.

use rayon::prelude::*;

use super::PhantomSpec;
use super::noise::add_gaussian;
use crate::error::Result;
use crate::extent::{Dims, Range};
use crate::memory;
use crate::volume::{Voxel, VoxelType, Voxels};

/// A voxel type that real numbers are rounded to.
pub(super) trait Stored: Voxel {
    /// The nearest value the type has.
    fn nearest(value: f64) -> Self;
}

macro_rules! whole_numbers {
    ($($t:ty),*) => {$(
        impl Stored for $t {
            fn nearest(value: f64) -> Self {
                value.round() as $t
            }
        }
    )*};
}
whole_numbers!(u8, u16, i16);

impl Stored for f32 {
    fn nearest(value: f64) -> Self {
        value as f32
    }
}

/// The stored value of a `fraction` of the value range.
pub(super) fn at_fraction<T: Stored>(values: Range, fraction: f64) -> T {
    T::nearest(values.at(fraction))
}

/// Runs `$body` with `$t` bound to the Rust type of `$voxel_type`; gives `Result<Voxels>` where
/// the body gives `Result<Vec<$t>>`.
macro_rules! with_type {
    ($voxel_type:expr, $t:ident => $body:expr) => {
        match $voxel_type {
            $crate::volume::VoxelType::U8 => {
                type $t = u8;
                $body.map($crate::volume::Voxels::from)
            }
            $crate::volume::VoxelType::U16 => {
                type $t = u16;
                $body.map($crate::volume::Voxels::from)
            }
            $crate::volume::VoxelType::I16 => {
                type $t = i16;
                $body.map($crate::volume::Voxels::from)
            }
            $crate::volume::VoxelType::F32 => {
                type $t = f32;
                $body.map($crate::volume::Voxels::from)
            }
        }
    };
}
pub(super) use with_type;

/// `dims` voxels of one value.
///
/// # Errors
/// There is not enough memory.
pub(super) fn uniform<T: Stored>(dims: Dims, value: T) -> Result<Vec<T>> {
    let what = format_args!("a phantom of {dims} {} voxels", T::TYPE);
    memory::filled(dims.voxels() as usize, value, what)
}

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

/// Whether the type holds whole numbers only.
pub(super) fn is_whole(voxel_type: VoxelType) -> bool {
    voxel_type != VoxelType::F32
}
