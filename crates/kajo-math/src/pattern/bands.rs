//! Bands: waves of a coordinate, of an angle, of a distance.
//!
//! With the wave `W` of period 1 in its argument, `theta` the angle around the y axis, and `r` the distance from it,
//!
//! ```text
//! gradient  W(f x + p)        radial  W(k theta / 2 pi + p)        spiral  W(k theta / 2 pi + f r + p)        onion  W(f |q| + p)
//! ```

use super::{Pattern, fract};
use crate::{Vec3, fmath};

/// The shape of a wave, in [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wave {
    /// Up from 0 to 1 and back, evenly.
    #[default]
    Triangle,
    /// Up and back as a sine does: `(1 - cos 2 pi t) / 2`.
    Sine,
    /// Up from 0 to 1, and then 0 at once.
    Saw,
    /// Up from 0 to 1 once, and 0 before and 1 after it.
    Once,
}

impl Wave {
    /// Its value at `t` periods.
    pub fn at(self, t: f32) -> f32 {
        match self {
            Wave::Triangle => {
                let t = fract(t);
                2.0 * t.min(1.0 - t)
            }
            Wave::Sine => 0.5 - 0.5 * fmath::cos(std::f32::consts::TAU * fract(t)),
            Wave::Saw => fract(t),
            Wave::Once => t.clamp(0.0, 1.0),
        }
    }

    /// How often it is repeated per unit where its argument grows by `frequency` per unit.
    pub(super) fn repeats(self, frequency: f32) -> f32 {
        if self == Wave::Once { 0.0 } else { frequency.abs() }
    }
}

/// The part of a full turn around the y axis: 0 along z, growing towards x; in [-1/2, 1/2].
pub(super) fn turn(q: Vec3) -> f32 {
    fmath::atan2(q.x, q.z) / std::f32::consts::TAU
}

/// Distance from the y axis.
pub(super) fn radius(q: Vec3) -> f32 {
    (q.x * q.x + q.z * q.z).sqrt()
}

/// Planes across x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gradient {
    /// Shape.
    pub wave: Wave,
    /// Periods per unit.
    pub frequency: f32,
    /// Periods at the origin.
    pub phase: f32,
}

impl Default for Gradient {
    fn default() -> Gradient {
        Gradient { wave: Wave::Triangle, frequency: 1.0, phase: 0.0 }
    }
}

impl Pattern for Gradient {
    fn is_finite(&self) -> bool {
        self.frequency.is_finite() && self.phase.is_finite()
    }

    fn at(&self, q: Vec3, _width: f32) -> f32 {
        self.wave.at(self.frequency * q.x + self.phase)
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        self.wave.repeats(self.frequency)
    }
}

/// Sectors around the y axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radial {
    /// Shape.
    pub wave: Wave,
    /// Periods of a full turn.
    pub arms: u32,
    /// Periods at the angle 0.
    pub phase: f32,
}

impl Default for Radial {
    fn default() -> Radial {
        Radial { wave: Wave::Triangle, arms: 8, phase: 0.0 }
    }
}

impl Pattern for Radial {
    fn is_finite(&self) -> bool {
        self.phase.is_finite()
    }

    fn at(&self, q: Vec3, _width: f32) -> f32 {
        self.wave.at(self.arms as f32 * turn(q) + self.phase)
    }

    fn frequency(&self, q: Vec3) -> f32 {
        self.wave.repeats(self.arms as f32 / (std::f32::consts::TAU * radius(q)).max(1e-6))
    }
}

/// Spirals around the y axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spiral {
    /// Shape.
    pub wave: Wave,
    /// How many there are beside each other.
    pub arms: u32,
    /// Periods per unit of radius.
    pub frequency: f32,
    /// Periods at the axis.
    pub phase: f32,
}

impl Default for Spiral {
    fn default() -> Spiral {
        Spiral { wave: Wave::Triangle, arms: 2, frequency: 1.0, phase: 0.0 }
    }
}

impl Pattern for Spiral {
    fn is_finite(&self) -> bool {
        self.frequency.is_finite() && self.phase.is_finite()
    }

    fn at(&self, q: Vec3, _width: f32) -> f32 {
        self.wave.at(self.arms as f32 * turn(q) + self.frequency * radius(q) + self.phase)
    }

    fn frequency(&self, q: Vec3) -> f32 {
        let around = self.arms as f32 / (std::f32::consts::TAU * radius(q)).max(1e-6);
        self.wave.repeats(around.max(self.frequency.abs()))
    }
}

/// Shells around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onion {
    /// Shape.
    pub wave: Wave,
    /// Periods per unit.
    pub frequency: f32,
    /// Periods at the origin.
    pub phase: f32,
}

impl Default for Onion {
    fn default() -> Onion {
        Onion { wave: Wave::Triangle, frequency: 1.0, phase: 0.0 }
    }
}

impl Pattern for Onion {
    fn is_finite(&self) -> bool {
        self.frequency.is_finite() && self.phase.is_finite()
    }

    fn at(&self, q: Vec3, _width: f32) -> f32 {
        self.wave.at(self.frequency * q.length() + self.phase)
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        self.wave.repeats(self.frequency)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_have_their_shapes() {
        let values = |wave: Wave| [-0.75, 0.0, 0.125, 0.25, 0.5, 1.0, 1.75].map(|t| wave.at(t));
        assert_eq!(values(Wave::Saw), [0.25, 0.0, 0.125, 0.25, 0.5, 0.0, 0.75]);
        assert_eq!(values(Wave::Triangle), [0.5, 0.0, 0.25, 0.5, 1.0, 0.0, 0.5]);
        assert_eq!(values(Wave::Once), [0.0, 0.0, 0.125, 0.25, 0.5, 1.0, 1.0]);
        let expected = [0.5, 0.0, 0.146_446_6, 0.5, 1.0, 0.0, 0.5];
        assert!(values(Wave::Sine).iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6));
    }

    #[test]
    fn angles_close_and_distances_are_distances() {
        let (radial, spiral) = (Radial::default(), Spiral::default());
        for i in 0..100 {
            let angle = 0.0628 * i as f32 - 3.1;
            let at = |angle: f32| Vec3::new(fmath::sin(angle), 0.3, fmath::cos(angle));
            // Turned by one sector and by one arm they are the same.
            let sector = std::f32::consts::TAU / 8.0;
            let [here, there] = [angle, angle + sector].map(|angle| radial.at(2.0 * at(angle), 0.0));
            assert!((here - there).abs() < 1e-5, "{angle}");
            let half = std::f32::consts::PI;
            let [here, there] = [angle, angle + half].map(|angle| spiral.at(at(angle), 0.0));
            assert!((here - there).abs() < 1e-5, "{angle}");
            let outwards = spiral.at(at(angle) * Vec3::new(2.0, 1.0, 2.0), 0.0);
            assert!((outwards - here).abs() < 1e-5, "{angle}");
        }
        let onion = Onion { wave: Wave::Saw, frequency: 0.5, phase: 0.25 };
        assert!((onion.at(Vec3::new(1.0, 2.0, 2.0), 0.0) - 0.75).abs() < 1e-6);
    }
}
