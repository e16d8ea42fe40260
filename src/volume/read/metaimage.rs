//! MetaImage: .mha, and .mhd with its data files.
//!
//! Source: the MetaIO documentation, what ITK writes (`TransformMatrix` lists the directions of the
//! first axis, then of the second, then of the third) and what it reads: keys of any bytes, `:` for
//! `=`, and lines without either, which it skips.

use std::collections::HashMap;
use std::path::Path;

use glam::{DMat3, DVec3};

use super::Request;
use super::array::{Array, refuse_components};
use super::element::{Element, Endian, Scalar};
use super::files::{self, DataFiles};
use super::frames::Frames;
use super::payload::Payload;
use super::source::{LONGEST_HEADER, Source, open_plain};
use super::text::{exactly, number};
use crate::error::{Error, Result};
use crate::volume::{Geometry, Rescale, Volume};

/// Where a header says its voxels are; `None` where it makes no sense.
pub(super) fn data_files(head: &[u8]) -> Option<DataFiles> {
    Fields::parse(head).ok().and_then(|fields| fields.data)
}

/// The header's `Key = Value` lines, keys in lower case, and where they end.
struct Fields {
    values: HashMap<String, String>,
    data: Option<DataFiles>,
    length: usize,
}

impl Fields {
    /// Lines up to `ElementDataFile`; those that are not `Key = Value` are skipped.
    fn parse(head: &[u8]) -> Result<Self> {
        let head = &head[..head.len().min(LONGEST_HEADER)];
        let mut fields = Self {
            values: HashMap::new(),
            data: None,
            length: 0,
        };
        let mut lines = head.split_inclusive(|&byte| byte == b'\n');
        while let Some(bytes) = lines.next() {
            fields.length += bytes.len();
            let Some((key, value)) = key_and_value(bytes) else {
                continue;
            };
            if key == "elementdatafile" {
                fields.data = Some(Self::data_files(&value, lines)?);
                break;
            }
            fields.values.insert(key, value);
        }
        Ok(fields)
    }

    fn data_files<'a>(value: &str, rest: impl Iterator<Item = &'a [u8]>) -> Result<DataFiles> {
        if value.eq_ignore_ascii_case("LOCAL") {
            return Ok(DataFiles::Attached);
        }
        if value.split_whitespace().next() == Some("LIST") {
            return Ok(DataFiles::Files(
                rest.map(|line| String::from_utf8_lossy(line).trim().to_owned())
                    .filter(|line| !line.is_empty())
                    .collect(),
            ));
        }
        Ok(DataFiles::Files(match files::numbered(value)? {
            Some(names) => names,
            None => vec![value.to_owned()],
        }))
    }

    /// The first of several names of one field.
    fn get(&self, names: &[&'static str]) -> Option<(&'static str, &str)> {
        names.iter().find_map(|name| {
            let value = self.values.get(&name.to_ascii_lowercase())?;
            Some((*name, value.as_str()))
        })
    }

    fn need(&self, name: &'static str) -> Result<&str> {
        self.get(&[name])
            .map(|(_, value)| value)
            .ok_or_else(|| Error::input(format!("the MetaImage header has no '{name}'")))
    }

    fn is_true(&self, names: &[&'static str]) -> bool {
        self.get(names)
            .is_some_and(|(_, value)| value.starts_with(['T', 't', '1']))
    }

    fn scalar(&self) -> Result<Scalar> {
        let name = self.need("ElementType")?;
        let plain = name.strip_suffix("_ARRAY").unwrap_or(name);
        Ok(match plain {
            "MET_CHAR" | "MET_ASCII_CHAR" => Scalar::I8,
            "MET_UCHAR" => Scalar::U8,
            "MET_SHORT" => Scalar::I16,
            "MET_USHORT" => Scalar::U16,
            // MetaIO fixes a "long" at four bytes.
            "MET_INT" | "MET_LONG" => Scalar::I32,
            "MET_UINT" | "MET_ULONG" => Scalar::U32,
            "MET_LONG_LONG" => Scalar::I64,
            "MET_ULONG_LONG" => Scalar::U64,
            "MET_FLOAT" => Scalar::F32,
            "MET_DOUBLE" => Scalar::F64,
            _ => {
                return Err(Error::input(format!(
                    "the MetaImage element type '{name}' is unknown"
                )));
            }
        })
    }

    /// The geometry in mm, LPS (MetaImage's own space, as ITK reads it); of more axes the first three.
    fn geometry(&self, axes: usize) -> Result<Geometry> {
        let mut origin_mm = DVec3::ZERO;
        let mut spacing_mm = DVec3::ONE;
        let mut columns = [DVec3::X, DVec3::Y, DVec3::Z];
        if let Some((name, text)) = self.get(&["Offset", "Position", "Origin"]) {
            for (axis, value) in exactly(name, text, axes)?.into_iter().take(3).enumerate() {
                origin_mm[axis] = value;
            }
        }
        if let Some((name, text)) = self.get(&["ElementSpacing", "ElementSize"]) {
            for (axis, value) in exactly(name, text, axes)?.into_iter().take(3).enumerate() {
                spacing_mm[axis] = value;
            }
        }
        if let Some((name, text)) = self.get(&["TransformMatrix", "Rotation", "Orientation"]) {
            let matrix: Vec<f64> = exactly(name, text, axes * axes)?;
            for (axis, row) in matrix.chunks_exact(axes).take(3).enumerate() {
                let mut direction = DVec3::ZERO;
                for (component, &value) in row.iter().take(3).enumerate() {
                    direction[component] = value;
                }
                columns[axis] = direction;
            }
        }
        let direction = DMat3::from_cols(columns[0], columns[1], columns[2]);
        Geometry::of_signed_spacing(origin_mm, direction, spacing_mm)
    }
}

/// A header line: a key, `=` or `:`, and a value. The key may be anything: DICOM tags, words with
/// blanks, letters of an unknown encoding.
fn key_and_value(line: &[u8]) -> Option<(String, String)> {
    let is_separator = |c: &char| matches!(c, '=' | ':');
    let line = String::from_utf8_lossy(line);
    let (key, value) = line.split_once(|c| is_separator(&c))?;
    let value = value.trim_start_matches(|c: char| is_separator(&c) || c.is_whitespace());
    Some((key.trim().to_ascii_lowercase(), value.trim_end().to_owned()))
}

/// A header begins with lines of text, one of which is `NDims` (`ObjectType` often comes first, but
/// not always).
pub(super) fn is_metaimage(head: &[u8]) -> bool {
    const LONGEST_SEARCH: usize = 1 << 16;
    head[..head.len().min(LONGEST_SEARCH)]
        .split_inclusive(|&byte| byte == b'\n')
        .take_while(|line| !line.contains(&0))
        .filter_map(key_and_value)
        .any(|(key, value)| key == "ndims" || (key == "objecttype" && value == "Image"))
}

/// How to get from a data file's start to its voxels.
#[derive(Clone, Copy)]
struct Steps {
    /// `None`: the voxels are the file's last bytes.
    skip_bytes: Option<u64>,
    is_compressed: bool,
    is_text: bool,
    scalar: Scalar,
}

impl Steps {
    fn of(fields: &Fields, scalar: Scalar) -> Result<Self> {
        let header_size: i64 = match fields.get(&["HeaderSize"]) {
            Some((name, text)) => number(name, text)?,
            None => 0,
        };
        Ok(Self {
            skip_bytes: match header_size {
                -1 => None,
                size => Some(u64::try_from(size).map_err(|_| {
                    Error::input(format!("the header's 'HeaderSize = {size}' makes no sense"))
                })?),
            },
            is_compressed: fields.is_true(&["CompressedData"]),
            is_text: fields
                .get(&["BinaryData"])
                .is_some_and(|(_, value)| value.starts_with(['F', 'f', '0'])),
            scalar,
        })
    }

    fn take(self, payload: Payload, length: u64) -> Result<Payload> {
        let payload = match self.skip_bytes {
            Some(count) => payload.skip(count)?,
            None if self.is_compressed => {
                return Err(Error::input(
                    "'HeaderSize = -1' needs voxels that are not compressed",
                ));
            }
            None => payload.last(length)?,
        };
        Ok(match (self.is_compressed, self.is_text) {
            (true, _) => payload.inflate()?,
            (false, true) => payload.numbers(self.scalar),
            (false, false) => payload,
        })
    }
}

/// Reads a .mha, or a .mhd with its data files.
pub(super) fn read(source: Source, request: &Request) -> Result<Volume> {
    let fields = Fields::parse(source.head())?;
    let data = fields.data.as_ref().ok_or_else(|| {
        if source.head().len() < LONGEST_HEADER {
            Error::input("the MetaImage header ends without 'ElementDataFile'")
        } else {
            Error::input(format!(
                "the MetaImage header has no 'ElementDataFile' in its first {LONGEST_HEADER} bytes"
            ))
        }
    })?;
    let axes: usize = number("NDims", fields.need("NDims")?)?;
    if !(1..=4).contains(&axes) {
        return Err(Error::input(format!("a MetaImage of {axes} axes")));
    }
    let mut sizes: Vec<u64> = exactly("DimSize", fields.need("DimSize")?, axes)?;
    let mut frame_axis = (axes == 4).then_some(3);
    let scalar = fields.scalar()?;
    let channels: u64 = match fields.get(&["ElementNumberOfChannels"]) {
        Some((name, text)) => number(name, text)?,
        None => 1,
    };
    if channels != 1 {
        if matches!(channels, 3 | 4) || frame_axis.is_some() {
            return Err(refuse_components(channels, Some(scalar)));
        }
        sizes.insert(0, channels);
        frame_axis = Some(0);
    }
    let (dims, frames, note) = Frames::choose(&sizes, frame_axis, request.options.frame)?;
    let steps = Steps::of(&fields, scalar)?;
    let big = fields.is_true(&["BinaryDataByteOrderMSB", "ElementByteOrderMSB"]);
    let element = match (steps.is_text && !steps.is_compressed, big) {
        (true, _) => Element::native(scalar),
        (false, true) => Element {
            scalar,
            endian: Endian::Big,
        },
        (false, false) => Element {
            scalar,
            endian: Endian::Little,
        },
    };
    let array = Array {
        dims,
        frames,
        element,
        geometry: fields.geometry(axes)?,
        rescale: Rescale::IDENTITY,
        notes: note.into_iter().collect(),
    };
    let total = array.total_bytes()?;
    let payload = match data {
        DataFiles::Attached => {
            let payload = source.into_payload().skip(fields.length as u64)?;
            steps.take(payload, total)?
        }
        DataFiles::Files(names) => {
            let share = total / (names.len() as u64).max(1);
            let open = move |path: &Path| steps.take(Payload::Mapped(open_plain(path)?), share);
            files::joined(request.path, names, total, Box::new(open))?
        }
    };
    array.read(payload, request)
}
