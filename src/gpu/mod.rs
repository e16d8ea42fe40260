//! The OpenCL device, memory, kernel sources, programs, typed passes and timings. Knows no volumes.

mod args;
mod arranged;
mod binary;
mod build_server;
mod builder;
mod device;
mod device_info;
mod element;
mod image;
mod loader;
mod memory;
mod pass;
pub mod process;
mod program;
mod scratch;
mod signature;
mod source;
mod status;
mod timing;

pub use args::{Args, Group};
pub use device::Device;
pub use device_info::{DeviceInfo, DeviceKind};
pub use element::Element;
pub use image::{Channel, Image};
pub use memory::{AnyBuffer, Buffer};
pub use pass::{Launch, Pass};
pub use program::Defines;
pub use source::{files, flatten};
pub use timing::{FrameTimes, PassTime, Timings};
