//! Options of renders in passes: when they end, where they are kept, who watches.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use kajo::Goal;

use super::values;

/// When a render ends, and what happens on the way.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Passes")]
pub struct PassArgs {
    /// End after this many seconds; every pixel gets one sample in any case
    #[arg(long, value_name = "SECONDS", value_parser = values::seconds)]
    pub time: Option<Duration>,
    /// End when the estimated relative error of the picture is this small: 0.01
    #[arg(long, value_name = "ERROR", value_parser = values::positive)]
    pub noise: Option<f64>,
    /// Take more samples where the picture is noisy and fewer elsewhere; --samples is then the mean
    #[arg(long)]
    pub adaptive: bool,
    /// Save the state of the render to this file now and then, and when it ends, be it by an interrupt
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// Let checkpoints take the place of a file that is none, of that of another render or of a farther one
    #[arg(long, requires = "checkpoint")]
    pub overwrite_checkpoint: bool,
    /// Seconds from one checkpoint to the next
    #[arg(long, value_name = "SECONDS", default_value = "60", value_parser = values::seconds)]
    pub checkpoint_every: Duration,
    /// Go on from a checkpoint
    #[arg(long, value_name = "FILE")]
    pub resume: Option<PathBuf>,
    /// Show the picture in the viewer tev while it is rendered
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, default_missing_value = "127.0.0.1:14158")]
    pub tev: Option<String>,
}

impl PassArgs {
    /// Whether any of these is wanted, so that one pass would not do.
    pub fn are_wanted(&self) -> bool {
        let PassArgs { time, noise, adaptive, checkpoint, resume, tev, .. } = self;
        *adaptive
            || time.is_some()
            || noise.is_some()
            || checkpoint.is_some()
            || resume.is_some()
            || tev.is_some()
    }

    /// When the picture is good enough.
    pub fn goal(&self) -> Goal {
        /// A viewer should not wait longer for the next picture.
        const LIVELY: Duration = Duration::from_secs(2);
        let interval = match (&self.checkpoint, &self.tev) {
            (_, Some(_)) => Some(LIVELY),
            (Some(_), None) => Some(self.checkpoint_every),
            (None, None) => None,
        };
        Goal { time: self.time, noise: self.noise, adaptive: self.adaptive, interval }
    }
}
