//! What arguments a kernel takes, as its Rust function means it and as the built kernel tells it.

use ocl::core::{self, Kernel, KernelArgInfo, KernelArgInfoResult, KernelInfo, KernelInfoResult};

use crate::error::{Error, Result};

use super::{Element, device_error};

/// One argument of a kernel, as its Rust function means it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameter {
    pub(super) name: &'static str,
    /// As OpenCL tells it: `float*` for a buffer, `image3d_t` for an image, `RayGrid` for a value.
    pub(super) type_name: String,
}

impl Parameter {
    /// Its name and its type, as OpenCL gives them.
    pub(super) fn as_told(&self) -> (&str, &str) {
        (self.name, &self.type_name)
    }
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
pub(super) const IMAGE: &str = "image3d_t";

/// A number or struct handed over by value.
pub fn value<T: Element>(name: &'static str) -> Parameter {
    Parameter {
        name,
        type_name: T::CL_NAME.to_owned(),
    }
}

/// Compares the kernel's own arguments with the names and types of a signature. Only kernels built from source tell them
/// (OpenCL 1.2, §5.7.3).
///
/// # Errors
/// They differ, or the kernel does not tell.
pub(super) fn check<'a>(
    kernel: &Kernel,
    name: &str,
    signature: impl ExactSizeIterator<Item = (&'a str, &'a str)>,
) -> Result<()> {
    let does_not_tell = || Error::failed(format!("the pass {name} does not tell its arguments"));
    let KernelInfoResult::NumArgs(count) = core::get_kernel_info(kernel, KernelInfo::NumArgs)
        .map_err(|e| device_error("count a kernel's arguments", &e))?
    else {
        return Err(does_not_tell());
    };
    if count as usize != signature.len() {
        return Err(Error::failed(format!(
            "the pass {name} takes {count} arguments, its Rust function gives {}",
            signature.len()
        )));
    }
    for (index, (name_given, type_given)) in signature.enumerate() {
        let ask = |what| {
            core::get_kernel_arg_info(kernel, index as u32, what, None)
                .map_err(|e| device_error("ask for a kernel's arguments", &e))
        };
        let (KernelArgInfoResult::Name(name_there), KernelArgInfoResult::TypeName(type_there)) =
            (ask(KernelArgInfo::Name)?, ask(KernelArgInfo::TypeName)?)
        else {
            return Err(does_not_tell());
        };
        let type_there = type_there.trim_start_matches("struct ").replace(' ', "");
        if name_there != name_given || type_there != type_given {
            return Err(Error::failed(format!(
                "argument {index} of the pass {name} is '{type_there} {name_there}', its Rust function gives '{type_given} {name_given}'"
            )));
        }
    }
    Ok(())
}
