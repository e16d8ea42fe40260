//! The signed error of every pixel.

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::frame::{Frame, percentile};

use super::Scale;
use super::color::color_entries;
use super::entry::Entry;
use super::geometry::{depth_entries, normal_entries};
use super::value::value_entries;

/// The quantity that a map shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// The mean of the three differences of the display planes' R, G and B, each with its sign:
    /// how much brighter the pixel is. Differences that cancel each other are not seen.
    Color,
    /// Positive where the picture's surface is farther from the eye than the reference's.
    Depth,
    /// The angle between the normals, which has no sign.
    Normal,
    /// The difference of the value planes, which is positive where the picture's value is larger.
    Value,
}

impl Quantity {
    /// The quantity's name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Color => "colour",
            Self::Depth => "depth",
            Self::Normal => "normal",
            Self::Value => "value",
        }
    }

    /// The unit of its numbers.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Color => "of white",
            Self::Depth => "voxels",
            Self::Normal => "degrees",
            Self::Value => "of the value range",
        }
    }

    /// The least that a map is coloured to: a level of 8 bits for colours, for values in a window over
    /// their whole range, and for the shading by a normal; a hundredth of a voxel. What rounding
    /// leaves is far below, and would else fill the maps of good pictures.
    pub fn min_scale(self) -> f64 {
        const LEVEL: f64 = 1.0 / 255.0;
        match self {
            Self::Color | Self::Value => LEVEL,
            Self::Depth => 0.01,
            Self::Normal => LEVEL.asin().to_degrees(),
        }
    }

    /// Whether the quantity has a sign.
    pub fn is_signed(self) -> bool {
        self != Self::Normal
    }
}

/// The error of one quantity, pixel by pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorMap {
    /// The quantity whose error is shown.
    pub quantity: Quantity,
    /// The size of the two pictures.
    pub size: ImageSize,
    /// The entries, row 0 at the top, x fastest, in [`Quantity::unit`].
    pub entries: Vec<Entry>,
    /// The difference, positive or negative, that gets the palette's last colour; larger ones get
    /// it too. Positive and finite; two maps are comparable by eye if theirs is the same.
    pub scale: f64,
}

impl ErrorMap {
    /// Compares the planes of a quantity. The map's scale is the 99th percentile of the absolute
    /// differences that are not 0: a few outliers do not make all else look alike.
    ///
    /// # Errors
    /// Those of [`super::color_error`], [`super::depth_error`], [`super::normal_error`] or
    /// [`super::value_error`].
    pub fn new(quantity: Quantity, reference: &Frame, frame: &Frame, scale: Scale) -> Result<Self> {
        let entries = match quantity {
            Quantity::Color => color_entries(reference, frame),
            Quantity::Depth => depth_entries(reference, frame, scale.smallest_spacing_mm),
            Quantity::Normal => normal_entries(reference, frame),
            Quantity::Value => value_entries(reference, frame, scale.range_width),
        }?;
        let mut sizes: Vec<f64> = entries
            .iter()
            .filter_map(|entry| entry.difference().map(f64::abs))
            .filter(|&size| size > 0.0)
            .collect();
        Ok(Self {
            quantity,
            size: frame.size,
            entries,
            scale: percentile(&mut sizes, 99)
                .unwrap_or(0.0)
                .max(quantity.min_scale()),
        })
    }

    /// Returns the same map, coloured to another scale.
    ///
    /// # Errors
    /// A scale that is not positive and finite.
    pub fn with_scale(mut self, scale: f64) -> Result<Self> {
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(Error::failed(format!(
                "an error map cannot be coloured to a scale of {scale}"
            )));
        }
        self.scale = scale;
        Ok(self)
    }

    /// Whether the map shows a difference to the eye: a hit is missed or added, or a difference reaches
    /// a twentieth of the scale.
    pub fn shows_something(&self) -> bool {
        self.entries.iter().any(|entry| match entry {
            Entry::Nothing => false,
            Entry::Missed | Entry::Extra => true,
            Entry::Difference(difference) => difference.abs() >= 0.05 * self.scale,
        })
    }

    /// The largest absolute difference; `None` where nothing is compared.
    pub fn largest(&self) -> Option<f64> {
        self.entries
            .iter()
            .filter_map(|entry| entry.difference().map(f64::abs))
            .reduce(f64::max)
    }
}
