//! Lets the program link where no OpenCL library is installed.
//!
//! The `cl-sys` crate asks the linker for `-lOpenCL`. `src/gpu/loader.rs` defines those symbols and
//! forwards them to the library that it opens at run time, so an empty archive satisfies the
//! linker, and the program starts (to say what to install) on a machine without OpenCL.

use std::path::Path;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    println!("cargo:rerun-if-changed=build.rs");
    let target_os = env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    if target_os == "macos" {
        return Ok(()); // OpenCL is a framework of the system there
    }
    let out_dir = env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    let msvc = env::var("CARGO_CFG_TARGET_ENV").is_ok_and(|v| v == "msvc");
    let name = if msvc { "OpenCL.lib" } else { "libOpenCL.a" };
    fs::write(Path::new(&out_dir).join(name), b"!<arch>\n")?;
    println!("cargo:rustc-link-search=native={out_dir}");
    Ok(())
}
