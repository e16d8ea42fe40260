//! Whether a device is large enough, said before anything is read, built or uploaded.

use crate::error::{Error, Result};
use crate::extent::{Dims, ImageSize};
use crate::frame::{Layer, Wanted};
use crate::gpu::{DeviceInfo, DeviceKind};
use crate::render::resources::DeviceLayers;
use crate::scene::{DofMethod, Occlusion, Scene};
use crate::volume::VoxelType;

use super::planes::ScreenPlanes;

/// Rays that are cast at a time where a pixel has many: their planes take some tens of megabytes.
pub const RAYS_AT_A_TIME: usize = 1 << 20;

/// Checks that a device can hold the voxels of a volume of this size and type, in one piece.
///
/// # Errors
/// It is too small.
pub fn check_volume(device: &DeviceInfo, dims: Dims, voxel: VoxelType) -> Result<()> {
    let bytes = u128::from(dims.voxels()) * voxel.bytes() as u128;
    let max = device.max_allocation_bytes.min(device.memory_bytes);
    if bytes <= u128::from(max) {
        return Ok(());
    }
    Err(Error::resource(format!(
        "{dims} voxels of {} need {bytes} bytes in one piece, the device '{}' gives {max}",
        voxel.name(),
        device.name
    ))
    .hint("choose another --device; '--device reference' needs none"))
}

/// The bytes that a scene's picture takes on the device for marks and lists of pixels, for the planes of the rays that are
/// cast at a time where a pixel has many, and for those that depth of field is made of: the picture that one point of a lens
/// sees, what surfaces hide and the discs of both, or blurred pictures.
pub fn listing_bytes(scene: &Scene) -> u64 {
    /// A mark, and two numbers in the list.
    const LISTED: u64 = 4 + 8;
    /// Colour, normal, t and kind.
    const RAY: u64 = 16 + 16 + 4 + 4;
    let (pixels, rays) = (
        scene.size.pixels() as u64,
        u64::from(scene.anti_aliasing.rays()),
    );
    let of_screen = match scene.ambient_occlusion {
        Some(Occlusion::Screen(_)) => ScreenPlanes::PIXEL_BYTES,
        Some(Occlusion::Volume(_)) | None => 0,
    };
    /// A depth and a circle of confusion.
    const DEEP: u64 = 4 + 4;
    /// A disc, and what it covers.
    const DISC: u64 = 4 + 4;
    /// Light, premultiplied.
    const LIGHT: u64 = 16;
    let of_lens = match (scene.depth_of_field, scene.sampling.dof) {
        (None, _) => 0,
        (Some(_), DofMethod::Gather) => RAY + DEEP + 2 * DISC + LIGHT,
        (Some(_), DofMethod::Mix) => DISC + 2 * LIGHT,
        (Some(_), DofMethod::Lens(_)) => RAY + of_screen,
    };
    let of_lens = pixels * (of_lens + of_screen);
    if rays > 1 {
        return of_lens + pixels * LISTED + RAY * (pixels * rays).min(RAYS_AT_A_TIME as u64);
    }
    of_lens + scene.sparse.map_or(0, |_| pixels * LISTED)
}

/// Checks that a frame of this size fits beside `held_bytes` of volume and octree. Counts the most that a picture
/// with these planes can hold; on a CPU the copies that are read back come out of the same memory.
///
/// # Errors
/// It does not.
pub fn check_picture(
    device: &DeviceInfo,
    size: ImageSize,
    wanted: Wanted,
    held_bytes: u64,
) -> Result<()> {
    const COLOR: u64 = 16;
    const HIT: u64 = 4;
    /// What reaches the hits of each light.
    const REACHED: u64 = 16;
    let display = if wanted.display { COLOR } else { 0 };
    // Layers that are not wanted may be needed to make those that are.
    let layers: u64 = Layer::ALL.map(DeviceLayers::entry_bytes).iter().sum();
    let on_device = COLOR + display + HIT + REACHED + layers;
    let read_back = match device.kind {
        DeviceKind::Cpu => on_device,
        DeviceKind::Gpu | DeviceKind::Accelerator => 0,
    };
    let planes_bytes = size.pixels() as u64 * (on_device + read_back);
    let bytes = planes_bytes.saturating_add(held_bytes);
    if bytes <= device.memory_bytes {
        return Ok(());
    }
    Err(Error::resource(format!(
        "a picture of {size} pixels needs up to {bytes} bytes with its volume, the device '{}' has {}",
        device.name, device.memory_bytes
    ))
    .hint("choose a smaller --size"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    fn device(memory_bytes: u64, max_allocation_bytes: u64) -> DeviceInfo {
        DeviceInfo {
            id: 0,
            name: "small".into(),
            platform: "p".into(),
            driver: "d".into(),
            version: "v".into(),
            kind: DeviceKind::Gpu,
            compute_units: 1,
            memory_bytes,
            max_allocation_bytes,
            max_work_group: 1,
            vector_width: 1,
        }
    }

    #[test]
    fn a_volume_fits_up_to_the_last_byte() {
        let dims = Dims::new([10, 10, 10]).unwrap();
        let check = |device: &DeviceInfo, voxel| check_volume(device, dims, voxel);
        for device in [device(2000, 2000), device(9000, 2000)] {
            assert_eq!(check(&device, VoxelType::I16), Ok(()));
            let refused = check(&device, VoxelType::F32).unwrap_err();
            assert_eq!(refused.kind(), ErrorKind::Resource);
            let message = refused.to_string();
            assert!(
                message.contains("10x10x10") && message.contains("4000 bytes"),
                "{message}"
            );
            assert!(message.contains("'small' gives 2000"), "{message}");
        }
        assert!(check(&device(1999, 2000), VoxelType::I16).is_err());
        assert!(check(&device(2000, 1999), VoxelType::I16).is_err());
        // The largest volume is counted right.
        let huge = Dims::new([Dims::MAX_AXIS, Dims::MAX_AXIS, 256]).unwrap();
        let gives = |bytes| check_volume(&device(bytes, bytes), huge, VoxelType::F32);
        assert!(gives((1 << 42) - 1).is_err());
        assert_eq!(gives(1 << 42), Ok(()));
    }

    #[test]
    fn a_picture_fits_beside_its_volume() {
        let size = ImageSize::new(10, 10).unwrap();
        let of = |memory, held| check_picture(&device(memory, memory), size, Wanted::NONE, held);
        let needs = 100 * (3 * 16 + 13 * 4);
        assert_eq!(of(needs, 0), Ok(()));
        assert_eq!(of(needs + 5, 5), Ok(()));
        assert!(of(needs - 1, 0).is_err() && of(needs, 1).is_err());
        assert!(of(u64::MAX - 1, u64::MAX).is_err());
    }
}
