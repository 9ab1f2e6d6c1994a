//! Options of renders that many workers share.

use std::path::PathBuf;

use clap::Args;
use kajo::MOST_THREADS;

/// Who renders, and in which pieces. None of it changes the picture.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Many workers")]
pub struct FarmArgs {
    /// Render by so many worker processes of this machine: local:4. Run it again to go on with what was finished
    #[arg(long, value_name = "local:N", value_parser = local_workers)]
    pub farm: Option<u16>,
    /// The folder of what is finished; by default one beside the picture, which is removed once that is written
    #[arg(long, value_name = "DIR")]
    pub job: Option<PathBuf>,
    /// Side of a unit's tile in pixels
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..))]
    pub unit_tile: Option<u32>,
    /// Samples of each pixel in a unit; by default as many as take this machine about ten seconds
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub unit_samples: Option<u32>,
}

/// `local:4`
fn local_workers(text: &str) -> Result<u16, String> {
    let number = text.strip_prefix("local:").and_then(|number| number.parse().ok());
    number
        .filter(|n| (1..=1024).contains(n))
        .ok_or_else(|| format!("expected local:N with 1 to {MOST_THREADS} workers, found `{text}`"))
}
