//! Cubic polynomials on [0, 1]: what the trilinear field is along a ray inside a cell.

use smallvec::{SmallVec, smallvec};

/// `c[0] + c[1]·s + c[2]·s² + c[3]·s³`, s from 0 to 1 along a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cubic(pub [f64; 4]);

/// Parameters in ascending order, from 0 to 1.
pub type Parameters = SmallVec<[f64; 8]>;

impl Cubic {
    /// The trilinear interpolant of `corners` (x fastest) along the line from `p` to `p + d` in the
    /// cell's own coordinates. Constant corners give an exactly constant polynomial.
    pub fn along(corners: &[f64; 8], p: [f64; 3], d: [f64; 3]) -> Self {
        let line = |at: usize| {
            let (a, b) = (corners[at], corners[at + 1]);
            [a + (b - a) * p[0], (b - a) * d[0]]
        };
        let square = |at: usize| {
            let (a, b) = (line(at), line(at + 2));
            let e = [b[0] - a[0], b[1] - a[1]];
            [
                a[0] + e[0] * p[1],
                a[1] + e[1] * p[1] + e[0] * d[1],
                e[1] * d[1],
            ]
        };
        let (a, b) = (square(0), square(4));
        let e = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        Self([
            a[0] + e[0] * p[2],
            a[1] + e[1] * p[2] + e[0] * d[2],
            a[2] + e[2] * p[2] + e[1] * d[2],
            e[2] * d[2],
        ])
    }

    /// `Σ weights[i] · cubics[i]`.
    pub fn combine(cubics: &[Self; 3], weights: [f64; 3]) -> Self {
        let coefficient = |k: usize| (0..3).fold(0.0, |sum, i| sum + weights[i] * cubics[i].0[k]);
        Self([0, 1, 2, 3].map(coefficient))
    }

    pub fn at(&self, s: f64) -> f64 {
        let [a, b, c, d] = self.0;
        ((d * s + c) * s + b) * s + a
    }

    fn slope(&self, s: f64) -> f64 {
        let [_, b, c, d] = self.0;
        (3.0 * d * s + 2.0 * c) * s + b
    }

    /// The Bézier ordinates of the part between two parameters: their hull holds its values.
    pub fn hull(&self, from: f64, to: f64) -> [f64; 4] {
        let third = (to - from) / 3.0;
        let (a, b) = (self.at(from), self.at(to));
        [
            a,
            a + third * self.slope(from),
            b - third * self.slope(to),
            b,
        ]
    }

    /// The mean over [0, 1].
    pub fn mean(&self) -> f64 {
        let [a, b, c, d] = self.0;
        a + b / 2.0 + c / 3.0 + d / 4.0
    }

    /// Ends of the pieces on which the polynomial is monotone: 0, its turning points, 1.
    pub fn monotone_ends(&self) -> Parameters {
        let mut ends: Parameters = smallvec![0.0];
        let [_, b, c, d] = self.0;
        let scale = b.abs().max(2.0 * c.abs()).max(3.0 * d.abs());
        if scale > 0.0 {
            // The derivative k2·s² + k1·s + k0, by the form without cancellation.
            let (k0, k1, k2) = (b / scale, 2.0 * c / scale, 3.0 * d / scale);
            let discriminant = k1 * k1 - 4.0 * k2 * k0;
            if discriminant > 0.0 {
                let q = -0.5 * (k1 + discriminant.sqrt().copysign(k1));
                let (one, other) = (q / k2, k0 / q);
                for root in [one.min(other), one.max(other)] {
                    if root > 0.0 && root < 1.0 {
                        ends.push(root);
                    }
                }
            }
        }
        ends.push(1.0);
        ends
    }

    /// Where the polynomial crosses `level` on a monotone piece whose ends lie on different sides
    /// of it: Newton's method, replaced by bisection whenever it leaves the bracket or does not
    /// halve its step in two turns, down to the last bit of [0, 1].
    pub fn crossing(&self, level: f64, from: f64, to: f64) -> f64 {
        let rises = self.at(from) < self.at(to);
        let (mut low, mut high) = (from, to);
        let (mut step, mut step_before) = (to - from, to - from);
        let mut s = 0.5 * (from + to);
        for _ in 0..128 {
            let f = self.at(s) - level;
            if f == 0.0 {
                return s;
            }
            if (f < 0.0) == rises {
                low = s;
            } else {
                high = s;
            }
            let newton = f / self.slope(s);
            let inside = s - newton > low && s - newton < high;
            let before = s;
            if inside && 2.0 * newton.abs() < step_before.abs() {
                (step_before, step) = (step, newton);
                s -= newton;
            } else {
                (step_before, step) = (step, 0.5 * (high - low));
                s = low + step;
            }
            if s == before || step.abs() < f64::EPSILON / 4.0 {
                return s;
            }
        }
        s
    }

    /// Appends every point in (0, 1) where the polynomial crosses `level`.
    pub fn push_crossings(&self, level: f64, out: &mut SmallVec<[f64; 16]>) {
        for ends in self.monotone_ends().windows(2) {
            let (a, b) = (self.at(ends[0]), self.at(ends[1]));
            if (a < level) != (b < level) {
                out.push(self.crossing(level, ends[0], ends[1]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (s − a)(s − b)(s − c) · k
    fn with_roots([a, b, c]: [f64; 3], k: f64) -> Cubic {
        Cubic([-a * b * c, a * b + b * c + c * a, -(a + b + c), 1.0].map(|x| x * k))
    }

    #[test]
    fn every_root_is_found_to_the_last_digits() {
        for k in [1.0, -1e-200, 1e200] {
            let cubic = with_roots([0.125, 0.3, 0.9], k);
            let mut found = SmallVec::new();
            cubic.push_crossings(0.0, &mut found);
            assert_eq!(found.len(), 3);
            for (f, root) in found.iter().zip([0.125, 0.3, 0.9]) {
                assert!((f - root).abs() < 1e-14, "{f} {root}");
            }
            found.clear();
            with_roots([0.5, 2.0, -1.0], k).push_crossings(0.0, &mut found);
            assert_eq!(found.len(), 1);
        }
    }

    #[test]
    fn roots_a_billionth_apart_are_two_and_none_when_they_miss() {
        // Touches 1 at s = 0.4 but for ±1e-9.
        for (miss, count) in [(1e-9, 0), (-1e-9, 2)] {
            let c = Cubic([1.0 - 0.16 - miss, 0.8, -1.0, 0.0]);
            let mut found = SmallVec::new();
            c.push_crossings(1.0, &mut found);
            assert_eq!(found.len(), count);
        }
    }

    #[test]
    fn a_triple_root_and_a_flat_start_converge() {
        for cubic in [with_roots([0.3; 3], 1.0), Cubic([-1e-30, 0.0, 0.0, 1.0])] {
            let root = cubic.crossing(0.0, 0.0, 1.0);
            assert!(cubic.at(root).abs() < 1e-16);
        }
    }

    #[test]
    fn turning_points_survive_cancellation() {
        // The derivative's roots are 1e-9 and 1e9.
        let c = Cubic([0.0, 1.0, -0.5 * (1e9 + 1e-9), 1.0 / 3.0]);
        let ends = c.monotone_ends();
        assert_eq!(ends.len(), 3);
        assert!((ends[1] - 1e-9).abs() < 1e-20);
        assert_eq!(Cubic([7.0, 0.0, 0.0, 0.0]).monotone_ends().len(), 2);
        // They are a ten-thousandth apart; one sign further there are none.
        for (apart, count) in [(2.5e-9, 4), (-2.5e-9, 2)] {
            let c = Cubic([0.0, 0.25 - apart, -0.5, 1.0 / 3.0]);
            assert_eq!(c.monotone_ends().len(), count);
        }
    }

    #[test]
    fn the_hull_holds_the_values() {
        let c = with_roots([0.2, 0.5, 1.5], 3.0);
        let (from, to) = (0.125, 0.75);
        let hull = c.hull(from, to);
        // De Casteljau's algorithm on the hull gives the polynomial.
        for f in [0.0, 0.3, 0.9] {
            let mut points = hull;
            for last in (1..4).rev() {
                for i in 0..last {
                    points[i] += (points[i + 1] - points[i]) * f;
                }
            }
            assert!((points[0] - c.at(from + (to - from) * f)).abs() < 1e-14);
            assert!((points[0] - c.at(from + (to - from) * f + 1e-6)).abs() > 1e-14);
        }
    }

    #[test]
    fn the_cubic_along_a_line_is_the_trilinear_field() {
        let corners = [1.0, 4.0, -2.0, 0.5, 3.0, 8.0, -7.0, 2.0];
        let (p, d) = ([0.1, 0.9, 0.3], [0.8, -0.7, 0.6]);
        let cubic = Cubic::along(&corners, p, d);
        for s in [0.0, 0.25, 0.7, 1.0] {
            let q: [f64; 3] = std::array::from_fn(|a| p[a] + d[a] * s);
            let mut value = 0.0;
            for (i, corner) in corners.iter().enumerate() {
                let weight = |a: usize| if i >> a & 1 == 1 { q[a] } else { 1.0 - q[a] };
                value += corner * weight(0) * weight(1) * weight(2);
            }
            assert!((cubic.at(s) - value).abs() < 1e-13);
            assert!((cubic.at(s) - value - 1e-6).abs() > 1e-13);
        }
        let flat = Cubic::along(&[0.1; 8], p, d);
        assert_eq!(flat.0, [0.1, 0.0, 0.0, 0.0]);
    }
}
