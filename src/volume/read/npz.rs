//! NumPy archives: .npz, a zip of .npy arrays, stored or deflated.

use std::io::{self, Cursor, Read};

use flate2::Crc;
use flate2::bufread::DeflateDecoder;
use zip::{CompressionMethod, ZipArchive};

use super::Request;
use super::numpy::{self, Header};
use super::payload::{MappedBytes, Payload};
use super::source::Source;
use crate::error::{Error, Result};
use crate::volume::Volume;

/// Common names of the array that is the volume, the likeliest first.
const LIKELY_NAMES: [&str; 8] = [
    "volume", "vol", "data", "image", "img", "voxels", "array", "arr_0",
];

/// The most arrays that are considered.
const MAX_ARRAYS: usize = 4096;

/// The most arrays named where none will do.
const MAX_NAMED: usize = 10;

pub(super) fn is_zip(head: &[u8]) -> bool {
    head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06")
}

/// One array of the archive.
struct Entry {
    name: String,
    bytes: MappedBytes,
    is_deflated: bool,
    checksum: u32,
}

impl Entry {
    /// The array's header and what follows it.
    fn open(&self) -> Result<(Header, Payload)> {
        let bytes = self.bytes.clone();
        let payload = if self.is_deflated {
            let length = bytes.len();
            let checked = Checked {
                reader: DeflateDecoder::new(bytes),
                sum: Crc::new(),
                expected: self.checksum,
            };
            Payload::unzipped(checked, length)
        } else {
            Payload::Mapped(bytes)
        };
        Header::take(payload).map_err(|error| error.at(format!("array '{}'", self.name)))
    }
}

/// Reads the archive's volume: of several arrays with three or four axes the one with the likeliest
/// name, else the first.
pub(super) fn read(source: &Source, request: &Request) -> Result<Volume> {
    let file = source.plain().ok_or_else(|| {
        Error::input("this is a zip archive inside gzip").hint("unpack it with gunzip first")
    })?;
    let entries = entries(file)?;
    let mut shapes = Vec::new();
    let mut chosen: Option<(usize, &Entry)> = None;
    for entry in &entries {
        // Decoders are large: an array's is dropped again before the next one's is made.
        let (header, _) = entry.open()?;
        if shapes.len() < MAX_NAMED {
            shapes.push(format!("{} {:?}", entry.name, header.shape));
        }
        let rank = LIKELY_NAMES
            .iter()
            .position(|name| entry.name.eq_ignore_ascii_case(name))
            .unwrap_or(LIKELY_NAMES.len());
        if matches!(header.shape.len(), 3 | 4) && chosen.is_none_or(|(best, _)| rank < best) {
            chosen = Some((rank, entry));
        }
    }
    let Some((_, entry)) = chosen else {
        return Err(Error::input(if entries.is_empty() {
            "this is a zip archive without NumPy arrays: DICOM and other archives are not read by this version".to_owned()
        } else {
            format!("no array has three or four axes: {}", shapes.join(", "))
        }));
    };
    let mut notes = Vec::new();
    if entries.len() > 1 {
        notes.push(format!(
            "of the archive's {} arrays '{}' is read",
            entries.len(),
            entry.name
        ));
    }
    let (header, payload) = entry.open()?;
    numpy::read_array(&header, payload, notes, request)
        .map_err(|error| error.at(format!("array '{}'", entry.name)))
}

fn entries(file: &MappedBytes) -> Result<Vec<Entry>> {
    let damaged = |cause| Error::input(format!("the zip archive is damaged: {cause}"));
    let mut archive = ZipArchive::new(Cursor::new(file.as_slice())).map_err(damaged)?;
    let mut entries = Vec::new();
    let mut places = Vec::new();
    for index in 0..archive.len().min(MAX_ARRAYS) {
        let member = archive.by_index_raw(index).map_err(damaged)?;
        let name = String::from_utf8_lossy(member.name_raw()).into_owned();
        let Some(name) = name.strip_suffix(".npy") else {
            continue;
        };
        let refused = |why: &str| Err(Error::input(format!("array '{name}' is {why}")));
        if member.encrypted() {
            return refused("encrypted");
        }
        let Some(start) = member.data_start() else {
            return refused("nowhere in the archive");
        };
        let bytes = file.clone().after(start)?.first(member.compressed_size());
        places.push((member.header_start(), start.saturating_add(bytes.len())));
        let is_deflated = match member.compression() {
            CompressionMethod::Stored => false,
            CompressionMethod::Deflated => true,
            _ => return refused("compressed by a method which this version does not read"),
        };
        entries.push(Entry {
            name: name.to_owned(),
            bytes,
            is_deflated,
            checksum: member.crc32(),
        });
    }
    // No archiver writes bytes that are two members' at once: each would be decoded anew.
    places.sort_unstable();
    if places.windows(2).any(|pair| pair[1].0 < pair[0].1) {
        return Err(Error::input("arrays of the zip archive overlap"));
    }
    Ok(entries)
}

/// Compares the archive's checksum at the data's end.
struct Checked<R> {
    reader: R,
    sum: Crc,
    expected: u32,
}

impl<R: Read> Read for Checked<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.reader.read(buffer)?;
        self.sum.update(&buffer[..count]);
        if count == 0 && !buffer.is_empty() && self.sum.sum() != self.expected {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                "the archive's checksum disagrees",
            ));
        }
        Ok(count)
    }
}
