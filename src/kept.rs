//! Files that can be made again, kept so that they need not be: each under a hash of everything that it
//! depends on, so that nothing stale is ever taken for the thing itself.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::error::{Error, Result};

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

    #[test]
    fn what_depends_on_something_else_is_kept_elsewhere() {
        let folder = tempfile::tempdir().unwrap();
        let kept = Kept::in_folder(folder.path(), "thing").unwrap();
        let of = |text: &str| kept.path(blake3::Hasher::new().update(text.as_bytes()));
        assert_eq!(of("one"), of("one"));
        assert_ne!(of("one"), of("two"));
    }
}
