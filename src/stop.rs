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

/// From now on the first SIGINT or SIGTERM only sets what [`asked`] tells, and the second ends the
/// process at once. SIGHUP is left as it is, so that `nohup` keeps its meaning.
///
/// # Errors
/// The system lets no signals be caught.
pub fn listen() -> Result<()> {
    for signal in [SIGINT, SIGTERM] {
        let status = i32::from(ErrorKind::Stopped.exit_code());
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
