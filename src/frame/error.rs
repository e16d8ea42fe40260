//! The error of a picture against a reference of the same scene and size.
//!
//! All sums are f64; every percentile is by nearest rank ([`super::percentile`]). A pixel of which
//! only one picture has something to compare is counted, never averaged away; where nothing is
//! left to compare the figures are `None`.

use serde::Serialize;

use crate::error::{Error, Result};
use crate::extent::ImageSize;

use super::{Frame, percentile};

/// Over the sRGB-encoded R, G and B of all pixels, in 0..1, before rounding to a file's levels:
/// three differences a pixel, each of them one entry.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ColorError {
    pub rmse: f64,
    pub max: f64,
    pub p99: f64,
    /// −20 log₁₀ rmse: the peak is 1. +∞ for equal pictures.
    pub psnr_db: f64,
}

/// Hits are pixels of finite depth. `mean`, `p99` and `max` are of the absolute difference over
/// pixels that both hit, in voxels of the smallest spacing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DepthError {
    pub reference_hits: u64,
    /// Pixels that only the reference hits.
    pub missed: u64,
    /// Pixels that only the other picture hits.
    pub extra: u64,
    /// Pixels that both hit.
    pub compared: u64,
    pub mean: Option<f64>,
    pub p99: Option<f64>,
    pub max: Option<f64>,
}

impl DepthError {
    /// Missed hits as a share of the reference's.
    pub fn missed_share(&self) -> Option<f64> {
        self.share_of_hits(self.missed)
    }

    /// Extra hits as a share of the reference's hits.
    pub fn extra_share(&self) -> Option<f64> {
        self.share_of_hits(self.extra)
    }

    fn share_of_hits(&self, pixels: u64) -> Option<f64> {
        (self.reference_hits > 0).then(|| pixels as f64 / self.reference_hits as f64)
    }
}

/// The angle between the normals, in degrees, over pixels where both have one (not 0).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NormalError {
    pub compared: u64,
    pub mean_deg: Option<f64>,
    pub p99_deg: Option<f64>,
}

/// Absolute differences of the value plane over pixels that both cover (colour's alpha > 0), as a
/// share of the volume's value range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ValueError {
    pub compared: u64,
    /// Pixels that only the reference covers.
    pub missed: u64,
    /// Pixels that only the other picture covers.
    pub extra: u64,
    pub mean: Option<f64>,
    pub rmse: Option<f64>,
    pub p99: Option<f64>,
    pub max: Option<f64>,
}

/// Compares the display planes.
///
/// # Errors
/// Different sizes, a missing display plane, a channel that is not finite.
pub fn color_error(reference: &Frame, frame: &Frame) -> Result<ColorError> {
    let size = comparable(reference, frame)?;
    let (left, right) = both(reference, frame, "display", |f| f.display.as_deref())?;
    let mut differences = Vec::with_capacity(3 * size.pixels());
    for (pixel, (a, b)) in left.iter().zip(right).enumerate() {
        for channel in 0..3 {
            let difference = (f64::from(a[channel]) - f64::from(b[channel])).abs();
            differences.push(finite(difference, "display", size, pixel)?);
        }
    }
    // A picture has at least one pixel.
    let spread = Spread::of(&mut differences)
        .ok_or_else(|| Error::failed("a picture without pixels has no error"))?;
    Ok(ColorError {
        rmse: spread.rmse,
        max: spread.max,
        p99: spread.p99,
        psnr_db: -20.0 * spread.rmse.log10(),
    })
}

/// Compares the depth planes; `smallest_spacing_mm` is the volume's smallest voxel spacing.
///
/// # Errors
/// Different sizes, a missing depth plane, a depth that is NaN or −∞, a spacing that is not
/// positive and finite.
pub fn depth_error(
    reference: &Frame,
    frame: &Frame,
    smallest_spacing_mm: f64,
) -> Result<DepthError> {
    let size = comparable(reference, frame)?;
    let unit = positive(smallest_spacing_mm, "voxel spacing")?;
    let (left, right) = both(reference, frame, "depth", |f| f.depth.as_deref())?;
    let mut differences = Vec::new();
    let (mut missed, mut extra) = (0, 0);
    for (pixel, (&a, &b)) in left.iter().zip(right).enumerate() {
        for depth in [a, b] {
            if depth != f32::INFINITY {
                finite(depth.into(), "depth", size, pixel)?;
            }
        }
        match (a.is_finite(), b.is_finite()) {
            (true, true) => differences.push((f64::from(a) - f64::from(b)).abs() / unit),
            (true, false) => missed += 1,
            (false, true) => extra += 1,
            (false, false) => {}
        }
    }
    let compared = differences.len() as u64;
    let spread = Spread::of(&mut differences);
    Ok(DepthError {
        reference_hits: compared + missed,
        missed,
        extra,
        compared,
        mean: spread.map(|s| s.mean),
        p99: spread.map(|s| s.p99),
        max: spread.map(|s| s.max),
    })
}

/// Compares the normal planes.
///
/// # Errors
/// Different sizes, a missing normal plane, a normal that is not finite.
pub fn normal_error(reference: &Frame, frame: &Frame) -> Result<NormalError> {
    let size = comparable(reference, frame)?;
    let (left, right) = both(reference, frame, "normal", |f| f.normal.as_deref())?;
    let mut angles = Vec::new();
    for (pixel, (a, b)) in left.iter().zip(right).enumerate() {
        let (a, b) = (a.map(f64::from), b.map(f64::from));
        for component in a.into_iter().chain(b) {
            finite(component, "normal", size, pixel)?;
        }
        if a != [0.0; 3] && b != [0.0; 3] {
            angles.push(angle_deg(a, b));
        }
    }
    let spread = Spread::of(&mut angles);
    Ok(NormalError {
        compared: angles.len() as u64,
        mean_deg: spread.map(|s| s.mean),
        p99_deg: spread.map(|s| s.p99),
    })
}

/// Compares the value planes; `range_width` is the volume's largest minus its smallest value.
///
/// # Errors
/// Different sizes, a missing value plane, a value that is not finite, a range width that is not
/// positive and finite.
pub fn value_error(reference: &Frame, frame: &Frame, range_width: f64) -> Result<ValueError> {
    let size = comparable(reference, frame)?;
    let unit = positive(range_width, "width of the value range")?;
    let (left, right) = both(reference, frame, "value", |f| f.value.as_deref())?;
    let covers = |frame: &Frame, pixel: usize| frame.color[pixel][3] > 0.0;
    let mut differences = Vec::new();
    let (mut missed, mut extra) = (0, 0);
    for (pixel, (&a, &b)) in left.iter().zip(right).enumerate() {
        let difference = finite((f64::from(a) - f64::from(b)).abs(), "value", size, pixel)?;
        match (covers(reference, pixel), covers(frame, pixel)) {
            (true, true) => differences.push(difference / unit),
            (true, false) => missed += 1,
            (false, true) => extra += 1,
            (false, false) => {}
        }
    }
    let spread = Spread::of(&mut differences);
    Ok(ValueError {
        compared: differences.len() as u64,
        missed,
        extra,
        mean: spread.map(|s| s.mean),
        rmse: spread.map(|s| s.rmse),
        p99: spread.map(|s| s.p99),
        max: spread.map(|s| s.max),
    })
}

/// Statistics of finite entries that are not negative.
#[derive(Clone, Copy)]
struct Spread {
    mean: f64,
    rmse: f64,
    p99: f64,
    max: f64,
}

impl Spread {
    fn of(entries: &mut [f64]) -> Option<Self> {
        let p99 = percentile(entries, 99)?;
        let count = entries.len() as f64;
        Some(Self {
            mean: entries.iter().sum::<f64>() / count,
            rmse: (entries.iter().map(|e| e * e).sum::<f64>() / count).sqrt(),
            p99,
            max: entries.iter().copied().fold(0.0, f64::max),
        })
    }
}

fn comparable(reference: &Frame, frame: &Frame) -> Result<ImageSize> {
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

fn both<'a, T>(
    reference: &'a Frame,
    frame: &'a Frame,
    name: &str,
    plane: impl Fn(&'a Frame) -> Option<&'a [T]>,
) -> Result<(&'a [T], &'a [T])> {
    let of = |who: &str, f| {
        plane(f).ok_or_else(|| Error::failed(format!("{who} has no {name} plane to compare")))
    };
    Ok((of("the reference", reference)?, of("the picture", frame)?))
}

fn finite(v: f64, name: &str, size: ImageSize, pixel: usize) -> Result<f64> {
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

fn positive(v: f64, name: &str) -> Result<f64> {
    if v > 0.0 && v.is_finite() {
        Ok(v)
    } else {
        Err(Error::failed(format!(
            "an error cannot be expressed in units of a {name} of {v}"
        )))
    }
}

/// From sine and cosine together: exact for small angles, where the arc cosine alone is not.
/// Lengths may differ from 1.
fn angle_deg(a: [f64; 3], b: [f64; 3]) -> f64 {
    let cross = [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ];
    let length = cross.iter().map(|c| c * c).sum::<f64>().sqrt();
    let dot: f64 = a.iter().zip(b).map(|(x, y)| x * y).sum();
    length.atan2(dot).to_degrees()
}
