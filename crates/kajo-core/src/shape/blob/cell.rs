//! Boxes in double precision.

use kajo_math::{Aabb, DVec3};

use crate::shape::Ray64;
use crate::shape::box_faces::around;

/// A box in double precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub min: DVec3,
    pub max: DVec3,
}

impl Cell {
    /// The axis along which it is longest.
    fn longest(&self) -> DVec3 {
        let size = self.max - self.min;
        if size.x >= size.y.max(size.z) {
            DVec3::X
        } else if size.y >= size.z {
            DVec3::Y
        } else {
            DVec3::Z
        }
    }

    /// Its halves across its longest side.
    pub fn halves(&self) -> [Cell; 2] {
        let half = 0.5 * (self.max - self.min) * self.longest();
        [Cell { max: self.max - half, ..*self }, Cell { min: self.min + half, ..*self }]
    }

    /// [`Cell::halves`] that share the plane between them, to the bit; so do cells that other cells were halved to.
    pub fn joined_halves(&self) -> [Cell; 2] {
        let (middle, across) = (self.middle(), self.longest().cmpgt(DVec3::ZERO));
        [
            Cell { max: DVec3::select(across, middle, self.max), ..*self },
            Cell { min: DVec3::select(across, middle, self.min), ..*self },
        ]
    }

    /// Its center.
    #[inline]
    pub fn middle(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// With a margin around it.
    #[inline]
    pub fn padded(&self, margin: f64) -> Cell {
        Cell { min: self.min - margin, max: self.max + margin }
    }

    /// Whether it holds a point.
    #[inline]
    pub fn contains(&self, p: DVec3) -> bool {
        self.min.cmple(p).all() && p.cmple(self.max).all()
    }

    /// A box of single precision around it.
    pub fn bounds(&self) -> Aabb {
        around([self.min, self.max])
    }

    /// The piece of a line in it and in a range of parameters; none where it has no length. Cells give the same parameter for a plane
    /// that they share.
    ///
    /// * `inverse`: one over each coordinate of the line's direction
    #[inline]
    pub fn clip(&self, line: &Ray64, inverse: DVec3, [mut from, mut to]: [f64; 2]) -> Option<[f64; 2]> {
        for axis in 0..3 {
            let (o, low, high) = (line.o[axis], self.min[axis], self.max[axis]);
            if line.d[axis] == 0.0 {
                if !(low <= o && o < high) {
                    return None;
                }
                continue;
            }
            let [a, b] = [(low - o) * inverse[axis], (high - o) * inverse[axis]];
            from = from.max(a.min(b));
            to = to.min(a.max(b));
        }
        (from < to).then_some([from, to])
    }

    /// The least and the largest distance of its points from `p`, squared.
    pub fn distances2(&self, p: DVec3) -> [f64; 2] {
        let (below, above) = (self.min - p, p - self.max);
        let outside = below.max(above).max(DVec3::ZERO);
        [outside.length_squared(), below.abs().max(above.abs()).length_squared()]
    }
}
