//! What is known of the octree's nodes and of the cells before a ray meets them, on the device: found
//! once per iso value, floor or transfer function, however many frames look at the volume.

use crate::error::Result;
use crate::frame::Wanted;
use crate::gpu::{Buffer, Device};
use crate::octree::Octree;
use crate::scene::{Filter, Picture, Projection, Scene, Traverse, Window};
use crate::volume::Volume;

use super::cells;
use super::classify;
use super::homogeneity::Limit;
use super::medium::Knots;
use super::reach::add_reach;
use super::twins::{stored, stored_with_error};

/// What tells the nodes that matter from those that do not.
#[derive(Debug, Clone, PartialEq)]
pub enum Criterion {
    /// Stored units, and how far that is from the iso value asked for.
    Iso { iso: f32, iso_error: f32 },
    /// Of sign · Φ: what is not above it need not be found.
    Floor { sign: f32, floor: f32 },
    /// Opacity; leaves within the limit are homogeneous.
    Opacity {
        knots: Knots,
        skip: bool,
        limit: Option<Limit>,
    },
}

impl Criterion {
    pub fn of(scene: &Scene, wanted: Wanted, volume: &Volume, octree: &Octree) -> Self {
        let rescale = volume.rescale();
        match &scene.picture {
            Picture::Surface { iso, .. } => {
                let (iso, iso_error) = stored_with_error(rescale, *iso);
                Self::Iso { iso, iso_error }
            }
            Picture::Projection { of, window } => Self::Floor {
                sign: sign(*of),
                floor: floor(*of, *window, wanted, volume, octree),
            },
            Picture::Emission(emission) => Self::Opacity {
                knots: Knots::of(&emission.transfer, volume),
                skip: scene.sampling.skip,
                limit: emission
                    .homogeneity
                    .map(|homogeneity| Limit::new(homogeneity, &emission.transfer, volume)),
            },
        }
    }

    fn classes(&self, octree: &Octree) -> Result<Vec<u8>> {
        match self {
            Self::Iso { iso, iso_error } => classify::by_iso(octree, *iso, *iso_error),
            Self::Floor { sign, floor } => classify::by_floor(octree, *sign, *floor),
            Self::Opacity { knots, skip, limit } => {
                classify::by_opacity(octree, knots, *skip, *limit)
            }
        }
    }

    /// The cells that matter, a bit each; none where nothing is led past them one by one.
    fn cells(&self, volume: &Volume, octree: &Octree, classes: &[u8]) -> Result<Vec<u64>> {
        match self {
            Self::Iso { iso, iso_error } => {
                cells::crossed(volume, octree, classes, *iso, *iso_error)
            }
            Self::Opacity {
                knots, limit: None, ..
            } => cells::absorbing(volume, octree, classes, knots),
            Self::Floor { .. } | Self::Opacity { .. } => Ok(vec![0]),
        }
    }
}

/// +1 looks for maxima, −1 for minima.
pub fn sign(of: Projection) -> f32 {
    if of == Projection::Minimum { -1.0 } else { 1.0 }
}

/// What of sign · Φ a projection need not find, in stored units: what is not above the volume's own end,
/// unless it may be a local maximum that counts; or, where only the picture is wanted, what the window
/// shows as it shows its own end.
pub fn floor(
    of: Projection,
    window: Window,
    wanted: Wanted,
    volume: &Volume,
    octree: &Octree,
) -> f32 {
    let rescale = volume.rescale();
    let [min, max] = octree.ranges()[octree.ranges().len() - 1];
    let picture_alone = !(wanted.value || wanted.depth);
    match of {
        Projection::Maximum if picture_alone => min.max(stored(rescale, window.low())),
        Projection::Minimum if picture_alone => -max.min(stored(rescale, window.high())),
        Projection::Maximum => min,
        Projection::Minimum => -max,
        Projection::LocalMaximum { threshold } if stored(rescale, threshold) > min => min,
        Projection::LocalMaximum { .. } | Projection::Mean => f32::NEG_INFINITY,
    }
}

/// Of one volume, on the device.
pub struct Classified {
    criterion: Criterion,
    traverse: Traverse,
    filter: Filter,
    /// Per octree node its class and, where space is skipped by distance, its reach.
    pub node_class: Buffer<u8>,
    /// A bit per cell that matters, where rays are led past the others together: with the linear filter
    /// and where space is skipped by distance. Else a single word.
    pub cells: Buffer<u64>,
}

impl Classified {
    fn upload(
        device: &Device,
        volume: &Volume,
        octree: &Octree,
        scene: &Scene,
        criterion: Criterion,
    ) -> Result<Self> {
        let (traverse, filter) = (scene.sampling.traverse, scene.sampling.filter);
        let mut classes = criterion.classes(octree)?;
        let cells = if traverse == Traverse::Distance && filter == Filter::Linear {
            criterion.cells(volume, octree, &classes)?
        } else {
            vec![0]
        };
        if traverse == Traverse::Distance {
            add_reach(octree, &mut classes)?;
        }
        Ok(Self {
            criterion,
            traverse,
            filter,
            node_class: Buffer::upload(device, "octree's classes", &classes)?,
            cells: Buffer::upload(device, "cells that matter", &cells)?,
        })
    }

    /// Whether it holds for the scene too.
    fn serves(&self, scene: &Scene, criterion: &Criterion) -> bool {
        self.criterion == *criterion
            && self.traverse == scene.sampling.traverse
            && self.filter == scene.sampling.filter
    }

    fn bytes(&self) -> u64 {
        self.node_class.bytes() + self.cells.bytes()
    }
}

/// What was found for the last few criteria, the latest last: for scenes that take turns, such as those of
/// a benchmark. The latest alone, or as many as together take half of the voxels' memory at most.
#[derive(Default)]
pub struct RecentlyClassified(Vec<Classified>);

impl RecentlyClassified {
    /// What holds for the scene, and whether it had to be found.
    ///
    /// # Errors
    /// The host or the device has no room.
    pub fn of(
        &mut self,
        device: &Device,
        volume: &Volume,
        octree: &Octree,
        scene: &Scene,
        criterion: Criterion,
    ) -> Result<(&Classified, bool)> {
        let there = self.0.iter().position(|one| one.serves(scene, &criterion));
        let latest = match there {
            Some(n) => self.0.remove(n),
            None => Classified::upload(device, volume, octree, scene, criterion)?,
        };
        self.0.push(latest);
        while self.0.len() > 1 && self.bytes() > volume.voxels().bytes().len() as u64 / 2 {
            self.0.remove(0);
        }
        Ok((&self.0[self.0.len() - 1], there.is_none()))
    }

    pub fn forget(&mut self) {
        self.0.clear();
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.0.iter().map(Classified::bytes).sum()
    }
}
