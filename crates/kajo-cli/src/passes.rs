//! What happens between the passes of a render: checkpoints, and pictures for a viewer.

use std::io;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use kajo::output::{OutputError, Target};
use kajo::{Snapshot, Tev};

use crate::args::PassArgs;
use crate::console;
use crate::interrupt::Interrupt;

/// Who looks at a render after each pass.
pub struct Watcher<'a> {
    checkpoint: Option<Checkpoints<'a>>,
    tev: Option<Tev>,
    interrupt: &'a Interrupt,
    /// What went wrong with a checkpoint. The render ends, since it cannot be kept as was asked.
    pub failure: Option<OutputError>,
}

/// A file that is written again and again.
struct Checkpoints<'a> {
    target: &'a Target,
    every: Duration,
    last: Instant,
}

impl<'a> Watcher<'a> {
    /// Whoever the options ask for.
    ///
    /// * `target`: of the checkpoints
    pub fn new(
        args: &PassArgs,
        scene: &Path,
        target: Option<&'a Target>,
        interrupt: &'a Interrupt,
    ) -> Watcher<'a> {
        let every = args.checkpoint_every;
        let checkpoint = target.map(|target| Checkpoints { target, every, last: Instant::now() });
        let name = scene.file_name().unwrap_or(scene.as_os_str()).to_string_lossy();
        let connect = |address: &String| {
            let connected = Tev::connect(address, &name);
            connected.map_err(|error| warn_of_tev(address, &error)).ok()
        };
        Watcher { checkpoint, tev: args.tev.as_ref().and_then(connect), interrupt, failure: None }
    }

    /// Looks at the picture so far.
    pub fn look(&mut self, snapshot: Snapshot<'_>) -> ControlFlow<()> {
        if let Some(tev) = &mut self.tev {
            let shown = snapshot.light().map_err(io::Error::other).and_then(|light| tev.show(&light));
            if let Err(error) = shown {
                warn_of_tev("tev", &error);
                self.tev = None;
            }
        }
        let Some(checkpoint) = &mut self.checkpoint else { return ControlFlow::Continue(()) };
        if checkpoint.last.elapsed() < checkpoint.every {
            return ControlFlow::Continue(());
        }
        self.failure = self.interrupt.undisturbed(|| snapshot.save(checkpoint.target)).err();
        checkpoint.last = Instant::now();
        if self.failure.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

fn warn_of_tev(address: &str, error: &io::Error) {
    console::warning(&format!("the picture is not shown in {address}: {error}"));
}
