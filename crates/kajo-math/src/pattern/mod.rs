//! Patterns that fill space: numbers in [0, 1] for every point, of which textures are made.
//!
//! A pattern is a function of a point `q` in a space of its own, in which its features are about one unit wide. All of them are
//! in single precision and draw what is random from [integer hashes](hash) of lattice cells instead of a table of permutations, so that vector
//! lanes and graphics cards can follow the same source.
//!
//! A feature that is repeated `f` times per unit cannot be told from noise where samples lie farther apart than `1 / (2 f)`. A pattern
//! therefore takes the distance `w` between samples, and fades what it repeats from `w f = 1/4` on, until at `w f = 1/2` its mean is
//! left ([`passed`]) [Norton, Rockwood and Skolmoski 1982; Ebert et al. 2003, chapter 2]. Sums of octaves do so octave by octave. With
//! `w = 0` a pattern is what its equation says. How much it varies between samples beyond what is left of it, is known about
//! ([`SolidPattern::lost`]): by it functions of the pattern can be averaged.
//!
//! A new pattern is a type with a [`Pattern`] and a line in the list of [`AnyPattern`].

mod bands;
mod fractal;
mod gabor;
mod gradient_noise;
pub mod hash;
mod ripples;
mod tilings;
mod veins;
mod warp;
mod wood;
mod worley;

#[cfg(test)]
mod tests;

pub use bands::{Gradient, Onion, Radial, Spiral, Wave};
pub use fractal::{Clouds, Granite, Octaves, Ridged, Turbulence, Wrinkles};
pub use gabor::Gabor;
pub use gradient_noise::{noise, noise_vector};
pub use ripples::{Ripples, Waves};
pub use tilings::{Brick, Cells, Checks, Hexagons, Leopard};
pub use veins::{Agate, Rings, Veins};
pub use warp::TurbulentWarp;
pub use wood::Timber;
pub use worley::{Metric, Worley, WorleyValue, nearest_two};

use crate::Vec3;

/// Coordinates beyond which a single-precision number has not enough digits left for a place within a cell.
const FARTHEST: f32 = 1_048_576.0;

/// What every pattern can do.
pub trait Pattern {
    /// Whether all its own numbers are finite.
    fn is_finite(&self) -> bool;

    /// The number at a point, about in [0, 1].
    ///
    /// * `q`: finite, no coordinate larger than 2^20
    /// * `width`: distance between samples, for what a pattern can fade part by part; not negative
    fn at(&self, q: Vec3, width: f32) -> f32;

    /// The variance of what [`Pattern::at`] fades part by part, about: 0 for a pattern that is not faded so, and where it is not known.
    ///
    /// * `variance`: of the pattern over all places
    fn lost(&self, _q: Vec3, _width: f32, _variance: f32) -> f32 {
        0.0
    }

    /// How often per unit its widest feature is repeated around a point: where samples are too far apart for that, the mean is left.
    fn frequency(&self, q: Vec3) -> f32;
}

/// The share that is left of what is repeated `frequency` times per unit: 1 up to `width * frequency = 1/4`, 0 from 1/2 on, and the
/// cubic with level ends between.
#[inline]
pub fn passed(width: f32, frequency: f32) -> f32 {
    let t = (2.0 - 4.0 * width * frequency).clamp(0.0, 1.0);
    // What is no number is between no bounds.
    if t > 0.0 { t * t * (3.0 - 2.0 * t) } else { 0.0 }
}

/// A number and its fraction: the cell of a lattice and the place within.
#[inline]
fn cell_and_offset(v: f32) -> (i32, f32) {
    let floor = v.floor();
    (floor as i32, v - floor)
}

/// `a` at 0, `b` at 1.
#[inline]
fn lerp(t: f32, a: f32, b: f32) -> f32 {
    a + t * (b - a)
}

/// What is left of a whole when whole numbers are taken away: in [0, 1).
#[inline]
fn fract(v: f32) -> f32 {
    let left = v - v.floor();
    if left < 1.0 { left } else { 0.0 }
}

macro_rules! patterns {
    ($($Member:ident),+ $(,)?) => {
        /// Any pattern.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[allow(missing_docs, reason = "each is the type that it holds")]
        pub enum AnyPattern {
            $($Member($Member),)+
        }

        $(
            impl From<$Member> for AnyPattern {
                fn from(pattern: $Member) -> AnyPattern {
                    AnyPattern::$Member(pattern)
                }
            }
        )+

        impl AnyPattern {
            /// One of each, as it is where a scene says no more than its name.
            pub fn all() -> Vec<AnyPattern> {
                vec![$($Member::default().into()),+]
            }

            /// The name of its type.
            pub fn name(&self) -> &'static str {
                match self {
                    $(AnyPattern::$Member(_) => stringify!($Member),)+
                }
            }
        }

        impl Pattern for AnyPattern {
            fn is_finite(&self) -> bool {
                match self {
                    $(AnyPattern::$Member(pattern) => pattern.is_finite(),)+
                }
            }

            fn at(&self, q: Vec3, width: f32) -> f32 {
                match self {
                    $(AnyPattern::$Member(pattern) => pattern.at(q, width),)+
                }
            }

            fn lost(&self, q: Vec3, width: f32, variance: f32) -> f32 {
                match self {
                    $(AnyPattern::$Member(pattern) => pattern.lost(q, width, variance),)+
                }
            }

            fn frequency(&self, q: Vec3) -> f32 {
                match self {
                    $(AnyPattern::$Member(pattern) => pattern.frequency(q),)+
                }
            }
        }
    };
}

patterns! {
    Agate,
    Brick,
    Cells,
    Checks,
    Clouds,
    Gabor,
    Gradient,
    Granite,
    Hexagons,
    Leopard,
    Onion,
    Radial,
    Ridged,
    Rings,
    Ripples,
    Spiral,
    Timber,
    Turbulence,
    Veins,
    Waves,
    Worley,
    Wrinkles,
}

/// A pattern with its mean and variance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidPattern {
    pattern: AnyPattern,
    mean: f32,
    variance: f32,
}

impl SolidPattern {
    /// The pattern with its mean and variance over a cube around the origin.
    pub fn new(pattern: impl Into<AnyPattern>) -> SolidPattern {
        let pattern = pattern.into();
        let value = |i| f64::from(held(pattern.at(32.0 * scattered(i), 0.0)));
        let add = |(sum, squares): (f64, f64), v: f64| (sum + v, squares + v * v);
        let (sum, squares) = (0..POINTS).map(value).fold((0.0, 0.0), add);
        let mean = sum / f64::from(POINTS);
        let variance = squares / f64::from(POINTS) - mean * mean;
        SolidPattern { pattern, mean: held(mean as f32), variance: held(variance as f32) }
    }

    /// The pattern itself.
    pub fn pattern(&self) -> &AnyPattern {
        &self.pattern
    }

    /// The mean over all places, about.
    pub fn mean(&self) -> f32 {
        self.mean
    }

    /// The number at a point, in [0, 1]; the mean where the point is no number or farther than 2^20 from the origin.
    ///
    /// * `width`: distance between samples; 0 for a point
    pub fn at(&self, q: Vec3, width: f32) -> f32 {
        let is_near = q.abs().max_element() <= FARTHEST && q.is_finite();
        if !is_near {
            return self.mean;
        }
        if width == 0.0 {
            return held(self.pattern.at(q, 0.0));
        }
        let share = passed(width, self.pattern.frequency(q));
        if share == 0.0 { self.mean } else { lerp(share, self.mean, held(self.pattern.at(q, width))) }
    }

    /// The variance, about, of what [`SolidPattern::at`] has faded around a point: at least 0, at most that over all places.
    ///
    /// What is left of a pattern of variance `V` where a share `s` of it passes has `s^2 V`.
    ///
    /// * `width`: as there
    pub fn lost(&self, q: Vec3, width: f32) -> f32 {
        if width == 0.0 {
            return 0.0;
        }
        let passed = passed(width, self.pattern.frequency(q)).powi(2);
        let parts = if passed > 0.0 { self.pattern.lost(q, width, self.variance) } else { 0.0 };
        held((1.0 - passed) * self.variance + passed * parts).min(0.25)
    }
}

/// The sum of the squares of what is not `passed` of independent parts, by that of all of them.
///
/// * `parts`: their sizes, and how much of each passes
fn faded_share(parts: impl Iterator<Item = (f32, f32)>) -> f32 {
    let add = |(lost, all): (f32, f32), (size, passed): (f32, f32)| {
        let square = size * size;
        (lost + square * (1.0 - passed * passed), all + square)
    };
    let (lost, all) = parts.fold((0.0, 0.0), add);
    if all > 0.0 { lost / all } else { 0.0 }
}

/// A number held to [0, 1]; 0 for what is none.
fn held(v: f32) -> f32 {
    if v > 0.0 { v.min(1.0) } else { 0.0 }
}

/// How many points a mean is taken over.
const POINTS: u32 = 8192;

/// Points that are drawn from [-1, 1]³: what is repeated cannot agree with them.
fn scattered(i: u32) -> Vec3 {
    let along = |k| 2.0 * hash::uniform(hash::spread_bits(i), k) - 1.0;
    Vec3::new(along(0), along(1), along(2))
}

/// The points of a sequence that is spread evenly over [-1, 1]³: multiples of the powers of `1 / g`, where `g^4 = g + 1`
/// [Roberts 2018].
#[cfg(test)]
fn spread(i: u32) -> Vec3 {
    let along = |step: u32| 2.0 * crate::rng::unit(i.wrapping_mul(step)) - 1.0;
    Vec3::new(along(3_518_319_153), along(2_882_110_345), along(2_360_945_575))
}
