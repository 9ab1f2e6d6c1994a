//! kajo, a ray tracer: load a scene, render it, write pictures.
//!
//! This crate is all that a program needs that uses kajo; the command line is one such program. A render is
//! three steps, each a function: [`load`] reads a scene and says what is wrong with it, [`render()`] makes a
//! picture of it, and [`Picture::encode`] turns that into the bytes of a file, which
//! [`output::Target`] writes whole or not at all.
//!
//! ```
//! use kajo::{Defaults, Format, LoadOptions, MemoryAssets, RenderRequest, RenderSettings, Settings, Silent, View};
//!
//! let text = "
//!     PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }
//!     Lights { DirectionalLight { direction -1 -1 -1  color 1 1 1 } }
//!     Materials { Material gold { diffuseColor 1 0.8 0.2 } }
//!     Group { MaterialIndex gold  Sphere { center 0 0 0  radius 1 } }";
//! let assets = MemoryAssets::new().with("ball.txt", text);
//! let loaded = kajo::load_from("ball.txt", &assets, &LoadOptions::default());
//! let scene = loaded.scene.as_ref().expect("the scene has no errors");
//!
//! let asked = Settings { size: Some([64, 48]), ..Settings::default() };
//! let settings = RenderSettings::resolve(scene, &asked, Defaults::Modern, false)?;
//! let outputs = [(View::Color, Format::Png)];
//! let picture = kajo::render(&RenderRequest::new(scene, &settings, &outputs), &Silent)?;
//! let png = picture.encode(&[View::Color], Format::Png, kajo::BitDepth::Eight)?;
//! assert!(png.starts_with(b"\x89PNG"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod assets;
pub mod btf;
pub mod build;
mod camera_pose;
mod checkpoint;
pub mod compare;
mod denoise;
mod development;
pub mod diagrams;
pub mod epoch;
mod info;
pub mod language;
mod load;
mod load_options;
pub mod memory;
mod model_scene;
pub mod output;
pub mod probe;
mod reduction;
mod render;
mod scene_digest;
pub mod session;
mod settings;
mod split_render;
mod tev;
mod texture_folder;
pub mod turntable;
mod view;

pub use assets::{FsAssets, LoadProgress};
pub use camera_pose::{CameraPose, Stroke};
pub use checkpoint::{CheckpointError, Kept};
pub use denoise::{DENOISE_OUTPUTS, DenoiseError, Denoiser};
pub use development::Development;
pub use info::{ObjectInfo, SceneInfo, TreeNode};
pub use load::{Loaded, animation, load, load_from, parse_scene};
pub use load_options::{LoadOptions, ModelOptions, UpAxis};
pub use model_scene::{ConvertError, ModelScene, model_scene, model_text};
pub use reduction::Reduction;
pub use render::{Passes, Picture, RenderError, RenderRequest, Resources, Snapshot, render, render_passes};
pub use scene_digest::SceneDigest;
pub use settings::{RenderSettings, SettingsError, suitable_size};
pub use split_render::{SplitRender, WorkUnit};
pub use tev::Tev;
pub use texture_folder::TextureFolder;
pub use view::View;

pub use kajo_color::Tone;
pub use kajo_color::gamut::{self, Gamut};
pub use kajo_core::RayOffset;
pub use kajo_core::animation::Animation;
pub use kajo_core::bsdf::Highlight;
pub use kajo_core::compile::{LAST_FRAME, MeshStore};
pub use kajo_core::light::LightChoice;
pub use kajo_core::sampler::SamplerKind;
pub use kajo_core::scene::Scene;
pub use kajo_core::settings::{
    Caustics, Dialect, Directions, FilterChoice, Gradients, IntegratorName, MakeFilter, PhotonMapUse,
    Settings, SettingsKey, ShadowAttenuation, Shadows, Technique,
};
pub use kajo_core::texture::{Encoding, TexelFilter, TileCache};
pub use kajo_image::{BitDepth, EncodeOptions, Format, Image, ImageError, encode, is_contained};
pub use kajo_math;
pub use kajo_render::integrator::CHOICES as INTEGRATOR_CHOICES;
pub use kajo_render::integrator::classic::MAX_BOUNCES;
pub use kajo_render::integrator::{AUTO, Defaults, INTEGRATORS, IntegratorSettings, IntegratorSpec};
pub use kajo_render::schedule::{LARGEST_TILE, MOST_THREADS};
pub use kajo_render::{
    ClampedLight, Film, Goal, KeptState, LARGEST_R_HAT, Position, Progress, RayCounters, Rect, RenderStats,
    Silent,
};
pub use kajo_scene::{
    AssetError, AssetFile, Assets, Diagnostic, Diagnostics, Limits, LoadStep, MemoryAssets, MemoryBudget,
    Severity, Sources, TokenKind, nearest, printable, relative_asset, tokens,
};
