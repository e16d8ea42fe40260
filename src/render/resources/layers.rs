//! The planes of a picture's layers on the device, as a map by layer.

use crate::error::Result;
use crate::frame::{FillValue, Layer, Plane};
use crate::gpu::{Args, Buffer, Device, Group};

use super::rays::RaySource;

/// The plane of a layer on the device.
enum DevicePlane {
    Scalars(Buffer<f32>),
    /// The last component is padding.
    Vectors(Buffer<[f32; 4]>),
    Counts(Buffer<u32>),
}

impl DevicePlane {
    fn new(device: &Device, rays: &RaySource, name: &str, empty: FillValue) -> Result<Self> {
        let what = format!("{name} plane");
        Ok(match empty {
            FillValue::Scalar(empty) => Self::Scalars(rays.plane(device, &what, empty)?),
            FillValue::Vector([x, y, z]) => {
                Self::Vectors(rays.plane(device, &what, [x, y, z, 0.0])?)
            }
            FillValue::Count(empty) => Self::Counts(rays.plane(device, &what, empty)?),
        })
    }

    fn bytes(&self) -> u64 {
        match self {
            Self::Scalars(buffer) => buffer.bytes(),
            Self::Vectors(buffer) => buffer.bytes(),
            Self::Counts(buffer) => buffer.bytes(),
        }
    }

    fn download(&self, device: &Device) -> Result<Plane> {
        Ok(match self {
            Self::Scalars(buffer) => Plane::Scalars(buffer.download(device)?),
            Self::Vectors(buffer) => {
                let padded = buffer.download(device)?.into_iter();
                Plane::Vectors(padded.map(|[x, y, z, _]| [x, y, z]).collect())
            }
            Self::Counts(buffer) => Plane::Counts(buffer.download(device)?),
        })
    }
}

/// The planes of a picture's layers on the device: those that are wanted, or needed to make those. Kernels know
/// each by its layer's name.
#[derive(Default)]
pub struct DeviceLayers([Option<DevicePlane>; Layer::COUNT]);

impl DeviceLayers {
    /// Bytes that a pixel of a layer takes on the device; 0 where the device makes no such plane.
    pub fn entry_bytes(layer: Layer) -> u64 {
        match layer.empty() {
            Some(FillValue::Scalar(_) | FillValue::Count(_)) => 4,
            Some(FillValue::Vector(_)) => 16,
            None => 0,
        }
    }

    /// Makes room for the planes of these layers; for those without planes none. Where no ray writes them, they
    /// hold their fill value.
    ///
    /// # Errors
    /// The device has no room.
    pub fn allocate(&mut self, device: &Device, rays: &RaySource, layers: &[Layer]) -> Result<()> {
        for &layer in layers {
            if let Some(empty) = layer.empty() {
                let plane = DevicePlane::new(device, rays, layer.name(), empty)?;
                self.0[layer as usize] = Some(plane);
            }
        }
        Ok(())
    }

    /// Whether a layer has a plane.
    pub fn has(&self, layer: Layer) -> bool {
        self.0[layer as usize].is_some()
    }

    /// The plane of a layer of whole numbers.
    pub fn layer_counts(&self, layer: Layer) -> Option<&Buffer<u32>> {
        match &self.0[layer as usize] {
            Some(DevicePlane::Counts(buffer)) => Some(buffer),
            _ => None,
        }
    }

    /// The plane of a layer of numbers.
    pub fn layer_scalars(&self, layer: Layer) -> Option<&Buffer<f32>> {
        match &self.0[layer as usize] {
            Some(DevicePlane::Scalars(buffer)) => Some(buffer),
            _ => None,
        }
    }

    /// The planes of those of the layers that are there, in this order, as arguments of a pass that reads
    /// them.
    pub fn reading<'a>(&'a self, layers: &'a [Layer]) -> impl Group + 'a {
        InOrder {
            planes: self,
            layers,
        }
    }

    /// The kernel arguments of a pass that writes the layers; compare [`DeviceLayers::reading`].
    pub fn writing<'a>(&'a mut self, layers: &'a [Layer]) -> impl Group + 'a {
        self.reading(layers)
    }

    /// Waits for what was launched before and copies the plane of a layer to the host.
    ///
    /// # Errors
    /// The device failed; not enough memory.
    pub fn download(&self, device: &Device, layer: Layer) -> Result<Option<Plane>> {
        let plane = self.0[layer as usize].as_ref();
        plane.map(|plane| plane.download(device)).transpose()
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.0.iter().flatten().map(DevicePlane::bytes).sum()
    }
}

struct InOrder<'a> {
    planes: &'a DeviceLayers,
    layers: &'a [Layer],
}

impl Group for InOrder<'_> {
    fn add_to(self, args: Args) -> Args {
        self.layers.iter().fold(args, |args, &layer| {
            let name = layer.name();
            match &self.planes.0[layer as usize] {
                Some(DevicePlane::Scalars(buffer)) => args.read(name, buffer),
                Some(DevicePlane::Vectors(buffer)) => args.read(name, buffer),
                Some(DevicePlane::Counts(buffer)) => args.read(name, buffer),
                None => args,
            }
        })
    }
}
