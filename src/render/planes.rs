//! The planes that a picture's passes leave on the device, and their way back to the host.

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::frame::{Certificate, Frame, Kind, Wanted};
use crate::gpu::{Buffer, Device, DeviceKind, Element};
use crate::memory;
use crate::volume::Rescale;

use super::passes::Counters;

/// Fails before anything is allocated when a frame of this size cannot fit. Counts the most that a
/// picture with these planes can hold; on a CPU the copies that are read back come out of the same
/// memory.
///
/// # Errors
/// The planes, with `held_bytes` of volume and octree, exceed the device's memory.
pub fn check_room(device: &Device, size: ImageSize, wanted: Wanted, held_bytes: u64) -> Result<()> {
    const COLOR: u64 = 16;
    const SCALAR: u64 = 4;
    let display = if wanted.display { COLOR } else { 0 };
    // Colour, normal, hit, kind, certificate, value, depth, and both counters.
    let on_device = 2 * COLOR + 7 * SCALAR + display;
    let read_back = match device.info().kind {
        DeviceKind::Cpu => on_device,
        DeviceKind::Gpu | DeviceKind::Accelerator => 0,
    };
    let bytes = size.pixels() as u64 * (on_device + read_back) + held_bytes;
    let memory_bytes = device.info().memory_bytes;
    if bytes <= memory_bytes {
        return Ok(());
    }
    Err(Error::resource(format!(
        "a picture of {size} pixels needs up to {bytes} bytes with its volume, the device '{}' has {memory_bytes}",
        device.info().name
    ))
    .hint("choose a smaller --size"))
}

/// Planes of a picture on the device; the optional ones were wanted, or needed on the way.
pub struct Planes {
    pub color: Buffer<[f32; 4]>,
    pub display: Option<Buffer<[f32; 4]>>,
    pub depth: Option<Buffer<f32>>,
    pub normal: Option<Buffer<[f32; 4]>>,
    /// In stored units.
    pub value: Option<Buffer<f32>>,
    pub kind: Option<Buffer<u32>>,
    pub certificate: Option<Buffer<u32>>,
    pub counters: Option<Counters>,
    /// Of tables and planes that only the passes needed.
    pub other_bytes: u64,
}

impl Planes {
    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        fn of<T>(plane: Option<&Buffer<T>>) -> u64 {
            plane.map_or(0, |buffer| buffer.bytes())
        }
        let counters = self.counters.as_ref().map_or(0, |counters| {
            counters.steps.bytes() + counters.nodes.bytes()
        });
        self.color.bytes()
            + of(self.display.as_ref())
            + of(self.depth.as_ref())
            + of(self.normal.as_ref())
            + of(self.value.as_ref())
            + of(self.kind.as_ref())
            + of(self.certificate.as_ref())
            + counters
            + self.other_bytes
    }

    /// Waits for the passes and copies the wanted planes; values become physical by `rescale`. A
    /// wanted layer that the picture does not have (a dvr's depth) is filled with what "nothing"
    /// means for it.
    ///
    /// # Errors
    /// The device failed.
    pub fn read_back(
        &self,
        device: &Device,
        size: ImageSize,
        wanted: Wanted,
        rescale: Rescale,
    ) -> Result<Frame> {
        let layers = ReadBack { device, size };
        let nothing = Kind::Nothing as u32;
        let kind = layers.plane(wanted.kind || wanted.value, self.kind.as_ref(), nothing)?;
        let mut value = layers.plane(wanted.value, self.value.as_ref(), 0.0)?;
        if let (Some(value), Some(kind)) = (&mut value, &kind) {
            for (value, &kind) in value.iter_mut().zip(kind) {
                if kind != nothing {
                    *value = rescale.physical(f64::from(*value)) as f32;
                }
            }
        }
        let normal = layers.plane(wanted.normal, self.normal.as_ref(), [0.0; 4])?;
        let counter = |of: fn(&Counters) -> &Buffer<u32>| {
            layers.plane(wanted.counters, self.counters.as_ref().map(of), 0)
        };
        Ok(Frame {
            size,
            color: self.color.download(device)?,
            display: layers.plane(wanted.display, self.display.as_ref(), [0.0; 4])?,
            depth: layers.plane(wanted.depth, self.depth.as_ref(), f32::INFINITY)?,
            normal: normal.map(|plane| plane.into_iter().map(|[x, y, z, _]| [x, y, z]).collect()),
            value,
            steps: counter(|counters| &counters.steps)?,
            nodes: counter(|counters| &counters.nodes)?,
            kind: kind.filter(|_| wanted.kind),
            certificate: layers.plane(
                wanted.certificate,
                self.certificate.as_ref(),
                Certificate::Undecided as u32,
            )?,
        })
    }
}

/// The copying of planes of one size.
struct ReadBack<'a> {
    device: &'a Device,
    size: ImageSize,
}

impl ReadBack<'_> {
    /// A wanted plane, filled with `nothing` where the picture has none.
    fn plane<T: Element>(
        &self,
        wanted: bool,
        plane: Option<&Buffer<T>>,
        nothing: T,
    ) -> Result<Option<Vec<T>>> {
        Ok(match (wanted, plane) {
            (false, _) => None,
            (true, Some(plane)) => Some(plane.download(self.device)?),
            (true, None) => Some(memory::filled(
                self.size.pixels(),
                nothing,
                "a plane of the picture",
            )?),
        })
    }
}
