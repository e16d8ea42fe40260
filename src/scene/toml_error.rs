//! Where in a TOML file something is wrong.

use crate::error::Error;

/// The usage error `place:line: message`; the line is the first one that `error` names.
pub(crate) fn located(error: &toml::de::Error, text: &str, place: &str) -> Error {
    let message = error.message().replace('\n', " ");
    match error.span() {
        Some(span) => Error::usage(message).at(format!("{place}:{}", line(text, span.start))),
        None => Error::usage(message).at(place),
    }
}

/// The line of a byte of `text`, counted from 1.
pub(crate) fn line(text: &str, byte: usize) -> usize {
    let before = &text.as_bytes()[..byte.min(text.len())];
    1 + before.iter().filter(|&&b| b == b'\n').count()
}
