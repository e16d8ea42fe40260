//! Two pictures as pairs of entries.

use crate::error::{Error, Result};
use crate::extent::ImageSize;

use crate::frame::Frame;

/// A plane of the reference and the same plane of the other picture.
pub(super) type Pair<'a, T> = (&'a [T], &'a [T]);

/// The size of both.
pub(super) fn comparable(reference: &Frame, frame: &Frame) -> Result<ImageSize> {
    reference.check()?;
    frame.check()?;
    if reference.size != frame.size {
        return Err(Error::failed(format!(
            "a picture of {} cannot be compared with a reference of {}",
            frame.size, reference.size
        )));
    }
    Ok(frame.size)
}

/// The plane of both, `name` being its name in a complaint.
pub(super) fn both<'a, T>(
    reference: &'a Frame,
    frame: &'a Frame,
    name: &str,
    plane: impl Fn(&'a Frame) -> Option<&'a [T]>,
) -> Result<Pair<'a, T>> {
    let of = |who: &str, f| {
        plane(f).ok_or_else(|| Error::failed(format!("{who} has no {name} plane to compare")))
    };
    Ok((of("the reference", reference)?, of("the picture", frame)?))
}

/// The display planes of both, whose R, G and B are all finite.
pub(super) fn displays<'a>(reference: &'a Frame, frame: &'a Frame) -> Result<Pair<'a, [f32; 4]>> {
    let size = comparable(reference, frame)?;
    let (left, right) = both(reference, frame, "display", |f| f.display.as_deref())?;
    for (pixel, (a, b)) in left.iter().zip(right).enumerate() {
        for channel in 0..3 {
            let pair = f64::from(a[channel]) + f64::from(b[channel]);
            finite(pair, "display", size, pixel)?;
        }
    }
    Ok((left, right))
}

/// `v`, unless it is not finite: then the pixel is named.
pub(super) fn finite(v: f64, name: &str, size: ImageSize, pixel: usize) -> Result<f64> {
    if v.is_finite() {
        return Ok(v);
    }
    let width = size.width() as usize;
    Err(Error::failed(format!(
        "the {name} planes cannot be compared: pixel {},{} is not finite",
        pixel % width,
        pixel / width
    )))
}

/// `v` as a unit to measure in.
pub(super) fn positive(v: f64, name: &str) -> Result<f64> {
    if v > 0.0 && v.is_finite() {
        Ok(v)
    } else {
        Err(Error::failed(format!(
            "an error cannot be expressed in units of a {name} of {v}"
        )))
    }
}
