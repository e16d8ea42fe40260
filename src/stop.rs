//! Requests to stop: Ctrl-C, or a scheduler's SIGTERM.
//!
//! Long work calls [`listen`] once and checks [`requested`] between its parts. What it has finished by then
//! is whole, and it ends with [`Error::stopped`](crate::error::Error::stopped). Other work
//! [ends at once](end_at_once).

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level;

use crate::error::{Error, ErrorKind, Result};
use crate::output::forget_unfinished;

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Listens for signals: the first SIGINT or SIGTERM only sets what [`requested`] returns, and the second
/// ends the process.
///
/// `say` is called at either, and gives the exit code at the second. SIGHUP is left as it is, so that
/// `nohup` keeps its meaning.
///
/// # Errors
/// The system lets no signals be caught.
pub fn listen(say: impl Fn(Signal) -> ErrorKind + Send + 'static) -> Result<()> {
    spawn(move || {
        let signal = match REQUESTED.swap(true, Ordering::Relaxed) {
            false => Signal::First,
            true => Signal::Second,
        };
        let kind = say(signal);
        (signal == Signal::Second).then_some(kind)
    })
}

/// Lets a SIGINT or SIGTERM end the process, for work that has nothing to put in order: `say` is called,
/// and gives the exit code. Files that are not finished are removed.
///
/// # Errors
/// The system lets no signals be caught.
pub fn end_at_once(say: impl Fn() -> ErrorKind + Send + 'static) -> Result<()> {
    spawn(move || Some(say()))
}

/// One of the signals that [`listen`] hears.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// The first signal, which asks for a stop.
    First,
    /// Any later signal, which ends the process.
    Second,
}

/// Calls `heard` at every signal, on a thread of its own, until it gives what the process ends as.
fn spawn(heard: impl Fn() -> Option<ErrorKind> + Send + 'static) -> Result<()> {
    let failed =
        |cause: std::io::Error| Error::resource(format!("signals cannot be caught: {cause}"));
    let mut signals = Signals::new([SIGINT, SIGTERM]).map_err(failed)?;
    let listener = thread::Builder::new().name("signals".into());
    let listening = listener.spawn(move || {
        for _ in signals.forever() {
            if let Some(kind) = heard() {
                forget_unfinished();
                // Without the drivers' exit handlers, which wait for their threads.
                low_level::exit(kind.exit_code().into());
            }
        }
    });
    listening.map(drop).map_err(failed)
}

/// Whether it is time to stop.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// The outcome of work, or the stop if `check` fails because it is time to stop: a failure then is the
/// stop, not a fault.
///
/// A signal while kernels are built makes LLVM remove the files that it is writing, so that the build
/// fails.
///
/// # Errors
/// Those of `check` where the work failed, else the work's own.
pub fn over_failure<T>(outcome: Result<T>, check: impl FnOnce() -> Result<()>) -> Result<T> {
    outcome.or_else(|failure| {
        check()?;
        Err(failure)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_is_reported_in_place_of_a_failure_and_of_nothing_else() {
        let stopped = || Err(Error::stopped("stopped"));
        let failed = || Err::<u8, _>(Error::failed("no kernel"));
        let reported = over_failure(failed(), stopped).unwrap_err();
        assert_eq!(reported.kind(), ErrorKind::Stopped);
        assert_eq!(over_failure(Ok(3), stopped), Ok(3));
        // The control: no stop was requested, so that the fault is reported.
        assert_eq!(over_failure(failed(), || Ok(())), failed());
    }
}
