//! What happens between the passes of a render: checkpoints, and pictures for a viewer.

use std::io;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use kajo::output::Target;
use kajo::{Snapshot, Tev};

use crate::args::PassArgs;
use crate::console;
use crate::interrupt::Interrupt;

/// Who looks at a render after each pass.
pub struct Watcher<'a> {
    checkpoint: Option<Checkpoints<'a>>,
    tev: Option<Tev>,
    interrupt: &'a Interrupt,
}

/// How long to wait at most before a checkpoint is tried again that could not be written.
const SOON: Duration = Duration::from_secs(60);

/// A file that is written again and again.
struct Checkpoints<'a> {
    target: &'a Target,
    every: Duration,
    last: Instant,
    /// When the last pass ended.
    last_look: Instant,
    /// Whether the last one could not be written.
    failed: bool,
}

impl<'a> Checkpoints<'a> {
    fn new(target: &'a Target, every: Duration, now: Instant) -> Checkpoints<'a> {
        Checkpoints { target, every, last: now, last_look: now, failed: false }
    }

    /// Whether it is time for the next one: another pass as long as the last would end too late.
    fn is_due(&mut self, now: Instant) -> bool {
        let took = now.duration_since(self.last_look);
        self.last_look = now;
        let every = if self.failed { self.every.min(SOON) } else { self.every };
        now.duration_since(self.last).saturating_add(took) >= every
    }

    /// Writes one. When that fails the render goes on: there will be another attempt, and the picture at the end.
    fn write(&mut self, snapshot: Snapshot<'_>) {
        let result = snapshot.save(self.target);
        if let Err(error) = &result {
            // Said once, not at each attempt.
            if !self.failed {
                console::warning(&format!("{error}; the render goes on and tries again"));
            }
        }
        self.failed = result.is_err();
        let now = Instant::now();
        (self.last, self.last_look) = (now, now);
    }
}

impl<'a> Watcher<'a> {
    /// The callback that the options ask for.
    ///
    /// * `target`: of the checkpoints
    pub fn new(
        args: &PassArgs,
        scene: &Path,
        target: Option<&'a Target>,
        interrupt: &'a Interrupt,
    ) -> Watcher<'a> {
        let every = args.checkpoint_every;
        let now = Instant::now();
        let checkpoint = target.map(|target| Checkpoints::new(target, every, now));
        let name = scene.file_name().unwrap_or(scene.as_os_str()).to_string_lossy();
        let connect = |address: &String| {
            let connected = Tev::connect(address, &name);
            connected.map_err(|error| warn_of_tev(address, &error)).ok()
        };
        Watcher { checkpoint, tev: args.tev.as_ref().and_then(connect), interrupt }
    }

    /// Looks at the picture so far.
    pub fn look(&mut self, snapshot: Snapshot<'_>) -> ControlFlow<()> {
        if let Some(tev) = &mut self.tev {
            let stop = || self.interrupt.is_stopping();
            let light = snapshot.light().map_err(io::Error::other);
            if let Err(error) = light.and_then(|light| tev.show(&light, &stop)) {
                if !stop() {
                    warn_of_tev("tev", &error);
                }
                self.tev = None;
            }
        }
        let Some(checkpoint) = &mut self.checkpoint else { return ControlFlow::Continue(()) };
        if !checkpoint.is_due(Instant::now()) {
            return ControlFlow::Continue(());
        }
        self.interrupt.undisturbed(|| checkpoint.write(snapshot));
        ControlFlow::Continue(())
    }
}

fn warn_of_tev(address: &str, error: &io::Error) {
    console::warning(&format!("the picture is not shown in {address}: {error}"));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checkpoint_is_due_before_it_is_too_late() {
        let folder = tempfile::tempdir().unwrap();
        let target = Target::check(&folder.path().join("state"), &[]).unwrap();
        let (start, every) = (Instant::now(), Duration::from_secs(60));
        let mut checkpoints = Checkpoints::new(&target, every, start);
        let mut is_due = |seconds| checkpoints.is_due(start + Duration::from_secs(seconds));
        assert!(!is_due(10));
        assert!(!is_due(29), "another pass of 19 seconds ends in time");
        assert!(is_due(45), "another pass of 16 seconds would not");
    }

    #[test]
    fn what_could_not_be_written_is_tried_again_soon() {
        let folder = tempfile::tempdir().unwrap();
        let target = Target::check(&folder.path().join("state"), &[]).unwrap();
        let (start, hour) = (Instant::now(), Duration::from_secs(3600));
        let mut checkpoints = Checkpoints::new(&target, hour, start);
        assert!(!checkpoints.is_due(start + Duration::from_secs(50)));
        checkpoints.failed = true;
        assert!(!checkpoints.is_due(start + Duration::from_secs(54)));
        assert!(checkpoints.is_due(start + Duration::from_secs(60)));
    }

    #[test]
    fn without_an_interval_every_pass_is_saved() {
        let folder = tempfile::tempdir().unwrap();
        let target = Target::check(&folder.path().join("state"), &[]).unwrap();
        let (start, every) = (Instant::now(), Duration::ZERO);
        assert!(Checkpoints::new(&target, every, start).is_due(start));
    }
}
