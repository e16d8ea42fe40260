//! angioray: pictures from angiograms and other sparse scalar volumes, without a window.
//!
//! A volume file becomes a [`volume::Volume`]; a [`scene::Scene`] says what to look at and how, and
//! [`options`] are how flags and scene files write one;
//! [`render`] casts it on an OpenCL device, [`mod@reference`] in double precision on the host; both
//! give a [`frame::Frame`], which is written as a picture. ARCHITECTURE.md draws the whole.

pub mod abrupt;
pub mod batch;
pub mod cache;
pub mod cli;
pub mod crash;
pub mod error;
pub mod extent;
pub mod frame;
pub mod gpu;
pub mod input;
pub mod lab;
pub mod memory;
mod number_text;
pub mod octree;
pub mod options;
pub mod output;
pub mod progress;
pub mod reference;
pub mod render;
pub mod scene;
pub mod stop;
pub mod subject;
pub mod volume;

pub use error::{Error, Result};

/// The version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
