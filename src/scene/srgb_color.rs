//! Colours as users write them.

use std::fmt;
use std::str::FromStr;

use super::Rgb;
use crate::error::{Error, Result};
use crate::number_text::numbers;

/// An sRGB-encoded colour, channels 0..1: `r,g,b`, `#rrggbb`, `#rgb`, or one of CSS's colour names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SrgbColor([f64; 3]);

impl SrgbColor {
    /// Black.
    pub const BLACK: Self = Self([0.0; 3]);
    /// White.
    pub const WHITE: Self = Self([1.0; 3]);
    /// The colour of surfaces where none is given: warm ivory.
    pub const IVORY: Self = Self([0.94, 0.87, 0.76]);

    /// Returns the colour in linear light.
    pub fn linear(self) -> Rgb {
        Rgb::from_srgb(self.0)
    }
}

impl FromStr for SrgbColor {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::usage(format!(
                "'{text}' is not a colour: write r,g,b from 0 to 1, #rrggbb, #rgb, or a colour's CSS name such as white"
            ))
        };
        let text = text.trim();
        let is_hex = text.starts_with('#') && matches!(text.len(), 4 | 7);
        let is_name = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_alphabetic());
        if is_hex || is_name {
            // Of what CSS writes more than that, nothing is an opaque colour by its name.
            let color = text.parse::<csscolorparser::Color>().map_err(|_| wrong())?;
            let [r, g, b, alpha] = color.to_rgba8();
            let opaque = alpha == u8::MAX;
            let channels = opaque.then_some([r, g, b]).ok_or_else(wrong)?;
            return Ok(Self(channels.map(|byte| f64::from(byte) / 255.0)));
        }
        let rgb: [f64; 3] = numbers(text).ok_or_else(wrong)?;
        if !rgb.iter().all(|channel| (0.0..=1.0).contains(channel)) {
            return Err(wrong());
        }
        Ok(Self(rgb))
    }
}

impl fmt::Display for SrgbColor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "{r},{g},{b}")
    }
}
