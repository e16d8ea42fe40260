//! How passes find gradients: by differences of the field, or from directions on the device.

use std::time::Instant;

use crate::error::Result;
use crate::frame::{Layer, Wanted};
use crate::gpu::{Args, Buffer, Defines, Device, Group};
use crate::render::abi::KernelEnum;
use crate::scene::{Gradient, Picture, Precomputed, Scene};
use crate::volume::Volume;

use super::directions::{AngleError, Directions};

/// The cost of precomputed gradients, and their error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GradientFigures {
    /// Device memory that they take.
    pub bytes: u64,
    /// How far they are from central differences; `None`: the whole volume is flat.
    pub angle: Option<AngleError>,
    /// Time to compute and upload them.
    pub ms: f64,
}

/// Precomputed gradients on the device.
pub struct DeviceDirections {
    /// How they were computed.
    pub how: Precomputed,
    /// Their cost and error.
    pub figures: GradientFigures,
    directions: Buffer<i16>,
    /// The number of directions along x, y, z, and the voxels between two.
    grid: [u32; 4],
}

impl DeviceDirections {
    /// Computes the directions and uploads them.
    ///
    /// # Errors
    /// Not enough memory, on the host or the device.
    pub fn upload(device: &Device, volume: &Volume, how: Precomputed) -> Result<Self> {
        let began = Instant::now();
        let computed = Directions::compute(volume, how)?;
        let directions = Buffer::upload(device, "precomputed gradients", &computed.packed)?;
        let ms = began.elapsed().as_secs_f64() * 1e3;
        let [x, y, z] = computed.grid;
        Ok(Self {
            how,
            figures: GradientFigures {
                bytes: directions.bytes(),
                angle: computed.angle_error(volume),
                ms,
            },
            directions,
            grid: [x, y, z, computed.apart],
        })
    }
}

/// The precomputed gradients that a picture makes use of.
pub fn needed_gradients(scene: &Scene, wanted: Wanted) -> Option<Precomputed> {
    let has_normals = match &scene.picture {
        Picture::Surface { phong, .. } => wanted.has(Layer::Normal) || phong.is_some(),
        Picture::Emission(emission) => wanted.has(Layer::Normal) || emission.phong.is_some(),
        Picture::Projection { .. } => false,
    };
    match scene.gradient {
        Gradient::Precomputed(how) if has_normals => Some(how),
        _ => None,
    }
}

/// How a pass finds gradients: by a constant, and where directions are read, their arguments.
#[derive(Clone, Copy)]
pub enum DeviceGradient<'a> {
    /// Gradients by differences of the field, of this kind.
    Differences(Gradient),
    /// Gradients from directions that were computed before.
    Directions(&'a DeviceDirections),
}

impl<'a> DeviceGradient<'a> {
    /// The gradient of a pass without normals.
    pub const NONE: Self = Self::Differences(Gradient::Central);

    /// How a picture's gradients are found: by central differences where it needs no directions.
    pub fn of(gradient: Gradient, directions: Option<&'a DeviceDirections>) -> Self {
        match (gradient, directions) {
            (Gradient::Precomputed(_), Some(directions)) => Self::Directions(directions),
            (Gradient::Precomputed(_), None) => Self::NONE,
            (differences, _) => Self::Differences(differences),
        }
    }

    /// Adds the constant of the gradient's kind.
    pub fn define(self, defines: Defines) -> Defines {
        let gradient = match self {
            Self::Differences(gradient) => gradient,
            Self::Directions(directions) => Gradient::Precomputed(directions.how),
        };
        defines.with("GRADIENT", format!("{}u", gradient.number()))
    }

    /// Whether voxels are read for gradients.
    pub fn reads_voxels(self) -> bool {
        matches!(self, Self::Differences(_))
    }
}

impl Group for DeviceGradient<'_> {
    fn add_to(self, args: Args) -> Args {
        match self {
            Self::Differences(_) => args,
            Self::Directions(on) => args
                .read("directions", &on.directions)
                .value("direction_grid", &on.grid),
        }
    }
}
