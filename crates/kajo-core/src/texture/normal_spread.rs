//! How much normals differ.

use kajo_math::{Vec2, Vec3, fmath};

/// Normals of which a filter takes the mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilteredNormals {
    /// Their mean `m`, along the two coordinates and outwards; it is not of unit length.
    pub mean: Vec3,
    /// How much they differ, which is not zero.
    pub spread: NormalSpread,
}

/// The covariances of normals within a footprint: of their components along the first and the second coordinate. Zero where nothing
/// is known of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NormalSpread {
    /// Variance along the first.
    pub xx: f32,
    /// Variance along the second.
    pub yy: f32,
    /// Covariance.
    pub xy: f32,
}

impl NormalSpread {
    /// Whether they do not differ.
    pub fn is_none(&self) -> bool {
        self.xx <= 0.0 && self.yy <= 0.0
    }

    /// Those of components under a linear map.
    ///
    /// * `x`, `y`: where it takes the unit vectors
    #[must_use]
    pub fn mapped(&self, x: Vec2, y: Vec2) -> NormalSpread {
        let of =
            |a: f32, b: f32, c: f32, d: f32| a * b * self.xx + c * d * self.yy + (a * d + c * b) * self.xy;
        NormalSpread { xx: of(x.x, x.x, y.x, y.x), yy: of(x.y, x.y, y.y, y.y), xy: of(x.x, x.y, y.x, y.y) }
    }

    /// The greatest and the least variance of all directions, and the angle of the greatest from the first coordinate in full turns.
    pub fn principal(&self) -> ([f32; 2], f32) {
        let (mean, half) = (0.5 * (self.xx + self.yy), 0.5 * (self.xx - self.yy));
        let off = (half * half + self.xy * self.xy).sqrt();
        let turn = fmath::atan2(self.xy, half) * (0.5 / std::f32::consts::TAU);
        ([mean + off, (mean - off).max(0.0)], turn)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::rng::Stream;

    #[test]
    fn principal_variances_are_those_of_turned_normals() {
        for i in 0..100 {
            let s = Stream::new(8, [i, 0], 0);
            let (greatest, least, turn) = (0.5 + s.uniform(0), 0.5 * s.uniform(1), s.uniform(2) - 0.5);
            let (sin, cos) = fmath::sin_cos(turn * std::f32::consts::PI);
            let along = NormalSpread { xx: greatest, yy: least, xy: 0.0 };
            let turned = along.mapped(Vec2::new(cos, sin), Vec2::new(-sin, cos));
            let ([found, other], angle) = turned.principal();
            assert!((found - greatest).abs() < 1e-5 && (other - least).abs() < 1e-5, "{turned:?}");
            let off = (angle - 0.5 * turn).rem_euclid(0.5);
            assert!(off.min(0.5 - off) < 1e-5, "{angle} for {}", 0.5 * turn);
        }
        assert!(NormalSpread::default().is_none());
    }
}
