//! What a sample covers of a texture.

use kajo_math::{Vec2, Vec3};

use super::UvSet;

/// How far it is from the point where a texture is evaluated to those of the neighbouring samples.
///
/// Zero where nothing is known of it: then textures are evaluated at the point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TextureFootprint {
    /// In the space in which patterns are evaluated.
    pub p: [Vec3; 2],
    /// In surface coordinates of the first set; zero where no texture of the material asks for coordinates.
    pub uv: [Vec2; 2],
    /// In those of the second; what it is in the first where there is no second set, or [`super::Textures::wants_second_footprint`] says that
    /// no texture asks for it.
    pub second_uv: [Vec2; 2],
}

impl TextureFootprint {
    /// That of a single point.
    pub const POINT: TextureFootprint =
        TextureFootprint { p: [Vec3::ZERO; 2], uv: [Vec2::ZERO; 2], second_uv: [Vec2::ZERO; 2] };

    /// In surface coordinates of a set.
    #[inline]
    pub fn on(&self, set: UvSet) -> [Vec2; 2] {
        match set {
            UvSet::First => self.uv,
            UvSet::Second => self.second_uv,
        }
    }

    /// Whether it is that of a single point.
    #[inline]
    pub fn is_point(&self) -> bool {
        *self == TextureFootprint::POINT
    }

    /// The distance between samples in space, the larger one.
    #[inline]
    pub fn width(&self) -> f32 {
        let [across, up] = self.p;
        across.length_squared().max(up.length_squared()).sqrt()
    }
}
