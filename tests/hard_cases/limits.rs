//! How far device and reference may be apart, in one table.

use angioray::scene::{Emission, QuadratureMethod};

use crate::common::Figure;

/// Of surfaces, pixels that hit on one side only, or that hit different things; those whose ray is
/// within 1e-4 voxel of a tangent are not counted.
pub const WRONG_PIXELS: usize = 0;
/// Of surfaces, the share of the hits whose depth may be off by more than 1e-3 voxel.
pub const DISPLACED: f64 = 1e-3;

/// Of projections. The values: the share of the range that single precision cannot resolve.
pub const PROJECTED: [(Figure, f64); 2] = [(Figure::Kind, 0.0), (Figure::ValueMax, 2e-6)];

/// Of emissions, premultiplied linear light and opacity: the adaptive rule's own bound, of others,
/// half a voxel a step, what that leaves out at the corners of the field.
pub fn light(emission: &Emission) -> f64 {
    match emission.quadrature.method() {
        QuadratureMethod::Adaptive => emission.quadrature.bound(),
        _ => 4e-3,
    }
}

/// Of light beside an edge in focus, linear, as a share of white: what a slope loses where its circles differ.
pub const NOT_SMEARED: f64 = 0.02;
/// Of light across a blurred edge, linear, as a share of white: what discs of pixels are off, and that loss.
pub const BLURRED: f64 = 0.03;
/// Of the occlusion of a plane, whose own is 0: what is seen hides less than that where it lies that near the tangent plane.
pub const OCCLUDED_PLANE: f64 = 1e-3;
