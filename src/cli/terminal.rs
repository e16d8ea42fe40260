//! Data to stdout, messages to stderr. A reader that has gone away is no error.

use std::fmt::Display;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::sync::OnceLock;

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

/// Whether nothing but errors is said, as far as that was said already.
static QUIET: OnceLock<bool> = OnceLock::new();

/// Says whether nothing but errors is said from now on. The first call is the one that counts: flags are
/// read before scene files.
pub fn set_quiet(quiet: bool) {
    let _ = QUIET.set(quiet);
}

/// Whether nothing but errors is said.
pub fn is_quiet() -> bool {
    QUIET.get().is_some_and(|quiet| *quiet)
}

/// A line for the user, unless nothing but errors is said.
pub fn message(line: impl Display) {
    if !is_quiet() {
        say(line);
    }
}

/// Where stderr is closed there is nobody to read it.
fn say(line: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Something chosen or changed that the user may want to know.
pub fn note(sentence: impl Display) {
    message(format_args!("note: {sentence}"));
}

/// How the program is called, where it was called without saying what to do.
pub fn usage(text: &impl Display) {
    say(text);
}

pub fn error(error: &Error) {
    say(lines(error).trim_end());
}

/// An error as it is printed: a line, and one for its hint.
pub fn lines(error: &Error) -> String {
    match error.hint_text() {
        Some(hint) => format!("error: {error}\nhint: {hint}\n"),
        None => format!("error: {error}\n"),
    }
}
