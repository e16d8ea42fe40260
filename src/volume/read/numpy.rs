//! NumPy arrays: .npy. An array is indexed z, y, x, a series frame, z, y, x, whatever order its
//! numbers lie in (C or Fortran), as all of Python's imaging does.
//!
//! Source: the docstring of numpy.lib.format, versions 1.0 to 3.0.

use std::io::Read;

use rayon::prelude::*;

use super::Request;
use super::array::{Array, refuse_components};
use super::element::{Element, Endian, Scalar};
use super::frames::Frames;
use super::payload::Payload;
use super::source::Source;
use crate::error::{Error, Result};
use crate::extent::Dims;
use crate::memory;
use crate::volume::{Geometry, Rescale, Volume, Voxel};
use crate::with_voxels;

const MAGIC: &[u8] = b"\x93NUMPY";

/// The longest header: NumPy itself reads no longer one by default.
const LONGEST_HEADER: usize = 10_000;

/// The most axes: NumPy's own limit.
const MAX_AXES: usize = 64;

pub(super) fn is_npy(head: &[u8]) -> bool {
    head.starts_with(MAGIC)
}

/// The header that precedes an array's numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header {
    descr: String,
    fortran_order: bool,
    pub(super) shape: Vec<u64>,
}

impl Header {
    /// Takes the header off the payload.
    ///
    /// # Errors
    /// It is no .npy header, cut off, or of an unknown version.
    pub(super) fn take(payload: Payload) -> Result<(Self, Payload)> {
        match payload {
            Payload::Mapped(mut bytes) => {
                let header = Self::read(&mut bytes)?;
                Ok((header, Payload::Mapped(bytes)))
            }
            Payload::Stream {
                mut reader,
                max_bytes,
            } => {
                let header = Self::read(&mut reader)?;
                Ok((header, Payload::Stream { reader, max_bytes }))
            }
        }
    }

    fn read(reader: &mut dyn Read) -> Result<Self> {
        let cut_off = |cause| Error::input(format!("the .npy header is cut off: {cause}"));
        let mut start = [0; 8];
        reader.read_exact(&mut start).map_err(cut_off)?;
        if !start.starts_with(MAGIC) {
            return Err(Error::input("not a .npy array"));
        }
        let length = match start[6] {
            1 => {
                let mut length = [0; 2];
                reader.read_exact(&mut length).map_err(cut_off)?;
                usize::from(u16::from_le_bytes(length))
            }
            2 | 3 => {
                let mut length = [0; 4];
                reader.read_exact(&mut length).map_err(cut_off)?;
                u32::from_le_bytes(length) as usize
            }
            version => {
                return Err(Error::input(format!(
                    "the .npy format's version {version} is not known"
                )));
            }
        };
        if length > LONGEST_HEADER {
            return Err(Error::input(format!(
                "the .npy header announces {length} bytes for itself: at most {LONGEST_HEADER} are read"
            )));
        }
        let mut text = vec![0; length];
        reader.read_exact(&mut text).map_err(cut_off)?;
        Self::parse(&String::from_utf8_lossy(&text))
    }

    /// `{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4, 5), }`
    fn parse(text: &str) -> Result<Self> {
        let value = |key: &str| {
            ['\'', '"']
                .into_iter()
                .find_map(|quote| {
                    let (_, rest) = text.split_once(&format!("{quote}{key}{quote}"))?;
                    Some(rest.trim_start().strip_prefix(':')?.trim_start())
                })
                .ok_or_else(|| Error::input(format!("the .npy header has no '{key}'")))
        };
        let descr = value("descr")?;
        let descr = descr
            .strip_prefix(['\'', '"'])
            .and_then(|rest| rest.split_once(['\'', '"']))
            .map(|(descr, _)| descr.to_owned())
            .ok_or_else(|| Error::input("arrays of records are not supported"))?;
        let fortran_order = match value("fortran_order")? {
            rest if rest.starts_with("True") => true,
            rest if rest.starts_with("False") => false,
            _ => return Err(Error::input("the .npy header's order is unclear")),
        };
        let shape: Vec<u64> = value("shape")?
            .strip_prefix('(')
            .and_then(|rest| rest.split_once(')'))
            .and_then(|(sizes, _)| {
                sizes
                    .split(',')
                    .map(str::trim)
                    .filter(|size| !size.is_empty())
                    .take(MAX_AXES + 1)
                    .map(|size| size.trim_end_matches('L').parse().ok())
                    .collect()
            })
            .ok_or_else(|| Error::input("the .npy header's shape cannot be read"))?;
        if shape.len() > MAX_AXES {
            return Err(Error::input(format!(
                "the .npy header announces more than {MAX_AXES} axes"
            )));
        }
        Ok(Self {
            descr,
            fortran_order,
            shape,
        })
    }

    fn element(&self) -> Result<Element> {
        let unsupported =
            || Error::input(format!("arrays of type '{}' are not supported", self.descr));
        let (endian, kind) = match self.descr.split_at_checked(1).ok_or_else(unsupported)? {
            (">", kind) => (Endian::Big, kind),
            ("<", kind) => (Endian::Little, kind),
            ("|" | "=", kind) => (Endian::NATIVE, kind),
            _ => return Err(unsupported()),
        };
        let scalar = match kind {
            "b1" | "u1" => Scalar::U8,
            "i1" => Scalar::I8,
            "u2" => Scalar::U16,
            "i2" => Scalar::I16,
            "u4" => Scalar::U32,
            "i4" => Scalar::I32,
            "u8" => Scalar::U64,
            "i8" => Scalar::I64,
            "f2" => Scalar::F16,
            "f4" => Scalar::F32,
            "f8" => Scalar::F64,
            _ => return Err(unsupported()),
        };
        Ok(Element { scalar, endian })
    }
}

/// Reads a .npy file.
pub(super) fn read(source: Source, request: &Request) -> Result<Volume> {
    let (header, payload) = Header::take(source.into_payload())?;
    read_array(&header, payload, Vec::new(), request)
}

/// Reads the array behind a header.
pub(super) fn read_array(
    header: &Header,
    payload: Payload,
    mut notes: Vec<String>,
    request: &Request,
) -> Result<Volume> {
    let element = header.element()?;
    let mut shape = header.shape.clone();
    if shape.is_empty() || shape.len() > 4 {
        return Err(Error::input(format!(
            "an array of {} axes is not a volume, nor a series of volumes",
            shape.len()
        )));
    }
    if let [_, _, _, components @ (3 | 4)] = shape[..] {
        return Err(refuse_components(components, Some(element.scalar)));
    }
    while shape.len() < 3 {
        shape.insert(0, 1);
    }
    let is_series = shape.len() == 4;
    let (sizes, frame_axis) = if header.fortran_order {
        (shape, is_series.then_some(0))
    } else {
        shape.reverse();
        (shape, is_series.then_some(3))
    };
    let (stored_dims, frames, note) = Frames::choose(&sizes, frame_axis, request.options.frame)?;
    notes.extend(note);
    let mut array = Array {
        dims: stored_dims,
        frames,
        element,
        geometry: Geometry::default(),
        rescale: Rescale::IDENTITY,
        notes,
    };
    if !header.fortran_order {
        return array.read(payload, request);
    }
    let voxels = array.voxels(payload, request)?;
    let [nz, ny, nx] = stored_dims.array().map(u64::from);
    array.dims = Dims::new([nx, ny, nz])?;
    let turned = with_voxels!(&voxels, slice => x_fastest(slice, array.dims)?.into());
    array.into_volume(turned, request.options)
}

/// Voxels that lie with z fastest, turned.
///
/// # Errors
/// Not enough memory.
fn x_fastest<T: Voxel>(z_fastest: &[T], dims: Dims) -> Result<Vec<T>> {
    let [nx, ny, nz] = dims.usize();
    let what = format_args!("{dims} voxels, turned from Fortran's order");
    let mut turned = memory::filled(z_fastest.len(), T::zeroed(), what)?;
    turned
        .par_chunks_mut(nx * ny)
        .enumerate()
        .for_each(|(z, slice)| {
            for (y, row) in slice.chunks_mut(nx).enumerate() {
                for (x, voxel) in row.iter_mut().enumerate() {
                    *voxel = z_fastest[z + nz * (y + ny * x)];
                }
            }
        });
    Ok(turned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_parse_and_refuse() {
        let header =
            Header::parse("{'descr': '>f8', 'fortran_order': True, 'shape': (2, 3L, 4,), }\n")
                .unwrap();
        assert!(header.fortran_order);
        assert_eq!(header.shape, [2, 3, 4]);
        assert_eq!(header.element().unwrap().to_string(), "f64be");
        for bad in [
            "",
            "{'descr': '<f4', 'fortran_order': False}",
            "{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (2,)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (2, -3)}",
            "{'descr': '<f4', 'fortran_order': 0, 'shape': (2, 3)}",
        ] {
            assert!(Header::parse(bad).is_err(), "{bad}");
        }
    }
}
