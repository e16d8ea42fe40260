//! The hard cases by kind of difficulty, each with its volumes and its scenes.

mod effects;
mod emission;
mod grid;
mod isosurface;
mod kinds;
mod pixels;
mod rays;

pub use kinds::orientation_of;
pub use pixels::line_axes;

use super::HardCase;
use crate::volume::Geometry;

/// All cases, by number.
pub(super) const CASES: [&[HardCase]; 6] = [
    rays::CASES,
    isosurface::CASES,
    emission::CASES,
    kinds::CASES,
    pixels::CASES,
    effects::CASES,
];

/// Spacing 1 mm, origin 0, the world's axes: world and index space are one.
fn unit() -> Geometry {
    Geometry::default()
}
