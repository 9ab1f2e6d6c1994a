//! Wood: rings around the y axis, shaken by turbulence:
//! `sin(frequency sqrt(x^2 + z^2) + amplitude N(q))`.

use kajo_math::{Vec3, fmath, noise};

use super::{FloatNode, TextureContext, Textures, unit_from_signed};

/// Perlin's wood.
#[derive(Clone, Copy, Debug)]
pub struct Wood {
    /// Number of terms of the turbulence.
    pub octaves: u32,
    /// Radians of a ring's phase per unit of radius.
    pub frequency: f32,
    /// Radians of phase per unit of turbulence.
    pub amplitude: f32,
}

impl Wood {
    /// The number at a point of its own space.
    pub fn at(&self, q: Vec3) -> f32 {
        let rings = self.frequency * (q.x * q.x + q.z * q.z).sqrt();
        unit_from_signed(fmath::sin(rings + self.amplitude * noise::turbulence(q, self.octaves)))
    }
}

impl FloatNode for Wood {
    fn is_finite(&self) -> bool {
        self.frequency.is_finite() && self.amplitude.is_finite()
    }

    fn value(&self, _textures: &Textures, at: &TextureContext) -> f32 {
        self.at(at.p)
    }
}
