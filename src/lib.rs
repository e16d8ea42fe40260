//! Pictures from angiograms and other sparse scalar volumes, each with its error.
//!
//! A [`Volume`] is opened or made, a [`Scene`] says what to see of it and how, a [`Renderer`] casts the scene on
//! an OpenCL [`Device`], [`reference::render`] in double precision on the host; both give a [`Frame`], which is
//! saved as a picture or compared with another ([`frame::error`]).
//!
//! ```
//! use angioray::{Device, Mode, Octree, Options, Renderer, Scene, Subject, Volume, Wanted};
//!
//! # use angioray::volume::{PhantomKind, PhantomSpec, phantom, write_nrrd};
//! # fn main() -> angioray::Result<()> {
//! # if std::env::var_os("REQUIRE_OPENCL").is_none() && Device::first().is_err() {
//! #     return Ok(());
//! # }
//! # let folder = tempfile::tempdir().unwrap();
//! # let (head, picture) = (folder.path().join("head.nrrd"), folder.path().join("head.png"));
//! # let dims = angioray::extent::Dims::new([24; 3])?;
//! # write_nrrd(&phantom(&PhantomSpec::new(PhantomKind::Vessels, dims))?.volume, &head, false)?;
//! let volume = Volume::open(&head)?;
//! let scene = Scene::of_mode(Mode::Mip, &Subject::of(&volume))?;
//! let octree = Octree::of(&volume)?;
//! let device = Device::first()?;
//! let mut renderer = Renderer::new(&device, &volume, &octree, Options::default())?;
//! let frame = renderer.render(&scene, Wanted::DISPLAY)?.frame;
//! frame.save(&picture)?;
//! # assert!(picture.metadata().unwrap().len() > 500);
//! # Ok(())
//! # }
//! ```
//!
//! The folder `examples` has whole programs. Values (iso values, windows, thresholds, transfer functions) are the
//! volume's own physical values, lengths are millimetres, world space is LPS; ARCHITECTURE.md draws the whole.
//! Nothing here prints or shows progress by itself: long work reports to a [`progress::Progress`].
//!
//! Modules that are hidden here belong to the program `angioray`; they change without notice.

#[doc(hidden)]
pub mod abrupt;
#[doc(hidden)]
pub mod batch;
#[doc(hidden)]
pub mod cache;
#[doc(hidden)]
pub mod cli;
#[doc(hidden)]
pub mod crash;
pub mod error;
pub mod extent;
pub mod frame;
pub mod gpu;
#[doc(hidden)]
pub mod input;
#[doc(hidden)]
pub mod lab;
#[doc(hidden)]
pub mod memory;
mod number_text;
pub mod octree;
#[doc(hidden)]
pub mod options;
#[doc(hidden)]
pub mod output;
pub mod progress;
pub mod reference;
pub mod render;
pub mod scene;
#[doc(hidden)]
pub mod stop;
mod subject;
pub mod volume;

pub use error::{Error, Result};
pub use frame::{Frame, Layer, Wanted};
pub use gpu::Device;
pub use octree::Octree;
pub use render::{Options, Renderer};
pub use scene::{Mode, Scene};
pub use subject::{Content, Corners, Sphere, Subject};
pub use volume::Volume;

/// The version of this library and of its program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
