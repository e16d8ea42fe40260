//! Casting a scene on an OpenCL device. Each folder uses only those before it: what host and kernels agree on
//! (`abi`), what lies on the device (`resources`), what is known before a ray is cast (`occupancy`), the
//! passes, and the frame that they make.

mod abi;
mod frame;
mod occupancy;
mod passes;
mod ray_caster;
mod resources;

pub use abi::{Lanes, Variant, struct_layouts};
pub use frame::{Options, Renderer, Rendering, SampleCheck, Sampled, check_picture, check_volume};
pub use occupancy::content;
pub use ray_caster::{FirstCrossing, RayCaster, TimedCrossings};
pub use resources::{AngleError, Directions, GradientFigures, IndexRay};
