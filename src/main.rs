//! The program: everything is in the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    // SAFETY: the program begins here, with one thread.
    unsafe { angioray::gpu::loader::prepare_environment() };
    angioray::cli::main()
}
