//! What to show and how: plain, validated data. No GPU, no volume, no command line.
//!
//! Values (iso, window, thresholds, transfer function) are physical values of the volume; lengths
//! are millimetres, unless a name says voxels; colours are linear light unless a name says sRGB.
//!
//! [`Scene::of_mode`] makes a scene with every default in its place.

mod antialias;
mod camera;
mod clip;
mod color;
mod depth_cues;
mod depth_of_field;
pub(crate) mod enum_names;
mod gradient;
mod homogeneity;
mod jitter;
mod keyed_text;
mod light;
mod mode;
mod occlusion;
mod path;
mod phong;
mod picture;
mod quadrature;
pub(crate) mod quantities;
mod sampling;
mod screen_occlusion;
mod shadows;
mod sparse;
mod srgb_color;
pub(crate) mod toml_error;
mod tone;
mod transfer;
mod transfer_file;
mod view;

pub use antialias::AntiAliasing;
pub use camera::{Camera, Lens, LensPoint, Ray};
pub use clip::ClipPlane;
pub use color::{Rgb, linear_from_srgb, srgb_from_linear};
pub use depth_cues::{
    Chromadepth, DepthCue, DepthCues, DepthRange, Edge, Ramp, StepCount, WidthPx,
};
pub use depth_of_field::{Aperture, DepthOfField, DofMethod, Focus};
pub use gradient::{Gradient, Precomputed};
pub use homogeneity::{Homogeneity, HomogeneityRule};
pub use jitter::{Interleaved, Jitter, Shift};
pub use light::{Direction, Light, LightFrom, LightPlace};
pub use mode::Mode;
pub use occlusion::{AmbientOcclusion, OcclusionBy};
pub use path::{FrameCount, Orbit, OrbitAxis};
pub use phong::{MostReflected, Phong, Reflection};
pub use picture::{Emission, Picture, Projection, Window};
pub use quadrature::{Quadrature, QuadratureMethod};
pub use quantities::{
    Brightness, Contrast, DistanceMm, FovDeg, Gamma, HeightMm, HomogeneityLimit, Intensity,
    LightSizeDeg, OcclusionError, RayCount, Reflectance, RimPower, ScreenError, ShadedFrom,
    ShadowStep, Share, Shininess, StepVoxels, Termination,
};
pub use sampling::{
    Filter, Reconstruction, Refine, RefineMethod, Sampling, SamplingMethod, Storage, Traverse,
};
pub use screen_occlusion::{Occlusion, SampleCount, ScreenOcclusion};
pub use shadows::{GridSide, ShadowMethod, Shadows};
pub use sparse::{Refill, Sparse, SparseGrid};
pub use srgb_color::SrgbColor;
pub use tone::Tone;
pub use transfer::{Knot, TransferFunction};
pub use transfer_file::{TransferFile, TransferUnits};
pub use view::{Orientation, View, fit_distance_mm};

use crate::error::Result;
use crate::extent::ImageSize;
use crate::subject::Subject;

/// Everything that determines a picture of a given volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The picture's size in pixels.
    pub size: ImageSize,
    /// The eye and the lens.
    pub camera: Camera,
    /// The kind of picture: a surface, a projection or a medium.
    pub picture: Picture,
    /// The clip planes, at most [`ClipPlane::MAX_COUNT`]: a ray sees what lies on the kept side of all.
    pub clip_planes: Vec<ClipPlane>,
    /// How rays are followed.
    pub sampling: Sampling,
    /// How many rays a pixel has.
    pub anti_aliasing: AntiAliasing,
    /// Which pixels have rays of their own; `None`: all.
    pub sparse: Option<Sparse>,
    /// The lights for shading, at most [`Light::MAX_COUNT`].
    pub lights: Vec<Light>,
    /// How much of the light from everywhere a surface keeps from itself; `None`: nothing.
    pub ambient_occlusion: Option<Occlusion>,
    /// How the lights are kept from points of the volume by the volume itself; `None`: they are not.
    pub shadows: Option<Shadows>,
    /// The lens; `None`: a pinhole.
    pub depth_of_field: Option<DepthOfField>,
    /// What colours tell of depth; `None`: nothing.
    pub depth_cues: Option<DepthCues>,
    /// How gradients are computed for normals, in the layer and in shading.
    pub gradient: Gradient,
    /// The tone curve of display pictures.
    pub tone: Tone,
}

impl Scene {
    /// Constructs the scene of a mode as the command line makes it where nothing else is given: the
    /// subject's content from the front.
    ///
    /// # Errors
    /// As [`Camera::of_view`] and [`Picture::of_mode`].
    pub fn of_mode(mode: Mode, subject: &Subject) -> Result<Self> {
        let picture = Picture::of_mode(mode, subject)?;
        let size = ImageSize::DEFAULT;
        let sampling = Sampling {
            method: match &picture {
                Picture::Emission(medium) => medium.quadrature.sampling(),
                _ => SamplingMethod::default(),
            },
            ..Sampling::default()
        };
        Ok(Self {
            size,
            camera: Camera::of_view(View::default(), subject, size)?,
            picture,
            clip_planes: Vec::new(),
            sampling,
            anti_aliasing: AntiAliasing::OFF,
            sparse: None,
            lights: vec![Light::default()],
            ambient_occlusion: None,
            shadows: None,
            depth_of_field: None,
            depth_cues: None,
            gradient: Gradient::default(),
            tone: Tone::default(),
        })
    }

    /// How this picture's rays are sampled: an integral's as its quadrature is.
    pub fn sampling_method(&self) -> SamplingMethod {
        match &self.picture {
            Picture::Emission(medium) => medium.quadrature.sampling(),
            Picture::Surface { .. } | Picture::Projection { .. } => self.sampling.method,
        }
    }

    /// Within what ambient occlusion is bounded, where a device is to bound it.
    pub fn occlusion_error(&self) -> Option<OcclusionError> {
        match self.ambient_occlusion?.in_volume()?.by {
            OcclusionBy::Bound(error) => Some(error),
            OcclusionBy::Rays(_) => None,
        }
    }
}
