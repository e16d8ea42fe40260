//! The program: everything is in the library.

use std::process::ExitCode;

use angioray::memory::Allocator;

#[global_allocator]
static ALLOCATOR: Allocator = Allocator;

fn main() -> ExitCode {
    // SAFETY: the program begins here, with one thread.
    unsafe { angioray::gpu::loader::prepare_environment() };
    angioray::cli::main()
}
