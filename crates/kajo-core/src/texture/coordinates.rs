//! Where pictures are laid on a surface, and what its vertices multiply them by.

use kajo_math::Vec2;

/// What a surface says of one of its places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceUv {
    /// Surface coordinates.
    pub first: Vec2,
    /// A second set of them; those of the first where there is none.
    pub second: Vec2,
    /// Linear red, green, blue and opacity, in [0, 1]; all 1 where vertices have no colours.
    pub color: [f32; 4],
}

impl Default for SurfaceUv {
    fn default() -> SurfaceUv {
        Vec2::ZERO.into()
    }
}

impl From<Vec2> for SurfaceUv {
    fn from(uv: Vec2) -> SurfaceUv {
        SurfaceUv { first: uv, second: uv, color: [1.0; 4] }
    }
}

impl SurfaceUv {
    /// The place that is this step away in both sets of coordinates.
    pub fn moved(self, step: Vec2) -> SurfaceUv {
        SurfaceUv { first: self.first + step, second: self.second + step, ..self }
    }
}

/// One of the two sets of coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UvSet {
    /// [`SurfaceUv::first`].
    #[default]
    First,
    /// [`SurfaceUv::second`].
    Second,
}
