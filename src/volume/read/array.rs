//! From a parsed header and its payload to a volume, for all formats.

use std::io::Read;

use super::element::{self, Element, Loss, Scalar};
use super::frames::Frames;
use super::payload::{MappedBytes, Payload};
use super::{ReadOptions, Request};
use crate::error::{Error, Result};
use crate::extent::Dims;
use crate::volume::{Geometry, Rescale, Volume, VoxelBuffer, VoxelType, Voxels};

/// The voxels as a header describes them, whatever its format.
pub(super) struct Array {
    pub(super) dims: Dims,
    pub(super) frames: Frames,
    pub(super) element: Element,
    pub(super) geometry: Geometry,
    pub(super) rescale: Rescale,
    pub(super) notes: Vec<String>,
}

impl Array {
    /// The bytes of all frames.
    ///
    /// # Errors
    /// More than any file has.
    pub(super) fn total_bytes(&self) -> Result<u64> {
        self.frames
            .total_bytes(self.dims, self.element.scalar.bytes())
    }

    /// Reads the voxels: in place where they lie ready in a mapped file, else into memory.
    ///
    /// # Errors
    /// The payload is shorter than announced or damaged; see [`Volume::new`].
    pub(super) fn read(mut self, payload: Payload, request: &Request) -> Result<Volume> {
        let voxels = self.voxels(payload, request)?;
        self.into_volume(voxels, request.options)
    }

    /// The volume of voxels that are read already.
    pub(super) fn into_volume(self, voxels: Voxels, options: &ReadOptions) -> Result<Volume> {
        let volume = Volume::new(
            self.dims,
            voxels,
            self.geometry,
            self.rescale,
            options.non_finite,
        )?;
        Ok(self.notes.into_iter().fold(volume, Volume::with_note))
    }

    /// Reads the voxels alone; compare [`Array::read`].
    pub(super) fn voxels(&mut self, payload: Payload, request: &Request) -> Result<Voxels> {
        let total = self.total_bytes()?;
        let frame_bytes = self.dims.voxels() * self.element.scalar.bytes();
        let certain = matches!(payload, Payload::Mapped(_));
        if let Payload::Mapped(bytes) = &payload {
            if bytes.len() < total {
                return Err(Error::input(format!(
                    "{total} bytes of voxels announced, but only {} are there: the file is cut off or its header wrong",
                    bytes.len()
                )));
            }
            if bytes.len() > total {
                self.note_rest(&format!("{} bytes", bytes.len() - total));
            }
        }
        (request.accept)(self.dims, self.element.scalar.voxel_type())?;
        request.progress.begin("reading", frame_bytes);
        let voxels = match &payload {
            Payload::Mapped(bytes) => self.in_place(bytes)?,
            Payload::Stream { .. } => None,
        };
        let voxels = match voxels {
            Some(voxels) => {
                request.progress.advance(frame_bytes);
                voxels
            }
            None => self.copy(payload, total, certain, request)?,
        };
        request.progress.end();
        Ok(voxels)
    }

    fn in_place(&self, bytes: &MappedBytes) -> Result<Option<Voxels>> {
        if !self.element.is_usable_in_place() || !self.frames.is_contiguous(self.dims) {
            return Ok(None);
        }
        let size = self.element.scalar.bytes();
        let len = usize_voxels(self.dims)?;
        let before = self.frames.chosen * self.frames.run * size;
        let offset = bytes.clone().after(before)?.start();
        let map = bytes.map();
        Ok(match self.element.scalar.voxel_type() {
            VoxelType::U8 => VoxelBuffer::mapped(map, offset, len)?.map(Voxels::U8),
            VoxelType::U16 => VoxelBuffer::mapped(map, offset, len)?.map(Voxels::U16),
            VoxelType::I16 => VoxelBuffer::mapped(map, offset, len)?.map(Voxels::I16),
            VoxelType::F32 => VoxelBuffer::mapped(map, offset, len)?.map(Voxels::F32),
        })
    }

    fn copy(
        &mut self,
        payload: Payload,
        total: u64,
        certain: bool,
        request: &Request,
    ) -> Result<Voxels> {
        let len = usize_voxels(self.dims)?;
        let size = self.element.scalar.bytes();
        let (mut reader, max_bytes) = payload.into_reader();
        if max_bytes < total {
            return Err(Error::input(format!(
                "{total} bytes of voxels announced, but the data cannot hold more than {max_bytes}"
            )));
        }
        let read = |reader: &mut dyn Read| {
            element::read_voxels(reader, self.element, len, certain, request.progress)
        };
        let converted = if self.frames.count == 1 {
            read(&mut reader)?
        } else {
            read(&mut self.frames.pick(&mut reader, size))?
        };
        // One byte more: at the data's end a decoder verifies its checksum.
        if !certain && self.frames.chosen + 1 == self.frames.count {
            let mut beyond = [0];
            match reader.read(&mut beyond) {
                Ok(0) => {}
                Ok(_) => self.note_rest("data"),
                Err(cause) => {
                    return Err(Error::input(format!("the voxels are damaged: {cause}")));
                }
            }
        }
        self.note_loss(converted.loss);
        self.rescale = self.rescale.after(converted.rescale);
        Ok(converted.voxels)
    }

    fn note_rest(&mut self, what: &str) {
        self.notes
            .push(format!("the file has {what} after the voxels: ignored"));
    }

    fn note_loss(&mut self, loss: Loss) {
        if loss.changed == 0 {
            return;
        }
        let mut note = format!(
            "{} of {} voxels lose digits as f32 (the file has {})",
            loss.changed,
            self.dims.voxels(),
            self.element.scalar.name()
        );
        if loss.largest > 0.0 {
            note.push_str(&format!(
                ": at most {:.1e}, which is {:.1e} of the value range",
                loss.largest * self.rescale.slope.abs(),
                loss.largest / loss.width
            ));
        }
        if loss.clamped > 0 {
            note.push_str(&format!(
                "; {} beyond its range are read as ±{:e}",
                loss.clamped,
                f32::MAX
            ));
        }
        self.notes.push(note);
    }
}

/// The voxel count as an array size.
fn usize_voxels(dims: Dims) -> Result<usize> {
    usize::try_from(dims.voxels())
        .map_err(|_| Error::resource(format!("{dims} voxels do not fit this machine's memory")))
}

/// Colour and vector volumes: which several formats declare, each in its own form.
pub(super) fn refuse_components(count: u64, scalar: Option<Scalar>) -> Error {
    let of = scalar.map_or(String::new(), |scalar| format!(" of {}", scalar.name()));
    Error::input(format!(
        "{count} components{of} a voxel: colour and vector volumes are not supported by this version"
    ))
    .hint("extract one component, or the brightness, into a scalar volume first")
}
