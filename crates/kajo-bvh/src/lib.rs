//! Bounding volume hierarchies: which primitives can a ray meet?
//!
//! [`Bvh`] stands over boxes of anything; [`TriangleBvh`] over triangles, which it also
//! intersects. Neither knows shapes, materials or scenes.

#[cfg(feature = "bench")]
pub mod bench;
mod boxes;
mod build;
mod group;
mod node;
mod simd;
mod slabs;
#[cfg(test)]
mod tests;
mod triangles;
mod walk;

pub use boxes::Bvh;
pub use group::TriangleHit;
pub use triangles::TriangleBvh;

/// How much time to spend on a tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Binned surface area heuristic.
    #[default]
    Fast,
    /// Slower to build, faster to trace.
    High,
}

/// What a tree is built for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BuildSettings {
    /// How much time to spend.
    pub quality: Quality,
}

/// Why no tree could be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BuildError {
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} refers to vertex {index}, but there are {vertices} vertices")]
    IndexOutOfRange {
        /// The triangle.
        triangle: usize,
        /// The index it holds.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// More primitives than 32-bit references can tell apart.
    #[error("{0} primitives are more than a tree can hold")]
    TooMany(usize),
}

/// What a finished tree looks like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Inner nodes.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// Inner nodes on the longest way from the root to a leaf.
    pub depth: usize,
    /// Primitives that cannot be hit and were left out: empty boxes, triangles without area
    /// or with a coordinate that is not finite.
    pub dropped: usize,
    /// Memory held, in bytes.
    pub bytes: usize,
}
