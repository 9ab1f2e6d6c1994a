//! Points of a ray in a medium drawn by their angle as a light sees them [Kulla and Fajardo 2012].
//!
//! Light that comes from a small light and is scattered once on a ray is an integral over the ray of a function with a peak `1 / d^2` where the ray
//! passes the light at the distance `D`. Free paths do not depend on that. So for a light `l`, drawn for the ray with
//! the probability `P_r(l)`, a distance is drawn with
//!
//! ```text
//! e(t) = D / ((b - a) (D^2 + (t - s)^2)),    t = s + D tan((1 - u) a + u b)          [Kulla and Fajardo 2012, eq. 4 and 5]
//! ```
//!
//! where `s` is the distance of the point closest to the middle of the light, and `a` and `b` are the angles of the
//! ends of that part of the ray which the light can reach ([`RaySegment`]): of a spot light, that in its cone. At that
//! point light is drawn from `l` as at any other. What is found that way and what is found at collisions, where `l` has
//! the probability `P(l)`, count by the power heuristic of
//!
//! ```text
//! P_r(l) e(t)    against    P(l) mean over lanes of sigma_t T(t)
//! ```
//!
//! both of which are functions of the ray, the distance and the light alone, so that the two weights sum to one. Light
//! that a collision's own direction meets has the weight of the collision.
//!
//! Where the density varies, `T` is not known. Residual ratio tracking to the point draws null collisions that a free path may have too, so
//! that these are a part of what both draw [Miller, Georgiev and Jarosz 2019], and in the place of `sigma_t T` is
//!
//! ```text
//! q sigma_t(t),    q = exp(-sigma_t integral of c) (product over null collisions of (m - d)/(m - c))
//! ```
//!
//! with the density `d` and its bounds `c` and `m`.
//!
//! It is done where one medium is around, for lights so near to a ray that its points do not see them alike, or that reach a part of it alone.

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::LightIndex;
use kajo_core::interaction::SurfacePoint;
use kajo_core::light::{LightSelection, RaySegment, Receiver, SampledLight};
use kajo_core::medium::{Coefficients, MediumId};
use kajo_core::scene::Scene;
use kajo_core::space::Space;
use kajo_math::{Ray, Vec3};

use super::collisions::{MediumAlongRay, scattering_at};
use super::media::through_media;
use super::{Joining, Passage, PathState, all_lanes, connect_through_media, power_heuristic};
use crate::trail::{About, PathObserver, RayKind};

/// A ray in a medium along which a point has been drawn for a light.
#[derive(Clone, Copy, Debug)]
pub struct EquiangularRay {
    /// The part of the ray within the medium.
    segment: RaySegment,
    /// Distance at which that begins.
    start: f32,
    extinction: Extinction,
    wavelengths: Wavelengths,
}

/// What a medium takes away along a ray.
#[derive(Clone, Copy, Debug)]
enum Extinction {
    /// The same everywhere, by lanes.
    Homogeneous(Spectrum),
    /// By the density at each place.
    Heterogeneous {
        /// The probability of having come to the start of the ray from the last vertex without a collision.
        before: f32,
    },
}

/// The collision of a path on a ray along which a point has been drawn for a light too.
#[derive(Clone, Copy, Debug)]
pub struct CollisionOnRay {
    ray: EquiangularRay,
    /// Its distance.
    t: f32,
    /// Density per unit length of a collision there in a heterogeneous medium, `q sigma_t`, the mean over the lanes; 0 in others.
    tracked_pdf: f32,
}

impl EquiangularRay {
    /// The ray that a path is about to follow; `None` where no points are drawn: but in one medium that scatters, and for
    /// lights that have a position.
    ///
    /// * `length`: of the ray to the next surface, perhaps infinite
    pub fn of(scene: &Scene, path: &PathState<'_>, length: f32) -> Option<EquiangularRay> {
        if scene.space() == Space::Curved || !scene.lighting.sampler.has_finite() {
            return None;
        }
        let wavelengths = path.wavelengths;
        let (medium, coefficients) = scattering_medium(scene, path)?;
        let (start, segment, extinction) = if scene.appearance.media.is_homogeneous(medium) {
            let sigma_t = coefficients.sigma_s(&wavelengths) + coefficients.sigma_a(&wavelengths);
            let segment = RaySegment::new(&path.ray, length, all_lanes(sigma_t, &wavelengths));
            (0.0, segment, Extinction::Homogeneous(sigma_t))
        } else {
            let matter = MediumAlongRay::new(scene, medium, &wavelengths, path.lanes.hero);
            let part = within(&matter, &Ray { t_min: 0.0, t_max: length, ..path.ray }, &wavelengths)?;
            let ray = Ray { o: path.ray.at(part.start), ..path.ray };
            let segment =
                RaySegment { is_homogeneous: false, ..RaySegment::new(&ray, part.length, part.extinction) };
            (part.start, segment, Extinction::Heterogeneous { before: path.lanes.arrival(&wavelengths) })
        };
        let ray = EquiangularRay { segment, start, extinction, wavelengths };
        segment.middle().is_finite().then_some(ray)
    }

    /// The point of the segment at a distance from its start.
    fn receiver(&self, t: f32) -> Receiver {
        let RaySegment { o, d, time, .. } = self.segment;
        Receiver { p: o + t * d, n: Vec3::ZERO, time }
    }

    /// Density of a collision per unit length in a medium that is the same everywhere.
    fn pdf_in_homogeneous(&self, sigma_t: Spectrum, t: f32) -> f32 {
        all_lanes(sigma_t * (sigma_t * -t).exp(), &self.wavelengths)
    }

    /// The collision of a path that has followed the ray.
    ///
    /// * `length`: distance from the start of the ray
    /// * `path`: behind the collision, before it goes on
    pub fn collision(&self, length: f32, path: &PathState<'_>) -> CollisionOnRay {
        let tracked_pdf = match self.extinction {
            Extinction::Homogeneous(_) => 0.0,
            Extinction::Heterogeneous { before } => path.lanes.reach * path.lanes.sigma_t / before,
        };
        CollisionOnRay { ray: *self, t: length - self.start, tracked_pdf }
    }

    /// Goes to a point of the segment without a collision.
    ///
    /// * `start`: the path at the start of the ray
    /// * `path`: the same path now, whose random numbers are taken where the density varies
    /// * `t`: distance from the start of the segment
    fn reach<'s>(
        &self,
        scene: &Scene,
        start: &PathState<'s>,
        path: &mut PathState<'s>,
        t: f32,
    ) -> Option<Reached> {
        let (wavelengths, lanes) = (&start.wavelengths, &start.lanes);
        let (medium, coefficients) = scattering_medium(scene, start)?;
        let before = match self.extinction {
            Extinction::Homogeneous(sigma_t) => {
                let left = start.media.transmittance(t) * (sigma_t * -t).exp();
                let pdf = self.pdf_in_homogeneous(sigma_t, t);
                let sigma_s = coefficients.sigma_s(wavelengths);
                return Some(Reached { left, sigma_s, r_l: lanes.r_u, pdf });
            }
            Extinction::Heterogeneous { before } => before,
        };
        let matter = MediumAlongRay::new(scene, medium, wavelengths, lanes.hero);
        let ray = Ray { t_min: 0.0, t_max: self.start + t, ..start.ray };
        let mut with = Joining { wavelengths, hero: lanes.hero, r_u: lanes.r_u, draws: &mut path.draws };
        let mut passage = Passage::open(lanes.r_u);
        through_media(scene, &ray, &start.media, &mut with, &mut passage);
        let passed = lanes.r_u.safe_div(lanes.r_l) * passage.r_u.safe_div(passage.r_l);
        let p = matter.source(ray.at(ray.t_max), ray.time);
        let density = matter.spectral_density(p, wavelengths);
        let sigma_s = scattering_at(coefficients, density, p, wavelengths);
        let pdf = all_lanes(passed, wavelengths) / before * all_lanes(matter.sigma_t * density, wavelengths);
        (!passage.t.is_black()).then_some(Reached { left: passage.t, sigma_s, r_l: passage.r_l, pdf })
    }

    /// A light, and what it adds to the path at a point drawn along the ray: `w beta T sigma_s p Li / (P_r e q)`.
    ///
    /// * `start`: the path at the start of the ray
    /// * `path`: the same path now, whose random numbers are taken: four, and what a connection takes
    pub fn sample<'s>(
        &self,
        scene: &Scene,
        start: &PathState<'s>,
        path: &mut PathState<'s>,
        by: LightSelection<'_>,
        observer: &mut impl PathObserver,
    ) -> Option<(LightIndex, Spectrum)> {
        let (u, v) = (path.draws.next_2d(), path.draws.next_2d());
        let chosen = scene.lighting.sampler.sample_along(&self.segment, u.x, by)?;
        let SampledLight { light, .. } = chosen;
        let span = scene.lighting.sampler.seen_from(light, &self.segment)?;
        let t = span.sample(v.x);
        if !(0.0..self.segment.length).contains(&t) {
            return None;
        }
        let receiver = self.receiver(t);
        let li = scene.sample_li(light, &receiver, chosen.pair(u), &start.wavelengths, by)?;
        let drawn = chosen.probability * span.pdf(t);
        let Reached { left, sigma_s, r_l, pdf } = self.reach(scene, start, path, t)?;
        let collided = pdf * scene.lighting.sampler.pmf(light, &receiver, by);
        let (_, coefficients) = scattering_medium(scene, start)?;
        let scattered = coefficients.phase().at(&start.wavelengths).eval(-self.segment.d, li.wi).value();
        let carried = start.beta * left * sigma_s * scattered;
        if drawn <= 0.0 || li.radiance.is_black() || carried.is_black() {
            return None;
        }
        let segment =
            SurfacePoint { p: receiver.p, ..SurfacePoint::default() }.ray_to(&li.at, li.wi, receiver.time);
        let with = Joining {
            wavelengths: &start.wavelengths,
            hero: start.lanes.hero,
            r_u: r_l,
            draws: &mut path.draws,
        };
        let passage = connect_through_media(scene, &segment, start.media, with, observer);
        observer.light_drawn(&receiver, light, || !passage.t.is_black());
        let by_light = start.mean(passage.r_l);
        let weight = power_heuristic(drawn, collided);
        let added = carried * li.radiance * passage.t * (weight / (drawn * li.pdf * by_light));
        let added = if added.is_finite() { added } else { Spectrum::BLACK };
        let about = || About {
            eta: start.media.eta(),
            weight: sensor::to_rgb(carried, &start.wavelengths),
            light: Some(scene.lighting.sampler.id(light)),
        };
        observer
            .joined(RayKind::Shadow, scene, &segment, about, || sensor::to_rgb(added, &start.wavelengths));
        Some((light, added))
    }
}

/// A point of a ray that is gone to without a collision.
struct Reached {
    /// The share of light that is left, times the density of what was drawn on the way with the path's hero.
    left: Spectrum,
    /// Scattering per unit length there, by lanes.
    sigma_s: Spectrum,
    /// Densities of the path and of what was drawn, by lanes, over that.
    r_l: Spectrum,
    /// Density per unit length of a collision there, the mean over the lanes.
    pdf: f32,
}

impl CollisionOnRay {
    /// The weight of light found at the collision.
    pub fn weight(&self, scene: &Scene, light: LightIndex, by: LightSelection<'_>) -> f32 {
        let CollisionOnRay { ray, t, tracked_pdf } = self;
        let sampler = &scene.lighting.sampler;
        let of_distance = sampler.seen_from(light, &ray.segment).map_or(0.0, |span| span.pdf(*t));
        if of_distance == 0.0 {
            return 1.0;
        }
        let drawn = of_distance * sampler.pmf_along(light, &ray.segment, by);
        if drawn <= 0.0 {
            return 1.0;
        }
        let pdf = match ray.extinction {
            Extinction::Homogeneous(sigma_t) => ray.pdf_in_homogeneous(sigma_t, *t),
            Extinction::Heterogeneous { .. } => *tracked_pdf,
        };
        power_heuristic(pdf * sampler.pmf(light, &ray.receiver(*t), by), drawn)
    }
}

/// The part of a ray that is within a medium.
struct PartWithin {
    start: f32,
    /// Perhaps infinite.
    length: f32,
    /// The mean extinction of its majorants.
    extinction: f32,
}

/// * `ray`: of unit direction
fn within(matter: &MediumAlongRay<'_>, ray: &Ray, wavelengths: &Wavelengths) -> Option<PartWithin> {
    let (mut part, mut depth): (Option<[f32; 2]>, f32) = (None, 0.0);
    for span in matter.majorants(ray).filter(|span| span.density > 0.0) {
        let [start, _] = part.unwrap_or([span.t_min; 2]);
        part = Some([start, span.t_max]);
        depth += span.density * (span.t_max - span.t_min);
    }
    let [start, end] = part?;
    let length = end - start;
    let density = depth / length;
    let extinction = all_lanes(matter.sigma_t, wavelengths) * density;
    (length > 0.0 && density.is_finite()).then_some(PartWithin { start, length, extinction })
}

/// The medium that scatters light and is alone around a path; of several media each has a phase function of its own.
fn scattering_medium<'a>(scene: &'a Scene, path: &PathState<'_>) -> Option<(MediumId, &'a Coefficients)> {
    let medium = path.media.medium().filter(|_| !path.media.overlaps())?;
    let coefficients = scene.appearance.media.coefficients(medium);
    coefficients.scatters().then_some((medium, coefficients))
}

/// The same where it is homogeneous.
pub fn homogeneous_medium<'a>(scene: &'a Scene, path: &PathState<'_>) -> Option<&'a Coefficients> {
    let (medium, coefficients) = scattering_medium(scene, path)?;
    scene.appearance.media.is_homogeneous(medium).then_some(coefficients)
}
