//! File formats of pictures, and what each can hold.

use std::path::Path;

use crate::error::{Error, Result};
use crate::extent::ImageSize;

use super::layer::Layer;

/// The colour's channels in formats of linear light, which is premultiplied.
pub(super) const COLOR: [&str; 4] = ["R", "G", "B", "A"];

/// The longest side of a WebP: the header has 14 bits for it; most decoders stop one short of 2^14.
const WEBP_MAX_SIDE_PX: u32 = 16_383;

/// A picture's file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// PNG: the displayed picture without loss, and its scene.
    Png,
    /// OpenEXR: linear light and all layers as floats, and the scene.
    Exr,
    /// JPEG: the displayed picture, with loss.
    Jpeg,
    /// WebP: the displayed picture, without loss.
    WebP,
    /// NumPy's array file: linear light and all layers as floats.
    Npy,
}

const EXTENSIONS: [(&str, Format); 6] = [
    ("png", Format::Png),
    ("exr", Format::Exr),
    ("jpg", Format::Jpeg),
    ("jpeg", Format::Jpeg),
    ("webp", Format::WebP),
    ("npy", Format::Npy),
];

impl Format {
    /// The format that the file name's extension says, in upper or lower case.
    ///
    /// # Errors
    /// No extension, or one that is not known (usage).
    pub fn from_path(path: &Path) -> Result<Self> {
        let extension = path.extension().map(|e| e.to_string_lossy());
        let known = EXTENSIONS.iter().find(|(name, _)| {
            extension
                .as_ref()
                .is_some_and(|e| e.eq_ignore_ascii_case(name))
        });
        if let Some((_, format)) = known {
            return Ok(*format);
        }
        let cause = match extension {
            Some(extension) => {
                format!("'.{extension}' is not a picture format that can be written")
            }
            None => "the name has no extension that gives the picture's format".to_owned(),
        };
        let names: Vec<_> = EXTENSIONS
            .iter()
            .map(|(name, _)| format!(".{name}"))
            .collect();
        Err(Error::usage(format!("{}: {cause}", path.display()))
            .hint(format!("use one of {}", names.join(" "))))
    }

    /// Whether the format holds the picture as displayed (sRGB-encoded, opaque):
    /// [`super::Frame::display`]. The others hold linear light with alpha.
    pub fn is_display(self) -> bool {
        !self.carries_layers()
    }

    /// Whether the format carries the scene and the version as texts.
    pub fn carries_metadata(self) -> bool {
        matches!(self, Self::Png | Self::Exr)
    }

    /// Whether the format holds the layers beside the colour.
    pub fn carries_layers(self) -> bool {
        matches!(self, Self::Exr | Self::Npy)
    }
}

/// Bits per channel of a PNG (`--bit-depth`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BitDepth {
    /// 8 bits.
    Eight,
    /// 16 bits.
    Sixteen,
}

/// How a picture is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Encoding {
    /// The file format.
    pub format: Format,
    /// The bits per channel of a PNG.
    pub bit_depth: BitDepth,
    /// The quality of a JPEG, 1 (small) to 100 (good).
    pub quality: u8,
    /// The layers beside the colour, in any order; EXR and NPY only.
    pub layers: Vec<Layer>,
}

impl Encoding {
    /// The quality of a JPEG if none is given.
    pub const DEFAULT_QUALITY: u8 = 92;

    /// `format` with its defaults: 8 bits, [`Self::DEFAULT_QUALITY`], the colour alone.
    pub fn new(format: Format) -> Self {
        Self {
            format,
            bit_depth: BitDepth::Eight,
            quality: Self::DEFAULT_QUALITY,
            layers: Vec::new(),
        }
    }

    /// Checks that the format supports this encoding; [`super::write`] checks it too.
    ///
    /// # Errors
    /// Layers in a format without, 16 bits in another format than PNG, a quality outside 1..=100
    /// (usage).
    pub fn check(&self) -> Result<()> {
        if !self.layers.is_empty() && !self.format.carries_layers() {
            return Err(Error::usage(
                "layers beside the colour (--aov) fit into .exr and .npy files only",
            )
            .hint("write an .exr, or leave out --aov"));
        }
        if self.bit_depth == BitDepth::Sixteen && self.format != Format::Png {
            return Err(Error::usage(
                "16 bits per channel (--bit-depth 16) are for .png files only",
            )
            .hint("write a .png, or an .exr for 32-bit floating point"));
        }
        if !(1..=100).contains(&self.quality) {
            return Err(Error::usage(format!(
                "a JPEG quality of {}: it must be 1 to 100",
                self.quality
            )));
        }
        Ok(())
    }

    /// Checks that a picture of this size fits into the format; [`super::write`] checks it too. All but
    /// WebP hold every [`ImageSize`]: JPEG's limit is [`ImageSize::MAX_SIDE_PX`] itself.
    ///
    /// # Errors
    /// A side longer than the format has numbers for (usage).
    pub fn check_size(&self, size: ImageSize) -> Result<()> {
        let max = WEBP_MAX_SIDE_PX;
        if self.format == Format::WebP && size.width().max(size.height()) > max {
            return Err(Error::usage(format!(
                "a WebP has at most {max} pixels a side, the picture is {size}"
            ))
            .hint("write a .png"));
        }
        Ok(())
    }

    /// The layers that are written, each once, in the order of [`Layer::ALL`].
    pub(super) fn layers_in_order(&self) -> impl Iterator<Item = Layer> {
        Layer::ALL
            .into_iter()
            .filter(|layer| self.format.carries_layers() && self.layers.contains(layer))
    }
}

/// The names of a file's channels, in the order of an NPY's last axis (EXR keeps its channels
/// sorted by name).
pub fn channels(encoding: &Encoding) -> Vec<String> {
    let color: &[&str] = if encoding.format.is_display() {
        &["R", "G", "B"]
    } else {
        &COLOR
    };
    let layers = encoding.layers_in_order().flat_map(Layer::channels);
    color
        .iter()
        .chain(layers)
        .map(|name| (*name).to_owned())
        .collect()
}
