//! What a program, as a process, arranges for its drivers: their environment, a folder, and processes of its
//! own in which they build.
//!
//! A driver that builds kernels in the program's own process can end it, and cannot be stopped. So the
//! program starts itself anew to build, as a builder (`gpu/builder.rs`). A library has no program to start: where
//! [`begin`] was not called, kernels are built in the process that wants them, and its environment is left
//! as it is.

use std::path::Path;
use std::process::ExitCode;
use std::sync::OnceLock;

use super::builder;
use super::scratch::Scratch;

/// Where PoCL keeps what it builds, in its own way. What the user names is not used: PoCL loads what lies
/// there without a check.
pub(super) const POCL_FOLDER: &str = "POCL_CACHE_DIR";

/// Asks PoCL for one kernel for work-groups of all sizes. Its kernels of one size each are no faster here,
/// and its binaries hold the one for all sizes only.
const POCL_SPECIALIZATION: &str = "POCL_WORK_GROUP_SPECIALIZATION";

static ARRANGED: OnceLock<Arranged> = OnceLock::new();

/// What [`begin`] arranged.
pub(super) struct Arranged {
    /// For what drivers write; nothing where there is no place for it.
    scratch: Option<Scratch>,
}

/// What the program's `main` does first: sets what drivers are asked for through the environment. The
/// folder that they are given is made when a device is first looked for, and removed with what is given
/// back here.
///
/// # Safety
/// No other thread may run: they may be reading the environment.
#[must_use = "the driver's folder goes with it"]
pub unsafe fn begin() -> Process {
    if std::env::var_os(POCL_SPECIALIZATION).is_none() {
        // SAFETY: as this function demands.
        unsafe { std::env::set_var(POCL_SPECIALIZATION, "0") };
    }
    let is_builder = builder::is_asked_for();
    if is_builder {
        return Process { is_builder };
    }
    let scratch = Scratch::choose();
    if let Some(scratch) = &scratch {
        // SAFETY: as this function demands.
        unsafe { std::env::set_var(POCL_FOLDER, scratch.path()) };
    }
    let _ = ARRANGED.set(Arranged { scratch });
    Process { is_builder }
}

/// The process, from [`begin`] to its end.
pub struct Process {
    is_builder: bool,
}

impl Process {
    /// Where this process was started to build a kernel: does so, and gives what it ends with.
    pub fn build_if_asked(&self) -> Option<ExitCode> {
        self.is_builder.then(builder::serve)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if let Some(scratch) = arranged().and_then(|arranged| arranged.scratch.as_ref()) {
            scratch.remove();
        }
    }
}

/// Nothing in a library.
pub(super) fn arranged() -> Option<&'static Arranged> {
    ARRANGED.get()
}

impl Arranged {
    /// The folder that drivers are given, made if need be.
    ///
    /// # Errors
    /// Why there is none, as a clause.
    pub fn folder(&self) -> Result<&Path, String> {
        let Some(scratch) = &self.scratch else {
            return Err("no place takes files that may be loaded as programs".to_owned());
        };
        match scratch.make() {
            Ok(()) => Ok(scratch.path()),
            Err(cause) => Err(format!("{}: {cause}", scratch.path().display())),
        }
    }
}
