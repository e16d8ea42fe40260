//! The volume on the device, but for its voxels: its grid and the tables of its octree.

use glam::DVec3;

use crate::error::Result;
use crate::gpu::{Buffer, Device};
use crate::octree::Octree;
use crate::render::abi::{VolumeGrid, covector_scale};
use crate::volume::Volume;

/// The volume on the device, but for its voxels.
pub struct DeviceVolume {
    /// Sizes, and the map of gradients.
    pub grid: VolumeGrid,
    /// The nodes along x, y, z and the first node's offset of each octree level.
    pub levels: Buffer<[u32; 4]>,
    /// The range of values of each octree node.
    pub node_range: Buffer<[f32; 2]>,
}

impl DeviceVolume {
    /// Uploads the octree's tables.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, volume: &Volume, octree: &Octree) -> Result<Self> {
        let levels: Vec<[u32; 4]> = octree
            .levels()
            .iter()
            .map(|level| {
                let [nx, ny, nz] = level.size;
                [nx, ny, nz, level.offset]
            })
            .collect();
        Ok(Self {
            grid: volume_grid(volume, levels.len() as u32),
            levels: Buffer::upload(device, "octree's levels", &levels)?,
            node_range: Buffer::upload(device, "octree's ranges", octree.ranges())?,
        })
    }

    /// Device memory that the tables of an octree take, in bytes.
    pub fn bytes_of(octree: &Octree) -> u64 {
        let levels = octree.levels().len() * size_of::<[u32; 4]>();
        (levels + size_of_val(octree.ranges())) as u64
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.levels.bytes() + self.node_range.bytes()
    }
}

/// The volume as the kernels see it. Gradients map by the inverse transpose; its scale is left
/// out (normals are unit), so that extreme spacings cost no precision.
fn volume_grid(volume: &Volume, levels: u32) -> VolumeGrid {
    let covector_map = volume.geometry().index_from_world().matrix3;
    let scale = covector_scale(volume);
    // world = (index_from_world)ᵀ · index: its rows are the columns of index_from_world.
    let row = |column: DVec3| {
        let [x, y, z] = (column / scale).to_array().map(|c| c as f32);
        [x, y, z, 0.0]
    };
    let [nx, ny, nz] = volume.dims().array();
    VolumeGrid {
        gradient_row_x: row(covector_map.x_axis),
        gradient_row_y: row(covector_map.y_axis),
        gradient_row_z: row(covector_map.z_axis),
        nx,
        ny,
        nz,
        levels,
    }
}
