//! What a file stores per voxel, and its conversion to a voxel type the device reads.

use std::fmt;
use std::io::{self, Read};

use half::f16;

use super::narrow::narrow;
use crate::error::{Error, Result};
use crate::memory;
use crate::progress::Progress;
use crate::volume::{Rescale, Voxel, VoxelType, Voxels};

/// The number types that files store.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F16,
    F32,
    F64,
}

impl Scalar {
    pub(super) fn bytes(self) -> u64 {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 | Self::F16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::U8 => "u8",
            Self::I8 => "i8",
            Self::U16 => "u16",
            Self::I16 => "i16",
            Self::U32 => "u32",
            Self::I32 => "i32",
            Self::U64 => "u64",
            Self::I64 => "i64",
            Self::F16 => "f16",
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }

    /// The voxel type that holds it.
    pub(super) fn voxel_type(self) -> VoxelType {
        match self {
            Self::U8 => VoxelType::U8,
            Self::U16 => VoxelType::U16,
            Self::I16 => VoxelType::I16,
            _ => VoxelType::F32,
        }
    }

    /// Whether the file's numbers are stored unchanged.
    pub(super) fn is_exact(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::I16 | Self::F32)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Endian {
    Little,
    Big,
}

impl Endian {
    pub(super) const NATIVE: Self = if cfg!(target_endian = "big") {
        Self::Big
    } else {
        Self::Little
    };
}

/// A number type in a byte order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) scalar: Scalar,
    pub(super) endian: Endian,
}

impl Element {
    pub(super) fn native(scalar: Scalar) -> Self {
        Self {
            scalar,
            endian: Endian::NATIVE,
        }
    }

    /// Whether the bytes can be used where they lie.
    pub(super) fn is_usable_in_place(self) -> bool {
        self.scalar.is_exact() && (self.endian == Endian::NATIVE || self.scalar.bytes() == 1)
    }
}

/// `u16be`: the order is named where it matters.
impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.scalar.name())?;
        match self.endian {
            _ if self.scalar.bytes() == 1 => Ok(()),
            Endian::Little => f.write_str("le"),
            Endian::Big => f.write_str("be"),
        }
    }
}

/// The changes that a conversion to single precision has made.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Loss {
    /// Voxels whose number differs from the file's.
    pub(super) changed: u64,
    /// The number of finite numbers among them that lie beyond single precision's range and are stored
    /// as ±3.4e38.
    pub(super) clamped: u64,
    /// The greatest difference among the others, in the file's numbers.
    pub(super) largest: f64,
    /// The width of the range of the file's finite numbers.
    pub(super) width: f64,
}

/// Voxels as they are stored: the file's number is `rescale.physical(stored)`.
pub(super) struct Converted {
    pub(super) voxels: Voxels,
    pub(super) rescale: Rescale,
    pub(super) loss: Loss,
}

impl<T> From<Vec<T>> for Converted
where
    Voxels: From<Vec<T>>,
{
    /// Takes the file's own numbers.
    fn from(voxels: Vec<T>) -> Self {
        Self {
            voxels: voxels.into(),
            rescale: Rescale::IDENTITY,
            loss: Loss::default(),
        }
    }
}

/// Reads up to the end of `buffer` or of the data; the count says which.
fn read_full(reader: &mut dyn Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        match reader.read(&mut buffer[filled..]) {
            Ok(0) => break,
            Ok(n) => filled += n,
            Err(cause) if cause.kind() == io::ErrorKind::Interrupted => {}
            Err(cause) => return Err(cause),
        }
    }
    Ok(filled)
}

/// Data of a size that only their end proves: memory grows with what really arrives.
struct Growth {
    count: usize,
    certain: bool,
}

impl Growth {
    const FIRST: usize = 1 << 20;

    /// Makes room in `voxels`, at most doubling it, unless the whole count is certain to come.
    fn make_room<T>(&self, voxels: &mut Vec<T>) -> Result<()> {
        if voxels.len() < voxels.capacity() {
            return Ok(());
        }
        let target = if self.certain {
            self.count
        } else {
            self.count
                .min(voxels.len().saturating_mul(2).max(Self::FIRST))
        };
        let what = format_args!("{} voxels", self.count);
        memory::make_room(voxels, target - voxels.len(), what)
    }
}

/// Bytes read at a time.
const CHUNK: usize = 1 << 18;

/// `count` voxels from the reader, straight into their final place. `certain` says that the bytes
/// are known to be there, so that all memory may be allocated at once.
///
/// # Errors
/// The data end early or are damaged; memory is short.
pub(super) fn read_voxels(
    reader: &mut dyn Read,
    element: Element,
    count: usize,
    certain: bool,
    progress: &dyn Progress,
) -> Result<Converted> {
    let growth = Growth { count, certain };
    let endian = element.endian;
    Ok(match element.scalar {
        Scalar::U8 => read_unconverted::<u8>(reader, endian, &growth, progress)?.into(),
        Scalar::U16 => read_unconverted::<u16>(reader, endian, &growth, progress)?.into(),
        Scalar::I16 => read_unconverted::<i16>(reader, endian, &growth, progress)?.into(),
        Scalar::F32 => read_unconverted::<f32>(reader, endian, &growth, progress)?.into(),
        Scalar::I8 | Scalar::F16 => read_converted(reader, element, &growth, progress)?.into(),
        Scalar::U32 | Scalar::I32 | Scalar::U64 | Scalar::I64 | Scalar::F64 => {
            // As they lie in the file, in the memory in which they are then narrowed.
            let singles = element.scalar.bytes() as usize / size_of::<f32>();
            let count = count.checked_mul(singles).ok_or_else(|| {
                Error::resource(format!("{count} voxels do not fit this machine's memory"))
            })?;
            let growth = Growth { count, certain };
            let raw = read_unconverted::<f32>(reader, Endian::NATIVE, &growth, progress)?;
            narrow(raw, element)
        }
    })
}

fn ended_early(read: u64, expected: u64) -> Error {
    Error::input(format!(
        "the voxels end after {read} of {expected} bytes: the file is cut off or its header wrong"
    ))
}

fn damaged(cause: &io::Error, read: u64, expected: u64) -> Error {
    if cause.kind() == io::ErrorKind::UnexpectedEof {
        return ended_early(read, expected);
    }
    Error::input(format!(
        "the voxels cannot be read past byte {read} of {expected}: {cause}"
    ))
}

fn read_unconverted<T: Voxel>(
    reader: &mut dyn Read,
    endian: Endian,
    growth: &Growth,
    progress: &dyn Progress,
) -> Result<Vec<T>> {
    let expected = growth.count as u64 * size_of::<T>() as u64;
    let mut voxels: Vec<T> = Vec::new();
    while voxels.len() < growth.count {
        growth.make_room(&mut voxels)?;
        let start = voxels.len();
        let end = voxels
            .capacity()
            .min(growth.count)
            .min(start + CHUNK / size_of::<T>());
        voxels.resize(end, T::zeroed());
        let done = (start * size_of::<T>()) as u64;
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut voxels[start..]);
        let wanted = bytes.len();
        let got = read_full(reader, bytes).map_err(|cause| damaged(&cause, done, expected))?;
        if got < wanted {
            return Err(ended_early(done + got as u64, expected));
        }
        if endian != Endian::NATIVE {
            swap_bytes(&mut voxels[start..]);
        }
        progress.advance(wanted as u64);
    }
    Ok(voxels)
}

fn swap_bytes<T: Voxel>(voxels: &mut [T]) {
    let bytes: &mut [u8] = bytemuck::cast_slice_mut(voxels);
    for voxel in bytes.chunks_exact_mut(size_of::<T>()) {
        voxel.reverse();
    }
}

/// Numbers of types that single precision holds wholly.
fn read_converted(
    reader: &mut dyn Read,
    element: Element,
    growth: &Growth,
    progress: &dyn Progress,
) -> Result<Vec<f32>> {
    let size = element.scalar.bytes() as usize;
    let expected = growth.count as u64 * size as u64;
    let mut scratch = vec![0; CHUNK.min(growth.count.saturating_mul(size))];
    let mut voxels: Vec<f32> = Vec::new();
    while voxels.len() < growth.count {
        growth.make_room(&mut voxels)?;
        let room = voxels.capacity().min(growth.count) - voxels.len();
        let wanted = (scratch.len() / size).min(room) * size;
        let done = (voxels.len() * size) as u64;
        let bytes = &mut scratch[..wanted];
        let got = read_full(reader, bytes).map_err(|cause| damaged(&cause, done, expected))?;
        if got < wanted {
            return Err(ended_early(done + got as u64, expected));
        }
        let half = |pair: &[u8]| match element.endian {
            Endian::Little => f16::from_le_bytes([pair[0], pair[1]]),
            Endian::Big => f16::from_be_bytes([pair[0], pair[1]]),
        };
        match element.scalar {
            Scalar::F16 => voxels.extend(bytes.chunks_exact(2).map(|pair| half(pair).to_f32())),
            _ => voxels.extend(bytes.iter().map(|&byte| f32::from(byte.cast_signed()))),
        }
        progress.advance(wanted as u64);
    }
    Ok(voxels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;

    fn read(scalar: Scalar, bytes: &[u8], count: usize) -> Result<Vec<f64>> {
        let element = Element {
            scalar,
            endian: Endian::Little,
        };
        let converted = read_voxels(&mut &bytes[..], element, count, false, &Silent)?;
        Ok((0..count).map(|i| converted.voxels.stored(i)).collect())
    }

    #[test]
    fn small_numbers_become_single_precision() {
        assert_eq!(
            read(Scalar::I8, &[0, 127, 128, 255], 4).unwrap(),
            [0.0, 127.0, -128.0, -1.0]
        );
        let halves = [0x00, 0x3c, 0x01, 0xc0];
        assert_eq!(
            read(Scalar::F16, &halves, 2).unwrap(),
            [1.0, f64::from(f16::from_bits(0xc001))]
        );
    }

    #[test]
    fn data_that_end_early_are_an_error_with_the_place() {
        let error = read(Scalar::U16, &[1, 0, 2, 0, 3], 3).unwrap_err();
        assert!(error.to_string().contains("after 5 of 6 bytes"), "{error}");
        assert!(read(Scalar::U16, &[1, 0, 2, 0, 3, 0], 3).is_ok());
    }
}
