//! Bands that noise bends: veins of marble, rings of wood, layers of agate.
//!
//! With `b(q)` the sum of octaves by three of its standard deviations and `W` a wave,
//!
//! ```text
//! veins  W(f x + a b(q) + p)        rings  W(f r + a b(q) + p)        agate  ((1 + sin 2 pi (0.2 z + a t(q))) / 2)^0.77
//! ```
//!
//! the marble and the wood of [Perlin 1985]; agate, with the sum `t` of absolute values, after POV-Ray's pattern of that name.

use super::bands::{Wave, radius};
use super::fractal::Octaves;
use super::{Pattern, fract};
use crate::{Vec3, fmath};

/// Veins across x, as marble has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Veins {
    /// Shape.
    pub wave: Wave,
    /// Periods per unit.
    pub frequency: f32,
    /// Periods at the origin.
    pub phase: f32,
    /// Periods by which the noise bends them.
    pub bend: f32,
    /// The noise.
    pub octaves: Octaves,
}

impl Default for Veins {
    fn default() -> Veins {
        let octaves = Octaves::default();
        Veins { wave: Wave::Triangle, frequency: 1.0, phase: 0.0, bend: 1.5, octaves }
    }
}

impl Pattern for Veins {
    fn is_finite(&self) -> bool {
        [self.frequency, self.phase, self.bend, self.octaves.gain, self.octaves.lacunarity]
            .iter()
            .all(|v| v.is_finite())
    }

    fn at(&self, q: Vec3, width: f32) -> f32 {
        let bent = self.bend * self.octaves.normalised(q, width) / 3.0;
        self.wave.at(self.frequency * q.x + bent + self.phase)
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        self.wave.repeats(self.frequency)
    }
}

/// Rings around the y axis, as wood has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rings {
    /// Shape.
    pub wave: Wave,
    /// Periods per unit.
    pub frequency: f32,
    /// Periods at the axis.
    pub phase: f32,
    /// Periods by which the noise bends them.
    pub bend: f32,
    /// The noise.
    pub octaves: Octaves,
}

impl Default for Rings {
    fn default() -> Rings {
        let octaves = Octaves { count: 3, ..Octaves::default() };
        Rings { wave: Wave::Saw, frequency: 4.0, phase: 0.0, bend: 1.0, octaves }
    }
}

impl Pattern for Rings {
    fn is_finite(&self) -> bool {
        [self.frequency, self.phase, self.bend, self.octaves.gain, self.octaves.lacunarity]
            .iter()
            .all(|v| v.is_finite())
    }

    fn at(&self, q: Vec3, width: f32) -> f32 {
        // Trunks are straight: noise is stretched along them.
        let stretched = Vec3::new(q.x, 0.125 * q.y, q.z);
        let bent = self.bend * self.octaves.normalised(stretched, width) / 3.0;
        self.wave.at(self.frequency * radius(q) + bent + self.phase)
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        self.wave.repeats(self.frequency)
    }
}

/// Layers of agate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agate {
    /// How strongly turbulence folds the layers.
    pub bend: f32,
    /// The noise.
    pub octaves: Octaves,
}

impl Default for Agate {
    fn default() -> Agate {
        Agate { bend: 2.0, octaves: Octaves::default() }
    }
}

impl Pattern for Agate {
    fn is_finite(&self) -> bool {
        self.bend.is_finite() && self.octaves.gain.is_finite() && self.octaves.lacunarity.is_finite()
    }

    fn at(&self, q: Vec3, width: f32) -> f32 {
        let periods = 0.2 * q.z + self.bend * self.octaves.absolute(q, width);
        let layer = 0.5 + 0.5 * fmath::sin(std::f32::consts::TAU * fract(periods));
        if layer > 0.0 { fmath::pow(layer, 0.77) } else { 0.0 }
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::spread;

    #[test]
    fn without_bends_they_are_bands() {
        let veins = Veins { bend: 0.0, ..Veins::default() };
        let rings = Rings { bend: 0.0, ..Rings::default() };
        for i in 0..200 {
            let q = 20.0 * spread(i);
            assert_eq!(veins.at(q, 0.0), Wave::Triangle.at(q.x));
            assert_eq!(rings.at(q, 0.0), Wave::Saw.at(4.0 * radius(q)));
        }
    }
}
