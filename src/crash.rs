//! A process that a signal kills says so in a sentence first.
//!
//! Drivers run their compilers' and our kernels' machine code in this process: what they abort, or do
//! wrong with memory, ends it. Nothing can be repaired then, but a message can say what was at work, and
//! cached files that may be the cause are removed, so that the next run begins without them.

use std::path::Path;

/// Makes SIGABRT, SIGILL, SIGSEGV, SIGBUS and SIGFPE end the process with an `error:` line and the exit
/// code of a resource that failed.
///
/// For the program's `main`: a library leaves signals to the program that uses it.
pub fn catch() {
    #[cfg(unix)]
    signals::catch();
}

/// Puts the handlers of [`catch`] in place again, where they were.
///
/// A driver's compiler installs its own when it is first used, which are reset as soon as one thread's
/// signal arrives, so that another thread's ends the process without a word.
pub fn catch_again() {
    #[cfg(unix)]
    signals::catch_again();
}

/// Sets what the crash message names from now on, such as `the device 'x' was at work`.
pub fn while_at_work(clause: &str) {
    #[cfg(unix)]
    signals::set_clause(clause);
    #[cfg(not(unix))]
    let _ = clause;
}

/// A cached file that is removed if a signal ends the process: it may be the cause, and can be made again.
pub fn suspect(path: &Path) {
    #[cfg(unix)]
    signals::suspect(path);
    #[cfg(not(unix))]
    let _ = path;
}

#[cfg(unix)]
mod signals {
    use std::ffi::{CStr, CString, c_char, c_int};
    use std::os::unix::ffi::OsStrExt;
    use std::path::Path;
    use std::ptr::null_mut;
    use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicUsize, Ordering};

    use crate::abrupt;
    use crate::error::ErrorKind;

    /// The signals and their names, each with a NUL at its end.
    const SIGNALS: [(c_int, &CStr); 5] = [
        (libc::SIGABRT, c"SIGABRT"),
        (libc::SIGILL, c"SIGILL"),
        (libc::SIGSEGV, c"SIGSEGV"),
        (libc::SIGBUS, c"SIGBUS"),
        (libc::SIGFPE, c"SIGFPE"),
    ];

    /// More cached files than a process uses.
    const MAX_SUSPECTS: usize = 1024;

    // What the handler reads: strings that are never freed.
    static CLAUSE: AtomicPtr<c_char> = AtomicPtr::new(null_mut());
    static SUSPECTS: [AtomicPtr<c_char>; MAX_SUSPECTS] =
        [const { AtomicPtr::new(null_mut()) }; MAX_SUSPECTS];
    static CATCHING: AtomicBool = AtomicBool::new(false);
    static SUSPECTS_SET: AtomicUsize = AtomicUsize::new(0);

    pub fn catch() {
        CATCHING.store(true, Ordering::Relaxed);
        install();
    }

    pub fn catch_again() {
        if CATCHING.load(Ordering::Relaxed) {
            install();
        }
    }

    fn install() {
        for (signal, _) in SIGNALS {
            // SAFETY: the action is whole: zero is its empty mask and no flags. The handler calls only what
            // a handler may call. It runs on the stack that Rust's threads set aside, where there is one.
            unsafe {
                let mut action: libc::sigaction = std::mem::zeroed();
                action.sa_sigaction = end as extern "C" fn(c_int) as libc::sighandler_t;
                action.sa_flags = libc::SA_ONSTACK;
                libc::sigaction(signal, &raw const action, null_mut());
            }
        }
    }

    /// A string that a handler may read at any time.
    fn leaked(bytes: &[u8]) -> Option<*mut c_char> {
        CString::new(bytes).ok().map(CString::into_raw)
    }

    pub fn set_clause(clause: &str) {
        let clause = clause.replace(char::is_control, " ");
        if CATCHING.load(Ordering::Relaxed)
            && let Some(clause) = leaked(clause.as_bytes())
        {
            CLAUSE.store(clause, Ordering::Release);
        }
    }

    pub fn suspect(path: &Path) {
        if !CATCHING.load(Ordering::Relaxed) {
            return;
        }
        let place = SUSPECTS_SET.fetch_add(1, Ordering::Relaxed);
        if let Some(slot) = SUSPECTS.get(place)
            && let Some(path) = leaked(path.as_os_str().as_bytes())
        {
            slot.store(path, Ordering::Release);
        }
    }

    /// Ends the process in words.
    extern "C" fn end(signal: c_int) {
        let name = SIGNALS.iter().find(|(number, _)| *number == signal);
        let name = name.map_or(c"a signal", |(_, name)| name);
        let clause = CLAUSE.load(Ordering::Acquire);
        let mut removed = false;
        for slot in &SUSPECTS {
            let path = slot.load(Ordering::Acquire);
            if !path.is_null() {
                // SAFETY: it came from a CString that is never freed; a handler may remove a file.
                removed |= unsafe { libc::unlink(path) } == 0;
            }
        }
        let (while_, clause) = match clause.is_null() {
            true => ("", c""),
            // SAFETY: as above.
            false => (" while ", unsafe { CStr::from_ptr(clause) }),
        };
        let hint = match (removed, while_.is_empty()) {
            (true, _) => {
                "hint: the cached kernels that were in use are removed; the same command builds them again\n"
            }
            (false, false) => {
                "hint: its driver failed, or memory ran out; '--device reference' needs no driver\n"
            }
            (false, true) => "hint: this is a fault of the program, or memory ran out\n",
        };
        let words = [
            b"error: the process was ended by ",
            name.to_bytes(),
            while_.as_bytes(),
            clause.to_bytes(),
            b"\n",
            hint.as_bytes(),
        ];
        abrupt::end(&words, ErrorKind::Resource.exit_code());
    }
}
