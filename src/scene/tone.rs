//! The tone curve: what a screen shows of linear light.

use super::{Brightness, Contrast, Gamma, Rgb};

/// From linear light to a display picture. Never touches EXR or NPY.
///
/// In order: composite over `background`, encode as sRGB, `(v − ½)·contrast + ½ + brightness`,
/// clamp to 0..1, `v^(1/gamma)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    pub background: Rgb,
    pub brightness: Brightness,
    pub contrast: Contrast,
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
