//! Options that several commands share.

use std::path::PathBuf;

use clap::Args;
use kajo::{
    Dialect, LARGEST_TILE, LoadOptions, MOST_THREADS, ModelOptions, Resources, TexelFilter, TextureFolder,
    UpAxis,
};

use super::values;

/// How a scene is read.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Reading the scene")]
pub struct SceneArgs {
    /// The lineage of the scene's format, where it is not to be the scene's own choice
    #[arg(long, value_parser = values::dialect())]
    pub dialect: Option<Dialect>,
    /// A folder besides the scene's own whose files it may name [may be repeated]
    #[arg(long, value_name = "DIR", action = clap::ArgAction::Append)]
    pub assets: Vec<PathBuf>,
    /// Let the scene name files anywhere; only for scenes you trust
    #[arg(long)]
    pub allow_outside: bool,
    /// The camera that takes the picture, by its name; the last one of the scene by default
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    #[command(flatten)]
    pub textures: TextureArgs,
    #[command(flatten)]
    pub model: ModelArgs,
}

/// How pictures on surfaces are kept.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Pictures on surfaces")]
pub struct TextureArgs {
    /// How pictures are filtered that do not say it themselves, where that is not to be the scene's own choice
    #[arg(long, value_name = "NAME", value_parser = values::choice(TexelFilter::NAMES))]
    pub texture_filter: Option<TexelFilter>,
    /// Memory for pictures, in MB, of which what is seen is read from tiled copies; by default whole pictures are kept for as long as there is room
    #[arg(long, value_name = "MB", value_parser = clap::value_parser!(u32).range(1..))]
    pub texture_memory: Option<u32>,
    #[command(flatten)]
    pub folder: TextureFolderArgs,
}

/// Where tiled copies are.
#[derive(Args, Clone, Debug, Default)]
pub struct TextureFolderArgs {
    /// The folder of tiled copies; by default that of KAJO_TEXTURES, or one among the caches of the user
    #[arg(long, value_name = "DIR")]
    pub texture_folder: Option<PathBuf>,
}

impl TextureFolderArgs {
    /// The folder; `None` where there is none.
    ///
    /// * `memory`: as [`TextureFolder::memory`]
    pub fn folder(&self, memory: Option<u64>) -> Option<TextureFolder> {
        let folder = self.texture_folder.clone().or_else(TextureFolder::of_user)?;
        Some(TextureFolder { folder, memory })
    }
}

/// How a model that is no scene is shown.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Models that are no scenes")]
pub struct ModelArgs {
    /// Which of its axes points up: x, y, z, or -y and so on; by default y, and z for STL
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, value_parser = values::choice(UpAxis::NAMES))]
    pub up: Option<UpAxis>,
    /// Put it on a ground
    #[arg(long)]
    pub ground: bool,
}

impl SceneArgs {
    /// The same for the loader.
    pub fn options(&self) -> LoadOptions {
        LoadOptions {
            dialect: self.dialect,
            texture_filter: self.textures.texture_filter,
            folders: self.assets.clone(),
            allow_outside: self.allow_outside,
            camera: self.camera.clone(),
            textures: self
                .textures
                .folder
                .folder(self.textures.texture_memory.map(|megabytes| u64::from(megabytes) * 1_000_000)),
            model: ModelOptions { up: self.model.up, ground: self.model.ground },
            ..LoadOptions::default()
        }
    }
}

/// How a render is run. None of it changes the picture.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Running")]
pub struct RunArgs {
    /// Threads, at most 1024; 0 for one on each core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=MOST_THREADS as i64))]
    pub threads: u16,
    /// Side of the tiles that threads work on, in pixels, at most 512; 0 for the default
    #[arg(long, value_name = "PIXELS", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=i64::from(LARGEST_TILE)))]
    pub tile: u32,
    /// Memory for the scene and the picture, in MB; what the system has left by default
    #[arg(long, value_name = "MB")]
    pub memory: Option<u32>,
    /// Say nothing but warnings and errors
    #[arg(short, long)]
    pub quiet: bool,
    /// Print numbers of rays and times at the end
    #[arg(long)]
    pub stats: bool,
    /// Show progress even where there is no terminal
    #[arg(long)]
    pub show_progress: bool,
    /// When interrupted, write what there is of the picture
    #[arg(long)]
    pub keep_partial: bool,
}

impl RunArgs {
    /// The same for the renderer.
    pub fn resources(&self) -> Resources {
        Resources {
            threads: self.threads.into(),
            tile: self.tile,
            memory: self.memory.map(|megabytes| u64::from(megabytes) * 1_000_000),
        }
    }
}
