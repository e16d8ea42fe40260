//! Cutting a ray's interval by the scene's planes, after Yuan 2009, §3.4: it begins at the last
//! plane by which the ray enters and ends at the first by which it leaves.

use glam::DAffine3;

use crate::extent::Dims;
use crate::scene::ClipPlane;

use super::interval::{Entry, Interval};

/// The rounding errors of a sum of products, as a share of the sum of their magnitudes.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A clip plane in index space: keeps the points where `normal·p + offset ≥ 0`.
#[derive(Debug, Clone, Copy)]
pub struct IndexPlane {
    normal: [f64; 3],
    offset: f64,
}

impl IndexPlane {
    /// Transforms a plane from world space (mm) to index space.
    pub fn new(plane: ClipPlane, world_from_index: DAffine3) -> Self {
        let (normal, offset) = plane.in_space(world_from_index);
        Self {
            normal: normal.to_array(),
            offset,
        }
    }

    /// `normal·v + offset`; 0 where that is no more than its rounding error.
    fn product(&self, v: [f64; 3], offset: f64) -> f64 {
        let terms = [0, 1, 2].map(|a| self.normal[a] * v[a]);
        let sum = terms.iter().sum::<f64>() + offset;
        let size = terms.iter().map(|term| term.abs()).sum::<f64>() + offset.abs();
        if sum.abs() <= ROUNDING * size && size.is_finite() {
            0.0
        } else {
            sum
        }
    }
}

impl Interval {
    /// The part on the kept side of every plane. A ray parallel to a plane is kept or dropped as a
    /// whole; one that lies in the plane, or starts on it, is kept.
    pub fn clipped(self, planes: &[IndexPlane], dims: Dims) -> Option<Self> {
        // From the interval's start, which is near the planes that matter however far the eye is.
        let (mut enter_mm, mut leave_mm, mut entry) = (0.0, self.length_mm, self.entry);
        for (i, plane) in planes.iter().enumerate() {
            let rate = plane.product(self.dir, 0.0);
            let height = plane.product(self.start, plane.offset);
            if rate == 0.0 {
                if height < 0.0 {
                    return None;
                }
                continue;
            }
            let at_mm = -height / rate;
            if rate < 0.0 {
                leave_mm = at_mm.min(leave_mm);
            } else if at_mm > enter_mm {
                enter_mm = at_mm;
                entry = Some(Entry::Plane(i));
            }
        }
        if enter_mm > leave_mm {
            return None;
        }
        let domain = dims.domain();
        let at = |axis: usize| {
            let (low, high) = domain[axis];
            (self.start[axis] + self.dir[axis] * enter_mm).clamp(low, high)
        };
        Some(Self {
            enter_mm: self.enter_mm + enter_mm,
            length_mm: leave_mm - enter_mm,
            start: [at(0), at(1), at(2)],
            dir: self.dir,
            entry,
        })
    }
}
