//! The gradient of Φ inside one box of the lattice, as polynomials along a ray: a shift by whole
//! voxels keeps the faces of the boxes where they are.

use crate::scene::Gradient;
use crate::volume::Voxel;

use super::cells::Segment;
use super::cubic::Cubic;
use super::field::Field;

impl<T: Voxel> Field<'_, T> {
    /// ∇Φ in index space along a segment by the differences of `gradient`, every point clamped to
    /// the domain and the divisors the same at the border. Precomputed gradients stand for central
    /// differences, which are taken here.
    pub fn gradient(&self, segment: &Segment, gradient: Gradient) -> [Cubic; 3] {
        // Weights of Φ shifted by −2 to 2 voxels.
        let weights: &[(isize, f64)] = match gradient {
            Gradient::Central | Gradient::Precomputed(_) => &[(1, 0.5), (-1, -0.5)],
            Gradient::Forward => &[(1, 1.0), (0, -1.0)],
            Gradient::FourthOrder => &[
                (1, 8.0 / 12.0),
                (-1, -8.0 / 12.0),
                (2, -1.0 / 12.0),
                (-2, 1.0 / 12.0),
            ],
        };
        [0, 1, 2].map(|axis| {
            let mut sum = [0.0; 4];
            for pair in weights.chunks(2) {
                // In pairs of opposite weights, so that a constant field has none.
                let [(ahead, weight), (behind, _)] = [pair[0], pair[1]];
                let ahead = self.shifted(segment, axis, ahead).0;
                let behind = self.shifted(segment, axis, behind).0;
                for k in 0..4 {
                    sum[k] += weight * (ahead[k] - behind[k]);
                }
            }
            Cubic(sum)
        })
    }
}
