//! Ripples and waves: spheres of waves around ten places, added up, after POV-Ray's patterns of these names.
//!
//! ```text
//! ripples  1/2 + sum sin 2 pi (f |q - c_i| + p) / 20        waves  1/2 + sum (sin 2 pi (f f_i |q - c_i| + p) / f_i) / (2 sum 1 / f_i)
//! ```
//!
//! The places `c_i` are drawn on a sphere of five units around the origin, the factors `f_i` from 1 to 4. A phase that grows lets them run.

use super::{Pattern, faded_share, fract, hash, passed};
use crate::{Vec3, fmath};

/// How many places there are.
const SOURCES: u32 = 10;

/// Their distance from the origin.
const DISTANCE: f32 = 5.0;

/// Waves of one length around ten places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ripples {
    /// Periods per unit.
    pub frequency: f32,
    /// Periods at the places.
    pub phase: f32,
    /// Chooses the places.
    pub seed: u32,
}

/// Waves of ten lengths, the longer the higher.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waves {
    /// Periods per unit of the longest.
    pub frequency: f32,
    /// Periods at the places.
    pub phase: f32,
    /// Chooses the places and lengths.
    pub seed: u32,
}

impl Default for Ripples {
    fn default() -> Ripples {
        Ripples { frequency: 1.0, phase: 0.0, seed: 0 }
    }
}

impl Default for Waves {
    fn default() -> Waves {
        Waves { frequency: 1.0, phase: 0.0, seed: 0 }
    }
}

/// A place on the sphere, uniform: by its height and its angle.
fn source(h: u32) -> Vec3 {
    let z = 2.0 * hash::uniform(h, 0) - 1.0;
    let (sin, cos) = fmath::sin_cos(std::f32::consts::TAU * hash::uniform(h, 1));
    let r = (1.0 - z * z).max(0.0).sqrt();
    DISTANCE * Vec3::new(r * cos, z, r * sin)
}

fn sine(periods: f32) -> f32 {
    fmath::sin(std::f32::consts::TAU * fract(periods))
}

impl Pattern for Ripples {
    fn is_finite(&self) -> bool {
        self.frequency.is_finite() && self.phase.is_finite()
    }

    fn at(&self, q: Vec3, _width: f32) -> f32 {
        let wave = |i: u32| {
            let distance = q.distance(source(hash::with(self.seed, i as i32)));
            sine(self.frequency * distance + self.phase)
        };
        0.5 + (0..SOURCES).map(wave).sum::<f32>() / (2 * SOURCES) as f32
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        self.frequency.abs()
    }
}

impl Waves {
    /// What is drawn for a source, and the frequency of its waves by that of the slowest.
    fn source(&self, i: u32) -> (u32, f32) {
        let h = hash::with(self.seed, i as i32);
        (h, 1.0 + 3.0 * hash::uniform(h, 2))
    }
}

impl Pattern for Waves {
    fn is_finite(&self) -> bool {
        self.frequency.is_finite() && self.phase.is_finite()
    }

    fn at(&self, q: Vec3, width: f32) -> f32 {
        let (mut sum, mut sizes) = (0.0, 0.0);
        for i in 0..SOURCES {
            let (h, factor) = self.source(i);
            let frequency = factor * self.frequency;
            let wave = sine(frequency * q.distance(source(h)) + self.phase);
            sum += passed(width, frequency.abs()) * wave / factor;
            sizes += 1.0 / factor;
        }
        0.5 + 0.5 * sum / sizes
    }

    fn lost(&self, _q: Vec3, width: f32, variance: f32) -> f32 {
        let part = |i| {
            let (_, factor) = self.source(i);
            (1.0 / factor, passed(width, (factor * self.frequency).abs()))
        };
        variance * faded_share((0..SOURCES).map(part))
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        self.frequency.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::spread;

    #[test]
    fn sources_stand_on_a_sphere_and_waves_run() {
        let sum: Vec3 = (0..4000).map(|i| source(hash::with(3, i))).sum();
        assert!(sum.length() / 4000.0 < 0.15, "{sum}");
        for i in 0..100 {
            let h = hash::with(0, i);
            assert!((source(h).length() - DISTANCE).abs() < 1e-5);
            // After a whole period they are as before, after half of one the other way up.
            let q = 9.0 * spread(i as u32);
            let at = |phase: f32| Ripples { phase, ..Ripples::default() }.at(q, 0.0);
            assert!((at(0.0) - at(1.0)).abs() < 1e-5 && (at(0.0) + at(0.5) - 1.0).abs() < 1e-5);
        }
    }
}
