//! Marble: veins across x, shaken by turbulence: `sin(frequency x + amplitude N(q))`.

use kajo_math::{Vec3, fmath, noise};

use super::{FloatNode, TextureContext, Textures, unit_from_signed};

/// Perlin's marble.
#[derive(Clone, Copy, Debug)]
pub struct Marble {
    /// Number of terms of the turbulence.
    pub octaves: u32,
    /// Radians of a vein's phase per unit of x.
    pub frequency: f32,
    /// Radians of phase per unit of turbulence.
    pub amplitude: f32,
}

impl Marble {
    /// The number at a point of its own space.
    pub fn at(&self, q: Vec3) -> f32 {
        let phase = self.frequency * q.x + self.amplitude * noise::turbulence(q, self.octaves);
        unit_from_signed(fmath::sin(phase))
    }
}

impl FloatNode for Marble {
    fn is_finite(&self) -> bool {
        self.frequency.is_finite() && self.amplitude.is_finite()
    }

    fn value(&self, _textures: &Textures, at: &TextureContext) -> f32 {
        self.at(at.p)
    }
}
