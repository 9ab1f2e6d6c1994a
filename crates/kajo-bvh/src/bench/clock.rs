//! Wall clock and processor time. Where the system tells no processor time, the wall clock stands in.

use std::time::{Duration, Instant};

/// Seconds by both clocks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Seconds {
    pub(super) wall: f64,
    pub(super) cpu: f64,
}

/// Whose processor time is read.
#[derive(Clone, Copy)]
enum Of {
    Thread,
    Process,
}

#[cfg(unix)]
fn processor_time(of: Of) -> Duration {
    use rustix::time::{ClockId, clock_gettime};
    let t = clock_gettime(match of {
        Of::Thread => ClockId::ThreadCPUTime,
        Of::Process => ClockId::ProcessCPUTime,
    });
    Duration::new(t.tv_sec as u64, t.tv_nsec as u32)
}

#[cfg(not(unix))]
fn processor_time(_of: Of) -> Duration {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    START.get_or_init(Instant::now).elapsed()
}

/// Processor time of the calling thread while `f` runs, in seconds.
pub(super) fn thread_seconds(f: impl FnOnce()) -> f64 {
    let start = processor_time(Of::Thread);
    f();
    (processor_time(Of::Thread) - start).as_secs_f64()
}

/// Runs `f`; processor time is that of all threads.
pub(super) fn timed<R>(f: impl FnOnce() -> R) -> (R, Seconds) {
    let (wall, cpu) = (Instant::now(), processor_time(Of::Process));
    let result = f();
    let cpu = (processor_time(Of::Process) - cpu).as_secs_f64();
    (result, Seconds { wall: wall.elapsed().as_secs_f64(), cpu })
}
