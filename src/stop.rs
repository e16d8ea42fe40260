//! Being asked to stop: Ctrl-C, or a scheduler's SIGTERM.
//!
//! Long work [`listen`]s once and looks at [`asked`] between its parts. What it has finished by then
//! is whole, and it ends with [`Error::stopped`](crate::error::Error::stopped).

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::error::{Error, ErrorKind, Result};

static ASKED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// As [`listen_for`], for work that can be gone on with wherever it is ended.
///
/// # Errors
/// Those of [`listen_for`].
pub fn listen() -> Result<()> {
    listen_for(ErrorKind::Stopped)
}

/// From now on the first SIGINT or SIGTERM only sets what [`asked`] tells, and the second ends the
/// process at once, as `ended` says. SIGHUP is left as it is, so that `nohup` keeps its meaning.
///
/// # Errors
/// The system lets no signals be caught.
pub fn listen_for(ended: ErrorKind) -> Result<()> {
    for signal in [SIGINT, SIGTERM] {
        let status = i32::from(ended.exit_code());
        // In this order: the first signal finds the flag unset and sets it.
        flag::register_conditional_shutdown(signal, status, Arc::clone(&ASKED))
            .and_then(|_| flag::register(signal, Arc::clone(&ASKED)))
            .map_err(|cause| Error::failed(format!("signals cannot be caught: {cause}")))?;
    }
    Ok(())
}

/// Whether it is time to stop.
pub fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}

/// What work came to, where `check` fails when it is time to stop: a failure then is the stop, not a
/// fault. For a signal while kernels are built makes LLVM remove the files that it is writing, so
/// that the build fails.
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
    fn a_stop_is_told_in_place_of_a_failure_and_of_nothing_else() {
        let stopped = || Err(Error::stopped("stopped"));
        let failed = || Err::<u8, _>(Error::failed("no kernel"));
        let told = over_failure(failed(), stopped).unwrap_err();
        assert_eq!(told.kind(), ErrorKind::Stopped);
        assert_eq!(over_failure(Ok(3), stopped), Ok(3));
        // The control: nobody asked, so that the fault is told.
        assert_eq!(over_failure(failed(), || Ok(())), failed());
    }
}
