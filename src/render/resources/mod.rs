//! What lies on the device for many frames or for one: voxels, the octree's tables, the transfer function,
//! clip planes, gradients, rays, sets of directions and sections, planes of layers, spans of depths.

mod clip;
mod device_transfer;
mod directions;
mod gradient;
mod held_volume;
mod layers;
mod ray_sets;
mod rays;
mod sections;
mod spans;
mod taps;
mod transfer;
mod volume;
mod voxels;

pub use clip::DeviceClip;
pub use device_transfer::{DeviceTransfer, Tables};
pub use directions::{AngleError, Directions};
pub use gradient::{DeviceDirections, DeviceGradient, GradientFigures, needed_gradients};
pub use held_volume::HeldVolume;
pub use layers::DeviceLayers;
pub use ray_sets::RaySets;
pub use rays::{IndexRay, RaySource};
pub use sections::Sections;
pub use spans::{Screen, Spans};
pub use taps::BlurTaps;
pub use transfer::{Knots, unit_absorption};
pub use volume::DeviceVolume;
pub use voxels::DeviceVoxels;
