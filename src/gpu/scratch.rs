//! A folder of this process alone, for what a driver writes while it builds.
//!
//! PoCL offers no device without a folder, loads what it finds in it without a check, and aborts where that
//! is damaged. So each process gives it an empty one. What is cached from run to run is ours
//! ([`super::binary`]), and verified.

use std::fs::{self, File};
use std::hash::{BuildHasher, RandomState};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use crate::cache;

/// The start of such folders' names.
const PREFIX: &str = "angioray-driver-";

/// A file in each, locked for as long as its process lives.
const HELD: &str = "held";

/// A folder without a lock is being made, unless it is older.
const BEING_MADE: Duration = Duration::from_secs(3600);

/// The room in bytes that a place must have.
const MIN_ROOM: u64 = 64 << 20;

/// One folder, made when it is first needed, removed by [`Scratch::remove`].
#[derive(Debug)]
pub struct Scratch {
    path: PathBuf,
    held: Mutex<Option<File>>,
}

impl Scratch {
    /// A folder in the first place where files can be made, and loaded as programs; it is not made yet.
    /// Nothing where there is no such place.
    pub fn choose() -> Option<Self> {
        let named = |name| std::env::var_os(name).map(PathBuf::from);
        // Where the user says; else in memory first, since PoCL waits for the disk after each file.
        let places = [
            named("TMPDIR"),
            named("XDG_RUNTIME_DIR"),
            Some("/dev/shm".into()),
            Some(std::env::temp_dir()),
            cache::user_folder(),
            Some("/var/tmp".into()),
        ];
        let mut places = places.into_iter().flatten();
        places
            .find(|place| is_fit(place))
            .map(|place| Self::below(&place))
    }

    /// A folder below `place`, with an unpredictable name.
    fn below(place: &Path) -> Self {
        let [a, b] = [(); 2].map(|()| RandomState::new().hash_one(std::process::id()));
        Self {
            path: place.join(format!("{PREFIX}{a:016x}{b:016x}")),
            held: Mutex::new(None),
        }
    }

    /// The folder's path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Makes the folder, for this user alone, unless it is made; then removes beside it what processes left
    /// that have ended.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn make(&self) -> io::Result<()> {
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        if held.is_some() {
            return Ok(());
        }
        let mut builder = fs::DirBuilder::new();
        #[cfg(unix)]
        std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
        builder.create(&self.path)?;
        let lock = File::create_new(self.path.join(HELD))?;
        // A file system without locks: the folder is removed at the end all the same.
        let _ = lock.try_lock();
        *held = Some(lock);
        self.sweep();
        Ok(())
    }

    /// Removes the folder, if it was made.
    pub fn remove(&self) {
        let held = self
            .held
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        if held.is_some() {
            let _ = fs::remove_dir_all(&self.path);
        }
    }

    /// Removes folders like this one whose processes have ended, as far as that is possible.
    fn sweep(&self) {
        let Some(place) = self.path.parent() else {
            return;
        };
        for entry in fs::read_dir(place).into_iter().flatten().flatten() {
            let is_like = entry
                .file_name()
                .as_encoded_bytes()
                .starts_with(PREFIX.as_bytes());
            if is_like && entry.path() != self.path && self.is_left(&entry.path()) {
                let _ = fs::remove_dir_all(entry.path());
            }
        }
    }

    /// Whether a folder belonged to a process of this user that no longer runs.
    fn is_left(&self, folder: &Path) -> bool {
        let (Ok(there), Ok(own)) = (folder.symlink_metadata(), self.path.symlink_metadata()) else {
            return false;
        };
        if !there.is_dir() || !same_owner(&there, &own) {
            return false;
        }
        match cache::open(&folder.join(HELD)) {
            Ok(lock) => lock.try_lock().is_ok(),
            Err(_) => {
                let age = there.modified().ok().and_then(|made| made.elapsed().ok());
                age.is_some_and(|age| age > BEING_MADE)
            }
        }
    }
}

#[cfg(unix)]
fn same_owner(a: &fs::Metadata, b: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    a.uid() == b.uid()
}

#[cfg(not(unix))]
fn same_owner(_: &fs::Metadata, _: &fs::Metadata) -> bool {
    true
}

/// Whether files can be created in a folder and loaded as programs, which some mounts forbid, and there
/// is enough space.
fn is_fit(place: &Path) -> bool {
    #[cfg(unix)]
    {
        use rustix::fs::{StatVfs, StatVfsMountFlags, statvfs};
        let is_fit = |mount: StatVfs| {
            !mount.f_flag.contains(StatVfsMountFlags::NOEXEC)
                && mount.f_bavail.saturating_mul(mount.f_frsize) >= MIN_ROOM
        };
        if !statvfs(place).is_ok_and(is_fit) {
            return false;
        }
    }
    place.is_absolute() && place.is_dir() && cache::check_writable(place).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made_below(place: &Path) -> Scratch {
        let scratch = Scratch::below(place);
        scratch.make().unwrap();
        scratch
    }

    #[test]
    fn a_folder_is_removed_with_what_is_in_it() {
        let place = tempfile::tempdir().unwrap();
        let scratch = made_below(place.path());
        scratch.make().unwrap();
        fs::create_dir(scratch.path().join("sub")).unwrap();
        fs::write(scratch.path().join("sub/file"), "x").unwrap();
        scratch.remove();
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 0);
        // One that was never made leaves nothing.
        Scratch::below(place.path()).remove();
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 0);
    }

    #[cfg(unix)]
    #[test]
    fn what_a_dead_process_left_is_removed_and_nothing_else() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        let living = made_below(place.path());
        assert_eq!(
            living.path().metadata().unwrap().permissions().mode() & 0o777,
            0o700
        );
        // Its lock went with its process.
        let dead = at("angioray-driver-dead");
        fs::create_dir(&dead).unwrap();
        fs::write(dead.join(HELD), "").unwrap();
        fs::write(dead.join("file"), "x").unwrap();
        // One that is being made; someone else's folder; a link to one.
        fs::create_dir(at("angioray-driver-new")).unwrap();
        fs::create_dir(at("else")).unwrap();
        fs::write(at("else").join(HELD), "").unwrap();
        symlink(at("else"), at("angioray-driver-link")).unwrap();

        let next = made_below(place.path());
        assert!(!dead.exists());
        for stays in [
            living.path(),
            next.path(),
            &at("angioray-driver-new"),
            &at("else").join(HELD),
        ] {
            assert!(stays.exists(), "{}", stays.display());
        }
        assert!(at("angioray-driver-link").is_symlink());
    }

    #[test]
    fn a_place_is_fit_where_files_can_be_made() {
        let place = tempfile::tempdir().unwrap();
        assert!(is_fit(place.path()));
        fs::write(place.path().join("file"), "").unwrap();
        for unfit in [
            place.path().join("file"),
            place.path().join("none"),
            PathBuf::from("."),
        ] {
            assert!(!is_fit(&unfit), "{}", unfit.display());
        }
        if cfg!(target_os = "linux") {
            assert!(!is_fit(Path::new("/proc")));
        }
    }
}
