//! Voxels in their own type, in memory or mapped from the file.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

use bytemuck::Pod;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::extent::Range;
use crate::memory;
use crate::volume::MappedFile;

/// A voxel type which the device reads as it is.
pub trait Voxel: Pod + Send + Sync + PartialOrd + Into<f64> {
    /// The type's tag.
    const TYPE: VoxelType;
}

impl Voxel for u8 {
    const TYPE: VoxelType = VoxelType::U8;
}
impl Voxel for u16 {
    const TYPE: VoxelType = VoxelType::U16;
}
impl Voxel for i16 {
    const TYPE: VoxelType = VoxelType::I16;
}
impl Voxel for f32 {
    const TYPE: VoxelType = VoxelType::F32;
}

/// The voxel types which the device reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum VoxelType {
    /// Unsigned 8-bit integers.
    U8,
    /// Unsigned 16-bit integers.
    U16,
    /// Signed 16-bit integers.
    I16,
    /// Single-precision floats.
    F32,
}

impl VoxelType {
    /// All voxel types.
    pub const ALL: [Self; 4] = [Self::U8, Self::U16, Self::I16, Self::F32];

    /// The type's name: `u8`, `u16`, `i16` or `f32`.
    pub fn name(self) -> &'static str {
        match self {
            Self::U8 => "u8",
            Self::U16 => "u16",
            Self::I16 => "i16",
            Self::F32 => "f32",
        }
    }

    /// The size of a voxel in bytes.
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::F32 => 4,
        }
    }
}

impl fmt::Display for VoxelType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// `len` voxels, owned or lying in a mapped file.
pub enum VoxelBuffer<T> {
    /// Voxels in memory of their own.
    Owned(Vec<T>),
    /// Voxels in a mapped file.
    Mapped(MappedVoxels),
}

/// Voxels in a mapped file: aligned, native-endian, checked to lie inside.
pub struct MappedVoxels {
    map: Arc<MappedFile>,
    offset: usize,
    bytes: usize,
}

impl<T: Voxel> VoxelBuffer<T> {
    /// `len` voxels at `offset` bytes of `map`; `None` when they are not aligned for T there (then
    /// copy). The file's endianness must be the machine's.
    ///
    /// # Errors
    /// The file ends before the last voxel.
    pub fn mapped(map: &Arc<MappedFile>, offset: usize, len: usize) -> Result<Option<Self>> {
        let bytes = len
            .checked_mul(size_of::<T>())
            .filter(|&bytes| offset.checked_add(bytes).is_some_and(|end| end <= map.len()))
            .ok_or_else(|| {
                Error::input(format!(
                    "{len} voxels of {} bytes announced from byte {offset} on, but the file has {} bytes",
                    size_of::<T>(),
                    map.len()
                ))
            })?;
        let aligned = bytemuck::try_cast_slice::<u8, T>(&map[offset..offset + bytes]).is_ok();
        Ok(aligned.then(|| {
            Self::Mapped(MappedVoxels {
                map: Arc::clone(map),
                offset,
                bytes,
            })
        }))
    }
}

impl<T: Voxel> Deref for VoxelBuffer<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        match self {
            Self::Owned(voxels) => voxels,
            Self::Mapped(m) => bytemuck::cast_slice(&m.map[m.offset..m.offset + m.bytes]),
        }
    }
}

impl<T> fmt::Debug for VoxelBuffer<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Owned(voxels) => write!(f, "{} voxels in memory", voxels.len()),
            Self::Mapped(m) => write!(f, "{} bytes of voxels in a mapped file", m.bytes),
        }
    }
}

/// A volume's voxels, x fastest.
#[derive(Debug)]
pub enum Voxels {
    /// Unsigned 8-bit integers.
    U8(VoxelBuffer<u8>),
    /// Unsigned 16-bit integers.
    U16(VoxelBuffer<u16>),
    /// Signed 16-bit integers.
    I16(VoxelBuffer<i16>),
    /// Single-precision floats.
    F32(VoxelBuffer<f32>),
}

/// Runs `$body` with `$slice` bound to the voxels as a slice of their own type.
#[macro_export]
macro_rules! with_voxels {
    ($voxels:expr, $slice:ident => $body:expr) => {
        match $voxels {
            $crate::volume::Voxels::U8(buffer) => {
                let $slice: &[u8] = buffer;
                $body
            }
            $crate::volume::Voxels::U16(buffer) => {
                let $slice: &[u16] = buffer;
                $body
            }
            $crate::volume::Voxels::I16(buffer) => {
                let $slice: &[i16] = buffer;
                $body
            }
            $crate::volume::Voxels::F32(buffer) => {
                let $slice: &[f32] = buffer;
                $body
            }
        }
    };
}

impl From<Vec<u8>> for Voxels {
    fn from(voxels: Vec<u8>) -> Self {
        Self::U8(VoxelBuffer::Owned(voxels))
    }
}
impl From<Vec<u16>> for Voxels {
    fn from(voxels: Vec<u16>) -> Self {
        Self::U16(VoxelBuffer::Owned(voxels))
    }
}
impl From<Vec<i16>> for Voxels {
    fn from(voxels: Vec<i16>) -> Self {
        Self::I16(VoxelBuffer::Owned(voxels))
    }
}
impl From<Vec<f32>> for Voxels {
    fn from(voxels: Vec<f32>) -> Self {
        Self::F32(VoxelBuffer::Owned(voxels))
    }
}

impl Voxels {
    /// The type of the voxels.
    pub fn voxel_type(&self) -> VoxelType {
        match self {
            Self::U8(_) => VoxelType::U8,
            Self::U16(_) => VoxelType::U16,
            Self::I16(_) => VoxelType::I16,
            Self::F32(_) => VoxelType::F32,
        }
    }

    /// The number of voxels.
    pub fn len(&self) -> usize {
        with_voxels!(self, slice => slice.len())
    }

    /// Whether there are no voxels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The voxels' bytes, native-endian.
    pub fn bytes(&self) -> &[u8] {
        with_voxels!(self, slice => bytemuck::cast_slice(slice))
    }

    /// The stored value of one voxel by its linear index.
    pub fn stored(&self, index: usize) -> f64 {
        with_voxels!(self, slice => slice[index].into())
    }

    /// The range of the finite values (`None` when there are none) and the count of the others.
    pub(super) fn scan(&self) -> (Option<Range>, u64) {
        fn chunk<T: Voxel>(voxels: &[T]) -> (f64, f64, u64) {
            let mut found = (f64::INFINITY, f64::NEG_INFINITY, 0);
            for &voxel in voxels {
                let value: f64 = voxel.into();
                if value.is_finite() {
                    found.0 = found.0.min(value);
                    found.1 = found.1.max(value);
                } else {
                    found.2 += 1;
                }
            }
            found
        }
        let (min, max, bad) = with_voxels!(self, slice => slice
        .par_chunks(1 << 16)
        .map(chunk)
        .reduce(
            || (f64::INFINITY, f64::NEG_INFINITY, 0),
            |a, b| (a.0.min(b.0), a.1.max(b.1), a.2 + b.2),
        ));
        ((min <= max).then_some(Range { min, max }), bad)
    }

    /// Applies `f` to every voxel of an f32 volume, where they lie if they may be written; other types
    /// have nothing to settle.
    ///
    /// # Errors
    /// Not enough memory for a copy of mapped voxels.
    pub(super) fn map_f32(&mut self, f: impl Fn(f32) -> f32 + Sync + Send) -> Result<()> {
        match self {
            Self::F32(VoxelBuffer::Owned(voxels)) => voxels.par_iter_mut().for_each(|v| *v = f(*v)),
            Self::F32(VoxelBuffer::Mapped(_)) => {
                *self = self.each_with(|v| f(v as f32))?.into();
            }
            _ => {}
        }
        Ok(())
    }

    /// Every voxel through `f`, in order.
    ///
    /// # Errors
    /// Not enough memory.
    pub(super) fn each_with<U: Send>(&self, f: impl Fn(f64) -> U + Sync + Send) -> Result<Vec<U>> {
        let what = format_args!("{} voxels of {} bytes", self.len(), size_of::<U>());
        with_voxels!(self, slice => memory::collected(slice.par_iter().map(|&v| f(v.into())), what))
    }
}
