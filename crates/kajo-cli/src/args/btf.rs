//! The arguments of `kajo btf`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::SceneArgs;

/// `kajo btf`
#[derive(Args, Debug)]
pub struct BtfArgs {
    /// What to do
    #[command(subcommand)]
    pub command: BtfCommand,
}

/// What to do with bidirectional texture functions.
#[derive(Debug, Subcommand)]
pub enum BtfCommand {
    /// Render one: a square of a surface about the plane z = 0, seen and lit from all around
    #[command(allow_negative_numbers = true)]
    Make(BtfMakeArgs),
    /// Make one of what was measured: pictures of UBO2003 or a file of UBO2014
    Compress(BtfCompressArgs),
    /// Tell what is in a file
    Info(BtfInfoArgs),
}

/// `kajo btf make`
#[derive(Args, Debug)]
pub struct BtfMakeArgs {
    /// Scene file with the surface; its own lights have no effect
    pub scene: PathBuf,
    /// Texels along each side
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub side: u32,
    /// Rings of directions around the normal: 3 are 37 directions, 5 are 91
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=12))]
    pub rings: u32,
    /// Samples of each texel for each pair of directions
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub samples: u32,
    /// The corner of the square with the least x and y
    #[arg(long, num_args = 2, value_names = ["X", "Y"], default_values_t = [0.0, 0.0])]
    pub corner: Vec<f64>,
    /// Length of its sides
    #[arg(long, value_name = "LENGTH", default_value_t = 1.0, value_parser = positive)]
    pub length: f64,
    #[command(flatten)]
    pub kept: BtfKeptArgs,
    #[command(flatten)]
    pub scene_args: SceneArgs,
}

/// `kajo btf compress`
#[derive(Args, Debug)]
pub struct BtfCompressArgs {
    /// A folder of pictures whose names say their directions, such as tl030_pl120_tv015_pv060.jpg, or a file in the form DFMF or FMF
    pub measured: PathBuf,
    /// Texels along a side at most; larger textures are averaged
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub side: u32,
    #[command(flatten)]
    pub kept: BtfKeptArgs,
}

/// `kajo btf info`
#[derive(Args, Debug)]
pub struct BtfInfoArgs {
    /// The file
    pub file: PathBuf,
}

/// How much is kept, and where.
#[derive(Args, Debug)]
pub struct BtfKeptArgs {
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Clusters of texels
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub clusters: u32,
    /// Principal components of each
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=1024))]
    pub components: u32,
    /// Store values with 32 bits instead of 16
    #[arg(long)]
    pub float: bool,
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(v) if v.is_finite() && v > 0.0 => Ok(v),
        _ => Err("a length greater than 0 is expected".to_owned()),
    }
}
