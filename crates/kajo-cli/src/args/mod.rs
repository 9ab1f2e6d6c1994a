//! The command line.
//!
//! One tree of commands for `clap`, and before it [`normalise()`], which turns the spellings that `clap` does
//! not know into ones it does: a bare scene file, the single dashes of the classic program, and values
//! of two words.

mod bench;
mod btf;
mod classic;
mod common;
mod develop;
mod farm;
mod frames;
mod normalise;
mod passes;
mod render;
mod selftest;
mod texture;
mod values;
mod workers;

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Args, CommandFactory, Parser, Subcommand};
use clap_complete::Shell;

pub use bench::{BenchArgs, BenchCommand, MemoryArgs, ParseArgs, RaysArgs, WhittedArgs};
pub use btf::{BtfArgs, BtfCommand, BtfCompressArgs, BtfInfoArgs, BtfKeptArgs, BtfMakeArgs};
pub use classic::ClassicArgs;
pub use common::{ModelArgs, RunArgs, SceneArgs, TextureFolderArgs};
pub use develop::DevelopArgs;
pub use farm::{BundleArgs, FarmCommand, FarmCommandArgs, MergeArgs, PlanArgs, UnitArgs, WorkerArgs};
pub use frames::{FrameArgs, Frames, has_number, numbered, range};
pub use normalise::normalise;
pub use passes::PassArgs;
pub use render::RenderArgs;
pub use selftest::SelftestArgs;
pub use texture::{TextureCommand, TextureCommandArgs, TextureMakeArgs};
pub use workers::{FarmArgs, Workers};

const EXAMPLES: &str = "\
Examples:
  kajo scene.txt                                   renders to scene.png beside the scene
  kajo render scene.txt -o out.png --size 1920 1080 --samples jittered 64
  kajo render scene.txt -o out.exr --aov depth --aov normals --aov object
  kajo -input scene.txt -output out.png -size 200 200 -depth 9 10 depth.png
  kajo render film.txt --frames 1..240 -o out.####.png
  kajo model.glb --ground                          the same of a model: framed, lit, on a ground
  kajo convert model.glb scene.txt                 writes the scene that shows a model, to go on with
  kajo studio scene.txt                            opens the window
  kajo check scenes/*.txt                          reports every mistake, renders nothing
  kajo diff reference.png out.png --share 0.5      fails if more than 0.5 % of the pixels are off

Exit codes:
  0  success                                       5  a file could not be written
  1  pictures, or rows of a test, differ           6  not enough memory
  2  a wrong scene, picture or command line      130  interrupted
  3  work is missing that may come yet            75  interrupted; what was finished is kept
  4  a bug in kajo";

/// A ray tracer.
#[derive(Debug, Parser)]
#[command(
    name = "kajo",
    version,
    after_help = EXAMPLES,
    override_usage = "kajo SCENE [OPTIONS]\n       kajo\n       kajo <COMMAND> ...\n       kajo -input SCENE -output FILE [CLASSIC OPTIONS]",
    arg_required_else_help = true,
    disable_help_subcommand = true,
    args_override_self = true
)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene with the modern command line; `kajo SCENE` is short for it
    #[command(allow_negative_numbers = true)]
    Render(Box<RenderArgs>),
    /// Render a scene with the classic command line; `kajo -input SCENE` is short for it
    #[command(allow_negative_numbers = true)]
    Classic(Box<ClassicArgs>),
    /// Cut a render into units for many workers
    #[command(allow_negative_numbers = true)]
    Plan(Box<PlanArgs>),
    /// Render units of a plan
    Unit(UnitArgs),
    /// Put the units of a plan together and write the picture
    Merge(MergeArgs),
    /// Render units as another program asks for them
    Worker(WorkerArgs),
    /// Put a scene and all its files into one file
    Bundle(BundleArgs),
    /// Render on a cluster
    Farm(FarmCommandArgs),
    /// Read scenes and report every mistake, without rendering
    Check(CheckArgs),
    /// Tell what is in a scene
    Info(InfoArgs),
    /// Write the scene that shows a model, to go on with
    Convert(ConvertArgs),
    /// Make textures that depend on view and light
    Btf(BtfArgs),
    /// Make tiled copies of pictures before they are needed, list them, remove them
    Texture(TextureCommandArgs),
    /// Compare two pictures
    #[command(allow_negative_numbers = true)]
    Diff(DiffArgs),
    /// Render every scene of a list to a folder with a page that shows them
    Gallery(GalleryArgs),
    /// Measure how fast it is
    Bench(BenchArgs),
    /// Render scenes whose light is known by a formula, and compare
    Selftest(SelftestArgs),
    /// Open the window: fly through a scene, trace it, edit it; `kajo` alone is short for it
    Studio(StudioArgs),
    /// Print completions for a shell
    Completions(CompletionsArgs),
    /// Explain a command, or the fields of a block of the scene language
    Help(HelpArgs),
}

/// `kajo check`
#[derive(Args, Debug)]
pub struct CheckArgs {
    /// Scene files
    #[arg(required = true, value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// Print one line a message, as compilers do
    #[arg(long)]
    pub short: bool,
    #[command(flatten)]
    pub scene_args: SceneArgs,
}

/// `kajo studio`
#[derive(Args, Debug, Default)]
pub struct StudioArgs {
    /// Scene file
    pub scene: Option<PathBuf>,
}

/// `kajo info`
#[derive(Args, Debug)]
pub struct InfoArgs {
    /// Scene file
    pub scene: PathBuf,
    /// Print JSON for other programs
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub scene_args: SceneArgs,
}

/// `kajo convert`
#[derive(Args, Debug)]
pub struct ConvertArgs {
    /// The model: glTF, OBJ, PLY or STL
    pub model: PathBuf,
    /// The scene; `-` is standard output. By default a file of the same name that ends in .txt
    pub scene: Option<PathBuf>,
    /// Write over a scene that is there already
    #[arg(long)]
    pub force: bool,
    #[command(flatten)]
    pub model_args: ModelArgs,
}

/// `kajo diff`
#[derive(Args, Debug)]
pub struct DiffArgs {
    /// The picture to compare with
    pub reference: PathBuf,
    /// The picture to judge
    pub picture: PathBuf,
    /// Write where they differ, in the colours of FLIP: black where they agree
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// How far off a channel may be, in steps of 1/255
    #[arg(long, value_name = "N", default_value_t = 2.0, value_parser = values::not_negative)]
    pub max_off: f64,
    /// Fail (exit code 1) when more than this percentage of the pixels is off
    #[arg(long, value_name = "PERCENT", value_parser = values::not_negative)]
    pub share: Option<f64>,
}

/// `kajo gallery`
#[derive(Args, Debug)]
#[command(after_help = "\
Each line of the list is a name, a scene file beside the list, and arguments of the classic command line:
  # name        scene                        arguments
  five_spheres  r1+r2_02_five_spheres.txt    -size 200 200 -depth 8 12 @.depth.png -normals @.normals.png
`@` at the start of an argument stands for OUT/name; the picture itself goes to OUT/name.png unless -output says
otherwise. Names with blanks stand in double quotes. A list writes to OUT only and names scenes in its own folder;
options that lift limits stand here, not in the list.")]
pub struct GalleryArgs {
    /// The list of scenes
    pub manifest: PathBuf,
    /// The folder for the pictures and the page; made if it is not there
    pub out: PathBuf,
    #[command(flatten)]
    pub scene_args: SceneArgs,
    #[command(flatten)]
    pub run: RunArgs,
}

/// `kajo completions`
#[derive(Args, Debug)]
pub struct CompletionsArgs {
    /// The shell
    pub shell: Shell,
}

/// `kajo help`
#[derive(Args, Debug)]
pub struct HelpArgs {
    /// A command, or a block such as Sphere; without any, all of them
    pub topic: Vec<String>,
}

impl Cli {
    /// The tree of commands, built.
    pub fn tree() -> clap::Command {
        let mut command = Cli::command();
        command.build();
        command
    }

    /// Reads a whole command line, the program's name first.
    ///
    /// # Errors
    /// `clap`'s, which also stands for `--help` and `--version`.
    pub fn read(line: Vec<OsString>) -> Result<Cli, clap::Error> {
        let line = normalise(line, &Cli::tree())?;
        Cli::try_parse_from(line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_is_sound() {
        Cli::command().debug_assert();
    }
}
