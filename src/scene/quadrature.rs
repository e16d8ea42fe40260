//! How the emission–absorption integral along a ray is approximated on the device.

use std::str::FromStr;

use crate::error::{Error, Result};

use super::SamplingMethod;

/// The rule. All but `Adaptive` work on panels between two samples of the fixed step; each is
/// exact for a constant medium, and its colours and opacities never leave 0..1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum QuadratureMethod {
    /// The panel's near end stands for all of it. Order 1.
    Riemann,
    /// The panel's middle stands for all of it. Order 2.
    Midpoint,
    /// Both ends and the middle. Order 4.
    Simpson,
    /// Two Richardson levels on the trapezoid rule, five points (Romberg 1955; Lesar et al. 2015,
    /// §III-E). Order 6.
    Romberg,
    /// The classical Runge–Kutta method on optical depth and colour (Lesar et al. 2015, §III-E).
    /// Order 4.
    Rk4,
    /// The field linear across the panel, the transfer function as it is (Röttger et al. 2000;
    /// Engel et al. 2001): order 2, and no value between the two samples is missed.
    Preintegrated,
    /// Panels as short as an error bound needs them, without a fixed step.
    Adaptive,
}

impl QuadratureMethod {
    /// All rules.
    pub const ALL: [Self; 7] = [
        Self::Riemann,
        Self::Midpoint,
        Self::Simpson,
        Self::Romberg,
        Self::Rk4,
        Self::Preintegrated,
        Self::Adaptive,
    ];
}

/// A rule and, where it takes one, its error bound: `METHOD[:BOUND]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quadrature {
    method: QuadratureMethod,
    bound: f64,
}

impl Quadrature {
    /// The possible error bounds of adaptive quadrature, in linear light of 0..1.
    pub const BOUNDS: std::ops::RangeInclusive<f64> = 1e-5..=0.1;
    /// The error bound of adaptive quadrature if none is given.
    pub const DEFAULT_BOUND: f64 = 1e-3;

    /// Constructs a rule with its default bound.
    pub fn of(method: QuadratureMethod) -> Self {
        let bound = match method {
            QuadratureMethod::Adaptive => Self::DEFAULT_BOUND,
            _ => 0.0,
        };
        Self { method, bound }
    }

    /// Constructs the adaptive rule with an error bound in [`Self::BOUNDS`].
    ///
    /// # Errors
    /// Usage: a bound outside them.
    pub fn adaptive(bound: f64) -> Result<Self> {
        if !Self::BOUNDS.contains(&bound) {
            return Err(Error::usage(format!(
                "an error of {bound}: the adaptive quadrature takes {:e} to {}",
                Self::BOUNDS.start(),
                Self::BOUNDS.end()
            )));
        }
        Ok(Self {
            method: QuadratureMethod::Adaptive,
            bound,
        })
    }

    /// Returns the rule.
    pub const fn method(self) -> QuadratureMethod {
        self.method
    }

    /// Returns how far each channel of a pixel's premultiplied linear light, and its opacity, may be off
    /// with the adaptive rule, early termination included; 0 with the others, which have no bound.
    pub const fn bound(self) -> f64 {
        self.bound
    }

    /// Returns how the rule samples: at fixed steps, or wherever its bound needs it.
    pub fn sampling(self) -> SamplingMethod {
        if self.is_stepped() {
            SamplingMethod::Fixed
        } else {
            SamplingMethod::Exact
        }
    }

    /// Whether the rule samples at a fixed step.
    pub fn is_stepped(self) -> bool {
        self.method != QuadratureMethod::Adaptive
    }
}

impl Default for Quadrature {
    fn default() -> Self {
        Self::of(QuadratureMethod::Simpson)
    }
}

impl FromStr for Quadrature {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let Some((name, bound)) = text.split_once(':') else {
            return text.parse().map(Self::of);
        };
        let method = name.parse()?;
        let adaptive = bound.parse().ok().and_then(|b| Self::adaptive(b).ok());
        match (method, adaptive) {
            (QuadratureMethod::Adaptive, Some(adaptive)) => Ok(adaptive),
            _ => Err(Error::usage(format!(
                "'{text}' is not a quadrature: :BOUND is adaptive's alone, an error from {:e} to {}",
                Self::BOUNDS.start(),
                Self::BOUNDS.end()
            ))),
        }
    }
}

impl std::fmt::Display for Quadrature {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.method {
            QuadratureMethod::Adaptive => write!(f, "{}:{}", self.method, self.bound),
            method => method.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadratures_parse_and_print() {
        for (text, printed) in [
            ("riemann", "riemann"),
            ("rk4", "rk4"),
            ("adaptive", "adaptive:0.001"),
            ("adaptive:1e-5", "adaptive:0.00001"),
            ("adaptive:0.1", "adaptive:0.1"),
        ] {
            let quadrature: Quadrature = text.parse().unwrap();
            assert_eq!(quadrature.to_string(), printed);
            assert_eq!(printed.parse::<Quadrature>().unwrap(), quadrature);
        }
        for bad in [
            "",
            "gauss",
            "simpson:1e-3",
            "adaptive:",
            "adaptive:1e-6",
            "adaptive:0.2",
            "adaptive:nan",
        ] {
            let error = bad.parse::<Quadrature>().unwrap_err();
            assert_eq!(error.exit_code(), 2, "{bad}");
        }
        for method in QuadratureMethod::ALL {
            let name = method.to_string();
            assert_eq!(name.parse::<Quadrature>().unwrap(), Quadrature::of(method));
        }
    }
}
