//! The tone curve: what a screen shows of linear light.

use super::{Brightness, Contrast, Gamma, Rgb};

/// The conversion of linear light to a display picture. Never applied to EXR or NPY.
///
/// In order: composite over `background`, encode as sRGB, `(v − ½)·contrast + ½ + brightness`,
/// clamp to 0..1, `v^(1/gamma)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    /// The colour behind the picture, linear light.
    pub background: Rgb,
    /// What is added to the encoded value.
    pub brightness: Brightness,
    /// The factor about the middle grey ½.
    pub contrast: Contrast,
    /// The inverse of the exponent.
    pub gamma: Gamma,
}

impl Default for Tone {
    fn default() -> Self {
        Self {
            background: Rgb::BLACK,
            brightness: Brightness::default(),
            contrast: Contrast::default(),
            gamma: Gamma::default(),
        }
    }
}
