//! Finding and opening an OpenCL device.

use std::ffi::CString;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use ocl::core::{
    self, CommandQueue, CommandQueueProperties, Context, ContextProperties, DeviceId, DeviceType,
    PlatformId,
};

use crate::crash;
use crate::error::{Error, Result};
use crate::progress::{Progress, Silent};

use super::arranged::{Arranged, arranged};
use super::binary::Binaries;
use super::device_info::{DeviceInfo, DeviceKind, describe};
use super::loader;
use super::status::device_error;

/// An open device with one in-order queue that times what runs on it.
pub struct Device {
    info: DeviceInfo,
    device_id: DeviceId,
    context: Context,
    queue: CommandQueue,
    binaries: Binaries,
    uploaded_bytes: AtomicU64,
    built_kernels: AtomicU64,
    listener: Box<dyn Progress + Send>,
}

impl Device {
    /// All usable devices of all platforms.
    ///
    /// # Errors
    /// No OpenCL library, no platform, no device: [`crate::error::ErrorKind::NoDevice`].
    pub fn list() -> Result<Vec<DeviceInfo>> {
        Ok(found()?.into_iter().map(|(_, _, info)| info).collect())
    }

    /// Opens the first GPU; without one, the first device.
    ///
    /// # Errors
    /// As [`Device::list`].
    pub fn first() -> Result<Self> {
        Self::select("")
    }

    /// Opens the device that `choice` names: an ID of [`Device::list`], `cpu`, `gpu`, part of a
    /// device's or platform's name in any case, or nothing for the first GPU, else the first device.
    ///
    /// # Errors
    /// As [`Device::list`], or no device fits the choice.
    pub fn select(choice: &str) -> Result<Self> {
        let mut found = found()?;
        let wanted = choice.to_lowercase();
        let fits = |info: &DeviceInfo| match wanted.as_str() {
            "" => info.kind == DeviceKind::Gpu,
            "cpu" => info.kind == DeviceKind::Cpu,
            "gpu" => info.kind == DeviceKind::Gpu,
            _ => wanted.parse().map_or_else(
                |_| {
                    info.name.to_lowercase().contains(&wanted)
                        || info.platform.to_lowercase().contains(&wanted)
                },
                |id: usize| id == info.id,
            ),
        };
        let place = match found.iter().position(|(_, _, info)| fits(info)) {
            Some(place) => place,
            None if wanted.is_empty() => 0,
            None => {
                let names: Vec<_> = found
                    .iter()
                    .map(|(_, _, info)| format!("{} {}", info.id, info.name))
                    .collect();
                return Err(Error::no_device(format!(
                    "no OpenCL device fits '{choice}'; there is: {}",
                    names.join(", ")
                ))
                .hint("'angioray devices' lists them; '--device reference' needs none"));
            }
        };
        let (platform, device_id, info) = found.swap_remove(place);
        crash::while_at_work(&format!("the device '{}' was at work", info.name));
        Self::open(platform, device_id, info)
    }

    /// Reports kernels that are built to `listener` from now on: a stage of as many units as there are.
    #[must_use]
    pub fn heard_by(mut self, listener: impl Progress + Send + 'static) -> Self {
        self.listener = Box::new(listener);
        self
    }

    /// Why built kernels are not cached from run to run, where that was not the user's wish.
    pub fn note(&self) -> Option<&str> {
        self.binaries.note()
    }

    fn open(platform: PlatformId, device_id: DeviceId, info: DeviceInfo) -> Result<Self> {
        let properties = ContextProperties::new().platform(platform);
        let context = core::create_context(Some(&properties), &[device_id], None, None)
            .map_err(|e| device_error("open the device", &e))?;
        let profiling = CommandQueueProperties::PROFILING_ENABLE;
        let queue = core::create_command_queue(&context, device_id, Some(profiling))
            .map_err(|e| device_error("make a command queue", &e))?;
        Ok(Self {
            info,
            device_id,
            context,
            queue,
            binaries: Binaries::open()?,
            uploaded_bytes: AtomicU64::new(0),
            built_kernels: AtomicU64::new(0),
            listener: Box::new(Silent),
        })
    }

    /// The properties of the device.
    pub fn info(&self) -> &DeviceInfo {
        &self.info
    }

    /// Bytes copied to the device since it was opened.
    pub fn uploaded_bytes(&self) -> u64 {
        self.uploaded_bytes.load(Ordering::Relaxed)
    }

    /// Kernels built, and not taken from the cache, since it was opened.
    pub fn built_kernels(&self) -> u64 {
        self.built_kernels.load(Ordering::Relaxed)
    }

    pub(super) fn count_built(&self) {
        self.built_kernels.fetch_add(1, Ordering::Relaxed);
    }

    pub(super) fn listener(&self) -> &dyn Progress {
        &*self.listener
    }

    pub(super) fn count_upload(&self, bytes: usize) {
        self.uploaded_bytes
            .fetch_add(bytes as u64, Ordering::Relaxed);
    }

    pub(super) fn device_id(&self) -> DeviceId {
        self.device_id
    }

    pub(super) fn context(&self) -> &Context {
        &self.context
    }

    pub(super) fn queue(&self) -> &CommandQueue {
        &self.queue
    }

    pub(super) fn binaries(&self) -> &Binaries {
        &self.binaries
    }

    /// Waits until all that was launched is done.
    ///
    /// # Errors
    /// The device failed.
    pub fn finish(&self) -> Result<()> {
        core::finish(&self.queue).map_err(|e| device_error("finish", &e))
    }

    pub(super) fn program(&self, source: &str) -> Result<core::Program> {
        let source =
            CString::new(source).map_err(|_| Error::failed("a kernel source holds a NUL byte"))?;
        core::create_program_with_source(&self.context, &[source])
            .map_err(|e| device_error("take a kernel's source", &e))
    }
}

/// Every usable device with its platform. Devices that do not answer are left out.
fn found() -> Result<Vec<(PlatformId, DeviceId, DeviceInfo)>> {
    const INSTALL: &str = "install a driver, such as PoCL for any CPU ('scripts/setup.sh', or Debian's pocl-opencl-icd and ocl-icd-libopencl1), or render without one with '--device reference'";
    // Drivers set themselves up at the first call, and not all of them can do it in two threads at once.
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _one = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = arranged().map(Arranged::folder);
    loader::open().map_err(|reason| {
        Error::no_device(format!("no OpenCL library is installed ({reason})")).hint(INSTALL)
    })?;
    let platforms = if any_platform() {
        core::get_platform_ids().unwrap_or_default()
    } else {
        Vec::new()
    };
    let mut found = Vec::new();
    for platform in platforms {
        let devices =
            core::get_device_ids(platform, Some(DeviceType::ALL), None).unwrap_or_default();
        for device in devices {
            if let Some(info) = describe(found.len(), platform, device) {
                found.push((platform, device, info));
            }
        }
    }
    if let (true, Some(Err(why))) = (found.is_empty(), folder) {
        return Err(Error::resource(format!(
            "no OpenCL device was found, and there is no folder in which a driver could build ({why})"
        ))
        .hint("let TMPDIR name a folder that takes files"));
    }
    if found.is_empty() {
        return Err(Error::no_device("no OpenCL device was found").hint(INSTALL));
    }
    Ok(found)
}

/// Whether any driver is installed. This is checked first, because `ocl` waits ten seconds for one to
/// appear.
fn any_platform() -> bool {
    let mut count = 0;
    // SAFETY: no list of length 0 makes OpenCL give the count alone.
    unsafe { ocl::ffi::clGetPlatformIDs(0, std::ptr::null_mut(), &raw mut count) };
    count > 0
}
