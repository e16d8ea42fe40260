//! Mapped files that are shortened while they are read. Touching a page that no longer exists raises SIGBUS,
//! as does one that the disk cannot give: the process ends there, with a sentence that names the file.

use std::path::Path;
use std::ptr::null_mut;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicPtr, AtomicUsize, Ordering};

use crate::abrupt;
use crate::error::{Error, ErrorKind};

/// How an error is printed: the lines for it.
type Print = fn(&Error) -> String;

static PRINT: OnceLock<Print> = OnceLock::new();

/// A mapped file's addresses and last words. A handler may be reading it at any time, so that it is
/// never freed.
struct Watched {
    start: usize,
    /// 0 once the file is no longer mapped.
    end: AtomicUsize,
    last_words: String,
    /// The one mapped before it.
    before: AtomicPtr<Watched>,
}

/// The file mapped last.
static LATEST: AtomicPtr<Watched> = AtomicPtr::new(null_mut());

/// Watches the bytes of a mapped file until it is dropped: touching what is gone ends the process.
#[derive(Debug)]
pub(super) struct Watch {
    end: &'static AtomicUsize,
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.end.store(0, Ordering::Release);
    }
}

/// Arranges that a volume file that is shortened while it is mapped, or that its disk no longer gives,
/// ends the process with the lines that `print` makes of the error, and the exit code of a resource that
/// failed. For programs: it puts a handler on SIGBUS, which leaves all other causes to the handler that
/// was there before. A second call changes nothing. Systems without SIGBUS need no handler.
///
/// # Errors
/// The system takes no handler.
pub fn end_when_shortened(print: fn(&Error) -> String) -> crate::error::Result<()> {
    if PRINT.set(print).is_err() {
        return Ok(());
    }
    #[cfg(unix)]
    handler::install().map_err(|cause| {
        Error::resource(format!("no handler of signals can be set up: {cause}"))
    })?;
    Ok(())
}

/// Watches the mapped bytes of the file `path`, if the program has requested it.
pub(super) fn watch(bytes: &[u8], path: &Path) -> Option<Watch> {
    let print = PRINT.get()?;
    let error = Error::resource(format!(
        "{}: the file was shortened while it was being read, or its disk failed",
        path.display()
    ))
    .hint("leave the file alone while it is in use, or give a copy of it");
    let watched: &'static Watched = Box::leak(Box::new(Watched {
        start: bytes.as_ptr() as usize,
        end: AtomicUsize::new(bytes.as_ptr() as usize + bytes.len()),
        last_words: print(&error),
        before: AtomicPtr::new(LATEST.load(Ordering::Acquire)),
    }));
    let own = std::ptr::from_ref(watched).cast_mut();
    loop {
        let before = watched.before.load(Ordering::Acquire);
        match LATEST.compare_exchange(before, own, Ordering::AcqRel, Ordering::Acquire) {
            Ok(_) => return Some(Watch { end: &watched.end }),
            Err(latest) => watched.before.store(latest, Ordering::Release),
        }
    }
}

/// Ends the process where `address` lies in a mapped file; else returns. Safe in a signal's handler.
#[cfg_attr(not(unix), allow(dead_code))]
fn end_if_mapped(address: usize) {
    let mut next = LATEST.load(Ordering::Acquire);
    // SAFETY: what was ever put into the list stays there, and is never written but for its atomics.
    while let Some(watched) = unsafe { next.as_ref() } {
        if (watched.start..watched.end.load(Ordering::Acquire)).contains(&address) {
            abrupt::end(
                &[watched.last_words.as_bytes()],
                ErrorKind::Resource.exit_code(),
            );
        }
        next = watched.before.load(Ordering::Acquire);
    }
}

#[cfg(unix)]
mod handler {
    use std::io;
    use std::mem::zeroed;
    use std::sync::OnceLock;

    use libc::{
        SA_NODEFER, SA_ONSTACK, SA_SIGINFO, SIG_DFL, SIG_IGN, SIGBUS, sigaction, siginfo_t,
    };

    use super::end_if_mapped;

    /// The handler of SIGBUS that was installed before.
    static BEFORE: OnceLock<sigaction> = OnceLock::new();

    /// Installs the handler.
    ///
    /// # Errors
    /// The system refuses it.
    pub fn install() -> io::Result<()> {
        // SAFETY: plain C structures, of which zeros are valid; the handler is safe in a signal's.
        unsafe {
            let mut before: sigaction = zeroed();
            if libc::sigaction(SIGBUS, std::ptr::null(), &mut before) != 0 {
                return Err(io::Error::last_os_error());
            }
            // Known before the handler can run.
            let _ = BEFORE.set(before);
            let mut own: sigaction = zeroed();
            own.sa_sigaction = on_bus_error as *const () as usize;
            own.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER;
            libc::sigemptyset(&mut own.sa_mask);
            if libc::sigaction(SIGBUS, &own, std::ptr::null_mut()) != 0 {
                return Err(io::Error::last_os_error());
            }
        }
        Ok(())
    }

    extern "C" fn on_bus_error(
        signal: libc::c_int,
        info: *mut siginfo_t,
        context: *mut libc::c_void,
    ) {
        // SAFETY: the system gives the information that SA_SIGINFO asks for; the handler from before
        // is called as it wanted to be.
        unsafe {
            end_if_mapped((*info).si_addr() as usize);
            let before = BEFORE.get();
            match before.map_or(SIG_DFL, |before| before.sa_sigaction) {
                SIG_DFL | SIG_IGN => {
                    // Touched again, it ends the process as without a handler.
                    let mut default: sigaction = zeroed();
                    default.sa_sigaction = SIG_DFL;
                    libc::sigaction(signal, &default, std::ptr::null_mut());
                }
                earlier if before.is_some_and(|before| before.sa_flags & SA_SIGINFO != 0) => {
                    let earlier: extern "C" fn(libc::c_int, *mut siginfo_t, *mut libc::c_void) =
                        std::mem::transmute(earlier);
                    earlier(signal, info, context);
                }
                earlier => {
                    let earlier: extern "C" fn(libc::c_int) = std::mem::transmute(earlier);
                    earlier(signal);
                }
            }
        }
    }
}
