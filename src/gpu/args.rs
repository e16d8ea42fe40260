//! The arguments of a pass: one list, which is both its kernel's signature and what a launch binds.

use bytemuck::bytes_of;
use ocl::core::{ArgVal, Mem};
use smallvec::SmallVec;

use super::element::Element;
use super::image::Image;
use super::memory::{AnyBuffer, Buffer};
use super::signature::{Parameter, ParameterType};

/// The arguments of a pass, in the order of its kernel's: each with the name and the type that the kernel
/// must give it. Memory is held until the launch has been made, so that buffers may be dropped before.
#[must_use]
#[derive(Default)]
pub struct Args {
    parameters: Vec<Parameter>,
    arguments: Vec<Argument>,
}

/// An argument as the device gets it.
pub(super) enum Argument {
    Memory(Mem),
    Value(SmallVec<[u8; 64]>),
}

impl Argument {
    /// The argument as OpenCL takes it, which borrows from `self`.
    pub fn as_cl(&self) -> ArgVal<'_> {
        match self {
            Self::Memory(mem) => ArgVal::mem(mem),
            // SAFETY: pointer and size are those of bytes that are borrowed for as long as the argument is.
            Self::Value(bytes) => unsafe {
                ArgVal::from_raw(bytes.len(), bytes.as_ptr().cast(), false)
            },
        }
    }
}

/// Things that kernels take together, as consecutive arguments under names of their own.
pub trait Group {
    /// Adds the group's arguments at the end of a list.
    fn add_to(self, args: Args) -> Args;
}

/// A group that is not there adds nothing.
impl<G: Group> Group for Option<G> {
    fn add_to(self, args: Args) -> Args {
        match self {
            Some(group) => group.add_to(args),
            None => args,
        }
    }
}

impl Args {
    /// An empty list.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a buffer that the pass reads.
    pub fn read(self, name: &'static str, buffer: &AnyBuffer) -> Self {
        let argument = Argument::Memory(buffer.mem().clone());
        self.add(name, ParameterType::Buffer(buffer.cl_name()), argument)
    }

    /// Adds a buffer that the pass reads, where there is one.
    pub fn read_some<T>(self, name: &'static str, buffer: Option<&Buffer<T>>) -> Self {
        match buffer {
            Some(buffer) => self.read(name, buffer),
            None => self,
        }
    }

    /// Adds a buffer that the pass writes.
    pub fn write<T: Element>(self, name: &'static str, buffer: &mut Buffer<T>) -> Self {
        self.read(name, buffer)
    }

    /// Adds a three-dimensional image that the pass reads.
    pub fn image(self, name: &'static str, image: &Image) -> Self {
        let argument = Argument::Memory(image.mem().clone());
        self.add(name, ParameterType::Image, argument)
    }

    /// Adds a number or struct that is copied to the device at the launch.
    pub fn value<T: Element>(self, name: &'static str, value: &T) -> Self {
        let argument = Argument::Value(bytes_of(value).into());
        self.add(name, ParameterType::Value(T::CL_NAME), argument)
    }

    /// Adds the arguments of a group.
    pub fn with(self, group: impl Group) -> Self {
        group.add_to(self)
    }

    fn add(mut self, name: &'static str, of: ParameterType, argument: Argument) -> Self {
        self.parameters.push(Parameter { name, of });
        self.arguments.push(argument);
        self
    }

    /// Splits the list into the signature and what is bound to it.
    pub(super) fn into_parts(self) -> (Vec<Parameter>, Vec<Argument>) {
        (self.parameters, self.arguments)
    }
}
