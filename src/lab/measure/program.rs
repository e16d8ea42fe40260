//! The identity of the program that measures, by its content.

use crate::error::{Error, Result};
use crate::gpu::{files, flatten};

/// Adds the program's own file to a hash: another build may give other results.
///
/// # Errors
/// The program cannot read its own file.
pub fn hash_program(hasher: &mut blake3::Hasher) -> Result<()> {
    let failed = |cause: std::io::Error| {
        Error::failed(format!("the program cannot read its own file: {cause}"))
    };
    let path = std::env::current_exe().map_err(failed)?;
    let file = std::fs::File::open(path).map_err(failed)?;
    hasher.update_reader(file).map_err(failed)?;
    Ok(())
}

/// Adds the kernels to a hash; they may come from a folder and not from the program. A file that does
/// not exist is left out, as nothing uses it.
pub fn hash_kernels(hasher: &mut blake3::Hasher) {
    for path in files() {
        if let Ok(text) = flatten(path) {
            hasher.update(text.as_bytes());
        }
    }
}
