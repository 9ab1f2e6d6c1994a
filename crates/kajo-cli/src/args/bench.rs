//! The arguments of `kajo bench`.

use clap::{Args, Subcommand, ValueEnum};
use kajo_selftest::bench::rays::Quality;
use kajo_selftest::bench::whitted::{AntiAliasing, WhittedScene};

const EXAMPLES: &str = "\
Examples:
  kajo bench whitted                               renders two scenes on 1 and on 2 threads, five times
  kajo bench whitted --scene flake --aa 2x2 --json
  kajo bench rays sphere grass terrain --threads 2
  kajo bench rays dragon.kmsh --quality high --json
  kajo bench parse --lines 1000000

Every answer is checked before its speed is shown; a wrong one ends with exit code 1.";

/// `kajo bench`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct BenchArgs {
    #[command(subcommand)]
    pub what: BenchCommand,
}

/// What to measure.
#[derive(Debug, Subcommand)]
pub enum BenchCommand {
    /// Render mirrors and glass: a sphereflake, and a thousand marbles
    Whitted(WhittedArgs),
    /// Cast rays at meshes: camera, bounce and shadow rays
    Rays(RaysArgs),
    /// Read scene text
    Parse(ParseArgs),
    /// Load a large mesh and compare the peak of memory with what is kept
    Memory(MemoryArgs),
}

/// `kajo bench whitted`
#[derive(Args, Debug)]
pub struct WhittedArgs {
    /// The scene
    #[arg(long, value_enum, default_value = "all")]
    pub scene: SceneChoice,
    /// Numbers of threads to render with, such as 1,2
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "1,2", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Vec<u16>,
    /// How often to render; the median is reported
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    pub passes: u16,
    /// Camera rays of a pixel: one, or one and a grid of 2 x 2
    #[arg(long, value_enum, default_value = "none")]
    pub aa: AaChoice,
    /// Write the pictures to SCENE.png in this folder
    #[arg(long, value_name = "DIR")]
    pub pictures: Option<std::path::PathBuf>,
    /// Render nothing; write the scenes for POV-Ray (.pov) and Tachyon (.dat) to this folder
    #[arg(long, value_name = "DIR", conflicts_with = "pictures")]
    pub peers: Option<std::path::PathBuf>,
    /// Print one JSON object a scene
    #[arg(long)]
    pub json: bool,
}

/// `--scene`
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum SceneChoice {
    /// Sphereflake of mirrors
    Flake,
    /// Mirrors, matte spheres and glass
    Marbles,
    /// Both
    All,
}

impl SceneChoice {
    /// The scenes that it stands for.
    pub fn scenes(self) -> Vec<WhittedScene> {
        match self {
            SceneChoice::Flake => vec![WhittedScene::Flake],
            SceneChoice::Marbles => vec![WhittedScene::Marbles],
            SceneChoice::All => WhittedScene::ALL.to_vec(),
        }
    }
}

/// `--aa`
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum AaChoice {
    /// One ray through the centre
    None,
    /// The centre and four more, five in all
    #[value(name = "2x2")]
    Grid,
}

impl From<AaChoice> for AntiAliasing {
    fn from(choice: AaChoice) -> AntiAliasing {
        match choice {
            AaChoice::None => AntiAliasing::None,
            AaChoice::Grid => AntiAliasing::Grid,
        }
    }
}

/// `kajo bench rays`
#[derive(Args, Debug)]
pub struct RaysArgs {
    /// Mesh files (KMSH), or `sphere`, `grass`, `terrain`, which are made on the spot
    #[arg(required = true, value_name = "MESH")]
    pub meshes: Vec<String>,
    /// Threads that build and trace
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: u16,
    /// How often to trace; the median is reported
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    pub passes: u16,
    /// How often to build the tree
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..))]
    pub builds: u16,
    /// Time to spend on the tree
    #[arg(long, value_enum, default_value = "medium")]
    pub quality: QualityChoice,
    /// No ray slips between triangles; always so, the word is for scripts that run other ray casters too
    #[arg(long)]
    pub robust: bool,
    /// Print one JSON object a mesh
    #[arg(long)]
    pub json: bool,
}

/// `--quality`
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum QualityChoice {
    /// The default of scenes
    Medium,
    /// Slower to build, faster to trace
    High,
}

impl From<QualityChoice> for Quality {
    fn from(choice: QualityChoice) -> Quality {
        match choice {
            QualityChoice::Medium => Quality::Fast,
            QualityChoice::High => Quality::High,
        }
    }
}

/// `kajo bench parse`
#[derive(Args, Debug)]
pub struct ParseArgs {
    /// Lines of scene text
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    pub lines: u32,
    /// How often to read it; the median is reported
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    pub passes: u16,
    /// Print a JSON object
    #[arg(long)]
    pub json: bool,
}

/// `kajo bench memory`
#[derive(Args, Debug)]
pub struct MemoryArgs {
    /// Triangles of the mesh
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u32).range(2..=100_000_000))]
    pub triangles: u32,
    /// Print a JSON object
    #[arg(long)]
    pub json: bool,
}
