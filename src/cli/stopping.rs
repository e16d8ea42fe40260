//! What the user is shown when a signal stops the program: Ctrl-C, or a scheduler's SIGTERM.

use crate::error::{Error, ErrorKind, Result};
use crate::stop::{self, Signal};

use super::terminal::{error, note};

/// Work that ends between two parts of it, of which `part` is one, at the first signal, and at once at the
/// second, as `ended` says.
///
/// # Errors
/// The system lets no signals be caught.
pub fn between_parts(part: &'static str, ended: ErrorKind) -> Result<()> {
    stop::listen(move |signal| {
        match signal {
            Signal::First => note(format_args!(
                "stopping after the current {part}; a second signal stops at once"
            )),
            Signal::Second => error(&Error::new(ended, "stopped at once; finished work stays")),
        }
        ended
    })
}

/// Work that ends at once; `left` is a sentence on what is left of it.
///
/// # Errors
/// The system lets no signals be caught.
pub fn at_once(left: &'static str) -> Result<()> {
    stop::end_at_once(move || {
        let stopped = Error::stopped(format!("stopped before the end; {left}"));
        error(&stopped.hint("run the same command again"));
        ErrorKind::Stopped
    })
}
