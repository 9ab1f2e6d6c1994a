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
//! It is done in homogeneous media, for lights so near to a ray that its points do not see them alike, or that reach a part of it alone.

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::LightIndex;
use kajo_core::interaction::SurfacePoint;
use kajo_core::light::{LightSelection, RaySegment, Receiver, SampledLight};
use kajo_core::medium::Coefficients;
use kajo_core::scene::Scene;
use kajo_core::space::Space;
use kajo_math::Vec3;

use super::{Joining, PathState, all_lanes, connect_through_media, power_heuristic};
use crate::trail::{About, PathObserver, RayKind};

/// A ray in a homogeneous medium along which a point has been drawn for a light.
#[derive(Clone, Copy, Debug)]
pub struct EquiangularRay {
    segment: RaySegment,
    /// Extinction by lanes.
    sigma_t: Spectrum,
    wavelengths: Wavelengths,
}

impl EquiangularRay {
    /// The ray that a path is about to follow; `None` where no points are drawn: but in one homogeneous medium that
    /// scatters, and for lights that have a position.
    ///
    /// * `length`: of the ray to the next surface, perhaps infinite
    pub fn of(scene: &Scene, path: &PathState<'_>, length: f32) -> Option<EquiangularRay> {
        if scene.space() == Space::Curved || !scene.lighting.sampler.has_finite() {
            return None;
        }
        let coefficients = scattering_medium(scene, path)?;
        let sigma_t = coefficients.sigma_s(&path.wavelengths) + coefficients.sigma_a(&path.wavelengths);
        let segment = RaySegment::new(&path.ray, length, all_lanes(sigma_t, &path.wavelengths));
        let ray = EquiangularRay { segment, sigma_t, wavelengths: path.wavelengths };
        segment.middle().is_finite().then_some(ray)
    }

    /// The point of the ray at a distance.
    fn receiver(&self, t: f32) -> Receiver {
        let RaySegment { o, d, time, .. } = self.segment;
        Receiver { p: o + t * d, n: Vec3::ZERO, time }
    }

    /// Density of a collision at a distance and of drawing a light there.
    fn pdf_of_collision(&self, scene: &Scene, light: LightIndex, t: f32, by: LightSelection<'_>) -> f32 {
        let collision = all_lanes(self.sigma_t * (self.sigma_t * -t).exp(), &self.wavelengths);
        collision * scene.lighting.sampler.pmf(light, &self.receiver(t), by)
    }

    /// The weight of light found at a collision.
    ///
    /// * `t`: distance of the collision
    pub fn weight_of_collision(
        &self,
        scene: &Scene,
        light: LightIndex,
        t: f32,
        by: LightSelection<'_>,
    ) -> f32 {
        let sampler = &scene.lighting.sampler;
        let of_distance = sampler.seen_from(light, &self.segment).map_or(0.0, |span| span.pdf(t));
        if of_distance == 0.0 {
            return 1.0;
        }
        let drawn = of_distance * sampler.pmf_along(light, &self.segment, by);
        if drawn > 0.0 { power_heuristic(self.pdf_of_collision(scene, light, t, by), drawn) } else { 1.0 }
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
        let li = scene.sample_li(light, &receiver, chosen.pair(u), &start.wavelengths)?;
        let drawn = chosen.probability * span.pdf(t);
        let collided = self.pdf_of_collision(scene, light, t, by);
        let coefficients = scattering_medium(scene, start)?;
        let scattered = coefficients.phase().at(&start.wavelengths).eval(-self.segment.d, li.wi).value();
        let absorbed = start.media.transmittance(t) * (self.sigma_t * -t).exp();
        let carried = start.beta * absorbed * coefficients.sigma_s(&start.wavelengths) * scattered;
        if drawn <= 0.0 || li.radiance.is_black() || carried.is_black() {
            return None;
        }
        let segment =
            SurfacePoint { p: receiver.p, ..SurfacePoint::default() }.ray_to(&li.at, li.wi, receiver.time);
        let with = Joining {
            wavelengths: &start.wavelengths,
            hero: start.lanes.hero,
            r_u: start.lanes.r_u,
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

/// The homogeneous medium that scatters light and is alone around a path; of several media each has a phase function of its own.
pub fn scattering_medium<'a>(scene: &'a Scene, path: &PathState<'_>) -> Option<&'a Coefficients> {
    let medium = path.media.medium().filter(|_| !path.media.overlaps())?;
    let media = &scene.appearance.media;
    Some(media.coefficients(medium))
        .filter(|coefficients| media.is_homogeneous(medium) && coefficients.scatters())
}
