//! Gradient options, a part of the picture's: how normals are found.

use std::fmt;
use std::str::FromStr;

use super::group::Keys;
use super::numbers::SigmaVoxels;
use super::picture::PictureOptions;
use super::plain::plain;
use super::words::{GradientMethod, Mode, Shading};
use crate::error::{Error, Result};
use crate::scene::{Gradient, Precomputed};

/// `--gradient-scale`: voxels between two precomputed gradients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GradientScale(u32);

impl FromStr for GradientScale {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let scale = text.trim().parse().ok();
        let scale = scale.filter(|n| Precomputed::SCALES.contains(n));
        scale.map(Self).ok_or_else(|| {
            Error::usage(format!(
                "'{text}' is not a gradient scale: write a whole number from {} to {}",
                Precomputed::SCALES.start(),
                Precomputed::SCALES.end()
            ))
        })
    }
}

impl fmt::Display for GradientScale {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

plain!(GradientScale);

/// What gradients are made of.
const GRADIENT: [&str; 3] = ["gradient", "gradient-scale", "gradient-smooth"];
/// What only precomputed gradients make use of, and why no others do.
const PRECOMPUTED: [(&str, &str); 2] = [
    (
        "gradient-scale",
        "only precomputed gradients are kept at every N-th voxel",
    ),
    (
        "gradient-smooth",
        "only precomputed gradients are smoothed by themselves; 'smooth' is for the volume",
    ),
];

impl PictureOptions {
    fn gradient_method(&self) -> GradientMethod {
        self.gradient.unwrap_or_default()
    }

    /// Whether the picture has a place for normals. An unshaded surface has its normal layer.
    pub(super) fn has_normals(&self) -> bool {
        match self.mode() {
            Mode::Iso => true,
            Mode::Dvr => self.shading() != Shading::None,
            Mode::Mip | Mode::Lmip | Mode::Minip | Mode::Mean => false,
        }
    }

    /// Without what makes gradients.
    pub(super) fn without_gradient(self) -> Self {
        self.keeping(|key| !GRADIENT.contains(&key))
    }

    /// Without what only precomputed gradients make use of.
    pub(super) fn without_precomputed(self) -> Self {
        self.keeping(|key| PRECOMPUTED.iter().all(|(only, _)| *only != key))
    }

    /// # Errors
    /// A gradient where there are no normals; what only precomputed gradients use, for others.
    pub(super) fn check_gradient(&self) -> Result<()> {
        let given = self.given();
        let is_given = |key: &str| given.iter().any(|given| given == key);
        let mode = self.mode();
        if !self.has_normals()
            && let Some(key) = GRADIENT.iter().find(|key| is_given(key))
        {
            return Err(Error::usage(format!(
                "'{key}' has no effect in mode '{mode}' without shading"
            ))
            .hint("choose a shading: phong or blinn-phong"));
        }
        let method = self.gradient_method();
        if method != GradientMethod::Precomputed
            && let Some((key, why)) = PRECOMPUTED.iter().find(|(key, _)| is_given(key))
        {
            return Err(Error::usage(format!(
                "'{key}' does not go with gradient '{method}': {why}"
            ))
            .hint("it belongs to gradient precomputed"));
        }
        Ok(())
    }

    /// The gradient's options alone, with their defaults in place.
    pub(super) fn differentiated(&self) -> Result<Self> {
        let none = Self::default();
        if !self.has_normals() {
            return Ok(none);
        }
        let method = self.gradient_method();
        let gradient = Self {
            gradient: Some(method),
            ..none
        };
        if method != GradientMethod::Precomputed {
            return Ok(gradient);
        }
        let default = Precomputed::default();
        let smooth = self
            .gradient_smooth
            .map_or_else(|| SigmaVoxels::new(default.sigma_voxels()), Ok)?;
        let scale = self
            .gradient_scale
            .unwrap_or(GradientScale(default.scale()));
        Ok(Self {
            gradient_scale: Some(scale),
            gradient_smooth: Some(smooth),
            ..gradient
        })
    }

    /// From filled options.
    pub(super) fn gradient(&self) -> Result<Gradient> {
        Ok(match self.gradient_method() {
            GradientMethod::Central => Gradient::Central,
            GradientMethod::Forward => Gradient::Forward,
            GradientMethod::FourthOrder => Gradient::FourthOrder,
            GradientMethod::Precomputed => {
                let default = Precomputed::default();
                Gradient::Precomputed(Precomputed::new(
                    self.gradient_scale.map_or(default.scale(), |scale| scale.0),
                    self.gradient_smooth
                        .map_or(default.sigma_voxels(), SigmaVoxels::get),
                )?)
            }
        })
    }
}
