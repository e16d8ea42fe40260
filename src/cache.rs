//! An on-disk cache: files that can be made again, each under a hash of everything that it depends on, so
//! that a stale file is never taken for a current one. Files that have not been used for a while expire.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, BufWriter, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::error::{Error, Result};
use crate::input;
use crate::output::write_atomically;

/// The age at which a file that has not been used is removed.
const EXPIRY: Duration = Duration::from_secs(30 * 24 * 3600);

/// A folder of cached files of one kind.
#[derive(Debug, Clone)]
pub struct CacheFolder {
    folder: PathBuf,
    /// The extension of this kind's file names.
    extension: &'static str,
}

impl CacheFolder {
    /// Opens the folder, and creates it if it does not exist. Files of this kind that have not been used for
    /// thirty days, such as those of older versions, are removed, as far as they can be.
    ///
    /// # Errors
    /// The folder cannot be created.
    pub fn in_folder(folder: &Path, extension: &'static str) -> Result<Self> {
        std::fs::create_dir_all(folder)
            .map_err(|cause| Error::writing(folder, "make the folder", &cause))?;
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        for path in entries.map(|entry| entry.path()) {
            let age = || path.metadata().ok()?.modified().ok()?.elapsed().ok();
            let is_ours = path.extension().is_some_and(|name| name == extension);
            if is_ours && age().is_some_and(|age| age > EXPIRY) {
                let _ = std::fs::remove_file(path);
            }
        }
        Ok(Self {
            folder: folder.to_owned(),
            extension,
        })
    }

    /// The path of the file that depends on what was hashed.
    pub fn path(&self, hasher: &blake3::Hasher) -> PathBuf {
        let mut name = String::new();
        for byte in &hasher.finalize().as_bytes()[..16] {
            let _ = write!(name, "{byte:02x}");
        }
        self.folder.join(format!("{name}.{}", self.extension))
    }
}

/// Opens a cached file for reading. It must be a regular file: a pipe, a device or a folder in its place is
/// refused and never waited for.
///
/// # Errors
/// There is no such file, or it cannot be read.
pub fn open(path: &Path) -> io::Result<File> {
    let file = input::open(path)?;
    if file.metadata()?.is_file() {
        Ok(file)
    } else {
        Err(io::Error::new(
            io::ErrorKind::InvalidData,
            "not a regular file",
        ))
    }
}

/// The first `max_bytes` bytes of a cached file, or all if it is shorter; see [`open`].
///
/// # Errors
/// Those of [`open`]; the disk failed.
pub fn read(path: &Path, max_bytes: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.take(max_bytes).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Writes a cached file as [`write_atomically`] does, in place of whatever has its name; a folder stays, and
/// then nothing is cached.
///
/// # Errors
/// Those of [`write_atomically`].
pub fn write(path: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> Result<()>) -> Result<()> {
    // A pipe or a device would receive the bytes, and might never take them.
    let there = fs::symlink_metadata(path);
    if there.is_ok_and(|there| !there.is_file() && !there.is_dir()) {
        fs::remove_file(path).map_err(|cause| Error::writing(path, "replace", &cause))?;
    }
    write_atomically(path, fill)
}

/// Checks that files can be created in an existing folder.
///
/// # Errors
/// The folder's permissions or its file system do not allow it.
pub fn check_writable(folder: &Path) -> Result<()> {
    #[cfg(unix)]
    {
        use rustix::fs::{Access, access};
        access(folder, Access::WRITE_OK | Access::EXEC_OK)
            .map_err(|cause| Error::writing(folder, "make files there", &cause.into()))?;
    }
    #[cfg(not(unix))]
    let _ = folder;
    Ok(())
}

/// Marks a cached file as used now, so that it does not expire. If that fails, it is made again one day.
pub fn mark_used(path: &Path) {
    let file = std::fs::File::options().append(true).open(path);
    let _ = file.and_then(|file| file.set_modified(SystemTime::now()));
}

/// This program's folder in the user's cache folder (XDG Base Directory Specification), if there is one.
pub fn user_folder() -> Option<PathBuf> {
    let named = std::env::var_os("XDG_CACHE_HOME").map(PathBuf::from);
    let named = named.filter(|path| path.is_absolute());
    let home = || Some(std::env::home_dir()?.join(".cache"));
    Some(named.or_else(home)?.join("angioray"))
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use super::*;

    #[test]
    fn unused_files_expire() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str, age: Duration| {
            let path = folder.path().join(name);
            let file = std::fs::File::create(&path).unwrap();
            file.set_modified(SystemTime::now() - age).unwrap();
            path
        };
        let old = put("a.thing", EXPIRY * 2);
        let used = put("b.thing", EXPIRY * 2);
        let young = put("c.thing", EXPIRY / 2);
        let others = put("d.other", EXPIRY * 2);
        mark_used(&used);
        CacheFolder::in_folder(folder.path(), "thing").unwrap();
        let there = [&old, &used, &young, &others].map(|path| path.exists());
        assert_eq!(there, [false, true, true, true]);
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_regular_file_is_not_waited_for_and_is_replaced() {
        use std::os::unix::net::UnixListener;
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("file"), "x").unwrap();
        rustix::fs::mkfifoat(rustix::fs::CWD, at("fifo"), rustix::fs::Mode::RWXU).unwrap();
        let _listening = UnixListener::bind(at("socket")).unwrap();
        std::os::unix::fs::symlink("/dev/zero", at("device")).unwrap();
        std::os::unix::fs::symlink("nothing", at("dangling")).unwrap();
        fs::create_dir(at("folder")).unwrap();
        for name in ["fifo", "socket", "device", "dangling", "folder"] {
            assert!(read(&at(name), 9).is_err(), "{name}");
        }
        // The control.
        assert_eq!(read(&at("file"), 9).unwrap(), b"x");

        let put = |name: &str| {
            write(&at(name), |out| {
                out.write_all(b"y")
                    .map_err(|cause| Error::writing(&at(name), "write", &cause))
            })
        };
        for name in ["file", "fifo", "socket", "device", "dangling"] {
            put(name).unwrap();
            assert_eq!(read(&at(name), 9).unwrap(), b"y", "{name}");
            assert!(fs::symlink_metadata(at(name)).unwrap().is_file(), "{name}");
        }
        assert!(put("folder").is_err() && at("folder").is_dir());
    }

    #[test]
    fn what_depends_on_something_else_has_another_path() {
        let folder = tempfile::tempdir().unwrap();
        let cache = CacheFolder::in_folder(folder.path(), "thing").unwrap();
        let of = |text: &str| cache.path(blake3::Hasher::new().update(text.as_bytes()));
        assert_eq!(of("one"), of("one"));
        assert_ne!(of("one"), of("two"));
    }
}
