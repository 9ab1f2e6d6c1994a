//! What came of compiling the texts of a document.

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
    /// What it was made from.
    pub tree: Arc<Tree>,
}
