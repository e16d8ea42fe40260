//! Device buffers that know what they hold.

use std::marker::PhantomData;
use std::ops::Deref;

use ocl::core::{self, Event, Mem, MemFlags};

use crate::error::{Error, Result};
use crate::memory;

use super::device::Device;
use super::element::Element;
use super::status::device_error;

/// Checks that the device gives so many bytes in one piece.
pub(super) fn check_allocation(device: &Device, what: &str, bytes: usize) -> Result<()> {
    let max = device.info().max_allocation_bytes;
    if bytes as u64 <= max {
        return Ok(());
    }
    Err(Error::resource(format!(
        "the {what} needs {bytes} bytes in one piece, the device '{}' allows {max}",
        device.info().name
    ))
    .hint("choose a smaller picture or volume, or another --device"))
}

/// A device buffer whose element type is known at run time only.
pub struct AnyBuffer {
    mem: Mem,
    bytes: usize,
    cl_name: &'static str,
}

impl AnyBuffer {
    fn new(device: &Device, what: &str, bytes: usize, cl_name: &'static str) -> Result<Self> {
        check_allocation(device, what, bytes)?;
        // An empty buffer cannot be made: hold at least one byte.
        // SAFETY: no host memory is handed over.
        let mem = unsafe {
            core::create_buffer(
                device.context(),
                MemFlags::new().read_write(),
                bytes.max(1),
                None::<&[u8]>,
            )
        }
        .map_err(|e| device_error(&format!("allocate {bytes} bytes for the {what}"), &e))?;
        Ok(Self {
            mem,
            bytes,
            cl_name,
        })
    }

    /// Copies bytes of elements of the OpenCL type `cl_name` to the device; `what` names them in
    /// errors.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(
        device: &Device,
        what: &str,
        bytes: &[u8],
        cl_name: &'static str,
    ) -> Result<Self> {
        let buffer = Self::new(device, what, bytes.len(), cl_name)?;
        if !bytes.is_empty() {
            // SAFETY: blocking, so `bytes` outlives the copy.
            unsafe {
                core::enqueue_write_buffer(
                    device.queue(),
                    &buffer.mem,
                    true,
                    0,
                    bytes,
                    None::<Event>,
                    None::<&mut Event>,
                )
            }
            .map_err(|e| device_error(&format!("upload the {what}"), &e))?;
            device.count_upload(bytes.len());
        }
        Ok(buffer)
    }

    /// The size of the buffer in bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes as u64
    }

    pub(super) fn mem(&self) -> &Mem {
        &self.mem
    }

    pub(super) fn cl_name(&self) -> &'static str {
        self.cl_name
    }
}

/// A device buffer of `len` elements.
pub struct Buffer<T> {
    any: AnyBuffer,
    len: usize,
    element: PhantomData<T>,
}

impl<T: Element> Buffer<T> {
    /// Room for `len` elements, not initialised; `what` names it in errors.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(device: &Device, what: &str, len: usize) -> Result<Self> {
        let bytes = len
            .checked_mul(size_of::<T>())
            .ok_or_else(|| Error::resource(format!("the {what} is too large")))?;
        Ok(Self {
            any: AnyBuffer::new(device, what, bytes, T::CL_NAME)?,
            len,
            element: PhantomData,
        })
    }

    /// Copies elements to the device.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, what: &str, elements: &[T]) -> Result<Self> {
        Ok(Self {
            any: AnyBuffer::upload(device, what, bytemuck::cast_slice(elements), T::CL_NAME)?,
            len: elements.len(),
            element: PhantomData,
        })
    }

    /// How many elements it holds.
    pub fn count(&self) -> usize {
        self.len
    }

    /// Waits for what was launched before and copies the elements back.
    ///
    /// # Errors
    /// The device failed; not enough memory.
    pub fn download(&self, device: &Device) -> Result<Vec<T>> {
        let mut elements = memory::filled(self.len, T::zeroed(), "a plane of the picture")?;
        if self.len > 0 {
            let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut elements);
            // SAFETY: blocking, so `bytes` outlives the copy.
            unsafe {
                core::enqueue_read_buffer(
                    device.queue(),
                    self.any.mem(),
                    true,
                    0,
                    bytes,
                    None::<Event>,
                    None::<&mut Event>,
                )
            }
            .map_err(|e| device_error("read a plane back", &e))?;
        }
        Ok(elements)
    }
}

impl<T> Deref for Buffer<T> {
    type Target = AnyBuffer;

    fn deref(&self) -> &AnyBuffer {
        &self.any
    }
}
