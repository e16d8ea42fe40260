//! The transfer function as a TOML file, and the presets, which are files of the same form.

use std::fmt;
use std::path::Path;

use serde::de::{self, DeserializeSeed, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::toml_error::located;
use super::{Knot, Rgb, TransferFunction};
use crate::error::{Error, Result};
use crate::extent::Range;
use crate::input;
use crate::number_text::concise;

/// A transfer function as it is written down: `points = [[value, r, g, b, opacity], …]`,
/// ascending in value; r, g, b sRGB-encoded, they and the opacity in 0..1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TransferFile {
    /// The path length which the opacities are of, mm.
    #[serde(default = "one", deserialize_with = "positive")]
    pub unit_length_mm: f64,
    /// The units of the points' values.
    #[serde(default)]
    pub units: TransferUnits,
    /// The points: value, red, green, blue and opacity each, ascending in value.
    #[serde(deserialize_with = "ascending")]
    pub points: Vec<[f64; 5]>,
}

/// The units of the values of a transfer function's points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TransferUnits {
    /// Physical values of the volume.
    #[default]
    Value,
    /// Shares of the volume's robust value range (without a few far-away values and padding), 0 to
    /// 1: for scanners whose units are arbitrary.
    Range,
}

/// The presets' names and files.
const PRESETS: [(&str, &str); 3] = [
    ("cta", include_str!("presets/cta.toml")),
    ("mra", include_str!("presets/mra.toml")),
    ("3dra", include_str!("presets/3dra.toml")),
];

impl TransferFile {
    /// The preset for a volume of which nothing is known.
    pub const DEFAULT_PRESET: &'static str = "3dra";

    /// The presets' names.
    pub fn presets() -> impl Iterator<Item = &'static str> {
        PRESETS.iter().map(|(name, _)| *name)
    }

    /// The name and the text of the preset that is called so, in upper or lower case.
    pub(crate) fn preset(name: &str) -> Option<(&'static str, &'static str)> {
        let is_it = |(preset, _): &&(&str, &str)| preset.eq_ignore_ascii_case(name.trim());
        PRESETS.iter().find(is_it).copied()
    }

    /// A preset by its name, else the file of that name.
    ///
    /// # Errors
    /// Neither a preset nor a readable file; anything wrong in the file, with its line.
    pub fn named(name: &str) -> Result<Self> {
        if let Some((name, text)) = Self::preset(name) {
            return Self::parse(text, name);
        }
        if name.is_empty() {
            return Err(Error::usage("the transfer function has an empty name")
                .hint("name a preset (cta, mra, 3dra) or a TOML file"));
        }
        let path = Path::new(name);
        let text = input::text(path, "read the transfer function").map_err(|error| {
            let presets: Vec<&str> = Self::presets().collect();
            error.hint(format!("the presets are {}", presets.join(", ")))
        })?;
        Self::parse(&text, &path.display().to_string())
    }

    /// Parses TOML; `place` names the text in errors.
    ///
    /// # Errors
    /// Anything wrong, as `place:line: …`.
    pub fn parse(text: &str, place: &str) -> Result<Self> {
        toml::from_str(text).map_err(|error| located(&error, text, place))
    }

    /// Returns the same function over physical values, its shares taken of this range.
    #[must_use]
    pub fn in_values(mut self, range: Range) -> Self {
        if self.units == TransferUnits::Range {
            for point in &mut self.points {
                point[0] = range.at(point[0]);
            }
            self.units = TransferUnits::Value;
        }
        self
    }

    /// Converts to linear light, its shares taken of this range.
    ///
    /// # Errors
    /// As [`TransferFunction::new`].
    pub fn transfer_function(self, range: Range) -> Result<TransferFunction> {
        let Self {
            points,
            unit_length_mm,
            ..
        } = self.in_values(range);
        let knots = points.iter().map(|&[value, r, g, b, opacity]| Knot {
            value,
            color: Rgb::from_srgb([r, g, b]),
            opacity,
        });
        TransferFunction::new(knots.collect(), unit_length_mm)
    }
}

fn one() -> f64 {
    1.0
}

fn positive<'de, D: Deserializer<'de>>(from: D) -> std::result::Result<f64, D::Error> {
    let length = f64::deserialize(from)?;
    if length > 0.0 && length.is_finite() {
        Ok(length)
    } else {
        Err(de::Error::custom(format!(
            "unit_length_mm = {} must be positive",
            concise(length)
        )))
    }
}

/// Points one by one, so that an error is on its point's line.
fn ascending<'de, D: Deserializer<'de>>(from: D) -> std::result::Result<Vec<[f64; 5]>, D::Error> {
    struct Points;

    impl<'de> Visitor<'de> for Points {
        type Value = Vec<[f64; 5]>;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("points [[value, r, g, b, opacity], …]")
        }

        fn visit_seq<A: SeqAccess<'de>>(
            self,
            mut items: A,
        ) -> std::result::Result<Self::Value, A::Error> {
            let mut points: Self::Value = Vec::new();
            while let Some(point) = items.next_element_seed(PointAfter(points.last().copied()))? {
                points.push(point);
            }
            if points.is_empty() || points.len() > TransferFunction::MAX_KNOTS {
                return Err(de::Error::custom(format!(
                    "{} points: a transfer function has 1 to {}",
                    points.len(),
                    TransferFunction::MAX_KNOTS
                )));
            }
            Ok(points)
        }
    }

    from.deserialize_seq(Points)
}

/// A point, after the one given: refused while it is read, so that its line is known.
struct PointAfter(Option<[f64; 5]>);

impl<'de> DeserializeSeed<'de> for PointAfter {
    type Value = [f64; 5];

    fn deserialize<D: Deserializer<'de>>(
        self,
        from: D,
    ) -> std::result::Result<Self::Value, D::Error> {
        from.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for PointAfter {
    type Value = [f64; 5];

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a point [value, r, g, b, opacity]")
    }

    fn visit_seq<A: SeqAccess<'de>>(
        self,
        mut items: A,
    ) -> std::result::Result<Self::Value, A::Error> {
        let mut numbers = Vec::new();
        while let Some(number) = items.next_element::<f64>()? {
            numbers.push(number);
        }
        let Ok(point) = <[f64; 5]>::try_from(numbers) else {
            return Err(de::Error::custom(
                "a point is five numbers: [value, r, g, b, opacity]",
            ));
        };
        let [value, color_and_opacity @ ..] = point;
        if !value.is_finite() {
            return Err(de::Error::custom(format!(
                "the value {value} is not finite"
            )));
        }
        if let Some(wrong) = color_and_opacity.iter().find(|c| !(0.0..=1.0).contains(*c)) {
            return Err(de::Error::custom(format!(
                "{} is outside 0..1: r, g, b and opacity must lie in it",
                concise(*wrong)
            )));
        }
        if let Some(before) = self.0.filter(|before| value < before[0]) {
            return Err(de::Error::custom(format!(
                "the value {} is below the one before it, {}: points must ascend",
                concise(value),
                concise(before[0])
            )));
        }
        Ok(point)
    }
}
