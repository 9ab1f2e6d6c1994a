//! Overlapping participating media: coefficients add, and collisions are sampled in their sum. And media whose density has a colour, one or
//! several.
//!
//! Coefficients add, `sigma[i] = sum over k of sigma_k[i] d_k[i]` with the densities `d_k`, which are the same in all lanes `i` or not, and so
//! do majorants. Null collisions are drawn as in one medium, but the share of real ones depends on the lane. With the majorant
//! `m[i] = sum of sigma_t,k[i] m_k`, the extinction `r[i] = sum of sigma_t,k[i] d_k[i]` and the rest `n[i] = m[i] - r[i]`
//! [Miller, Georgiev and Jarosz 2019]
//!
//! ```text
//!                   beta *=                                             r_u *=                                    r_l *=
//! scattered by k    T[i] sigma_s,k[i] d_k[i] / (T[h] r[h] P[h](k))      T[i] r[i] P[i](k) / (T[h] r[h] P[h](k))   = r_u
//! null collision    T[i] n[i] / (T[h] n[h])                             the same                                  T[i] m[i] / (T[h] n[h])
//! arrives           T[i] / T[h]                                         the same                                  the same
//! ```
//!
//! Media that absorb and do nothing else, everywhere the same, are a factor `exp(-sigma_a s)` and no part of this.
//!
//! Which medium scatters is chosen in proportion to its scattering there, of the hero,
//! `P[i](k) = sigma_s,k[i] d_k[i] / sum over j of sigma_s,j[i] d_j[i]`. Each lane would choose otherwise, so this counts among the densities of
//! all lanes, or colours would be noisier with each scattering. A vertex has the phase function of one medium. The probability is the same for
//! paths from both ends, so it cancels in the MIS weights.

use std::array;

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::bsdf::Transport;
use kajo_core::medium::{Coefficients, Majorant, Majorants, MaybeMedium, MediumId};
use kajo_core::sampler::SampleStream;
use kajo_core::scene::Scene;
use kajo_math::{Ray, Vec3};

use super::collisions::{self, MediumAlongRay, MediumInteraction, Passage, Walked, emission_integral};
use super::emission_points::EmissionPoints;
use super::lane_mis::all_lanes;
use super::medium_stack::{MOST_MEDIA, MediumStack};
use super::null_collisions::{CollisionVisitor, NullCollisionMedium, Span, walk};
use super::{LaneMis, PathState};
use crate::trail::{About, PathObserver};

/// A number for each of the media.
type Densities = [f32; MOST_MEDIA];

/// The densities of each of the media by lanes.
type DensitiesByLanes = [Spectrum; MOST_MEDIA];

/// Several media along a ray, at the wavelengths of a path.
struct Overlap<'a> {
    /// Absorption per unit length of those that do nothing else, everywhere the same. It is a factor of all light, and no events are drawn of it.
    absorption: Spectrum,
    /// The others.
    parts: [Option<Part<'a>>; MOST_MEDIA],
    /// Extinction of all together at the density 1.
    sigma_t: Spectrum,
    is_homogeneous: bool,
    emits: bool,
    wavelengths: Wavelengths,
    hero: usize,
}

/// One of several media.
struct Part<'a> {
    stretch: MediumAlongRay<'a>,
    coefficients: &'a Coefficients,
}

impl Part<'_> {
    fn density(&self, p: Vec3, time: f32) -> f32 {
        self.stretch.density(self.stretch.source(p, time))
    }
}

/// Majorants of all media on a span of the ray.
#[derive(Clone, Copy)]
struct Most {
    densities: Densities,
    /// `m`.
    sigma: Spectrum,
}

/// Coefficients of all media together at a point.
struct SummedCoefficients {
    densities: DensitiesByLanes,
    /// `r`.
    real: Spectrum,
    /// `n`.
    null: Spectrum,
}

impl<'a> Overlap<'a> {
    fn new(scene: &'a Scene, media: &MediumStack, wavelengths: &Wavelengths, hero: u32) -> Overlap<'a> {
        let all = &scene.appearance.media;
        let mut absorption = Spectrum::BLACK;
        let part = |medium: MaybeMedium| {
            // What bends light does nothing else to it.
            let medium = medium.get().filter(|&medium| !all.bends_light(medium))?;
            let stretch = MediumAlongRay::new(scene, medium, wavelengths, hero);
            let coefficients = all.coefficients(medium);
            let acts_at_places = coefficients.scatters() || coefficients.emits();
            if !acts_at_places && (all.is_homogeneous(medium) || stretch.sigma_t.is_black()) {
                absorption += stretch.sigma_t;
                return None;
            }
            Some(Part { stretch, coefficients })
        };
        let parts = media.each_medium().map(part);
        Overlap {
            absorption,
            sigma_t: parts.iter().flatten().fold(Spectrum::BLACK, |sum, part| sum + part.stretch.sigma_t),
            is_homogeneous: parts.iter().flatten().all(|part| all.is_homogeneous(part.stretch.medium)),
            emits: parts.iter().flatten().any(|part| part.coefficients.emits()),
            wavelengths: *wavelengths,
            hero: hero as usize,
            parts,
        }
    }

    fn scatters(&self) -> bool {
        self.parts.iter().flatten().any(|part| part.coefficients.scatters())
    }

    /// `sum of sigma_t,k d_k`.
    fn extinction(&self, densities: &DensitiesByLanes) -> Spectrum {
        self.parts.iter().zip(densities).fold(Spectrum::BLACK, |sum, (part, &density)| match part {
            Some(part) => sum + part.stretch.sigma_t * density,
            None => sum,
        })
    }

    /// * `time`: moment within the shutter interval
    fn densities(&self, p: Vec3, time: f32) -> Densities {
        if self.is_homogeneous {
            return [1.0; MOST_MEDIA];
        }
        self.parts.each_ref().map(|part| part.as_ref().map_or(0.0, |part| part.density(p, time)))
    }

    /// * `time`: moment within the shutter interval
    fn at(&self, p: Vec3, time: f32, most: &Most) -> SummedCoefficients {
        let most = &most.densities;
        let densities: DensitiesByLanes = match self.is_homogeneous {
            true => [Spectrum::WHITE; MOST_MEDIA],
            false => array::from_fn(|k| {
                let part = self.parts[k].as_ref();
                let density_of = |Part { stretch, .. }: &Part<'_>| {
                    stretch.spectral_density(stretch.source(p, time), &self.wavelengths)
                };
                let found = part.map(density_of);
                found.map_or(Spectrum::BLACK, |density| density.map(|density| density.min(most[k])))
            }),
        };
        let rest = array::from_fn(|k| Spectrum::grey(most[k]) - densities[k]);
        SummedCoefficients { densities, real: self.extinction(&densities), null: self.extinction(&rest) }
    }

    /// The sum of the majorants of those that emit.
    fn most_emissive(&self, most: &Most) -> f32 {
        let each = self.parts.iter().zip(most.densities);
        each.filter(|(part, _)| part.as_ref().is_some_and(|part| part.coefficients.emits()))
            .map(|(_, density)| density)
            .sum()
    }

    /// Radiance per unit length that all of them give at a point.
    ///
    /// * `time`: moment within the shutter interval
    fn emission(&self, p: Vec3, time: f32, densities: &Densities) -> Spectrum {
        let wavelengths = &self.wavelengths;
        let each = self.parts.iter().zip(densities).filter(|&(_, &density)| density > 0.0);
        each.fold(Spectrum::BLACK, |sum, (part, &density)| {
            let Some(Part { stretch, coefficients }) = part else { return sum };
            let emission = coefficients.emission_at(stretch.source(p, time), wavelengths);
            emission.map_or(sum, |emission| sum + emission * density)
        })
    }

    /// The medium that scatters; `None` where none does.
    ///
    /// * `u`: uniform in [0, 1)
    fn choose(&self, densities: &DensitiesByLanes, u: f32) -> Option<Choice> {
        let wavelengths = &self.wavelengths;
        let each: [Spectrum; MOST_MEDIA] = array::from_fn(|k| {
            self.parts[k].as_ref().map_or(Spectrum::BLACK, |part| part.stretch.sigma_s * densities[k])
        });
        let sum = each.iter().fold(Spectrum::BLACK, |sum, &sigma_s| sum + sigma_s);
        let mean = all_lanes(sum, wavelengths);
        // Lanes that nothing scatters would choose by the means of all.
        let scatters = sum.map(|sigma_s| if sigma_s > 0.0 { 1.0 } else { 0.0 });
        let probability = |sigma_s: Spectrum| {
            let by_mean = Spectrum::grey(all_lanes(sigma_s, wavelengths) / mean);
            sigma_s.safe_div(sum) + by_mean * (Spectrum::WHITE - scatters)
        };
        if mean <= 0.0 || !mean.is_finite() {
            return None;
        }
        let mut left = u;
        let mut chosen = None;
        for (k, &sigma_s) in each.iter().enumerate() {
            let probability = probability(sigma_s);
            let share = probability[self.hero];
            if share <= 0.0 {
                continue;
            }
            chosen = Some(Choice { k, sigma_s: sigma_s * (1.0 / share), ratio: probability * (1.0 / share) });
            if left < share {
                break;
            }
            left -= share;
        }
        chosen
    }
}

/// The medium that scatters.
struct Choice {
    k: usize,
    /// Its scattering per unit length over the hero's probability to choose it.
    sigma_s: Spectrum,
    /// The probabilities of all lanes over the hero's.
    ratio: Spectrum,
}

impl NullCollisionMedium for Overlap<'_> {
    type Most = Most;
    type Depth = Spectrum;

    fn spans(&self, ray: &Ray) -> impl Iterator<Item = Span<Most>> {
        let walks = self.parts.each_ref().map(|part| part.as_ref().map(|part| part.stretch.majorants(ray)));
        let merged = Merged { walks: walks.map(|walk| walk.map(Peeked::new)), at: 0.0 };
        merged.map(|Span { t_min, t_max, most }| {
            let most = Most { densities: most, sigma: self.extinction(&most.map(Spectrum::grey)) };
            Span { t_min, t_max, most }
        })
    }

    fn is_void(&self, most: &Most) -> bool {
        most.sigma.is_black() && !(self.emits && most.densities.iter().any(|&density| density > 0.0))
    }

    fn hero_extinction(&self, most: &Most) -> f32 {
        most.sigma[self.hero]
    }

    fn depth(&self, most: &Most, length: f32) -> Spectrum {
        most.sigma * length.min(f32::MAX)
    }

    fn transmittance(&self, depth: Spectrum) -> Spectrum {
        (depth * -1.0).exp()
    }
}

/// `T[i]` over a length.
fn transmittance(sigma: Spectrum, length: f32) -> Spectrum {
    // As for one medium: 0 times infinity would be no number.
    (sigma * -length.min(f32::MAX)).exp()
}

/// The spans of a ray on which the majorants of all media are constant.
struct Merged<'a> {
    walks: [Option<Peeked<'a>>; MOST_MEDIA],
    at: f32,
}

/// The intervals of one majorant, with the current one.
struct Peeked<'a> {
    next: Option<Majorant>,
    rest: Majorants<'a>,
}

impl<'a> Peeked<'a> {
    fn new(mut rest: Majorants<'a>) -> Peeked<'a> {
        Peeked { next: rest.next(), rest }
    }

    /// The stretch that ends behind a distance, if there is one.
    fn behind(&mut self, at: f32) -> Option<Majorant> {
        while self.next.is_some_and(|next| next.t_max <= at) {
            self.next = self.rest.next();
        }
        self.next
    }
}

impl Iterator for Merged<'_> {
    type Item = Span<Densities>;

    fn next(&mut self) -> Option<Span<Densities>> {
        let from = self.at;
        let mut to = f32::NAN;
        let mut most = [0.0; MOST_MEDIA];
        for (walk, most) in self.walks.iter_mut().zip(&mut most) {
            let Some(next) = walk.as_mut().and_then(|walk| walk.behind(from)) else { continue };
            let end = if next.t_min > from {
                next.t_min
            } else {
                *most = next.density;
                next.t_max
            };
            to = to.min(end);
        }
        self.at = to;
        (to > from).then_some(Span { t_min: from, t_max: to, most })
    }
}

/// Delta tracking of a path through several media.
struct OverlapDeltaTracking<'a> {
    all: &'a Overlap<'a>,
    ray: &'a Ray,
    beta: Spectrum,
    lanes: LaneMis,
    /// Where it is scattered, and by which medium.
    scattered: Option<(f32, usize)>,
    /// Light that they gave so far, where that counts.
    emitted: Option<Spectrum>,
    /// Where that is asked for; where there are none, at one point of each stretch without a collision.
    points: Option<EmissionPoints>,
    /// What absorbs this light besides the media.
    sigma_a: Spectrum,
}

impl CollisionVisitor<Most, Spectrum> for OverlapDeltaTracking<'_> {
    /// As in one medium: the light given along a stretch without collisions, at some points of it.
    fn pass(&mut self, draws: &mut SampleStream<'_>, from: f32, to: f32, depth: Spectrum, most: &Most) {
        let Some(emitted) = &mut self.emitted else { return };
        let mut add = |at: f32, length: f32| {
            let p = self.ray.at(at);
            let t = self.all.transmittance(depth + self.all.depth(most, at - from));
            let ratio = t * (1.0 / t[self.all.hero]);
            let mean = self.all.wavelengths.mean(self.lanes.r_u * ratio);
            let time = self.ray.time;
            let radiance = self.all.emission(p, time, &self.all.densities(p, time));
            let added = self.beta * ratio * radiance * (self.sigma_a * -at).exp() * (length / mean);
            if added.is_finite() {
                *emitted += added;
            }
        };
        let Some(points) = &mut self.points else {
            return add(from + draws.next_1d() * (to - from), to - from);
        };
        let majorant = self.all.most_emissive(most);
        while let Some((at, length)) = points.next_in(from, to, majorant) {
            add(at, length);
        }
        points.pass(from, to, majorant);
    }

    fn collide(&mut self, draws: &mut SampleStream<'_>, at: f32, t: Spectrum, most: &Most) -> bool {
        let hero = self.all.hero;
        let is_homogeneous = self.all.is_homogeneous;
        let SummedCoefficients { densities, real, null } = self.all.at(self.ray.at(at), self.ray.time, most);
        let lanes = &mut self.lanes;
        let is_real = is_homogeneous || draws.next_1d() * most.sigma[hero] < real[hero] || null[hero] <= 0.0;
        if !is_real {
            // Second row [Miller, Georgiev and Jarosz 2019]; ratio tracking passes with the probability 1.
            let by = 1.0 / (t[hero] * null[hero]);
            self.beta *= t * null * by;
            lanes.r_u *= t * null * by;
            lanes.r_l *= t * most.sigma * by;
            return false;
        }
        // First row, of which the choice of the medium is multiplied below.
        let by = 1.0 / (t[hero] * real[hero]);
        let passed = if is_homogeneous { t } else { Spectrum::WHITE };
        lanes.reach = all_lanes(passed * lanes.r_u.safe_div(lanes.r_l), &self.all.wavelengths);
        lanes.sigma_t = all_lanes(real, &self.all.wavelengths);
        lanes.r_u *= t * real * by;
        if let Some(Choice { k, sigma_s, ratio }) = self.all.choose(&densities, draws.next_1d()) {
            self.beta *= t * sigma_s * by;
            lanes.r_u *= ratio;
            self.scattered = Some((at, k));
        }
        lanes.r_l = lanes.r_u;
        true
    }
}

impl MediumStack {
    /// Whether collisions are those of [`Overlap`]: several media are around, or one whose density has a colour.
    #[inline]
    pub(super) fn differs_by_lanes(&self, scene: &Scene) -> bool {
        let has_color = |medium: MediumId| scene.appearance.media.has_colored_density(medium);
        self.overlaps() || self.medium().is_some_and(has_color)
    }
}

/// Samples a free path through the medium around a path, or all of them, at most `length`; returns the collision that scatters it, if there is one.
///
/// Takes numbers as in one medium, and one more where several are or its density has a colour: it chooses which of them scatters.
#[cold]
#[inline(never)]
pub fn sample_collision<'a>(
    scene: &'a Scene,
    path: &mut PathState<'_>,
    length: f32,
    observer: &mut impl PathObserver,
) -> Option<MediumInteraction<'a>> {
    let at = if path.media.differs_by_lanes(scene) {
        path.extent = length;
        sample_collision_in_all(scene, path, length)?
    } else {
        let medium = path.media.medium()?;
        path.extent = length;
        collisions::sample_collision_in(scene, path, medium, length)?
    };
    path.beta *= path.media.transmittance(at.length);
    let ray = Ray { t_max: at.length, ..path.ray };
    observer.ended(scene, &ray, None, || About {
        eta: path.media.eta(),
        weight: sensor::to_rgb(path.beta, &path.wavelengths),
        light: None,
    });
    Some(at)
}

/// The same through all media around the path.
///
/// Takes numbers as in one medium, and one more that chooses which of them scatters.
fn sample_collision_in_all<'a>(
    scene: &'a Scene,
    path: &mut PathState<'_>,
    length: f32,
) -> Option<MediumInteraction<'a>> {
    let all = Overlap::new(scene, &path.media, &path.wavelengths, path.lanes.hero);
    let gives_light = path.mode == Transport::Radiance && all.emits;
    let sigma_a = path.media.absorption().unwrap_or(Spectrum::BLACK) + all.absorption;
    let ray = Ray { t_min: 0.0, t_max: length, ..path.ray };
    if all.is_homogeneous && !all.scatters() {
        if gives_light {
            let radiance = all.emission(ray.o, ray.time, &[1.0; MOST_MEDIA]);
            path.emitted += path.beta * radiance * emission_integral(all.sigma_t + sigma_a, length);
        }
        path.beta *= transmittance(all.sigma_t + all.absorption, length);
        return None;
    }
    let points = if gives_light {
        let u = path.draws.next_1d();
        EmissionPoints::along(&all, &ray, path.scatterings, |most| all.most_emissive(most), u)
    } else {
        None
    };
    let mut tracking = OverlapDeltaTracking {
        all: &all,
        ray: &ray,
        beta: path.beta,
        lanes: path.lanes,
        scattered: None,
        emitted: gives_light.then_some(path.emitted),
        points,
        sigma_a,
    };
    let arrives = walk(&all, &ray, &mut path.draws, &mut tracking);
    let OverlapDeltaTracking { beta, lanes, scattered, emitted, .. } = tracking;
    // Where nothing varies connections know what is left; elsewhere they draw all collisions.
    let residual = arrives.filter(|_| !all.is_homogeneous).unwrap_or(Spectrum::WHITE);
    path.leave_walk(Walked { beta, lanes, emitted, residual, is_scattered: scattered.is_some() }, arrives);
    path.beta *= transmittance(all.absorption, scattered.map_or(length, |(at, _)| at));
    let (at, k) = scattered?;
    let Part { stretch, coefficients } = all.parts[k].as_ref()?;
    Some(collisions::scattered_at(path, coefficients, stretch, &ray, at))
}

impl Passage {
    /// Goes on through a stretch of all media of a stack, as [`Passage::through`] one of them.
    ///
    /// * `ray`: of unit direction, from its start to `t_max`
    pub(super) fn through_all(
        &mut self,
        scene: &Scene,
        media: &MediumStack,
        ray: &Ray,
        wavelengths: &Wavelengths,
        hero: u32,
        draws: &mut SampleStream<'_>,
    ) {
        let all = Overlap::new(scene, media, wavelengths, hero);
        self.t *= transmittance(all.absorption, ray.t_max);
        if all.is_homogeneous {
            let t = transmittance(all.sigma_t, ray.t_max);
            self.t *= t;
            // Paths go through what scatters nothing with the probability 1.
            if all.scatters() {
                self.r_u *= t;
            }
            return;
        }
        let mut tracking = OverlapRatioTracking { all: &all, ray, passage: *self };
        let arrives = walk(&all, ray, draws, &mut tracking);
        *self = tracking.passage;
        self.arrive(arrives, all.hero);
    }
}

/// Ratio tracking of a segment through several media.
struct OverlapRatioTracking<'a> {
    all: &'a Overlap<'a>,
    ray: &'a Ray,
    passage: Passage,
}

impl CollisionVisitor<Most, Spectrum> for OverlapRatioTracking<'_> {
    fn collide(&mut self, _draws: &mut SampleStream<'_>, at: f32, t: Spectrum, most: &Most) -> bool {
        let SummedCoefficients { null, .. } = self.all.at(self.ray.at(at), self.ray.time, most);
        let hero = t[self.all.hero] * most.sigma[self.all.hero];
        let by = if hero > 0.0 { 1.0 / hero } else { 0.0 };
        let Passage { t: left, r_l, r_u } = &mut self.passage;
        *left *= t * null * by;
        *r_l *= t * most.sigma * by;
        *r_u *= t * null * by;
        left.is_black()
    }
}
