//! What varies over a surface: patterns, numbers in [0, 1] that vary over space, and pictures laid on surfaces.

mod checker;
mod constant;
mod context;
mod coordinates;
mod marble;
mod noise;
mod paint;
mod picture;
mod wood;

pub use checker::Checker;
pub use constant::Constant;
pub use context::TextureContext;
pub use coordinates::UvSet;
pub use marble::Marble;
pub use noise::Noise;
pub use paint::{Channel, Paint, Share};
pub(crate) use paint::{picture_reflectance, rgb_reflectance};
pub use picture::{Encoding, Picture, PictureMap, TexelFilter, Wrap};
pub use wood::Wood;

use kajo_math::Vec3;

use crate::family::family;
pub use crate::interaction::SurfaceUv;

/// What every pattern can do.
pub trait Pattern {
    /// Whether all its numbers are finite.
    fn is_finite(&self) -> bool;

    /// The pattern's value at a point of its own space, in [0, 1].
    fn value(&self, q: Vec3) -> f32;
}

family! {
    /// Names a pattern in [`Textures`].
    handle TextureId;
    /// All patterns of a scene.
    pools Textures;
    /// Any pattern.
    any AnyPattern;
    contract Pattern;
    members {
        checkers: Checker,
        constants: Constant,
        marbles: Marble,
        noises: Noise,
        woods: Wood,
    }
    any methods {
        /// See [`Pattern::is_finite`].
        fn is_finite() -> bool;
    }
    methods {
        /// See [`Pattern::value`].
        fn value(q: Vec3) -> f32;
    }
}

/// A number in about [-1, 1] brought to [0, 1].
pub(crate) fn unit_from_signed(v: f32) -> f32 {
    (0.5 + 0.5 * v).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::noise::perlin;

    #[test]
    fn checker_follows_the_classic_parity() {
        // The rule for positive and negative cells, and the reference's own result on whole negative numbers.
        for (q, first) in [
            (Vec3::new(0.5, 0.5, 0.5), true),
            (Vec3::new(1.5, 0.5, 0.5), false),
            (Vec3::new(-0.5, 0.5, 0.5), false),
            (Vec3::new(-1.5, 0.5, 0.5), true),
            (Vec3::new(-0.5, -0.5, 0.5), true),
            (Vec3::new(7.2, -3.1, 2.9), false),
            (Vec3::new(-1.0, 0.5, 0.5), true),
        ] {
            assert_eq!(Checker.value(q) == 0.0, first, "{q}");
        }
        for i in 0..1000 {
            let s = kajo_math::rng::Stream::new(5, [i, 0], 0);
            let q = 20.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) - 10.0;
            let even = q.floor().element_sum().rem_euclid(2.0) == 0.0;
            assert_eq!(Checker.value(q) == 0.0, even, "{q}");
        }
    }

    #[test]
    fn patterns_follow_their_formulas() {
        let q = Vec3::new(0.3, 1.7, -2.2);
        let turbulence = perlin(q) + 0.5 * perlin(2.0 * q);
        let noise = Noise { octaves: 2 }.value(q);
        assert!((noise - (0.5 + 0.5 * turbulence)).abs() < 1e-6);
        let marble = Marble { octaves: 2, frequency: 3.0, amplitude: 4.0 }.value(q);
        assert!((marble - (0.5 + 0.5 * (3.0 * 0.3 + 4.0 * turbulence).sin())).abs() < 1e-5);
        let wood = Wood { octaves: 2, frequency: 3.0, amplitude: 4.0 }.value(q);
        let rings = 3.0 * (0.3f32 * 0.3 + 2.2 * 2.2).sqrt();
        assert!((wood - (0.5 + 0.5 * (rings + 4.0 * turbulence).sin())).abs() < 1e-5);
    }
}
