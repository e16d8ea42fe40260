//! The error of a surface: its hits, their depth, their normals.

use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};

use crate::error::Result;

use super::entry::{Entry, Tally};
use super::pairing::{both, comparable, finite, positive};
use crate::frame::{DEPTH, Frame, NORMAL};

/// Hits are pixels of finite depth. `mean`, `p99` and `max` are of the absolute difference over
/// pixels that both hit, in voxels of the smallest spacing. Serialized with both shares.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct DepthError {
    /// Pixels that the reference hits.
    pub reference_hits: u64,
    /// Pixels that only the reference hits.
    pub missed: u64,
    /// Pixels that only the other picture hits.
    pub extra: u64,
    /// Pixels that both hit.
    pub compared: u64,
    /// The mean difference of the depths, voxels; `None` if no pixel was compared.
    pub mean: Option<f64>,
    /// The 99th percentile of the differences, voxels; `None` if no pixel was compared.
    pub p99: Option<f64>,
    /// The largest difference, voxels; `None` if no pixel was compared.
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

    /// Missed and extra hits together as a share of the reference's hits.
    pub fn wrong_share(&self) -> Option<f64> {
        self.share_of_hits(self.missed + self.extra)
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
    /// Pixels where both have a normal.
    pub compared: u64,
    /// The mean angle, degrees; `None` if no pixel was compared.
    pub mean_deg: Option<f64>,
    /// The 99th percentile of the angles, degrees; `None` if no pixel was compared.
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
    let tally = Tally::of(&depth_entries(reference, frame, smallest_spacing_mm)?);
    Ok(DepthError {
        reference_hits: tally.compared + tally.missed,
        missed: tally.missed,
        extra: tally.extra,
        compared: tally.compared,
        mean: tally.spread.map(|s| s.mean),
        p99: tally.spread.map(|s| s.p99),
        max: tally.spread.map(|s| s.max),
    })
}

/// How much farther the picture's surface is, in voxels.
pub(super) fn depth_entries(
    reference: &Frame,
    frame: &Frame,
    smallest_spacing_mm: f64,
) -> Result<Vec<Entry>> {
    let size = comparable(reference, frame)?;
    let unit = positive(smallest_spacing_mm, "voxel spacing")?;
    let (left, right) = both(reference, frame, "depth", |f| f.plane(DEPTH))?;
    let entry = |(pixel, (&a, &b)): (usize, (&f32, &f32))| {
        for depth in [a, b] {
            if depth != f32::INFINITY {
                finite(depth.into(), "depth", size, pixel)?;
            }
        }
        Entry::of(a.is_finite(), b.is_finite(), || {
            let voxels = (f64::from(b) - f64::from(a)) / unit;
            finite(voxels, "depth", size, pixel)
        })
    };
    left.iter().zip(right).enumerate().map(entry).collect()
}

/// Compares the normal planes.
///
/// # Errors
/// Different sizes, a missing normal plane, a normal that is not finite.
pub fn normal_error(reference: &Frame, frame: &Frame) -> Result<NormalError> {
    let tally = Tally::of(&normal_entries(reference, frame)?);
    Ok(NormalError {
        compared: tally.compared,
        mean_deg: tally.spread.map(|s| s.mean),
        p99_deg: tally.spread.map(|s| s.p99),
    })
}

/// The angles between the normals, in degrees.
pub(super) fn normal_entries(reference: &Frame, frame: &Frame) -> Result<Vec<Entry>> {
    let size = comparable(reference, frame)?;
    let (left, right) = both(reference, frame, "normal", |f| f.plane(NORMAL))?;
    let entry = |(pixel, (a, b)): (usize, (&[f32; 3], &[f32; 3]))| {
        let (a, b) = (a.map(f64::from), b.map(f64::from));
        for component in a.into_iter().chain(b) {
            finite(component, "normal", size, pixel)?;
        }
        Entry::of(a != [0.0; 3], b != [0.0; 3], || Ok(angle_deg(a, b)))
    };
    left.iter().zip(right).enumerate().map(entry).collect()
}

/// The angle, from sine and cosine together: exact for small angles, where the arc cosine alone is not.
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
