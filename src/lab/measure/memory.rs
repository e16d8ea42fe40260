//! The host memory of this process.

/// The most host memory that this process has held so far, in bytes; unknown on some systems.
pub fn host_peak_bytes() -> Option<u64> {
    // Linux reports it in kB.
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    kilobytes.checked_mul(1024)
}
