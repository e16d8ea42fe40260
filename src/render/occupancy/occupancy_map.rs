//! The classes of nodes and the bits of cells, on the device.

use crate::error::Result;
use crate::gpu::{Buffer, Device};
use crate::octree::Octree;
use crate::render::abi::Class;
use crate::scene::{Filter, Sampling, Traverse};
use crate::volume::Volume;

use super::criterion::Criterion;
use super::distance::add_distances;

/// The occupancy of a volume by one criterion, on the device: which nodes and cells matter.
pub struct Occupancy {
    criterion: Criterion,
    traverse: Traverse,
    filter: Filter,
    has_homogeneous: bool,
    /// The class of each octree node and, where space is skipped by distance, its distance.
    pub node_class: Buffer<u8>,
    /// A bit per cell that matters, where ray packets skip the others: with the linear filter
    /// and where space is skipped by distance. Else a single word.
    pub cells: Buffer<u64>,
}

impl Occupancy {
    /// Classifies nodes and cells for rays with this sampling, and uploads the classes.
    ///
    /// # Errors
    /// The host or the device has no room.
    pub fn upload(
        device: &Device,
        volume: &Volume,
        octree: &Octree,
        sampling: &Sampling,
        criterion: Criterion,
    ) -> Result<Self> {
        let (traverse, filter) = (sampling.traverse, sampling.filter);
        let mut classes = criterion.classes(octree)?;
        let has_homogeneous = classes.contains(&(Class::Homogeneous as u8));
        let cells = if traverse == Traverse::Distance && filter == Filter::Linear {
            criterion.cells(volume, octree, &classes)?
        } else {
            vec![0]
        };
        if traverse == Traverse::Distance {
            add_distances(octree, &mut classes)?;
        }
        Ok(Self {
            criterion,
            traverse,
            filter,
            has_homogeneous,
            node_class: Buffer::upload(device, "octree's classes", &classes)?,
            cells: Buffer::upload(device, "cells that matter", &cells)?,
        })
    }

    /// The criterion that nodes and cells were classified by.
    pub fn criterion(&self) -> &Criterion {
        &self.criterion
    }

    /// Whether any leaf is of [`Class::Homogeneous`].
    pub fn has_homogeneous(&self) -> bool {
        self.has_homogeneous
    }

    /// Whether the occupancy also holds for this criterion and sampling.
    pub fn serves(&self, sampling: &Sampling, criterion: &Criterion) -> bool {
        self.criterion == *criterion
            && self.traverse == sampling.traverse
            && self.filter == sampling.filter
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.node_class.bytes() + self.cells.bytes()
    }
}
