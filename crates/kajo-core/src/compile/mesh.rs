//! `TriangleMesh` blocks.
use super::Compiler;
use crate::shape::ShapeId;
use kajo_scene::Item;
use std::collections::HashMap;
/// Meshes read so far.
#[derive(Default)]
pub(super) struct MeshCache {
    _by_file: HashMap<String, ShapeId>,
}
impl Compiler<'_> {
    pub(super) fn mesh(&mut self, _item: Item<'_>) -> Option<ShapeId> {
        None
    }
}
