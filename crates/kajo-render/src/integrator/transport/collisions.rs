//! Collisions with the particles of a medium along a ray, and what of light is left along one.
//!
//! Free paths are drawn by null collisions [Woodcock et al. 1965]: to a medium of density `d` one of particles that do nothing is
//! added, so that there are `m >= d` everywhere, the majorant. Collisions of that are exponential, and one at a point of
//! density `d` is real with the probability `d / m`.
//!
//! Coefficients depend on the wavelength, so one lane of the path, its hero `h`, draws distances for all of them. Each lane
//! might have been the hero, and the light found counts over the mean of the densities of all [Wilkie et al. 2014; Miller,
//! Georgiev and Jarosz 2019]. A path carries these as ratios to the density that it was drawn with,
//!
//! ```text
//! r_u[i] = p(path | hero i) / p(path | hero h),    r_l[i] = p(path | hero i, last segment by ratio tracking) / p(path | hero h)
//! ```
//!
//! where `r_l` is that of finding the last segment by a [`super::connect`], whose densities of directions are left out of both.
//! With `T[i] = exp(-sigma_t[i] m s)` over a step of length `s`, `sigma[i] = sigma_t[i] m`:
//!
//! ```text
//!                   beta *=                                     r_u *=                              r_l *=
//! scattered         T[i] sigma_s[i] / (T[h] sigma_t[h])         T[i] sigma[i] / (T[h] sigma[h])     = r_u
//! null collision    T[i] sigma[i] / (T[h] sigma[h])             the same                            the same / (1 - d/m)
//! arrives           T[i] / T[h]                                 the same                            the same
//! ```
//!
//! Absorption is no event: it is a factor, and paths of little weight end by roulette. Where a density is the same everywhere,
//! connections know `T` in a closed form, so that `r_l` is multiplied by `1 / T[h]` upon arrival. All three may be multiplied by
//! one number and no estimate changes; it is chosen so that the mean of `r_u` is 1, and `beta` is the weight of the
//! path as it is without media.

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::medium::{MediumId, Phase};
use kajo_core::sampler::SampleStream;
use kajo_core::scene::Scene;
use kajo_math::{Ray, Vec3, fmath};

use super::PathState;
use super::lane_mis::all_lanes;
use crate::trail::{About, PathObserver};

/// Null collisions along one ray after which it is given up: a majorant that is far above all densities is a mistake of the
/// scene, and must not hold up a picture for ever.
const MOST_COLLISIONS: u32 = 1 << 20;

/// A vertex of a path within a medium.
#[derive(Clone, Copy, Debug)]
pub struct MediumInteraction {
    /// The point, in world space.
    pub p: Vec3,
    /// Unit direction back along the path.
    pub wo: Vec3,
    /// Where to light is scattered.
    pub phase: Phase,
    /// Length of the way from the last event.
    pub length: f32,
    /// Moment within the shutter interval.
    pub time: f32,
}

impl PathState<'_> {
    /// Has media absorb and scatter the path from here on.
    ///
    /// * `hero`: the lane that draws distances
    pub fn carry_media(&mut self, hero: u32) {
        self.carries_media = true;
        self.lanes.hero = hero;
    }

    /// Multiplies the weight of the path and all of its densities by one number, so that the mean of these is 1.
    fn normalize_lanes(&mut self) {
        let mean = self.mean(self.lanes.r_u);
        if mean > 0.0 && mean.is_finite() {
            let factor = 1.0 / mean;
            self.beta *= factor;
            self.lanes.r_u *= factor;
            self.lanes.r_l *= factor;
        } else {
            // Rounding has left nothing of the path.
            self.beta = Spectrum::BLACK;
        }
    }

    /// The mean of densities over the lanes that are followed.
    #[inline]
    pub fn mean(&self, densities: Spectrum) -> f32 {
        self.wavelengths.mean(densities)
    }

    /// Follows the hero's wavelength alone from here on, where paths of the others would take other ways.
    pub fn end_secondary_wavelengths(&mut self) {
        self.wavelengths.terminate_secondary();
        if self.carries_media {
            self.normalize_lanes();
        }
    }
}

/// A medium along a ray, at the wavelengths of a path.
struct Stretch<'a> {
    scene: &'a Scene,
    medium: MediumId,
    sigma_s: Spectrum,
    sigma_t: Spectrum,
    hero: usize,
}

impl<'a> Stretch<'a> {
    fn new(scene: &'a Scene, medium: MediumId, wavelengths: &Wavelengths, hero: u32) -> Stretch<'a> {
        let coefficients = scene.appearance.media.coefficients(medium);
        let sigma_s = coefficients.sigma_s(wavelengths);
        let sigma_t = sigma_s + coefficients.sigma_a(wavelengths);
        Stretch { scene, medium, sigma_s, sigma_t, hero: hero as usize }
    }

    /// `T[i]` over a length with a density.
    fn transmittance(&self, density: f32, length: f32) -> Spectrum {
        // Nothing absorbs nothing over any length.
        (self.sigma_t * -(density * length).min(f32::MAX)).exp()
    }

    fn density(&self, p: Vec3) -> f32 {
        self.scene.appearance.media.density(self.medium, &self.scene.appearance.textures, p)
    }

    /// `T[i] sigma[i] / (T[h] sigma[h])` after a step that ended in a collision; black where rounding left nothing.
    fn collision(&self, t: Spectrum) -> Spectrum {
        let hero = t[self.hero] * self.sigma_t[self.hero];
        if hero > 0.0 { t * self.sigma_t * (1.0 / hero) } else { Spectrum::BLACK }
    }
}

/// Where along a ray collisions with a majorant are, one after the other, drawn by the hero's lane.
///
/// Calls `collide` with each: the distance, `T[i]` of all lanes since the last one, and the majorant; `true` ends the walk.
/// Returns `T[i]` since the last collision where it ends at the far end of the ray.
fn walk(
    stretch: &Stretch<'_>,
    ray: &Ray,
    draws: &mut SampleStream<'_>,
    mut collide: impl FnMut(&mut SampleStream<'_>, f32, Spectrum, f32) -> bool,
) -> Option<Spectrum> {
    let hero = stretch.sigma_t[stretch.hero];
    let mut optical_depth = exponential(draws);
    let mut t = Spectrum::WHITE;
    let mut collisions = 0;
    for majorant in stretch.scene.appearance.media.majorants(stretch.medium, ray) {
        // Where there is nothing, nothing happens.
        if majorant.density == 0.0 {
            continue;
        }
        let mut at = majorant.t_min;
        let sigma = hero * majorant.density;
        loop {
            let step = if sigma > 0.0 { optical_depth / sigma } else { f32::INFINITY };
            if at + step >= majorant.t_max {
                let rest = majorant.t_max - at;
                optical_depth = (optical_depth - sigma * rest).max(0.0);
                t *= stretch.transmittance(majorant.density, rest);
                break;
            }
            at += step;
            t *= stretch.transmittance(majorant.density, step);
            collisions += 1;
            if collide(draws, at, t, majorant.density) || collisions == MOST_COLLISIONS {
                return None;
            }
            t = Spectrum::WHITE;
            optical_depth = exponential(draws);
        }
    }
    Some(t)
}

/// An optical depth of the density `exp(-depth)`.
fn exponential(draws: &mut SampleStream<'_>) -> f32 {
    -fmath::ln(1.0 - draws.next_1d())
}

/// Takes a path along its ray through a medium, up to `length`; where it is scattered on the way.
///
/// Takes a number for each collision with the majorant and, where the density varies, another one for what it is.
fn travel(
    scene: &Scene,
    path: &mut PathState<'_>,
    medium: MediumId,
    length: f32,
) -> Option<MediumInteraction> {
    let stretch = Stretch::new(scene, medium, &path.wavelengths, path.lanes.hero);
    let is_homogeneous = scene.appearance.media.is_homogeneous(medium);
    let scatters = scene.appearance.media.coefficients(medium).scatters();
    if is_homogeneous && !scatters {
        path.beta *= stretch.transmittance(1.0, length);
        return None;
    }
    let ray = Ray { t_min: 0.0, t_max: length, ..path.ray };
    let (mut beta, mut lanes) = (path.beta, path.lanes);
    let wavelengths = path.wavelengths;
    let mut scattered = None;
    let arrives = walk(&stretch, &ray, &mut path.draws, |draws, at, t, majorant| {
        let factor = stretch.collision(t);
        let real = if is_homogeneous { 1.0 } else { (stretch.density(ray.at(at)) / majorant).min(1.0) };
        if is_homogeneous || draws.next_1d() < real {
            // T sigma_s / (T[h] sigma_t[h]): the collision with its albedo.
            beta *= factor * stretch.sigma_s.safe_div(stretch.sigma_t);
            let passed = if is_homogeneous { t } else { Spectrum::WHITE };
            lanes.reach = all_lanes(passed * lanes.r_u.safe_div(lanes.r_l), &wavelengths);
            lanes.sigma_t = all_lanes(stretch.sigma_t, &wavelengths) * (real * majorant);
            lanes.r_u *= factor;
            lanes.r_l = lanes.r_u;
            scattered = Some(at);
            return true;
        }
        beta *= factor;
        lanes.r_u *= factor;
        lanes.r_l *= factor * (1.0 / (1.0 - real));
        false
    });
    if let Some(t) = arrives {
        let hero = 1.0 / t[stretch.hero];
        beta *= t * hero;
        lanes.r_u *= t * hero;
        lanes.r_l *= if is_homogeneous { Spectrum::WHITE * hero } else { t * hero };
    }
    (path.beta, path.lanes) = (beta, lanes);
    path.normalize_lanes();
    if arrives.is_none() && scattered.is_none() {
        path.beta = Spectrum::BLACK;
    }
    let at = scattered?;
    let phase = scene.appearance.media.coefficients(medium).phase();
    Some(MediumInteraction { p: ray.at(at), wo: -ray.d, phase, length: at, time: ray.time })
}

/// Takes the path through the medium around it, up to `length`; where it is scattered on the way.
///
/// Takes numbers as [`travel`].
#[cold]
#[inline(never)]
pub fn travel_to(
    scene: &Scene,
    path: &mut PathState<'_>,
    length: f32,
    observer: &mut impl PathObserver,
) -> Option<MediumInteraction> {
    let medium = path.media.medium()?;
    let at = travel(scene, path, medium, length)?;
    path.beta *= path.media.transmittance(at.length);
    let ray = Ray { t_max: at.length, ..path.ray };
    observer.ended(scene, &ray, None, || About {
        eta: path.media.eta(),
        weight: sensor::to_rgb(path.beta, &path.wavelengths),
        light: None,
    });
    Some(at)
}

/// What of light comes along a segment that joins two vertices, as an estimate, and the densities of the lanes.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    /// The share of light, times the density of what was drawn along the way with the path's hero.
    pub t: Spectrum,
    /// Densities of the path to the vertex before and of what was drawn, by lanes, over that.
    pub r_l: Spectrum,
    /// Densities of going the same way by free paths.
    pub r_u: Spectrum,
}

impl Passage {
    /// Nothing is in the way.
    ///
    /// * `r_u`: of the path to the vertex, [`super::LaneMis::r_u`], or of both paths that are joined
    pub fn open(r_u: Spectrum) -> Passage {
        Passage { t: Spectrum::WHITE, r_l: r_u, r_u }
    }

    /// The probability of going the same way by free paths, the mean over all lanes; 1 where nothing is in the way.
    pub fn reach(&self, wavelengths: &Wavelengths) -> f32 {
        all_lanes(self.r_u.safe_div(self.r_l), wavelengths)
    }

    /// Nothing comes along.
    pub fn closed() -> Passage {
        Passage { t: Spectrum::BLACK, r_l: Spectrum::WHITE, r_u: Spectrum::WHITE }
    }

    /// Goes on through a stretch of a medium by ratio tracking [Novák, Selle and Jarosz 2014]: at each collision with the
    /// majorant the share `1 - d/m` is left. Where the density is the same everywhere, `T` is known.
    ///
    /// * `ray`: of unit direction, from its start to `t_max`
    pub fn through(
        &mut self,
        scene: &Scene,
        medium: MediumId,
        ray: &Ray,
        wavelengths: &Wavelengths,
        hero: u32,
        draws: &mut SampleStream<'_>,
    ) {
        let stretch = Stretch::new(scene, medium, wavelengths, hero);
        if scene.appearance.media.is_homogeneous(medium) {
            let t = stretch.transmittance(1.0, ray.t_max);
            self.t *= t;
            // Paths go through what scatters nothing with the probability 1.
            if scene.appearance.media.coefficients(medium).scatters() {
                self.r_u *= t;
            }
            return;
        }
        let Passage { t: left, r_l, r_u } = self;
        let arrives = walk(&stretch, ray, draws, |_, at, t, majorant| {
            let (factor, real) = (stretch.collision(t), (stretch.density(ray.at(at)) / majorant).min(1.0));
            *left *= factor * (1.0 - real);
            *r_l *= factor;
            *r_u *= factor * (1.0 - real);
            left.is_black()
        });
        match arrives {
            Some(t) => {
                let ratio = t * (1.0 / t[stretch.hero]);
                self.t *= ratio;
                self.r_l *= ratio;
                self.r_u *= ratio;
            }
            None => *self = Passage::closed(),
        }
    }
}
