//! A pass: one kernel, whose arguments are checked by name, type and count when it is built.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use ocl::core::{self, Event, Kernel};

use crate::error::{Error, Result};
use crate::extent::ImageSize;

use super::args::{Args, Argument};
use super::device::Device;
use super::program::{self, Defines, Order};
use super::signature::Parameter;
use super::status::device_error;

/// A kernel, built before its first launch. The arguments of that launch are its signature: the kernel is
/// compared with them when it is built, and later launches must give the same.
pub struct Pass {
    folder: &'static str,
    name: &'static str,
    defines: Defines,
    /// Pixels along x and y that one work-item takes.
    tile: [usize; 2],
    signature: OnceLock<Vec<Parameter>>,
    kernel: Mutex<Option<Kernel>>,
}

impl Pass {
    /// The kernel `name` of `kernels/<folder>/<name>.cl`, not built yet; one work-item takes a `tile` of
    /// pixels along x and y.
    pub fn new(
        folder: &'static str,
        name: &'static str,
        defines: Defines,
        tile: [usize; 2],
    ) -> Arc<Self> {
        Arc::new(Self {
            folder,
            name,
            defines,
            tile,
            signature: OnceLock::new(),
            kernel: Mutex::new(None),
        })
    }

    fn kernel(&self) -> MutexGuard<'_, Option<Kernel>> {
        self.kernel.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Builds those of the passes that are not built yet, and compares them with their signatures. Returns
    /// how many there were.
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

    fn order(&self) -> Order<'_> {
        Order {
            path: format!("{}/{}.cl", self.folder, self.name),
            name: self.name,
            defines: &self.defines,
            signature: self.signature.get().map_or(&[], Vec::as_slice),
        }
    }

    /// Prepares a launch with these arguments: a work-item per tile of the `size` pixels, in groups of
    /// `work_group` work-items along x and y; `None`: groups of 8 × 8 pixels, where the device takes those.
    ///
    /// # Errors
    /// The arguments are not those of the first launch.
    pub fn launch(
        self: &Arc<Self>,
        device: &Device,
        args: Args,
        size: ImageSize,
        work_group: Option<[usize; 2]>,
    ) -> Result<Launch> {
        let (parameters, arguments) = args.into_parts();
        let signature = self.signature.get_or_init(|| parameters.clone());
        if *signature != parameters {
            return Err(Error::failed(format!(
                "the pass {} was first launched with other arguments",
                self.name
            )));
        }
        let [tile_x, tile_y] = self.tile;
        let [group_x, group_y] = work_group.unwrap_or_else(|| default_group(device, self.tile));
        let (width, height) = (size.width() as usize, size.height() as usize);
        Ok(Launch {
            pass: Arc::clone(self),
            arguments,
            global: [
                width.div_ceil(tile_x).next_multiple_of(group_x),
                height.div_ceil(tile_y).next_multiple_of(group_y),
                1,
            ],
            group: [group_x, group_y, 1],
        })
    }
}

/// A launch of a pass that has not been made yet: it waits for the passes of its frame to be built.
#[must_use]
pub struct Launch {
    pub(super) pass: Arc<Pass>,
    arguments: Vec<Argument>,
    global: [usize; 3],
    group: [usize; 3],
}

impl Launch {
    /// The name of the pass.
    pub(super) fn name(&self) -> &'static str {
        self.pass.name
    }

    /// Starts it. The pass must have been built.
    ///
    /// # Errors
    /// The device refused an argument or the launch.
    pub(super) fn start(&self, device: &Device) -> Result<Event> {
        let name = self.pass.name;
        let kernel = self.pass.kernel();
        let Some(kernel) = &*kernel else {
            return Err(Error::failed(format!("the pass {name} is not built")));
        };
        for (index, argument) in self.arguments.iter().enumerate() {
            core::set_kernel_arg(kernel, index as u32, argument.as_cl()).map_err(|e| {
                let signature = self.pass.signature.get();
                let argument = signature.map_or("", |signature| signature[index].name);
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
fn default_group(device: &Device, tile: [usize; 2]) -> [usize; 2] {
    let group = [0, 1].map(|axis| (GROUP_PIXELS[axis] / tile[axis]).max(1));
    if group[0] * group[1] <= device.info().max_work_group {
        group
    } else {
        [1, 1]
    }
}
