//! Files that can be made again, kept so that they need not be: each under a hash of everything that it
//! depends on, so that nothing stale is ever taken for the thing itself.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, BufWriter, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::error::{Error, Result};
use crate::input;
use crate::output::write_atomically;

/// Files that nobody asked for in so long are removed.
const KEPT: Duration = Duration::from_secs(30 * 24 * 3600);

/// A folder of kept files of one kind.
#[derive(Debug, Clone)]
pub struct Kept {
    folder: PathBuf,
    /// Of the kind's file names.
    extension: &'static str,
}

impl Kept {
    /// The folder is made where there is none. Files of this kind that nobody asked for in thirty days,
    /// such as those of programs that are no more, are removed from it, as far as they can be.
    ///
    /// # Errors
    /// The folder cannot be made.
    pub fn in_folder(folder: &Path, extension: &'static str) -> Result<Self> {
        std::fs::create_dir_all(folder)
            .map_err(|cause| Error::writing(folder, "make the folder", &cause))?;
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        for path in entries.map(|entry| entry.path()) {
            let asked = || path.metadata().ok()?.modified().ok()?.elapsed().ok();
            let is_ours = path.extension().is_some_and(|name| name == extension);
            if is_ours && asked().is_some_and(|age| age > KEPT) {
                let _ = std::fs::remove_file(path);
            }
        }
        Ok(Self {
            folder: folder.to_owned(),
            extension,
        })
    }

    /// Where the file is kept that depends on what was hashed.
    pub fn path(&self, hasher: &blake3::Hasher) -> PathBuf {
        let mut name = String::new();
        for byte in &hasher.finalize().as_bytes()[..16] {
            let _ = write!(name, "{byte:02x}");
        }
        self.folder.join(format!("{name}.{}", self.extension))
    }
}

/// Opens a kept file for reading. Only a regular file is one: a pipe, a device or a folder in its place
/// is never waited for.
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
            "this is no regular file",
        ))
    }
}

/// The bytes of a kept file, as [`open`] opens it; of a longer one the first `most`.
///
/// # Errors
/// Those of [`open`]; the disk failed.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Writes a kept file as [`write_atomically`] does, in place of whatever has its name; a folder stays, so
/// that nothing is kept there.
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

/// That files can be made in a folder that is there.
///
/// # Errors
/// They cannot, by its permissions or its file system's.
pub fn check_takes_files(folder: &Path) -> Result<()> {
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

/// Says of a kept file that it was asked for. Where that cannot be said it is made again one day.
pub fn asked_for(path: &Path) {
    let file = std::fs::File::options().append(true).open(path);
    let _ = file.and_then(|file| file.set_modified(SystemTime::now()));
}

/// Where programs of this system keep what can be made again (XDG Base Directory Specification).
pub fn users_folder() -> Option<PathBuf> {
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
    fn files_of_a_kind_that_nobody_asked_for_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str, age: Duration| {
            let path = folder.path().join(name);
            let file = std::fs::File::create(&path).unwrap();
            file.set_modified(SystemTime::now() - age).unwrap();
            path
        };
        let old = put("a.thing", KEPT * 2);
        let asked = put("b.thing", KEPT * 2);
        let young = put("c.thing", KEPT / 2);
        let others = put("d.other", KEPT * 2);
        asked_for(&asked);
        Kept::in_folder(folder.path(), "thing").unwrap();
        let there = [&old, &asked, &young, &others].map(|path| path.exists());
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
    fn what_depends_on_something_else_is_kept_elsewhere() {
        let folder = tempfile::tempdir().unwrap();
        let kept = Kept::in_folder(folder.path(), "thing").unwrap();
        let of = |text: &str| kept.path(blake3::Hasher::new().update(text.as_bytes()));
        assert_eq!(of("one"), of("one"));
        assert_ne!(of("one"), of("two"));
    }
}
