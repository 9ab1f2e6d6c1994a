//! Cloudy noise: turbulence `N(q) + N(2q)/2 + N(4q)/4 + ...`, brought from [-1, 1] to [0, 1].

use kajo_math::{Vec3, noise};

use super::{FloatNode, TextureContext, Textures, unit_from_signed};

/// Perlin turbulence.
#[derive(Clone, Copy, Debug)]
pub struct Noise {
    /// Number of terms of the sum.
    pub octaves: u32,
}

impl Noise {
    /// The number at a point of its own space.
    pub fn at(&self, q: Vec3) -> f32 {
        unit_from_signed(noise::turbulence(q, self.octaves))
    }
}

impl FloatNode for Noise {
    fn is_finite(&self) -> bool {
        true
    }

    fn value(&self, _textures: &Textures, at: &TextureContext) -> f32 {
        self.at(at.p)
    }
}
