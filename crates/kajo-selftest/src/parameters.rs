//! The free numbers of a scene, drawn from a seed and the scene's name.

use std::f64::consts::TAU;

use kajo_math::rng::{Stream, mix};
use kajo_math::{DVec3, fmath};

/// Draws one number after the other.
pub struct Parameters {
    stream: Stream,
    next: u32,
}

impl Parameters {
    /// The numbers of the scene called `name`: they do not depend on which other scenes are asked for.
    pub fn new(seed: u64, name: &str) -> Parameters {
        let hash = name.bytes().fold(0, |hash, byte| mix(hash ^ u64::from(byte)));
        Parameters { stream: Stream::new(seed ^ hash, [0, 0], 0), next: 0 }
    }

    /// A number between `low` and `high`, with few enough digits to be read.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let u = f64::from(self.stream.uniform(self.next));
        self.next += 1;
        let digits = 10f64.powi(3 - (high - low).log10().floor() as i32);
        ((low + (high - low) * u) * digits).round() / digits
    }

    /// One of `0..n`.
    pub fn index(&mut self, n: usize) -> usize {
        let bits = self.stream.bits(self.next);
        self.next += 1;
        ((u64::from(bits) * n as u64) >> 32) as usize
    }

    /// A unit vector whose angle with the y axis has a cosine of at least `least`.
    pub fn direction(&mut self, least: f64) -> DVec3 {
        let y = self.between(least, 1.0);
        let (r, phi) = ((1.0 - y * y).max(0.0).sqrt(), self.between(0.0, TAU));
        DVec3::new(r * fmath::cos64(phi), y, r * fmath::sin64(phi))
    }

    /// A point within a box around the origin.
    pub fn point(&mut self, half: f64) -> DVec3 {
        let mut next = || self.between(-half, half);
        DVec3::new(next(), next(), next())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay_in_their_range_and_follow_the_seed() {
        let draw = |seed: u64, name: &str| Parameters::new(seed, name).between(2.0, 3.0);
        assert_eq!(draw(7, "ball"), draw(7, "ball"));
        assert_ne!(draw(7, "ball"), draw(8, "ball"));
        assert_ne!(draw(7, "ball"), draw(7, "cube"));
        let mut some = Parameters::new(1, "many");
        for _ in 0..1000 {
            assert!((2.0..=3.0).contains(&some.between(2.0, 3.0)));
            assert!(some.index(3) < 3);
            let d = some.direction(0.3);
            assert!((d.length() - 1.0).abs() < 1e-12 && d.y >= 0.3);
        }
    }
}
