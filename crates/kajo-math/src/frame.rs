//! The local frame of a surface, in which scattering is described.

use crate::{Vec3, warp};

/// A right-handed orthonormal frame: local coordinates are the components along `s`, `t` and `n`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Local x axis, the direction of the tangent where there is one.
    pub s: Vec3,
    /// Local y axis.
    pub t: Vec3,
    /// Local z axis, the normal.
    pub n: Vec3,
}

impl Frame {
    /// A frame around the unit normal `n`; its x axis points somewhere [Duff et al. 2017].
    #[inline]
    pub fn from_normal(n: Vec3) -> Frame {
        let (s, t) = warp::basis(n);
        Frame { s, t, n }
    }

    /// The frame around the unit normal `n` whose x axis is nearest to `tangent`.
    ///
    /// A tangent of no length, one along the normal and one that is no number give any frame around `n`.
    #[inline]
    pub fn from_tangent(n: Vec3, tangent: Vec3) -> Frame {
        let s = tangent - n.dot(tangent) * n;
        // Of a tangent nearly along the normal, nothing but rounding is left.
        let enough = 1e-8 * tangent.length_squared();
        if s.length_squared() > enough && s.is_finite() {
            let s = s.normalize();
            return Frame { s, t: n.cross(s), n };
        }
        Frame::from_normal(n)
    }

    /// The world-space vector `v` in local coordinates.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(self.s.dot(v), self.t.dot(v), self.n.dot(v))
    }

    /// The local vector `v` in world space.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_and_their_maps_invert_each_other() {
        let n = Vec3::new(0.6, -0.48, 0.64);
        let tangents = [
            Vec3::X,
            Vec3::new(-3.0, 0.1, 0.0),
            n,
            -2.0 * n,
            Vec3::ZERO,
            Vec3::splat(f32::NAN),
            Vec3::splat(1e30),
        ];
        for frame in tangents.map(|tangent| Frame::from_tangent(n, tangent)) {
            assert!((frame.s.cross(frame.t) - n).length() < 1e-5 && frame.s.dot(n).abs() < 1e-5, "{frame:?}");
            let v = Vec3::new(0.3, -2.0, 0.7);
            assert!((frame.to_world(frame.to_local(v)) - v).length() < 1e-5);
            assert!((frame.to_local(n) - Vec3::Z).length() < 1e-5);
        }
        let along = Frame::from_tangent(Vec3::Z, Vec3::new(0.0, 2.0, 5.0));
        assert!((along.s - Vec3::Y).length() < 1e-6, "the tangent leads: {along:?}");
    }
}
