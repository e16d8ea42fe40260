//! Display options: from linear light to what a screen shows.

use super::group::group;
use super::numbers::{Brightness, Contrast, Gamma};
use super::values::SrgbColor;
use crate::error::Result;
use crate::scene::{Rgb, Tone};

group! {
    /// The picture on a display; EXR and NPY never contain any of it.
    #[derive(serde::Serialize)]
    #[command(next_help_heading = "Display (PNG, JPEG, WebP)")]
    pub struct ToneOptions {
        /// Colour behind everything: sRGB r,g,b from 0 to 1, #rrggbb, #rgb, or a CSS name such as white
        /// [default: 0,0,0]
        #[arg(long, value_name = "COLOR", allow_hyphen_values = true)]
        background: SrgbColor,

        /// Added to the encoded picture, -1 to 1 [default: 0]
        #[arg(long, value_name = "B", allow_hyphen_values = true)]
        brightness: Brightness,

        /// Slope about middle grey [default: 1]
        #[arg(long, value_name = "C", allow_hyphen_values = true)]
        contrast: Contrast,

        /// Above 1 brightens the middle, below 1 darkens it [default: 1]
        #[arg(long, value_name = "G", allow_hyphen_values = true)]
        gamma: Gamma,
    }
}

impl ToneOptions {
    /// With every default in its place.
    pub(super) fn filled(self) -> Result<Self> {
        let default = Tone::default();
        Ok(Self {
            background: self
                .background
                .or(Some(SrgbColor(default.background.to_srgb()))),
            brightness: match self.brightness {
                Some(brightness) => Some(brightness),
                None => Some(Brightness::new(default.brightness)?),
            },
            contrast: match self.contrast {
                Some(contrast) => Some(contrast),
                None => Some(Contrast::new(default.contrast)?),
            },
            gamma: match self.gamma {
                Some(gamma) => Some(gamma),
                None => Some(Gamma::new(default.gamma)?),
            },
        })
    }

    pub(super) fn tone(&self) -> Tone {
        let default = Tone::default();
        Tone {
            background: self
                .background
                .map_or(default.background, |SrgbColor(c)| Rgb::from_srgb(c)),
            brightness: self.brightness.map_or(default.brightness, Brightness::get),
            contrast: self.contrast.map_or(default.contrast, Contrast::get),
            gamma: self.gamma.map_or(default.gamma, Gamma::get),
        }
    }
}
