//! Marble: veins across x, shaken by turbulence: `sin(frequency x + amplitude N(q))`.

use kajo_math::{Vec3, fmath, noise};

use super::{Pattern, unit_from_signed};

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

impl Pattern for Marble {
    fn value(&self, q: Vec3) -> f32 {
        let phase = self.frequency * q.x + self.amplitude * noise::turbulence(q, self.octaves);
        unit_from_signed(fmath::sin(phase))
    }

    fn is_finite(&self) -> bool {
        self.frequency.is_finite() && self.amplitude.is_finite()
    }
}
