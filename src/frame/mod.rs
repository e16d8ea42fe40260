//! Image planes: the layers of one picture, row 0 at the top, x fastest; written as files
//! ([`write()`]) and compared with each other ([`mod@error`]).

mod animation;
mod channel;
mod contents;
mod encoder_error;
pub mod error;
mod exr;
mod format;
mod jpeg;
mod layer;
mod layers;
mod metadata;
mod npy;
pub mod palette;
mod percentile;
mod pixel;
mod png;
mod quantize;
mod verify;
mod wanted;
mod webp;
mod write;

pub use animation::{Animation, AnimationFormat, FrameRate, Reel};
pub use contents::Frame;
pub use format::{BitDepth, Encoding, Format, channels};
pub use layer::*;
pub use layers::{Layers, Plane, PlaneEntry};
pub use metadata::{carrier, read_encoding, read_metadata};
pub use percentile::{median, percentile};
pub use pixel::{Certificate, Kind};
pub use png::read_display;
pub use verify::is_complete;
pub use wanted::Wanted;
pub use write::write;
