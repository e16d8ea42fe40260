//! What passes find gradients by: differences of the field, or directions on the device.

use std::time::Instant;

use crate::error::Result;
use crate::frame::Wanted;
use crate::gpu::{Buffer, Defines, Device, Launch, Parameter, input, value};
use crate::scene::{Gradient, Picture, Precomputed, Scene};
use crate::volume::Volume;

use super::directions::{AngleError, Directions};
use super::variant::{GRADIENT_PRECOMPUTED, gradient_constant};

/// What precomputed gradients cost and are worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GradientFigures {
    /// On the device.
    pub bytes: u64,
    /// `None`: the whole volume is flat.
    pub angle: Option<AngleError>,
    /// Computing and uploading them.
    pub ms: f64,
}

/// Precomputed gradients on the device.
pub struct DeviceDirections {
    pub how: Precomputed,
    pub figures: GradientFigures,
    directions: Buffer<i16>,
    /// Along x, y, z; voxels between two.
    grid: [u32; 4],
}

impl DeviceDirections {
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
pub fn needed(scene: &Scene, wanted: Wanted) -> Option<Precomputed> {
    let has_normals = match &scene.picture {
        Picture::Surface { phong, .. } => wanted.normal || phong.is_some(),
        Picture::Emission(emission) => wanted.normal || emission.phong.is_some(),
        Picture::Projection { .. } => false,
    };
    match scene.gradient {
        Gradient::Precomputed(how) if has_normals => Some(how),
        _ => None,
    }
}

/// As a pass is given it: a constant, and where directions are read, their arguments.
#[derive(Clone, Copy)]
pub enum DeviceGradient<'a> {
    /// One of the kernels' GRADIENT_*.
    Differences(u32),
    Directions(&'a DeviceDirections),
}

impl<'a> DeviceGradient<'a> {
    /// By central differences where the picture needs no directions.
    pub fn of(gradient: Gradient, directions: Option<&'a DeviceDirections>) -> Self {
        match (gradient, directions) {
            (Gradient::Precomputed(_), Some(directions)) => Self::Directions(directions),
            (Gradient::Precomputed(_), None) => Self::none(),
            (differences, _) => Self::Differences(gradient_constant(differences)),
        }
    }

    /// For a pass without normals.
    pub fn none() -> Self {
        Self::Differences(gradient_constant(Gradient::Central))
    }

    pub fn define(self, defines: Defines) -> Defines {
        let number = match self {
            Self::Differences(number) => number,
            Self::Directions(_) => GRADIENT_PRECOMPUTED,
        };
        defines.with("GRADIENT", format!("{number}u"))
    }

    /// Whether voxels are read for gradients.
    pub fn reads_voxels(self) -> bool {
        matches!(self, Self::Differences(_))
    }

    /// Their place in a pass's signature.
    pub fn parameters(self) -> impl Iterator<Item = Parameter> {
        let of_directions = [
            input::<i16>("directions"),
            value::<[u32; 4]>("direction_grid"),
        ];
        let reads_voxels = self.reads_voxels();
        of_directions.into_iter().filter(move |_| !reads_voxels)
    }

    pub fn give<'b>(self, launch: Launch<'b>) -> Launch<'b>
    where
        'a: 'b,
    {
        match self {
            Self::Differences(_) => launch,
            Self::Directions(on) => launch.input(&on.directions).value(&on.grid),
        }
    }
}
