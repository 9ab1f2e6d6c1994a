//! Sums of octaves of noise: clouds, turbulence, ridges, wrinkles, granite.
//!
//! With the noise `n`, lacunarity `l` and gain `g`, and each octave moved by an irrational part of its cells,
//!
//! ```text
//! clouds      1/2 + sum g^i n(l^i q) / (6 sigma S)          S^2 = sum g^2i       fractional Brownian motion
//! turbulence  2 sum g^i |n(l^i q)| / sum g^i                                     [Perlin 1985]
//! wrinkles    |sum g^i n(l^i q)| / (3 sigma S)
//! ridged      sum g^i s_i / sum g^i,   s_i = w_i (1 - |n(l^i q)|)^2,   w_0 = 1,  w_(i+1) = min(1, 2 s_i)
//! ```
//!
//! the last one the ridged multifractal of [Ebert et al. 2003, chapter 16]. Clouds and wrinkles are scaled so that three standard deviations
//! reach the ends of their range. An octave too fine for the samples is replaced by the mean of what it adds: 0 for `n`, but not for `|n|`.

use super::gradient_noise::{MEAN_ABS, SHIFT, SIGMA};
use super::{Pattern, faded_share, lerp, noise, passed};
use crate::Vec3;

/// Octaves of noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Octaves {
    /// How many, at least one.
    pub count: u32,
    /// Size of an octave by that of the one before, in (0, 1].
    pub gain: f32,
    /// Frequency of an octave by that of the one before, at least 1.
    pub lacunarity: f32,
    /// Chooses one of many noises.
    pub seed: u32,
}

impl Default for Octaves {
    fn default() -> Octaves {
        Octaves { count: 6, gain: 0.5, lacunarity: 2.0, seed: 0 }
    }
}

/// The most octaves there may be: beyond them single precision has no digits left.
const MOST: u32 = 16;

/// The largest coordinate of an octave that single precision has digits left for.
const FARTHEST: f32 = 4_194_304.0;

/// One of the octaves at a point.
struct Octave {
    /// Its size.
    amplitude: f32,
    /// Its noise.
    noise: f32,
    /// How much of it the samples can show.
    passed: f32,
}

impl Octaves {
    fn is_finite(&self) -> bool {
        self.gain.is_finite() && self.lacunarity.is_finite()
    }

    /// The octaves at a point, from the widest to the narrowest.
    fn at(&self, q: Vec3, width: f32) -> impl Iterator<Item = Octave> + use<> {
        let Octaves { count, gain, lacunarity, seed } = *self;
        let (mut q, mut frequency, mut amplitude) = (q, 1.0f32, 1.0f32);
        (0..count.min(MOST)).map(move |i| {
            let share = passed(width, frequency);
            let is_seen = share > 0.0 && q.abs().max_element() < FARTHEST;
            let noise = if is_seen { noise(q + SHIFT * i as f32, seed.wrapping_add(i)) } else { 0.0 };
            let octave = Octave { amplitude, noise, passed: if is_seen { share } else { 0.0 } };
            q *= lacunarity;
            frequency *= lacunarity;
            amplitude *= gain;
            octave
        })
    }

    /// The share of the variance of the octaves, which are independent, that is faded.
    fn faded(&self, width: f32) -> f32 {
        let frequency = |i: u32| self.lacunarity.powi(i as i32);
        let part = |i: u32| (self.gain.powi(i as i32), passed(width, frequency(i)));
        faded_share((0..self.count.min(MOST)).map(part))
    }

    /// The sum of the octaves by the standard deviation that it has with all of them.
    pub(super) fn normalised(&self, q: Vec3, width: f32) -> f32 {
        let (sum, squares) = self.at(q, width).fold((0.0, 0.0), |(sum, squares), octave| {
            (sum + octave.amplitude * octave.passed * octave.noise, squares + octave.amplitude.powi(2))
        });
        sum / (SIGMA * squares.sqrt())
    }

    /// The sum of their absolute values by the sum of their sizes.
    pub(super) fn absolute(&self, q: Vec3, width: f32) -> f32 {
        let (sum, sizes) = self.at(q, width).fold((0.0, 0.0), |(sum, sizes), octave| {
            let value = lerp(octave.passed, MEAN_ABS, octave.noise.abs());
            (sum + octave.amplitude * value, sizes + octave.amplitude)
        });
        sum / sizes
    }
}

/// Clouds: fractional Brownian motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clouds(pub Octaves);

/// Sums of absolute values of noise: creases at its zeros.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turbulence(pub Octaves);

/// Absolute values of a sum of noise: folds of cloth and paper.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrinkles(pub Octaves);

/// Mountain ridges, with detail where it is high.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ridged(pub Octaves);

/// Grains of stone: turbulence at four times the frequency, each octave half as strong, after POV-Ray's pattern of that name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Granite {
    /// Chooses one of many.
    pub seed: u32,
}

#[expect(clippy::derivable_impls, reason = "the default of a scene, not of a type")]
impl Default for Granite {
    fn default() -> Granite {
        Granite { seed: 0 }
    }
}

impl Pattern for Clouds {
    fn is_finite(&self) -> bool {
        self.0.is_finite()
    }

    fn at(&self, q: Vec3, width: f32) -> f32 {
        0.5 + self.0.normalised(q, width) / 6.0
    }

    fn lost(&self, _q: Vec3, width: f32, variance: f32) -> f32 {
        variance * self.0.faded(width)
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        1.0
    }
}

impl Pattern for Turbulence {
    fn is_finite(&self) -> bool {
        self.0.is_finite()
    }

    fn at(&self, q: Vec3, width: f32) -> f32 {
        2.0 * self.0.absolute(q, width)
    }

    fn lost(&self, _q: Vec3, width: f32, variance: f32) -> f32 {
        variance * self.0.faded(width)
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        1.0
    }
}

impl Pattern for Wrinkles {
    fn is_finite(&self) -> bool {
        self.0.is_finite()
    }

    fn at(&self, q: Vec3, width: f32) -> f32 {
        self.0.normalised(q, width).abs() / 3.0
    }

    fn lost(&self, _q: Vec3, width: f32, variance: f32) -> f32 {
        variance * self.0.faded(width)
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        1.0
    }
}

impl Pattern for Ridged {
    fn is_finite(&self) -> bool {
        self.0.is_finite()
    }

    fn at(&self, q: Vec3, width: f32) -> f32 {
        /// Mean of `(1 - |n|)^2`.
        const MEAN_RIDGE: f32 = 1.0 - 2.0 * MEAN_ABS + SIGMA * SIGMA;
        let (mut sum, mut sizes, mut weight) = (0.0, 0.0, 1.0f32);
        for octave in self.0.at(q, width) {
            let ridge = 1.0 - octave.noise.abs().min(1.0);
            let signal = weight * lerp(octave.passed, MEAN_RIDGE, ridge * ridge);
            sum += octave.amplitude * signal;
            sizes += octave.amplitude;
            weight = (2.0 * signal).min(1.0);
        }
        sum / sizes
    }

    fn lost(&self, _q: Vec3, width: f32, variance: f32) -> f32 {
        variance * self.0.faded(width)
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        1.0
    }
}

impl Granite {
    fn octaves(self) -> Octaves {
        Octaves { count: 6, gain: 0.5, lacunarity: 2.0, seed: self.seed }
    }
}

impl Pattern for Granite {
    fn is_finite(&self) -> bool {
        true
    }

    fn at(&self, q: Vec3, width: f32) -> f32 {
        2.0 * self.octaves().absolute(4.0 * q, 4.0 * width)
    }

    fn lost(&self, _q: Vec3, width: f32, variance: f32) -> f32 {
        variance * self.octaves().faded(4.0 * width)
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        4.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::spread;

    /// Mean and variance of a function of many points.
    fn moments(value: impl Fn(Vec3) -> f32) -> (f64, f64) {
        let n = 60_000u32;
        let values = (0..n).map(|i| f64::from(value(500.0 * spread(i))));
        let (sum, squares) = values.fold((0.0, 0.0), |(s, q), v| (s + v, q + v * v));
        let mean = sum / f64::from(n);
        (mean, squares / f64::from(n) - mean * mean)
    }

    #[test]
    fn octaves_are_independent() {
        // Variances add up: four octaves of gain 1/2 have 1 + 1/4 + 1/16 + 1/64 times that of one.
        let octaves = Octaves { count: 4, ..Octaves::default() };
        let sum = |q| octaves.at(q, 0.0).map(|octave| octave.amplitude * octave.noise).sum::<f32>();
        let (mean, variance) = moments(sum);
        let (_, of_one) = moments(|q| noise(q, 0));
        assert!(mean.abs() < 0.004, "{mean}");
        assert!((variance / of_one - 1.328_125).abs() < 0.02, "{}", variance / of_one);
    }

    #[test]
    fn three_standard_deviations_reach_the_ends() {
        let (mean, variance) = moments(|q| Clouds::default().at(q, 0.0));
        assert!(
            (mean - 0.5).abs() < 0.003 && (variance.sqrt() - 1.0 / 6.0).abs() < 0.003,
            "{mean} {variance}"
        );
    }

    #[test]
    fn octaves_fade_to_their_means() {
        // At a width of 1/8 the third octave is half gone and the others of six are; what is left is the sum of two and a half.
        let clouds = Octaves::default();
        for i in 0..200 {
            let q = 50.0 * spread(i);
            let few = clouds.at(q, 0.0).take(2).map(|o| o.amplitude * o.noise).sum::<f32>();
            let third = clouds.at(q, 0.0).nth(2).map_or(0.0, |o| o.amplitude * o.noise);
            let squares: f32 = clouds.at(q, 0.0).map(|o| o.amplitude.powi(2)).sum();
            let left = clouds.normalised(q, 3.0 / 32.0) * SIGMA * squares.sqrt();
            assert!((left - few - 0.5 * third).abs() < 1e-5, "{q}");
        }
        let (sharp, _) = moments(|q| Turbulence::default().at(q, 0.0));
        let (faded, variance) = moments(|q| Turbulence::default().at(q, 0.2));
        assert!((sharp - faded).abs() < 0.01 && variance > 0.0, "{sharp} {faded}");
    }
}
