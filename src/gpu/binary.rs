//! The cache of built programs, which lasts from run to run.
//!
//! Drivers cache what they built too, but may need tenths of a second to find that nothing has changed:
//! PoCL runs the whole preprocessor for it. A program's own binary is there in milliseconds.

use std::fmt::Display;
use std::io::Write;
use std::path::{Path, PathBuf};

use ocl::core::{self, Program, ProgramInfo, ProgramInfoResult};

use crate::cache::{self, CacheFolder};
use crate::error::{Error, Result};

use super::arranged::arranged;
use super::device_info::DeviceInfo;
use super::signature::Parameter;

/// Names the folder of built programs, or turns it off.
const FOLDER: &str = "ANGIORAY_KERNEL_CACHE";
const OFF: &str = "off";

/// The extension of the files of built programs.
const EXTENSION: &str = "kernel";

/// The longest file that is read.
const MAX_BYTES: u64 = 1 << 30;

/// Where built programs are cached; nowhere where there is no place for them.
#[derive(Debug)]
pub struct Binaries {
    cache: Option<CacheFolder>,
    /// Why they are not cached, where that was not the user's wish.
    note: Option<String>,
}

impl Binaries {
    /// Opens the cache in the folder that the environment names, else in the user's cache folder.
    ///
    /// # Errors
    /// The folder that is named cannot be made.
    pub fn open() -> Result<Self> {
        match std::env::var_os(FOLDER) {
            Some(word) if word == OFF || word.is_empty() => Ok(Self {
                cache: None,
                note: None,
            }),
            Some(folder) => Self::in_folder(Path::new(&folder)).map_err(|error| {
                error.hint(format!(
                    "let {FOLDER} name another folder, or set it to 'off'"
                ))
            }),
            None => {
                let Some(folder) = cache::user_folder() else {
                    return Ok(Self::not_cached("this user has no cache folder"));
                };
                Ok(Self::in_folder(&folder).unwrap_or_else(Self::not_cached))
            }
        }
    }

    /// Opens the cache in a folder; what is there is used even if nothing can be added.
    fn in_folder(folder: &Path) -> Result<Self> {
        let cache = CacheFolder::in_folder(folder, EXTENSION)?;
        let note = cache::check_writable(folder).err().map(not_cached);
        Ok(Self {
            cache: Some(cache),
            note,
        })
    }

    fn not_cached(why: impl Display) -> Self {
        Self {
            cache: None,
            note: Some(not_cached(why)),
        }
    }

    /// Why built programs are not cached, where that was not the user's wish.
    pub fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }

    /// Where the program is cached that the device's compiler makes of `source` and `options`, and whose
    /// kernel has the arguments of `signature`.
    pub fn path(
        &self,
        device: &DeviceInfo,
        source: &str,
        options: &str,
        signature: &[Parameter],
    ) -> Option<PathBuf> {
        let cache = self.cache.as_ref()?;
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
            add(&parameter.of.to_string());
        }
        Some(cache.path(&hasher))
    }
}

/// The sentence of a [`Binaries::note`].
fn not_cached(why: impl Display) -> String {
    let folder = arranged().and_then(|arranged| arranged.folder().ok());
    let built_in = folder.map_or(String::new(), |folder| {
        format!(
            ", and built in '{}', which is removed at the end",
            folder.display()
        )
    });
    format!(
        "kernels are not cached from run to run ({why}){built_in}; {FOLDER} names another folder"
    )
}

/// The binary in a file of [`packed`] bytes; `None` if there is none, or it is damaged.
pub fn read(path: &Path) -> Option<Vec<u8>> {
    let bytes = cache::read(path, MAX_BYTES).ok()?;
    unpacked(&bytes).map(<[u8]>::to_owned)
}

/// The binary in [`packed`] bytes; nothing where they are not whole.
pub fn unpacked(bytes: &[u8]) -> Option<&[u8]> {
    let (digest, binary) = bytes.split_at_checked(blake3::OUT_LEN)?;
    (blake3::hash(binary).as_bytes() == digest).then_some(binary)
}

/// The driver's binary of a built program; nothing where it gives none. Drivers that leave part of the
/// building to the first launch, as PoCL does, do it now.
pub fn of(program: &Program) -> Option<Vec<u8>> {
    let binaries = core::get_program_info(program, ProgramInfo::Binaries);
    let Ok(ProgramInfoResult::Binaries(binaries)) = binaries else {
        return None;
    };
    let [binary] = &binaries[..] else { return None };
    (!binary.is_empty()).then(|| binary.clone())
}

/// A binary behind its digest.
pub fn packed(binary: &[u8]) -> Vec<u8> {
    [blake3::hash(binary).as_bytes(), binary].concat()
}

/// Stores a binary in `path`. Where that cannot be done it is built again.
pub fn store(path: &Path, binary: &[u8]) {
    let _ = cache::write(path, |out| {
        out.write_all(&packed(binary))
            .map_err(|cause| Error::writing(path, "write", &cause))
    });
}
