//! The colour's error in focus and out of it.

use serde::{Serialize, Serializer};

use crate::error::{Error, Result};

use super::pairing::{comparable, displays};
use crate::frame::{COC, DEPTH, Frame};

/// The error of the display planes' colours in parts of the picture, by the reference's depths and circles of confusion: as in
/// [`ColorError`](super::ColorError).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FocusError {
    /// Circles of half a pixel at most.
    pub in_focus: PartError,
    /// Wider circles of what lies before the focal plane.
    pub near: PartError,
    /// Wider circles of what lies behind it.
    pub far: PartError,
    /// Where nothing is seen but through the lens, in either picture.
    pub beside: PartError,
    /// How much more opacity there is near and beside than in the reference, as a share of that: where nothing lies behind what is
    /// near, how much larger its silhouette is. `None` if the reference has none there.
    pub silhouette: Option<f64>,
}

/// The error in a part of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PartError {
    /// Its pixels.
    pub pixels: u64,
    /// The root mean square of their differences; `None` if there are no pixels.
    pub rmse: Option<f64>,
    /// −20 log₁₀ rmse; `None` if there are no pixels, +∞ (`null` in JSON) for equal ones.
    #[serde(serialize_with = "null_if_infinite")]
    pub psnr_db: Option<f64>,
}

impl PartError {
    /// Of the sum of the squared differences of three channels of each pixel.
    fn of(pixels: u64, squares: f64) -> Self {
        let rmse = (pixels > 0).then(|| (squares / (3 * pixels) as f64).sqrt());
        Self {
            pixels,
            rmse,
            psnr_db: rmse.map(|rmse| -20.0 * rmse.log10()),
        }
    }
}

/// A circle of confusion is in focus up to this diameter, pixels.
const FOCUSED_PX: f32 = 0.5;

/// Compares the display planes where the reference's circles of confusion say that something is in focus, or before or behind
/// the focal plane.
///
/// # Errors
/// As [`color_error`](super::color_error); the reference has no circles of confusion, or no depths.
pub fn focus_error(reference: &Frame, frame: &Frame) -> Result<FocusError> {
    comparable(reference, frame)?;
    let (left, right) = displays(reference, frame)?;
    let circles = reference
        .plane(COC)
        .ok_or_else(|| Error::failed("the reference has no circles of confusion to compare by"))?;
    let depths = reference
        .plane(DEPTH)
        .ok_or_else(|| Error::failed("the reference has no depths to compare by"))?;
    let mut parts = [(0, 0.0); 4];
    let mut opacities = [0.0; 2];
    for (pixel, (&circle, &depth)) in circles.iter().zip(depths).enumerate() {
        let is_deep = depth.is_finite();
        let covers = |frame: &Frame| frame.color[pixel][3] > 0.0;
        if is_deep || covers(reference) || covers(frame) {
            let part = if is_deep { part_of(circle) } else { BESIDE };
            let (pixels, squares) = &mut parts[part];
            *pixels += 1;
            if matches!(part, NEAR | BESIDE) {
                for (sum, frame) in opacities.iter_mut().zip([reference, frame]) {
                    *sum += f64::from(frame.color[pixel][3]);
                }
            }
            for channel in 0..3 {
                let difference = f64::from(left[pixel][channel]) - f64::from(right[pixel][channel]);
                *squares += difference * difference;
            }
        }
    }
    let [in_focus, near, far, beside] =
        parts.map(|(pixels, squares)| PartError::of(pixels, squares));
    Ok(FocusError {
        in_focus,
        near,
        far,
        beside,
        silhouette: (opacities[0] > 0.0).then(|| opacities[1] / opacities[0] - 1.0),
    })
}

/// The numbers of the parts.
const IN_FOCUS: usize = 0;
const NEAR: usize = 1;
const FAR: usize = 2;
const BESIDE: usize = 3;

fn part_of(circle_px: f32) -> usize {
    if circle_px.abs() <= FOCUSED_PX {
        IN_FOCUS
    } else if circle_px < 0.0 {
        NEAR
    } else {
        FAR
    }
}

fn null_if_infinite<S: Serializer>(
    figure: &Option<f64>,
    to: S,
) -> std::result::Result<S::Ok, S::Error> {
    figure.filter(|figure| figure.is_finite()).serialize(to)
}
