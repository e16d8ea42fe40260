//! When a leaf's average value may stand for the whole leaf.
//!
//! Let κ and c be the medium's absorption and colour along a ray, κ' and c' those with every
//! homogeneous leaf at its average, F the light that arrives from behind a point of the first, T'
//! what the second lets through before it. The light F − F' lost obeys (F − F')' = κ'(F − F') +
//! (κ − κ')(F − c) − κ'(c − c'), so that at the eye, as F and c lie in 0..1,
//!
//! |F − F'| ≤ ∫ T' (|κ − κ'| + κ' |c − c'|) dt,
//!
//! and with c = c' = 0 and light behind everything the same bounds the opacity. A leaf in which κ
//! and c differ by δκ and δc at most is counted in one of two ways:
//! - by its length l: it adds at most l (δκ + κmax δc). If that is within E/(2L) a millimetre, L the
//!   longest path through the volume, all such leaves of a ray add E/2 at most.
//! - by the light p = ∫ T' κ' that it gives, which over all leaves is 1 at most: as κ' ≥ κmin, it
//!   adds at most p (δκ/κmin + δc). If that is within E/2 for 1, all such leaves add E/2 at most.

use std::borrow::Cow;

use crate::octree::Octree;
use crate::render::resources::unit_absorption;
use crate::scene::{Filter, Homogeneity, HomogeneityRule, TransferFunction};
use crate::volume::Volume;

use super::opacity_ranges::OpacityRanges;

/// The value that stands for each leaf of the octree, in stored units: its average. With the nearest filter the
/// average is no value of the field, which may lie between two labels: there the leaf's smallest or largest
/// value stands for it, whichever is nearer to the average. All that is derived above of the average holds
/// of any value in the leaf's range.
pub fn stand_ins(octree: &Octree, filter: Filter) -> Cow<'_, [f32]> {
    let leaves = octree.levels()[0].nodes();
    let averages = &octree.averages()[..leaves];
    match filter {
        Filter::Linear => Cow::Borrowed(averages),
        Filter::Nearest => {
            let ranges = octree.ranges()[..leaves].iter();
            let nearer = |(&average, &[min, max]): (&f32, &[f32; 2])| {
                if average - min <= max - average {
                    min
                } else {
                    max
                }
            };
            averages.iter().zip(ranges).map(nearer).collect()
        }
    }
}

/// `--homogeneity` for one volume and transfer function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// The bounds above, with E/2 and L in unit lengths.
    Optical { half: f64, longest: f64 },
    /// Maximum − minimum less than this, in stored units (Lesar et al. 2015, §III-E).
    Range { width: f64 },
}

impl Limit {
    /// The limit of a volume and transfer function.
    pub fn new(homogeneity: Homogeneity, transfer: &TransferFunction, volume: &Volume) -> Self {
        let limit = homogeneity.limit.get();
        match homogeneity.rule {
            HomogeneityRule::Optical => Self::Optical {
                half: 0.5 * limit,
                longest: 2.0 * volume.bounding_sphere().1 / transfer.unit_length_mm(),
            },
            HomogeneityRule::Range => Self::Range {
                width: limit * volume.stored_range().width(),
            },
        }
    }

    /// Whether a leaf with this range of values counts as homogeneous.
    pub fn holds(self, ranges: &OpacityRanges, min: f32, max: f32) -> bool {
        match self {
            Self::Range { width } => f64::from(max) - f64::from(min) < width,
            Self::Optical { half, longest } => {
                let [low, high] = ranges.bounds(min, max);
                let min = unit_absorption(low[3].into());
                let max = unit_absorption(high[3].into());
                let differs = max - min;
                let color = (0..3).fold(0.0, |max, c| f64::max(max, (high[c] - low[c]).into()));
                let by_length = (differs + max * color) * longest;
                let by_light = if min > 0.0 {
                    differs / min + color
                } else {
                    f64::INFINITY
                };
                by_length <= half || by_light <= half
            }
        }
    }
}
