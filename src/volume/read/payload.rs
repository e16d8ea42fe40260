//! The voxels' bytes, wherever they lie: in a mapped file or behind a decoder.

use std::io::{self, BufRead, BufReader, Read};
use std::sync::Arc;

use bzip2::bufread::MultiBzDecoder;
use flate2::bufread::{GzDecoder, ZlibDecoder};

use super::element::Scalar;
use super::text::{HexBytes, TextNumbers};
use crate::error::{Error, Result};
use crate::volume::MappedFile;

/// A part of a mapped file, read from its start.
#[derive(Clone)]
pub(super) struct MappedBytes {
    map: Arc<MappedFile>,
    start: usize,
    end: usize,
}

impl MappedBytes {
    pub(super) fn whole(map: Arc<MappedFile>) -> Self {
        let end = map.len();
        Self { map, start: 0, end }
    }

    pub(super) fn map(&self) -> &Arc<MappedFile> {
        &self.map
    }

    /// Where it starts in the file.
    pub(super) fn start(&self) -> usize {
        self.start
    }

    pub(super) fn as_slice(&self) -> &[u8] {
        &self.map[self.start..self.end]
    }

    pub(super) fn len(&self) -> u64 {
        (self.end - self.start) as u64
    }

    /// Skips the first `skip` bytes; fails when there are fewer.
    pub(super) fn after(mut self, skip: u64) -> Result<Self> {
        if skip > self.len() {
            return Err(Error::input(format!(
                "the voxels should start {skip} bytes in, but only {} bytes are there",
                self.len()
            )));
        }
        self.start += skip as usize;
        Ok(self)
    }

    /// The first `length` bytes, or all when there are fewer.
    pub(super) fn first(mut self, length: u64) -> Self {
        self.end = self.start + self.len().min(length) as usize;
        self
    }
}

impl Read for MappedBytes {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.as_slice().read(buffer)?;
        self.start += count;
        Ok(count)
    }
}

impl BufRead for MappedBytes {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        Ok(self.as_slice())
    }

    fn consume(&mut self, count: usize) {
        self.start = (self.start + count).min(self.end);
    }
}

/// Bytes from a header's end (or a data file's start) on.
pub(super) enum Payload {
    /// The bytes lie in a file unchanged.
    Mapped(MappedBytes),
    /// The bytes come out of a decoder; no more than `max_bytes`.
    Stream {
        reader: Box<dyn BufRead>,
        max_bytes: u64,
    },
}

/// Deflate spends at least two bits on at most 258 bytes.
const DEFLATE_RATIO: u64 = 258 * 8 / 2;

/// The fewest bits of a bzip2 block: its marks and checksum (105), the bytes that occur (32), two code
/// tables of three lengths (34 with their number and the selectors'), one symbol.
const BZIP2_BLOCK_BITS: u64 = 105 + 32 + 34 + 1;

/// The most bytes that come out of one: of the 900,000 that it holds at most every five may stand for
/// 259.
const BZIP2_BLOCK_BYTES: u64 = 900_000 / 5 * 259;

impl Payload {
    fn stream(reader: impl Read + 'static, max_bytes: u64) -> Self {
        Self::Stream {
            reader: Box::new(BufReader::with_capacity(1 << 16, reader)),
            max_bytes,
        }
    }

    /// The output of a decoder of `length` deflated bytes.
    pub(super) fn unzipped(decoder: impl Read + 'static, length: u64) -> Self {
        Self::stream(decoder, length.saturating_mul(DEFLATE_RATIO))
    }

    /// The reader, and how many bytes it can give at most.
    pub(super) fn into_reader(self) -> (Box<dyn BufRead>, u64) {
        match self {
            Self::Mapped(bytes) => {
                let length = bytes.len();
                (Box::new(bytes), length)
            }
            Self::Stream { reader, max_bytes } => (reader, max_bytes),
        }
    }

    /// Decoded by gzip; bytes after the last member are ignored.
    pub(super) fn gunzip(self) -> Self {
        let (reader, length) = self.into_reader();
        Self::unzipped(GzipMembers::new(reader), length)
    }

    /// Decoded by zlib, or by gzip where the data say so themselves.
    pub(super) fn inflate(self) -> Result<Self> {
        let (mut reader, length) = self.into_reader();
        let start = reader
            .fill_buf()
            .map_err(|cause| Error::input(format!("the compressed voxels: {cause}")))?;
        Ok(if start.starts_with(GZIP_MAGIC) {
            Self::unzipped(GzipMembers::new(reader), length)
        } else {
            Self::unzipped(ZlibDecoder::new(reader), length)
        })
    }

    /// Decoded by bzip2, streams one after the other as one.
    pub(super) fn bunzip2(self) -> Self {
        let (reader, length) = self.into_reader();
        let blocks = length.saturating_mul(8) / BZIP2_BLOCK_BITS;
        Self::stream(
            MultiBzDecoder::new(reader),
            blocks.saturating_mul(BZIP2_BLOCK_BYTES),
        )
    }

    /// Written numbers as native-endian bytes: each of a digit and a separator at least.
    pub(super) fn numbers(self, scalar: Scalar) -> Self {
        let (reader, length) = self.into_reader();
        Self::stream(
            TextNumbers::new(reader, scalar),
            length.div_ceil(2).saturating_mul(scalar.bytes()),
        )
    }

    /// Bytes written as pairs of hexadecimal digits.
    pub(super) fn hex(self) -> Self {
        let (reader, length) = self.into_reader();
        Self::stream(HexBytes(reader), length)
    }

    /// Skips the first `count` bytes.
    ///
    /// # Errors
    /// There are fewer, or they are damaged.
    pub(super) fn skip(self, count: u64) -> Result<Self> {
        match self {
            Self::Mapped(bytes) => Ok(Self::Mapped(bytes.after(count)?)),
            Self::Stream {
                mut reader,
                max_bytes,
            } => {
                if count > max_bytes {
                    return Err(Error::input(format!(
                        "the voxels should start {count} bytes in, but the data there cannot hold more than {max_bytes}"
                    )));
                }
                let skipped =
                    io::copy(&mut (&mut reader).take(count), &mut io::sink()).map_err(|cause| {
                        Error::input(format!("the data before the voxels: {cause}"))
                    })?;
                if skipped < count {
                    return Err(Error::input(format!(
                        "the voxels should start {count} bytes in, but only {skipped} bytes are there"
                    )));
                }
                Ok(Self::Stream {
                    reader,
                    max_bytes: max_bytes.saturating_sub(count),
                })
            }
        }
    }

    /// Skips the first `count` lines.
    pub(super) fn skip_lines(self, count: u64) -> Result<Self> {
        let missing =
            |line| Error::input(format!("{count} lines to skip, but the data have {line}"));
        match self {
            Self::Mapped(bytes) => {
                let mut start = 0;
                for line in 0..count {
                    let rest = &bytes.as_slice()[start..];
                    let end = rest.iter().position(|&b| b == b'\n');
                    start += end.ok_or_else(|| missing(line))? + 1;
                }
                Ok(Self::Mapped(bytes.after(start as u64)?))
            }
            Self::Stream {
                mut reader,
                max_bytes,
            } => {
                for line in 0..count {
                    let read = reader
                        .skip_until(b'\n')
                        .map_err(|cause| Error::input(format!("the lines to skip: {cause}")))?;
                    if read == 0 {
                        return Err(missing(line));
                    }
                }
                Ok(Self::Stream { reader, max_bytes })
            }
        }
    }

    /// The last `count` bytes: headers of unknown size are stepped over so.
    pub(super) fn last(self, count: u64) -> Result<Self> {
        match self {
            Self::Mapped(bytes) => {
                let skip = bytes.len().checked_sub(count).ok_or_else(|| {
                    Error::input(format!(
                        "{count} bytes of voxels announced, but the file has {}",
                        bytes.len()
                    ))
                })?;
                Ok(Self::Mapped(bytes.after(skip)?))
            }
            Self::Stream { .. } => Err(Error::input(
                "the voxels are to be found from the file's end, which needs an uncompressed file",
            )
            .hint("decompress it first")),
        }
    }
}

/// Gzip's mark and its only method, deflate.
pub(super) const GZIP_MAGIC: &[u8] = b"\x1f\x8b\x08";

/// Gzip members one after the other, as one; like gzip itself it ignores what follows the last
/// (tapes and some archives pad with zeros).
pub(super) struct GzipMembers<R> {
    member: Option<GzDecoder<R>>,
}

impl<R: BufRead> GzipMembers<R> {
    pub(super) fn new(reader: R) -> Self {
        Self {
            member: Some(GzDecoder::new(reader)),
        }
    }
}

impl<R: BufRead> Read for GzipMembers<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let Some(member) = &mut self.member else {
                return Ok(0);
            };
            let count = member.read(buffer)?;
            if count > 0 || buffer.is_empty() {
                return Ok(count);
            }
            if let Some(mut rest) = self.member.take().map(GzDecoder::into_inner)
                && rest.fill_buf()?.starts_with(GZIP_MAGIC)
            {
                self.member = Some(GzDecoder::new(rest));
            }
        }
    }
}
