//! Values of a field, between 0 and 1, as voxels of a type.

use crate::error::Result;
use crate::extent::{Dims, Range};
use crate::memory;
use crate::volume::{Voxel, VoxelType};

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

/// Whether the type holds whole numbers only.
pub(super) fn is_whole(voxel_type: VoxelType) -> bool {
    voxel_type != VoxelType::F32
}
