//! Volumes from a function of the voxel.

use glam::DVec3;

use crate::error::Result;
use crate::extent::Dims;
use crate::volume::{Geometry, NonFinite, Rescale, Volume, Voxels};

/// A volume with `voxel` of the index position at every voxel; it must be finite.
pub(super) fn volume_of<T>(
    dims: [u64; 3],
    geometry: Geometry,
    voxel: impl Fn(DVec3) -> T,
) -> Result<Volume>
where
    Voxels: From<Vec<T>>,
{
    let voxels = voxels_of(dims, voxel);
    Volume::new(
        Dims::new(dims)?,
        Voxels::from(voxels),
        geometry,
        Rescale::IDENTITY,
        NonFinite::Refuse,
    )
}

/// `voxel` of every index position, x fastest.
pub(super) fn voxels_of<T>(dims: [u64; 3], voxel: impl Fn(DVec3) -> T) -> Vec<T> {
    let [nx, ny, nz] = dims;
    let at = |x: u64, y: u64, z: u64| DVec3::new(x as f64, y as f64, z as f64);
    let positions =
        (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| (x, y, z))));
    positions.map(|(x, y, z)| voxel(at(x, y, z))).collect()
}

/// A hash of an index position, in [0, 1): noise that is the same everywhere.
pub(super) fn hash(p: DVec3) -> f64 {
    let n = (p.x as u64 * 73_856_093) ^ (p.y as u64 * 19_349_663) ^ (p.z as u64 * 83_492_791);
    (n.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / f64::from(1 << 24)
}

/// White noise over u8.
pub(super) fn noise(dims: [u64; 3]) -> Result<Volume> {
    volume_of(dims, Geometry::default(), |p| (255.0 * hash(p)) as u8)
}

/// A smooth bump, so that grazing rays see nothing sudden: 250 · exp(−1.5 |q|²) with q running from
/// −1 to 1 along each axis.
pub(super) fn bump(dims: [u64; 3], geometry: Geometry) -> Result<Volume> {
    let middle = DVec3::from_array(dims.map(|n| (n - 1) as f64)) / 2.0;
    volume_of(dims, geometry, |p| {
        let q = (p - middle) / middle.max(DVec3::ONE);
        (250.0 * (-1.5 * q.length_squared()).exp()) as u8
    })
}
