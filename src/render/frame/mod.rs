//! One frame, from scene to planes: what lies on the device, each picture's schedule of passes, the
//! read-back.

mod emission;
mod planes;
mod projection;
mod renderer;
mod room;
mod sampled;
mod step;
mod surface;
mod view;

pub use renderer::{Options, Renderer, Rendering};
pub use room::{check_picture, check_volume};
pub use sampled::Sampled;
