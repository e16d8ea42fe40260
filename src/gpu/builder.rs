//! Kernels built in processes of their own: the program itself, started anew.
//!
//! A driver that aborts, or has to stop, ends such a process and no other. It takes a [`Request`] after
//! another, a line each, from its standard input, which stays open for as long as it is wanted, and leaves
//! each answer in a file.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::error::{Error, ErrorKind, Result};
use crate::stop;

use super::arranged::{Arranged, POCL_FOLDER};
use super::binary;
use super::device_info::DeviceInfo;

/// The first argument of a builder; the second is its folder.
pub(super) const ARGUMENT: &str = "--build-kernels";

/// The folder where the driver of a builder caches what it builds.
const DRIVERS: &str = "driver";

/// The file of what the driver of a builder prints.
const MESSAGES: &str = "messages";

/// The time between two looks for a builder's answer.
const POLL: Duration = Duration::from_millis(5);

/// The most characters that are shown of what a driver printed before it ended.
const LAST_WORDS: usize = 400;

/// A kernel to be built.
#[derive(Debug, Serialize, Deserialize)]
pub struct Request {
    /// The place of the device in the list, and what is there.
    pub device: usize,
    /// The properties of that device ([`identity`]): another one may have its place by now.
    pub identity: [String; 4],
    /// The kernel's file for messages: `kernels/<path>`.
    pub path: String,
    /// The flattened source in OpenCL C.
    pub source: String,
    /// The compiler's options.
    pub options: String,
    /// The kernel's name.
    pub kernel: String,
    /// Names and types of its arguments.
    pub signature: Vec<(String, String)>,
}

/// Properties that distinguish a device from another that has its place now.
pub fn identity(info: &DeviceInfo) -> [String; 4] {
    [&info.name, &info.platform, &info.driver, &info.version].map(Clone::clone)
}

/// The outcome of a request.
#[derive(Debug, PartialEq)]
pub enum Answer {
    /// The driver's binary.
    Built(Vec<u8>),
    /// The kernel must be built in this process: no other can build it here, or the driver gives no
    /// binaries.
    NotHere,
}

/// Builds kernels one after another, in a process that is started when it is first needed.
pub struct Builders<'a> {
    arranged: &'a Arranged,
    current: Option<Builder>,
}

impl<'a> Builders<'a> {
    /// Makes builders, of which none is started yet.
    pub fn new(arranged: &'a Arranged) -> Self {
        Self {
            arranged,
            current: None,
        }
    }

    /// Builds a kernel. Ends the process when it is time to stop, or `no_longer_wanted`.
    ///
    /// # Errors
    /// The kernel does not build; the driver ended the process; it is time to stop.
    pub fn build(&mut self, request: &Request, no_longer_wanted: &AtomicBool) -> Result<Answer> {
        let builder = match &mut self.current {
            Some(builder) => builder,
            none => match Builder::start(self.arranged) {
                Some(builder) => none.insert(builder),
                None => return Ok(Answer::NotHere),
            },
        };
        builder.build(request, no_longer_wanted)
    }
}

/// One process.
struct Builder {
    child: Child,
    folder: PathBuf,
    requests: u64,
}

impl Builder {
    /// Starts a process that builds kernels; `None` if none can be started.
    fn start(arranged: &Arranged) -> Option<Self> {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let folder = arranged.folder().ok()?.join(format!("builder-{number}"));
        let drivers = folder.join(DRIVERS);
        fs::create_dir_all(&drivers).ok()?;
        // The running program, whatever has its path by now.
        let program = match Path::new("/proc/self/exe") {
            own if own.exists() => own.to_owned(),
            _ => std::env::current_exe().ok()?,
        };
        let mut command = Command::new(program);
        command
            .arg(ARGUMENT)
            .arg(&folder)
            .env(POCL_FOLDER, &drivers)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(File::create(folder.join(MESSAGES)).ok()?);
        // Ctrl-C is for this process, which ends its builders.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        Some(Self {
            child: command.spawn().ok()?,
            folder,
            requests: 0,
        })
    }

    fn build(&mut self, request: &Request, no_longer_wanted: &AtomicBool) -> Result<Answer> {
        let failed = |cause: &dyn std::fmt::Display| {
            Error::resource(format!("a process that builds kernels failed: {cause}"))
        };
        let answer = answer_file(&self.folder, self.requests);
        self.requests += 1;
        let mut line = serde_json::to_vec(request).map_err(|cause| failed(&cause))?;
        line.push(b'\n');
        if let Some(stdin) = &mut self.child.stdin {
            // A process that has ended is noticed below.
            let _ = stdin.write_all(&line);
        }
        loop {
            if let Ok(bytes) = fs::read(&answer) {
                let _ = fs::remove_file(&answer);
                return unpacked(&bytes);
            }
            if let Some(status) = self.child.try_wait().map_err(|cause| failed(&cause))? {
                return Err(self.failure(request, status));
            }
            if stop::requested() || no_longer_wanted.load(Ordering::Relaxed) {
                return Err(Error::stopped("stopped while kernels were built"));
            }
            std::thread::sleep(POLL);
        }
    }

    /// How the driver ended this process, and its last words.
    fn failure(&self, request: &Request, status: ExitStatus) -> Error {
        let [device, ..] = &request.identity;
        let words = last_words(&self.folder.join(MESSAGES));
        let colon = if words.is_empty() { "" } else { ": " };
        let error = Error::resource(format!(
            "the driver of '{device}' failed while it built kernels/{} ({}){colon}{words}",
            request.path,
            how_ended(status)
        ));
        if words.contains("\"ld\"") {
            error.hint("PoCL needs the linker 'ld': install binutils, or add its folder to PATH")
        } else {
            error.hint("choose another --device; '--device reference' needs no driver")
        }
    }
}

impl Drop for Builder {
    fn drop(&mut self) {
        // With what it started, such as linkers. A process that was waited for has no number any more.
        #[cfg(unix)]
        if matches!(self.child.try_wait(), Ok(None)) {
            let group = -libc::pid_t::from_ne_bytes(self.child.id().to_ne_bytes());
            // SAFETY: sends a signal.
            unsafe { libc::kill(group, libc::SIGKILL) };
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = fs::remove_dir_all(&self.folder);
    }
}

pub(super) fn answer_file(folder: &Path, number: u64) -> PathBuf {
    folder.join(format!("{number}.answer"))
}

/// An answer as bytes: an exit code, then an error's message, or a packed binary where there is one.
pub(super) fn packed(answer: Result<Option<Vec<u8>>>) -> Vec<u8> {
    match answer {
        Ok(binary) => [&[0], &binary.unwrap_or_default()[..]].concat(),
        Err(error) => [&[error.exit_code()], error.to_string().as_bytes()].concat(),
    }
}

/// The answer that [`packed`] made bytes of.
fn unpacked(bytes: &[u8]) -> Result<Answer> {
    let (code, rest) = bytes.split_first().unwrap_or((&0, &[]));
    match ErrorKind::of_exit_code(i32::from(*code)) {
        None => Ok(binary::unpacked(rest)
            .map_or(Answer::NotHere, |binary| Answer::Built(binary.to_owned()))),
        // Another device has its place now.
        Some(ErrorKind::NoDevice) => Ok(Answer::NotHere),
        Some(kind) => Err(Error::new(kind, String::from_utf8_lossy(rest))),
    }
}

fn how_ended(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        let name = signal_hook::low_level::signal_name(signal);
        return name.map_or_else(|| format!("signal {signal}"), str::to_owned);
    }
    status.to_string()
}

/// The end of what was printed, in one line.
fn last_words(messages: &Path) -> String {
    let text = fs::read(messages).unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let line: String = lines.collect::<Vec<_>>().join("; ");
    let line: String = (line.chars())
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    let before = line.chars().count().saturating_sub(LAST_WORDS);
    let end: String = line.chars().skip(before).collect();
    if before > 0 { format!("…{end}") } else { end }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_is_what_was_packed() {
        let binary = binary::packed(b"code");
        let built = unpacked(&packed(Ok(Some(binary.clone()))));
        assert_eq!(built, Ok(Answer::Built(b"code".to_vec())));
        assert_eq!(unpacked(&packed(Ok(None))), Ok(Answer::NotHere));
        for error in [
            Error::resource("it does not build"),
            Error::failed("'a' is 'b'"),
        ] {
            assert_eq!(unpacked(&packed(Err(error.clone()))), Err(error));
        }
        let elsewhere = packed(Err(Error::no_device("another")));
        assert_eq!(unpacked(&elsewhere), Ok(Answer::NotHere));
        // A damaged binary is not taken.
        let mut damaged = packed(Ok(Some(binary)));
        *damaged.last_mut().unwrap() ^= 1;
        assert_eq!(unpacked(&damaged), Ok(Answer::NotHere));
    }

    #[test]
    fn the_last_words_are_one_short_line() {
        let folder = tempfile::tempdir().unwrap();
        let messages = folder.path().join(MESSAGES);
        assert_eq!(last_words(&messages), "");
        fs::write(&messages, "a warning\n\n  error: no \u{1b}[1mld\n").unwrap();
        assert_eq!(last_words(&messages), "a warning; error: no  [1mld");
        fs::write(&messages, [&[b'x'; 5000][..], b"\nthe end\n"].concat()).unwrap();
        let words = last_words(&messages);
        assert!(
            words.starts_with('…') && words.ends_with("x; the end"),
            "{words}"
        );
        assert_eq!(words.chars().count(), LAST_WORDS + 1);
    }

    #[cfg(unix)]
    #[test]
    fn how_a_process_ended_is_named() {
        use std::os::unix::process::ExitStatusExt;
        assert_eq!(how_ended(ExitStatus::from_raw(6)), "SIGABRT");
        assert_eq!(how_ended(ExitStatus::from_raw(1 << 8)), "exit status: 1");
    }
}
