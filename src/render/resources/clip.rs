//! The scene's clip planes on the device.

use glam::DAffine3;

use crate::error::Result;
use crate::gpu::{Args, Buffer, Device, Group};
use crate::scene::ClipPlane;

/// Beyond any volume, and far from overflow.
const FARTHEST: f64 = 1e30;

/// Clip planes in index space: each keeps the points where `x·p.x + y·p.y + z·p.z + w ≥ 0`.
pub struct DeviceClip {
    planes: Buffer<[f32; 4]>,
    count: u32,
}

impl DeviceClip {
    /// Uploads clip planes given in world space.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(
        device: &Device,
        planes: &[ClipPlane],
        world_from_index: DAffine3,
    ) -> Result<Self> {
        let in_index = |plane: &ClipPlane| {
            let (n, offset) = plane.in_space(world_from_index);
            let offset = offset.clamp(-FARTHEST, FARTHEST);
            [n.x as f32, n.y as f32, n.z as f32, offset as f32]
        };
        let in_index: Vec<[f32; 4]> = planes.iter().map(in_index).collect();
        Ok(Self {
            planes: Buffer::upload(device, "clip planes", &in_index)?,
            count: in_index.len() as u32,
        })
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.planes.bytes()
    }
}

impl Group for &DeviceClip {
    fn add_to(self, args: Args) -> Args {
        args.read("clip_planes", &self.planes)
            .value("clip_count", &self.count)
    }
}
