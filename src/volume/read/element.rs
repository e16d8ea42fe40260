//! What a file stores per voxel, and its way into a voxel type the device reads.

use std::fmt;
use std::io::{self, Read};

use half::f16;

use crate::error::{Error, Result};
use crate::memory;
use crate::progress::Progress;
use crate::volume::{Voxel, VoxelType, Voxels};

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

    /// The voxel type it is kept in.
    pub(super) fn voxel_type(self) -> VoxelType {
        match self {
            Self::U8 => VoxelType::U8,
            Self::U16 => VoxelType::U16,
            Self::I16 => VoxelType::I16,
            _ => VoxelType::F32,
        }
    }

    /// Whether the file's numbers are kept as they are.
    pub(super) fn is_kept(self) -> bool {
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
        self.scalar.is_kept() && (self.endian == Endian::NATIVE || self.scalar.bytes() == 1)
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

/// How many of the voxels a conversion to single precision has changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Loss {
    /// Voxels whose f32 differs from the file's number.
    pub(super) changed: u64,
    /// Of those, finite numbers beyond single precision's range, kept as ±3.4e38.
    pub(super) clamped: u64,
}

/// Reads up to the end of `buffer` or of the data; the count tells which.
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
/// are known to be there, so that all memory may be asked for at once.
///
/// # Errors
/// The data end early or are damaged; memory is short.
pub(super) fn read_voxels(
    reader: &mut dyn Read,
    element: Element,
    count: usize,
    certain: bool,
    progress: &dyn Progress,
) -> Result<(Voxels, Loss)> {
    let growth = Growth { count, certain };
    let kept = Loss::default();
    Ok(match element.scalar {
        Scalar::U8 => (
            read_kept::<u8>(reader, element, &growth, progress)?.into(),
            kept,
        ),
        Scalar::U16 => (
            read_kept::<u16>(reader, element, &growth, progress)?.into(),
            kept,
        ),
        Scalar::I16 => (
            read_kept::<i16>(reader, element, &growth, progress)?.into(),
            kept,
        ),
        Scalar::F32 => (
            read_kept::<f32>(reader, element, &growth, progress)?.into(),
            kept,
        ),
        _ => {
            let (voxels, loss) = read_converted(reader, element, &growth, progress)?;
            (voxels.into(), loss)
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

fn read_kept<T: Voxel>(
    reader: &mut dyn Read,
    element: Element,
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
        if element.endian != Endian::NATIVE {
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

fn read_converted(
    reader: &mut dyn Read,
    element: Element,
    growth: &Growth,
    progress: &dyn Progress,
) -> Result<(Vec<f32>, Loss)> {
    let size = element.scalar.bytes() as usize;
    let expected = growth.count as u64 * size as u64;
    let mut scratch = vec![0; CHUNK.min(growth.count.saturating_mul(size))];
    let mut voxels: Vec<f32> = Vec::new();
    let mut loss = Loss::default();
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
        convert(element, bytes, &mut voxels, &mut loss);
        progress.advance(wanted as u64);
    }
    Ok((voxels, loss))
}

/// Appends the numbers in `bytes` as f32.
fn convert(element: Element, bytes: &mut [u8], voxels: &mut Vec<f32>, loss: &mut Loss) {
    macro_rules! each {
        ($t:ty, $to_f32:expr) => {
            for number in bytes.chunks_exact_mut(size_of::<$t>()) {
                if element.endian != Endian::NATIVE {
                    number.reverse();
                }
                let number: $t = bytemuck::pod_read_unaligned(number);
                voxels.push($to_f32(number));
            }
        };
    }
    // i128 holds every integer type and every f32 that one of them rounds to.
    macro_rules! integers {
        ($t:ty) => {
            each!($t, |number: $t| {
                let single = number as f32;
                loss.changed += u64::from(single as i128 != i128::from(number));
                single
            })
        };
    }
    match element.scalar {
        Scalar::I8 => integers!(i8),
        Scalar::U32 => integers!(u32),
        Scalar::I32 => integers!(i32),
        Scalar::U64 => integers!(u64),
        Scalar::I64 => integers!(i64),
        Scalar::F16 => each!(u16, |bits| f16::from_bits(bits).to_f32()),
        Scalar::F64 => each!(f64, |number| single(number, loss)),
        Scalar::U8 | Scalar::U16 | Scalar::I16 | Scalar::F32 => {
            unreachable!("these types are kept, not converted")
        }
    }
}

fn single(number: f64, loss: &mut Loss) -> f32 {
    let single = number as f32;
    if f64::from(single) == number || number.is_nan() {
        return single;
    }
    loss.changed += 1;
    if single.is_infinite() {
        loss.clamped += 1;
        return f32::MAX.copysign(single);
    }
    single
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;

    fn read(scalar: Scalar, bytes: &[u8], count: usize) -> Result<(Vec<f64>, Loss)> {
        let element = Element {
            scalar,
            endian: Endian::Little,
        };
        let (voxels, loss) = read_voxels(&mut &bytes[..], element, count, false, &Silent)?;
        Ok(((0..count).map(|i| voxels.stored(i)).collect(), loss))
    }

    #[test]
    fn a_conversion_counts_what_it_changes() {
        let numbers: [i32; 3] = [16_777_216, 16_777_217, -5];
        let bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
        let (voxels, loss) = read(Scalar::I32, &bytes, 3).unwrap();
        assert_eq!(voxels, [16_777_216.0, 16_777_216.0, -5.0]);
        assert_eq!((loss.changed, loss.clamped), (1, 0));

        // The largest integers round up to a power of two just outside their type.
        let bytes = u64::MAX.to_le_bytes();
        assert_eq!(read(Scalar::U64, &bytes, 1).unwrap().1.changed, 1);
        let bytes = i64::MAX.to_le_bytes();
        assert_eq!(read(Scalar::I64, &bytes, 1).unwrap().1.changed, 1);
        let bytes = i64::MIN.to_le_bytes();
        assert_eq!(read(Scalar::I64, &bytes, 1).unwrap().1.changed, 0);
    }

    #[test]
    fn doubles_beyond_single_precision_are_clamped_and_infinities_kept() {
        let numbers = [1e300, -1e300, f64::INFINITY, 0.5, f64::NAN];
        let bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
        let (voxels, loss) = read(Scalar::F64, &bytes, 5).unwrap();
        let largest = f64::from(f32::MAX);
        assert_eq!(voxels[..4], [largest, -largest, f64::INFINITY, 0.5]);
        assert!(voxels[4].is_nan());
        assert_eq!((loss.changed, loss.clamped), (2, 2));
    }

    #[test]
    fn data_that_end_early_are_an_error_with_the_place() {
        let error = read(Scalar::U16, &[1, 0, 2, 0, 3], 3).unwrap_err();
        assert!(error.to_string().contains("after 5 of 6 bytes"), "{error}");
        assert!(read(Scalar::U16, &[1, 0, 2, 0, 3, 0], 3).is_ok());
    }
}
