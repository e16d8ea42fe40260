//! A peer's process: lines to it, lines from it, and never a wait without end.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender, TryRecvError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use serde_json::{Map, Value};

use crate::error::{Error, Result};

/// The longest line of a peer that is read.
const LONGEST_LINE_BYTES: u64 = 1 << 16;
/// How long a peer may take to end once it is requested to, or has closed its output.
const FAREWELL: Duration = Duration::from_secs(2);
/// The most characters of a peer's output that an error quotes.
const QUOTED_CHARS: usize = 200;

/// A running peer. Threads of its own read and write, so that neither a silent peer nor one that
/// does not listen can hold up the caller.
pub(super) struct Process {
    /// The peer's name in error messages.
    name: String,
    child: Child,
    /// `None` once nothing more is to be said.
    requests: Option<Sender<String>>,
    replies: Receiver<String>,
    complaints: Complaints,
    patience: Duration,
    /// Why there are no more answers, once that is so.
    over: Option<Error>,
}

impl Process {
    /// Starts `command`, written as for a POSIX shell.
    ///
    /// # Errors
    /// Usage: no command. Failed: it cannot be started.
    pub fn start(command: &str, patience: Duration) -> Result<Self> {
        let words = shlex::split(command).filter(|words| !words.is_empty());
        let Some(words) = words else {
            return Err(Error::usage(format!(
                "the peer '{command}' is not a command: give a program and its arguments, quoted as in a shell"
            )));
        };
        let name = format!("the peer '{command}'");
        let mut child = Command::new(&words[0])
            .args(&words[1..])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|cause| Error::failed(format!("{name} cannot be started: {cause}")))?;
        let (Some(stdin), Some(stdout), Some(stderr)) =
            (child.stdin.take(), child.stdout.take(), child.stderr.take())
        else {
            return Err(Error::failed(format!("{name} has no pipes")));
        };
        Ok(Self {
            name,
            child,
            requests: Some(spawn_writer(stdin)),
            replies: spawn_reader(stdout),
            complaints: Complaints::of(stderr),
            patience,
            over: None,
        })
    }

    /// Changes the peer's name in error messages.
    pub fn rename(&mut self, name: String) {
        self.name = name;
    }

    /// An error of this peer.
    pub fn failed(&self, what: &str) -> Error {
        Error::failed(format!("{} {what}", self.name))
    }

    /// The next object that the peer says, after `request` if there is one; `doing` is what it is
    /// to do then ("render").
    ///
    /// # Errors
    /// It ends, stays silent longer than it may, or says anything but one JSON object on a line:
    /// then it is stopped, and every later answer is the same error. It answers `{"error": why}`:
    /// then another request may be sent.
    pub fn answer(&mut self, request: Option<String>, doing: &str) -> Result<Map<String, Value>> {
        if let Some(error) = &self.over {
            return Err(error.clone());
        }
        let object = self.exchange(request, doing).inspect_err(|error| {
            self.over = Some(error.clone());
        });
        if self.over.is_some() {
            self.stop();
        }
        let object = object?;
        match object.get("error") {
            None => Ok(object),
            Some(why) => {
                let why = why.as_str().map_or(why.to_string(), str::to_owned);
                Err(self.failed(&format!("cannot {doing}: {}", quotable(&why))))
            }
        }
    }

    fn exchange(&mut self, request: Option<String>, doing: &str) -> Result<Map<String, Value>> {
        if let Some(request) = request {
            match self.replies.try_recv() {
                Ok(line) => {
                    return Err(
                        self.failed(&format!("sent '{}' without a request", quotable(&line)))
                    );
                }
                Err(TryRecvError::Disconnected) => return Err(self.ended(doing)),
                Err(TryRecvError::Empty) => {}
            }
            // A writer that has ended has found a closed pipe: the answer says so.
            if let Some(requests) = &self.requests {
                let _ = requests.send(request);
            }
        }
        let line = match self.replies.recv_timeout(self.patience) {
            Ok(line) => line,
            Err(RecvTimeoutError::Disconnected) => return Err(self.ended(doing)),
            Err(RecvTimeoutError::Timeout) => {
                return Err(self.failed(&format!(
                    "was to {doing} and has not answered for {} s",
                    self.patience.as_secs_f64()
                )));
            }
        };
        serde_json::from_str(&line).map_err(|_| {
            self.failed(&format!(
                "was to {doing} and answered '{}', which is not a JSON object",
                quotable(&line)
            ))
        })
    }

    /// The error of a peer that closed its output: how it ended, and its last message.
    fn ended(&mut self, doing: &str) -> Error {
        let how = match self.wait(FAREWELL) {
            Some(status) => format!("ended ({status})"),
            None => "closed its output".to_owned(),
        };
        let last = match self.complaints.last() {
            Some(line) => format!(": {}", quotable(&line)),
            None => String::new(),
        };
        self.failed(&format!("{how} where it was to {doing}{last}"))
    }

    /// Waits for the peer's exit status, for `time` at most.
    fn wait(&mut self, time: Duration) -> Option<std::process::ExitStatus> {
        let start = Instant::now();
        loop {
            match self.child.try_wait() {
                Ok(Some(status)) => return Some(status),
                Ok(None) if start.elapsed() < time => thread::sleep(Duration::from_millis(5)),
                _ => return None,
            }
        }
    }

    /// Ends the peer now.
    fn stop(&mut self) {
        self.requests = None;
        // It may have ended already, which is as good.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Process {
    /// Closes the peer's input; a peer that does not end then is killed.
    fn drop(&mut self) {
        self.requests = None;
        if self.over.is_none() {
            self.wait(FAREWELL);
        }
        self.stop();
    }
}

/// Writes lines until there are no more, or the reader has closed its end.
fn spawn_writer(mut stdin: ChildStdin) -> Sender<String> {
    let (sender, lines) = mpsc::channel::<String>();
    thread::spawn(move || {
        for line in lines {
            if writeln!(stdin, "{line}")
                .and_then(|()| stdin.flush())
                .is_err()
            {
                return;
            }
        }
    });
    sender
}

/// Reads lines until the output ends, a line is too long, or the receiver is dropped. What is not UTF-8
/// is replaced.
fn spawn_reader(stdout: ChildStdout) -> Receiver<String> {
    // A peer that talks without end is held up by the pipe, not by the memory.
    let (sender, replies) = mpsc::sync_channel(16);
    thread::spawn(move || {
        let mut lines = BufReader::new(stdout);
        while let Some(line) = next_line(&mut lines) {
            let whole = line.len() < LONGEST_LINE_BYTES as usize;
            if sender.send(line).is_err() || !whole {
                return;
            }
        }
    });
    replies
}

/// The next line without its end, or as much of it as is read at most.
fn next_line(from: &mut impl BufRead) -> Option<String> {
    let mut bytes = Vec::new();
    from.take(LONGEST_LINE_BYTES)
        .read_until(b'\n', &mut bytes)
        .ok()
        .filter(|&read| read > 0)?;
    Some(String::from_utf8_lossy(&bytes).trim_end().to_owned())
}

/// The last line of a peer's standard error.
struct Complaints {
    last: Arc<Mutex<Option<String>>>,
    reader: JoinHandle<()>,
}

impl Complaints {
    fn of(stderr: ChildStderr) -> Self {
        let last = Arc::new(Mutex::new(None));
        let shared = Arc::clone(&last);
        let reader = thread::spawn(move || {
            let mut lines = BufReader::new(stderr);
            while let Some(line) = next_line(&mut lines) {
                if !line.is_empty() {
                    *shared.lock().unwrap_or_else(PoisonError::into_inner) = Some(line);
                }
            }
        });
        Self { last, reader }
    }

    /// The last line of a process that has ended: its own children may still hold the pipe.
    fn last(&self) -> Option<String> {
        let start = Instant::now();
        while !self.reader.is_finished() && start.elapsed() < FAREWELL {
            thread::sleep(Duration::from_millis(5));
        }
        let last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        last.clone()
    }
}

/// The beginning of what a peer said, as much as an error quotes.
pub(super) fn quotable(text: &str) -> String {
    let mut quoted: String = text.chars().take(QUOTED_CHARS).collect();
    if text.chars().count() > QUOTED_CHARS {
        quoted.push('…');
    }
    quoted
}
