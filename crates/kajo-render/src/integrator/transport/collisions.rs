//! Collisions with the particles of a medium along a ray, and its transmittance.
//!
//! What is estimated is radiance along a ray in a medium that scatters and emits,
//!
//! ```text
//! L = integral of  T(t) sigma_s d(t) (integral of p(wo, wi) Li(wi) dwi)  dt  +  integral of  T(t) e(t) dt  +  T(s) L(s)
//! ```
//!
//! over the distance `t` to the next surface at `s`: the first one by sampling `t` (a collision that scatters), the
//! second at one point of each stretch without a collision, the third where the path arrives.
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
//! Connections go by residual ratio tracking [Novák, Selle and Jarosz 2014]: where the density is nowhere less than `c`, that part of it is a
//! factor `exp(-sigma_t[i] c s)`, and null collisions are drawn of the rest, of the majorant `m - c`. Both ways have the same null
//! collisions, so that each knows the density of the other. With `T[i] = exp(-sigma_t[i] m s)` over a step of length `s`, the residual
//! transmittance `R[i] = exp(-sigma_t[i] (m - c) s)`, and `sigma = sigma_t`:
//!
//! ```text
//!                   beta *=                               r_u *=                              r_l *=
//! scattered         T[i] sigma_s[i] / (T[h] sigma[h])     T[i] sigma[i] / (T[h] sigma[h])     = r_u
//! null collision    T[i] sigma[i] / (T[h] sigma[h])       the same                            R[i] sigma[i] (m - c) / (T[h] sigma[h] (m - d))
//! arrives           T[i] / T[h]                           the same                            R[i] / T[h]
//! ```
//!
//! and for a connection, whose null collisions have the density of `r_l`,
//!
//! ```text
//!                   t *=                                                       r_u *=           r_l *=
//! null collision    T[i] sigma[i] (m - d) / (R[h] sigma[h] (m - c))            the same         R[i] sigma[i] / (R[h] sigma[h])
//! arrives           T[i] / R[h]                                                the same         R[i] / R[h]
//! ```
//!
//! Where a density is the same everywhere, `R = 1`: connections know `T` in a closed form. Absorption is no event: it is a factor, and paths of
//! little weight end by roulette. All three of a path may be multiplied by one number and no estimate changes; it is chosen so that
//! the mean of `r_u` is 1, and `beta` is the weight of the path as it is without media.
//!
//! What a medium gives of its own is found by paths from the camera alone, on each stretch that they go without a collision.
//!
//! For overlapping media, and densities that have a colour, see `overlap.rs`.

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::bsdf::Transport;
use kajo_core::medium::{Coefficients, Heat, Majorants, MediumId, PhaseAtWavelengths, VelocityGrid};
use kajo_core::sampler::SampleStream;
use kajo_core::scene::Scene;
use kajo_math::{Ray, Vec3, fmath};

use super::emission_points::EmissionPoints;
use super::lane_mis::all_lanes;
use super::null_collisions::{CollisionVisitor, NullCollisionMedium, Span, walk};
use super::{LaneMis, MediumStack, PathState};

/// A vertex of a path within a medium.
#[derive(Clone, Copy, Debug)]
pub struct MediumInteraction<'a> {
    /// The point, in world space.
    pub p: Vec3,
    /// Unit direction back along the path.
    pub wo: Vec3,
    /// Phase function there.
    pub phase: PhaseAtWavelengths<'a>,
    /// Length along the path since the last event.
    pub length: f32,
    /// Moment within the shutter interval.
    pub time: f32,
    /// Whether it is within a body that light is scattered in many times before it leaves; see
    /// [`kajo_core::medium::Coefficients::is_subsurface`].
    pub is_subsurface: bool,
}

impl MediumStack {
    /// Scattering per unit length of all media at a point, by lanes.
    ///
    /// * `p`: in world space, where the stack holds
    /// * `time`: moment within the shutter interval
    pub fn scattering(&self, scene: &Scene, p: Vec3, time: f32, wavelengths: &Wavelengths) -> Spectrum {
        let of = |medium: MediumId| {
            let coefficients = scene.appearance.media.coefficients(medium);
            let p = source(scene.appearance.media.velocities(medium), p, time);
            let density = scene.appearance.spectral_density(medium, p, wavelengths);
            scattering_at(coefficients, density, p, wavelengths)
        };
        if !self.overlaps() {
            return self.medium().map_or(Spectrum::BLACK, of);
        }
        let each = self.each_medium();
        each.iter().filter_map(|medium| medium.get()).fold(Spectrum::BLACK, |sum, medium| sum + of(medium))
    }
}

/// Scattering per unit length of a medium at a point, by lanes.
///
/// * `density`: there, by lanes
/// * `p`: where its matter was at the moment that its grids are of
pub(super) fn scattering_at(
    coefficients: &Coefficients,
    density: Spectrum,
    p: Vec3,
    wavelengths: &Wavelengths,
) -> Spectrum {
    let sigma_s = coefficients.sigma_s(wavelengths) * density;
    coefficients.colors().map_or(sigma_s, |colors| sigma_s * colors.at(p, wavelengths))
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

    /// Multiplies the weight of a path that a medium scatters by what its colours say there.
    ///
    /// * `p`: where its matter was at the moment that they are of
    #[inline]
    pub(super) fn scatter_by_colors(&mut self, coefficients: &Coefficients, p: Vec3) {
        if let Some(colors) = coefficients.colors() {
            self.beta *= colors.at(p, &self.wavelengths);
        }
    }

    /// The mean of densities over the lanes that are followed.
    #[inline]
    pub fn mean(&self, densities: Spectrum) -> f32 {
        self.wavelengths.mean(densities)
    }

    /// Multiplies the weight of a path, and its densities by free paths, by the values of a phase function that differ between lanes.
    ///
    /// Each lane might have drawn the direction, as each might have drawn the distances, with `p_i` where `p` is their mean:
    ///
    /// ```text
    /// beta *= p_i / p,    r_u *= p_i / p,    r_l unchanged
    /// ```
    ///
    /// Light drawn for the vertex knows nothing of the direction, so neither does [`LaneMis::r_l`]; the density that is
    /// weighed with `r_u` is `p`.
    ///
    /// * `colors`: `p_i / p`, see [`kajo_core::medium::phase::PhaseValue`]
    pub(super) fn turn_by_lanes(&mut self, colors: Spectrum) {
        self.beta *= colors;
        self.lanes.r_u *= lane_densities(colors);
        self.normalize_lanes();
    }

    /// Follows the hero's wavelength alone from here on, where paths of the others would take other directions.
    pub fn end_secondary_wavelengths(&mut self) {
        self.wavelengths.terminate_secondary();
        if self.carries_media {
            self.normalize_lanes();
        }
    }
}

/// Densities of a direction by lanes, over their mean.
///
/// A lane that sends nothing there keeps a density that rounding hides in means over the lanes: else its part in the ratio
/// of `r_u` and `r_l` would be lost on all later segments, where paths from the other end have it.
///
/// * `colors`: values by lanes over their mean, see [`kajo_core::medium::phase::PhaseValue`]
pub fn lane_densities(colors: Spectrum) -> Spectrum {
    colors.map(|share| share.max(1e-7))
}

/// A medium along a ray, at the wavelengths of a path.
pub(super) struct MediumAlongRay<'a> {
    scene: &'a Scene,
    pub(super) medium: MediumId,
    pub(super) sigma_s: Spectrum,
    pub(super) sigma_t: Spectrum,
    velocities: Option<&'a VelocityGrid>,
    hero: usize,
}

/// Where the matter of a medium that is at a point at a ray's time was at the moment that its grids are of.
#[inline]
fn source(velocities: Option<&VelocityGrid>, p: Vec3, time: f32) -> Vec3 {
    velocities.map_or(p, |velocities| velocities.source(p, time))
}

/// The density on a part of a ray is between these.
#[derive(Clone, Copy)]
pub(super) struct DensityRange {
    /// `c`.
    least: f32,
    /// `m`.
    most: f32,
}

impl DensityRange {
    /// `m - c`.
    #[inline]
    fn width(&self) -> f32 {
        self.most - self.least
    }
}

impl NullCollisionMedium for MediumAlongRay<'_> {
    type Most = DensityRange;
    type Depth = f32;

    #[inline]
    fn spans(&self, ray: &Ray) -> impl Iterator<Item = Span<DensityRange>> {
        self.majorants(ray).map(|majorant| Span {
            t_min: majorant.t_min,
            t_max: majorant.t_max,
            most: DensityRange { least: majorant.least, most: majorant.density },
        })
    }

    #[inline]
    fn is_void(&self, density: &DensityRange) -> bool {
        density.most == 0.0
    }

    #[inline]
    fn hero_extinction(&self, density: &DensityRange) -> f32 {
        self.sigma_t[self.hero] * density.most
    }

    #[inline]
    fn depth(&self, density: &DensityRange, length: f32) -> f32 {
        density.most * length
    }

    #[inline]
    fn transmittance(&self, depth: f32) -> Spectrum {
        self.transmittance_of(depth)
    }
}

/// What is left of a medium without the part of its density that is everywhere there.
struct Residual<'a>(&'a MediumAlongRay<'a>);

impl NullCollisionMedium for Residual<'_> {
    type Most = DensityRange;
    type Depth = f32;

    #[inline]
    fn spans(&self, ray: &Ray) -> impl Iterator<Item = Span<DensityRange>> {
        self.0.spans(ray)
    }

    #[inline]
    fn is_void(&self, density: &DensityRange) -> bool {
        self.0.is_void(density)
    }

    #[inline]
    fn hero_extinction(&self, density: &DensityRange) -> f32 {
        self.0.sigma_t[self.0.hero] * density.width()
    }

    #[inline]
    fn depth(&self, density: &DensityRange, length: f32) -> f32 {
        density.width() * length
    }

    #[inline]
    fn transmittance(&self, depth: f32) -> Spectrum {
        self.0.transmittance_of(depth)
    }
}

impl<'a> MediumAlongRay<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        medium: MediumId,
        wavelengths: &Wavelengths,
        hero: u32,
    ) -> MediumAlongRay<'a> {
        let coefficients = scene.appearance.media.coefficients(medium);
        let sigma_s = coefficients.sigma_s(wavelengths);
        let sigma_t = sigma_s + coefficients.sigma_a(wavelengths);
        let velocities = scene.appearance.media.velocities(medium);
        MediumAlongRay { scene, medium, sigma_s, sigma_t, velocities, hero: hero as usize }
    }

    pub(super) fn majorants(&self, ray: &Ray) -> Majorants<'a> {
        self.scene.appearance.media.majorants(self.medium, ray)
    }

    /// `T[i]` for the integral of a density over a length.
    #[inline]
    fn transmittance_of(&self, depth: f32) -> Spectrum {
        // A lane without extinction transmits everything over an infinite length too, where 0 times infinity would be no number.
        (self.sigma_t * -depth.min(f32::MAX)).exp()
    }

    /// Where its matter that is at a point at a ray's time was at the moment that its grids are of.
    #[inline]
    pub(super) fn source(&self, p: Vec3, time: f32) -> Vec3 {
        source(self.velocities, p, time)
    }

    /// * `p`: [source](MediumAlongRay::source) of a point
    pub(super) fn density(&self, p: Vec3) -> f32 {
        self.scene.appearance.density(self.medium, p)
    }

    /// The density at a point by lanes.
    ///
    /// * `p`: [source](MediumAlongRay::source) of a point
    pub(super) fn spectral_density(&self, p: Vec3, wavelengths: &Wavelengths) -> Spectrum {
        self.scene.appearance.spectral_density(self.medium, p, wavelengths)
    }

    /// The share of collisions with the majorant `m` at a distance along a ray that are real.
    #[inline]
    fn real_share(&self, ray: &Ray, at: f32, majorant: f32) -> f32 {
        (self.density(self.source(ray.at(at), ray.time)) / majorant).min(1.0)
    }

    /// `T[i] sigma[i] / (T'[h] sigma[h])` after a step that ended in a collision; black where rounding left nothing.
    ///
    /// * `drawn`: `T'[h]`, of what the step was drawn by
    fn collision(&self, t: Spectrum, drawn: f32) -> Spectrum {
        let hero = drawn * self.sigma_t[self.hero];
        if hero > 0.0 { t * self.sigma_t * (1.0 / hero) } else { Spectrum::BLACK }
    }
}

/// Delta tracking of a path through a medium.
struct DeltaTracking<'a> {
    stretch: &'a MediumAlongRay<'a>,
    ray: &'a Ray,
    wavelengths: Wavelengths,
    is_homogeneous: bool,
    beta: Spectrum,
    lanes: LaneMis,
    /// Since the last collision.
    passed: PassedDensities,
    scattered: Option<f32>,
    /// Emission of the medium, where the path collects it.
    emission: Option<EmissionAlongRay>,
}

/// Integrals of bounds on the density along a part of a ray.
#[derive(Clone, Copy, Default)]
struct PassedDensities {
    /// Of `c`.
    least: f32,
    /// Of `m - c`.
    rest: f32,
}

impl PassedDensities {
    #[inline]
    fn pass(&mut self, density: &DensityRange, length: f32) {
        self.least += density.least * length;
        self.rest += density.width() * length;
    }

    /// `R[i]`.
    ///
    /// * `t`: `T[i]`
    #[inline]
    fn residual(&self, sigma_t: Spectrum, t: Spectrum) -> Spectrum {
        if self.least > 0.0 { (sigma_t * -self.rest).exp() } else { t }
    }

    /// `T[i] / R[i]`.
    #[inline]
    fn known(&self, sigma_t: Spectrum) -> Spectrum {
        if self.least > 0.0 { (sigma_t * -self.least).exp() } else { Spectrum::WHITE }
    }
}

/// Emission of a medium along a ray, collected towards the camera.
struct EmissionAlongRay {
    /// Where it is asked for; where there are none, at one point of each stretch without a collision.
    points: Option<EmissionPoints>,
    /// Radiance per unit length at the density 1.
    radiance: Spectrum,
    /// What absorbs it besides the medium: the body's own absorption.
    sigma_a: Spectrum,
    /// The sum so far.
    found: Spectrum,
}

impl DeltaTracking<'_> {
    /// Adds the light that the medium gives along a stretch without collisions, at some points of it.
    ///
    /// In the mean over such stretches that is the integral of `T e d`, with the radiance `e` per unit length at the density
    /// 1 and the density `d`, since the path gets to a point without a collision with the probability `T[h]`.
    ///
    /// * `emission_at`: that radiance at a point, of what it is everywhere
    #[inline]
    fn add_emission(
        &mut self,
        draws: &mut SampleStream<'_>,
        from: f32,
        to: f32,
        depth: f32,
        majorant: f32,
        emission_at: impl Fn(Vec3, Spectrum) -> Spectrum,
    ) {
        let Some(EmissionAlongRay { points, radiance, sigma_a, found }) = &mut self.emission else { return };
        let mut add = |at: f32, length: f32| {
            let p = self.stretch.source(self.ray.at(at), self.ray.time);
            let density = if self.is_homogeneous { 1.0 } else { self.stretch.density(p) };
            let t = self.stretch.transmittance_of(depth + majorant * (at - from));
            let ratio = t * (1.0 / t[self.stretch.hero]);
            let mean = self.wavelengths.mean(self.lanes.r_u * ratio);
            let radiance = emission_at(p, *radiance);
            let added = self.beta * ratio * radiance * (*sigma_a * -at).exp() * (density * length / mean);
            if added.is_finite() {
                *found += added;
            }
        };
        let Some(points) = points else { return add(from + draws.next_1d() * (to - from), to - from) };
        while let Some((at, length)) = points.next_in(from, to, majorant) {
            add(at, length);
        }
        points.pass(from, to, majorant);
    }
}

/// What sampling the collisions along a ray has made of a path.
pub(super) struct Walked {
    pub(super) beta: Spectrum,
    pub(super) lanes: LaneMis,
    /// Light that media gave since it was taken last, where that counts.
    pub(super) emitted: Option<Spectrum>,
    /// `R[i]` since the last collision, where it arrives.
    pub(super) residual: Spectrum,
    pub(super) is_scattered: bool,
}

impl PathState<'_> {
    /// Writes the result of sampling collisions along a ray back to the path: where it arrives, the third row of the table above [Miller, Georgiev and Jarosz 2019].
    ///
    /// * `arrives`: `T[i]` since the last collision, where it comes to the far end
    #[inline]
    pub(super) fn leave_walk(&mut self, walked: Walked, arrives: Option<Spectrum>) {
        let Walked { mut beta, mut lanes, emitted, residual, is_scattered } = walked;
        if let Some(t) = arrives {
            let hero = 1.0 / t[lanes.hero as usize];
            beta *= t * hero;
            lanes.r_u *= t * hero;
            lanes.r_l *= residual * hero;
        }
        (self.beta, self.lanes) = (beta, lanes);
        if let Some(emitted) = emitted {
            self.emitted = emitted;
        }
        self.normalize_lanes();
        if arrives.is_none() && !is_scattered {
            self.beta = Spectrum::BLACK;
        }
    }
}

impl CollisionVisitor<DensityRange, f32> for DeltaTracking<'_> {
    #[inline]
    fn pass(&mut self, draws: &mut SampleStream<'_>, from: f32, to: f32, depth: f32, density: &DensityRange) {
        self.add_emission(draws, from, to, depth, density.most, |_, emission| emission);
        self.passed.pass(density, to - from);
    }

    fn collide(
        &mut self,
        draws: &mut SampleStream<'_>,
        at: f32,
        t: Spectrum,
        density: &DensityRange,
    ) -> bool {
        let passed = std::mem::take(&mut self.passed);
        let DeltaTracking { stretch, is_homogeneous, beta, lanes, .. } = self;
        let (is_homogeneous, majorant) = (*is_homogeneous, density.most);
        let (sigma_t, drawn) = (stretch.sigma_t, t[stretch.hero]);
        let factor = stretch.collision(t, drawn);
        let real = if is_homogeneous { 1.0 } else { stretch.real_share(self.ray, at, majorant) };
        if is_homogeneous || draws.next_1d() < real {
            // First row: T[i] sigma_s[i] / (T[h] sigma_t[h]), and T[i] sigma[i] / (T[h] sigma[h]) for r_u. The probability d / m of a
            // real collision is the same for all lanes, and cancels [Miller, Georgiev and Jarosz 2019].
            *beta *= factor * stretch.sigma_s.safe_div(sigma_t);
            let known = if is_homogeneous { t } else { passed.known(sigma_t) };
            lanes.reach = all_lanes(known * lanes.r_u.safe_div(lanes.r_l), &self.wavelengths);
            lanes.sigma_t = all_lanes(sigma_t, &self.wavelengths) * (real * majorant);
            lanes.r_u *= factor;
            lanes.r_l = lanes.r_u;
            self.scattered = Some(at);
            return true;
        }
        // Second row: a null collision. A free path passes it with the probability 1 - d / m, ratio tracking with 1, so that does not cancel in r_l.
        *beta *= factor;
        lanes.r_u *= factor;
        let residual = stretch.collision(passed.residual(sigma_t, t), drawn);
        lanes.r_l *= residual * (density.width() / (majorant * (1.0 - real)));
        false
    }
}

/// The same through a medium that emits by its temperature.
struct HotDeltaTracking<'a> {
    tracking: DeltaTracking<'a>,
    heat: &'a Heat,
}

impl CollisionVisitor<DensityRange, f32> for HotDeltaTracking<'_> {
    #[inline]
    fn pass(&mut self, draws: &mut SampleStream<'_>, from: f32, to: f32, depth: f32, density: &DensityRange) {
        let HotDeltaTracking { tracking, heat } = self;
        let wavelengths = tracking.wavelengths;
        tracking.add_emission(draws, from, to, depth, density.most, |p, _| heat.emission(p, &wavelengths));
        tracking.passed.pass(density, to - from);
    }

    #[inline]
    fn collide(
        &mut self,
        draws: &mut SampleStream<'_>,
        at: f32,
        t: Spectrum,
        density: &DensityRange,
    ) -> bool {
        self.tracking.collide(draws, at, t, density)
    }
}

/// Samples a free path by delta tracking along the ray of a path through a medium, at most `length`; returns the
/// collision that scatters it, if there is one.
///
/// Takes a number for each collision with the majorant and, where the density varies, another one for what it is; where the medium gives
/// light and scatters, one before all of them for the points at which it is asked for, or where the ray has no end, one for each stretch
/// between collisions.
pub(super) fn sample_collision_in<'a>(
    scene: &'a Scene,
    path: &mut PathState<'_>,
    medium: MediumId,
    length: f32,
) -> Option<MediumInteraction<'a>> {
    let stretch = MediumAlongRay::new(scene, medium, &path.wavelengths, path.lanes.hero);
    let is_homogeneous = scene.appearance.media.is_homogeneous(medium);
    let coefficients = scene.appearance.media.coefficients(medium);
    let gives_light = path.mode == Transport::Radiance;
    let emission = coefficients.emission(&path.wavelengths).filter(|_| gives_light);
    let absorption = || path.media.absorption().unwrap_or(Spectrum::BLACK);
    if is_homogeneous && !coefficients.scatters() {
        if let Some(emission) = emission {
            path.emitted += path.beta * emission * emission_integral(stretch.sigma_t + absorption(), length);
        }
        path.beta *= stretch.transmittance_of(length);
        return None;
    }
    let ray = Ray { t_min: 0.0, t_max: length, ..path.ray };
    let is_collected = gives_light && coefficients.emits();
    let u = if is_collected { path.draws.next_1d() } else { 0.0 };
    let on_the_way = |radiance| EmissionAlongRay {
        points: EmissionPoints::along(&stretch, &ray, path.scatterings, |density| density.most, u),
        radiance,
        sigma_a: absorption(),
        found: path.emitted,
    };
    let mut tracking = DeltaTracking {
        stretch: &stretch,
        ray: &ray,
        wavelengths: path.wavelengths,
        is_homogeneous,
        beta: path.beta,
        lanes: path.lanes,
        passed: PassedDensities::default(),
        scattered: None,
        emission: emission.map(on_the_way),
    };
    let arrives = match coefficients.heat() {
        None => walk(&stretch, &ray, &mut path.draws, &mut tracking),
        Some(heat) => {
            tracking.emission = gives_light.then(|| on_the_way(Spectrum::WHITE));
            let mut hot = HotDeltaTracking { tracking, heat };
            let arrives = walk(&stretch, &ray, &mut path.draws, &mut hot);
            tracking = hot.tracking;
            arrives
        }
    };
    let DeltaTracking { beta, lanes, passed, scattered, emission, .. } = tracking;
    let emitted = emission.map(|emission| emission.found);
    let residual = match arrives {
        Some(t) if !is_homogeneous => passed.residual(stretch.sigma_t, t),
        _ => Spectrum::WHITE,
    };
    path.leave_walk(Walked { beta, lanes, emitted, residual, is_scattered: scattered.is_some() }, arrives);
    Some(scattered_at(path, coefficients, &stretch, &ray, scattered?))
}

/// The path's scattering at a distance along its ray.
pub(super) fn scattered_at<'a>(
    path: &mut PathState<'_>,
    coefficients: &'a Coefficients,
    medium: &MediumAlongRay<'_>,
    ray: &Ray,
    at: f32,
) -> MediumInteraction<'a> {
    let p = ray.at(at);
    path.scatter_by_colors(coefficients, medium.source(p, ray.time));
    MediumInteraction {
        p,
        wo: -ray.d,
        phase: coefficients.phase().at(&path.wavelengths),
        length: at,
        time: ray.time,
        is_subsurface: coefficients.is_subsurface(),
    }
}

/// The integral of `exp(-sigma t)` over a length, by lanes.
pub(super) fn emission_integral(sigma: Spectrum, length: f32) -> Spectrum {
    sigma.map(|sigma| {
        let depth = sigma * length;
        // For small depths without the difference of near numbers; what has no end has a depth in each lane that counts.
        let integral =
            if depth > 1e-3 { -fmath::exp_m1(-depth) / sigma } else { length * (1.0 - 0.5 * depth) };
        if integral.is_finite() { integral } else { 0.0 }
    })
}

/// Ratio-tracking estimate of the transmittance of a segment that joins two vertices, and the densities of the lanes
/// `r_u` (by free paths) and `r_l` (by this) [Miller, Georgiev and Jarosz 2019].
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

    /// Goes on through a stretch of a medium by residual ratio tracking [Novák, Selle and Jarosz 2014]: at each collision with
    /// the majorant of what is not known the share `(m - d)/(m - c)` is left. Where the density is the same everywhere, `T` is known.
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
        let stretch = MediumAlongRay::new(scene, medium, wavelengths, hero);
        if scene.appearance.media.is_homogeneous(medium) {
            let t = stretch.transmittance_of(ray.t_max);
            self.t *= t;
            // Paths go through what scatters nothing with the probability 1.
            if scene.appearance.media.coefficients(medium).scatters() {
                self.r_u *= t;
            }
            return;
        }
        let mut tracking =
            RatioTracking { stretch: &stretch, ray, passage: *self, passed: PassedDensities::default() };
        let arrives = walk(&Residual(&stretch), ray, draws, &mut tracking);
        let known = tracking.passed.known(stretch.sigma_t);
        *self = tracking.passage;
        self.arrive(arrives, stretch.hero);
        self.t *= known;
        self.r_u *= known;
    }

    /// Comes to the end of a segment.
    ///
    /// * `arrives`: `T[i]` since the last collision; `None` where nothing comes so far
    #[inline]
    pub(super) fn arrive(&mut self, arrives: Option<Spectrum>, hero: usize) {
        match arrives {
            Some(t) => {
                let ratio = t * (1.0 / t[hero]);
                self.t *= ratio;
                self.r_l *= ratio;
                self.r_u *= ratio;
            }
            None => *self = Passage::closed(),
        }
    }
}

/// Residual ratio tracking of a segment through a medium.
struct RatioTracking<'a> {
    stretch: &'a MediumAlongRay<'a>,
    ray: &'a Ray,
    passage: Passage,
    /// From the start of the segment.
    passed: PassedDensities,
}

impl CollisionVisitor<DensityRange, f32> for RatioTracking<'_> {
    #[inline]
    fn pass(&mut self, _: &mut SampleStream<'_>, from: f32, to: f32, _: f32, density: &DensityRange) {
        self.passed.pass(density, to - from);
    }

    fn collide(&mut self, _: &mut SampleStream<'_>, at: f32, t: Spectrum, density: &DensityRange) -> bool {
        let RatioTracking { stretch, ray, passage, .. } = self;
        let factor = stretch.collision(t, t[stretch.hero]);
        let real = stretch.real_share(ray, at, density.most);
        let share = density.most * (1.0 - real) / density.width();
        passage.t *= factor * share;
        passage.r_l *= factor;
        passage.r_u *= factor * share;
        passage.t.is_black()
    }
}
