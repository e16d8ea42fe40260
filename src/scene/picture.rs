//! What is shown: each kind of picture carries what only it needs.

use crate::error::{Error, Result};

use super::{Homogeneity, Phong, Quadrature, Refine, Rgb, TransferFunction};

/// The kind of picture (`--mode`).
#[derive(Debug, Clone, PartialEq)]
pub enum Picture {
    /// `iso`: the first point on the ray's interval where Φ − iso changes sign.
    Surface {
        iso: f64,
        /// A ray that enters its interval through a face or a clip plane where Φ ≥ iso hits there.
        caps: bool,
        refine: Refine,
        color: Rgb,
        /// `None`: the colour alone.
        phong: Option<Phong>,
    },
    /// `mip`, `minip`, `mean`, `lmip`: one value per ray, shown through a window.
    Projection { of: Projection, window: Window },
    /// `dvr`: emission and absorption under a transfer function.
    Emission(Emission),
}

/// An emitting, absorbing medium, and how it is integrated.
#[derive(Debug, Clone, PartialEq)]
pub struct Emission {
    pub transfer: TransferFunction,
    /// `None`: the transfer function's colours alone.
    pub phong: Option<Phong>,
    pub quadrature: Quadrature,
    /// A ray ends where its opacity exceeds this, in (0, 1]; the colour lost is at most
    /// (1 − termination) times the brightest colour.
    pub termination: f64,
    /// `None`: every node that is not transparent is sampled. Not with shading, for normals differ
    /// within a node, nor with the adaptive quadrature, whose bound it would break.
    pub homogeneity: Option<Homogeneity>,
}

impl Emission {
    pub const DEFAULT_TERMINATION: f64 = 0.999;

    /// The opacity from which a pixel has layers: a depth, a value, a normal, a kind.
    pub const LAYERS_FROM: f32 = 0.01;

    /// Unshaded, with the default quadrature and termination.
    pub fn of(transfer: TransferFunction) -> Self {
        Self {
            transfer,
            phong: None,
            quadrature: Quadrature::default(),
            termination: Self::DEFAULT_TERMINATION,
            homogeneity: None,
        }
    }
}

impl Picture {
    /// The mode's name on the command line.
    pub fn mode(&self) -> &'static str {
        match self {
            Self::Surface { .. } => "iso",
            Self::Projection { of, .. } => of.mode(),
            Self::Emission(_) => "dvr",
        }
    }
}

/// Which value of a ray is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    Maximum,
    Minimum,
    Mean,
    /// The first local maximum ≥ threshold, else the maximum. Both ends of the interval count as
    /// local maxima when the value falls away from them (Sato et al. 1998).
    LocalMaximum {
        threshold: f64,
    },
}

impl Projection {
    pub fn mode(self) -> &'static str {
        match self {
            Self::Maximum => "mip",
            Self::Minimum => "minip",
            Self::Mean => "mean",
            Self::LocalMaximum { .. } => "lmip",
        }
    }
}

/// Values from `low` (black) to `high` (white); the sRGB-encoded grey is linear between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    low: f64,
    high: f64,
}

impl Window {
    /// # Errors
    /// `low >= high`, or either beyond single precision.
    pub fn new(low: f64, high: f64) -> Result<Self> {
        let most = f64::from(f32::MAX);
        if low.abs().max(high.abs()) > most {
            return Err(Error::usage(format!(
                "the window {low:e},{high:e} reaches beyond what a picture's values can: {most:e}"
            )));
        }
        if !(low.is_finite() && high.is_finite() && low < high) {
            return Err(Error::usage(format!(
                "the window {low},{high} is empty: its low end must be below its high end"
            )));
        }
        Ok(Self { low, high })
    }

    pub fn low(self) -> f64 {
        self.low
    }

    pub fn high(self) -> f64 {
        self.high
    }

    /// The sRGB-encoded grey of a value, 0..1.
    pub fn grey_srgb(self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }
}
