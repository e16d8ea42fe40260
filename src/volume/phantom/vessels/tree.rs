//! The tree as data, and Murray's law.
//!
//! C. D. Murray, "The physiological principle of minimum work. I", PNAS 12 (1926): the cube of a
//! vessel's radius is the sum of its branches' cubes. C. D. Murray, "The physiological principle
//! of minimum work applied to the angle of branching of arteries", J. Gen. Physiol. 9 (1926): the
//! branches leave at the angles which make the vessels' volume least, where the unit directions,
//! weighted by squared radii, balance: r0² t0 = r1² t1 + r2² t2.

use serde::Serialize;

use crate::extent::Dims;

/// The exponent n of `r0^n = r1^n + r2^n`.
pub const MURRAY_EXPONENT: f64 = 3.0;

/// A vessel from one branching to the next (or to a tip). World space, mm; the radius is the same
/// all along.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VesselSegment {
    /// The segment's index in [`VesselTree::segments`].
    pub id: usize,
    /// The segment at whose end this one starts; the root has none.
    pub parent: Option<usize>,
    /// Branchings between the root and here.
    pub generation: u32,
    /// The radius, mm.
    pub radius_mm: f64,
    /// The radius, in voxels of the smallest spacing.
    pub radius_voxels: f64,
    /// The start of the centreline.
    pub start_mm: [f64; 3],
    /// The end of the centreline.
    pub end_mm: [f64; 3],
    /// The centreline's unit tangent at the start; at a branching it obeys Murray's angles.
    pub start_direction: [f64; 3],
    /// The centreline's unit tangent at the end; at a branching it obeys Murray's angles.
    pub end_direction: [f64; 3],
    /// The centreline: a polyline from start to end, both included. What the voxels show is the
    /// tube around exactly this polyline.
    pub points_mm: Vec<[f64; 3]>,
}

/// All segments, a parent before its branches. Each has no branches or two.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VesselTree {
    /// The number of voxels along each axis.
    pub dims: Dims,
    /// The distance of voxel centres along each axis, mm.
    pub spacing_mm: [f64; 3],
    /// The seed that the tree was grown from.
    pub seed: u64,
    /// The exponent of Murray's law ([`MURRAY_EXPONENT`]).
    pub murray_exponent: f64,
    /// The segments; a segment's `id` is its index.
    pub segments: Vec<VesselSegment>,
}

/// Cosines of the angles between a vessel of radius `r0` and its branches of `r1` and `r2`: the
/// law of cosines in the triangle of sides r0², r1², r2², which is Murray's balance.
pub(super) fn branching_cosines(r0: f64, r1: f64, r2: f64) -> [f64; 2] {
    let [s0, s1, s2] = [r0, r1, r2].map(|r| r * r);
    let cosine = |a: f64, b: f64| (s0 * s0 + a * a - b * b) / (2.0 * s0 * a);
    [
        cosine(s1, s2).clamp(-1.0, 1.0),
        cosine(s2, s1).clamp(-1.0, 1.0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The volume of three straight vessels from a branching at (x, y) to fixed ends.
    fn volume(ends: [([f64; 2], f64); 3], [x, y]: [f64; 2]) -> f64 {
        let length = |[a, b]: [f64; 2]| (a - x).hypot(b - y);
        ends.iter().map(|&(end, r)| r * r * length(end)).sum()
    }

    /// Murray's angles are where the volume is smallest: moving the branching any way adds to it.
    #[test]
    fn branching_angles_minimise_the_volume() {
        let is_minimal = |cosines: [f64; 2], radii: [f64; 3]| {
            let sine = |c: f64| (1.0 - c * c).sqrt();
            let ends = [
                ([-1.0, 0.0], radii[0]),
                ([cosines[0], sine(cosines[0])], radii[1]),
                ([cosines[1], -sine(cosines[1])], radii[2]),
            ];
            let here = volume(ends, [0.0, 0.0]);
            (0..16).all(|n| {
                let (sin, cos) = (f64::from(n) * 0.4).sin_cos();
                volume(ends, [1e-3 * cos, 1e-3 * sin]) > here
            })
        };
        for r1 in [0.3_f64, 0.6, 0.8, 0.95] {
            let r2 = (1.0 - r1.powi(3)).cbrt();
            let cosines = branching_cosines(1.0, r1, r2);
            assert!(is_minimal(cosines, [1.0, r1, r2]), "r1 = {r1}");
            let wider = cosines.map(|c| (c.acos() + 0.05).cos());
            assert!(!is_minimal(wider, [1.0, r1, r2]), "r1 = {r1}, wrong angles");
        }
    }
}
