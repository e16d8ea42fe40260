//! The planes that a picture's passes leave on the device, and how they are downloaded to the host.

use crate::error::Result;
use crate::extent::ImageSize;
use crate::frame::{Frame, KIND, Kind, Layer, Plane, PlaneEntry, VALUE, Wanted};
use crate::gpu::{Buffer, Device};
use crate::render::abi::MARK_CAST;
use crate::render::passes::{Compared, Run};
use crate::render::resources::{DeviceLayers, Spans};
use crate::scene::Emission;
use crate::volume::Rescale;

use super::sample_check::SampleCheck;

/// What a picture's occlusion is estimated from.
pub struct ScreenPlanes {
    /// The spans of depths that rays spend inside the surface.
    pub spans: Spans,
    /// What is estimated of each hit's occlusion before it is smoothed.
    pub estimate: Buffer<f32>,
}

impl ScreenPlanes {
    /// Device memory held by a pixel, in bytes.
    pub const PIXEL_BYTES: u64 = 8 + 4;

    fn bytes(&self) -> u64 {
        let Self { spans, estimate } = self;
        spans.depths.bytes() + estimate.bytes()
    }
}

/// What is known of the rays through the centres of all pixels.
#[derive(Clone, Copy)]
pub struct Centers<'a> {
    /// Their layers.
    pub layers: &'a DeviceLayers,
    /// What their occlusion was estimated from, where it was.
    pub screen: Option<&'a ScreenPlanes>,
}

/// Planes of a picture on the device.
pub struct Planes {
    /// The colour: linear light, premultiplied.
    pub color: Buffer<[f32; 4]>,
    /// The picture as it is displayed, where that is wanted.
    pub display: Option<Buffer<[f32; 4]>>,
    /// The layers that are wanted, or were needed to make those; values are in stored units. A medium has no
    /// kind: it is there where it is opaque enough to have layers.
    pub layers: DeviceLayers,
    /// t of each hit, mm from the base plane; a surface's.
    pub hit_mm: Option<Buffer<f32>>,
    /// What reaches each hit of each light, where shadows are cast.
    pub lights_reached: Option<Buffer<[f32; 4]>>,
    /// What its occlusion is estimated from, where it is.
    pub screen: Option<ScreenPlanes>,
    /// The share of each pixel's rays that met something, where it is wanted.
    pub coverage: Option<Buffer<f32>>,
    /// The marks, which say which pixels were cast; `None`: all were.
    pub cast: Option<Buffer<u32>>,
    /// How much adaptive anti-aliasing may differ from the whole of it.
    pub check: Option<SampleCheck>,
    /// How far away the focal plane of the lens is along the view axis, mm.
    pub focus_mm: Option<f64>,
    /// The rays of each round.
    pub rays_per_round: Vec<u64>,
    /// Bytes of tables that only the passes needed.
    pub other_bytes: u64,
}

impl Planes {
    /// Room for the colour and these layers.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(run: &Run, layers: &[Layer]) -> Result<Self> {
        let mut planes = DeviceLayers::default();
        planes.allocate(run.device, &run.rays, layers)?;
        Ok(Self {
            color: run.plane("colour plane", [0.0; 4])?,
            display: None,
            layers: planes,
            hit_mm: None,
            lights_reached: None,
            screen: None,
            coverage: None,
            cast: None,
            check: None,
            focus_mm: None,
            rays_per_round: Vec::new(),
            other_bytes: 0,
        })
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        let display = self.display.as_ref().map_or(0, |display| display.bytes());
        let hit = self.hit_mm.as_ref().map_or(0, |hit| hit.bytes());
        let cast = self.cast.as_ref().map_or(0, |cast| cast.bytes());
        let reached = self
            .lights_reached
            .as_ref()
            .map_or(0, |reached| reached.bytes());
        let screen = self.screen.as_ref().map_or(0, |screen| screen.bytes());
        let layers = self.layers.bytes() + screen + reached;
        self.color.bytes() + display + hit + cast + layers + self.other_bytes
    }

    /// What is known of pixels' centres.
    pub fn centers(&self) -> Centers<'_> {
        Centers {
            layers: &self.layers,
            screen: self.screen.as_ref(),
        }
    }

    /// What pixels are compared by.
    pub fn compared(&self) -> Compared<'_> {
        Compared {
            color: &self.color,
            hit_mm: self.hit_mm.as_ref(),
            layers: Some(&self.layers),
        }
    }

    /// Waits for the passes and copies the wanted planes; values become physical by `rescale`. A
    /// wanted layer that the picture does not have (a projection's normal) holds its fill value.
    ///
    /// # Errors
    /// The device failed; not enough memory.
    pub fn read_back(
        &self,
        device: &Device,
        size: ImageSize,
        wanted: Wanted,
        rescale: Rescale,
    ) -> Result<Frame> {
        let display = self.display.as_ref().filter(|_| wanted.display);
        let mut frame = Frame {
            size,
            color: self.color.download(device)?,
            display: display.map(|plane| plane.download(device)).transpose()?,
            layers: Default::default(),
        };
        let with_kind =
            wanted.with_if(wanted.has_any([Layer::Value, Layer::Coverage]), Layer::Kind);
        for layer in with_kind.layers() {
            if let Some(plane) = self.plane(device, layer, &frame)? {
                frame.layers.insert_plane(layer, plane);
            }
        }
        rescale_values(&mut frame, rescale);
        if !wanted.has(Layer::Kind) {
            frame.layers.take(KIND);
        }
        Ok(frame)
    }

    /// The plane of a wanted layer.
    fn plane(&self, device: &Device, layer: Layer, frame: &Frame) -> Result<Option<Plane>> {
        if let Some(plane) = self.layers.download(device, layer)? {
            return Ok(Some(plane));
        }
        if layer == Layer::Coverage {
            return Ok(Some(Plane::Scalars(match &self.coverage {
                Some(coverage) => coverage.download(device)?,
                None => coverage_of_one(frame.plane(KIND).unwrap_or_default()),
            })));
        }
        if let (Layer::Cast, Some(cast)) = (layer, &self.cast) {
            let was_cast = |mark: u32| u32::from(mark == MARK_CAST);
            let marks = cast.download(device)?.into_iter();
            return Ok(Some(Plane::Counts(marks.map(was_cast).collect())));
        }
        if layer == Layer::Kind {
            // Fog may have taken opacity, but no depth.
            let depths = self.layers.download(device, Layer::Depth)?;
            let kinds = match depths.and_then(PlaneEntry::out_of) {
                Some(depths) => kinds_of(depths, |depth_mm: f32| depth_mm < f32::INFINITY),
                None => kinds_of(frame.color.clone(), |[_, _, _, opacity]: [f32; 4]| {
                    opacity >= Emission::LAYERS_FROM
                }),
            };
            return Ok(Some(Plane::Counts(kinds)));
        }
        let pixels = frame.size.pixels();
        let filled = |value| Plane::filled(value, pixels);
        layer.empty().map(filled).transpose()
    }
}

/// Makes stored values physical where something was met.
fn rescale_values(frame: &mut Frame, rescale: Rescale) {
    let Some(mut values) = frame.layers.take(VALUE) else {
        return;
    };
    let kinds = frame.plane(KIND).unwrap_or_default();
    for (value, &kind) in values.iter_mut().zip(kinds) {
        if kind != Kind::Nothing as u32 {
            *value = rescale.physical(f64::from(*value)) as f32;
        }
    }
    frame.layers.insert(VALUE, values);
}

/// What of each pixel its one ray met.
fn coverage_of_one(kinds: &[u32]) -> Vec<f32> {
    let coverage = |&kind: &u32| {
        if kind == Kind::Nothing as u32 {
            0.0
        } else {
            1.0
        }
    };
    kinds.iter().map(coverage).collect()
}

/// A medium is a surface where it is opaque enough to have layers.
fn kinds_of<T: Copy>(pixels: Vec<T>, has_layers: impl Fn(T) -> bool) -> Vec<u32> {
    let kind = |pixel: T| match has_layers(pixel) {
        true => Kind::Surface as u32,
        false => Kind::Nothing as u32,
    };
    pixels.into_iter().map(kind).collect()
}
