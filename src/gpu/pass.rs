//! A pass: one kernel, its arguments checked by name, type and count when it is built.

use bytemuck::bytes_of;
use ocl::core::{self, ArgVal, Event, Kernel};

use crate::error::{Error, Result};
use crate::extent::ImageSize;

use super::signature::{IMAGE, Parameter};
use super::{AnyBuffer, Buffer, Defines, Device, Element, Image, Timings, device_error, program};

/// A built kernel and its signature.
pub struct Pass {
    name: &'static str,
    kernel: Kernel,
    signature: Vec<Parameter>,
    /// Pixels along x and y that one work-item takes.
    tile: [usize; 2],
}

impl Pass {
    /// Builds the kernel `name` of `kernels/<folder>/<name>.cl` and holds it against `signature`.
    ///
    /// # Errors
    /// It does not build, or its arguments are not those of the signature.
    pub fn build(
        device: &Device,
        folder: &str,
        name: &'static str,
        defines: &Defines,
        signature: Vec<Parameter>,
    ) -> Result<Self> {
        let path = format!("{folder}/{name}.cl");
        let kernel = program::build(device, &path, name, defines, &signature)?;
        Ok(Self {
            name,
            kernel,
            signature,
            tile: [1, 1],
        })
    }

    /// One work-item for a tile of pixels along x and y.
    #[must_use]
    pub fn with_tile(mut self, tile: [usize; 2]) -> Self {
        self.tile = tile;
        self
    }

    /// Starts a list of arguments, in the signature's order.
    pub fn launch<'a>(&'a self, device: &'a Device) -> Launch<'a> {
        Launch {
            pass: self,
            device,
            given: 0,
            failed: None,
        }
    }
}

/// Arguments being given to a pass; [`Launch::run`] starts it.
#[must_use]
pub struct Launch<'a> {
    pass: &'a Pass,
    device: &'a Device,
    given: usize,
    failed: Option<Error>,
}

impl<'a> Launch<'a> {
    /// The buffer is borrowed until the launch is made: OpenCL does not keep it alive.
    pub fn input(self, buffer: &'a AnyBuffer) -> Self {
        let type_name = format!("{}*", buffer.cl_name());
        self.give(&type_name, ArgVal::mem(buffer.mem()))
    }

    /// As [`Launch::input`], for a buffer that the pass writes.
    pub fn output<T: Element>(self, buffer: &'a mut Buffer<T>) -> Self {
        self.input(buffer)
    }

    /// As [`Launch::input`], for an image.
    pub fn image(self, image: &'a Image) -> Self {
        self.give(IMAGE, ArgVal::mem(image.mem()))
    }

    pub fn value<T: Element>(self, value: &T) -> Self {
        let bytes = bytes_of(value);
        // SAFETY: the pointer and size are those of `value`, which OpenCL copies in this call.
        let arg = unsafe { ArgVal::from_raw(bytes.len(), bytes.as_ptr().cast(), false) };
        self.give(T::CL_NAME, arg)
    }

    fn give(mut self, type_name: &str, arg: ArgVal) -> Self {
        if self.failed.is_some() {
            return self;
        }
        let name = self.pass.name;
        match self.pass.signature.get(self.given) {
            Some(parameter) if parameter.type_name == type_name => {
                self.failed = core::set_kernel_arg(&self.pass.kernel, self.given as u32, arg)
                    .err()
                    .map(|e| {
                        device_error(&format!("set '{}' of the pass {name}", parameter.name), &e)
                    });
            }
            Some(parameter) => {
                self.failed = Some(Error::failed(format!(
                    "the pass {name} wants '{} {}' and was given '{type_name}'",
                    parameter.type_name, parameter.name
                )));
            }
            None => {
                self.failed = Some(Error::failed(format!(
                    "too many arguments for the pass {name}"
                )))
            }
        }
        self.given += 1;
        self
    }

    /// Launches a work-item per tile of pixels, in groups of `work_group` work-items along x and y,
    /// and records the event.
    ///
    /// # Errors
    /// An argument was wrong or missing, or the device refused the launch.
    pub fn run(
        self,
        size: ImageSize,
        work_group: Option<[usize; 2]>,
        timings: &mut Timings,
    ) -> Result<()> {
        let name = self.pass.name;
        if let Some(error) = self.failed {
            return Err(error);
        }
        if self.given != self.pass.signature.len() {
            return Err(Error::failed(format!(
                "the pass {name} takes {} arguments and was given {}",
                self.pass.signature.len(),
                self.given
            )));
        }
        let [tile_x, tile_y] = self.pass.tile;
        let [group_x, group_y] =
            work_group.unwrap_or_else(|| own_choice(self.device, self.pass.tile));
        let global = [
            (size.width() as usize)
                .div_ceil(tile_x)
                .next_multiple_of(group_x),
            (size.height() as usize)
                .div_ceil(tile_y)
                .next_multiple_of(group_y),
            1,
        ];
        let mut event = Event::null();
        // SAFETY: arguments are set and typed; kernels check their pixel against the image's size.
        unsafe {
            core::enqueue_kernel(
                self.device.queue(),
                &self.pass.kernel,
                2,
                None,
                &global,
                Some([group_x, group_y, 1]),
                None::<Event>,
                Some(&mut event),
            )
        }
        .map_err(|e| device_error(&format!("launch the pass {name}"), &e))?;
        timings.record(name, event);
        Ok(())
    }
}

/// Pixels along x and y of a group: small square tiles keep neighbouring rays, and the voxels that they
/// read, together.
const GROUP_PIXELS: [usize; 2] = [8, 8];

/// Work-items of a group, each taking a `tile` of pixels; single ones where the device takes fewer.
fn own_choice(device: &Device, tile: [usize; 2]) -> [usize; 2] {
    let group = [0, 1].map(|axis| (GROUP_PIXELS[axis] / tile[axis]).max(1));
    if group[0] * group[1] <= device.info().max_work_group {
        group
    } else {
        [1, 1]
    }
}
