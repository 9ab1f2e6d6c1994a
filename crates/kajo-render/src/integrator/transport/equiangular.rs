//! Points of a ray in a medium drawn by their angle as a light sees them [Kulla and Fajardo 2012].
//!
//! Light that comes from a small light and is scattered once on a ray is an integral over the ray of a function with a peak `1 / d^2` where the ray
//! passes the light at the distance `D`. Free paths do not depend on that. So for a light `l`, drawn for the ray with the probability `P_r(l)`, a distance is drawn with
//!
//! ```text
//! e(t) = D / ((b - a) (D^2 + (t - s)^2)),    t = s + D tan((1 - u) a + u b)          [Kulla and Fajardo 2012, eq. 4 and 5]
//! ```
//!
//! where `s` is the distance of the point closest to the middle of the light, and `a` and `b` are the angles of the ray's ends. At that point light
//! is drawn from `l` as at any other. What is found that way and what is found at collisions, where `l` has the probability `P(l)`, count by the power
//! heuristic of
//!
//! ```text
//! P_r(l) e(t)    against    P(l) mean over lanes of sigma_t T(t)
//! ```
//!
//! both of which are functions of the ray, the distance and the light alone, so that the two weights sum to one. Light that a collision's own direction
//! meets has the weight of the collision.
//!
//! It is done in homogeneous media, on rays that have been scattered once at most: farther on light comes from everywhere.

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::LightIndex;
use kajo_core::interaction::SurfacePoint;
use kajo_core::light::{LightSelection, Receiver, SampledLight};
use kajo_core::medium::Coefficients;
use kajo_core::scene::Scene;
use kajo_core::space::Space;
use kajo_math::{Ray, Vec3, fmath};

use super::{Joining, PathState, all_lanes, connect_through_media, power_heuristic};
use crate::trail::{About, PathObserver, RayKind};

/// Scatterings of a path after which no points are drawn along its rays.
const MOST_SCATTERINGS: u32 = 1;

/// A ray in a homogeneous medium along which a point has been drawn for a light.
#[derive(Clone, Copy, Debug)]
pub struct EquiangularRay {
    o: Vec3,
    d: Vec3,
    /// To the next surface, perhaps infinite.
    length: f32,
    /// Extinction by lanes.
    sigma_t: Spectrum,
    wavelengths: Wavelengths,
    /// For which a light is chosen.
    receiver: Receiver,
}

/// How distances along a ray are drawn for a light.
struct Equiangular {
    /// Distance of the closest point, and how far the light is from that.
    closest: f32,
    distance: f32,
    /// Angles of the ray's ends.
    ends: [f32; 2],
}

impl EquiangularRay {
    /// The ray that a path is about to follow; `None` where no points are drawn: but in one homogeneous medium that scatters.
    ///
    /// * `length`: of the ray to the next surface, perhaps infinite
    pub fn of(scene: &Scene, path: &PathState<'_>, length: f32) -> Option<EquiangularRay> {
        if path.scatterings > MOST_SCATTERINGS || scene.space() == Space::Curved {
            return None;
        }
        let coefficients = scattering_medium(scene, path)?;
        let sigma_t = coefficients.sigma_s(&path.wavelengths) + coefficients.sigma_a(&path.wavelengths);
        Some(EquiangularRay::new(path, sigma_t, length)).filter(|ray| ray.receiver.p.is_finite())
    }

    /// * `path`: before it follows its ray
    /// * `length`: of the ray
    fn new(path: &PathState<'_>, sigma_t: Spectrum, length: f32) -> EquiangularRay {
        let Ray { o, d, time, .. } = path.ray;
        let free = 1.0 / all_lanes(sigma_t, &path.wavelengths);
        let p = o + d * (0.5 * length).min(free);
        let receiver = Receiver { p, n: Vec3::ZERO, time };
        EquiangularRay { o, d, length, sigma_t, wavelengths: path.wavelengths, receiver }
    }

    /// How distances are drawn for a light; `None` for one that is infinitely far away.
    fn towards(&self, scene: &Scene, light: LightIndex) -> Option<Equiangular> {
        let bounds = scene.lighting.lights.bounds(scene.lighting.sampler.id(light))?.bounds;
        let (middle, radius) = (bounds.center(), 0.5 * bounds.extent().length());
        let to = middle - self.o;
        let closest = to.dot(self.d);
        // A light on the ray itself has no angle; no point is nearer than the light is large, or than rounding may tell.
        let distance = (to - closest * self.d).length().max(0.5 * radius).max(1e-4 * to.length());
        let angle = |t: f32| match t.is_finite() {
            true => fmath::atan2(t - closest, distance),
            false => std::f32::consts::FRAC_PI_2,
        };
        let ends = [angle(0.0), angle(self.length)];
        (distance > 0.0 && ends[1] > ends[0]).then_some(Equiangular { closest, distance, ends })
    }

    /// Density of drawing a light for the ray and the distance `t` for the light, and that of a collision there and of drawing the light at it.
    fn densities(&self, scene: &Scene, light: LightIndex, t: f32, by: LightSelection<'_>) -> [f32; 2] {
        let sampler = &scene.lighting.sampler;
        let drawn = sampler.pmf(light, &self.receiver, by)
            * self.towards(scene, light).map_or(0.0, |towards| towards.pdf(t));
        let there = Receiver { p: self.o + t * self.d, ..self.receiver };
        let collision = all_lanes(self.sigma_t * (self.sigma_t * -t).exp(), &self.wavelengths);
        [drawn, collision * sampler.pmf(light, &there, by)]
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
        let [drawn, collided] = self.densities(scene, light, t, by);
        if drawn > 0.0 { power_heuristic(collided, drawn) } else { 1.0 }
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
        let chosen = scene.lighting.sampler.sample(&self.receiver, u.x, by)?;
        let SampledLight { light, .. } = chosen;
        let towards = self.towards(scene, light)?;
        let t = towards.sample(v.x);
        if !(0.0..self.length).contains(&t) {
            return None;
        }
        let p = self.o + t * self.d;
        let receiver = Receiver { p, ..self.receiver };
        let li = scene.sample_li(light, &receiver, chosen.pair(u), &start.wavelengths)?;
        let [drawn, collided] = self.densities(scene, light, t, by);
        let coefficients = scattering_medium(scene, start)?;
        let scattered = coefficients.phase().eval(-self.d, li.wi);
        let absorbed = start.media.transmittance(t) * (self.sigma_t * -t).exp();
        let carried = start.beta * absorbed * coefficients.sigma_s(&start.wavelengths) * scattered;
        if drawn <= 0.0 || li.radiance.is_black() || carried.is_black() {
            return None;
        }
        let segment = SurfacePoint { p, ..SurfacePoint::default() }.ray_to(&li.at, li.wi, self.receiver.time);
        let with = Joining {
            wavelengths: &start.wavelengths,
            hero: start.lanes.hero,
            r_u: start.lanes.r_u,
            draws: &mut path.draws,
        };
        let passage = connect_through_media(scene, &segment, start.media, with, observer);
        observer.light_drawn(&self.receiver, light, || !passage.t.is_black());
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

impl Equiangular {
    fn sample(&self, u: f32) -> f32 {
        let [a, b] = self.ends;
        self.closest + self.distance * fmath::tan((1.0 - u) * a + u * b)
    }

    fn pdf(&self, t: f32) -> f32 {
        let (d, off) = (self.distance, t - self.closest);
        d / ((self.ends[1] - self.ends[0]) * (d * d + off * off))
    }
}
