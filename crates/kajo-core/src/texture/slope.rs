//! How textures change from place to place.

use kajo_math::{Vec2, Vec3};

use super::TextureContext;

/// Derivatives of a number; its change is the sum of both parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TextureSlope {
    /// By the surface coordinates.
    pub uv: Vec2,
    /// By the world-space point.
    pub p: Vec3,
}

impl TextureSlope {
    /// That of `factor` times a number that depends on the world-space point alone, by differences.
    ///
    /// A step is so long that the coordinates on both sides have ten bits to differ in.
    pub(super) fn in_space(
        at: &TextureContext,
        factor: f32,
        value: impl Fn(&TextureContext) -> f32,
    ) -> TextureSlope {
        TextureSlope::by_steps(at, at.p.abs().max_element().max(1.0) / 1024.0, factor, value)
    }

    /// As [`TextureSlope::in_space`] of a number whose features are much wider than `step`.
    ///
    /// Far from the origin the step is so long that the coordinates on both sides have six bits to differ in.
    pub(super) fn over(
        at: &TextureContext,
        step: f32,
        factor: f32,
        value: impl Fn(&TextureContext) -> f32,
    ) -> TextureSlope {
        TextureSlope::by_steps(at, (at.p.abs().max_element() / 262_144.0).max(step), factor, value)
    }

    fn by_steps(
        at: &TextureContext,
        step: f32,
        factor: f32,
        value: impl Fn(&TextureContext) -> f32,
    ) -> TextureSlope {
        let along = |axis: Vec3| {
            let [there, back] =
                [step, -step].map(|step| value(&TextureContext { p: at.p + step * axis, ..*at }));
            factor * (there - back) / (2.0 * step)
        };
        TextureSlope { uv: Vec2::ZERO, p: Vec3::new(along(Vec3::X), along(Vec3::Y), along(Vec3::Z)) }
    }

    /// That of `factor` times a number that depends on surface coordinates, by differences over `step`.
    pub(super) fn on_surface(
        at: &TextureContext,
        step: f32,
        factor: f32,
        value: impl Fn(&TextureContext) -> f32,
    ) -> TextureSlope {
        let along = |axis: Vec2| {
            let [there, back] =
                [step, -step].map(|step| value(&TextureContext { uv: at.uv.moved(step * axis), ..*at }));
            factor * (there - back) / (2.0 * step)
        };
        TextureSlope { uv: Vec2::new(along(Vec2::X), along(Vec2::Y)), p: Vec3::ZERO }
    }

    /// The sum of two.
    pub(super) fn plus(self, other: TextureSlope) -> TextureSlope {
        TextureSlope { uv: self.uv + other.uv, p: self.p + other.p }
    }
}
