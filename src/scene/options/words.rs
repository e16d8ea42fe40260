//! Choices by name: what a flag calls each, in one place.

use super::plain::plain;
use crate::scene::{
    Filter, HomogeneityRule, QuadratureMethod, RefineMethod, SamplingMethod, Storage, Traverse,
};

/// Gives an enum its names: `FromStr` (upper and lower case alike), `Display`.
macro_rules! words {
    ($type:ty, $what:literal: $($variant:ident = $name:literal),+ $(,)?) => {
        impl $type {
            const NAMES: &[(&'static str, Self)] = &[$(($name, Self::$variant)),+];
        }

        impl std::str::FromStr for $type {
            type Err = crate::error::Error;

            fn from_str(text: &str) -> crate::error::Result<Self> {
                let is_it = |(name, _): &&(&str, Self)| name.eq_ignore_ascii_case(text.trim());
                let found = Self::NAMES.iter().find(is_it);
                found.map(|(_, choice)| *choice).ok_or_else(|| {
                    let names: Vec<&str> = Self::NAMES.iter().map(|(name, _)| *name).collect();
                    crate::error::Error::usage(format!(
                        concat!("'{}' is not ", $what, ": write one of {}"),
                        text,
                        names.join(", ")
                    ))
                })
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(match self {
                    $(Self::$variant => $name),+
                })
            }
        }
    };
}

/// `--mode`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    Iso,
    Mip,
    Lmip,
    Minip,
    Mean,
    Dvr,
}

impl Mode {
    /// In the order in which help and tables name them.
    pub const ALL: [Self; 6] = [
        Self::Iso,
        Self::Mip,
        Self::Lmip,
        Self::Minip,
        Self::Mean,
        Self::Dvr,
    ];
}

words!(Mode, "a mode": Iso = "iso", Mip = "mip", Lmip = "lmip", Minip = "minip", Mean = "mean",
    Dvr = "dvr");

/// `--shading`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shading {
    None,
    Phong,
    BlinnPhong,
}
words!(Shading, "a shading": None = "none", Phong = "phong", BlinnPhong = "blinn-phong");

/// `--gradient`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum GradientMethod {
    #[default]
    Central,
    Forward,
    FourthOrder,
    Precomputed,
}
words!(GradientMethod, "a gradient": Central = "central", Forward = "forward",
    FourthOrder = "fourth-order", Precomputed = "precomputed");

/// Something that is on or off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Switch {
    On,
    Off,
}
words!(Switch, "a switch": On = "on", Off = "off");

impl Switch {
    pub fn is_on(self) -> bool {
        self == Self::On
    }
}

impl From<bool> for Switch {
    fn from(on: bool) -> Self {
        if on { Self::On } else { Self::Off }
    }
}

/// What NaN and ±Inf voxels are read as (`--non-finite`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NonFiniteRule {
    /// As the smallest finite value of the volume.
    #[default]
    Replace,
    /// Not at all: they are an error.
    Refuse,
}
words!(NonFiniteRule, "a rule for NaN and infinite voxels": Replace = "replace", Refuse = "refuse");

/// `--view`: the side of the patient on which the eye is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum View {
    #[default]
    Anterior,
    Posterior,
    Left,
    Right,
    Superior,
    Inferior,
}
words!(View, "a view": Anterior = "anterior", Posterior = "posterior", Left = "left",
    Right = "right", Superior = "superior", Inferior = "inferior");

words!(Filter, "a filter": Nearest = "nearest", Linear = "linear");
words!(RefineMethod, "a refiner": None = "none", Bisection = "bisection",
    RegulaFalsi = "regula-falsi", Illinois = "illinois", Newton = "newton");
words!(QuadratureMethod, "a quadrature": Riemann = "riemann", Midpoint = "midpoint",
    Simpson = "simpson", Romberg = "romberg", Rk4 = "rk4", Preintegrated = "preintegrated",
    Adaptive = "adaptive");
words!(HomogeneityRule, "a rule for homogeneous nodes": Optical = "optical", Range = "range");
words!(Traverse, "a traversal": Uniform = "uniform", KdRestart = "kd-restart",
    Hierarchical = "hierarchical", Revelles = "revelles", Distance = "distance");
words!(Storage, "a way to hold voxels": Buffer = "buffer", Image = "image", Filtered = "filtered");
words!(SamplingMethod, "a sampling": Fixed = "fixed", Exact = "exact");

plain!(Mode, Shading, GradientMethod, Switch, NonFiniteRule, View);
