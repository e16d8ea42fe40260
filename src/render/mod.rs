//! Casting a scene on an OpenCL device: the upload, the passes, the pipeline.

mod abi;
mod cells;
mod classified;
mod classify;
mod clip;
mod directions;
mod emission;
mod gradient;
mod homogeneity;
mod lanes;
mod medium;
mod passes;
mod picture;
mod pipeline;
mod planes;
mod ranges;
mod ray_caster;
mod rays;
mod reach;
mod room;
mod twins;
mod variant;
mod voxels;

pub use directions::{AngleError, Directions};
pub use gradient::GradientFigures;
pub use lanes::Lanes;
pub use pipeline::{Options, Renderer, Rendering, Sampled};
pub use ray_caster::{FirstCrossing, RayCaster};
pub use room::{check_picture, check_volume};
pub use twins::struct_layouts;
pub use variant::Variant;
