//! Building kernels from their sources and constants.

use std::ffi::CString;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread::available_parallelism;

use ocl::core::{self, Kernel, Program, ProgramBuildInfo};

use crate::cache::mark_used;
use crate::crash;
use crate::error::{Error, Result};
use crate::progress::Stage;

use super::arranged::{Arranged, arranged};
use super::builder::{self, Answer, Builders, Request};
use super::device::Device;
use super::signature::{self, Parameter, as_texts};
use super::status::device_error;
use super::{binary, source};

/// Names further options for the device's compiler while developing: `-cl-opt-disable` builds in a third of the time what
/// then runs several times as long, to the same bits.
const MORE_OPTIONS: &str = "ANGIORAY_KERNEL_OPTIONS";

/// The constants of a built program, `-D NAME=VALUE`, in the order given. Two equal lists are the
/// same program.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct Defines(Vec<(&'static str, String)>);

impl Defines {
    /// Adds a constant.
    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl ToString) -> Self {
        self.0.push((name, value.to_string()));
        self
    }

    /// The value of a constant.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|d| d.0 == name).map(|d| d.1.as_str())
    }

    /// The compiler's options: the constants, OpenCL C 1.2, argument names included for checking.
    pub fn options(&self) -> String {
        let mut options = String::from("-cl-std=CL1.2 -cl-kernel-arg-info");
        for (name, value) in &self.0 {
            options.push_str(&format!(" -D {name}={value}"));
        }
        options
    }
}

/// A kernel that is wanted: `name` of `kernels/<path>`, which has the arguments of `signature`.
pub(super) struct Order<'a> {
    /// The kernel's file below `kernels`.
    pub path: String,
    /// The kernel's name.
    pub name: &'static str,
    /// The constants that the kernel is built with.
    pub defines: &'a Defines,
    /// The kernel's arguments.
    pub signature: &'a [Parameter],
}

/// Builds kernels, in the order given, or takes them from the cache of built programs. The device's
/// listener is notified of those that are built.
///
/// # Errors
/// A source does not build on this device, then the message holds the compiler's first lines; or its
/// arguments are others; the driver failed; it is time to stop.
pub(super) fn build(device: &Device, orders: &[Order]) -> Result<Vec<Kernel>> {
    let plans = orders.iter().map(|order| Plan::of(device, order));
    let plans = plans.collect::<Result<Vec<Plan>>>()?;
    let mut kernels: Vec<Option<Kernel>> = plans.iter().map(|plan| plan.cached(device)).collect();
    let missing: Vec<usize> = (0..plans.len()).filter(|&i| kernels[i].is_none()).collect();
    if !missing.is_empty() {
        let count = missing.len() as u64;
        let stage = Stage::begin(device.listener(), "building kernels", count);
        let take = |i: usize, kernel| {
            kernels[i] = Some(kernel);
            device.count_built();
            stage.advance(1);
        };
        match arranged() {
            Some(arranged) => build_elsewhere(arranged, device, &plans, &missing, take)?,
            None => build_here(device, &plans, &missing, take)?,
        }
    }
    Ok(kernels.into_iter().flatten().collect())
}

/// Builds kernels in this process, one after another.
fn build_here(
    device: &Device,
    plans: &[Plan],
    missing: &[usize],
    mut take: impl FnMut(usize, Kernel),
) -> Result<()> {
    for &i in missing {
        take(i, plans[i].built_here(device)?);
    }
    Ok(())
}

/// Builds kernels in processes of their own, as many at once as there are processors.
fn build_elsewhere(
    arranged: &Arranged,
    device: &Device,
    plans: &[Plan],
    missing: &[usize],
    mut take: impl FnMut(usize, Kernel),
) -> Result<()> {
    let at_once = available_parallelism().map_or(1, usize::from);
    let requests = missing.iter().map(|&i| (i, plans[i].request(device)));
    let requests: Vec<(usize, Request)> = requests.collect();
    let (next, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
    let (send, receive) = mpsc::channel();
    let mut outcome = Ok(());
    std::thread::scope(|scope| {
        for _ in 0..at_once.min(requests.len()) {
            let (send, requests, next, failed) = (send.clone(), &requests, &next, &failed);
            scope.spawn(move || {
                let mut builders = Builders::new(arranged);
                while let Some((i, request)) = requests.get(next.fetch_add(1, Ordering::Relaxed))
                    && !failed.load(Ordering::Relaxed)
                {
                    let _ = send.send((*i, builders.build(request, failed)));
                }
            });
        }
        drop(send);
        for (i, answer) in receive {
            match answer.and_then(|answer| plans[i].answered(device, answer)) {
                Ok(kernel) => take(i, kernel),
                // The others end by this one, which says why.
                Err(error) if outcome.is_ok() => {
                    failed.store(true, Ordering::Relaxed);
                    outcome = Err(error);
                }
                Err(_) => {}
            }
        }
    });
    outcome
}

/// A kernel's source and options, and where its binary is cached.
struct Plan<'a> {
    order: &'a Order<'a>,
    source: String,
    options: CString,
    cached: Option<PathBuf>,
}

impl<'a> Plan<'a> {
    fn of(device: &Device, order: &'a Order<'a>) -> Result<Self> {
        let source = source::flatten(&order.path)?;
        // Drivers print their compiler's warnings, which are the tests' business, beside the program's own
        // words.
        let mut options = format!("{} -w", order.defines.options());
        if let Ok(more) = std::env::var(MORE_OPTIONS) {
            options.push_str(&format!(" {more}"));
        }
        // A cached program is one whose arguments were compared with this signature: it does not report them.
        let cached = (device.binaries()).path(device.info(), &source, &options, order.signature);
        Ok(Self {
            order,
            source,
            options: c_string(options)?,
            cached,
        })
    }

    /// The kernel from the cache of built programs.
    fn cached(&self, device: &Device) -> Option<Kernel> {
        let path = self.cached.as_deref()?;
        let binary = binary::read(path)?;
        crash::suspect(path);
        let kernel = self.taken_from(device, &binary)?;
        mark_used(path);
        Some(kernel)
    }

    /// The kernel of a built program; nothing where the driver does not take it.
    fn taken_from(&self, device: &Device, binary: &[u8]) -> Option<Kernel> {
        let devices = [device.device_id()];
        let context = device.context();
        let program = core::create_program_with_binary(context, &devices, &[binary]).ok()?;
        compile(device, &program, &self.options).ok()?;
        core::create_kernel(&program, self.order.name).ok()
    }

    fn store(&self, binary: &[u8]) {
        if let Some(path) = &self.cached {
            binary::store(path, binary);
            crash::suspect(path);
        }
    }

    fn built_here(&self, device: &Device) -> Result<Kernel> {
        let Order {
            path,
            name,
            signature,
            ..
        } = self.order;
        let program = compiled(device, &self.source, &self.options, path)?;
        let kernel = kernel_of(&program, name)?;
        signature::check(&kernel, name, &as_texts(signature))?;
        if let Some(binary) = binary::of(&program) {
            self.store(&binary);
        }
        Ok(kernel)
    }

    fn request(&self, device: &Device) -> Request {
        Request {
            device: device.info().id,
            identity: builder::identity(device.info()),
            path: self.order.path.clone(),
            source: self.source.clone(),
            options: self.options.to_string_lossy().into_owned(),
            kernel: self.order.name.to_owned(),
            signature: as_texts(self.order.signature),
        }
    }

    /// The kernel that another process built, or could not.
    fn answered(&self, device: &Device, answer: Answer) -> Result<Kernel> {
        if let Answer::Built(binary) = answer
            && let Some(kernel) = self.taken_from(device, &binary)
        {
            self.store(&binary);
            return Ok(kernel);
        }
        self.built_here(device)
    }
}

/// The binary of a requested kernel, packed, built in this process; nothing where the driver gives none.
///
/// # Errors
/// As [`build`].
pub(super) fn binary_of(device: &Device, request: &Request) -> Result<Option<Vec<u8>>> {
    let options = c_string(request.options.clone())?;
    let program = compiled(device, &request.source, &options, &request.path)?;
    let kernel = kernel_of(&program, &request.kernel)?;
    signature::check(&kernel, &request.kernel, &request.signature)?;
    Ok(binary::of(&program).map(|binary| binary::packed(&binary)))
}

fn c_string(options: String) -> Result<CString> {
    CString::new(options).map_err(|_| Error::failed("a kernel constant holds a NUL byte"))
}

fn compiled(device: &Device, source: &str, options: &CString, path: &str) -> Result<Program> {
    let program = device.program(source)?;
    match compile(device, &program, options) {
        Ok(()) => Ok(program),
        Err(error) => Err(not_built(device, &program, path, &error)),
    }
}

fn kernel_of(program: &Program, name: &str) -> Result<Kernel> {
    core::create_kernel(program, name)
        .map_err(|e| device_error(&format!("take the kernel {name}"), &e))
}

fn compile(device: &Device, program: &Program, options: &CString) -> core::Result<()> {
    core::build_program(program, Some(&[device.device_id()]), options, None, None)
}

/// The error of a program that does not build: the compiler's first lines.
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
