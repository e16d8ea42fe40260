//! A pass: one kernel, its arguments checked by name, type and count when it is built.

use bytemuck::bytes_of;
use ocl::core::{
    self, ArgVal, Event, Kernel, KernelArgInfo, KernelArgInfoResult, KernelInfo, KernelInfoResult,
};

use crate::error::{Error, Result};
use crate::extent::ImageSize;

use super::{AnyBuffer, Buffer, Defines, Device, Element, Image, Timings, device_error, program};

/// One argument of a kernel, as its Rust function means it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameter {
    name: &'static str,
    /// As OpenCL tells it: `float*` for a buffer, `image3d_t` for an image, `RayGrid` for a value.
    type_name: String,
}

/// A buffer that the pass reads.
pub fn input<T: Element>(name: &'static str) -> Parameter {
    input_of(name, T::CL_NAME)
}

/// A buffer that the pass reads, its element type known at run time.
pub fn input_of(name: &'static str, cl_name: &str) -> Parameter {
    Parameter {
        name,
        type_name: format!("{cl_name}*"),
    }
}

/// A buffer that the pass writes.
pub fn output<T: Element>(name: &'static str) -> Parameter {
    input::<T>(name)
}

/// A three-dimensional image that the pass reads.
pub fn image(name: &'static str) -> Parameter {
    Parameter {
        name,
        type_name: IMAGE.to_owned(),
    }
}

/// As OpenCL tells an image's type.
const IMAGE: &str = "image3d_t";

/// A number or struct handed over by value.
pub fn value<T: Element>(name: &'static str) -> Parameter {
    Parameter {
        name,
        type_name: T::CL_NAME.to_owned(),
    }
}

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
        let kernel = program::build(device, &format!("{folder}/{name}.cl"), name, defines)?;
        check(&kernel, name, &signature)?;
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

/// Compares the kernel's own arguments with the signature.
fn check(kernel: &Kernel, name: &str, signature: &[Parameter]) -> Result<()> {
    let KernelInfoResult::NumArgs(count) = core::get_kernel_info(kernel, KernelInfo::NumArgs)
        .map_err(|e| device_error("count a kernel's arguments", &e))?
    else {
        return Err(Error::failed(format!(
            "the pass {name} does not tell its arguments"
        )));
    };
    if count as usize != signature.len() {
        return Err(Error::failed(format!(
            "the pass {name} takes {count} arguments, its Rust function gives {}",
            signature.len()
        )));
    }
    for (index, parameter) in signature.iter().enumerate() {
        let ask = |what| {
            core::get_kernel_arg_info(kernel, index as u32, what, None)
                .map_err(|e| device_error("ask for a kernel's arguments", &e))
        };
        let (KernelArgInfoResult::Name(name_there), KernelArgInfoResult::TypeName(type_there)) =
            (ask(KernelArgInfo::Name)?, ask(KernelArgInfo::TypeName)?)
        else {
            return Err(Error::failed(format!(
                "the pass {name} does not tell its arguments"
            )));
        };
        let type_there = type_there.trim_start_matches("struct ").replace(' ', "");
        if name_there != parameter.name || type_there != parameter.type_name {
            return Err(Error::failed(format!(
                "argument {index} of the pass {name} is '{type_there} {name_there}', its Rust function gives '{} {}'",
                parameter.type_name, parameter.name
            )));
        }
    }
    Ok(())
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
