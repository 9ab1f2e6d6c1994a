//! The arguments of the commands around renders that many workers share.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Args, Subcommand};
use kajo::MOST_THREADS;

use super::{RenderArgs, SceneArgs};

/// `kajo plan`
#[derive(Args, Debug)]
pub struct PlanArgs {
    /// Print the number of units and nothing else
    #[arg(long)]
    pub count: bool,
    #[command(flatten)]
    pub render: RenderArgs,
}

/// `kajo unit`
#[derive(Args, Debug)]
pub struct UnitArgs {
    /// The folder that `kajo plan` made
    #[arg(long, value_name = "DIR")]
    pub job: PathBuf,
    /// The unit, counted from 0
    #[arg(long, value_name = "N")]
    pub index: u64,
    /// Render every so many-th unit from that one on: --index 3 --of 100 is the fourth of a hundred shares
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u64).range(1..))]
    pub of: Option<u64>,
    /// A bundle to take the scene from, where its files are not
    #[arg(long, value_name = "FILE")]
    pub bundle: Option<PathBuf>,
    /// Threads, at most 1024; 0 for one on each core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=MOST_THREADS as i64))]
    pub threads: u16,
}

/// `kajo merge`
#[derive(Args, Debug)]
pub struct MergeArgs {
    /// The folder that `kajo plan` made
    pub job: PathBuf,
    /// The picture, instead of the one that the plan names
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// A bundle to take the scene from, where its files are not
    #[arg(long, value_name = "FILE")]
    pub bundle: Option<PathBuf>,
    /// Say nothing but warnings and errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// `kajo worker`
#[derive(Args, Debug)]
pub struct WorkerArgs {
    /// Take messages from standard input and answer on standard output
    #[arg(long, required = true)]
    pub stdio: bool,
    /// Threads, at most 1024; 0 for one on each core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=MOST_THREADS as i64))]
    pub threads: u16,
}

/// `kajo bundle`
#[derive(Args, Debug)]
pub struct BundleArgs {
    /// Scene file
    pub scene: PathBuf,
    /// The bundle; by default a file of the same name that ends in .kbundle
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub scene_args: SceneArgs,
}

/// `kajo farm`
#[derive(Args, Debug)]
pub struct FarmCommandArgs {
    #[command(subcommand)]
    pub what: FarmCommand,
}

/// What manages the machines.
#[derive(Debug, Subcommand)]
pub enum FarmCommand {
    /// Print a batch script for Slurm: kajo farm slurm SCENE -o OUT --array 200 | sbatch
    #[command(allow_negative_numbers = true)]
    Slurm(Box<SlurmArgs>),
    /// Make the certificates of a cluster of Dask: kajo farm init [DIR]
    Init(HandedOn),
    /// Run the scheduler of a cluster: kajo farm head [--config DIR] [--host HOST] [--port PORT]
    Head(HandedOn),
    /// Render for a cluster: kajo farm join [--config DIR] tls://HEAD:PORT
    Join(HandedOn),
    /// Let other machines join by ssh: kajo farm ssh [--config DIR] HOSTS.txt tls://HEAD:PORT
    Ssh(HandedOn),
}

/// Words for the Python package, which has what talks to Dask.
#[derive(Args, Debug)]
#[command(disable_help_flag = true)]
pub struct HandedOn {
    /// See `kajo farm COMMAND --help`
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    pub words: Vec<OsString>,
}

/// `kajo farm slurm`
#[derive(Args, Debug)]
pub struct SlurmArgs {
    /// Elements of the job array, each of which renders its share of the units
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub array: u32,
    #[command(flatten)]
    pub render: RenderArgs,
}
