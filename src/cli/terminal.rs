//! Data to stdout, messages to stderr. A reader that has gone away is no error.

use std::fmt::Display;
use std::io::{self, BufWriter, ErrorKind, Write};

use crate::error::{Error, Result};

/// Writes data to stdout. When its reader closes the pipe the rest is not wanted, which is fine.
pub fn to_stdout(data: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    let mut out = BufWriter::new(io::stdout().lock());
    match data(&mut out).and_then(|()| out.flush()) {
        Err(cause) if cause.kind() != ErrorKind::BrokenPipe => Err(Error::resource(format!(
            "cannot write to the standard output: {cause}"
        ))),
        _ => {
            // What is left in the buffer has no reader.
            let _ = out.into_parts();
            Ok(())
        }
    }
}

/// A line for the user. Where stderr is closed there is nobody to tell.
pub fn message(line: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Something chosen or changed that the user may want to know.
pub fn note(sentence: impl Display) {
    message(format_args!("note: {sentence}"));
}

pub fn error(error: &Error) {
    message(lines(error).trim_end());
}

/// An error as it is printed: a line, and one for its hint.
pub fn lines(error: &Error) -> String {
    match error.hint_text() {
        Some(hint) => format!("error: {error}\nhint: {hint}\n"),
        None => format!("error: {error}\n"),
    }
}
