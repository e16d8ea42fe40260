//! Display options: from linear light to what a screen shows.

use super::group::group;
use super::text_form::text_form;
use crate::scene::{Brightness, Contrast, Gamma, SrgbColor, Tone};

text_form!(Brightness, Contrast, Gamma, SrgbColor);

group! {
    /// The picture on a display; EXR and NPY never contain any of it.
    #[derive(serde::Serialize)]
    #[command(next_help_heading = "Display (PNG, JPEG, WebP)")]
    pub struct ToneOptions {
        /// Colour behind everything: sRGB r,g,b from 0 to 1, #rrggbb, #rgb, or a CSS name such as white
        #[arg(long, value_name = "COLOR", allow_hyphen_values = true)]
        background: SrgbColor,

        /// Added to the encoded picture, -1 to 1
        #[arg(long, value_name = "B", allow_hyphen_values = true)]
        brightness: Brightness,

        /// Slope about middle grey
        #[arg(long, value_name = "C", allow_hyphen_values = true)]
        contrast: Contrast,

        /// Above 1 brightens the middle, below 1 darkens it
        #[arg(long, value_name = "G", allow_hyphen_values = true)]
        gamma: Gamma,
    }
}

impl ToneOptions {
    /// Makes the tone curve, and the options that make the same.
    pub(super) fn resolve(self) -> (Tone, Self) {
        let background = self.background.unwrap_or(SrgbColor::BLACK);
        let tone = Tone {
            background: background.linear(),
            brightness: self.brightness.unwrap_or_default(),
            contrast: self.contrast.unwrap_or_default(),
            gamma: self.gamma.unwrap_or_default(),
        };
        let options = Self {
            background: Some(background),
            brightness: Some(tone.brightness),
            contrast: Some(tone.contrast),
            gamma: Some(tone.gamma),
        };
        (tone, options)
    }
}
