//! The parts of a volume that are on the device: uploaded when a picture first needs them, and held.

use crate::error::Result;
use crate::gpu::Device;
use crate::octree::Octree;
use crate::scene::Storage;
use crate::volume::Volume;

use super::volume::DeviceVolume;
use super::voxels::DeviceVoxels;

/// The parts of a volume that are on the device: its octree's tables, and its voxels in each kind of storage that
/// pictures have needed.
#[derive(Default)]
pub struct HeldVolume {
    tables: Option<DeviceVolume>,
    buffer: Option<DeviceVoxels>,
    image: Option<DeviceVoxels>,
}

impl HeldVolume {
    /// The octree's tables and the voxels in one kind of storage, uploaded if they were not.
    ///
    /// # Errors
    /// As [`DeviceVoxels::upload`].
    pub fn upload(
        &mut self,
        device: &Device,
        volume: &Volume,
        octree: &Octree,
        storage: Storage,
    ) -> Result<(&DeviceVolume, &DeviceVoxels)> {
        let tables = match &mut self.tables {
            Some(there) => there,
            none => none.insert(DeviceVolume::upload(device, volume, octree)?),
        };
        let voxels = match storage {
            Storage::Buffer => &mut self.buffer,
            Storage::Image | Storage::Filtered => &mut self.image,
        };
        let voxels = match voxels {
            Some(there) => there,
            none => none.insert(DeviceVoxels::upload(device, volume, storage)?),
        };
        Ok((tables, voxels))
    }

    /// Device memory that a volume takes at least, uploaded or not, in bytes.
    pub fn min_bytes(volume: &Volume, octree: &Octree) -> u64 {
        DeviceVolume::bytes_of(octree) + volume.voxels().bytes().len() as u64
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        let tables = self.tables.as_ref().map_or(0, DeviceVolume::bytes);
        let voxels = [&self.buffer, &self.image];
        tables
            + voxels
                .into_iter()
                .flatten()
                .map(DeviceVoxels::bytes)
                .sum::<u64>()
    }
}
