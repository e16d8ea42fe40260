//! A transfer function in the device's units: its knots, and the sums over them.

use crate::render::abi::{SMOOTH_PARTS, stored};
use crate::scene::TransferFunction;
use crate::volume::Volume;

/// The knots of a transfer function, ascending in value.
#[derive(Debug, Clone, PartialEq)]
pub struct Knots {
    /// The knots' values, in stored units.
    pub values: Vec<f32>,
    /// The knots' colours in linear light, with the opacity of the unit length in the last channel.
    pub colors: Vec<[f32; 4]>,
}

/// The factor by which 1 − opacity changes at most between two smooth knots (`SMOOTH_PARTS` of the
/// constants follows from it), so that three Gauss points integrate its logarithm within 1e-6 of itself.
const SMOOTH_RATIO: f64 = 1.5;

impl Knots {
    /// The knots that shape the function on the volume's values.
    pub fn of(transfer: &TransferFunction, volume: &Volume) -> Self {
        let knots = transfer.knots_within(volume.range());
        let rescale = volume.rescale();
        Self {
            values: knots.iter().map(|k| stored(rescale, k.value)).collect(),
            colors: knots
                .iter()
                .map(|k| {
                    let [r, g, b] = k.color.0.map(|c| c as f32);
                    [r, g, b, k.opacity as f32]
                })
                .collect(),
        }
    }

    /// Returns the same function with more knots, so that between any two its absorption is close to a
    /// polynomial.
    pub fn smooth(&self) -> Self {
        let mut smooth = Self {
            values: vec![self.values[0]],
            colors: vec![self.colors[0]],
        };
        for k in 1..self.values.len() {
            let [v0, v1] = [self.values[k - 1], self.values[k]].map(f64::from);
            let [c0, c1] = [self.colors[k - 1], self.colors[k]].map(|c| c.map(f64::from));
            if v0 < v1 {
                for f in smooth_parts(c0[3], c1[3]) {
                    smooth.values.push((v0 + (v1 - v0) * f) as f32);
                    let color = std::array::from_fn(|c| (c0[c] + (c1[c] - c0[c]) * f) as f32);
                    smooth.colors.push(color);
                }
            }
            smooth.values.push(self.values[k]);
            smooth.colors.push(self.colors[k]);
        }
        smooth
    }

    /// The values (stored units) outside of which the opacity vanishes; from +∞ to −∞ where it does
    /// everywhere.
    pub fn absorbing(&self) -> [f32; 2] {
        let absorbs = |color: &[f32; 4]| color[3] > 0.0;
        let (Some(first), Some(last)) = (
            self.colors.iter().position(absorbs),
            self.colors.iter().rposition(absorbs),
        ) else {
            return [f32::INFINITY, f32::NEG_INFINITY];
        };
        let before = first.checked_sub(1).map(|k| self.values[k]);
        let after = self.values.get(last + 1).copied();
        [
            before.unwrap_or(f32::NEG_INFINITY),
            after.unwrap_or(f32::INFINITY),
        ]
    }

    /// The most by which the knots' colours differ in a channel.
    pub fn color_spread(&self) -> f32 {
        let spread = |c: usize| {
            let channel = || self.colors.iter().map(|color| color[c]);
            channel().fold(0.0, f32::max) - channel().fold(1.0, f32::min)
        };
        (0..3).map(spread).fold(0.0, f32::max)
    }

    /// Two entries a knot, the number in single precision and what that lacks: the integrals from
    /// the first knot on of colour times absorption, and, in the last channel, of absorption, of
    /// the unit length.
    pub fn sums(&self) -> Vec<[f32; 4]> {
        let first_four = |sums: [f32; 5]| [sums[0], sums[1], sums[2], sums[3]];
        self.integrals().into_iter().map(first_four).collect()
    }

    /// The integrals of value times absorption, as [`Knots::sums`].
    pub fn value_sums(&self) -> Vec<f32> {
        self.integrals().into_iter().map(|sums| sums[4]).collect()
    }

    /// The integrals of colour, 1 and value, each times absorption, as [`Knots::sums`].
    fn integrals(&self) -> Vec<[f32; 5]> {
        let mut sum = [0.0; 5];
        let mut pairs = Vec::with_capacity(2 * self.values.len());
        for k in 0..self.values.len() {
            if k > 0 {
                let [v0, v1] = [self.values[k - 1], self.values[k]].map(f64::from);
                let [c0, c1] = [self.colors[k - 1], self.colors[k]].map(|c| c.map(f64::from));
                let parts = smooth_parts(c0[3], c1[3]);
                let ends = || std::iter::once(0.0).chain(parts.iter().copied());
                for (from, to) in ends().zip(ends().skip(1).chain([1.0])) {
                    for (place, weight) in GAUSS {
                        let f = from + (to - from) * place;
                        let at = |c: usize| c0[c] + (c1[c] - c0[c]) * f;
                        let absorption = (v1 - v0) * (to - from) * weight * unit_absorption(at(3));
                        let of = [at(0), at(1), at(2), 1.0, v0 + (v1 - v0) * f];
                        for (sum, of) in sum.iter_mut().zip(of) {
                            *sum += absorption * of;
                        }
                    }
                }
            }
            let near = sum.map(|s| s as f32);
            pairs.push(near);
            pairs.push(std::array::from_fn(|c| {
                (sum[c] - f64::from(near[c])) as f32
            }));
        }
        pairs
    }
}

/// Nodes on 0..1 and weights of the five-point rule.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_095),
    (0.230_765_344_947_158_5, 0.239_314_335_249_683),
    (0.5, 0.284_444_444_444_444_4),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683),
    (0.953_089_922_969_332, 0.118_463_442_528_095),
];

/// −ln(1 − opacity), that of the greatest opacity at most.
pub fn unit_absorption(opacity: f64) -> f64 {
    -(-opacity.min(TransferFunction::MAX_OPACITY)).ln_1p()
}

/// Where an interval between two opacities is divided, as shares of it, ascending.
fn smooth_parts(opacity_0: f64, opacity_1: f64) -> Vec<f64> {
    let min = 1.0 - TransferFunction::MAX_OPACITY;
    let (clear_0, clear_1) = (1.0 - opacity_0, 1.0 - opacity_1);
    let (low, high) = (clear_0.min(clear_1), clear_0.max(clear_1));
    let mut levels = Vec::with_capacity(SMOOTH_PARTS);
    let mut level = high / SMOOTH_RATIO;
    while level > low.max(min) {
        levels.push(level);
        level /= SMOOTH_RATIO;
    }
    if low < min && min < high {
        levels.push(min);
    }
    if clear_0 < clear_1 {
        levels.reverse();
    }
    levels
        .iter()
        .map(|level| (clear_0 - level) / (clear_0 - clear_1))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knots(points: &[(f32, f32)]) -> Knots {
        Knots {
            values: points.iter().map(|p| p.0).collect(),
            colors: points.iter().map(|p| [p.1, 0.5, 1.0 - p.1, p.1]).collect(),
        }
    }

    fn opacity_at(knots: &Knots, value: f64) -> f64 {
        let after = knots.values.partition_point(|&v| f64::from(v) <= value);
        if after == 0 || after == knots.values.len() {
            return knots.colors[after.min(knots.values.len() - 1)][3].into();
        }
        let [v0, v1] = [knots.values[after - 1], knots.values[after]].map(f64::from);
        let [a0, a1] = [knots.colors[after - 1][3], knots.colors[after][3]].map(f64::from);
        a0 + (a1 - a0) * (value - v0) / (v1 - v0)
    }

    const HARD: [(f32, f32); 7] = [
        (0.0, 0.0),
        (10.0, 1.0),
        (20.0, 0.999_999),
        (20.0, 0.2),
        (21.0, 0.0),
        (40.0, 0.0),
        (50.0, 0.999),
    ];

    #[test]
    fn smooth_knots_are_the_same_function_and_few() {
        let whole = knots(&HARD);
        let smooth = whole.smooth();
        for i in 0..=5000 {
            let value = f64::from(i) * 0.01;
            let off = opacity_at(&whole, value) - opacity_at(&smooth, value);
            assert!(off.abs() < 1e-6, "{value}: {off}");
        }
        assert!(smooth.values.len() > 40);
        assert!(smooth.values.is_sorted());
        // The worst interval, alone.
        let worst = knots(&[(0.0, 0.0), (1.0, 1.0)]).smooth().values.len() - 1;
        assert!((20..=SMOOTH_PARTS).contains(&worst), "{worst}");
        for pair in smooth.colors.windows(2) {
            let clear = pair_of(|k| (1.0 - f64::from(pair[k][3])).max(1e-6));
            let ratio = clear[0].max(clear[1]) / clear[0].min(clear[1]);
            // Not at the jump; single precision has two digits left of the smallest.
            assert!(ratio < 1.6 || pair[1][3] == 0.2, "{pair:?}");
        }
    }

    #[test]
    fn nothing_absorbs_outside_the_absorbing_values() {
        let everywhere = [f32::NEG_INFINITY, f32::INFINITY];
        assert_eq!(knots(&HARD).absorbing(), [0.0, f32::INFINITY]);
        assert_eq!(knots(&HARD[..6]).absorbing(), [0.0, 21.0]);
        assert_eq!(knots(&HARD[1..4]).absorbing(), everywhere);
        assert_eq!(knots(&HARD[3..5]).absorbing(), [f32::NEG_INFINITY, 21.0]);
        assert_eq!(
            knots(&[(1.0, 0.0), (2.0, 0.0)]).absorbing(),
            [f32::INFINITY, f32::NEG_INFINITY]
        );
    }

    fn pair_of(at: impl Fn(usize) -> f64) -> [f64; 2] {
        [at(0), at(1)]
    }

    /// ∫ −ln(1 − α) over a ramp from 0 to a: closed form. The same whether the knots are smooth.
    #[test]
    fn sums_are_the_integrals() {
        for a in [0.3f32, 0.9, 0.999_9] {
            for ramp in [&[(2.0, 0.0), (5.0, a)][..], &[(2.0, a), (5.0, 0.0)]] {
                for knots in [knots(ramp), knots(ramp).smooth()] {
                    let sums = knots.sums();
                    let last = sums.len() - 2;
                    let total = f64::from(sums[last][3]) + f64::from(sums[last + 1][3]);
                    let clear = 1.0 - f64::from(a);
                    let exact = 3.0 * (clear * clear.ln() + 1.0 - clear) / (1.0 - clear);
                    assert!((total - exact).abs() < 2e-7 * exact, "{a}: {total} {exact}");
                    // The control: the sum of less than all of it.
                    assert!((f64::from(sums[0][3]) - exact).abs() > 0.5 * exact);
                }
            }
        }
    }
}
