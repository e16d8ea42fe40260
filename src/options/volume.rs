//! Which volume, and how it is read: what the voxels are before they are used.

use std::path::PathBuf;

use clap::builder::{MapValueParser, PathBufValueParser, TypedValueParser, ValueParserFactory};

use super::enum_names::NonFiniteRule;
use super::group::group;
use super::quantities::SigmaMm;
use super::text_form::{self, text_form};
use super::triple::SpacingMm;
use crate::octree::Leaf;

/// A file's path. In a scene file, relative to that file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FilePath(pub PathBuf);

impl ValueParserFactory for FilePath {
    type Parser = MapValueParser<PathBufValueParser, fn(PathBuf) -> Self>;

    fn value_parser() -> Self::Parser {
        PathBufValueParser::new().map(Self)
    }
}

impl serde::Serialize for FilePath {
    fn serialize<S: serde::Serializer>(&self, into: S) -> Result<S::Ok, S::Error> {
        into.serialize_str(&self.0.to_string_lossy())
    }
}

impl<'de> serde::Deserialize<'de> for FilePath {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        text_form::deserialize(from).map(Self)
    }
}

/// `NXxNYxNZ`, in a scene file also a list: for the volume's reader to understand.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RawSizeText(pub String);

impl std::str::FromStr for RawSizeText {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(Self(text.replace(',', "x")))
    }
}

impl std::fmt::Display for RawSizeText {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

text_form!(Leaf, RawSizeText);

group! {
    /// The volume and how it is read.
    #[derive(serde::Serialize)]
    #[command(next_help_heading = "Volume")]
    pub struct VolumeOptions {
        /// The volume: NRRD, MetaImage, NIfTI, NumPy or headerless raw, recognised by its content
        #[arg(value_name = "VOLUME", help_heading = None::<&str>)]
        volume: FilePath,

        /// Which volume of a 4-D file, counted from 0
        #[arg(long, value_name = "N", allow_hyphen_values = true)]
        frame: u32,

        /// Smooth with a Gaussian of this standard deviation in mm
        #[arg(long, value_name = "SIGMA_MM", allow_hyphen_values = true)]
        smooth: SigmaMm,

        /// NaN and infinite voxels: replace (by the smallest finite value) or refuse
        #[arg(long, value_name = "replace|refuse")]
        non_finite: NonFiniteRule,

        /// Size of a headerless raw file in voxels
        #[arg(long, value_name = "NXxNYxNZ", allow_hyphen_values = true)]
        raw_size: RawSizeText,

        /// Voxel type of a headerless raw file, with 'be' for big-endian: u8, i16, u16be, f32 ...
        #[arg(long, value_name = "TYPE")]
        raw_type: String,

        /// Voxel spacing of a headerless raw file, mm
        #[arg(long, value_name = "S|SX,SY,SZ", allow_hyphen_values = true)]
        raw_spacing: SpacingMm,

        /// Bytes before the first voxel of a headerless raw file
        #[arg(long, value_name = "BYTES", allow_hyphen_values = true)]
        raw_offset: u64,

        /// Edge of the octree's leaves in cells (a cell lies between 8 voxel centres), 4 to 32; never
        /// changes the picture, but for which pixels --screen-error fills outside iso
        #[arg(long, value_name = "CELLS", allow_hyphen_values = true)]
        octree_leaf: Leaf,
    }
}

impl VolumeOptions {
    /// Returns the options with every default in its place. The layout of a raw file has none, since other
    /// files have their own; nor has the octree, which never changes the picture.
    #[must_use]
    pub(super) fn resolve(self) -> Self {
        Self {
            frame: self.frame.or(Some(0)),
            smooth: Some(self.smooth.unwrap_or_default()),
            non_finite: Some(self.non_finite.unwrap_or_default()),
            ..self
        }
    }
}
