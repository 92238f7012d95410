//! Time and memory of this process, as the system counts them; not a number, or 0, where it does not.

/// User and system seconds of this process.
pub fn cpu_seconds() -> f64 {
    seconds_from(11)
}

/// User and system seconds of its children that have ended.
pub fn children_cpu_seconds() -> f64 {
    seconds_from(13)
}

/// Two fields of `/proc/self/stat` in hundredths of a second, counted from the state of the process on.
fn seconds_from(field: usize) -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace();
    fields.skip(field).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// Nanoseconds that this thread has run.
pub fn thread_nanoseconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    stat.split_whitespace().next().and_then(|first| first.parse().ok()).unwrap_or(f64::NAN)
}

/// Most memory of this process up to now, in MiB.
pub fn peak_mib() -> f64 {
    peak_mib_of("self")
}

/// Most memory that a process has held up to now, in MiB; not a number once it has ended.
pub fn peak_mib_of(process: &str) -> f64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM"));
    line.and_then(|line| line.split_whitespace().nth(1)?.parse::<f64>().ok()).map_or(f64::NAN, |kib| kib / 1024.0)
}
