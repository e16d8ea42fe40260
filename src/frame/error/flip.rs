//! ꟻLIP: how much a viewer sees who flips between two pictures.

use flip_rs::{DEFAULT_PPD, RgbImage, ldr_flip};

use crate::error::{Error, Result};
use crate::frame::Frame;

use super::pairing::displays;

/// The crate refuses more than 2^34 additions; at [`DEFAULT_PPD`] a pixel takes 602.
const MAX_PIXELS: usize = 28_000_000;

/// The mean over all pixels of ꟻLIP (Andersson et al., "ꟻLIP: A Difference Evaluator for
/// Alternating Images", HPG 2020), 0 (equal) to 1, of the display planes as sRGB, at the authors'
/// default of 67.02 pixels per degree: a screen 0.7 m and 3840 pixels wide, seen from 0.7 m.
/// Channels outside 0..1 are clamped, as in the authors' program. `None` for pictures of more than
/// 28 million pixels.
///
/// # Errors
/// Different sizes, a missing display plane, a channel that is not finite.
pub fn flip(reference: &Frame, frame: &Frame) -> Result<Option<f64>> {
    let (left, right) = displays(reference, frame)?;
    let size = frame.size;
    if size.pixels() > MAX_PIXELS {
        return Ok(None);
    }
    let srgb = |plane: &[[f32; 4]]| {
        let channels = plane.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
        RgbImage::new(size.width() as usize, size.height() as usize, channels)
    };
    let failed = |cause| Error::failed(format!("the pictures have no FLIP: {cause}"));
    let (left, right) = (srgb(left).map_err(failed)?, srgb(right).map_err(failed)?);
    let map = ldr_flip(&left, &right, DEFAULT_PPD).map_err(failed)?;
    // The crate's own mean is summed in f32.
    let sum: f64 = map.pixels().iter().copied().map(f64::from).sum();
    Ok(Some(sum / size.pixels() as f64))
}
