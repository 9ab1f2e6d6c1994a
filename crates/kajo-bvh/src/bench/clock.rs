//! Wall clock and processor time.

use std::time::{Duration, Instant};

use rustix::time::{ClockId, clock_gettime};

/// Seconds by both clocks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Seconds {
    pub(super) wall: f64,
    pub(super) cpu: f64,
}

fn read(clock: ClockId) -> Duration {
    let t = clock_gettime(clock);
    Duration::new(t.tv_sec as u64, t.tv_nsec as u32)
}

/// Processor time of the calling thread while `f` runs, in seconds.
pub(super) fn thread_seconds(f: impl FnOnce()) -> f64 {
    let start = read(ClockId::ThreadCPUTime);
    f();
    (read(ClockId::ThreadCPUTime) - start).as_secs_f64()
}

/// Runs `f`; processor time is that of all threads.
pub(super) fn timed<R>(f: impl FnOnce() -> R) -> (R, Seconds) {
    let (wall, cpu) = (Instant::now(), read(ClockId::ProcessCPUTime));
    let result = f();
    let cpu = (read(ClockId::ProcessCPUTime) - cpu).as_secs_f64();
    (result, Seconds { wall: wall.elapsed().as_secs_f64(), cpu })
}
