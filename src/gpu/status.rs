//! Failed OpenCL calls as errors.

use crate::error::Error;

/// A failed OpenCL call in one line: what was being done, and the status's name.
pub(super) fn device_error(doing: &str, error: &ocl::core::Error) -> Error {
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
