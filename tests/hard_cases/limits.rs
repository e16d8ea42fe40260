//! How far device and reference may be apart, in one table.

use angioray::scene::Picture;

use crate::common::Figure;

/// Of surfaces, pixels that hit on one side only, or that hit different things; those whose ray is
/// within 1e-4 voxel of a tangent are not counted.
pub const WRONG_PIXELS: usize = 0;
/// Of surfaces, the share of the hits whose depth may be off by more than 1e-3 voxel.
pub const DISPLACED: f64 = 1e-3;

/// Of other pictures.
pub fn figures(case: &str, picture: &Picture) -> &'static [(Figure, f64)] {
    match (picture, case) {
        (Picture::Surface { .. }, _) => &[],
        // The share of the value range that single precision cannot tell apart.
        (Picture::Projection { .. }, _) => &[(Figure::Kind, 0.0), (Figure::ValueMax, 2e-6)],
        // Under the default quadrature, half a voxel a step.
        (Picture::Emission { .. }, _) => &[(Figure::AlphaMax, 4e-3)],
    }
}
