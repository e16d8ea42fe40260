//! NRRD: attached and detached headers, raw, gzip, bzip2, hexadecimal and written numbers.
//!
//! Source: "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html.

use std::collections::HashMap;
use std::path::Path;

use super::Request;
use super::array::Array;
use super::element::{Element, Endian, Scalar};
use super::files::{self, DataFiles};
use super::frames::Frames;
use super::nrrd_axes::Axes;
use super::payload::Payload;
use super::source::{LONGEST_HEADER, Source, open_plain};
use super::text::number;
use crate::error::{Error, Result};
use crate::volume::{Rescale, Volume};

pub(super) fn is_nrrd(head: &[u8]) -> bool {
    head.starts_with(b"NRRD000")
}

/// Where a header says its voxels are; `None` where it makes no sense.
pub(super) fn data_files(head: &[u8]) -> Option<DataFiles> {
    Fields::parse(head).ok().map(|fields| fields.data)
}

/// The header's fields under their names in lower case without blanks (`data file` and `datafile`
/// are one), and where its lines end.
pub(super) struct Fields {
    values: HashMap<String, String>,
    data: DataFiles,
    length: usize,
}

impl Fields {
    fn parse(head: &[u8]) -> Result<Self> {
        let head = &head[..head.len().min(LONGEST_HEADER)];
        let mut fields = Self {
            values: HashMap::new(),
            data: DataFiles::Attached,
            length: 0,
        };
        let mut lines = head.split_inclusive(|&byte| byte == b'\n');
        fields.length += lines.next().map_or(0, <[u8]>::len);
        let mut closed = false;
        while let Some(bytes) = lines.next() {
            fields.length += bytes.len();
            let line = String::from_utf8_lossy(bytes);
            let line = line.trim_end();
            if line.is_empty() {
                closed = true;
                break;
            }
            // Comments, and `key:=value` pairs, which are the user's own.
            if line.starts_with('#') {
                continue;
            }
            let Some((name, value)) = line.split_once(':') else {
                return Err(Error::input(format!(
                    "the NRRD header's line '{}' has no ':'",
                    line.chars().take(40).collect::<String>()
                )));
            };
            if value.starts_with('=') {
                continue;
            }
            let name = name.replace(' ', "").to_ascii_lowercase();
            let value = value.trim().to_owned();
            if name == "datafile" {
                if value.split_whitespace().next() == Some("LIST") {
                    fields.data = DataFiles::Files(
                        lines
                            .map(|line| String::from_utf8_lossy(line).trim().to_owned())
                            .filter(|line| !line.is_empty())
                            .collect(),
                    );
                    return Ok(fields);
                }
                fields.data = DataFiles::Files(match files::numbered(&value)? {
                    Some(names) => names,
                    None => vec![value],
                });
                continue;
            }
            fields.values.insert(name, value);
        }
        if !closed && fields.data == DataFiles::Attached {
            return Err(Error::input(
                "the NRRD header does not end: no empty line, no data file",
            ));
        }
        Ok(fields)
    }

    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.values.get(name).map(String::as_str)
    }

    pub(super) fn need(&self, name: &str) -> Result<&str> {
        self.get(name)
            .ok_or_else(|| Error::input(format!("the NRRD header has no field '{name}'")))
    }

    fn scalar(&self) -> Result<Scalar> {
        let name = self.need("type")?;
        Ok(match name.to_ascii_lowercase().as_str() {
            "signed char" | "int8" | "int8_t" => Scalar::I8,
            "uchar" | "unsigned char" | "uint8" | "uint8_t" => Scalar::U8,
            "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => {
                Scalar::I16
            }
            "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => {
                Scalar::U16
            }
            "int" | "signed int" | "int32" | "int32_t" => Scalar::I32,
            "uint" | "unsigned int" | "uint32" | "uint32_t" => Scalar::U32,
            "longlong"
            | "long long"
            | "long long int"
            | "signed long long"
            | "signed long long int"
            | "int64"
            | "int64_t" => Scalar::I64,
            "ulonglong"
            | "unsigned long long"
            | "unsigned long long int"
            | "uint64"
            | "uint64_t" => Scalar::U64,
            "float" => Scalar::F32,
            "double" => Scalar::F64,
            _ => {
                return Err(Error::input(format!(
                    "the NRRD type '{name}' is unknown or no number"
                )));
            }
        })
    }

    fn endian(
        &self,
        scalar: Scalar,
        encoding: Encoding,
        notes: &mut Vec<String>,
    ) -> Result<Endian> {
        match self.get("endian").map(str::to_ascii_lowercase).as_deref() {
            Some("little") => Ok(Endian::Little),
            Some("big") => Ok(Endian::Big),
            Some(other) => Err(Error::input(format!(
                "the NRRD header's 'endian: {other}' is neither little nor big"
            ))),
            None => {
                if scalar.bytes() > 1 && encoding != Encoding::Text {
                    notes.push("the header names no byte order: read as little-endian".into());
                }
                Ok(Endian::Little)
            }
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Raw,
    Gzip,
    Bzip2,
    Text,
    Hex,
}

impl Encoding {
    fn of(fields: &Fields) -> Result<Self> {
        let name = fields.need("encoding")?;
        match name.to_ascii_lowercase().as_str() {
            "raw" => Ok(Self::Raw),
            "gzip" | "gz" => Ok(Self::Gzip),
            "bzip2" | "bz2" => Ok(Self::Bzip2),
            "ascii" | "text" | "txt" => Ok(Self::Text),
            "hex" => Ok(Self::Hex),
            _ => Err(
                Error::input(format!("the NRRD encoding '{name}' is not supported"))
                    .hint("raw, gzip, bzip2, ascii and hex are"),
            ),
        }
    }
}

/// How to get from a data file's start to its voxels.
#[derive(Clone, Copy)]
struct Steps {
    encoding: Encoding,
    skip_lines: u64,
    /// `None`: the voxels are the file's last bytes.
    skip_bytes: Option<u64>,
    scalar: Scalar,
}

impl Steps {
    fn of(fields: &Fields, encoding: Encoding, scalar: Scalar) -> Result<Self> {
        let skip: i64 = number("byte skip", fields.get("byteskip").unwrap_or("0"))?;
        let skip_bytes = match skip {
            -1 if encoding == Encoding::Raw => None,
            skip => Some(u64::try_from(skip).map_err(|_: std::num::TryFromIntError| {
                Error::input(format!(
                    "the header's 'byte skip: {skip}' makes no sense: only raw data allow -1"
                ))
            })?),
        };
        Ok(Self {
            encoding,
            skip_lines: number("line skip", fields.get("lineskip").unwrap_or("0"))?,
            skip_bytes,
            scalar,
        })
    }

    /// Lines are skipped before decoding, bytes after it; `length` bytes are wanted.
    fn take(self, payload: Payload, length: u64) -> Result<Payload> {
        let payload = payload.skip_lines(self.skip_lines)?;
        let payload = match self.encoding {
            Encoding::Raw | Encoding::Text | Encoding::Hex => payload,
            Encoding::Gzip => payload.gunzip(),
            Encoding::Bzip2 => payload.bunzip2(),
        };
        let payload = match self.skip_bytes {
            Some(count) => payload.skip(count)?,
            None => payload.last(length)?,
        };
        Ok(match self.encoding {
            Encoding::Text => payload.numbers(self.scalar),
            Encoding::Hex => payload.hex(),
            Encoding::Raw | Encoding::Gzip | Encoding::Bzip2 => payload,
        })
    }
}

/// Reads an attached or detached NRRD file.
pub(super) fn read(source: Source, request: &Request) -> Result<Volume> {
    let fields = Fields::parse(source.head())?;
    let mut notes = Vec::new();
    let axes = Axes::parse(&fields)?;
    let (dims, frames, note) = Frames::choose(&axes.sizes, axes.frame_axis, request.options.frame)?;
    notes.extend(note);
    let scalar = fields.scalar()?;
    let encoding = Encoding::of(&fields)?;
    let element = if encoding == Encoding::Text {
        Element::native(scalar)
    } else {
        Element {
            scalar,
            endian: fields.endian(scalar, encoding, &mut notes)?,
        }
    };
    let array = Array {
        dims,
        frames,
        element,
        geometry: axes.geometry(&fields, &mut notes)?,
        rescale: Rescale::IDENTITY,
        notes,
    };
    let steps = Steps::of(&fields, encoding, scalar)?;
    let total = array.total_bytes()?;
    let payload = match &fields.data {
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
