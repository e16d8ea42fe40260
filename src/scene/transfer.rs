//! The transfer function: value to colour and opacity.

use crate::error::{Error, Result};
use crate::extent::Range;

use super::Rgb;

/// A point of a transfer function: linear-light colour and opacity at a physical value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knot {
    /// The physical value.
    pub value: f64,
    /// The colour, linear light.
    pub color: Rgb,
    /// The opacity of a path of the unit length, 0..1.
    pub opacity: f64,
}

/// Piecewise linear between its knots in colour and opacity, constant outside them.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunction {
    knots: Vec<Knot>,
    unit_length_mm: f64,
}

impl TransferFunction {
    /// Opacity is limited to this, so that absorption stays finite.
    pub const MAX_OPACITY: f64 = 0.999_999;
    /// The most knots.
    pub const MAX_KNOTS: usize = 4096;
    /// The possible unit lengths, mm.
    pub const UNIT_LENGTH_MM: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

    /// Knots ascending in value; two knots at the same value are a jump, the later one holding
    /// at the value itself.
    ///
    /// # Errors
    /// No knots or more than [`Self::MAX_KNOTS`]; values not finite or not ascending; colour or
    /// opacity outside 0..1; a unit length outside [`Self::UNIT_LENGTH_MM`].
    pub fn new(knots: Vec<Knot>, unit_length_mm: f64) -> Result<Self> {
        if knots.is_empty() || knots.len() > Self::MAX_KNOTS {
            return Err(Error::usage(format!(
                "a transfer function needs 1 to {} points, this one has {}",
                Self::MAX_KNOTS,
                knots.len()
            )));
        }
        if !Self::UNIT_LENGTH_MM.contains(&unit_length_mm) {
            return Err(Error::usage(format!(
                "unit_length_mm = {unit_length_mm:e}: it must be {:e} to {:e}",
                Self::UNIT_LENGTH_MM.start(),
                Self::UNIT_LENGTH_MM.end()
            )));
        }
        for (i, knot) in knots.iter().enumerate() {
            let channels = knot.color.0.iter().chain([&knot.opacity]);
            if !knot.value.is_finite() || !channels.clone().all(|c| (0.0..=1.0).contains(c)) {
                return Err(Error::usage(format!(
                    "point {} of the transfer function: r, g, b and opacity must lie in 0..1 and the value must be finite",
                    i + 1
                )));
            }
            if i > 0 && knot.value < knots[i - 1].value {
                return Err(Error::usage(format!(
                    "point {} of the transfer function: its value {} is below the one before it, {}",
                    i + 1,
                    knot.value,
                    knots[i - 1].value
                )));
            }
        }
        Ok(Self {
            knots,
            unit_length_mm,
        })
    }

    /// The knots, ascending in value.
    pub fn knots(&self) -> &[Knot] {
        &self.knots
    }

    /// Knots of the same function on a range of values: none outside it, so that they narrow to
    /// single precision with the values, however far the function itself reaches.
    pub fn knots_within(&self, range: Range) -> Vec<Knot> {
        let end = |value: f64| {
            let (color, opacity) = self.at(value);
            Knot {
                value,
                color,
                opacity,
            }
        };
        let inside = |knot: &&Knot| knot.value > range.min && knot.value <= range.max;
        let mut knots = vec![end(range.min)];
        knots.extend(self.knots.iter().filter(inside));
        if knots.last().is_some_and(|last| last.value < range.max) {
            knots.push(end(range.max));
        }
        knots
    }

    /// Returns the same function of values that `moved` gives, which must keep their order (but for
    /// rounding).
    #[must_use]
    pub fn moved(&self, moved: impl Fn(f64) -> f64) -> Self {
        let mut min = f64::NEG_INFINITY;
        let knots = self.knots.iter().map(|knot| {
            min = moved(knot.value).max(min);
            Knot {
                value: min,
                ..*knot
            }
        });
        Self {
            knots: knots.collect(),
            unit_length_mm: self.unit_length_mm,
        }
    }

    /// The length of the path to which opacities refer, mm.
    pub fn unit_length_mm(&self) -> f64 {
        self.unit_length_mm
    }

    /// Colour (linear light, not premultiplied) and opacity of the unit length at a value.
    pub fn at(&self, value: f64) -> (Rgb, f64) {
        let after = self.knots.partition_point(|k| k.value <= value);
        let (Some(below), Some(above)) = (after.checked_sub(1), self.knots.get(after)) else {
            let end = if after == 0 {
                &self.knots[0]
            } else {
                &self.knots[after - 1]
            };
            return (end.color, end.opacity);
        };
        let below = &self.knots[below];
        let f = (value - below.value) / (above.value - below.value);
        let lerp = |a: f64, b: f64| a + (b - a) * f;
        let mut color = [0.0; 3];
        for (c, channel) in color.iter_mut().enumerate() {
            *channel = lerp(below.color.0[c], above.color.0[c]);
        }
        (Rgb(color), lerp(below.opacity, above.opacity))
    }

    /// Absorption per mm of an opacity of the unit length: `−ln(1 − α)/L`.
    pub fn absorption_per_mm(&self, opacity: f64) -> f64 {
        -(-opacity.min(Self::MAX_OPACITY)).ln_1p() / self.unit_length_mm
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knot(value: f64, grey: f64, opacity: f64) -> Knot {
        Knot {
            value,
            color: Rgb([grey; 3]),
            opacity,
        }
    }

    #[test]
    fn linear_between_constant_outside() {
        let tf =
            TransferFunction::new(vec![knot(10.0, 0.0, 0.0), knot(20.0, 1.0, 0.5)], 2.0).unwrap();
        assert_eq!(tf.at(-5.0), (Rgb([0.0; 3]), 0.0));
        assert_eq!(tf.at(15.0), (Rgb([0.5; 3]), 0.25));
        assert_eq!(tf.at(20.0), (Rgb([1.0; 3]), 0.5));
        assert_eq!(tf.at(99.0), (Rgb([1.0; 3]), 0.5));
        // exp(−κ L) = 1 − α
        assert!(((-tf.absorption_per_mm(0.5) * 2.0).exp() - 0.5).abs() < 1e-12);
        assert!(tf.absorption_per_mm(1.0).is_finite());
    }

    #[test]
    fn a_jump_takes_the_later_point() {
        let tf =
            TransferFunction::new(vec![knot(10.0, 0.0, 0.0), knot(10.0, 1.0, 1.0)], 1.0).unwrap();
        assert_eq!(tf.at(9.999).1, 0.0);
        assert_eq!(tf.at(10.0).1, 1.0);
    }

    #[test]
    fn knots_within_a_range_are_the_same_function_there() {
        let knots = vec![
            knot(-1e300, 0.0, 0.0),
            knot(10.0, 0.2, 0.1),
            knot(20.0, 0.4, 0.3),
            knot(20.0, 0.9, 0.8),
            knot(1e300, 1.0, 1.0),
        ];
        let whole = TransferFunction::new(knots, 1.0).unwrap();
        for (min, max) in [(0.0, 30.0), (10.0, 20.0), (12.0, 13.0), (5.0, 5.0)] {
            let range = Range { min, max };
            let part = TransferFunction::new(whole.knots_within(range), 1.0).unwrap();
            assert!(part.knots().iter().all(|k| range.contains(k.value)));
            for i in 0..=100 {
                let value = range.at(f64::from(i) / 100.0);
                let (a, b) = (whole.at(value), part.at(value));
                assert!((a.1 - b.1).abs() < 1e-12, "{value}: {} {}", a.1, b.1);
                assert!((a.0.0[0] - b.0.0[0]).abs() < 1e-12, "{value}");
            }
        }
        // Another range's knots are another function beyond that range.
        let part = whole.knots_within(Range {
            min: 0.0,
            max: 15.0,
        });
        assert_ne!(
            TransferFunction::new(part, 1.0).unwrap().at(30.0),
            whole.at(30.0)
        );
    }

    #[test]
    fn nonsense_is_refused() {
        assert!(TransferFunction::new(vec![], 1.0).is_err());
        assert!(TransferFunction::new(vec![knot(1.0, 0.0, 1.5)], 1.0).is_err());
        assert!(TransferFunction::new(vec![knot(f64::NAN, 0.0, 0.5)], 1.0).is_err());
        assert!(
            TransferFunction::new(vec![knot(2.0, 0.0, 0.5), knot(1.0, 0.0, 0.5)], 1.0).is_err()
        );
        assert!(TransferFunction::new(vec![knot(1.0, 0.0, 0.5)], 0.0).is_err());
    }
}
