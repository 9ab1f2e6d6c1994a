//! Boxes in double precision.

use kajo_math::DVec3;

/// A box in double precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub min: DVec3,
    pub max: DVec3,
}

impl Cell {
    /// Its halves across its longest side.
    pub fn halves(&self) -> [Cell; 2] {
        let size = self.max - self.min;
        let axis = if size.x >= size.y.max(size.z) {
            DVec3::X
        } else if size.y >= size.z {
            DVec3::Y
        } else {
            DVec3::Z
        };
        let half = 0.5 * size * axis;
        [Cell { max: self.max - half, ..*self }, Cell { min: self.min + half, ..*self }]
    }

    /// The least and the largest distance of its points from `p`, squared.
    pub fn distances2(&self, p: DVec3) -> [f64; 2] {
        let (below, above) = (self.min - p, p - self.max);
        let outside = below.max(above).max(DVec3::ZERO);
        [outside.length_squared(), below.abs().max(above.abs()).length_squared()]
    }
}
