//! The transfer function as the integrator wants it: ranges of Φ on which colour and opacity are
//! linear, and the levels between them.

use crate::scene::{Knot, TransferFunction};

/// A range of Φ on which colour and opacity are linear.
#[derive(Debug, Clone, Copy)]
pub struct Ramp {
    from: f64,
    /// The width of the ramp in values; 0 if it is constant.
    width: f64,
    below: Knot,
    above: Knot,
}

impl Ramp {
    /// Whether the ramp absorbs nothing.
    pub fn is_clear(&self) -> bool {
        self.below.opacity == 0.0 && self.above.opacity == 0.0
    }

    /// Colour and opacity at a value of this range.
    fn at(&self, value: f64) -> ([f64; 3], f64) {
        let (a, b) = (&self.below, &self.above);
        if self.width == 0.0 {
            return (a.color.0, a.opacity);
        }
        // A rounding error beyond the range's end must not leave the end's colour.
        let f = ((value - self.from) / self.width).clamp(0.0, 1.0);
        let lerp = |a: f64, b: f64| a + (b - a) * f;
        let color = std::array::from_fn(|c| lerp(a.color.0[c], b.color.0[c]));
        (color, lerp(a.opacity, b.opacity))
    }
}

/// A prepared transfer function.
#[derive(Debug, Clone)]
pub struct Medium {
    transfer: TransferFunction,
    /// One more than knots: below the first, between each two, above the last.
    ramps: Vec<Ramp>,
    /// Ascending values where the absorption is not smooth: the knots, and where the opacity meets
    /// its limit.
    levels: Vec<f64>,
    /// How many of the first i knots are not clear.
    opaque_before: Vec<usize>,
}

impl Medium {
    /// Prepares a transfer function: its ramps, and the values where its absorption is not smooth.
    pub fn new(transfer: &TransferFunction) -> Self {
        let knots = transfer.knots();
        let constant = |knot: Knot| Ramp {
            from: knot.value,
            width: 0.0,
            below: knot,
            above: knot,
        };
        let between = |pair: &[Knot]| Ramp {
            from: pair[0].value,
            width: pair[1].value - pair[0].value,
            below: pair[0],
            above: pair[1],
        };
        let mut ramps = vec![constant(knots[0])];
        ramps.extend(knots.windows(2).map(between));
        ramps.push(constant(knots[knots.len() - 1]));
        let mut levels: Vec<f64> = knots.iter().map(|k| k.value).collect();
        let limit = TransferFunction::MAX_OPACITY;
        for pair in knots.windows(2) {
            let (a, b) = (pair[0].opacity, pair[1].opacity);
            if (a < limit) != (b < limit) {
                let f = (limit - a) / (b - a);
                levels.push(pair[0].value + (pair[1].value - pair[0].value) * f);
            }
        }
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        let mut opaque_before = vec![0];
        for knot in knots {
            let so_far = opaque_before[opaque_before.len() - 1];
            opaque_before.push(so_far + usize::from(knot.opacity > 0.0));
        }
        Self {
            transfer: transfer.clone(),
            ramps,
            levels,
            opaque_before,
        }
    }

    /// Whether nothing between two values, both included, absorbs.
    pub fn is_clear(&self, low: f64, high: f64) -> bool {
        let knots = self.transfer.knots();
        let first = knots.partition_point(|k| k.value < low);
        let end = knots.partition_point(|k| k.value <= high);
        self.opaque_before[first] == self.opaque_before[end.max(first)]
            && self.ramp(low).is_clear_at(low)
            && self.ramp(high).is_clear_at(high)
    }

    /// The range a value lies in; at a knot, the one above.
    pub fn ramp(&self, value: f64) -> &Ramp {
        &self.ramps[self.transfer.knots().partition_point(|k| k.value <= value)]
    }

    /// The levels strictly between two values.
    pub fn levels_between(&self, low: f64, high: f64) -> &[f64] {
        let first = self.levels.partition_point(|&v| v <= low);
        let end = self.levels.partition_point(|&v| v < high);
        &self.levels[first..end.max(first)]
    }

    /// The largest change of the absorption of a range by an error `noise` of Φ, per mm.
    pub fn noise_per_mm(&self, ramp: &Ramp, noise: f64) -> f64 {
        if ramp.width == 0.0 {
            return 0.0;
        }
        let opacity = ramp.below.opacity.max(ramp.above.opacity);
        self.transfer.absorption_per_mm(opacity) * (noise / ramp.width).min(1.0)
    }

    /// Colour (linear light, not premultiplied) and absorption per mm.
    pub fn at(&self, ramp: &Ramp, value: f64) -> ([f64; 3], f64) {
        let (color, opacity) = ramp.at(value);
        (color, self.transfer.absorption_per_mm(opacity))
    }
}

impl Ramp {
    fn is_clear_at(&self, value: f64) -> bool {
        self.at(value).1 == 0.0
    }
}
