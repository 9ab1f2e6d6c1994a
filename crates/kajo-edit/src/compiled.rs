//! What came of compiling the texts of a document.

use std::collections::HashSet;
use std::sync::Arc;

use kajo_core::scene::Scene;
use kajo_scene::{Diagnostics, SceneDesc};

use super::NodeId;
use super::tree::Tree;

/// What came of a [`Compilation`](super::Compilation).
#[derive(Clone, Debug, Default)]
pub struct Compiled {
    /// Of the texts; `None` before the first.
    pub(super) generation: Option<u64>,
    pub(super) diagnostics: Diagnostics,
    /// The tree that was compiled: its texts are those that messages point into.
    pub(super) desc: Arc<SceneDesc>,
    pub(super) made: Option<Made>,
}

/// A scene, and the nodes that its objects come from.
#[derive(Clone, Debug)]
pub(super) struct Made {
    pub scene: Arc<Scene>,
    /// [`Document::generation`](super::Document::generation) of the texts it was made from.
    pub generation: u64,
    /// For each object of no nested instance the nodes that place it and that describe it.
    pub objects: Arc<[[Option<NodeId>; 2]]>,
    /// The keys of models that follow the frames.
    pub models: Arc<[ModelRow]>,
    /// What it was made from.
    pub tree: Arc<Tree>,
}

/// When a model has keys that stand in its file.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelRow {
    /// The block that places the model.
    pub node: NodeId,
    /// What it is called: the words of the block and of the animation.
    pub name: String,
    /// The frames at which it has keys, with fractions where they fall between two; each later than the one before.
    pub frames: Vec<f64>,
}

/// The keys of a scene's models.
pub(super) fn model_rows(scene: &Scene, tree: &Tree) -> Vec<ModelRow> {
    let Some(animation) = scene.output.animation else { return Vec::new() };
    let first = animation.first_frame() as f64;
    let mut rows = Vec::new();
    let mut seen = HashSet::new();
    for model in &scene.output.animated_models {
        let Some(node) = tree.outline.at_item(model.item) else { continue };
        // Blocks that are repeated have one text.
        if !seen.insert((node.file, node.span.start)) {
            continue;
        }
        let block = node.name.as_deref().unwrap_or(&node.keyword);
        let name = model.name.as_deref().unwrap_or("animation");
        let frames = model.key_times.iter().map(|seconds| first + seconds * animation.fps).collect();
        rows.push(ModelRow { node: node.id, name: format!("{block}: {name}"), frames });
    }
    rows
}
