//! What decides which nodes and cells matter for a picture: the numbers that its cast uses too.

use crate::error::Result;
use crate::frame::{Layer, Wanted};
use crate::octree::Octree;
use crate::render::abi::{StoredIso, stored};
use crate::render::resources::Knots;
use crate::scene::{Emission, Picture, Projection, Scene, Window};
use crate::volume::Volume;

use super::homogeneity::Limit;
use super::{cells, classes};

/// What decides which nodes and cells matter. It owns the numbers: casts read them here.
#[derive(Debug, Clone, PartialEq)]
pub enum Criterion {
    /// A surface's iso value.
    Iso(StoredIso),
    /// The values that a projection need not find.
    Floor(Floor),
    /// The opacity of an emission.
    Opacity(Opacity),
}

/// The values that a projection need not find: those of sign · Φ that are not above a floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Floor {
    /// +1 looks for maxima, −1 for minima.
    pub sign: f32,
    /// Of sign · Φ, in stored units.
    pub floor: f32,
}

/// What absorbs, and which leaves count as homogeneous.
#[derive(Debug, Clone, PartialEq)]
pub struct Opacity {
    /// The transfer function.
    pub knots: Knots,
    skip: bool,
    /// Leaves within the limit are homogeneous.
    limit: Option<Limit>,
}

impl Criterion {
    /// The criterion of a scene's picture.
    pub fn of(scene: &Scene, wanted: Wanted, volume: &Volume, octree: &Octree) -> Self {
        match &scene.picture {
            Picture::Surface { iso, .. } => Self::Iso(StoredIso::nearest(volume.rescale(), *iso)),
            Picture::Projection { of, window } => {
                Self::Floor(Floor::of(*of, *window, wanted, volume, octree))
            }
            Picture::Emission(emission) => {
                Self::Opacity(Opacity::of(emission, scene.sampling.skip, volume))
            }
        }
    }

    /// The class of every node.
    pub(super) fn classes(&self, octree: &Octree) -> Result<Vec<u8>> {
        match self {
            Self::Iso(iso) => classes::by_iso(octree, *iso),
            Self::Floor(floor) => classes::by_floor(octree, *floor),
            Self::Opacity(of) => classes::by_opacity(octree, &of.knots, of.skip, of.limit),
        }
    }

    /// The cells that matter, a bit each; none where nothing is led past them one by one.
    pub(super) fn cells(
        &self,
        volume: &Volume,
        octree: &Octree,
        classes: &[u8],
    ) -> Result<Vec<u64>> {
        match self {
            Self::Iso(iso) => cells::crossed(volume, octree, classes, *iso),
            Self::Opacity(of) => cells::absorbing(volume, octree, classes, &of.knots),
            Self::Floor(_) => Ok(vec![0]),
        }
    }
}

impl Floor {
    /// What is not above the volume's own end, unless it may be a local maximum that counts; or, where only
    /// the picture is wanted, what the window shows as it shows its own end.
    fn of(
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

impl Opacity {
    fn of(emission: &Emission, skip: bool, volume: &Volume) -> Self {
        let limit = |homogeneity| Limit::new(homogeneity, &emission.transfer, volume);
        Self {
            knots: Knots::of(&emission.transfer, volume),
            skip,
            limit: emission.homogeneity.map(limit),
        }
    }
}
