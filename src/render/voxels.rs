//! A volume's voxels on the device, in a buffer or an image: the twin of `kernels/lib/volume/voxels.clh`.

use std::borrow::Cow;

use crate::error::{Error, Result};
use crate::gpu::{AnyBuffer, Channel, Device, Image, Launch, Parameter, image, input_of};
use crate::scene::Storage;
use crate::volume::{Volume, VoxelType};

use super::variant::voxel_cl_name;

/// In stored units, x fastest.
pub enum DeviceVoxels {
    Buffer(AnyBuffer),
    Image(Image),
}

/// Its parameter in a pass's signature.
pub fn parameter(storage: Storage, voxel: VoxelType) -> Parameter {
    match storage {
        Storage::Buffer => input_of("voxels", voxel_cl_name(voxel)),
        Storage::Image | Storage::Filtered => image("voxels"),
    }
}

impl DeviceVoxels {
    /// Whether the device can hold a volume so.
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
                    VoxelType::I16 => Cow::Owned(moved_up(slice)),
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

    pub fn give<'a>(&'a self, launch: Launch<'a>) -> Launch<'a> {
        match self {
            Self::Buffer(buffer) => launch.input(buffer),
            Self::Image(image) => launch.image(image),
        }
    }
}

/// A volume's voxels in all the ways in which pictures have needed them.
#[derive(Default)]
pub struct HeldVoxels {
    buffer: Option<DeviceVoxels>,
    image: Option<DeviceVoxels>,
}

impl HeldVoxels {
    /// The voxels held in one way, uploaded if they were not.
    ///
    /// # Errors
    /// As [`DeviceVoxels::upload`].
    pub fn held(
        &mut self,
        device: &Device,
        volume: &Volume,
        storage: Storage,
    ) -> Result<&DeviceVoxels> {
        let held = match storage {
            Storage::Buffer => &mut self.buffer,
            Storage::Image | Storage::Filtered => &mut self.image,
        };
        Ok(match held {
            Some(there) => there,
            none => none.insert(DeviceVoxels::upload(device, volume, storage)?),
        })
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        let all = [&self.buffer, &self.image];
        all.into_iter().flatten().map(DeviceVoxels::bytes).sum()
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

/// Signed numbers of 16 bits, each 32768 more: signed texels would hold their least twice, as -1 and
/// below.
fn moved_up(signed: &[u8]) -> Vec<u8> {
    let numbers = signed.chunks_exact(2);
    numbers
        .flat_map(|bytes| (u16::from_ne_bytes([bytes[0], bytes[1]]) ^ 0x8000).to_ne_bytes())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signed_numbers_move_up_by_half_their_range() {
        let signed = [i16::MIN, -1, 0, 1, i16::MAX];
        let moved = moved_up(bytemuck::cast_slice(&signed));
        let expected = signed.map(|n| (i32::from(n) + 32768) as u16);
        assert_eq!(bytemuck::pod_collect_to_vec::<u8, u16>(&moved), expected);
    }
}
