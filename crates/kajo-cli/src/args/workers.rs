//! Options of renders that many workers share.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use kajo::MOST_THREADS;

use super::values;

/// Who renders, and in which pieces. None of it changes the picture.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Many workers")]
pub struct FarmArgs {
    /// Render by so many worker processes of this machine: local:4; or by a cluster of Dask: tls://head:8786. Run it
    /// again to go on with what was finished
    #[arg(long, value_name = "local:N|ADDRESS", value_parser = workers)]
    pub farm: Option<Workers>,
    /// The folder with the certificates of the cluster, which `kajo farm init` made
    #[arg(long, value_name = "DIR")]
    pub farm_config: Option<PathBuf>,
    /// Write the picture so far to this file now and then
    #[arg(long, value_name = "FILE")]
    pub preview: Option<PathBuf>,
    /// Seconds from one of these to the next
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = values::seconds)]
    pub preview_every: Duration,
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

/// Who renders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Workers {
    /// So many processes of this machine.
    Local(u16),
    /// The machines of the program that started this one, see [`kajo_farm::Engine`].
    Engine,
    /// The cluster whose scheduler has this address.
    Cluster(String),
}

fn workers(text: &str) -> Result<Workers, String> {
    if text == "stdio" {
        return Ok(Workers::Engine);
    }
    if let Some((scheme @ ("tls" | "tcp"), place)) = text.split_once("://") {
        let port =
            place.rsplit_once(':').filter(|(host, _)| !host.is_empty()).map(|(_, port)| port.parse::<u16>());
        return match port {
            Some(Ok(_)) => Ok(Workers::Cluster(text.to_owned())),
            _ => Err(format!("expected {scheme}://HOST:PORT, found `{text}`")),
        };
    }
    let number = text.strip_prefix("local:").and_then(|number| number.parse().ok());
    number.filter(|n| (1..=1024).contains(n)).map(Workers::Local).ok_or_else(|| {
        format!(
            "expected local:N with 1 to {MOST_THREADS} workers, or the address of a cluster such as tls://head:8786, \
             found `{text}`"
        )
    })
}
