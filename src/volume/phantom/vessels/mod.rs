//! A vessel tree with known centrelines and radii.

mod centreline;
mod draw;
mod grow;
mod targets;
mod tree;

pub(super) use draw::draw;
pub(super) use grow::grow;
pub use tree::{MURRAY_EXPONENT, VesselSegment, VesselTree};
