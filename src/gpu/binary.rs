//! Built programs, kept from run to run.
//!
//! Drivers keep what they built too, but may need tenths of a second to find that nothing has changed:
//! PoCL runs the whole preprocessor for it. A program's own binary is there in milliseconds.

use std::path::{Path, PathBuf};

use ocl::core::{self, Program, ProgramInfo, ProgramInfoResult};

use crate::error::Result;
use crate::kept::{self, Kept, asked_for};
use crate::output::write_bytes;

use super::{DeviceInfo, Parameter};

/// Names the folder of built programs, or turns it off.
const FOLDER: &str = "ANGIORAY_KERNEL_CACHE";
const OFF: &str = "off";

/// Of the files of built programs.
const EXTENSION: &str = "kernel";

/// Where built programs are kept; nowhere where there is no place for them.
#[derive(Debug)]
pub struct Binaries(Option<Kept>);

impl Binaries {
    /// In the folder that the environment names, else in the user's cache folder.
    ///
    /// # Errors
    /// The folder that is named cannot be made.
    pub fn open() -> Result<Self> {
        match std::env::var_os(FOLDER) {
            Some(word) if word == OFF => Ok(Self(None)),
            Some(folder) => Kept::in_folder(Path::new(&folder), EXTENSION)
                .map(|kept| Self(Some(kept)))
                .map_err(|error| {
                    error.hint(format!(
                        "let {FOLDER} name another folder, or set it to 'off'"
                    ))
                }),
            None => {
                let folder = kept::users_folder();
                let kept = folder.and_then(|folder| Kept::in_folder(&folder, EXTENSION).ok());
                Ok(Self(kept))
            }
        }
    }

    /// Where the program is kept that the device's compiler makes of `source` and `options`, and whose
    /// kernel has the arguments of `signature`.
    pub fn path(
        &self,
        device: &DeviceInfo,
        source: &str,
        options: &str,
        signature: &[Parameter],
    ) -> Option<PathBuf> {
        let kept = self.0.as_ref()?;
        let mut hasher = blake3::Hasher::new();
        let DeviceInfo {
            name,
            platform,
            driver,
            version,
            ..
        } = device;
        let mut add = |part: &str| {
            hasher.update(&(part.len() as u64).to_le_bytes());
            hasher.update(part.as_bytes());
        };
        for part in [name, platform, driver, version, options, source] {
            add(part);
        }
        for parameter in signature {
            add(parameter.name);
            add(&parameter.type_name);
        }
        Some(kept.path(&hasher))
    }
}

/// The binary kept in `path`; nothing where there is none, or none that is whole.
pub fn read(path: &Path) -> Option<Vec<u8>> {
    let bytes = std::fs::read(path).ok()?;
    let (digest, binary) = bytes.split_at_checked(blake3::OUT_LEN)?;
    if blake3::hash(binary).as_bytes() != digest {
        return None;
    }
    asked_for(path);
    Some(binary.to_owned())
}

/// Keeps a built program in `path`, behind its digest. Where that cannot be done it is built again.
pub fn write(path: &Path, program: &Program) {
    let binaries = core::get_program_info(program, ProgramInfo::Binaries);
    if let Ok(ProgramInfoResult::Binaries(binaries)) = binaries
        && let [binary] = &binaries[..]
        && !binary.is_empty()
    {
        let digest = blake3::hash(binary);
        let _ = write_bytes(path, &[digest.as_bytes(), &binary[..]].concat());
    }
}
