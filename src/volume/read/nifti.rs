//! NIfTI-1 and NIfTI-2: .nii, .hdr/.img pairs, each part also gzipped.
//!
//! Source: the nifti1.h and nifti2.h headers of the NIfTI Data Format Working Group.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::Request;
use super::array::{Array, refuse_components};
use super::element::{Element, Endian, Scalar};
use super::frames::Frames;
use super::payload::Payload;
use super::source::{Source, open_plain};
use crate::error::{Error, Result};
use crate::volume::{Geometry, Rescale, Volume};

const SIZE_1: u32 = 348;
const SIZE_2: u32 = 540;

/// A header's bytes with the byte order its size field betrays.
struct Bytes<'a> {
    bytes: &'a [u8],
    endian: Endian,
}

macro_rules! getter {
    ($name:ident, $t:ty) => {
        fn $name(&self, offset: usize) -> $t {
            let mut number = [0; size_of::<$t>()];
            number.copy_from_slice(&self.bytes[offset..offset + size_of::<$t>()]);
            match self.endian {
                Endian::Little => <$t>::from_le_bytes(number),
                Endian::Big => <$t>::from_be_bytes(number),
            }
        }
    };
}

impl Bytes<'_> {
    getter!(i16, i16);
    getter!(i32, i32);
    getter!(i64, i64);
    getter!(f32, f32);
    getter!(f64, f64);
}

/// The header's size (which gives the version) and byte order.
fn size_and_endian(head: &[u8]) -> Option<(u32, Endian)> {
    let size = head.first_chunk::<4>()?;
    [Endian::Little, Endian::Big]
        .into_iter()
        .find_map(|endian| {
            let size = match endian {
                Endian::Little => u32::from_le_bytes(*size),
                Endian::Big => u32::from_be_bytes(*size),
            };
            (size == SIZE_1 || size == SIZE_2).then_some((size, endian))
        })
}

/// `n+1`, `ni1` and so on, without the bytes behind it.
fn magic(head: &[u8], size: u32) -> Option<&[u8]> {
    let offset = if size == SIZE_1 { 344 } else { 4 };
    head.get(offset..offset + 4)
}

pub(super) fn is_nifti(head: &[u8]) -> bool {
    size_and_endian(head).is_some_and(|(size, _)| {
        magic(head, size).is_some_and(|magic| match size {
            SIZE_1 => magic == b"n+1\0" || magic == b"ni1\0",
            _ => magic == b"n+2\0" || magic == b"ni2\0",
        })
    })
}

/// The predecessor: the same size, no magic, and a plausible number of axes.
pub(super) fn is_analyze(head: &[u8]) -> bool {
    head.len() == SIZE_1 as usize
        && size_and_endian(head).is_some_and(|(size, endian)| {
            let bytes = Bytes {
                bytes: head,
                endian,
            };
            size == SIZE_1 && (1..=7).contains(&bytes.i16(40))
        })
}

/// Both versions' fields, in the wider one's types.
struct Header {
    bytes: u64,
    endian: Endian,
    is_pair: bool,
    datatype: i16,
    dim: [i64; 8],
    pixdim: [f64; 8],
    vox_offset: f64,
    slope: f64,
    intercept: f64,
    units: i32,
    qform_code: i32,
    sform_code: i32,
    quatern: DVec3,
    qoffset: DVec3,
    srow: [[f64; 4]; 3],
}

impl Header {
    fn parse(head: &[u8]) -> Result<Self> {
        let (size, endian) = size_and_endian(head)
            .filter(|&(size, _)| head.len() >= size as usize)
            .ok_or_else(|| Error::input("the NIfTI header is cut off"))?;
        let is_pair = magic(head, size).is_some_and(|magic| magic.starts_with(b"ni"));
        let b = Bytes {
            bytes: head,
            endian,
        };
        let single = |offset| f64::from(b.f32(offset));
        Ok(if size == SIZE_1 {
            Self {
                bytes: u64::from(size),
                endian,
                is_pair,
                datatype: b.i16(70),
                dim: std::array::from_fn(|i| i64::from(b.i16(40 + 2 * i))),
                pixdim: std::array::from_fn(|i| single(76 + 4 * i)),
                vox_offset: single(108),
                slope: single(112),
                intercept: single(116),
                units: i32::from(head[123]),
                qform_code: i32::from(b.i16(252)),
                sform_code: i32::from(b.i16(254)),
                quatern: DVec3::new(single(256), single(260), single(264)),
                qoffset: DVec3::new(single(268), single(272), single(276)),
                srow: std::array::from_fn(|row| {
                    std::array::from_fn(|column| single(280 + 16 * row + 4 * column))
                }),
            }
        } else {
            Self {
                bytes: u64::from(size),
                endian,
                is_pair,
                datatype: b.i16(12),
                dim: std::array::from_fn(|i| b.i64(16 + 8 * i)),
                pixdim: std::array::from_fn(|i| b.f64(104 + 8 * i)),
                vox_offset: b.i64(168) as f64,
                slope: b.f64(176),
                intercept: b.f64(184),
                units: b.i32(500),
                qform_code: b.i32(344),
                sform_code: b.i32(348),
                quatern: DVec3::new(b.f64(352), b.f64(360), b.f64(368)),
                qoffset: DVec3::new(b.f64(376), b.f64(384), b.f64(392)),
                srow: std::array::from_fn(|row| {
                    std::array::from_fn(|column| b.f64(400 + 32 * row + 8 * column))
                }),
            }
        })
    }

    /// x, y, z, and all further axes as one of frames. After the first, an axis of none counts as one
    /// of one, as the NIfTI library reads it.
    fn sizes(&self) -> Result<[u64; 4]> {
        let axes = self.dim[0];
        if !(1..=7).contains(&axes) {
            return Err(Error::input(format!("the header announces {axes} axes")));
        }
        let mut sizes = [1u64; 4];
        for (axis, &size) in self.dim[1..=axes as usize].iter().enumerate() {
            let size = if axis > 0 { size.max(1) } else { size };
            let grown = u64::try_from(size)
                .ok()
                .and_then(|size| sizes[axis.min(3)].checked_mul(size));
            sizes[axis.min(3)] = grown.ok_or_else(|| {
                Error::input(format!("the header announces sizes {:?}", &self.dim[1..]))
            })?;
        }
        Ok(sizes)
    }

    fn scalar(&self) -> Result<Scalar> {
        Ok(match self.datatype {
            2 => Scalar::U8,
            4 => Scalar::I16,
            8 => Scalar::I32,
            16 => Scalar::F32,
            64 => Scalar::F64,
            256 => Scalar::I8,
            512 => Scalar::U16,
            768 => Scalar::U32,
            1024 => Scalar::I64,
            1280 => Scalar::U64,
            128 => return Err(refuse_components(3, Some(Scalar::U8))),
            2304 => return Err(refuse_components(4, Some(Scalar::U8))),
            32 | 1792 | 2048 => {
                return Err(Error::input("complex numbers are not supported")
                    .hint("write their magnitude into a volume first"));
            }
            1 => return Err(Error::input("volumes of single bits are not supported")),
            1536 => return Err(Error::input("128-bit floats are not supported")),
            other => {
                return Err(Error::input(format!(
                    "the header's datatype {other} is unknown"
                )));
            }
        })
    }

    /// A slope of 0 means none; so does one that is no number, as nibabel reads it.
    fn rescale(&self) -> Rescale {
        if self.slope == 0.0 || !self.slope.is_finite() || !self.intercept.is_finite() {
            return Rescale::IDENTITY;
        }
        Rescale {
            slope: self.slope,
            intercept: self.intercept,
        }
    }

    /// Voxel sizes in the file's unit; those that are 0 or no number become 1.
    fn spacing(&self, notes: &mut Vec<String>) -> DVec3 {
        let sizes = DVec3::new(self.pixdim[1], self.pixdim[2], self.pixdim[3]).abs();
        let usable = |size: f64| size.is_finite() && size > 0.0;
        if sizes.to_array().into_iter().all(usable) {
            return sizes;
        }
        notes.push(format!(
            "the voxel size {sizes} is taken as 1 where it is not a length"
        ));
        DVec3::from_array(
            sizes
                .to_array()
                .map(|size| if usable(size) { size } else { 1.0 }),
        )
    }

    /// World from index in the file's unit, RAS, by the qform ("method 2" in nifti1.h).
    fn qform(&self, spacing: DVec3) -> DAffine3 {
        let imaginary = self.quatern.length_squared();
        // Rounding may have left a half turn's quaternion a little too long.
        let quaternion = if imaginary < 1.0 {
            let [b, c, d] = self.quatern.to_array();
            DQuat::from_xyzw(b, c, d, (1.0 - imaginary).sqrt())
        } else {
            let [b, c, d] = (self.quatern / imaginary.sqrt()).to_array();
            DQuat::from_xyzw(b, c, d, 0.0)
        };
        let handedness = if self.pixdim[0] < 0.0 { -1.0 } else { 1.0 };
        let scale = spacing * DVec3::new(1.0, 1.0, handedness);
        DAffine3 {
            matrix3: DMat3::from_quat(quaternion) * DMat3::from_diagonal(scale),
            translation: self.qoffset,
        }
    }

    /// The orientation by the sform ("method 3"); compare [`Header::qform`].
    fn sform(&self) -> DAffine3 {
        let column = |c: usize| DVec3::new(self.srow[0][c], self.srow[1][c], self.srow[2][c]);
        DAffine3 {
            matrix3: DMat3::from_cols(column(0), column(1), column(2)),
            translation: column(3),
        }
    }

    /// A sentence where the volume would lie elsewhere, by more than a hundredth of a voxel, by the
    /// qform or, where that is not set, with the voxel sizes of `pixdim`.
    fn disagreement(
        &self,
        taken: &Geometry,
        lps_mm: &dyn Fn(DAffine3) -> Result<Geometry>,
        unit_mm: f64,
    ) -> Option<String> {
        const ALIKE_VOXELS: f64 = 0.01;
        // A size that is no length says nothing.
        let own = taken.spacing_mm() / unit_mm;
        let sizes = DVec3::from_array([0, 1, 2].map(|axis| {
            let size = self.pixdim[axis + 1].abs();
            let is_length = size.is_finite() && size > 0.0;
            if is_length { size } else { own[axis] }
        }));
        let (name, other) = if self.qform_code > 0 {
            ("the qform", lps_mm(self.qform(sizes)).ok()?)
        } else {
            let (origin, direction) = (taken.origin_mm(), taken.direction());
            let other = Geometry::new(origin, direction, sizes * unit_mm).ok()?;
            ("its voxel sizes (pixdim)", other)
        };
        let far = DVec3::from_array([1, 2, 3].map(|axis| (self.dim[axis].max(1) - 1) as f64));
        let (a, b) = (taken.world_from_index(), other.world_from_index());
        let apart = (0..8).map(|corner| {
            let pick = |axis: usize| f64::from(corner >> axis & 1) * far[axis];
            let corner = DVec3::new(pick(0), pick(1), pick(2));
            a.transform_point3(corner)
                .distance(b.transform_point3(corner))
        });
        let apart_mm = apart.fold(0.0, f64::max);
        let mm = |g: &Geometry| {
            let [x, y, z] = g.spacing_mm().to_array().map(|s| (s * 1e4).round() / 1e4);
            format!("{x} x {y} x {z}")
        };
        (apart_mm > ALIKE_VOXELS * taken.smallest_spacing_mm()).then(|| {
            format!(
                "the file's sform (voxels of {} mm) and {name} ({} mm) place the volume differently, its corners up to {} mm apart: the sform is taken",
                mm(taken),
                mm(&other),
                (apart_mm * 1e3).round() / 1e3
            )
        })
    }

    /// The geometry in mm, LPS: the sform if it is set and spans space, else the qform, else the voxel
    /// sizes alone with axes along the world's (as ITK does).
    fn geometry(&self, notes: &mut Vec<String>) -> Result<Geometry> {
        let unit_mm = match self.units & 7 {
            1 => 1000.0,
            3 => 0.001,
            _ => 1.0,
        };
        let lps_mm = |world_ras: DAffine3| {
            let to = DMat3::from_diagonal(DVec3::new(-1.0, -1.0, 1.0) * unit_mm);
            Geometry::from_affine(DAffine3 {
                matrix3: to * world_ras.matrix3,
                translation: to * world_ras.translation,
            })
        };
        if self.sform_code > 0 {
            match lps_mm(self.sform()) {
                Ok(geometry) => {
                    notes.extend(self.disagreement(&geometry, &lps_mm, unit_mm));
                    return Ok(geometry);
                }
                Err(error) => notes.push(format!("the sform is ignored: {error}")),
            }
        }
        let spacing = self.spacing(notes);
        if self.qform_code > 0 {
            match lps_mm(self.qform(spacing)) {
                Ok(geometry) => return Ok(geometry),
                Err(error) => notes.push(format!("the qform is ignored: {error}")),
            }
        }
        Geometry::new(DVec3::ZERO, DMat3::IDENTITY, spacing * unit_mm)
    }
}

/// Reads a .nii, or a .hdr with its .img.
pub(super) fn read(source: Source, request: &Request) -> Result<Volume> {
    let header = Header::parse(source.head())?;
    let mut notes = Vec::new();
    let (dims, frames, note) = Frames::choose(&header.sizes()?, Some(3), request.options.frame)?;
    notes.extend(note);
    let geometry = header.geometry(&mut notes)?;
    let array = Array {
        dims,
        frames,
        element: Element {
            scalar: header.scalar()?,
            endian: header.endian,
        },
        geometry,
        rescale: header.rescale(),
        notes,
    };
    if !(0.0..1e15).contains(&header.vox_offset) {
        return Err(Error::input(format!(
            "the voxels cannot start at byte {}",
            header.vox_offset
        )));
    }
    let offset = header.vox_offset as u64;
    if header.is_pair {
        let path = image_beside(request.path)?;
        let is_zipped = path.extension().is_some_and(|ending| ending == "gz");
        let image = if is_zipped {
            Source::open(&path).map(Source::into_payload)
        } else {
            open_plain(&path).map(Payload::Mapped)
        };
        let payload = image
            .and_then(|image| image.skip(offset))
            .map_err(|error| error.at(path.display()))?;
        return array.read(payload, request);
    }
    // Writers that leave the offset 0 mean: right after the header and its extension flag.
    let payload = source.into_payload().skip(offset.max(header.bytes + 4))?;
    array.read(payload, request)
}

/// `dir/name.img.gz` to `dir/name`, when the name has that ending.
fn stem(path: &Path, ending: &str) -> Option<OsString> {
    let text = path.file_name()?.to_str()?;
    let lower = text.to_ascii_lowercase();
    let plain = lower.strip_suffix(".gz").unwrap_or(&lower);
    let length = plain.strip_suffix(ending)?.len();
    // Lowering ASCII letters keeps every byte's place.
    Some(path.with_file_name(&text[..length]).into_os_string())
}

/// The first of the names that is there.
fn existing(stem: &OsString, endings: &[&str]) -> Option<PathBuf> {
    endings.iter().find_map(|ending| {
        let mut name = stem.clone();
        name.push(ending);
        let path = PathBuf::from(name);
        path.is_file().then_some(path)
    })
}

/// The header that belongs to an .img file.
pub(super) fn header_beside(path: &Path) -> Option<PathBuf> {
    existing(
        &stem(path, ".img")?,
        &[".hdr", ".hdr.gz", ".HDR", ".HDR.gz"],
    )
}

/// Reads a pair whose .img was named by the user.
pub(super) fn read_header_beside(header: &Path, request: &Request) -> Result<Volume> {
    let read_header = || {
        let source = Source::open(header)?;
        if !is_nifti(source.head()) {
            return Err(Error::input(
                "is not a NIfTI header (of such pairs, Analyze 7.5 is not supported)",
            ));
        }
        let request = Request {
            path: header,
            ..*request
        };
        read(source, &request)
    };
    read_header().map_err(|error| error.at(header.display()))
}

/// The .img that belongs to a header, whatever the header is called.
pub(super) fn image_beside(header: &Path) -> Result<PathBuf> {
    let stem = stem(header, ".hdr").unwrap_or_else(|| header.with_extension("").into_os_string());
    existing(&stem, &[".img", ".img.gz", ".IMG", ".IMG.gz"]).ok_or_else(|| {
        Error::input("this is the header of a NIfTI pair, but no .img lies beside it")
    })
}
