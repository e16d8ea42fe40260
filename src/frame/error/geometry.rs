//! The error of a surface: its hits, their depth, their normals.

use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};

use crate::error::Result;

use super::pairing::{both, comparable, finite, positive};
use super::spread::Spread;
use crate::frame::Frame;

/// Hits are pixels of finite depth. `mean`, `p99` and `max` are of the absolute difference over
/// pixels that both hit, in voxels of the smallest spacing. Serialized with both shares.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
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

impl Serialize for DepthError {
    fn serialize<S: Serializer>(&self, to: S) -> std::result::Result<S::Ok, S::Error> {
        let mut fields = to.serialize_struct("DepthError", 9)?;
        fields.serialize_field("reference_hits", &self.reference_hits)?;
        fields.serialize_field("missed", &self.missed)?;
        fields.serialize_field("extra", &self.extra)?;
        fields.serialize_field("missed_share", &self.missed_share())?;
        fields.serialize_field("extra_share", &self.extra_share())?;
        fields.serialize_field("compared", &self.compared)?;
        fields.serialize_field("mean", &self.mean)?;
        fields.serialize_field("p99", &self.p99)?;
        fields.serialize_field("max", &self.max)?;
        fields.end()
    }
}

/// The angle between the normals, in degrees, over pixels where both have one (not 0).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NormalError {
    pub compared: u64,
    pub mean_deg: Option<f64>,
    pub p99_deg: Option<f64>,
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
