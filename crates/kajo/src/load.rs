//! From a file to a scene ready to be rendered, with all diagnostics.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kajo_core::animation::Animation;
use kajo_core::compile::{animation_of, clock_of, compile};
use kajo_core::scene::Scene;
use kajo_core::texture::TileCache;
use kajo_scene::{
    Assets, Clock, Diagnostic, Diagnostics, Limits, MemoryBudget, Parsed, READ_FORMATS, SceneDesc, Sources,
    one_line, render,
};

use crate::model_scene::ModelFile;
use crate::{FsAssets, LoadOptions, SceneDigest};

/// What came of reading a scene.
#[derive(Debug)]
pub struct Loaded {
    /// The tree of its text, complete unless there are errors.
    pub desc: SceneDesc,
    /// Everything worth saying, in the order it came up.
    pub diagnostics: Diagnostics,
    /// The scene; `None` when there are errors.
    pub scene: Option<Scene>,
    /// Real paths of the files it was read from.
    pub files: Vec<PathBuf>,
    /// What it was read from, where that is no file.
    pub digest: Option<SceneDigest>,
    /// The tiles of pictures that are not in memory as a whole.
    pub tiles: Option<Arc<TileCache>>,
    /// The memory it takes, and what is left of that which it may take.
    pub memory: MemoryBudget,
}

impl Loaded {
    /// Whether there is no scene for want of memory.
    pub fn is_out_of_memory(&self) -> bool {
        self.scene.is_none() && self.memory.was_exceeded()
    }

    /// The texts that the messages point into.
    pub fn sources(&self) -> &Sources {
        self.desc.sources()
    }

    /// The messages as they are shown to people, with the lines they are about; in colour on request.
    pub fn report(&self, color: bool) -> String {
        render(&self.diagnostics, self.sources(), color)
    }

    /// One line a message: `file:line:column: error: what`.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        self.diagnostics.iter().map(|diagnostic| one_line(diagnostic, self.sources()))
    }
}

/// Reads the scene at `path` and all it names.
///
/// Never fails: what is wrong is in [`Loaded::diagnostics`].
pub fn load(path: &Path, options: &LoadOptions) -> Loaded {
    match options.assets(path) {
        Ok(assets) => {
            let loaded = match ModelFile::find(path, &assets) {
                Some(model) => load_model(&model, &assets, options),
                None => load_from(assets.scene_name(), &assets, options),
            };
            Loaded { files: assets.opened(), ..loaded }
        }
        Err(problem) => {
            let mut diagnostics = Diagnostics::new();
            diagnostics.push(Diagnostic::error(problem));
            let (desc, memory) = (SceneDesc::default(), MemoryBudget::default());
            Loaded { desc, diagnostics, scene: None, files: Vec::new(), digest: None, tiles: None, memory }
        }
    }
}

/// As [`load`], with files from anywhere; the folders of `options` are not looked at.
///
/// ```
/// use kajo::{LoadOptions, MemoryAssets};
///
/// let assets = MemoryAssets::new().with("ball.txt", "Group { Sphre { center 0 0 0  radius 1 } }");
/// let loaded = kajo::load_from("ball.txt", &assets, &LoadOptions::default());
/// assert!(loaded.scene.is_none());
/// assert!(loaded.lines().any(|line| line.starts_with("ball.txt:1:9: error: ")));
/// ```
pub fn load_from(name: &str, assets: &dyn Assets, options: &LoadOptions) -> Loaded {
    let parse = |clock: &Clock, limits: &Limits| SceneDesc::load_at(name, assets, limits, clock);
    let (mut parsed, limits) = parse_scene(options, || options.budgeted(), parse);
    if parsed.desc.is_empty() && !parsed.diagnostics.has_errors() {
        let error = Diagnostic::error(format!("`{name}` is empty: there is no scene in it"));
        let help = format!("{READ_FORMATS}; what follows a `#` or `//` is a comment");
        parsed.diagnostics.push(error.help(help));
        parsed.whole = false;
    }
    compiled(parsed, assets, options, limits)
}

/// A model with the scene around it.
fn load_model(model: &ModelFile, assets: &FsAssets, options: &LoadOptions) -> Loaded {
    let mut said = Diagnostics::new();
    let scene = model.scene(model.name(), assets, options, &mut said);
    let (mut parsed, limits) = parse_scene(
        options,
        || options.budgeted(),
        |clock, limits| SceneDesc::parse_at(&model.scene_name(), scene.text.as_str(), assets, limits, clock),
    );
    said.iter().for_each(|diagnostic| parsed.diagnostics.push(diagnostic.clone()));
    compiled(parsed, assets, &LoadOptions { model_cameras_first: true, ..options.clone() }, limits)
}

/// Parses a scene as it is at the frame that `options` ask for; returns the limits that what is made of it is within too.
///
/// When that frame is, and when its shutter is open, the text itself may say: one that depends on the time is parsed twice.
///
/// * `limits`: makes limits with a budget of which nothing is used
/// * `parse`: parses the text for the moments of a clock
pub fn parse_scene(
    options: &LoadOptions,
    limits: impl Fn() -> Limits,
    parse: impl Fn(&Clock, &Limits) -> Parsed,
) -> (Parsed, Limits) {
    let within = limits();
    let mut parsed = parse(&Clock::default(), &within);
    let compile_options = options.compile_options(within.clone());
    let Some(clock) = clock_of(&parsed.desc, &compile_options) else { return (parsed, within) };
    if !parsed.desc.changes() {
        parsed.desc.set_clock(clock);
        return (parsed, within);
    }
    drop((parsed, within));
    let within = limits();
    (parse(&clock, &within), within)
}

/// What the scene at `path` says about its frames; `None` where it says nothing, or cannot be read.
pub fn animation(path: &Path, options: &LoadOptions) -> Option<Animation> {
    let assets = options.assets(path).ok().filter(|assets| ModelFile::find(path, assets).is_none())?;
    let limits = options.budgeted();
    let parsed = SceneDesc::load(assets.scene_name(), &assets, &limits);
    animation_of(&parsed.desc, &options.compile_options(limits))
}

fn compiled(parsed: Parsed, assets: &dyn Assets, options: &LoadOptions, limits: Limits) -> Loaded {
    let memory = limits.memory.clone();
    let Parsed { mut desc, mut diagnostics, whole } = parsed;
    let compile_options = options.compile_options(limits);
    // A text that could not be read whole would only give complaints about what is missing from it.
    let scene = match whole {
        true => compile(&mut desc, assets, &compile_options, &mut diagnostics),
        false => None,
    };
    let tiles = compile_options.tiled.map(|tiled| tiled.cache);
    Loaded { desc, diagnostics, scene, files: Vec::new(), digest: None, tiles, memory }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_scene_is_read_with_its_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.txt");
        fs::write(&path, "include \"camera.txt\"\nMaterials { Material {} } Group { MaterialIndex 0 Sphere { center 0 0 0  radius 1 } }").unwrap();
        let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";
        fs::write(folder.path().join("camera.txt"), camera).unwrap();
        let loaded = load(&path, &LoadOptions::default());
        assert!(loaded.scene.is_some(), "{}", loaded.report(false));
        assert_eq!(loaded.files.len(), 2);
    }

    #[test]
    fn slips_of_the_pen_do_not_hide_other_mistakes() {
        let text = "PerspectiveCamera { center 0 0 nan direction 0 0 -1 up 0 1 0 angle 3O }
            Group { Sphre { center 0 0 0 radius 1 } }";
        let assets = kajo_scene::MemoryAssets::new().with("a.txt", text);
        let loaded = load_from("a.txt", &assets, &LoadOptions::default());
        let lines: Vec<_> = loaded.lines().collect();
        assert_eq!(lines.len(), 3, "{lines:#?}");
        // What is cut off only draws complaints about what is missing, so the cut is all that is said.
        let assets = kajo_scene::MemoryAssets::new().with("a.txt", "Group { Sphre {");
        assert!(
            load_from("a.txt", &assets, &LoadOptions::default()).lines().all(|l| l.contains("not closed"))
        );
    }

    #[test]
    fn what_is_wrong_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let missing = load(&folder.path().join("scene.txt"), &LoadOptions::default());
        assert!(missing.report(false).contains("there is no such file"));
        let nowhere = load(&folder.path().join("nowhere/scene.txt"), &LoadOptions::default());
        assert!(nowhere.report(false).contains("cannot enter the folder"));
        let options = LoadOptions { folders: vec![folder.path().join("lost")], ..LoadOptions::default() };
        let lost = load(&folder.path().join("scene.txt"), &options);
        assert!(lost.report(false).contains("lost"));
    }
}
