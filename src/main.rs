//! The program: everything is in the library.

use std::process::ExitCode;

use angioray::memory::Allocator;

#[global_allocator]
static ALLOCATOR: Allocator = Allocator;

fn main() -> ExitCode {
    // SAFETY: the program begins here, with one thread.
    let process = unsafe { angioray::gpu::process::begin() };
    if let Some(built) = process.build_if_requested() {
        return built;
    }
    angioray::crash::catch();
    angioray::cli::main()
}
