//! A volume's voxels on the device, in a buffer or an image, as `kernels/lib/volume/voxels.clh` reads them.

use std::borrow::Cow;

use crate::error::{Error, Result};
use crate::gpu::{AnyBuffer, Args, Channel, Device, Group, Image};
use crate::render::abi::voxel_cl_name;
use crate::scene::Storage;
use crate::volume::{Volume, VoxelType};

/// The voxels of a volume on the device, in stored units, x fastest.
pub enum DeviceVoxels {
    /// The voxels in a buffer, in their own type.
    Buffer(AnyBuffer),
    /// The voxels in a three-dimensional image.
    Image(Image),
}

impl DeviceVoxels {
    /// Checks that the device can hold a volume in this storage.
    ///
    /// # Errors
    /// The device has no images, none so large, or none of the voxels' type.
    pub fn check(device: &Device, volume: &Volume, storage: Storage) -> Result<()> {
        match storage {
            Storage::Buffer => Ok(()),
            Storage::Image | Storage::Filtered => {
                Image::check(device, "volume", size(volume), channel(volume)).map_err(hinted)
            }
        }
    }

    /// Uploads the voxels.
    ///
    /// # Errors
    /// The device has no room; as [`DeviceVoxels::check`].
    pub fn upload(device: &Device, volume: &Volume, storage: Storage) -> Result<Self> {
        let voxels = volume.voxels();
        match storage {
            Storage::Buffer => {
                let name = voxel_cl_name(voxels.voxel_type());
                AnyBuffer::upload(device, "volume", voxels.bytes(), name).map(Self::Buffer)
            }
            Storage::Image | Storage::Filtered => {
                let (size, channel) = (size(volume), channel(volume));
                let slice_bytes = size[0] * size[1] * channel.bytes();
                let slices = voxels.bytes().chunks(slice_bytes);
                let slices = slices.map(|slice| match voxels.voxel_type() {
                    VoxelType::I16 => Cow::Owned(offset_to_unsigned(slice)),
                    VoxelType::U8 | VoxelType::U16 | VoxelType::F32 => Cow::Borrowed(slice),
                });
                Image::upload(device, "volume", size, channel, slices)
                    .map(Self::Image)
                    .map_err(hinted)
            }
        }
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Buffer(buffer) => buffer.bytes(),
            Self::Image(image) => image.bytes(),
        }
    }
}

impl Group for &DeviceVoxels {
    fn add_to(self, args: Args) -> Args {
        match self {
            DeviceVoxels::Buffer(buffer) => args.read("voxels", buffer),
            DeviceVoxels::Image(image) => args.image("voxels", image),
        }
    }
}

fn hinted(error: Error) -> Error {
    error.hint("--voxels buffer holds any volume for which there is memory")
}

fn size(volume: &Volume) -> [usize; 3] {
    volume.dims().array().map(|n| n as usize)
}

fn channel(volume: &Volume) -> Channel {
    match volume.voxels().voxel_type() {
        VoxelType::U8 => Channel::Unorm8,
        VoxelType::U16 | VoxelType::I16 => Channel::Unorm16,
        VoxelType::F32 => Channel::Float,
    }
}

/// Signed numbers of 16 bits, each 32768 more: signed texels would hold their smallest twice, as -1 and
/// below.
fn offset_to_unsigned(signed: &[u8]) -> Vec<u8> {
    let numbers = signed.chunks_exact(2);
    numbers
        .flat_map(|bytes| (u16::from_ne_bytes([bytes[0], bytes[1]]) ^ 0x8000).to_ne_bytes())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signed_numbers_are_offset_by_half_their_range() {
        let signed = [i16::MIN, -1, 0, 1, i16::MAX];
        let offset = offset_to_unsigned(bytemuck::cast_slice(&signed));
        let expected = signed.map(|n| (i32::from(n) + 32768) as u16);
        assert_eq!(bytemuck::pod_collect_to_vec::<u8, u16>(&offset), expected);
    }
}
