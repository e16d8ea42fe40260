//! The transfer function: value to colour and opacity.

use crate::error::{Error, Result};

use super::Rgb;

/// A point of a transfer function: linear-light colour and opacity at a physical value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knot {
    pub value: f64,
    pub color: Rgb,
    /// Of a path of the unit length, 0..1.
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
    pub const MAX_KNOTS: usize = 4096;

    /// Knots ascending in value; two knots at the same value are a jump, the later one holding
    /// at the value itself.
    ///
    /// # Errors
    /// No knots or more than [`Self::MAX_KNOTS`]; values not finite or not ascending; colour or
    /// opacity outside 0..1; a unit length that is not positive.
    pub fn new(knots: Vec<Knot>, unit_length_mm: f64) -> Result<Self> {
        if knots.is_empty() || knots.len() > Self::MAX_KNOTS {
            return Err(Error::usage(format!(
                "a transfer function needs 1 to {} points, this one has {}",
                Self::MAX_KNOTS,
                knots.len()
            )));
        }
        if !(unit_length_mm > 0.0 && unit_length_mm.is_finite()) {
            return Err(Error::usage(format!(
                "unit_length_mm = {unit_length_mm} must be positive"
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

    pub fn knots(&self) -> &[Knot] {
        &self.knots
    }

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
