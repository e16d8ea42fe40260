//! Gaussian pre-smoothing.

use glam::DVec3;
use rayon::prelude::*;

use super::{NonFinite, Volume, Voxel};
use crate::error::{Error, Result};
use crate::extent::Dims;
use crate::memory;
use crate::progress::Progress;
use crate::with_voxels;

/// `volume` convolved with a Gaussian of standard deviation `sigma_mm`, separably, with the
/// spacing of each axis. The kernel is sampled at the voxels, cut at 4 sigma (rounded up to whole
/// voxels) and normalised; beyond its border the volume counts as continued by its outermost
/// voxels. The result's voxels are f32, in stored values under the same calibration. A uniform
/// region keeps its value exactly. `sigma_mm` 0 changes no value.
///
/// Needs one f32 volume of memory besides the input.
///
/// # Errors
/// Usage: `sigma_mm` is negative, not finite, or longer than [`Dims::MAX_AXIS`] voxels. Resource:
/// not enough memory.
pub fn smooth(volume: &Volume, sigma_mm: f64, progress: &dyn Progress) -> Result<Volume> {
    let dims = volume.dims();
    let sigma_voxels = DVec3::splat(sigma_mm) / volume.geometry().spacing_mm();
    if !(sigma_mm.is_finite() && sigma_mm >= 0.0) {
        return Err(Error::usage(format!(
            "a smoothing sigma of {sigma_mm} mm: it must be 0 or a positive length"
        )));
    }
    if sigma_voxels.max_element() > Dims::MAX_AXIS as f64 {
        return Err(Error::usage(format!(
            "a smoothing sigma of {sigma_mm} mm is {:.0} voxels, more than any volume has",
            sigma_voxels.max_element()
        )));
    }
    let what = format!("the smoothing of {dims} voxels");
    let mut smoothed: Vec<f32> = memory::filled(dims.voxels() as usize, 0.0, &what)?;

    let [nx, ny, nz] = dims.usize();
    let kernels = [
        (sigma_voxels.x, nx),
        (sigma_voxels.y, ny),
        (sigma_voxels.z, nz),
    ]
    .map(|(sigma, n)| Kernel::new(sigma, n));
    progress.begin("smoothing", nz as u64);
    with_voxels!(volume.voxels(), source => smoothed
    .par_chunks_mut(nx * ny)
    .enumerate()
    .try_for_each_init(
        || memory::filled(nx * ny.max(3), 0.0, &what),
        |scratch, (k, slice)| {
            let scratch = scratch.as_mut().map_err(|short| short.clone())?;
            smooth_slice(source, dims, k, &kernels, scratch, slice);
            progress.advance(1);
            Ok(())
        },
    ))?;
    progress.end();

    let result = Volume::new(
        dims,
        smoothed.into(),
        *volume.geometry(),
        volume.rescale(),
        NonFinite::Refuse,
    )?;
    Ok(volume.notes().iter().fold(result, Volume::with_note))
}

/// Half of a symmetric kernel: the weights at distance 1, 2, … What the centre weighs follows from
/// the sum, 1.
struct Kernel {
    side: Vec<f32>,
}

impl Kernel {
    /// The weights for an axis of `n` voxels. Weights at distances that always end beyond the border are
    /// gathered at distance n − 1, which reads the same outermost voxel.
    fn new(sigma_voxels: f64, n: usize) -> Self {
        if sigma_voxels == 0.0 || n == 1 {
            return Self { side: Vec::new() };
        }
        let radius = (4.0 * sigma_voxels).ceil() as usize;
        let weight = |distance: usize| (-0.5 * (distance as f64 / sigma_voxels).powi(2)).exp();
        let sum = 1.0 + 2.0 * (1..=radius).map(weight).sum::<f64>();
        let near = radius.min(n - 1);
        let mut side: Vec<f64> = (1..=near).map(|d| weight(d) / sum).collect();
        side[near - 1] += (near + 1..=radius).map(weight).sum::<f64>() / sum;
        Self {
            side: side.into_iter().map(|w| w as f32).collect(),
        }
    }

    /// `out = centre + Σ w_d · ((back_d − centre) + (ahead_d − centre))`: a uniform neighbourhood
    /// stays itself to the last bit. `row` gives the row at a signed distance.
    fn apply<'a, T: Voxel>(&self, centre: &[T], row: impl Fn(isize) -> &'a [T], out: &mut [f32]) {
        for (out, &c) in out.iter_mut().zip(centre) {
            *out = narrow(c);
        }
        for (&w, d) in self.side.iter().zip(1..) {
            for (((out, &c), &back), &ahead) in out.iter_mut().zip(centre).zip(row(-d)).zip(row(d))
            {
                let c = narrow(c);
                *out += w * ((narrow(back) - c) + (narrow(ahead) - c));
            }
        }
    }
}

/// Every voxel type fits f32 exactly.
fn narrow<T: Voxel>(voxel: T) -> f32 {
    let wide: f64 = voxel.into();
    wide as f32
}

/// Slice `k` of the result: along z from the source, then along y and x within the slice. Rows
/// are the inner loops throughout. `scratch` has room for a slice and for three rows.
fn smooth_slice<T: Voxel>(
    source: &[T],
    dims: Dims,
    k: usize,
    [along_x, along_y, along_z]: &[Kernel; 3],
    scratch: &mut [f32],
    slice: &mut [f32],
) {
    let [nx, ny, nz] = dims.usize();
    let clamped = |at: usize, by: isize, n: usize| at.saturating_add_signed(by).min(n - 1);

    for (j, out) in slice.chunks_exact_mut(nx).enumerate() {
        let row = |d: isize| &source[(clamped(k, d, nz) * ny + j) * nx..][..nx];
        along_z.apply(row(0), row, out);
    }
    let scratch = &mut scratch[..nx * ny.max(3)];
    if !along_y.side.is_empty() {
        scratch[..nx * ny].copy_from_slice(slice);
        for (j, out) in slice.chunks_exact_mut(nx).enumerate() {
            let row = |d: isize| &scratch[clamped(j, d, ny) * nx..][..nx];
            along_y.apply(row(0), row, out);
        }
    }
    if !along_x.side.is_empty() {
        // The row between two runs of its border voxels: each distance is then a shifted slice.
        // Distances stay below nx.
        let padded = &mut scratch[..3 * nx];
        for out in slice.chunks_exact_mut(nx) {
            padded[..nx].fill(out[0]);
            padded[nx..2 * nx].copy_from_slice(out);
            padded[2 * nx..].fill(out[nx - 1]);
            let row = |d: isize| &padded[nx.saturating_add_signed(d)..][..nx];
            along_x.apply(row(0), row, out);
        }
    }
}
