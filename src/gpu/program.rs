//! Building a kernel from its source and its constants.

use std::ffi::CString;

use ocl::core::{self, Kernel, Program, ProgramBuildInfo};

use crate::error::{Error, Result};

use super::signature::{self, Parameter};
use super::{Device, binary, device_error, source};

/// The constants of a built program, `-D NAME=VALUE`, in the order given. Two equal lists are the
/// same program.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct Defines(Vec<(&'static str, String)>);

impl Defines {
    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl ToString) -> Self {
        self.0.push((name, value.to_string()));
        self
    }

    /// The value of a constant.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|d| d.0 == name).map(|d| d.1.as_str())
    }

    /// The compiler's options: the constants, OpenCL C 1.2, argument names kept for checking.
    pub fn options(&self) -> String {
        let mut options = String::from("-cl-std=CL1.2 -cl-kernel-arg-info");
        for (name, value) in &self.0 {
            options.push_str(&format!(" -D {name}={value}"));
        }
        options
    }
}

/// Builds `kernels/<path>` and takes its kernel `name`, which has the arguments of `signature`; or takes it
/// from where built programs are kept.
///
/// # Errors
/// The source does not build on this device, then the message holds the compiler's first lines; or its
/// arguments are others.
pub(super) fn build(
    device: &Device,
    path: &str,
    name: &str,
    defines: &Defines,
    signature: &[Parameter],
) -> Result<Kernel> {
    let source = source::flatten(path)?;
    // Drivers print their compiler's warnings, which are the tests' business, beside the program's own words.
    let options = format!("{} -w", defines.options());
    // A kept program is one whose arguments were compared with this signature: it does not tell them.
    let kept = device
        .binaries()
        .path(device.info(), &source, &options, signature);
    let options =
        CString::new(options).map_err(|_| Error::failed("a kernel constant holds a NUL byte"))?;
    if let Some(kernel) = kept
        .as_deref()
        .and_then(binary::read)
        .and_then(|binary| from_binary(device, &binary, name, &options))
    {
        return Ok(kernel);
    }
    let program = device.program(&source)?;
    if let Err(error) = compile(device, &program, &options) {
        return Err(not_built(device, &program, path, &error));
    }
    let kernel = core::create_kernel(&program, name)
        .map_err(|e| device_error(&format!("take the kernel {name}"), &e))?;
    signature::check(&kernel, name, signature)?;
    if let Some(path) = kept {
        binary::write(&path, &program);
    }
    Ok(kernel)
}

fn compile(device: &Device, program: &Program, options: &CString) -> core::Result<()> {
    core::build_program(program, Some(&[device.device_id()]), options, None, None)
}

/// The compiler's first lines.
fn not_built(device: &Device, program: &Program, path: &str, error: &core::Error) -> Error {
    let log = core::get_program_build_info(program, device.device_id(), ProgramBuildInfo::BuildLog)
        .map(|log| log.to_string())
        .unwrap_or_else(|_| error.to_string());
    let first_lines: Vec<&str> = log
        .lines()
        .filter(|l| !l.trim().is_empty())
        .take(12)
        .collect();
    Error::resource(format!(
        "kernels/{path} does not build on '{}': {}",
        device.info().name,
        first_lines.join("; ")
    ))
}

/// The kernel `name` of a built program; nothing where the driver does not take it.
fn from_binary(device: &Device, binary: &[u8], name: &str, options: &CString) -> Option<Kernel> {
    let devices = [device.device_id()];
    let program = core::create_program_with_binary(device.context(), &devices, &[binary]).ok()?;
    compile(device, &program, options).ok()?;
    core::create_kernel(&program, name).ok()
}
