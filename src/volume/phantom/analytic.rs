//! Phantoms given by a formula: each field maps a voxel's index to 0..1, and comes with the
//! sentence that states it. `p` is a voxel's position in mm from the volume's centre.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::PhantomSpec;
use super::fill::sampled;
use super::stored::is_whole;
use crate::error::Result;
use crate::volume::Voxels;

fn position_mm(spec: &PhantomSpec, index: [u32; 3]) -> DVec3 {
    (DVec3::from_array(index.map(f64::from)) - spec.centre_index()) * spec.spacing_mm
}

/// Falls linearly with the distance to the surface, over two voxels on either side of it: the
/// distance is then unclamped at all corners of a cell that the surface crosses, and trilinear
/// interpolation finds the surface to O(spacing² / radius).
pub(super) fn sphere(spec: &PhantomSpec) -> Result<(Voxels, String)> {
    let radius_mm = spec.radius_mm.unwrap_or(0.35 * spec.extent_mm());
    let ramp_mm = 2.0 * spec.spacing_mm.max_element();
    let voxels = sampled(spec, |index| {
        let beyond_mm = position_mm(spec, index).length() - radius_mm;
        (0.5 - beyond_mm / (2.0 * ramp_mm)).clamp(0.0, 1.0)
    })?;
    let definition = format!(
        "the field is clamp(1/2 - (|p| - R) / (2 w), 0, 1) with R = {radius_mm} mm and w = {ramp_mm} mm, so that its isosurface at 1/2 is the sphere of radius R"
    );
    Ok((voxels, definition))
}

/// A box of thickness T convolved with a box two voxels wide. The ramp's width is a whole number
/// of voxels, so that the voxels along the axis sum to exactly T; and both voxels beside a face
/// lie on the ramp, so that the mid-value isosurface lies exactly at ±T/2 (for T of two voxels
/// and more).
pub(super) fn slab(spec: &PhantomSpec) -> Result<(Voxels, String)> {
    let axis = spec.axis.unwrap_or(2);
    let thickness_mm = spec.thickness_mm.unwrap_or(0.3 * spec.lengths_mm()[axis]);
    let half_mm = thickness_mm / 2.0;
    let h = spec.spacing_mm[axis];
    let voxels = sampled(spec, |index| {
        let p = position_mm(spec, index)[axis];
        ((p + h).min(half_mm) - (p - h).max(-half_mm)).max(0.0) / (2.0 * h)
    })?;
    let name = ["x", "y", "z"][axis];
    let definition = format!(
        "the field is clamp((min({name} + h, T/2) - max({name} - h, -T/2)) / (2 h), 0, 1) with T = {thickness_mm} mm and h = {h} mm, so that its integral along {name} is T and its isosurfaces at 1/2 are, for T >= 2 h, the faces {name} = -T/2 and T/2"
    );
    Ok((voxels, definition))
}

/// i · step. Whole-number types take the largest whole step that fits their range, which makes
/// the ramp exact in them too; where none fits, voxels are rounded.
pub(super) fn ramp(spec: &PhantomSpec) -> Result<(Voxels, String)> {
    let width = spec.values().width();
    let intervals = f64::from((spec.dims.array()[0] - 1).max(1));
    let even = width / intervals;
    let step = if is_whole(spec.voxel_type) && even >= 1.0 {
        even.floor()
    } else {
        even
    };
    let voxels = sampled(spec, |[i, _, _]| f64::from(i) * step / width)?;
    let definition = format!(
        "the voxel with index i along x has the value {} + {step} i",
        spec.values().min
    );
    Ok((voxels, definition))
}

pub(super) fn blob(spec: &PhantomSpec) -> Result<(Voxels, String)> {
    let sigma_mm = spec.sigma_mm.unwrap_or(0.15 * spec.extent_mm());
    let voxels = sampled(spec, |index| {
        let p = position_mm(spec, index) / sigma_mm;
        (-0.5 * p.length_squared()).exp()
    })?;
    let definition = format!("the field is exp(-|p|^2 / (2 s^2)) with s = {sigma_mm} mm");
    Ok((voxels, definition))
}

/// S. Marschner, R. Lobb, "An evaluation of reconstruction filters for volume rendering",
/// IEEE Visualization 1994: ρ with f_M = 6 and α = 0.25.
pub(super) fn marschner_lobb(spec: &PhantomSpec) -> Result<(Voxels, String)> {
    const FREQUENCY: f64 = 6.0;
    const ALPHA: f64 = 0.25;
    let half = spec.centre_index();
    let voxels = sampled(spec, |index| {
        // The volume's first voxel lies at −1, its last at 1; a single one at 0.
        let p = (DVec3::from_array(index.map(f64::from)) - half) / half.max(DVec3::splat(0.5));
        let rings = (TAU * FREQUENCY * (PI / 2.0 * p.truncate().length()).cos()).cos();
        (1.0 - (PI / 2.0 * p.z).sin() + ALPHA * (1.0 + rings)) / (2.0 * (1.0 + ALPHA))
    })?;
    let definition = "the field is the signal of Marschner and Lobb (1994) with f_M = 6 and alpha = 0.25, on [-1, 1]^3 from the first voxel of each axis to the last".into();
    Ok((voxels, definition))
}

/// The voxel at half the voxel count along each axis, rounded down.
pub(super) fn voxel(spec: &PhantomSpec) -> Result<(Voxels, String)> {
    let centre = spec.dims.array().map(|n| n / 2);
    let voxels = sampled(spec, |index| if index == centre { 1.0 } else { 0.0 })?;
    let [i, j, k] = centre;
    let definition = format!("the field is 1 at voxel ({i}, {j}, {k}) and 0 at all others");
    Ok((voxels, definition))
}
