//! The arguments that a kernel takes: as its Rust function gives them, and as the built kernel reports them.

use std::fmt;

use ocl::core::{self, Kernel, KernelArgInfo, KernelArgInfoResult, KernelInfo, KernelInfoResult};

use crate::error::{Error, Result};

use super::status::device_error;

/// One argument of a kernel, as its Rust function gives it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Parameter {
    /// The argument's name.
    pub name: &'static str,
    /// The argument's type.
    pub of: ParameterType,
}

/// The type of an argument, with the element's name in OpenCL C.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ParameterType {
    Buffer(&'static str),
    Image,
    Value(&'static str),
}

/// The type as OpenCL reports it: `float*` for a buffer, `image3d_t` for an image, `RayGrid` for a
/// value.
impl fmt::Display for ParameterType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Buffer(element) => write!(f, "{element}*"),
            Self::Image => f.write_str("image3d_t"),
            Self::Value(element) => f.write_str(element),
        }
    }
}

/// Names and types of a signature, as they are compared with a kernel's own and sent to other processes.
pub(super) fn as_texts(signature: &[Parameter]) -> Vec<(String, String)> {
    let text = |parameter: &Parameter| (parameter.name.to_owned(), parameter.of.to_string());
    signature.iter().map(text).collect()
}

/// Compares the kernel's own arguments with the names and types of a signature. Only kernels built from
/// source report them (OpenCL 1.2, §5.7.3).
///
/// # Errors
/// They differ, or the kernel does not report them.
pub(super) fn check(kernel: &Kernel, name: &str, signature: &[(String, String)]) -> Result<()> {
    let not_reported = || Error::failed(format!("the pass {name} does not report its arguments"));
    let KernelInfoResult::NumArgs(count) = core::get_kernel_info(kernel, KernelInfo::NumArgs)
        .map_err(|e| device_error("count a kernel's arguments", &e))?
    else {
        return Err(not_reported());
    };
    if count as usize != signature.len() {
        return Err(Error::failed(format!(
            "the pass {name} takes {count} arguments, its Rust function gives {}",
            signature.len()
        )));
    }
    for (index, (name_given, type_given)) in signature.iter().enumerate() {
        let query = |what| {
            core::get_kernel_arg_info(kernel, index as u32, what, None)
                .map_err(|e| device_error("query a kernel's arguments", &e))
        };
        let (KernelArgInfoResult::Name(name_there), KernelArgInfoResult::TypeName(type_there)) =
            (query(KernelArgInfo::Name)?, query(KernelArgInfo::TypeName)?)
        else {
            return Err(not_reported());
        };
        let type_there = type_there.trim_start_matches("struct ").replace(' ', "");
        if name_there != *name_given || type_there != *type_given {
            return Err(Error::failed(format!(
                "argument {index} of the pass {name} is '{type_there} {name_there}', its Rust function gives '{type_given} {name_given}'"
            )));
        }
    }
    Ok(())
}
