//! What a program, as a process, arranges for its drivers: their environment, a folder, and processes of its
//! own in which they build.
//!
//! A driver that builds kernels in the program's own process can end it, and cannot be stopped. So the
//! program starts itself anew to build, as a builder (`gpu/build_server.rs`). A library has no program to start: where
//! [`begin`] was not called, kernels are built in the process that wants them, and its environment is left
//! as it is.

use std::process::ExitCode;

use super::arranged::{Arranged, POCL_FOLDER, arrange, arranged};
use super::build_server;
use super::scratch::Scratch;

/// Asks PoCL for one kernel for work-groups of all sizes. Its kernels of one size each are no faster here,
/// and its binaries hold the one for all sizes only.
const POCL_SPECIALIZATION: &str = "POCL_WORK_GROUP_SPECIALIZATION";

/// Sets what drivers read from the environment; to be called first in the program's `main`. The folder
/// that they are given is created when a device is first looked for, and removed when the returned value
/// is dropped.
///
/// # Safety
/// No other thread may run: they may be reading the environment.
#[must_use = "the driver's folder goes with it"]
pub unsafe fn begin() -> Process {
    if std::env::var_os(POCL_SPECIALIZATION).is_none() {
        // SAFETY: as this function demands.
        unsafe { std::env::set_var(POCL_SPECIALIZATION, "0") };
    }
    let is_builder = build_server::is_requested();
    if is_builder {
        return Process { is_builder };
    }
    let scratch = Scratch::choose();
    if let Some(scratch) = &scratch {
        // SAFETY: as this function demands.
        unsafe { std::env::set_var(POCL_FOLDER, scratch.path()) };
    }
    arrange(Arranged { scratch });
    Process { is_builder }
}

/// The process, from [`begin`] to its end.
pub struct Process {
    is_builder: bool,
}

impl Process {
    /// Where this process was started to build a kernel: does so, and returns the exit code.
    pub fn build_if_requested(&self) -> Option<ExitCode> {
        self.is_builder.then(build_server::serve)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if let Some(scratch) = arranged().and_then(|arranged| arranged.scratch.as_ref()) {
            scratch.remove();
        }
    }
}
