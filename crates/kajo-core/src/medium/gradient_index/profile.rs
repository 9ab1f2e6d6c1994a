//! Indices of refraction by place.

use std::cell::RefCell;
use std::sync::Arc;

use kajo_math::fmath::{exp64, tanh64};
use kajo_math::noise::perlin_slope64;
use kajo_math::tape::{Dual, Tape};
use kajo_math::{DVec3, Vec3};

use super::IndexGrid;

/// An index of refraction by world-space place.
#[derive(Clone, Debug)]
pub enum Profile {
    /// A function of x, y and z.
    Function(Arc<Tape>),
    /// `n^2 = 2 - (r/R)^2`: parallel rays meet in a point of the surface of the ball [Luneburg 1944].
    Luneburg {
        /// Centre of the ball.
        center: DVec3,
        /// Its radius R.
        radius: f64,
    },
    /// `n = n0 / (1 + (r/a)^2)`: rays are circles, and all that leave a point meet again in another one [Maxwell 1854].
    FishEye {
        /// Centre.
        center: DVec3,
        /// The distance `a` at which the index is half of `n0`.
        radius: f64,
        /// Index at the centre.
        index: f64,
    },
    /// `n^2 = n0^2 (1 - (g r)^2)` at the distance r from an axis: a rod that light winds through like a wave.
    Rod {
        /// A point of the axis.
        origin: DVec3,
        /// Unit vector along it.
        axis: DVec3,
        /// Index on the axis.
        index: f64,
        /// `g`, per length.
        gradient: f64,
    },
    /// `n^2 = n0^2 + 2 g (x - x0)`: rays are parabolas.
    Linear {
        /// The point `x0`.
        origin: DVec3,
        /// The index there.
        index: f64,
        /// Half the gradient of `n^2`, per length.
        gradient: DVec3,
    },
    /// Air over hot or cold ground.
    Layers(AirLayers),
    /// A smooth function through numbers on a grid.
    Grid(Arc<IndexGrid>),
}

thread_local! {
    /// Results of operations, kept from point to point.
    static SLOTS: RefCell<Vec<Dual<f64, 3>>> = const { RefCell::new(Vec::new()) };
}

impl Profile {
    /// The square of the index, and half its gradient; not a number, or not positive, where there is none.
    #[inline]
    pub fn squared(&self, p: DVec3) -> (f64, DVec3) {
        match self {
            Profile::Function(tape) => {
                let variables = [0, 1, 2].map(|i| {
                    let slopes = std::array::from_fn(|k| if k == i { 1.0 } else { 0.0 });
                    Dual { value: p[i], slopes }
                });
                let Dual { value, slopes } = SLOTS.with_borrow_mut(|slots| tape.at(&variables, slots));
                if value > 0.0 {
                    (value * value, value * DVec3::from(slopes))
                } else {
                    (f64::NAN, DVec3::NAN)
                }
            }
            Profile::Luneburg { center, radius } => {
                let r = (p - *center) / *radius;
                (2.0 - r.length_squared(), -r / *radius)
            }
            Profile::FishEye { center, radius, index } => {
                let r = (p - *center) / *radius;
                let n = index / (1.0 + r.length_squared());
                (n * n, -2.0 * n * n * n / (index * radius) * r)
            }
            Profile::Rod { origin, axis, index, gradient } => {
                let from = p - *origin;
                let across = from - from.dot(*axis) * *axis;
                let g2 = gradient * gradient;
                (index * index * (1.0 - g2 * across.length_squared()), -index * index * g2 * across)
            }
            Profile::Linear { origin, index, gradient } => {
                (index * index + 2.0 * gradient.dot(p - *origin), *gradient)
            }
            Profile::Layers(layers) => {
                let (n, slope) = layers.index(p.dot(layers.up) - layers.ground);
                (n * n, n * slope * layers.up)
            }
            Profile::Grid(grid) => {
                let (n, slope) = grid.index(p);
                if n > 0.0 { (n * n, n * slope) } else { (f64::NAN, DVec3::NAN) }
            }
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        match self {
            Profile::Function(_) => true,
            Profile::Luneburg { center, radius } => center.is_finite() && radius.is_finite(),
            Profile::FishEye { center, radius, index } => {
                center.is_finite() && radius.is_finite() && index.is_finite()
            }
            Profile::Rod { origin, axis, index, gradient } => {
                origin.is_finite() && axis.is_finite() && index.is_finite() && gradient.is_finite()
            }
            Profile::Linear { origin, index, gradient } => {
                origin.is_finite() && index.is_finite() && gradient.is_finite()
            }
            Profile::Layers(layers) => layers.is_finite(),
            Profile::Grid(grid) => grid.is_finite(),
        }
    }
}

/// Air whose temperature depends on the height above the ground:
///
/// ```text
/// T(h) = T0 + rise exp(-h / depth) + inversion (1 + tanh((h - height) / width)) / 2
/// n(h) = 1 + r (T0 / T(h) - 1),          r = 2.77e-4 (288.15 K / T0) strength
/// ```
///
/// at the pressure of the sea. Indices are relative to that of air at `T0`, so that what is around has the index 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirLayers {
    /// Unit vector.
    pub up: DVec3,
    /// The ground is where the place along `up` is this.
    pub ground: f64,
    /// `T0` in K.
    pub temperature: f64,
    /// How much hotter the ground is, in K; negative where it is colder.
    pub rise: f64,
    /// The height in which that falls to 1/e.
    pub depth: f64,
    /// How much warmer the air is above the inversion, in K.
    pub inversion: f64,
    /// Height of the inversion's middle.
    pub height: f64,
    /// Half its width, about.
    pub width: f64,
    /// Factor of all that bends light; 1 for air.
    pub strength: f64,
}

/// `n - 1` of air at 288.15 K and the pressure of the sea.
const REFRACTIVITY: f64 = 2.77e-4;

impl AirLayers {
    /// The index at a height and its derivative.
    pub fn index(&self, h: f64) -> (f64, f64) {
        let hot = self.rise * exp64(-h / self.depth);
        let step = tanh64((h - self.height) / self.width);
        let t = self.temperature + hot + 0.5 * self.inversion * (1.0 + step);
        let slope = -hot / self.depth + 0.5 * self.inversion * (1.0 - step * step) / self.width;
        let refractivity = self.strength * REFRACTIVITY * 288.15 / self.temperature;
        let n = 1.0 + refractivity * (self.temperature / t - 1.0);
        // There is no air without a temperature.
        if t > 0.0 { (n, -refractivity * self.temperature / (t * t) * slope) } else { (f64::NAN, f64::NAN) }
    }

    fn is_finite(&self) -> bool {
        let AirLayers { up, ground, temperature, rise, depth, inversion, height, width, strength } = *self;
        up.is_finite()
            && [ground, temperature, rise, depth, inversion, height, width, strength]
                .iter()
                .all(|v| v.is_finite())
    }
}

/// Perlin noise that is added to the index: `a (N(q) + N(2q)/2 + N(4q)/4 + ...)`, `q = f (p - x)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IndexTurbulence {
    /// `a`.
    pub amplitude: f64,
    /// `f`, per length along each axis.
    pub frequency: Vec3,
    /// `x`: where its origin is.
    pub origin: Vec3,
    /// How many noises there are.
    pub octaves: u32,
}

impl IndexTurbulence {
    /// What it adds at a world-space point, and the gradient of that.
    pub fn at(&self, p: DVec3) -> (f64, DVec3) {
        let frequency = self.frequency.as_dvec3();
        let from = p - self.origin.as_dvec3();
        let (mut q, mut size, mut scale) = (from * frequency, self.amplitude, frequency);
        let (mut sum, mut slope) = (0.0, DVec3::ZERO);
        for _ in 0..self.octaves {
            let (value, its_slope) = perlin_slope64(q);
            sum += size * value;
            slope += size * scale * its_slope;
            q *= 2.0;
            scale *= 2.0;
            size *= 0.5;
        }
        (sum, slope)
    }

    pub(super) fn is_finite(&self) -> bool {
        self.amplitude.is_finite() && self.frequency.is_finite() && self.origin.is_finite()
    }
}
