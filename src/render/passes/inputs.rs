//! The inputs of every cast beside its own numbers.

use crate::gpu::{Args, Defines, Element};
use crate::render::abi::Jitter;
use crate::render::occupancy::Occupancy;
use crate::render::resources::{DeviceClip, DeviceGradient, DeviceVolume};

use super::run::Run;

/// The inputs of every cast: the volume, its occupancy, and the clip planes; and how samples are shifted where they are
/// at fixed steps.
#[derive(Clone, Copy)]
pub struct CastInputs<'a> {
    /// The volume, but for its voxels.
    pub volume: &'a DeviceVolume,
    /// The volume's nodes and cells that matter.
    pub occupancy: &'a Occupancy,
    /// The scene's clip planes.
    pub clip: &'a DeviceClip,
    /// How the samples of rays are shifted; `None`: they are not.
    pub jitter: Option<Jitter>,
}

impl CastInputs<'_> {
    /// Begins the list of a cast that skips by classes and the bits of cells.
    pub fn by_cells(&self, run: &Run) -> Args {
        self.add_nodes_and_cells(Args::new().with(run.voxels))
    }

    /// Begins the list of a pass that looks at classes and the bits of cells, and at no voxels.
    pub fn nodes_and_cells(&self) -> Args {
        self.add_nodes_and_cells(Args::new())
    }

    fn add_nodes_and_cells(&self, args: Args) -> Args {
        args.read("node_class", &self.occupancy.node_class)
            .read("levels", &self.volume.levels)
            .read("cells", &self.occupancy.cells)
    }

    /// Begins the list of a cast that skips by classes and the ranges of nodes.
    pub fn by_ranges(&self, run: &Run) -> Args {
        Args::new()
            .with(run.voxels)
            .read("node_class", &self.occupancy.node_class)
            .read("node_range", &self.volume.node_range)
            .read("levels", &self.volume.levels)
    }

    /// Adds the switch of a cast at fixed steps.
    pub fn define_steps(&self, defines: Defines) -> Defines {
        defines.with("JITTERED", u32::from(self.jitter.is_some()))
    }

    /// Adds the numbers of a cast at fixed steps, and how samples are shifted where they are.
    pub fn by_steps<T: Element>(&self, args: Args, cast: &T) -> Args {
        let args = args.value("cast", cast);
        match &self.jitter {
            Some(jitter) => args.value("jitter", jitter),
            None => args,
        }
    }

    /// Adds the rays and where they see the volume; `gradient` where normals are made use of.
    pub fn along_rays(&self, args: Args, run: &Run, gradient: DeviceGradient) -> Args {
        self.seen_along_rays(args.with(self.clip), run, gradient)
    }

    /// The same behind the clip planes.
    pub fn seen_along_rays(&self, args: Args, run: &Run, gradient: DeviceGradient) -> Args {
        args.with(gradient)
            .value("volume", &self.volume.grid)
            .with(&run.rays)
    }
}
