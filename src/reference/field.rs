//! Φ inside one box of the lattice, as a polynomial along a ray.

use crate::extent::Dims;
use crate::scene::Filter;
use crate::volume::Voxel;

use super::cells::{Lattice, Segment};
use super::cubic::Cubic;

/// The physical values of a volume, without its calibration's intercept, under a reconstruction
/// filter.
pub struct Field<'a, T> {
    voxels: &'a [T],
    dims: [usize; 3],
    slope: f64,
    filter: Filter,
    /// The boxes in which the field is one polynomial.
    pub lattice: Lattice,
}

impl<'a, T: Voxel> Field<'a, T> {
    /// `voxels` holds `dims.voxels()` values, x fastest.
    pub fn new(voxels: &'a [T], dims: Dims, slope: f64, filter: Filter) -> Self {
        Self {
            voxels,
            dims: dims.usize(),
            slope,
            filter,
            lattice: Lattice::new(dims, filter),
        }
    }

    /// The values at a box's corners, x fastest. With the nearest filter all are the voxel's own:
    /// a constant is a trilinear field too.
    pub fn corners(&self, cell: [usize; 3]) -> [f64; 8] {
        let [nx, ny, nz] = self.dims;
        let stride = [1, nx, nx * ny];
        let base = cell[0] + cell[1] * stride[1] + cell[2] * stride[2];
        let value = |index: usize| self.slope * self.voxels[index].into();
        if self.filter == Filter::Nearest {
            return [value(base); 8];
        }
        // An axis with a single voxel is constant along itself.
        let step = |axis: usize, n: usize| if n > 1 { stride[axis] } else { 0 };
        let (x, y, z) = (step(0, nx), step(1, ny), step(2, nz));
        [0, x, y, x + y, z, z + x, z + y, z + x + y].map(|offset| value(base + offset))
    }

    /// Φ along a segment, from its box's corners.
    pub fn along(corners: &[f64; 8], segment: &Segment) -> Cubic {
        // Rounding may leave a point a hair outside its box.
        let local = |p: f64, axis: usize| (p - segment.cell[axis] as f64).clamp(0.0, 1.0);
        let p: [f64; 3] = std::array::from_fn(|a| local(segment.p0[a], a));
        let q: [f64; 3] = std::array::from_fn(|a| local(segment.p1[a], a));
        Cubic::along(corners, p, q)
    }

    /// ∇Φ in index space at a point of a box, by the field in that box alone.
    pub fn slope_in(&self, cell: [usize; 3], p: [f64; 3]) -> [f64; 3] {
        let v = self.corners(cell);
        let at: [f64; 3] = std::array::from_fn(|a| (p[a] - cell[a] as f64).clamp(0.0, 1.0));
        let mix = |low: f64, high: f64, t: f64| low + (high - low) * t;
        // Of the differences along an axis, the four edges' mean by the other two axes, of which `b` is the lower.
        let along = |axis: usize| {
            let [b, c] = [[1, 2], [0, 2], [0, 1]][axis];
            let edge = |n: usize| v[n + (1 << axis)] - v[n];
            let low = mix(edge(0), edge(1 << b), at[b]);
            mix(
                low,
                mix(edge(1 << c), edge((1 << b) + (1 << c)), at[b]),
                at[c],
            )
        };
        [0, 1, 2].map(along)
    }

    /// Φ along a segment moved by whole voxels along an axis, clamped to the domain: past the last
    /// (first) box it slides along the domain's face.
    pub fn shifted(&self, segment: &Segment, axis: usize, by: isize) -> Cubic {
        let mut moved = *segment;
        let last = self.lattice.count[axis] - 1;
        let wanted = segment.cell[axis].checked_add_signed(by);
        if let Some(cell) = wanted.filter(|&cell| cell <= last) {
            moved.cell[axis] = cell;
            moved.p0[axis] += by as f64;
            moved.p1[axis] += by as f64;
        } else {
            let (cell, face) = if by > 0 {
                (last, self.dims[axis] - 1)
            } else {
                (0, 0)
            };
            moved.cell[axis] = cell;
            moved.p0[axis] = face as f64;
            moved.p1[axis] = face as f64;
        }
        Self::along(&self.corners(moved.cell), &moved)
    }
}

/// The smallest and largest of a box's corners bound Φ inside it.
pub fn bounds(corners: &[f64; 8]) -> (f64, f64) {
    corners
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), &v| {
            (lo.min(v), hi.max(v))
        })
}
