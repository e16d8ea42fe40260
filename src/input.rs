//! Files that are read as text, whatever they turn out to be: a device that never ends, a pipe that
//! that nothing writes to, a file that is not text.

use std::fs::{File, OpenOptions};
use std::io::{self, Read};
use std::path::Path;

use crate::error::{Error, Result};

/// The most bytes of a scene, a transfer function or any other text file: more is refused unread.
pub const LONGEST_TEXT: u64 = 1 << 20;

/// The text in the file; `doing` says what it is read for (`read the scene`).
///
/// # Errors
/// As [`bytes`]; it is not UTF-8.
pub fn text(path: &Path, doing: &str) -> Result<String> {
    String::from_utf8(bytes(path, doing)?).map_err(|_| {
        Error::input(format!(
            "{}: cannot {doing}: it is not text (UTF-8)",
            path.display()
        ))
    })
}

/// Reads a file's bytes, whatever they are; see [`text`].
///
/// # Errors
/// It cannot be read, or is longer than [`LONGEST_TEXT`]; a pipe that nothing writes to.
pub fn bytes(path: &Path, doing: &str) -> Result<Vec<u8>> {
    let failed = |cause: io::Error| Error::reading(path, doing, &cause);
    let refused = |why: String| Error::input(format!("{}: cannot {doing}: {why}", path.display()));
    let file = open(path).map_err(failed)?;
    let is_file = file.metadata().map_err(failed)?.is_file();
    let mut bytes = Vec::new();
    file.take(LONGEST_TEXT + 1)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    if bytes.len() as u64 > LONGEST_TEXT {
        return Err(refused(format!(
            "it is longer than {} KiB, the most that is read from a text file",
            LONGEST_TEXT >> 10
        )));
    }
    if bytes.is_empty() && !is_file {
        return Err(refused("it is empty, or nothing writes to it".into()));
    }
    Ok(bytes)
}

/// Opens a file for reading without waiting: a pipe that no process has opened for writing is at its end.
///
/// # Errors
/// Those of opening.
#[cfg(unix)]
pub fn open(path: &Path) -> io::Result<File> {
    use std::os::unix::fs::OpenOptionsExt;

    use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};

    let file = OpenOptions::new()
        .read(true)
        .custom_flags(OFlags::NONBLOCK.bits() as i32)
        .open(path)?;
    // Only opening must not wait: reading waits for what a writer has to say.
    fcntl_setfl(&file, fcntl_getfl(&file)? - OFlags::NONBLOCK)?;
    Ok(file)
}

/// Opens a file for reading.
///
/// # Errors
/// Those of opening.
#[cfg(not(unix))]
pub fn open(path: &Path) -> io::Result<File> {
    OpenOptions::new().read(true).open(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    #[test]
    fn texts_up_to_the_limit_are_read_and_longer_ones_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("long.toml");
        let mut long = "x".repeat(LONGEST_TEXT as usize);
        std::fs::write(&path, &long).unwrap();
        assert_eq!(text(&path, "read it"), Ok(long.clone()));
        long.push('x');
        std::fs::write(&path, &long).unwrap();
        let refused = text(&path, "read it").unwrap_err();
        assert_eq!(refused.kind(), ErrorKind::Input);
        assert!(refused.to_string().contains("1024 KiB"), "{refused}");
        std::fs::write(&path, b"\xff\xfe").unwrap();
        let refused = text(&path, "read it").unwrap_err();
        assert!(refused.to_string().contains("UTF-8"), "{refused}");
        std::fs::write(&path, "").unwrap();
        assert_eq!(text(&path, "read it"), Ok(String::new()));
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_idle_pipes_are_refused_and_pipes_with_a_writer_read() {
        let endless = text(Path::new("/dev/zero"), "read it").unwrap_err();
        assert!(endless.to_string().contains("KiB"), "{endless}");
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        let idle = text(&pipe, "read it").unwrap_err();
        assert_eq!(idle.kind(), ErrorKind::Input);
        // A pipe with a writer is waited for, as that of a shell's substitution.
        let (reader, mut writer) = io::pipe().unwrap();
        let path = format!("/dev/fd/{}", std::os::fd::AsRawFd::as_raw_fd(&reader));
        let writing = std::thread::spawn(move || {
            std::thread::sleep(std::time::Duration::from_millis(20));
            io::Write::write_all(&mut writer, b"mode = 'iso'").unwrap();
        });
        assert_eq!(text(Path::new(&path), "read it").unwrap(), "mode = 'iso'");
        writing.join().unwrap();
    }
}
