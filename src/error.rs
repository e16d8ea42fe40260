//! The one error type: a sentence for the user, an optional hint, and the exit code it leads to.

use std::fmt;
use std::io;
use std::path::Path;

/// The result of anything that can fail with an [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// Whose fault it is; decides the process's exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKind {
    /// The job failed for a reason that has no code of its own, or some of a batch did. Exit code 1.
    Failed,
    /// The request makes no sense: flags, scene file, values out of their domain. Exit code 2.
    Usage,
    /// No usable OpenCL device. Exit code 3.
    NoDevice,
    /// An input is unusable or not there: trying again is useless. Exit code 65 (`EX_DATAERR` of
    /// sysexits.h).
    Input,
    /// An output, the device, the disk or memory failed: trying again may help. Exit code 74
    /// (`EX_IOERR`).
    Resource,
    /// Asked to stop before the end; what is done is whole, and the rest can be done later. Exit
    /// code 75.
    Stopped,
}

impl ErrorKind {
    /// The process's exit code (1 failed, 2 usage, 3 no device, 65 input, 74 resource, 75 stopped early).
    pub fn exit_code(self) -> u8 {
        match self {
            Self::Failed => 1,
            Self::Usage => 2,
            Self::NoDevice => 3,
            Self::Input => 65,
            Self::Resource => 74,
            Self::Stopped => 75,
        }
    }

    /// The kind that leads to this exit code, if one does.
    pub fn of_exit_code(code: i32) -> Option<Self> {
        use ErrorKind::*;
        let kinds = [Failed, Usage, NoDevice, Input, Resource, Stopped];
        kinds
            .into_iter()
            .find(|kind| i32::from(kind.exit_code()) == code)
    }
}

/// One clear sentence about what is wrong and where, with a hint where we know a cure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    kind: ErrorKind,
    message: String,
    hint: Option<String>,
}

impl Error {
    /// The job failed (exit code 1).
    pub fn failed(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Failed, message)
    }

    /// Wrong usage (exit code 2).
    pub fn usage(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Usage, message)
    }

    /// No usable OpenCL device (exit code 3).
    pub fn no_device(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::NoDevice, message)
    }

    /// An input is unusable or not there (exit code 65).
    pub fn input(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Input, message)
    }

    /// An output, the device, the disk or memory failed (exit code 74).
    pub fn resource(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Resource, message)
    }

    /// Stopped early, can be resumed (exit code 75).
    pub fn stopped(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Stopped, message)
    }

    /// An error of this kind.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self {
            kind,
            message: message.into(),
            hint: None,
        }
    }

    /// A failed read of the input `path`; `doing` says of what (`read the scene`). An input that is not
    /// there, or may not be read, is [`ErrorKind::Input`]; a disk or network that failed meanwhile is
    /// [`ErrorKind::Resource`].
    pub fn reading(path: &Path, doing: &str, cause: &io::Error) -> Self {
        use io::ErrorKind::*;
        let kind = match cause.kind() {
            NotFound | PermissionDenied | IsADirectory | NotADirectory | InvalidData
            | InvalidInput | InvalidFilename | UnexpectedEof | Unsupported => ErrorKind::Input,
            _ => ErrorKind::Resource,
        };
        Self::new(kind, format!("{}: cannot {doing}: {cause}", path.display()))
    }

    /// A failed write of `path`, or of what is stored there; `doing` says of what (`make the folder`).
    pub fn writing(path: &Path, doing: &str, cause: &io::Error) -> Self {
        Self::resource(format!("{}: cannot {doing}: {cause}", path.display()))
    }

    /// Adds a hint, shown on a line of its own.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Puts the place before the message: `place: message`.
    #[must_use]
    pub fn at(mut self, place: impl fmt::Display) -> Self {
        self.message = format!("{place}: {}", self.message);
        self
    }

    /// The kind of the error, which decides the exit code.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// The hint, if there is one: what the user can do.
    pub fn hint_text(&self) -> Option<&str> {
        self.hint.as_deref()
    }

    /// The process's exit code for this error.
    pub fn exit_code(&self) -> u8 {
        self.kind.exit_code()
    }
}

/// The message alone, without `error:` and without the hint.
impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}
