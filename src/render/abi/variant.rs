//! The switches that every pass over a volume is built for.

use crate::gpu::Defines;
use crate::octree::{Leaf, Octree};
use crate::scene::{Filter, Sampling, Storage};
use crate::volume::{Volume, VoxelType};

use super::constants::{KernelEnum, constants};
use super::lanes::Lanes;

/// The switches that every pass over a volume is built for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Variant {
    /// The type of the voxels.
    pub voxel: VoxelType,
    /// How the field is made of the voxels.
    pub filter: Filter,
    /// The edge of the octree's leaves.
    pub leaf: Leaf,
    /// Whether there are more voxels than a 32-bit index can count.
    pub wide_index: bool,
    /// Rays that a work-item follows side by side.
    pub lanes: Lanes,
    /// Where the voxels are.
    pub storage: Storage,
}

/// The OpenCL name of a voxel type.
pub fn voxel_cl_name(voxel: VoxelType) -> &'static str {
    match voxel {
        VoxelType::U8 => "uchar",
        VoxelType::U16 => "ushort",
        VoxelType::I16 => "short",
        VoxelType::F32 => "float",
    }
}

impl Variant {
    /// The variant for a volume. Vectors index voxels by 32 bits: larger volumes are cast ray by ray.
    pub fn of(volume: &Volume, octree: &Octree, sampling: &Sampling, lanes: Lanes) -> Self {
        let wide_index = volume.dims().voxels() > u64::from(u32::MAX);
        Self {
            voxel: volume.voxels().voxel_type(),
            filter: sampling.filter,
            leaf: octree.leaf(),
            wide_index,
            lanes: if wide_index { Lanes::ONE } else { lanes },
            storage: sampling.voxels,
        }
    }

    /// The constants of this variant and those common to all.
    pub fn defines(self) -> Defines {
        let defines = Defines::default()
            .with("VOXEL", voxel_cl_name(self.voxel))
            .with("INDEX", if self.wide_index { "ulong" } else { "uint" })
            .with("LEAF", format!("{}u", self.leaf))
            .with("FILTER_LINEAR", u32::from(self.filter == Filter::Linear))
            .with("STORAGE", self.storage.number());
        constants().fold(defines, |defines, (name, number)| {
            defines.with(name, number)
        })
    }
}
