//! What is shown: each kind of picture carries what only it needs.

use crate::error::{Error, Result};
use crate::extent::Range;
use crate::subject::Subject;

use super::{
    Homogeneity, Mode, Phong, Quadrature, Refine, Rgb, ShadedFrom, SrgbColor, Termination,
    TransferFile, TransferFunction,
};

/// The kind of picture (`--mode`).
#[derive(Debug, Clone, PartialEq)]
pub enum Picture {
    /// `iso`: the first point on the ray's interval where Φ − iso changes sign.
    Surface {
        /// The iso value, physical.
        iso: f64,
        /// A ray that enters its interval through a face or a clip plane where Φ ≥ iso hits there.
        caps: bool,
        /// How a crossing between two samples is refined.
        refine: Refine,
        /// The surface's colour, linear light.
        color: Rgb,
        /// The shading; `None`: the colour alone.
        phong: Option<Phong>,
    },
    /// `mip`, `minip`, `mean`, `lmip`: one value per ray, shown through a window.
    Projection {
        /// The value of a ray that is shown.
        of: Projection,
        /// The values shown as black and as white.
        window: Window,
    },
    /// `dvr`: emission and absorption under a transfer function.
    Emission(Emission),
}

/// An emitting, absorbing medium, and how it is integrated.
#[derive(Debug, Clone, PartialEq)]
pub struct Emission {
    /// The transfer function: colour and opacity of each value.
    pub transfer: TransferFunction,
    /// `None`: the transfer function's colours alone.
    pub phong: Option<Phong>,
    /// Where the medium is shaded: its colour is mixed with the shaded one, whose share is
    /// min(1, |∇Φ| / this), |∇Φ| by the differences that give the normal; where this is 0, the shaded one
    /// everywhere. In noise, where normals are of any direction, gradients are small.
    pub shaded_from: ShadedFrom,
    /// The quadrature rule, with its error bound if it has one.
    pub quadrature: Quadrature,
    /// A ray ends where its opacity exceeds this; the colour lost is at most
    /// (1 − termination) times the brightest colour.
    pub termination: Termination,
    /// `None`: every node that is not transparent is sampled. Not with shading, for normals differ
    /// within a node, nor with the adaptive quadrature, whose bound it would break.
    pub homogeneity: Option<Homogeneity>,
}

impl Emission {
    /// The opacity from which a pixel has layers: a depth, a value, a normal, a kind.
    pub const LAYERS_FROM: f32 = 0.01;

    /// Unshaded, with the default quadrature and termination.
    pub fn of(transfer: TransferFunction) -> Self {
        Self {
            transfer,
            phong: None,
            shaded_from: ShadedFrom::default(),
            quadrature: Quadrature::default(),
            termination: Termination::default(),
            homogeneity: None,
        }
    }
}

impl Picture {
    /// Whether a surface is closed where the volume ends, where nothing else is given.
    pub const CAPS: bool = true;

    /// Constructs the picture of a mode as the command line makes it where nothing else is given.
    ///
    /// # Errors
    /// Usage: a range of values beyond single precision.
    pub fn of_mode(mode: Mode, subject: &Subject) -> Result<Self> {
        let projection = |of| {
            let window = Window::of_range(subject.robust_range)?;
            Ok(Self::Projection { of, window })
        };
        match mode {
            Mode::Iso => Ok(Self::Surface {
                iso: subject.suggested_iso,
                caps: Self::CAPS,
                refine: Refine::default(),
                color: SrgbColor::IVORY.linear(),
                phong: Some(Phong::default()),
            }),
            Mode::Mip => projection(Projection::Maximum),
            Mode::Minip => projection(Projection::Minimum),
            Mode::Mean => projection(Projection::Mean),
            Mode::Lmip => projection(Projection::LocalMaximum {
                threshold: subject.suggested_iso,
            }),
            Mode::Dvr => {
                let preset = TransferFile::named(TransferFile::DEFAULT_PRESET)?;
                let transfer = preset.transfer_function(subject.robust_range)?;
                Ok(Self::Emission(Emission::of(transfer)))
            }
        }
    }

    /// Returns the kind of the picture.
    pub fn mode(&self) -> Mode {
        match self {
            Self::Surface { .. } => Mode::Iso,
            Self::Projection { of, .. } => of.mode(),
            Self::Emission(_) => Mode::Dvr,
        }
    }
}

/// The value of a ray that is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// The largest value.
    Maximum,
    /// The smallest value.
    Minimum,
    /// The mean value.
    Mean,
    /// The first local maximum ≥ threshold, else the maximum. Both ends of the interval count as
    /// local maxima when the value falls away from them (Sato et al. 1998).
    LocalMaximum {
        /// The smallest value, physical, that counts.
        threshold: f64,
    },
}

impl Projection {
    /// The mode that shows this projection.
    pub fn mode(self) -> Mode {
        match self {
            Self::Maximum => Mode::Mip,
            Self::Minimum => Mode::Minip,
            Self::Mean => Mode::Mean,
            Self::LocalMaximum { .. } => Mode::Lmip,
        }
    }
}

/// Values from `black` to `white`, either of which may be the higher one; the sRGB-encoded grey is
/// linear between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    black: f64,
    white: f64,
}

impl Window {
    /// Makes a window from the values shown as black and as white.
    ///
    /// # Errors
    /// The ends are the same value, or either is beyond single precision.
    pub fn new(black: f64, white: f64) -> Result<Self> {
        let max = f64::from(f32::MAX);
        if black.abs().max(white.abs()) > max {
            return Err(Error::usage(format!(
                "the window {black:e},{white:e} reaches beyond what a picture's values can: {max:e}"
            )));
        }
        if !(black.is_finite() && white.is_finite() && black != white) {
            return Err(Error::usage(format!(
                "the window {black},{white} is empty: its ends must be different values"
            )));
        }
        Ok(Self { black, white })
    }

    /// Constructs the window that shows a range of values; of a single value, one about it, which shows it
    /// as middle grey.
    ///
    /// # Errors
    /// Usage: a range beyond single precision.
    pub fn of_range(range: Range) -> Result<Self> {
        if range.min < range.max {
            return Self::new(range.min, range.max);
        }
        let margin = f64::max(0.5, range.min.abs() * 1e-3);
        Self::new(range.min - margin, range.max + margin)
    }

    /// Returns the value shown black.
    pub fn black(self) -> f64 {
        self.black
    }

    /// The value shown white.
    pub fn white(self) -> f64 {
        self.white
    }

    /// The values between the ends: below and above them all are shown as the end is.
    pub fn range(self) -> Range {
        Range {
            min: self.black.min(self.white),
            max: self.black.max(self.white),
        }
    }

    /// The sRGB-encoded grey of a value, 0..1.
    pub fn grey_srgb(self, value: f64) -> f64 {
        ((value - self.black) / (self.white - self.black)).clamp(0.0, 1.0)
    }
}
