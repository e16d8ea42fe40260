//! The processor time of this process.

/// The processor time of all threads since the process began, ms; unknown on some systems.
#[cfg(unix)]
pub fn processor_ms() -> Option<f64> {
    let used = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(used.tv_sec as f64 * 1e3 + used.tv_nsec as f64 / 1e6)
}

/// The processor time of all threads since the process began, ms; unknown on some systems.
#[cfg(not(unix))]
pub fn processor_ms() -> Option<f64> {
    None
}

#[cfg(all(test, unix))]
mod tests {
    use rustix::time::{ClockId, clock_gettime};

    use super::*;

    /// Works until this thread has used 20 ms; what it has used.
    fn work() -> f64 {
        let used = || {
            let used = clock_gettime(ClockId::ThreadCPUTime);
            used.tv_sec as f64 * 1e3 + used.tv_nsec as f64 / 1e6
        };
        let began = used();
        while used() < began + 20.0 {}
        used() - began
    }

    #[test]
    fn it_is_that_of_all_threads_together() {
        let began = processor_ms().unwrap();
        let other = std::thread::spawn(work);
        let own = work();
        let both = own + other.join().unwrap();
        // One thread's alone would be half of it.
        assert!(processor_ms().unwrap() - began >= both);
    }
}
