//! The arguments of `kajo texture`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use kajo::Encoding;

use super::common::TextureFolderArgs;
use super::values;

/// `kajo texture`
#[derive(Args, Debug)]
pub struct TextureCommandArgs {
    /// What to do
    #[command(subcommand)]
    pub command: TextureCommand,
}

/// What to do with tiled copies of pictures.
#[derive(Debug, Subcommand)]
pub enum TextureCommand {
    /// Make those of pictures, unless they are there already
    Make(TextureMakeArgs),
    /// List those that there are, with their bytes
    List(TextureFolderArgs),
    /// Remove all
    Clear(TextureFolderArgs),
}

/// `kajo texture make`
#[derive(Args, Debug)]
pub struct TextureMakeArgs {
    /// The pictures
    #[arg(required = true, value_name = "PICTURE")]
    pub pictures: Vec<PathBuf>,
    /// What their numbers mean: linear for those of roughness, opacity, bumps and normals; by default the file decides, as for colours
    #[arg(long, value_parser = values::choice([("linear", Encoding::Linear), ("srgb", Encoding::Srgb)]))]
    pub encoding: Option<Encoding>,
    #[command(flatten)]
    pub folder: TextureFolderArgs,
}
