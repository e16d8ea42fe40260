//! The criterion by which nodes and cells matter for a picture: the numbers that its cast uses too.

use crate::error::Result;
use crate::frame::Wanted;
use crate::octree::Octree;
use crate::render::abi::StoredIso;
use crate::render::resources::{Knots, unit_absorption};
use crate::scene::{Emission, Picture, Scene};
use crate::volume::Volume;

use super::floor::Floor;
use super::homogeneity::Limit;
use super::opacity_ranges::OpacityRanges;
use super::{cells, classes};

/// The criterion by which nodes and cells matter. It owns its numbers: casts read them here.
#[derive(Debug, Clone, PartialEq)]
pub enum Criterion {
    /// A surface's iso value.
    Iso(StoredIso),
    /// The values that a projection need not find.
    Floor(Floor),
    /// The opacity of an emission.
    Opacity(Opacity),
}

/// The criterion of an emission: what absorbs, and which leaves count as homogeneous.
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

    /// The cells that matter, a bit each; a single word where none are skipped one by one.
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

impl Opacity {
    fn of(emission: &Emission, skip: bool, volume: &Volume) -> Self {
        let limit = |homogeneity| Limit::new(homogeneity, &emission.transfer, volume);
        Self {
            knots: Knots::of(&emission.transfer, volume),
            skip,
            limit: emission.homogeneity.map(limit),
        }
    }

    /// Per leaf the smallest and then the greatest red, green and blue, linear light, and absorption of the unit length, of
    /// all values between its smallest and its greatest.
    pub(super) fn light_of_leaves(&self, octree: &Octree) -> Vec<[f32; 4]> {
        let ranges = OpacityRanges::new(&self.knots);
        let leaves = octree.levels()[0].nodes();
        let light = |&[min, max]: &[f32; 2]| {
            let absorbing = |[r, g, b, opacity]: [f32; 4]| {
                let absorption = unit_absorption(opacity.into());
                [r, g, b, absorption as f32]
            };
            ranges.bounds(min, max).map(absorbing)
        };
        octree.ranges()[..leaves].iter().flat_map(light).collect()
    }
}
