//! What the process needs of the host's memory.

/// The most that it held so far; unknown on some systems.
pub fn host_peak_bytes() -> Option<u64> {
    // Linux tells it in kB.
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    kilobytes.checked_mul(1024)
}
