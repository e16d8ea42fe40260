//! Precomputed gradients (Fuller et al. 2009, §3.2): directions of the smoothed volume's central
//! differences at every N-th voxel, and how far they are from differences on the fly.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::progress::Silent;
use crate::scene::Precomputed;
use crate::volume::{Volume, Voxel, smooth};
use crate::with_voxels;

/// A unit direction's components are whole numbers up to this: within 0.002°.
const UNIT: f64 = 32767.0;
/// Places at which the angle error is measured, at most.
const MAX_PLACES: u64 = 1 << 18;
/// A gradient counts as strong from this share of the largest on: weaker ones turn with the noise.
const STRONG: f64 = 0.1;

/// Directions in index space, at the voxels 0, N, 2N, … of each axis and at its last.
pub struct Directions {
    /// The number of directions along x, y, z.
    pub grid: [u32; 3],
    /// The distance of two directions, in voxels.
    pub apart: u32,
    /// Three components each, x fastest; all 0 where there is no gradient.
    pub packed: Vec<i16>,
}

/// Angles, degrees in world space, between interpolated directions and central differences of Φ, at
/// places spread over the volume where the gradient is at least a tenth of the largest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngleError {
    /// The mean angle, degrees.
    pub mean_deg: f64,
    /// The angle that 99 of 100 places do not exceed.
    pub p99_deg: f64,
    /// The number of places at which it was measured.
    pub places: usize,
}

impl Directions {
    /// Computes the directions; needs one f32 volume of memory where it smooths.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn compute(volume: &Volume, how: Precomputed) -> Result<Self> {
        let sigma_mm = how.sigma_voxels() * volume.geometry().smallest_spacing_mm();
        let smoothed;
        let volume = if sigma_mm > 0.0 {
            smoothed = smooth(volume, sigma_mm, &Silent)?;
            &smoothed
        } else {
            volume
        };
        let apart = how.scale();
        let grid = volume.dims().array().map(|n| (n - 1).div_ceil(apart) + 1);
        let [gx, gy, gz] = grid.map(|n| n as usize);
        let count = gx * gy * gz * 3;
        let mut packed: Vec<i16> = Vec::new();
        packed.try_reserve_exact(count).map_err(|_| {
            Error::resource(format!(
                "not enough memory for {gx}x{gy}x{gz} precomputed gradients"
            ))
        })?;
        packed.resize(count, 0);
        let dims = volume.dims().usize();
        with_voxels!(volume.voxels(), voxels => packed
        .par_chunks_mut(gx * 3)
        .enumerate()
        .for_each(|(row, out)| {
            for (x, out) in out.chunks_exact_mut(3).enumerate() {
                let at = [x, row % gy, row / gy];
                let at = std::array::from_fn(|a| (at[a] * apart as usize).min(dims[a] - 1));
                out.copy_from_slice(&pack(difference(voxels, dims, at)));
            }
        }));
        Ok(Self {
            grid,
            apart,
            packed,
        })
    }

    /// How far the directions are from central differences of `volume`; `None` where all of it is flat.
    pub fn angle_error(&self, volume: &Volume) -> Option<AngleError> {
        let cells = volume.dims().cells().map(u64::from);
        let count: u64 = cells.iter().product();
        let places = count.min(MAX_PLACES);
        // Gradients map by the inverse transpose.
        let to_world = volume.geometry().index_from_world().matrix3.transpose();
        let scale = largest(to_world);
        let measured: Vec<(f64, f64)> = (0..places)
            .into_par_iter()
            .map(|k| {
                // Cells spread evenly, and another point of each (Roberts 2018).
                let cell = (count as f64 * (k as f64 * 0.618_033_988_749_895).fract()) as u64;
                let cell = if places == count {
                    k
                } else {
                    cell.min(count - 1)
                };
                let at = [
                    cell % cells[0],
                    cell / cells[0] % cells[1],
                    cell / cells[0] / cells[1],
                ];
                let offset = [0.819_172_513_396, 0.671_043_606_704, 0.549_700_477_902];
                let p = std::array::from_fn(|a| at[a] as f64 + (k as f64 * offset[a]).fract());
                let exact = (to_world * (1.0 / scale)) * central(volume, p);
                let found = (to_world * (1.0 / scale)) * self.at(volume, p);
                (exact.length(), angle_deg(exact, found))
            })
            .collect();
        let max = measured.iter().fold(0.0, |max: f64, m| max.max(m.0));
        let strong = measured.iter().filter(|m| m.0 > 0.0 && m.0 >= STRONG * max);
        let mut angles: Vec<f64> = strong.map(|m| m.1).collect();
        angles.sort_by(f64::total_cmp);
        let places = angles.len();
        Some(AngleError {
            mean_deg: angles.iter().sum::<f64>() / places as f64,
            p99_deg: *angles.get((places.saturating_sub(1)) * 99 / 100)?,
            places,
        })
    }

    /// Interpolated as the device does it.
    fn at(&self, volume: &Volume, p: [f64; 3]) -> DVec3 {
        let dims = volume.dims().array();
        let mut low = [0; 3];
        let mut next = [0; 3];
        let mut f = [0.0; 3];
        for a in 0..3 {
            low[a] = (p[a] as u32 / self.apart).min(self.grid[a].saturating_sub(2));
            next[a] = (low[a] + 1).min(self.grid[a] - 1);
            let from = low[a] * self.apart;
            let to = (from + self.apart).min(dims[a] - 1);
            if to > from {
                f[a] = ((p[a] - f64::from(from)) / f64::from(to - from)).clamp(0.0, 1.0);
            }
        }
        let mut sum = DVec3::ZERO;
        for corner in 0..8 {
            let up = |a: usize| corner >> a & 1 == 1;
            let at: [u32; 3] = std::array::from_fn(|a| if up(a) { next[a] } else { low[a] });
            let weight: f64 = (0..3)
                .map(|a| if up(a) { f[a] } else { 1.0 - f[a] })
                .product();
            let [gx, gy, _] = self.grid.map(|n| n as usize);
            let i = ((at[2] as usize * gy + at[1] as usize) * gx + at[0] as usize) * 3;
            let packed = &self.packed[i..i + 3];
            sum += weight * DVec3::from_array([0, 1, 2].map(|a| f64::from(packed[a])));
        }
        sum
    }
}

/// The largest of a matrix's magnitudes: extreme spacings must not overflow squares.
fn largest(m: DMat3) -> f64 {
    let magnitudes = m.to_cols_array().map(f64::abs);
    magnitudes.into_iter().fold(0.0, f64::max)
}

/// Central differences at a voxel, clamped at the border.
fn difference<T: Voxel>(voxels: &[T], [nx, ny, nz]: [usize; 3], at: [usize; 3]) -> DVec3 {
    let value = |[x, y, z]: [usize; 3]| -> f64 { voxels[(z * ny + y) * nx + x].into() };
    let along = |a: usize, n: usize| {
        let (mut ahead, mut behind) = (at, at);
        ahead[a] = (at[a] + 1).min(n - 1);
        behind[a] = at[a].saturating_sub(1);
        0.5 * (value(ahead) - value(behind))
    };
    DVec3::new(along(0, nx), along(1, ny), along(2, nz))
}

/// A direction's components as whole numbers; 0 stays 0.
fn pack(gradient: DVec3) -> [i16; 3] {
    let largest = gradient.abs().max_element();
    if largest == 0.0 {
        return [0; 3];
    }
    let unit = (gradient / largest).normalize() * UNIT;
    unit.to_array().map(|c| c.round() as i16)
}

/// Central differences of the trilinear field.
fn central(volume: &Volume, p: [f64; 3]) -> DVec3 {
    let along = |a: usize| {
        let (mut ahead, mut behind) = (p, p);
        ahead[a] += 1.0;
        behind[a] -= 1.0;
        0.5 * (trilinear(volume, ahead) - trilinear(volume, behind))
    };
    DVec3::new(along(0), along(1), along(2))
}

/// Φ in stored units at a point clamped to the voxel centres.
fn trilinear(volume: &Volume, p: [f64; 3]) -> f64 {
    let dims = volume.dims().usize();
    let p: [f64; 3] = std::array::from_fn(|a| p[a].clamp(0.0, dims[a] as f64 - 1.0));
    let low = p.map(|c| c as usize);
    let mut sum = 0.0;
    for corner in 0..8 {
        let up = |a: usize| corner >> a & 1;
        let at: [usize; 3] = std::array::from_fn(|a| (low[a] + up(a)).min(dims[a] - 1));
        let f = |a: usize| p[a] - low[a] as f64;
        let weight: f64 = (0..3)
            .map(|a| if up(a) == 1 { f(a) } else { 1.0 - f(a) })
            .product();
        let i = (at[2] * dims[1] + at[1]) * dims[0] + at[0];
        sum += weight * volume.voxels().stored(i);
    }
    sum
}

/// The angle between two directions; 90° if one of them is zero.
fn angle_deg(a: DVec3, b: DVec3) -> f64 {
    let (a, b) = (a.normalize_or_zero(), b.normalize_or_zero());
    a.cross(b)
        .length()
        .atan2(a.dot(b))
        .to_degrees()
        .max(if a == DVec3::ZERO || b == DVec3::ZERO {
            90.0
        } else {
            0.0
        })
}
