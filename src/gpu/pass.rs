//! A pass: one kernel, its arguments checked by name, type and count when it is built.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bytemuck::bytes_of;
use ocl::core::{self, ArgVal, Event, Kernel, Mem};
use smallvec::SmallVec;

use crate::error::{Error, Result};
use crate::extent::ImageSize;

use super::program::{self, Order};
use super::signature::{IMAGE, Parameter};
use super::{AnyBuffer, Buffer, Defines, Device, Element, Image, Timings, device_error};

/// A kernel and its signature, built when it is first launched, or before.
pub struct Pass {
    folder: &'static str,
    name: &'static str,
    defines: Defines,
    signature: Vec<Parameter>,
    /// Pixels along x and y that one work-item takes.
    tile: [usize; 2],
    kernel: Mutex<Option<Kernel>>,
}

impl Pass {
    /// The kernel `name` of `kernels/<folder>/<name>.cl`, not built yet.
    pub fn new(
        folder: &'static str,
        name: &'static str,
        defines: Defines,
        signature: Vec<Parameter>,
    ) -> Self {
        Self {
            folder,
            name,
            defines,
            signature,
            tile: [1, 1],
            kernel: Mutex::new(None),
        }
    }

    /// One work-item for a tile of pixels along x and y.
    #[must_use]
    pub fn with_tile(mut self, tile: [usize; 2]) -> Self {
        self.tile = tile;
        self
    }

    fn kernel(&self) -> MutexGuard<'_, Option<Kernel>> {
        self.kernel.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Builds those of the passes that are not built yet, and holds them against their signatures. Gives how
    /// many there were.
    ///
    /// # Errors
    /// One does not build, or its arguments are not those of its signature.
    pub(super) fn build_all<'a>(
        device: &Device,
        passes: impl Iterator<Item = &'a Arc<Self>>,
    ) -> Result<usize> {
        let mut missing: Vec<&Arc<Self>> = Vec::new();
        for pass in passes {
            let is_new = missing.iter().all(|other| !Arc::ptr_eq(other, pass));
            if is_new && pass.kernel().is_none() {
                missing.push(pass);
            }
        }
        let count = missing.len();
        let orders: Vec<Order> = missing.iter().map(|pass| pass.order()).collect();
        let kernels = program::build(device, &orders)?;
        for (pass, kernel) in missing.into_iter().zip(kernels) {
            *pass.kernel() = Some(kernel);
        }
        Ok(count)
    }

    /// Builds the pass at once.
    ///
    /// # Errors
    /// It does not build, or its arguments are not those of its signature.
    pub fn built(self, device: &Device) -> Result<Arc<Self>> {
        let pass = Arc::new(self);
        Self::build_all(device, [&pass].into_iter())?;
        Ok(pass)
    }

    fn order(&self) -> Order<'_> {
        Order {
            path: format!("{}/{}.cl", self.folder, self.name),
            name: self.name,
            defines: &self.defines,
            signature: &self.signature,
        }
    }

    /// Starts a list of arguments, in the signature's order.
    pub fn launch<'a>(self: &'a Arc<Self>, device: &'a Device) -> Launch<'a> {
        Launch {
            pass: self,
            device,
            given: Vec::new(),
            failed: None,
        }
    }
}

/// An argument that was given: what a launch needs of it, held for as long as the launch waits.
enum Given {
    Memory(Mem),
    Value(SmallVec<[u8; 64]>),
}

/// Arguments being given to a pass; [`Launch::run`] has it launched.
#[must_use]
pub struct Launch<'a> {
    pass: &'a Arc<Pass>,
    device: &'a Device,
    given: Vec<Given>,
    failed: Option<Error>,
}

impl<'a> Launch<'a> {
    pub fn input(self, buffer: &'a AnyBuffer) -> Self {
        let type_name = format!("{}*", buffer.cl_name());
        self.give(&type_name, Given::Memory(buffer.mem().clone()))
    }

    /// As [`Launch::input`], for a buffer that the pass writes.
    pub fn output<T: Element>(self, buffer: &'a mut Buffer<T>) -> Self {
        self.input(buffer)
    }

    /// As [`Launch::input`], for an image.
    pub fn image(self, image: &'a Image) -> Self {
        self.give(IMAGE, Given::Memory(image.mem().clone()))
    }

    pub fn value<T: Element>(self, value: &T) -> Self {
        self.give(T::CL_NAME, Given::Value(bytes_of(value).into()))
    }

    fn give(mut self, type_name: &str, given: Given) -> Self {
        let name = self.pass.name;
        let wrong = match self.pass.signature.get(self.given.len()) {
            Some(parameter) if parameter.type_name == type_name => None,
            Some(parameter) => Some(format!(
                "the pass {name} wants '{} {}' and was given '{type_name}'",
                parameter.type_name, parameter.name
            )),
            None => Some(format!("too many arguments for the pass {name}")),
        };
        self.failed = self.failed.or(wrong.map(Error::failed));
        self.given.push(given);
        self
    }

    /// Puts a launch of a work-item per tile of pixels, in groups of `work_group` work-items along x and y,
    /// at the end of `timings`.
    ///
    /// # Errors
    /// An argument was wrong or missing.
    pub fn run(
        self,
        size: ImageSize,
        work_group: Option<[usize; 2]>,
        timings: &mut Timings,
    ) -> Result<()> {
        let pass = self.pass;
        if let Some(error) = self.failed {
            return Err(error);
        }
        if self.given.len() != pass.signature.len() {
            return Err(Error::failed(format!(
                "the pass {} takes {} arguments and was given {}",
                pass.name,
                pass.signature.len(),
                self.given.len()
            )));
        }
        let [tile_x, tile_y] = pass.tile;
        let [group_x, group_y] = work_group.unwrap_or_else(|| own_choice(self.device, pass.tile));
        let global = [
            (size.width() as usize)
                .div_ceil(tile_x)
                .next_multiple_of(group_x),
            (size.height() as usize)
                .div_ceil(tile_y)
                .next_multiple_of(group_y),
            1,
        ];
        timings.add(Waiting {
            pass: Arc::clone(pass),
            given: self.given,
            global,
            group: [group_x, group_y, 1],
        });
        Ok(())
    }
}

/// A launch that waits for the passes of its frame to be built.
pub(super) struct Waiting {
    pub pass: Arc<Pass>,
    given: Vec<Given>,
    global: [usize; 3],
    group: [usize; 3],
}

impl Waiting {
    pub fn name(&self) -> &'static str {
        self.pass.name
    }

    /// Starts it. The pass must have been built.
    ///
    /// # Errors
    /// The device refused an argument or the launch.
    pub fn start(&self, device: &Device) -> Result<Event> {
        let name = self.pass.name;
        let kernel = self.pass.kernel();
        let Some(kernel) = &*kernel else {
            return Err(Error::failed(format!("the pass {name} is not built")));
        };
        for (index, given) in self.given.iter().enumerate() {
            let argument = match given {
                Given::Memory(mem) => ArgVal::mem(mem),
                // SAFETY: pointer and size are those of bytes that OpenCL copies in the call below.
                Given::Value(bytes) => unsafe {
                    ArgVal::from_raw(bytes.len(), bytes.as_ptr().cast(), false)
                },
            };
            core::set_kernel_arg(kernel, index as u32, argument).map_err(|e| {
                let argument = self.pass.signature[index].name;
                device_error(&format!("set '{argument}' of the pass {name}"), &e)
            })?;
        }
        let mut event = Event::null();
        // SAFETY: arguments are set and typed, and their memory is held; kernels check their pixel against
        // the image's size.
        unsafe {
            core::enqueue_kernel(
                device.queue(),
                kernel,
                2,
                None,
                &self.global,
                Some(self.group),
                None::<Event>,
                Some(&mut event),
            )
        }
        .map_err(|e| device_error(&format!("launch the pass {name}"), &e))?;
        Ok(event)
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
