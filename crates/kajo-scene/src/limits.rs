//! What a scene may cost before it is refused.
//!
//! Every reader of this crate takes a [`Limits`], so that no file, however
//! short, can ask for unbounded time or memory.

use crate::memory_budget::MemoryBudget;

/// Upper bounds on what readers accept; exceeding one ends in an error that names it.
///
/// ```
/// use kajo_scene::Limits;
/// let strict = Limits { nesting: 32, ..Limits::default() };
/// assert!(strict.items > 0);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of scene text, summed over every file each time it is included. At most `u32::MAX`.
    pub text_bytes: u64,
    /// Blocks inside blocks.
    pub nesting: usize,
    /// Files including files.
    pub include_depth: usize,
    /// `include` statements followed, in all.
    pub includes: usize,
    /// Items of the tree, after includes were followed.
    pub items: usize,
    /// Objects of a scene, each as often as it is placed; what is kept nested counts as it is written. The instances of
    /// a definition are nested where they would be more than a sixteenth of this.
    pub objects: usize,
    /// Errors of one parse before it gives up.
    pub errors: usize,
    /// Bytes of one mesh or material file, which is read piece by piece.
    pub mesh_bytes: u64,
    /// Bytes of one glTF model with the files that it names, all of which are held in memory.
    pub model_bytes: u64,
    /// Bytes of one file with a picture, which is held in memory.
    pub picture_bytes: u64,
    /// Bytes of one line of a mesh or material file, continuations included.
    pub line_bytes: usize,
    /// Vertex positions of one mesh; the same bound holds for its normals and its texture coordinates.
    pub vertices: usize,
    /// Triangles of one mesh, after polygons were split.
    pub faces: usize,
    /// Corners of one polygon.
    pub polygon_corners: usize,
    /// Materials of one mesh, material or model file.
    pub materials: usize,
    /// Memory for all of the scene together.
    pub memory: MemoryBudget,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            text_bytes: 1 << 30,
            nesting: 256,
            include_depth: 32,
            includes: 10_000,
            items: 10_000_000,
            objects: 10_000_000,
            errors: 1000,
            mesh_bytes: 64 << 30,
            model_bytes: 8 << 30,
            picture_bytes: 2 << 30,
            line_bytes: 1 << 20,
            vertices: 1 << 30,
            faces: 1 << 30,
            polygon_corners: 4096,
            materials: 1 << 20,
            memory: MemoryBudget::default(),
        }
    }
}
