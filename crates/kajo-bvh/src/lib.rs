//! Bounding volume hierarchies: which primitives can a ray meet?
//!
//! [`Bvh`] stands over boxes of anything, [`MovingBvh`] over boxes that move; [`TriangleBvh`]
//! over triangles, which it also intersects. None knows shapes, materials or scenes.
//!
//! A tree is built as a binary one by the surface area heuristic, improved by moving
//! subtrees, and collapsed into nodes of eight children, whose boxes one vector instruction
//! tests at a time. Triangles are tested four at a time, watertight. Instructions are chosen
//! at run time; what a ray hits is the same, bit for bit, on every machine, for any number of
//! threads that built the tree, and without a tree.
//!
//! ```
//! use kajo_bvh::{BuildSettings, TriangleBvh};
//! use kajo_math::{Ray, Vec3};
//!
//! let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
//! let tree = TriangleBvh::build(&positions, &[[0, 1, 2]], &BuildSettings::default())?;
//! let hit = tree.closest(&Ray::new(Vec3::new(0.25, 0.5, -3.0), Vec3::Z)).unwrap();
//! assert_eq!((hit.t, hit.u, hit.v, hit.triangle), (3.0, 0.25, 0.5, 0));
//! # Ok::<(), kajo_bvh::BuildError>(())
//! ```

mod array;
#[cfg(feature = "bench")]
pub mod bench;
mod boxes;
mod build;
mod group;
mod moving;
mod node;
#[cfg(any(test, feature = "bench"))]
mod packet;
mod refit;
mod simd;
mod slabs;
#[cfg(test)]
mod tests;
mod triangles;
#[cfg(any(test, feature = "bench"))]
mod visits;
mod walk;

pub use boxes::Bvh;
pub use group::TriangleHit;
pub use moving::MovingBvh;
pub use simd::instructions;
pub use triangles::TriangleBvh;
#[cfg(any(test, feature = "bench"))]
pub use visits::Visits;

/// How much time to spend on a tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Along a space-filling curve: two thirds of the time of `Fast` to build, and 5 to 15 %
    /// slower to trace. For what changes with every picture.
    Linear,
    /// Binned surface area heuristic, with the top of the tree improved.
    #[default]
    Fast,
    /// Triangles cut where that makes boxes smaller, and all of the tree improved: several times as
    /// long to build, and faster to trace where triangles are long or differ much in size. A
    /// tree refers to triangles at most 1.3 times as often as there are any.
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
