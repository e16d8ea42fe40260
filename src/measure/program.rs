//! Which program measures, by its content.

use crate::error::{Error, Result};
use crate::gpu::{files, flatten};

/// Adds the program's own file: one built anew may answer otherwise.
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

/// Adds the kernels, which may come from a folder and not from the program. A file that is not there
/// is not used.
pub fn hash_kernels(hasher: &mut blake3::Hasher) {
    for path in files() {
        if let Ok(text) = flatten(path) {
            hasher.update(text.as_bytes());
        }
    }
}
