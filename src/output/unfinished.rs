//! Files that are being written: hidden, beside their final names, and removed when their writer ends.
//!
//! A writer holds a lock on its file. What is not locked was left by a process that was killed, and is
//! removed by the next one that writes into the folder. Locks may not reach from one machine of a
//! cluster to another: so a file names the machine that made it, and another machine's is left alone
//! for a day.

use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tempfile::TempPath;

const PREFIX: &str = ".unfinished-";

/// The age at which a file that another machine left is removed.
const ABANDONED: Duration = Duration::from_secs(24 * 3600);

/// A file that takes its name when it is whole, and is removed when it is dropped before.
pub(super) struct Unfinished(Option<TempPath>);

/// The unfinished files of this process, and the folders that it has cleared of what others left.
#[derive(Default)]
struct Known {
    live: BTreeSet<PathBuf>,
    swept: BTreeSet<PathBuf>,
}

static KNOWN: LazyLock<Mutex<Known>> = LazyLock::new(Mutex::default);

fn known() -> MutexGuard<'static, Known> {
    KNOWN.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Unfinished {
    /// Makes one in a folder, which is cleared of what killed processes left, once.
    pub(super) fn in_folder(folder: &Path) -> io::Result<(File, Self)> {
        /// Another process may take a file that is not locked yet for one that was left.
        const TRIES: u32 = 16;
        if known().swept.insert(folder.to_owned()) {
            sweep(folder, &machine());
        }
        let prefix = format!("{PREFIX}{}-", machine());
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        for _ in 0..TRIES {
            let (file, path) = builder.tempfile_in(folder)?.into_parts();
            let taken = matches!(file.try_lock(), Err(TryLockError::WouldBlock));
            if !taken && fs::symlink_metadata(&path).is_ok() {
                known().live.insert(path.to_path_buf());
                return Ok((file, Self(Some(path))));
            }
        }
        Err(io::Error::other(
            "another process removes the files that are made there",
        ))
    }

    /// Gives the file its name, in place of what had it.
    pub(super) fn persist(mut self, target: &Path) -> io::Result<()> {
        let Some(path) = self.0.take() else {
            return Ok(());
        };
        known().live.remove::<Path>(&path);
        path.persist(target).map_err(|refused| refused.error)
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if let Some(path) = &self.0 {
            known().live.remove::<Path>(path);
        }
    }
}

/// Removes the files of this process that are not finished: before it ends without returning.
pub fn forget_unfinished() {
    for path in std::mem::take(&mut known().live) {
        let _ = fs::remove_file(path);
    }
}

/// Removes what processes that have ended left in a folder, as far as that is possible.
fn sweep(folder: &Path, machine: &str) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries {
        let name = entry.file_name();
        let Some(maker) = name.to_str().and_then(maker) else {
            continue;
        };
        let age = || entry.metadata().ok()?.modified().ok()?.elapsed().ok();
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        let is_due = maker == machine || age().is_some_and(|age| age > ABANDONED);
        let is_free = |file: File| file.try_lock().is_ok();
        let open = || File::options().append(true).open(entry.path());
        if is_file && is_due && open().is_ok_and(is_free) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// The machine that a file of ours is of, by its name.
fn maker(name: &str) -> Option<&str> {
    let (maker, random) = name.strip_prefix(PREFIX)?.split_once('-')?;
    let is_plain = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric());
    (is_plain(maker) && is_plain(random)).then_some(maker)
}

/// A word for this machine among those that share a file system.
fn machine() -> String {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let name = name.or_else(|| std::env::var("COMPUTERNAME").ok());
    let hash = blake3::hash(name.unwrap_or_default().as_bytes());
    hash.to_hex()[..8].to_owned()
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

    use super::*;

    /// A file that a process left which has ended, so long ago.
    fn left(folder: &Path, name: &str, age: Duration) -> PathBuf {
        let path = folder.join(name);
        let file = File::create(&path).unwrap();
        file.set_modified(SystemTime::now() - age).unwrap();
        path
    }

    #[test]
    fn what_a_killed_process_left_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let (here, young) = (machine(), Duration::ZERO);
        let ours = left(folder, &format!(".unfinished-{here}-Ab3xYz"), young);
        let held = left(folder, &format!(".unfinished-{here}-held00"), young);
        let elsewhere = left(folder, ".unfinished-00000000-Ab3xYz", ABANDONED / 2);
        let long_ago = left(folder, ".unfinished-00000000-Ab3xYw", ABANDONED * 2);
        let own = left(folder, ".unfinished-notes", ABANDONED * 2);
        let named = left(folder, ".unfinished-my-notes.txt", ABANDONED * 2);
        let holder = File::open(&held).unwrap();
        holder.lock().unwrap();

        let (file, unfinished) = Unfinished::in_folder(folder).unwrap();
        let there = [&ours, &held, &elsewhere, &long_ago, &own, &named].map(|path| path.exists());
        assert_eq!(there, [false, true, true, false, true, true]);

        // A file that is being written is not removed by others; once it is dropped it no longer exists.
        let count = || fs::read_dir(folder).unwrap().count();
        sweep(folder, &here);
        assert_eq!(count(), 5);
        drop((file, unfinished));
        assert_eq!(count(), 4);
    }

    #[test]
    fn a_process_that_ends_at_once_takes_its_files_along() {
        let folder = tempfile::tempdir().unwrap();
        let (_file, unfinished) = Unfinished::in_folder(folder.path()).unwrap();
        let (_other, finished) = Unfinished::in_folder(folder.path()).unwrap();
        finished.persist(&folder.path().join("whole")).unwrap();
        let path = unfinished.0.as_ref().unwrap().to_path_buf();
        assert!(path.exists());
        // Only this test's own: others run beside it.
        assert!(known().live.contains(&path));
        fs::remove_file(&path).unwrap();
        let names: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
        assert_eq!(names.len(), 1);
        drop(unfinished);
        assert!(!known().live.contains(&path));
    }
}
