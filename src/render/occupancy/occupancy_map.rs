//! The classes of nodes and the bits of cells, on the device.

use crate::error::Result;
use crate::frame::{Layer, Wanted};
use crate::gpu::{Buffer, Device};
use crate::octree::Octree;
use crate::render::abi::Class;
use crate::scene::{Filter, Refill, Sampling, Scene, ShadowMethod, Shadows, Sparse, Traverse};
use crate::volume::Volume;

use super::criterion::Criterion;
use super::distance::add_distances;

/// What passes ask an occupancy for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OccupancyTables {
    filter: Filter,
    /// The distances of leaves.
    with_distances: bool,
    /// The bits of cells.
    with_cells: bool,
    /// The bounds of leaves' light.
    with_light: bool,
}

impl OccupancyTables {
    /// What casts with this sampling ask for.
    pub fn of(sampling: &Sampling) -> Self {
        let with_distances = sampling.traverse == Traverse::Distance;
        Self {
            filter: sampling.filter,
            with_distances,
            with_cells: with_distances && sampling.filter == Filter::Linear,
            with_light: false,
        }
    }

    /// What a scene asks for: its casts, and what does by cells whatever those do: where pixels are left out or have many rays
    /// the tests of what they may show, of a medium by the light of leaves too, and rays that leave a point.
    pub fn of_scene(scene: &Scene, wanted: Wanted) -> Self {
        let is_certified = |sparse: Sparse| sparse.refill == Refill::Certified;
        let certified = scene.sparse.is_some_and(is_certified);
        let of_casts = Self::of(&scene.sampling);
        let leaves = scene.ambient_occlusion.is_some()
            || scene.shadows.is_some()
            || wanted.has(Layer::Thick);
        let by_cells = certified || scene.anti_aliasing.is_adaptive() || leaves;
        let is_cached = |shadows: Shadows| matches!(shadows.method, ShadowMethod::Cached(_));
        let caches = scene.shadows.is_some_and(is_cached);
        Self {
            with_cells: of_casts.with_cells || by_cells,
            with_light: certified || caches,
            ..of_casts
        }
    }
}

/// The occupancy of a volume by one criterion, on the device: which nodes and cells matter.
pub struct Occupancy {
    criterion: Criterion,
    tables: OccupancyTables,
    has_homogeneous: bool,
    /// The class of each octree node and, where space is skipped by distance, its distance.
    pub node_class: Buffer<u8>,
    /// A bit per cell that matters, where frustums skip the others. Else a single word.
    pub cells: Buffer<u64>,
    /// Per leaf the smallest and then the greatest red, green and blue, linear light, and absorption of the unit length;
    /// where it is certified what blocks of pixels show of a medium.
    pub leaf_light: Option<Buffer<[f32; 4]>>,
}

impl Occupancy {
    /// Classifies nodes and cells, and uploads the tables.
    ///
    /// # Errors
    /// The host or the device has no room.
    pub fn upload(
        device: &Device,
        volume: &Volume,
        octree: &Octree,
        tables: OccupancyTables,
        criterion: Criterion,
    ) -> Result<Self> {
        let mut classes = criterion.classes(octree)?;
        let has_homogeneous = classes.contains(&(Class::Homogeneous as u8));
        let cells = if tables.with_cells {
            criterion.cells(volume, octree, &classes)?
        } else {
            vec![0]
        };
        let leaf_light = match &criterion {
            Criterion::Opacity(of) if tables.with_light => Some(of.light_of_leaves(octree)),
            _ => None,
        };
        if tables.with_distances {
            add_distances(octree, &mut classes)?;
        }
        Ok(Self {
            criterion,
            tables,
            has_homogeneous,
            node_class: Buffer::upload(device, "octree's classes", &classes)?,
            cells: Buffer::upload(device, "cells that matter", &cells)?,
            leaf_light: leaf_light
                .map(|light| Buffer::upload(device, "bounds of leaves' light", &light))
                .transpose()?,
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

    /// Whether the occupancy has these tables by this criterion.
    pub fn serves(&self, tables: OccupancyTables, criterion: &Criterion) -> bool {
        self.criterion == *criterion && self.tables == tables
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        let light = self.leaf_light.as_ref().map_or(0, |light| light.bytes());
        self.node_class.bytes() + self.cells.bytes() + light
    }
}
