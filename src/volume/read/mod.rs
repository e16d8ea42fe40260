//! Volume files to volumes. A file is recognised by what it contains; gzip around any of the
//! formats is looked through.
//!
//! Each format's file turns its header into an `Array` (sizes, number type, geometry) and a
//! `Payload` (where the bytes come from); from there on all are read alike.

mod array;
mod element;
mod files;
mod frames;
mod metaimage;
mod narrow;
mod nifti;
mod npz;
mod nrrd;
mod nrrd_axes;
mod numpy;
mod parts;
mod payload;
mod raw;
mod source;
mod text;

pub use parts::files_of;
pub use raw::{RawLayout, RawSize, RawType};

use std::path::Path;

use self::source::Source;
use crate::error::{Error, Result};
use crate::extent::Dims;
use crate::progress::{Progress, Silent};
use crate::volume::{NonFinite, Volume, VoxelType};

/// The user's options for reading a file.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReadOptions {
    /// The index of the volume of a series (4-D) that is read; 0 is the first.
    pub frame: u32,
    /// The treatment of NaN and ±Inf voxels.
    pub non_finite: NonFinite,
    /// The layout of a headerless file.
    pub raw: RawLayout,
}

/// Who asks for what.
struct Request<'a> {
    path: &'a Path,
    options: &'a ReadOptions,
    progress: &'a dyn Progress,
    accept: Accept<'a>,
}

/// A check of whether the caller can use a volume of this size, whose voxels will be held as this type.
pub type Accept<'a> = &'a dyn Fn(Dims, VoxelType) -> Result<()>;

/// Reads a volume file: NRRD, MetaImage, NIfTI-1/2, NumPy (.npy, .npz) or headerless voxels, each
/// also gzipped. Geometry comes out in mm, LPS; a file without any has spacing 1, origin 0,
/// identity direction. Uncompressed native-endian voxels are mapped, all others decoded once.
///
/// # Errors
/// `path: cause`, in one sentence: unreadable, unknown, unsupported, cut off, or lying files
/// (failed); a frame the file does not have, an incomplete headerless description (usage).
pub fn read(path: &Path, options: &ReadOptions, progress: &dyn Progress) -> Result<Volume> {
    read_if(path, options, progress, &|_, _| Ok(()))
}

impl Volume {
    /// Opens a volume file of any format that is recognised: the first volume of a series, values that are not
    /// finite replaced by the smallest finite one. [`read`] has options and reports progress.
    ///
    /// # Errors
    /// As [`read`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        read(path.as_ref(), &ReadOptions::default(), &Silent)
    }
}

/// Reads a volume as [`read`] does, if `accept` accepts what the header says; it is called before any
/// voxel is read.
///
/// # Errors
/// Those of [`read`] and of `accept`, behind the path.
pub fn read_if(
    path: &Path,
    options: &ReadOptions,
    progress: &dyn Progress,
    accept: Accept<'_>,
) -> Result<Volume> {
    let request = Request {
        path,
        options,
        progress,
        accept,
    };
    Source::open(path)
        .and_then(|source| read_source(source, &request))
        .map_err(|error| shortened(error).at(path.display()))
}

/// Messages quote headers, which may be of any length.
fn shortened(error: Error) -> Error {
    const LONGEST: usize = 400;
    let message = error.to_string();
    let Some((end, _)) = message.char_indices().nth(LONGEST) else {
        return error;
    };
    let short = Error::new(error.kind(), format!("{}…", &message[..end]));
    match error.hint_text() {
        Some(hint) => short.hint(hint),
        None => short,
    }
}

fn read_source(source: Source, request: &Request) -> Result<Volume> {
    if raw::is_requested(request) {
        return raw::read(source, request);
    }
    let head = source.head();
    if nrrd::is_nrrd(head) {
        nrrd::read(source, request)
    } else if nifti::is_nifti(head) {
        nifti::read(source, request)
    } else if numpy::is_npy(head) {
        numpy::read(source, request)
    } else if npz::is_zip(head) {
        npz::read(&source, request)
    } else if metaimage::is_metaimage(head) {
        metaimage::read(source, request)
    } else if let Some(header) = nifti::header_beside(request.path) {
        nifti::read_header_beside(&header, request)
    } else if raw::is_named(request.path) {
        raw::read(source, request)
    } else if let Some(name) = foreign_format(head) {
        Err(
            Error::input(format!("this is {name}, which this version does not read"))
                .hint("convert it to NRRD, MetaImage, NIfTI or NumPy"),
        )
    } else {
        Err(raw::unrecognised(source))
    }
}

/// Formats that are known by their first bytes but not read.
fn foreign_format(head: &[u8]) -> Option<&'static str> {
    const SIGNATURES: [(usize, &[u8], &str); 16] = [
        (128, b"DICM", "a DICOM file"),
        (0, b"II*\0", "a TIFF file"),
        (0, b"MM\0*", "a TIFF file"),
        (0, b"II+\0", "a BigTIFF file"),
        (0, b"MM\0+", "a BigTIFF file"),
        (0, b"# vtk DataFile", "a legacy VTK file"),
        (0, b"\x89PNG\r\n\x1a\n", "a PNG picture"),
        (0, b"\xff\xd8\xff", "a JPEG picture"),
        (0, b"\x89HDF\r\n\x1a\n", "an HDF5 file"),
        (0, b"CDF\x01", "a NetCDF file"),
        (0, b"CDF\x02", "a NetCDF file"),
        (0, b"BZh", "a bzip2-compressed file"),
        (0, b"\xfd7zXZ\0", "an xz-compressed file"),
        (0, b"\x28\xb5\x2f\xfd", "a zstd-compressed file"),
        (0, b"7z\xbc\xaf\x27\x1c", "a 7-Zip archive"),
        (0, b"%PDF-", "a PDF document"),
    ];
    let by_signature = SIGNATURES.iter().find(|(offset, signature, _)| {
        head.get(*offset..)
            .is_some_and(|rest| rest.starts_with(signature))
    });
    if let Some((_, _, name)) = by_signature {
        return Some(name);
    }
    let start = &head[..head.len().min(1024)];
    let has = |needle: &[u8]| start.windows(needle.len()).any(|part| part == needle);
    if start.trim_ascii_start().starts_with(b"<") && has(b"<VTKFile") {
        return Some("a VTK XML file");
    }
    nifti::is_analyze(head).then_some("an Analyze 7.5 header, which has no orientation")
}
