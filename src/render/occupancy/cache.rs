//! A cache of the occupancies by the last few criteria: found once per iso value, floor or transfer function,
//! however many frames are made of the volume.

use crate::error::Result;
use crate::gpu::Device;
use crate::octree::Octree;
use crate::volume::Volume;

use super::criterion::Criterion;
use super::occupancy_map::{Occupancy, OccupancyTables};

/// The occupancies by the last few criteria, the latest last: for scenes that take turns, such as those of
/// a benchmark. The latest alone, or as many as together take half of the voxels' memory at most.
#[derive(Default)]
pub struct OccupancyCache(Vec<Occupancy>);

impl OccupancyCache {
    /// The occupancy by a criterion with these tables, and whether it had to be computed.
    ///
    /// # Errors
    /// The host or the device has no room.
    pub fn get(
        &mut self,
        device: &Device,
        volume: &Volume,
        octree: &Octree,
        tables: OccupancyTables,
        criterion: Criterion,
    ) -> Result<(&Occupancy, bool)> {
        let known = self.0.iter().position(|one| one.serves(tables, &criterion));
        let latest = match known {
            Some(place) => self.0.remove(place),
            None => Occupancy::upload(device, volume, octree, tables, criterion)?,
        };
        self.0.push(latest);
        while self.0.len() > 1 && self.bytes() > volume.voxels().bytes().len() as u64 / 2 {
            self.0.remove(0);
        }
        Ok((&self.0[self.0.len() - 1], known.is_none()))
    }

    /// Drops everything.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.0.iter().map(Occupancy::bytes).sum()
    }
}
