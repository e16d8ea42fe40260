//! Headerless voxels, described by flags or by the file's name.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use glam::{DMat3, DVec3};

use super::Request;
use super::array::Array;
use super::element::{Element, Endian, Scalar};
use super::frames::Frames;
use super::source::Source;
use crate::error::{Error, Result};
use crate::extent::Dims;
use crate::volume::{Geometry, Rescale, Volume};

/// The user's description of a headerless file (`--raw-size`, `--raw-type`, `--raw-spacing`,
/// `--raw-offset`). Any of these options makes the file a headerless one, whatever it looks like.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RawLayout {
    /// Voxels along x, y, z; x runs fastest in the file.
    pub size: Option<RawSize>,
    /// The stored number type.
    pub element: Option<RawType>,
    /// Millimetres between voxels; 1 when absent.
    pub spacing_mm: Option<DVec3>,
    /// Bytes before the first voxel (after decompression); 0 when absent.
    pub offset_bytes: Option<u64>,
}

impl RawLayout {
    fn is_given(&self) -> bool {
        *self != Self::default()
    }

    /// Fills each absent field from `other`.
    fn or(self, other: Self) -> Self {
        Self {
            size: self.size.or(other.size),
            element: self.element.or(other.element),
            spacing_mm: self.spacing_mm.or(other.spacing_mm),
            offset_bytes: self.offset_bytes.or(other.offset_bytes),
        }
    }

    /// The layout that a name such as `head_256x256x256_uint8.raw.gz` describes.
    fn from_name(path: &Path) -> Self {
        let name = path
            .file_name()
            .map(|name| name.to_string_lossy().to_ascii_lowercase())
            .unwrap_or_default();
        let mut layout = Self::default();
        for word in name.split(['_', '-', '.', ' ']) {
            layout.size = layout.size.or_else(|| word.parse().ok());
            layout.element = layout.element.or_else(|| long_type_name(word));
        }
        layout
    }
}

/// Voxels along each axis, written `NXxNYxNZ`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawSize(Dims);

impl RawSize {
    /// The sizes, in voxels.
    pub fn dims(self) -> Dims {
        self.0
    }
}

impl FromStr for RawSize {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let sides: Option<Vec<u64>> = text
            .split(['x', 'X'])
            .map(|side| side.trim().parse().ok())
            .collect();
        let Some(&[nx, ny, nz]) = sides.as_deref() else {
            return Err(Error::usage(format!(
                "'{text}' is not a volume size: write NXxNYxNZ, such as 256x256x128"
            )));
        };
        Dims::new([nx, ny, nz])
            .map(Self)
            .map_err(|error| Error::usage(error.to_string()))
    }
}

impl fmt::Display for RawSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// A stored number type, written `u8`, `i8`, `u16`, `i16`, `u32`, `i32`, `u64`, `i64`, `f32` or
/// `f64`, with `be` behind it for big-endian numbers (`le`, the default, may be written too).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawType(Element);

impl RawType {
    const SCALARS: [Scalar; 10] = [
        Scalar::U8,
        Scalar::I8,
        Scalar::U16,
        Scalar::I16,
        Scalar::U32,
        Scalar::I32,
        Scalar::U64,
        Scalar::I64,
        Scalar::F32,
        Scalar::F64,
    ];
}

/// The byte order said by a type's last two letters, and the letters before.
fn split_endian(text: &str) -> (&str, Endian) {
    match (text.strip_suffix("be"), text.strip_suffix("le")) {
        (Some(name), _) => (name, Endian::Big),
        (_, Some(name)) => (name, Endian::Little),
        _ => (text, Endian::Little),
    }
}

impl FromStr for RawType {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let lower = text.trim().to_ascii_lowercase();
        let (name, endian) = split_endian(&lower);
        Self::SCALARS
            .into_iter()
            .find(|scalar| scalar.name() == name)
            .map(|scalar| Self(Element { scalar, endian }))
            .ok_or_else(|| {
                Error::usage(format!(
                    "'{text}' is not a number type: write u8, i8, u16, i16, u32, i32, u64, i64, f32 or f64, with 'be' behind it for big-endian"
                ))
            })
    }
}

impl fmt::Display for RawType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// The names that types have in file names.
fn long_type_name(word: &str) -> Option<RawType> {
    if let Ok(element) = word.parse() {
        return Some(element);
    }
    // `double` itself ends in a byte order's letters.
    let named = |name: &str, endian| {
        let scalar = match name {
            "uint8" | "uchar" => Scalar::U8,
            "int8" => Scalar::I8,
            "uint16" | "ushort" => Scalar::U16,
            "int16" | "short" => Scalar::I16,
            "uint32" => Scalar::U32,
            "int32" => Scalar::I32,
            "uint64" => Scalar::U64,
            "int64" => Scalar::I64,
            "float32" | "float" => Scalar::F32,
            "float64" | "double" => Scalar::F64,
            _ => return None,
        };
        Some(RawType(Element { scalar, endian }))
    };
    let (name, endian) = split_endian(word);
    named(word, Endian::Little).or_else(|| named(name, endian))
}

/// Whether the flags make this file a headerless one.
pub(super) fn is_requested(request: &Request) -> bool {
    request.options.raw.is_given()
}

/// Whether the file's name describes it well enough.
pub(super) fn is_named(path: &Path) -> bool {
    let layout = RawLayout::from_name(path);
    layout.size.is_some() && layout.element.is_some()
}

/// Reads headerless voxels as flags and name describe them.
///
/// # Errors
/// Size or type are given nowhere; the file is shorter than they require.
pub(super) fn read(source: Source, request: &Request) -> Result<Volume> {
    let layout = request.options.raw.or(RawLayout::from_name(request.path));
    let (Some(RawSize(dims)), Some(RawType(element))) = (layout.size, layout.element) else {
        return Err(
            Error::usage("a headerless file needs both its size and its number type").hint(
                "give --raw-size NXxNYxNZ and --raw-type u8|i8|u16|i16|u32|i32|u64|i64|f32|f64[be]",
            ),
        );
    };
    let (dims, frames, _) =
        Frames::choose(&dims.array().map(u64::from), None, request.options.frame)?;
    let spacing_mm = layout.spacing_mm.unwrap_or(DVec3::ONE);
    let geometry = Geometry::new(DVec3::ZERO, DMat3::IDENTITY, spacing_mm)
        .map_err(|error| Error::usage(format!("--raw-spacing: {error}")))?;
    let array = Array {
        dims,
        frames,
        element,
        geometry,
        rescale: Rescale::IDENTITY,
        notes: Vec::new(),
    };
    let payload = source
        .into_payload()
        .skip(layout.offset_bytes.unwrap_or(0))?;
    array.read(payload, request)
}

/// The most bytes counted for a hint.
const MAX_COUNTED: u64 = 1 << 28;

/// The error of a file without any description: the flags it needs, with a guess at its size.
pub(super) fn unrecognised(source: Source) -> Error {
    let error = Error::input(
        "not in the format NRRD, MetaImage, NIfTI or NumPy, and its name does not describe headerless voxels",
    );
    let flags = "for headerless voxels give --raw-size NXxNYxNZ and --raw-type (u8, i16, f32, …)";
    let guess = match source.decoded_len(MAX_COUNTED) {
        Ok(Some(length)) => cube_guess(length),
        _ => None,
    };
    match guess {
        Some(guess) => error.hint(format!("{flags}; {guess}")),
        None => error.hint(flags),
    }
}

fn cube_guess(length: u64) -> Option<String> {
    let cube = |voxels: u64| {
        let side = (voxels as f64).cbrt().round() as u64;
        (side > 1 && side.checked_pow(3) == Some(voxels)).then_some(side)
    };
    let guess = |side: u64, name: &str| {
        format!("its {length} bytes would fit --raw-size {side}x{side}x{side} --raw-type {name}")
    };
    if let Some(side) = cube(length) {
        return Some(guess(side, "u8"));
    }
    let side = length.is_multiple_of(2).then(|| cube(length / 2))??;
    Some(guess(side, "u16"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_types_parse_print_and_refuse() {
        assert_eq!("4x5x6".parse::<RawSize>().unwrap().to_string(), "4x5x6");
        for bad in ["", "4x5", "4x5x6x7", "0x4x4", "-1x2x2", "4x5x99999999999"] {
            assert!(bad.parse::<RawSize>().is_err(), "{bad}");
        }
        for (text, shown) in [("u8", "u8"), ("i16", "i16le"), ("f64be", "f64be")] {
            assert_eq!(text.parse::<RawType>().unwrap().to_string(), shown);
        }
        for bad in ["", "u12", "f16", "uint8", "be", "u16me"] {
            assert!(bad.parse::<RawType>().is_err(), "{bad}");
        }
    }

    #[test]
    fn names_describe_files() {
        let of = |name: &str| {
            let layout = RawLayout::from_name(Path::new(name));
            let (size, element) = (layout.size?, layout.element?);
            Some(format!("{size} {element}"))
        };
        let is = |name, expected: &str| assert_eq!(of(name).as_deref(), Some(expected), "{name}");
        is("head_256x256x128_uint8.raw", "256x256x128 u8");
        is("a/b c_4x5x6_int16be.raw.gz", "4x5x6 i16be");
        is("x-7x8x9-double.bin", "7x8x9 f64le");
        assert_eq!(of("head_256x256_uint8.raw"), None);
        assert_eq!(of("head_256x256x256.raw"), None);
    }

    #[test]
    fn a_cube_is_guessed_for_the_hint_only() {
        assert!(cube_guess(27).unwrap().contains("3x3x3 --raw-type u8"));
        assert!(cube_guess(54).unwrap().contains("3x3x3 --raw-type u16"));
        assert_eq!(cube_guess(28), None);
        assert_eq!(cube_guess(1), None);
    }
}
