//! The pictures of a comparison and their error maps, as files.

use std::path::Path;
use std::time::Instant;

use crate::error::{Error, Result};
use crate::frame::error::{Entry, ErrorMap, Figures, Quantity, Scale};
use crate::frame::{self, Encoding, Format, Frame, Layer, median};
use crate::lab::report;
use crate::output::write_bytes;

use super::folder::Folder;
use super::row::RowFiles;

/// The metadata of a picture's files, for `--scene` and other programs.
pub type Metadata<'a> = [(&'a str, &'a str)];

/// A written picture.
pub struct Written {
    /// The names within the folder.
    pub png: String,
    pub exr: String,
    /// Time to write the PNG, ms.
    pub encode_ms: f64,
}

/// Writes a picture as PNG and, with all its planes, as EXR.
///
/// # Errors
/// The disk.
pub fn write(folder: &Folder, name: &str, frame: &Frame, metadata: &Metadata) -> Result<Written> {
    let png = format!("{name}.png");
    let began = Instant::now();
    let encoding = Encoding::new(Format::Png);
    frame::write(&folder.file(&png), frame, &encoding, metadata)?;
    let encode_ms = began.elapsed().as_secs_f64() * 1e3;
    let exr = format!("{name}.exr");
    let mut encoding = Encoding::new(Format::Exr);
    encoding.layers = layers_of(frame);
    frame::write(&folder.file(&exr), frame, &encoding, metadata)?;
    Ok(Written {
        png,
        exr,
        encode_ms,
    })
}

/// The layers whose planes are there.
fn layers_of(frame: &Frame) -> Vec<Layer> {
    frame.layers.iter().map(|(layer, _)| layer).collect()
}

/// The error map of a picture of these `figures`: where a surface lies or a projection's value, where
/// both pictures have it; else the colour.
///
/// # Errors
/// Pictures that cannot be compared.
pub fn error_map(
    reference: &Frame,
    frame: &Frame,
    figures: &Figures,
    scale: Scale,
) -> Result<ErrorMap> {
    let quantity = if figures.depth.is_some() {
        Quantity::Depth
    } else if figures.value.is_some() {
        Quantity::Value
    } else {
        Quantity::Color
    };
    ErrorMap::new(quantity, reference, frame, scale)
}

/// Colours maps of one mode to one scale for each quantity, the median of their own: equal colours are
/// then equal errors, and neither the best nor the worst setting makes the others look all alike.
///
/// # Errors
/// A map's own scale is not positive and finite, which [`ErrorMap`] rules out.
pub fn to_one_scale(maps: Vec<ErrorMap>) -> Result<Vec<ErrorMap>> {
    let scales: Vec<(Quantity, f64)> = maps.iter().map(|map| (map.quantity, map.scale)).collect();
    let common = |quantity| {
        let same = scales.iter().filter(|(other, _)| *other == quantity);
        median(&mut same.map(|(_, scale)| *scale).collect::<Vec<_>>())
    };
    let maps = maps.into_iter();
    maps.map(|map| match common(map.quantity) {
        Some(scale) => map.with_scale(scale),
        None => Ok(map),
    })
    .collect()
}

/// Writes an error map beside its picture; returns the names within the folder, PNG and EXR.
///
/// # Errors
/// The disk.
pub fn write_map(folder: &Folder, name: &str, map: &ErrorMap) -> Result<(String, String)> {
    let (png, exr) = (format!("{name}-error.png"), format!("{name}-error.exr"));
    write_bytes(&folder.file(&png), &map.png()?)?;
    map.write_exr(&folder.file(&exr))?;
    Ok((png, exr))
}

/// Writes an error map's PNG anew, with other colours; returns it as the report shows it.
///
/// # Errors
/// The disk.
pub fn recolored(folder: &Folder, files: &RowFiles, map: &ErrorMap) -> Result<report::ErrorMap> {
    let png = map.png()?;
    write_bytes(&folder.file(&files.error_png), &png)?;
    Ok(shown(map, png))
}

/// The bytes of a file that was just written.
///
/// # Errors
/// The disk.
pub fn bytes(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|cause| Error::reading(path, "read", &cause))
}

/// An error map as the report shows it; of the colours for what is no difference, those that occur.
fn shown(map: &ErrorMap, png: Vec<u8>) -> report::ErrorMap {
    // Shares are percentages to people, here as in the tables.
    let (times, percent) = match map.quantity {
        Quantity::Color | Quantity::Value => (100.0, "% "),
        Quantity::Depth | Quantity::Normal => (1.0, ""),
    };
    let high = times * map.scale;
    let low = if map.quantity.is_signed() { -high } else { 0.0 };
    let marks = [
        (
            Entry::Nothing,
            ErrorMap::NOTHING_COLOR,
            "nothing there in either",
        ),
        (Entry::Missed, ErrorMap::MISSED_COLOR, "missed"),
        (Entry::Extra, ErrorMap::EXTRA_COLOR, "added"),
    ];
    let marks = marks
        .into_iter()
        .filter(|(entry, _, _)| map.entries.contains(entry));
    report::ErrorMap {
        png,
        label: map.quantity.name().to_owned(),
        unit: format!("{percent}{}", map.quantity.unit()),
        scale: report::Scale {
            stops: map.palette_stops(),
            ..report::Scale::linear(low, high, &[])
        },
        marks: marks
            .map(|(_, color, meaning)| report::Mark {
                color,
                meaning: meaning.to_owned(),
            })
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extent::ImageSize;

    fn map(quantity: Quantity, scale: f64) -> ErrorMap {
        ErrorMap {
            quantity,
            size: ImageSize::new(1, 1).unwrap(),
            entries: vec![Entry::Difference(0.5)],
            scale,
        }
    }

    #[test]
    fn maps_of_one_quantity_get_one_scale() {
        let maps = [0.1, 3.0, 0.2].map(|scale| map(Quantity::Depth, scale));
        let mut maps = maps.to_vec();
        maps.push(map(Quantity::Color, 0.7));
        let scales: Vec<f64> = to_one_scale(maps)
            .unwrap()
            .iter()
            .map(|m| m.scale)
            .collect();
        assert_eq!(scales, [0.2, 0.2, 0.2, 0.7]);
        assert!(to_one_scale(Vec::new()).unwrap().is_empty());
    }

    #[test]
    fn a_map_explains_the_colours_that_occur() {
        let meanings = |entry| {
            let mut map = map(Quantity::Depth, 1.0);
            map.entries = vec![entry];
            let shown = shown(&map, Vec::new());
            let marks = shown.marks.into_iter();
            marks.map(|mark| mark.meaning).collect::<Vec<_>>()
        };
        assert_eq!(meanings(Entry::Missed), ["missed"]);
        assert_eq!(meanings(Entry::Extra), ["added"]);
        assert_eq!(meanings(Entry::Nothing), ["nothing there in either"]);
        assert!(meanings(Entry::Difference(0.0)).is_empty());
    }
}
