//! The planes that a picture's passes leave on the device, and their way back to the host.

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::frame::{Frame, Wanted};
use crate::gpu::{Buffer, Device, DeviceKind};

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
    // Colour, normal, hit, kind, value, depth, and both counters.
    let on_device = 2 * COLOR + 6 * SCALAR + display;
    let read_back = match device.info().kind {
        DeviceKind::Cpu => on_device,
        DeviceKind::Gpu | DeviceKind::Accelerator => 0,
    };
    let bytes = size.pixels() as u64 * (on_device + read_back) + held_bytes;
    let memory_bytes = device.info().memory_bytes;
    if bytes <= memory_bytes {
        return Ok(());
    }
    Err(Error::failed(format!(
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
    pub value: Option<Buffer<f32>>,
    pub kind: Option<Buffer<u32>>,
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
            + counters
            + self.other_bytes
    }

    /// Waits for the passes and copies the wanted planes. A wanted layer that the picture does not
    /// have (a dvr's depth) is filled with what "nothing" means for it.
    ///
    /// # Errors
    /// The device failed.
    pub fn read_back(&self, device: &Device, size: ImageSize, wanted: Wanted) -> Result<Frame> {
        let pixels = size.pixels();
        let scalar =
            |plane: &Option<Buffer<f32>>, wanted: bool, nothing: f32| -> Result<Option<Vec<f32>>> {
                Ok(match (wanted, plane) {
                    (false, _) => None,
                    (true, Some(plane)) => Some(plane.download(device)?),
                    (true, None) => Some(vec![nothing; pixels]),
                })
            };
        let normal = match (wanted.normal, &self.normal) {
            (false, _) => None,
            (true, Some(plane)) => {
                let padded = plane.download(device)?;
                Some(padded.into_iter().map(|[x, y, z, _]| [x, y, z]).collect())
            }
            (true, None) => Some(vec![[0.0; 3]; pixels]),
        };
        let kind = match (wanted.kind, &self.kind) {
            (false, _) => None,
            (true, Some(plane)) => Some(plane.download(device)?),
            (true, None) => Some(vec![0; pixels]),
        };
        let (steps, nodes) = match (wanted.counters, &self.counters) {
            (true, Some(counters)) => (
                Some(counters.steps.download(device)?),
                Some(counters.nodes.download(device)?),
            ),
            _ => (None, None),
        };
        Ok(Frame {
            size,
            color: self.color.download(device)?,
            display: self
                .display
                .as_ref()
                .map(|plane| plane.download(device))
                .transpose()?,
            depth: scalar(&self.depth, wanted.depth, f32::INFINITY)?,
            normal,
            value: scalar(&self.value, wanted.value, 0.0)?,
            steps,
            nodes,
            kind,
        })
    }
}
