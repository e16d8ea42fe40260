//! The values that a projection need not find.

use crate::frame::{Layer, Wanted};
use crate::octree::Octree;
use crate::render::abi::stored;
use crate::scene::{Projection, Window};
use crate::volume::Volume;

/// The values that a projection need not find: those of sign · Φ that are not above a floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Floor {
    /// +1 looks for maxima, −1 for minima.
    pub sign: f32,
    /// The floor of sign · Φ, in stored units.
    pub floor: f32,
}

impl Floor {
    /// The floor of a projection: what is not above the volume's own end, unless it may be a local maximum that counts; or, where only
    /// the picture is wanted, what the window shows as it shows its own end.
    pub fn of(
        of: Projection,
        window: Window,
        wanted: Wanted,
        volume: &Volume,
        octree: &Octree,
    ) -> Self {
        let rescale = volume.rescale();
        let [min, max] = octree.ranges()[octree.ranges().len() - 1];
        let picture_alone = !wanted.has_any([Layer::Value, Layer::Depth]);
        let floor = match of {
            Projection::Maximum if picture_alone => min.max(stored(rescale, window.range().min)),
            Projection::Minimum if picture_alone => -max.min(stored(rescale, window.range().max)),
            Projection::Maximum => min,
            Projection::Minimum => -max,
            Projection::LocalMaximum { threshold } if stored(rescale, threshold) > min => min,
            Projection::LocalMaximum { .. } | Projection::Mean => f32::NEG_INFINITY,
        };
        let sign = if of == Projection::Minimum { -1.0 } else { 1.0 };
        Self { sign, floor }
    }
}
