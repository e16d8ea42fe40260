//! What to look at and how: plain, validated data. No GPU, no volume.
//!
//! Values (iso, window, thresholds, transfer function) are physical values of the volume; lengths
//! are millimetres, unless a name says voxels; colours are linear light unless a name says sRGB.

mod camera;
mod clip;
mod color;
mod gradient;
mod homogeneity;
mod light;
pub(crate) mod options;
mod path;
mod picture;
mod quadrature;
mod sampling;
pub(crate) mod toml_error;
mod transfer;
mod transfer_file;
mod view;

pub use camera::{Camera, Lens, Ray};
pub use clip::ClipPlane;
pub use color::{Rgb, linear_from_srgb, srgb_from_linear};
pub use gradient::{Gradient, Precomputed};
pub use homogeneity::{Homogeneity, HomogeneityRule};
pub use light::{Light, Phong, Reflection};
pub use options::*;
pub use path::{FrameCount, Orbit, OrbitAxis};
pub use picture::{Emission, Picture, Projection, Window};
pub use quadrature::{Quadrature, QuadratureMethod};
pub use sampling::{Filter, Refine, RefineMethod, Sampling, SamplingMethod, Storage, Traverse};
pub use transfer::{Knot, TransferFunction};
pub use transfer_file::{TransferFile, TransferUnits};
pub use view::{Orientation, fit_distance_mm};

use crate::extent::ImageSize;

/// Everything that determines a picture of a given volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    pub size: ImageSize,
    pub camera: Camera,
    pub picture: Picture,
    /// At most [`ClipPlane::MOST`]: a ray sees what lies on the kept side of all.
    pub clip_planes: Vec<ClipPlane>,
    pub sampling: Sampling,
    pub light: Light,
    /// Of normals, in the layer and in shading.
    pub gradient: Gradient,
    pub tone: Tone,
}

impl Scene {
    /// How this picture's rays are sampled: an integral's as its quadrature is.
    pub fn sampling_method(&self) -> SamplingMethod {
        match &self.picture {
            Picture::Emission(medium) => medium.quadrature.sampling(),
            Picture::Surface { .. } | Picture::Projection { .. } => self.sampling.method,
        }
    }
}

/// From linear light to a display picture. Never touches EXR or NPY.
///
/// In order: composite over `background`, encode as sRGB, `(v − ½)·contrast + ½ + brightness`,
/// clamp to 0..1, `v^(1/gamma)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    pub background: Rgb,
    pub brightness: f64,
    pub contrast: f64,
    pub gamma: f64,
}

impl Default for Tone {
    fn default() -> Self {
        Self {
            background: Rgb::BLACK,
            brightness: 0.0,
            contrast: 1.0,
            gamma: 1.0,
        }
    }
}
