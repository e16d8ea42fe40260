//! The planes that a picture's passes leave on the device, and their way back to the host.

use crate::error::Result;
use crate::extent::ImageSize;
use crate::frame::{Certificate, Frame, Kind, Wanted};
use crate::gpu::{Buffer, Device, Element};
use crate::memory;
use crate::scene::Emission;
use crate::volume::Rescale;

use super::passes::Counters;

/// Planes of a picture on the device; the optional ones were wanted, or needed on the way.
pub struct Planes {
    pub color: Buffer<[f32; 4]>,
    pub display: Option<Buffer<[f32; 4]>>,
    pub depth: Option<Buffer<f32>>,
    pub normal: Option<Buffer<[f32; 4]>>,
    /// In stored units.
    pub value: Option<Buffer<f32>>,
    /// `None`: of a medium, which is there where it is opaque enough to have layers.
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
    /// wanted layer that the picture does not have (a projection's normal) is filled with what "nothing"
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
        let color = self.color.download(device)?;
        let kind = match &self.kind {
            Some(_) => layers.plane(wanted.kind || wanted.value, self.kind.as_ref(), nothing)?,
            None => (wanted.kind || wanted.value).then(|| kind_of_medium(&color)),
        };
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
            color,
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

/// A medium is a surface where it is opaque enough to have layers.
fn kind_of_medium(color: &[[f32; 4]]) -> Vec<u32> {
    let kind = |&[_, _, _, opacity]: &[f32; 4]| {
        if opacity >= Emission::LAYERS_FROM {
            Kind::Surface
        } else {
            Kind::Nothing
        }
    };
    color.iter().map(|color| kind(color) as u32).collect()
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
