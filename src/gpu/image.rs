//! Device images: voxels behind the device's texture units.

use std::borrow::Cow;

use ocl::core::{
    self, DeviceInfo as Query, DeviceInfoResult, Event, ImageChannelDataType, ImageChannelOrder,
    ImageDescriptor, ImageFormat, Mem, MemFlags, MemObjectType,
};

use crate::error::{Error, Result};

use super::device::Device;
use super::memory::check_allocation;
use super::status::device_error;

/// The content of a texel. Kernels read all of them as floats: integers as shares of their type's largest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// Unsigned 8-bit integers, read as 0..1.
    Unorm8,
    /// Unsigned 16-bit integers, read as 0..1.
    Unorm16,
    /// Single-precision floats.
    Float,
}

impl Channel {
    /// The size of a texel in bytes.
    pub fn bytes(self) -> usize {
        match self {
            Self::Unorm8 => 1,
            Self::Unorm16 => 2,
            Self::Float => 4,
        }
    }

    fn data_type(self) -> ImageChannelDataType {
        match self {
            Self::Unorm8 => ImageChannelDataType::UnormInt8,
            Self::Unorm16 => ImageChannelDataType::UnormInt16,
            Self::Float => ImageChannelDataType::Float,
        }
    }

    /// The name for errors.
    fn name(self) -> &'static str {
        match self {
            Self::Unorm8 => "8-bit integers",
            Self::Unorm16 => "16-bit integers",
            Self::Float => "floats",
        }
    }
}

/// A three-dimensional image of one channel, for kernels to read.
pub struct Image {
    mem: Mem,
    bytes: usize,
}

impl Image {
    /// Checks that the device can hold an image of so many texels along x, y and z.
    ///
    /// # Errors
    /// The device has no images, none so large, or none of this channel.
    pub fn check(device: &Device, what: &str, size: [usize; 3], channel: Channel) -> Result<()> {
        let name = &device.info().name;
        let refused = |why: String| Err(Error::resource(why));
        let DeviceInfoResult::ImageSupport(true) = query_device(device, Query::ImageSupport)?
        else {
            return refused(format!("the device '{name}' has no images"));
        };
        let max = max_texels(device)?;
        if (0..3).any(|axis| size[axis] > max[axis]) {
            let [nx, ny, nz] = size;
            let [max_x, max_y, max_z] = max;
            return refused(format!(
                "the {what} of {nx}x{ny}x{nz} voxels is larger than an image of the device '{name}', {max_x}x{max_y}x{max_z} at most"
            ));
        }
        let formats = core::get_supported_image_formats(
            device.context(),
            MemFlags::new().read_only(),
            MemObjectType::Image3d,
        )
        .map_err(|e| device_error("list the formats of images", &e))?;
        let fits = |format: &ImageFormat| {
            format.channel_order == ImageChannelOrder::R
                && format.channel_data_type == channel.data_type()
        };
        // Formats that are not known here are not used.
        if !formats.iter().flatten().any(fits) {
            return refused(format!(
                "the device '{name}' has no three-dimensional images of {}",
                channel.name()
            ));
        }
        check_allocation(device, what, bytes(size, channel))
    }

    /// Copies texels to the device, a slice across z after the other, x fastest; `what` names them in
    /// errors.
    ///
    /// # Errors
    /// As [`Image::check`]; the device has no room.
    ///
    /// # Panics
    /// A slice has another number of bytes than its texels.
    pub fn upload<'a>(
        device: &Device,
        what: &str,
        size: [usize; 3],
        channel: Channel,
        slices: impl Iterator<Item = Cow<'a, [u8]>>,
    ) -> Result<Self> {
        Self::check(device, what, size, channel)?;
        let [nx, ny, nz] = size;
        let format = ImageFormat::new(ImageChannelOrder::R, channel.data_type());
        let shape = ImageDescriptor::new(MemObjectType::Image3d, nx, ny, nz, 0, 0, 0, None);
        let bytes = bytes(size, channel);
        // SAFETY: no host memory is handed over.
        let mem = unsafe {
            core::create_image(
                device.context(),
                MemFlags::new().read_only(),
                &format,
                &shape,
                None::<&[u8]>,
                None,
            )
        }
        .map_err(|e| {
            device_error(
                &format!("allocate an image of {bytes} bytes for the {what}"),
                &e,
            )
        })?;
        for (z, slice) in slices.take(nz).enumerate() {
            assert_eq!(slice.len(), nx * ny * channel.bytes(), "slice {z}");
            // SAFETY: blocking, so the slice outlives the copy, and of the region's size.
            unsafe {
                core::enqueue_write_image(
                    device.queue(),
                    &mem,
                    true,
                    [0, 0, z],
                    [nx, ny, 1],
                    0,
                    0,
                    &slice,
                    None::<Event>,
                    None::<&mut Event>,
                )
            }
            .map_err(|e| device_error(&format!("upload the {what}"), &e))?;
        }
        device.count_upload(bytes);
        Ok(Self { mem, bytes })
    }

    /// The bytes of its texels; what the device adds to lay them out is not known.
    pub fn bytes(&self) -> u64 {
        self.bytes as u64
    }

    pub(super) fn mem(&self) -> &Mem {
        &self.mem
    }
}

fn bytes([nx, ny, nz]: [usize; 3], channel: Channel) -> usize {
    nx.saturating_mul(ny)
        .saturating_mul(nz)
        .saturating_mul(channel.bytes())
}

fn query_device(device: &Device, query: Query) -> Result<DeviceInfoResult> {
    core::get_device_info(device.device_id(), query)
        .map_err(|e| device_error("query the device's images", &e))
}

/// The most texels along x, y and z.
fn max_texels(device: &Device) -> Result<[usize; 3]> {
    let mut max = [0; 3];
    let queries = [
        Query::Image3dMaxWidth,
        Query::Image3dMaxHeight,
        Query::Image3dMaxDepth,
    ];
    for (max, query) in max.iter_mut().zip(queries) {
        *max = match query_device(device, query)? {
            DeviceInfoResult::Image3dMaxWidth(n)
            | DeviceInfoResult::Image3dMaxHeight(n)
            | DeviceInfoResult::Image3dMaxDepth(n) => n,
            _ => 0,
        };
    }
    Ok(max)
}
