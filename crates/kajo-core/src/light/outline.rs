//! What is drawn of a light in a view of the scene without its light.

use kajo_math::Vec3;

/// The outline of a light, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightOutline {
    /// None: the light is a surface that is seen itself, or all around.
    None,
    /// A point that light comes from.
    Star(Vec3),
    /// Cones into which light goes.
    Cone {
        /// Where it comes from.
        apex: Vec3,
        /// Unit direction, away from the light.
        axis: Vec3,
        /// Cosines of the half angles: that within which light is full, and that beyond which there is none.
        cosines: [f32; 2],
    },
    /// Parallel light; the unit direction towards where it comes from.
    Direction(Vec3),
}
