//! The command line, to be given again.

use crate::lab::report;

/// How this program was called, as a report passes it on: by its name alone, and so are its files.
pub fn command_line() -> String {
    let arguments = std::env::args_os().skip(1);
    let arguments = arguments.map(|argument| argument.to_string_lossy().into_owned());
    report::command_line(std::iter::once("angioray".to_owned()).chain(arguments))
}
