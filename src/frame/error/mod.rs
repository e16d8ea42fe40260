//! The error of a picture against a reference of the same scene and size.
//!
//! All sums are f64; every percentile is by nearest rank ([`super::percentile`]). A pixel of which
//! only one picture has something to compare is counted, never averaged away; where nothing is
//! left to compare the figures are `None`.

mod color;
mod drawing;
mod entry;
mod figures;
mod flip;
mod focus;
mod geometry;
mod map;
mod pairing;
mod share;
mod spread;
mod ssim;
mod value;

pub use color::{ColorError, color_error, differing_share};
pub use entry::Entry;
pub use figures::{Figures, Scale, figures};
pub use flip::flip;
pub use focus::{FocusError, PartError, focus_error};
pub use geometry::{DepthError, NormalError, depth_error, normal_error};
pub use map::{ErrorMap, Quantity};
pub use share::{ShareError, share_error};
pub use ssim::ssim;
pub use value::{ValueError, value_error};
