//! The names of a scene's choices, by which users write them.

use super::{
    Filter, HomogeneityRule, Mode, QuadratureMethod, Reconstruction, Refill, RefineMethod,
    SamplingMethod, Storage, Traverse, View,
};

/// Gives an enum its names: `name`, `Display`, and `FromStr`, for which upper and lower case are alike.
macro_rules! enum_names {
    ($type:ty, $what:literal: $($variant:ident = $name:literal),+ $(,)?) => {
        impl $type {
            const NAMES: &[(&'static str, Self)] = &[$(($name, Self::$variant)),+];

            /// Returns the name by which a user chooses this.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }
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
                f.write_str(self.name())
            }
        }
    };
}
pub(crate) use enum_names;

enum_names!(Mode, "a mode": Iso = "iso", Mip = "mip", Lmip = "lmip", Minip = "minip", Mean = "mean",
    Dvr = "dvr");
enum_names!(View, "a view": Anterior = "anterior", Posterior = "posterior", Left = "left",
    Right = "right", Superior = "superior", Inferior = "inferior");

enum_names!(Filter, "a filter": Nearest = "nearest", Linear = "linear");
enum_names!(Reconstruction, "a reconstruction": Full = "full", Adaptive = "adaptive");
enum_names!(RefineMethod, "a refiner": None = "none", Bisection = "bisection",
    RegulaFalsi = "regula-falsi", Illinois = "illinois", Newton = "newton");
enum_names!(QuadratureMethod, "a quadrature": Riemann = "riemann", Midpoint = "midpoint",
    Simpson = "simpson", Romberg = "romberg", Rk4 = "rk4", Preintegrated = "preintegrated",
    Adaptive = "adaptive");
enum_names!(HomogeneityRule, "a rule for homogeneous nodes": Optical = "optical", Range = "range");
enum_names!(Refill, "a refill": None = "none", Gradient = "gradient", Flood = "flood",
    Certified = "certified");
enum_names!(Traverse, "a traversal": Uniform = "uniform", KdRestart = "kd-restart",
    Hierarchical = "hierarchical", Revelles = "revelles", Distance = "distance");
enum_names!(Storage, "a way to hold voxels": Buffer = "buffer", Image = "image", Filtered = "filtered");
enum_names!(SamplingMethod, "a sampling": Fixed = "fixed", Exact = "exact");
