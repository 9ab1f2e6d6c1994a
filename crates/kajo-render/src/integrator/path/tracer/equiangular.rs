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
use kajo_core::medium::Phase;
use kajo_core::scene::Scene;
use kajo_core::settings::Technique;
use kajo_core::space::Space;
use kajo_math::{Ray, Vec3, fmath};

use super::{CameraPath, IndirectLight, PathTracer, power_heuristic};
use crate::integrator::transport::{
    Event, Joining, PathState, SurfaceInteraction, advance, all_lanes, connect_through_media,
};
use crate::trail::{About, PathObserver, RayKind};

/// Scatterings of a path after which no points are drawn along its rays.
const MOST_SCATTERINGS: u32 = 1;

/// A ray in a homogeneous medium along which a point has been drawn for a light.
#[derive(Clone, Copy, Debug)]
pub struct Along {
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

impl Along {
    /// * `path`: before it follows its ray
    /// * `length`: of the ray
    fn new(path: &PathState<'_>, sigma_t: Spectrum, length: f32) -> Along {
        let Ray { o, d, time, .. } = path.ray;
        let free = 1.0 / all_lanes(sigma_t, &path.wavelengths);
        let p = o + d * (0.5 * length).min(free);
        let receiver = Receiver { p, n: Vec3::ZERO, time };
        Along { o, d, length, sigma_t, wavelengths: path.wavelengths, receiver }
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

impl<'a: 's, 's, O: PathObserver, C: IndirectLight> PathTracer<'a, 's, O, C> {
    /// As [`advance`], through media: adds the light that these give on the way, and that of points drawn along the ray.
    #[cold]
    #[inline(never)]
    pub(super) fn advance_through_media(
        &mut self,
        path: &mut CameraPath<'s>,
        surface: &mut SurfaceInteraction,
    ) -> Event<'a> {
        let scene = self.scene();
        let start = path.state;
        path.along = None;
        let event = advance(scene, &mut path.state, surface, &mut self.estimate.first, self.observer);
        self.add_medium_emission(path);
        if C::IS_ASKED
            || path.ends_at_lights
            || self.settings.technique == Technique::Scattering
            || start.scatterings > MOST_SCATTERINGS
            || path.state.surfaces != start.surfaces + 1
            || scene.space() == Space::Curved
        {
            return event;
        }
        // Several media scatter by several phase functions: collisions find their light.
        let Some(medium) = start.media.medium().filter(|_| !start.media.overlaps()) else { return event };
        let (media, wavelengths) = (&scene.appearance.media, &start.wavelengths);
        let coefficients = media.coefficients(medium);
        if !media.is_homogeneous(medium) || !coefficients.scatters() {
            return event;
        }
        let length = match event {
            Event::Surface => surface.length,
            Event::Medium(_) => path.state.extent,
            Event::Escaped(_) => f32::INFINITY,
            Event::Absorbed => return event,
        };
        let sigma_s = coefficients.sigma_s(wavelengths);
        let along = Along::new(&start, sigma_s + coefficients.sigma_a(wavelengths), length);
        if !along.receiver.p.is_finite() {
            return event;
        }
        path.along = Some(along);
        self.add_along(path, &start, &along, (sigma_s, coefficients.phase()));
        event
    }

    /// Adds the light of one light at a point drawn along a ray.
    ///
    /// Takes four numbers, and what a connection takes.
    fn add_along(
        &mut self,
        path: &mut CameraPath<'s>,
        start: &PathState<'s>,
        along: &Along,
        (sigma_s, phase): (Spectrum, &Phase),
    ) {
        let (scene, by) = (self.scene(), self.lights);
        let draws = &mut path.state.draws;
        let (u, v) = (draws.next_2d(), draws.next_2d());
        let Some(chosen) = scene.lighting.sampler.sample(&along.receiver, u.x, by) else { return };
        let SampledLight { light, .. } = chosen;
        let Some(towards) = along.towards(scene, light) else { return };
        let t = towards.sample(v.x);
        if !(0.0..along.length).contains(&t) {
            return;
        }
        let p = along.o + t * along.d;
        let receiver = Receiver { p, ..along.receiver };
        let Some(li) = scene.sample_li(light, &receiver, chosen.pair(u), &start.wavelengths) else { return };
        let [drawn, collided] = along.densities(scene, light, t, by);
        let scattered = phase.eval(-along.d, li.wi);
        let absorbed = start.media.transmittance(t) * (along.sigma_t * -t).exp();
        let carried = start.beta * absorbed * sigma_s * scattered;
        if drawn <= 0.0 || li.radiance.is_black() || carried.is_black() {
            return;
        }
        let segment =
            SurfacePoint { p, ..SurfacePoint::default() }.ray_to(&li.at, li.wi, along.receiver.time);
        let with = Joining {
            wavelengths: &start.wavelengths,
            hero: start.lanes.hero,
            r_u: start.lanes.r_u,
            draws: &mut path.state.draws,
        };
        let passage = connect_through_media(scene, &segment, start.media, with, self.observer);
        self.observer.light_drawn(&along.receiver, light, || !passage.t.is_black());
        let by_light = start.mean(passage.r_l);
        let weight = power_heuristic(drawn, collided);
        let added = carried * li.radiance * passage.t * (weight / (drawn * li.pdf * by_light));
        let added = if added.is_finite() { added } else { Spectrum::BLACK };
        let about = || About {
            eta: start.media.eta(),
            weight: sensor::to_rgb(carried, &start.wavelengths),
            light: Some(scene.lighting.sampler.id(light)),
        };
        let rgb = || sensor::to_rgb(added, &start.wavelengths);
        self.observer.joined(RayKind::Shadow, scene, &segment, about, rgb);
        self.add(start, added, scene.lighting.sampler.group(light));
    }
}
