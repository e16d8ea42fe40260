//! What is known of a device before it is opened.

use std::fmt;

use ocl::core::{
    self, DeviceId, DeviceInfo as Query, DeviceInfoResult, DeviceType, PlatformId, PlatformInfo,
};

/// The kind of processor that a device is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceKind {
    /// The host's own processor.
    Cpu,
    /// A graphics processor.
    Gpu,
    /// Anything else.
    Accelerator,
}

impl fmt::Display for DeviceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
            Self::Accelerator => "accelerator",
        })
    }
}

/// The properties of a device that `angioray devices` prints.
#[derive(Debug, Clone)]
pub struct DeviceInfo {
    /// The device's place in the list of all platforms' devices: `--device ID`.
    pub id: usize,
    /// The device's name.
    pub name: String,
    /// The name of the platform that it belongs to.
    pub platform: String,
    /// The version of its driver.
    pub driver: String,
    /// The OpenCL version that it speaks.
    pub version: String,
    /// The kind of processor.
    pub kind: DeviceKind,
    /// How many of its units compute at once.
    pub compute_units: u32,
    /// The size of the device's memory, bytes.
    pub memory_bytes: u64,
    /// The most memory that it gives in one piece.
    pub max_allocation_bytes: u64,
    /// The most work-items of a group.
    pub max_work_group: usize,
    /// Single-precision numbers in a vector of its own.
    pub vector_width: u32,
}

/// Describes a device; `None` where it does not answer.
pub(super) fn describe(id: usize, platform: PlatformId, device: DeviceId) -> Option<DeviceInfo> {
    let ask = |query| core::get_device_info(device, query).ok();
    let text = |query| Some(ask(query)?.to_string().trim().to_owned());
    let DeviceInfoResult::Type(kind) = ask(Query::Type)? else {
        return None;
    };
    let DeviceInfoResult::MaxComputeUnits(compute_units) = ask(Query::MaxComputeUnits)? else {
        return None;
    };
    let DeviceInfoResult::GlobalMemSize(memory_bytes) = ask(Query::GlobalMemSize)? else {
        return None;
    };
    let DeviceInfoResult::MaxMemAllocSize(max_allocation_bytes) = ask(Query::MaxMemAllocSize)?
    else {
        return None;
    };
    let DeviceInfoResult::MaxWorkGroupSize(max_work_group) = ask(Query::MaxWorkGroupSize)? else {
        return None;
    };
    let DeviceInfoResult::NativeVectorWidthFloat(vector_width) =
        ask(Query::NativeVectorWidthFloat)?
    else {
        return None;
    };
    Some(DeviceInfo {
        id,
        name: text(Query::Name)?,
        platform: core::get_platform_info(platform, PlatformInfo::Name)
            .ok()?
            .to_string(),
        driver: text(Query::DriverVersion)?,
        version: text(Query::Version)?,
        kind: if kind.contains(DeviceType::GPU) {
            DeviceKind::Gpu
        } else if kind.contains(DeviceType::CPU) {
            DeviceKind::Cpu
        } else {
            DeviceKind::Accelerator
        },
        compute_units,
        memory_bytes,
        max_allocation_bytes,
        max_work_group,
        vector_width,
    })
}
