//! The arguments of `kajo selftest`.

use clap::Args;

const EXAMPLES: &str = "\
Examples:
  kajo selftest --quick                    every row to half a per cent
  kajo selftest                            every row to a twentieth of a per cent
  kajo selftest --seed 7 --only S3         the polygons of seed 7
  kajo selftest --only 'path, lights'       one method of the path integrator
  kajo selftest --json > rows.json

Each row is a scene whose light is known by a formula, with numbers drawn from the seed, rendered by
one integrator. Exit code 1 when a row fails.";

/// `kajo selftest`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct SelftestArgs {
    /// Draws the scenes' numbers; the time of day unless said
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Only rows whose name or method holds this, in any case
    #[arg(long, value_name = "TEXT")]
    pub only: Option<String>,
    /// Measure to half a per cent instead of a twentieth
    #[arg(long)]
    pub quick: bool,
    /// Show the rows without measuring them
    #[arg(long, conflicts_with = "json")]
    pub list: bool,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Threads; one on each core unless said
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true, value_parser = clap::value_parser!(u16).range(0..=1024))]
    pub threads: u16,
}

impl SelftestArgs {
    /// Whether a row of that name and method is asked for.
    pub fn wants(&self, name: &str, method: &str) -> bool {
        let holds = |text: &str, part: &str| text.to_lowercase().contains(part);
        self.only
            .as_ref()
            .map(|only| only.to_lowercase())
            .is_none_or(|only| holds(name, &only) || holds(method, &only))
    }
}
