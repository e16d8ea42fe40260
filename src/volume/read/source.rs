//! A file opened for reading: mapped, and looked into through gzip.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

use super::payload::{GZIP_MAGIC, GzipMembers, MappedBytes, Payload};
use crate::error::{Error, Result};
use crate::volume::MappedFile;

/// The longest header: longer ones (of whatever format) are lies.
pub(super) const LONGEST_HEADER: usize = 1 << 20;

/// An open file whose gzip wrapping, if any, is taken off.
pub(super) struct Source {
    file: MappedBytes,
    unzipped: Option<Unzipped>,
}

/// The decoded start, and the decoder that continues from there: nothing is decoded twice.
struct Unzipped {
    head: Vec<u8>,
    rest: GzipMembers<MappedBytes>,
}

impl Source {
    /// Opens the file and looks through gzip. The messages leave its name to the caller.
    ///
    /// # Errors
    /// As [`open_plain`]; damaged gzip.
    pub(super) fn open(path: &Path) -> Result<Self> {
        let file = open_plain(path)?;
        let unzipped = if file.as_slice().starts_with(GZIP_MAGIC) {
            Some(Unzipped::start(file.clone())?)
        } else {
            None
        };
        Ok(Self { file, unzipped })
    }

    /// The decoded contents' start: all of a plain file, the first [`LONGEST_HEADER`] bytes of a
    /// gzipped one.
    pub(super) fn head(&self) -> &[u8] {
        match &self.unzipped {
            Some(unzipped) => &unzipped.head,
            None => self.file.as_slice(),
        }
    }

    /// A plain file's bytes; `None` for a gzipped one.
    pub(super) fn plain(&self) -> Option<&MappedBytes> {
        self.unzipped.is_none().then_some(&self.file)
    }

    /// The decoded contents.
    pub(super) fn into_payload(self) -> Payload {
        match self.unzipped {
            None => Payload::Mapped(self.file),
            Some(Unzipped { head, rest }) => {
                Payload::unzipped(io::Cursor::new(head).chain(rest), self.file.len())
            }
        }
    }

    /// How many bytes the decoded contents have; `None` when that is more than `limit`.
    pub(super) fn decoded_len(self, limit: u64) -> Result<Option<u64>> {
        let (mut reader, _) = self.into_payload().into_reader();
        let length = io::copy(&mut (&mut reader).take(limit + 1), &mut io::sink())
            .map_err(|cause| damaged(&cause))?;
        Ok((length <= limit).then_some(length))
    }
}

/// Opens and maps the file as it is: voxels that a header describes may begin with any bytes. The
/// messages leave its name to the caller.
///
/// # Errors
/// It is missing, no regular file, unreadable, or empty.
pub(super) fn open_plain(path: &Path) -> Result<MappedBytes> {
    let failed = |cause: io::Error| match cause.kind() {
        io::ErrorKind::NotFound => Error::input("there is no such file"),
        io::ErrorKind::PermissionDenied => Error::input("reading it is not permitted"),
        // What Error::reading says of a cause, without the name.
        _ => {
            let kind = Error::reading(path, "read", &cause).kind();
            Error::new(kind, format!("cannot be read: {cause}"))
        }
    };
    // Asked before opening: opening a pipe would wait for its writer.
    let metadata = fs::metadata(path).map_err(failed)?;
    if metadata.is_dir() {
        return Err(Error::input("is a folder, not a volume file"));
    }
    if !metadata.is_file() {
        return Err(Error::input("is not a regular file"));
    }
    if metadata.len() == 0 {
        return Err(Error::input("the file is empty"));
    }
    let file = File::open(path).map_err(failed)?;
    let map = MappedFile::new(&file, path).map_err(failed)?;
    Ok(MappedBytes::whole(Arc::new(map)))
}

impl Unzipped {
    fn start(file: MappedBytes) -> Result<Self> {
        let mut rest = GzipMembers::new(file);
        let mut head = Vec::new();
        (&mut rest)
            .take(LONGEST_HEADER as u64)
            .read_to_end(&mut head)
            .map_err(|cause| damaged(&cause))?;
        if head.is_empty() {
            return Err(Error::input("the file is empty inside its gzip wrapping"));
        }
        Ok(Self { head, rest })
    }
}

fn damaged(cause: &io::Error) -> Error {
    if cause.kind() == io::ErrorKind::UnexpectedEof {
        return Error::input("the gzip data end early: the file is cut off");
    }
    Error::input(format!("the gzip data are damaged: {cause}"))
}
