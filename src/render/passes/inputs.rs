//! What every cast reads beside its own numbers.

use crate::gpu::Args;
use crate::render::occupancy::Occupancy;
use crate::render::resources::{DeviceClip, DeviceGradient, DeviceVolume};

use super::run::Run;

/// What every cast reads of the scene: the volume, what is known of its nodes and cells, and the clip planes.
#[derive(Clone, Copy)]
pub struct CastInputs<'a> {
    /// The volume, but for its voxels.
    pub volume: &'a DeviceVolume,
    /// What is known of its nodes and cells.
    pub occupancy: &'a Occupancy,
    /// The scene's clip planes.
    pub clip: &'a DeviceClip,
}

impl CastInputs<'_> {
    /// The arguments of a cast that begin its list: voxels, and what can be skipped by classes and bits.
    pub fn by_cells(&self, run: &Run) -> Args {
        Args::new()
            .with(run.voxels)
            .read("node_class", &self.occupancy.node_class)
            .read("levels", &self.volume.levels)
            .read("cells", &self.occupancy.cells)
    }

    /// As [`CastInputs::by_cells`], for casts that skip by the ranges of nodes.
    pub fn by_ranges(&self, run: &Run) -> Args {
        Args::new()
            .with(run.voxels)
            .read("node_class", &self.occupancy.node_class)
            .read("node_range", &self.volume.node_range)
            .read("levels", &self.volume.levels)
    }

    /// Adds the rays and where they see the volume; `gradient` where normals are made use of.
    pub fn along_rays(&self, args: Args, run: &Run, gradient: DeviceGradient) -> Args {
        args.with(self.clip)
            .with(gradient)
            .value("volume", &self.volume.grid)
            .with(&run.rays)
    }
}
