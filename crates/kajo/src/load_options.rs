//! What is known about a scene before it is read.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kajo_core::compile::{CompileOptions, MeshStore};
use kajo_core::settings::Dialect;
use kajo_core::texture::TexelFilter;
use kajo_math::Vec3;
use kajo_render::integrator;
use kajo_scene::{Limits, MemoryBudget};

use crate::{FsAssets, LoadProgress, TextureFolder, memory};

/// What is known about a scene before it is read.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// The dialect, where it is not to be the scene's own choice.
    pub dialect: Option<Dialect>,
    /// How pictures are filtered that do not say it themselves, where that is not to be the scene's own choice.
    pub texture_filter: Option<TexelFilter>,
    /// Folders besides the scene's own whose files it may name.
    pub folders: Vec<PathBuf>,
    /// Whether it may name any file at all.
    pub allow_outside: bool,
    /// Bounds on what it may demand; those on memory are the following.
    pub limits: Limits,
    /// Bytes that all of the scene may take; `None` for what the system has left.
    pub memory: Option<u64>,
    /// The name of the camera that takes the picture; the last one of the scene without.
    pub camera: Option<String>,
    /// Width of the picture over its height, for cameras that fit something into it, in place of that of the scene.
    pub aspect: Option<f64>,
    /// The frame to show, for scenes that change with time; the first one without.
    pub frame: Option<i64>,
    /// Frames of a second, above 0, where they are not to be the scene's own choice.
    pub fps: Option<f64>,
    /// Meshes of scenes that were read before, which need not be read again. The same store is for the same
    /// [`LoadOptions::limits`].
    pub meshes: Option<Arc<MeshStore>>,
    /// Where tiled copies of large pictures are kept; without it all pictures are in memory as a whole.
    pub textures: Option<TextureFolder>,
    /// How a model that is no scene is shown.
    pub model: ModelOptions,
    /// Whether cameras of models come before those of the scene: so for a model that is no scene.
    pub model_cameras_first: bool,
    /// Progress callback.
    pub progress: Option<Arc<dyn LoadProgress>>,
}

impl LoadOptions {
    /// The bounds, with a budget of memory of which nothing is used.
    pub fn budgeted(&self) -> Limits {
        let memory = MemoryBudget::new(self.memory.unwrap_or_else(memory::available));
        Limits { memory, ..self.limits.clone() }
    }

    /// The same for the compiler, within these bounds.
    pub fn compile_options(&self, limits: Limits) -> CompileOptions {
        let memory = limits.memory.used().saturating_add(limits.memory.left());
        CompileOptions {
            dialect: self.dialect,
            texture_filter: self.texture_filter,
            tiled: self.textures.as_ref().map(|textures| textures.copies(memory)),
            limits,
            camera: self.camera.clone(),
            aspect: self.aspect,
            frame: self.frame,
            fps: self.fps,
            meshes: self.meshes.clone(),
            model_cameras_first: self.model_cameras_first,
            integrators: &integrator::CHOICES,
            ..CompileOptions::default()
        }
    }

    /// The files that the scene at `path` may name.
    ///
    /// # Errors
    /// When its folder, or one of [`LoadOptions::folders`], cannot be entered: why, in words.
    pub fn assets(&self, path: &Path) -> Result<FsAssets, String> {
        let open = |folder: &Path, error: io::Error| {
            format!("cannot enter the folder `{}`: {error}", folder.display())
        };
        let mut assets = FsAssets::new(path).map_err(|error| match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => open(folder, error),
            _ => open(Path::new("."), error),
        })?;
        for folder in &self.folders {
            assets = assets.with_folder(folder).map_err(|error| open(folder, error))?;
        }
        Ok(assets.allow_outside(self.allow_outside).watched_by(self.progress.clone()))
    }
}

/// How a model is shown that is no scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ModelOptions {
    /// Which of its axes points up; by default y, and z for STL, whose programs have it so.
    pub up: Option<UpAxis>,
    /// Whether it stands on a ground.
    pub ground: bool,
}

/// A direction of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpAxis {
    /// Along +x.
    X,
    /// Along +y.
    Y,
    /// Along +z.
    Z,
    /// Along -x.
    MinusX,
    /// Along -y.
    MinusY,
    /// Along -z.
    MinusZ,
}

impl UpAxis {
    /// All directions, with the names that they are asked for by.
    pub const NAMES: [(&'static str, UpAxis); 6] = [
        ("x", UpAxis::X),
        ("y", UpAxis::Y),
        ("z", UpAxis::Z),
        ("-x", UpAxis::MinusX),
        ("-y", UpAxis::MinusY),
        ("-z", UpAxis::MinusZ),
    ];

    pub(crate) fn vector(self) -> Vec3 {
        match self {
            UpAxis::X => Vec3::X,
            UpAxis::Y => Vec3::Y,
            UpAxis::Z => Vec3::Z,
            UpAxis::MinusX => Vec3::NEG_X,
            UpAxis::MinusY => Vec3::NEG_Y,
            UpAxis::MinusZ => Vec3::NEG_Z,
        }
    }
}
