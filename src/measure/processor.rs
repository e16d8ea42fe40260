//! The processor time of this process.

/// What all threads have used together since the process began, ms; unknown on some systems.
#[cfg(unix)]
pub fn processor_ms() -> Option<f64> {
    let used = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(used.tv_sec as f64 * 1e3 + used.tv_nsec as f64 / 1e6)
}

/// What all threads have used together since the process began, ms; unknown on some systems.
#[cfg(not(unix))]
pub fn processor_ms() -> Option<f64> {
    None
}

#[cfg(all(test, unix))]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn work_uses_it_and_waiting_does_not() {
        let began = processor_ms().unwrap();
        while processor_ms().unwrap() < began + 20.0 {}
        let worked = processor_ms().unwrap();
        std::thread::sleep(Duration::from_millis(20));
        assert!(processor_ms().unwrap() - worked < 10.0);
    }
}
