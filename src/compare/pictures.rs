//! The pictures of a comparison and their error maps, as files.

use std::path::Path;
use std::time::Instant;

use crate::error::{Error, Result};
use crate::frame::error::{ErrorMap, Quantity, Scale};
use crate::frame::{self, Encoding, Format, Frame, Layer};
use crate::report;

use super::folder::Folder;
use super::row::RowFiles;

/// Writes a picture as PNG and, with all its planes, as EXR; gives the names within the folder and
/// what writing the PNG took, ms.
///
/// # Errors
/// The disk.
pub fn write(folder: &Folder, name: &str, frame: &Frame) -> Result<(String, String, f64)> {
    let png = format!("{name}.png");
    let began = Instant::now();
    frame::write(&folder.file(&png), frame, &Encoding::new(Format::Png), &[])?;
    let encode_ms = began.elapsed().as_secs_f64() * 1e3;
    let exr = format!("{name}.exr");
    let mut encoding = Encoding::new(Format::Exr);
    encoding.layers = layers_of(frame);
    frame::write(&folder.file(&exr), frame, &encoding, &[])?;
    Ok((png, exr, encode_ms))
}

/// Those whose planes are there.
fn layers_of(frame: &Frame) -> Vec<Layer> {
    let there = [
        (Layer::Depth, frame.depth.is_some()),
        (Layer::Normal, frame.normal.is_some()),
        (Layer::Value, frame.value.is_some()),
        (Layer::Steps, frame.steps.is_some()),
        (Layer::Nodes, frame.nodes.is_some()),
        (Layer::Kind, frame.kind.is_some()),
    ];
    let there = there.into_iter().filter(|(_, is)| *is);
    there.map(|(layer, _)| layer).collect()
}

/// Writes a picture with its error map; gives their names, what writing the PNG took, and the map.
///
/// # Errors
/// The disk; pictures that cannot be compared.
pub fn write_judged(
    folder: &Folder,
    name: &str,
    truth: &Frame,
    frame: &Frame,
    scale: Scale,
) -> Result<(RowFiles, f64, ErrorMap)> {
    let (png, exr, encode_ms) = write(folder, name, frame)?;
    let map = ErrorMap::new(quantity(truth, frame), truth, frame, scale)?;
    let error_png = format!("{name}-error.png");
    let error_exr = format!("{name}-error.exr");
    map.write_png(&folder.file(&error_png))?;
    map.write_exr(&folder.file(&error_exr))?;
    let files = RowFiles {
        png,
        exr,
        error_png,
        error_exr,
    };
    Ok((files, encode_ms, map))
}

/// The bytes of a file that was just written.
///
/// # Errors
/// The disk.
pub fn bytes(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|cause| Error::io(path, "read", &cause))
}

/// What an error map of two pictures shows: where a surface lies or a projection's value, where both
/// tell; else the colour.
fn quantity(truth: &Frame, frame: &Frame) -> Quantity {
    if truth.depth.is_some() && frame.depth.is_some() {
        Quantity::Depth
    } else if truth.value.is_some() && frame.value.is_some() {
        Quantity::Value
    } else {
        Quantity::Color
    }
}

/// An error map as the report shows it.
///
/// # Errors
/// Those of [`ErrorMap::png`].
pub fn shown(map: &ErrorMap) -> Result<report::ErrorMap> {
    let low = if map.quantity.is_signed() {
        -map.scale
    } else {
        0.0
    };
    let mut scale = report::Scale::linear(low, map.scale, &[]);
    scale.stops = map.palette_stops();
    let mark = |color, meaning: &str| report::Mark {
        color,
        meaning: meaning.to_owned(),
    };
    let mut marks = vec![mark(ErrorMap::NOTHING_COLOR, "nothing there in either")];
    if map.quantity != Quantity::Color {
        marks.push(mark(ErrorMap::MISSED_COLOR, "missed"));
        marks.push(mark(ErrorMap::EXTRA_COLOR, "added"));
    }
    Ok(report::ErrorMap {
        png: map.png()?,
        label: map.quantity.name().to_owned(),
        unit: map.quantity.unit().to_owned(),
        scale,
        marks,
    })
}
