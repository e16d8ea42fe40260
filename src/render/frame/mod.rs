//! One frame, from scene to planes: what lies on the device, each picture's schedule of passes, the
//! read-back.

mod antialias;
mod blur;
mod casting;
mod cues;
mod emission;
mod focus;
mod lens;
mod light_grids;
mod listing;
mod picture;
mod planes;
mod projection;
mod renderer;
mod room;
mod sample_check;
mod sampled;
mod schedule;
mod screen;
mod sparse;
mod step;
mod surface;
mod view;

pub use renderer::{Options, Renderer, Rendering};
pub use room::{check_picture, check_volume};
pub use sample_check::SampleCheck;
pub use sampled::Sampled;
