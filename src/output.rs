//! Writing a file whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

mod unfinished;

use unfinished::Unfinished;
pub use unfinished::forget_unfinished;

const BUFFER_BYTES: usize = 1 << 18;

/// Checks that [`write_atomically`] can write `path`, as far as that is possible without writing it: a
/// temporary file is made in its folder and dropped. Useful before hours of work.
///
/// # Errors
/// In the words of [`write_atomically`].
pub fn check_writable(path: &Path) -> Result<()> {
    match destination(path)? {
        Destination::Special => Ok(()),
        Destination::File { target, .. } => temporary_beside(path, &target).map(drop),
    }
}

/// Whether [`write_atomically`] would create a file at `path`, rather than write to a device or a pipe.
pub fn becomes_file(path: &Path) -> bool {
    std::fs::metadata(path).map_or(true, |there| there.is_file())
}

/// Checks that files can be written into a folder, or that the folder can be created if it does not
/// exist, as far as that is possible without creating it.
///
/// # Errors
/// What is there is no folder, or takes no files.
pub fn check_folder(path: &Path) -> Result<()> {
    let mut there = path;
    while !there.exists() {
        there = match there.parent() {
            Some(parent) if parent != Path::new("") => parent,
            _ => Path::new("."),
        };
    }
    check_writable(&there.join("file"))
}

/// Writes `path` by `fill`ing a temporary file in the same folder, which then takes its name: a
/// reader sees the old file or the whole new one, and a failure leaves nothing behind.
///
/// A new file gets the permissions that the umask gives, an old one keeps its own; a symbolic link
/// stays and its target is replaced. What is no regular file (a device, a pipe) cannot be replaced:
/// it receives the finished bytes, of which a reader that has closed its end wants no more.
///
/// What processes that were killed have left in the folder is removed.
///
/// # Errors
/// Those of `fill`; a folder that is missing, no folder, or not writable; `path` being a folder; a
/// full disk. All but those of `fill` name `path`.
pub fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> Result<()>,
) -> Result<()> {
    match destination(path)? {
        Destination::Special => pour(path, fill),
        Destination::File {
            target,
            permissions,
        } => replace(path, &target, permissions, fill),
    }
}

/// Writes bytes that are there already, as [`write_atomically`] does.
///
/// # Errors
/// Those of [`write_atomically`].
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<()> {
    write_atomically(path, |out| {
        out.write_all(bytes)
            .map_err(|cause| Error::writing(path, "write", &cause))
    })
}

/// Where the bytes for a path go.
enum Destination {
    /// A device or a pipe.
    Special,
    /// Behind symbolic links; with the permissions of the file that is there, if one is.
    File {
        target: PathBuf,
        permissions: Option<fs::Permissions>,
    },
}

fn destination(path: &Path) -> Result<Destination> {
    let refused = |why: &str| Error::resource(format!("{}: cannot write: {why}", path.display()));
    let is_folder = || refused("this is a folder").hint("name a file in it");
    if path.as_os_str().as_encoded_bytes().ends_with(b"/") {
        return Err(is_folder());
    }
    match fs::metadata(path) {
        Ok(old) if old.is_dir() => Err(is_folder()),
        Ok(old) if !old.is_file() => Ok(Destination::Special),
        Ok(old) => Ok(Destination::File {
            target: match path.is_symlink() {
                true => fs::canonicalize(path).map_err(|cause| refused(&cause.to_string()))?,
                false => path.to_owned(),
            },
            permissions: Some(old.permissions()),
        }),
        Err(_) if path.is_symlink() => Err(refused(
            "this is a symbolic link to a file that is not there",
        )
        .hint("remove the link, or name its target")),
        Err(cause) if cause.kind() == io::ErrorKind::InvalidFilename => {
            Err(refused("its name is too long"))
        }
        Err(_) => Ok(Destination::File {
            target: path.to_owned(),
            permissions: None,
        }),
    }
}

fn replace(
    path: &Path,
    target: &Path,
    permissions: Option<fs::Permissions>,
    fill: impl FnOnce(&mut BufWriter<File>) -> Result<()>,
) -> Result<()> {
    let failed = |cause: io::Error| Error::writing(path, "write", &cause);
    let (file, unfinished) = temporary_beside(path, target)?;
    let file = filled(path, file, fill)?;
    if let Some(permissions) = permissions {
        file.set_permissions(permissions).map_err(failed)?;
    }
    // Some file systems report a full disk only when the data leaves the cache.
    file.sync_data().map_err(failed)?;
    // The lock is held until the file has its name.
    unfinished.persist(target).map_err(failed)
}

/// `fill`s an unnamed file first, since `fill` may seek, then copies it to `path`.
fn pour(path: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> Result<()>) -> Result<()> {
    let failed = |cause: io::Error| Error::writing(path, "write", &cause);
    let file = tempfile::tempfile().map_err(failed)?;
    let mut file = filled(path, file, fill)?;
    file.rewind().map_err(failed)?;
    let mut device = File::options().write(true).open(path).map_err(failed)?;
    match io::copy(&mut file, &mut device) {
        Err(cause) if cause.kind() != io::ErrorKind::BrokenPipe => Err(failed(cause)),
        _ => Ok(()),
    }
}

fn filled(
    path: &Path,
    file: File,
    fill: impl FnOnce(&mut BufWriter<File>) -> Result<()>,
) -> Result<File> {
    let mut writer = BufWriter::with_capacity(BUFFER_BYTES, file);
    fill(&mut writer)?;
    writer
        .into_inner()
        .map_err(|unflushed| Error::writing(path, "write", unflushed.error()))
}

fn temporary_beside(path: &Path, target: &Path) -> Result<(File, Unfinished)> {
    let folder = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    if target.file_name().is_none() {
        return Err(Error::resource(format!(
            "cannot write to '{}': it names no file",
            path.display()
        )));
    }
    Unfinished::in_folder(&folder).map_err(|cause| {
        let error = Error::resource(format!(
            "{}: cannot write: {}",
            path.display(),
            refusal(&folder, &cause)
        ));
        if cause.kind() == io::ErrorKind::NotFound && !folder.exists() {
            error.hint(format!("make it first: mkdir -p '{}'", folder.display()))
        } else {
            error
        }
    })
}

fn refusal(folder: &Path, cause: &io::Error) -> String {
    let folder_name = folder.display();
    match cause.kind() {
        io::ErrorKind::NotFound if !folder.exists() => {
            format!("the folder '{folder_name}' does not exist")
        }
        io::ErrorKind::NotFound => format!("the folder '{folder_name}' takes no files"),
        io::ErrorKind::NotADirectory => format!("'{folder_name}' is not a folder"),
        io::ErrorKind::PermissionDenied => {
            format!("no permission to make files in '{folder_name}'")
        }
        io::ErrorKind::ReadOnlyFilesystem => format!("'{folder_name}' is read-only"),
        kind => format!("{kind} (folder '{folder_name}')"),
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Write};

    use super::*;

    fn write_text(path: &Path, text: &str) -> Result<()> {
        write_atomically(path, |out| {
            out.write_all(text.as_bytes())
                .map_err(|e| Error::writing(path, "write", &e))
        })
    }

    fn names_in(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_appears_whole_and_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_text(&path, "one").unwrap();
        write_text(&path, "two").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "two");
        assert_eq!(names_in(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_text(&path, "old").unwrap();
        for target in [path.clone(), folder.path().join("new.txt")] {
            let error = write_atomically(&target, |out| {
                out.write_all(&vec![7; 3 * BUFFER_BYTES]).unwrap();
                Err(Error::resource("the source ended"))
            })
            .unwrap_err();
            assert_eq!(error.to_string(), "the source ended");
        }
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names_in(folder.path()), ["a.txt"]);
    }

    #[test]
    fn impossible_places_are_named_in_one_sentence() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        fs::write(root.join("file"), "x").unwrap();
        fs::create_dir(root.join("sub")).unwrap();
        let cases = [
            (root.join("missing/a.txt"), "does not exist"),
            (root.join("file/a.txt"), "is not a folder"),
            (root.join("sub"), "this is a folder"),
            (root.join(".."), "this is a folder"),
            (root.join("new/"), "this is a folder"),
            (root.join("n".repeat(300)), "too long"),
            (PathBuf::new(), "names no file"),
        ];
        for (path, cause) in cases {
            let error = write_text(&path, "x").unwrap_err();
            let message = error.to_string();
            assert!(message.contains(cause), "{message}");
            assert!(message.contains(path.to_str().unwrap()), "{message}");
            assert!(!message.contains('\n'), "{message}");
            assert_eq!(error.exit_code(), 74);
            assert_eq!(check_writable(&path).unwrap_err(), error);
        }
        // The control: elsewhere the check passes, and leaves nothing.
        check_writable(&root.join("file")).unwrap();
        check_writable(&root.join("sub/a.txt")).unwrap();
        assert_eq!(names_in(root), ["file", "sub"]);
        assert!(names_in(&root.join("sub")).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn a_new_file_has_the_permissions_any_program_gives() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        let (plain, ours) = (folder.path().join("plain"), folder.path().join("ours"));
        File::create(&plain).unwrap();
        write_text(&ours, "x").unwrap();
        assert_eq!(mode(&ours), mode(&plain));
        let temporary = tempfile::NamedTempFile::new_in(folder.path()).unwrap();
        if mode(&plain) & 0o777 != 0o600 {
            assert_ne!(mode(&ours), mode(temporary.path()));
        }

        fs::set_permissions(&ours, fs::Permissions::from_mode(0o640)).unwrap();
        write_text(&ours, "y").unwrap();
        assert_eq!(mode(&ours) & 0o777, 0o640);
    }

    #[cfg(unix)]
    #[test]
    fn a_symbolic_link_stays_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        write_text(&real, "old").unwrap();
        std::os::unix::fs::symlink("real", &link).unwrap();
        write_text(&link, "new").unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read_to_string(&real).unwrap(), "new");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_that_takes_no_files_is_not_called_missing() {
        let refusal = |path: &str| check_writable(Path::new(path)).unwrap_err();
        let proc = refusal("/proc/a.png");
        assert!(proc.to_string().contains("takes no files"), "{proc}");
        assert_eq!(proc.hint_text(), None);
        // The control.
        let missing = refusal("/proc/none/a.png");
        assert!(missing.to_string().contains("does not exist"), "{missing}");
        assert!(missing.hint_text().is_some());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_receive_the_bytes_and_are_not_replaced() {
        use std::os::unix::fs::FileTypeExt;
        write_text(Path::new("/dev/null"), "x").unwrap();
        let full = Path::new("/dev/full");
        let message = write_text(full, "x").unwrap_err().to_string();
        assert!(
            message.starts_with("/dev/full: cannot write: "),
            "{message}"
        );
        for device in [Path::new("/dev/null"), full] {
            assert!(fs::metadata(device).unwrap().file_type().is_char_device());
        }
        let mut byte = [0];
        assert_eq!(File::open("/dev/null").unwrap().read(&mut byte).unwrap(), 0);
    }
}
