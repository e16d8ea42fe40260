//! The OpenCL device, memory, kernel sources, programs, typed passes and timings. Knows no volumes.

mod binary;
mod builder;
mod device;
mod element;
mod image;
mod loader;
mod memory;
mod pass;
pub mod process;
mod program;
mod scratch;
mod signature;
mod source;
mod timing;

pub use device::{Device, DeviceInfo, DeviceKind};
pub use element::Element;
pub use image::{Channel, Image};
pub use memory::{AnyBuffer, Buffer};
pub use pass::{Launch, Pass};
pub use program::Defines;
pub use signature::{Parameter, image, input, input_of, output, value};
pub use source::{files, flatten};
pub use timing::{PassTime, Timings};

use crate::error::Error;

/// A failed OpenCL call, told in one line: what was being done, and the status's name.
fn device_error(doing: &str, error: &ocl::core::Error) -> Error {
    let text = error.to_string();
    let status = text
        .split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
        .find(|word| word.starts_with("CL_"))
        .unwrap_or_else(|| {
            text.lines()
                .find(|line| !line.trim().is_empty())
                .unwrap_or("")
        })
        .to_owned();
    let error = Error::resource(format!("OpenCL could not {doing}: {status}"));
    match status.as_str() {
        "CL_MEM_OBJECT_ALLOCATION_FAILURE" | "CL_OUT_OF_RESOURCES" | "CL_INVALID_BUFFER_SIZE" => {
            error.hint("the device's memory may be too small: choose a smaller picture or volume, or another --device")
        }
        _ => error,
    }
}
