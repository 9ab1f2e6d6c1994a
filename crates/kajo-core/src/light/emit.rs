//! Light as it leaves its emitter: where paths from the emitters begin.
//!
//! A light is drawn with a probability `c` in proportion to its power, then a place on it and a direction. What the ray
//! carries is its power over the density of all that,
//!
//! ```text
//! W = L cos / (c p_place p_direction)
//!
//! surface             place by area                        direction by the cosine
//! point, spot         one place, of density 1              all directions of its light alike
//! infinitely far      a disk across the way, as            direction as drawn for a receiver; 1 for a light that
//!                     wide as the scene                    no ray finds by chance
//! ```
//!
//! [Veach 1997, 8.2], [Pharr, Jakob and Humphreys 2023, 12]. For a point light the radiance is its intensity and there is
//! no cosine; for lights infinitely far the cosine with the disk is 1.

use std::f32::consts::PI;

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::{Aabb, Frame, Ray, Vec2, Vec3, robust::offset_origin, warp};

use super::{Emitter, Emitters, Lights, Target};

/// A ball around everything that has bounds, for lights infinitely far away to shine at.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    /// Its middle.
    pub center: Vec3,
    /// Its radius.
    pub radius: f32,
}

impl Ball {
    /// A little more room than the box needs, so that rounding puts nothing outside.
    const MARGIN: f32 = 1.001;

    /// The ball around a box; around the origin when that is empty.
    pub fn around(bounds: &Aabb) -> Ball {
        if bounds.is_empty() {
            return Ball { center: Vec3::ZERO, radius: 1.0 };
        }
        let radius = Ball::MARGIN * 0.5 * bounds.extent().length();
        Ball { center: bounds.center(), radius: radius.max(f32::MIN_POSITIVE) }
    }

    /// Area of its shadow.
    pub fn cross_section(&self) -> f32 {
        PI * self.radius * self.radius
    }

    /// A point of the disk before the ball, from which light travels along the unit vector `d`.
    pub(super) fn disk(&self, u: Vec2, d: Vec3) -> Vec3 {
        let across = self.radius * warp::concentric_disk(u).extend(0.0);
        self.center - self.radius * d + Frame::from_normal(d).to_world(across)
    }

    /// Density per area of the point of the disk from which light along `d` comes to `p`; 0 where it does not.
    pub(super) fn pdf(&self, p: Vec3, d: Vec3) -> f32 {
        let offset = p - self.center;
        let along = offset.dot(d);
        let aside = offset - along * d;
        let lit = along >= -self.radius && aside.length_squared() <= self.radius * self.radius;
        if lit { 1.0 / self.cross_section() } else { 0.0 }
    }
}

/// A ray of light that leaves an emitter, drawn at random.
#[derive(Clone, Copy, Debug)]
pub struct Emitted {
    /// Where it starts: on the light, or before the scene.
    pub p: Vec3,
    /// What is there. Of a light infinitely far away only the direction belongs to it.
    pub origin: Target,
    /// Unit direction of the light.
    pub d: Vec3,
    /// Radiance; the intensity of a point, the irradiance of a light infinitely far away that no ray finds by chance.
    pub radiance: Spectrum,
    /// Coefficients `[c0, c1, c2]` of a falloff with distance `1 / (c0 + c1 d + c2 d^2)`.
    pub attenuation: [f32; 3],
    /// Densities of place and direction.
    pub pdf: EmissionPdf,
    /// Whether no ray finds the light by chance.
    pub is_delta: bool,
}

/// Densities of light that leaves an emitter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EmissionPdf {
    /// Of the place, per area; 1 for a point.
    pub place: f32,
    /// Of the direction, per solid angle; 1 for a light infinitely far away that no ray finds by chance.
    pub direction: f32,
}

/// The falloff by which light keeps its power.
pub(super) const INVERSE_SQUARE: [f32; 3] = [0.0, 0.0, 1.0];

impl Emitted {
    /// Whether the light is infinitely far away.
    pub fn is_infinite(&self) -> bool {
        matches!(self.origin, Target::Infinity)
    }

    /// Cosine at the light, where it has a surface.
    pub fn cosine(&self) -> f32 {
        match self.origin {
            Target::Surface { n, .. } => n.dot(self.d).abs(),
            Target::Point(_) | Target::Infinity => 1.0,
        }
    }

    /// What the ray carries.
    pub fn power(&self) -> Spectrum {
        self.radiance * (self.cosine() / (self.pdf.place * self.pdf.direction))
    }

    /// Power at a distance over power at the start, for lights whose falloff is none of nature's.
    pub fn share_at(&self, distance: f32) -> f32 {
        if self.attenuation == INVERSE_SQUARE {
            return 1.0;
        }
        let [c0, c1, c2] = self.attenuation;
        distance * distance / (c0 + distance * (c1 + distance * c2))
    }

    /// The ray, clear of the light's own surface.
    pub fn ray(&self, time: f32) -> Ray {
        let o = match self.origin {
            Target::Surface { p, p_error, n } => offset_origin(p, p_error, n, self.d),
            Target::Point(_) | Target::Infinity => self.p,
        };
        Ray { o, t_min: 0.0, d: self.d, t_max: f32::INFINITY, time }
    }
}

/// The lights of a scene, for paths to begin at.
#[derive(Debug)]
pub struct Departures {
    world: Ball,
    /// Sums of the powers of all lights up to each.
    sums: Vec<f32>,
}

impl Departures {
    /// * `bounds`: of everything that has any
    pub fn new(emitters: &Emitters, lights: &Lights, bounds: &Aabb) -> Departures {
        let world = Ball::around(bounds);
        let powers = emitters.list().iter().map(|&id| f64::from(lights.power(id, &world)));
        let sums = powers.scan(0.0, |sum: &mut f64, power| {
            *sum += if power.is_finite() { power.max(0.0) } else { 0.0 };
            Some(*sum as f32)
        });
        Departures { world, sums: sums.collect() }
    }

    /// The ball that lights infinitely far away shine at.
    pub fn world(&self) -> &Ball {
        &self.world
    }

    /// Probability of choosing a light.
    pub fn probability(&self, emitter: u32) -> f32 {
        let i = emitter as usize;
        let before = i.checked_sub(1).map_or(0.0, |i| self.sums[i]);
        self.sums.last().map_or(0.0, |&all| if all > 0.0 { (self.sums[i] - before) / all } else { 0.0 })
    }

    /// The number of an emitter for a uniform `u` in [0, 1); `None` when none gives light.
    pub fn choose(&self, u: f32) -> Option<u32> {
        let all = *self.sums.last()?;
        let i = self.sums.partition_point(|&sum| sum <= u * all);
        (i < self.sums.len()).then_some(i as u32)
    }
}

/// Directions of a cosine's density around `n`, or with `u.x` doubled on both sides of it.
pub(super) fn cosine_around(n: Vec3, u: Vec2, both: bool) -> Vec3 {
    let (x, side) = match (both, u.x < 0.5) {
        (false, _) => (u.x, 1.0),
        (true, true) => (2.0 * u.x, 1.0),
        (true, false) => (2.0 * u.x - 1.0, -1.0),
    };
    Frame::from_normal(side * n).to_world(warp::cosine_hemisphere(Vec2::new(x, u.y)))
}

/// The power of light from infinitely far, estimated by an even grid of the light's own samples.
pub(super) fn power_by_samples(light: &impl Emitter, world: &Ball) -> f32 {
    const SIDE: u32 = 24;
    let sample = |i: u32| {
        let u = Vec2::new((i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5) / SIDE as f32;
        let sample = light.sample(world.center, 0.0, u, &Wavelengths::RGB);
        sample.map_or(0.0, |sample| sample.radiance.luminance() / sample.pdf)
    };
    world.cross_section() * (0..SIDE * SIDE).map(sample).sum::<f32>() / (SIDE * SIDE) as f32
}
