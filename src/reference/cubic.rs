//! Cubic polynomials on [0, 1]: what the trilinear field is along a ray inside a cell.

use smallvec::{SmallVec, smallvec};

/// A cubic given by its Bézier ordinates, s from 0 to 1 along a segment: every value is a mean of them
/// with weights from 0 to 1. So it never leaves their range, and an ordinate whose weight is small
/// disturbs it little, however large it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cubic(pub [f64; 4]);

/// Parameters in ascending order, from 0 to 1.
pub type Parameters = SmallVec<[f64; 8]>;

/// Interpolates from `a` to `b`, never outside their range: from the nearer end, so that the rounding of
/// b − a cannot carry it past the other.
fn lerp(a: f64, b: f64, t: f64) -> f64 {
    if t < 0.5 {
        a + (b - a) * t
    } else {
        b - (b - a) * (1.0 - t)
    }
}

impl Cubic {
    /// The trilinear interpolant of `corners` (x fastest) along the line from `p` to `q` in the
    /// cell's own coordinates, 0 to 1. Never outside the corners' range; constant corners give an exactly
    /// constant polynomial.
    pub fn along(corners: &[f64; 8], p: [f64; 3], q: [f64; 3]) -> Self {
        // The polar form: each axis takes its coordinate from one end or the other.
        let ends = [p, q];
        let at = |x: usize, y: usize, z: usize| {
            let line = |at: usize| lerp(corners[at], corners[at + 1], ends[x][0]);
            let square = |at: usize| lerp(line(at), line(at + 2), ends[y][1]);
            lerp(square(0), square(4), ends[z][2])
        };
        Self([
            at(0, 0, 0),
            mean_of_three([at(1, 0, 0), at(0, 1, 0), at(0, 0, 1)]),
            mean_of_three([at(0, 1, 1), at(1, 0, 1), at(1, 1, 0)]),
            at(1, 1, 1),
        ])
    }

    /// The linear combination `Σ weights[i] · cubics[i]`.
    pub fn combine(cubics: &[Self; 3], weights: [f64; 3]) -> Self {
        let coefficient = |k: usize| (0..3).fold(0.0, |sum, i| sum + weights[i] * cubics[i].0[k]);
        Self([0, 1, 2, 3].map(coefficient))
    }

    /// Evaluates the cubic by de Casteljau's algorithm.
    pub fn at(&self, s: f64) -> f64 {
        let [a, b, c, d] = self.0;
        let [a, b, c] = [lerp(a, b, s), lerp(b, c, s), lerp(c, d, s)];
        let [a, b] = [lerp(a, b, s), lerp(b, c, s)];
        lerp(a, b, s)
    }

    fn slope(&self, s: f64) -> f64 {
        let [a, b, c] = self.differences();
        3.0 * lerp(lerp(a, b, s), lerp(b, c, s), s)
    }

    /// A third of the derivative's Bézier ordinates.
    fn differences(&self) -> [f64; 3] {
        let [a, b, c, d] = self.0;
        [b - a, c - b, d - c]
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
        self.0.iter().sum::<f64>() / 4.0
    }

    /// Ends of the pieces on which the polynomial is monotone: 0, its turning points, 1.
    pub fn monotone_ends(&self) -> Parameters {
        let mut ends: Parameters = smallvec![0.0];
        let differences = self.differences();
        let scale = differences.iter().fold(0.0, |max, d| d.abs().max(max));
        if scale > 0.0 {
            // The derivative k2·s² + k1·s + k0, by the form without cancellation.
            let [a, b, c] = differences.map(|d| d / scale);
            let (k0, k1, k2) = (a, 2.0 * (b - a), (a - b) + (c - b));
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

/// The mean of three values, never outside their range.
fn mean_of_three(values: [f64; 3]) -> f64 {
    let [a, b, c] = values;
    let mean = (a + b + c) / 3.0;
    mean.clamp(a.min(b).min(c), a.max(b).max(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// a + b·s + c·s² + d·s³
    fn power([a, b, c, d]: [f64; 4]) -> Cubic {
        let third = b / 3.0;
        Cubic([a, a + third, a + 2.0 * third + c / 3.0, a + b + c + d])
    }

    /// (s − a)(s − b)(s − c) · k
    fn with_roots([a, b, c]: [f64; 3], k: f64) -> Cubic {
        power([-a * b * c, a * b + b * c + c * a, -(a + b + c), 1.0].map(|x| x * k))
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
            let c = power([1.0 - 0.16 - miss, 0.8, -1.0, 0.0]);
            let mut found = SmallVec::new();
            c.push_crossings(1.0, &mut found);
            assert_eq!(found.len(), count);
        }
    }

    #[test]
    fn a_triple_root_and_a_flat_start_converge() {
        for cubic in [with_roots([0.3; 3], 1.0), power([-1e-30, 0.0, 0.0, 1.0])] {
            let root = cubic.crossing(0.0, 0.0, 1.0);
            assert!(cubic.at(root).abs() < 1e-16);
        }
    }

    #[test]
    fn turning_points_survive_cancellation() {
        // The derivative's roots are 1e-9 and 1e9.
        let c = power([0.0, 1.0, -0.5 * (1e9 + 1e-9), 1.0 / 3.0]);
        let ends = c.monotone_ends();
        assert_eq!(ends.len(), 3);
        assert!((ends[1] - 1e-9).abs() < 1e-20);
        assert_eq!(Cubic([7.0; 4]).monotone_ends().len(), 2);
        // They are a ten-thousandth apart; one sign further there are none.
        for (apart, count) in [(2.5e-9, 4), (-2.5e-9, 2)] {
            let c = power([0.0, 0.25 - apart, -0.5, 1.0 / 3.0]);
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
        let cubic = Cubic::along(&corners, p, std::array::from_fn(|a| p[a] + d[a]));
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
        let flat = Cubic::along(&[0.1; 8], p, [0.9, 0.2, 0.9]);
        assert_eq!(flat.0, [0.1; 4]);
        assert_eq!(flat.at(0.37), 0.1);
    }

    #[test]
    fn no_value_leaves_the_corners_range_however_far_they_are_apart() {
        let mut state = 7_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let kinds = [1e-30, 1e30, 3e-30, -1e30, 5.0, 0.1];
        let mut powers_leave = 0;
        for _ in 0..20_000 {
            let first = (random() * 6.0) as usize;
            let corners: [f64; 8] = [(); 8].map(|()| {
                kinds[if random() < 0.5 {
                    first
                } else {
                    (random() * 6.0) as usize
                }]
            });
            let low = corners.iter().fold(f64::INFINITY, |a, b| a.min(*b));
            let high = corners.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
            // As segments end: on a face here and there.
            let mut place = || [(); 3].map(|()| (1.5 * random() - 0.25).clamp(0.0, 1.0));
            let [p, q] = [place(), place()];
            let cubic = Cubic::along(&corners, p, q);
            let mut places: Vec<f64> = cubic.monotone_ends().to_vec();
            places.extend([random(), random(), random()]);
            for s in places {
                assert!(
                    (low..=high).contains(&cubic.at(s)),
                    "{corners:?} {p:?} {q:?} {s}"
                );
                // The control: by powers of s it does.
                let [a, b, c, d] = cubic.0;
                let [k1, k2, k3] = [
                    3.0 * (b - a),
                    3.0 * (a - 2.0 * b + c),
                    d - a + 3.0 * (b - c),
                ];
                let by_powers = ((k3 * s + k2) * s + k1) * s + a;
                powers_leave += usize::from(!(low..=high).contains(&by_powers));
            }
        }
        assert!(powers_leave > 100, "{powers_leave}");
    }
}
