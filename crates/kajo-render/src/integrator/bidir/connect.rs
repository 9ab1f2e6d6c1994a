//! The ends of paths, and what joins them.

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::light::{EmissionPdf, LightSample, Target};
use kajo_core::sampler::Draws;
use kajo_core::scene::Interaction;
use kajo_math::{Ray, Vec2, Vec3};

use super::rivals::{Rivals, square, weight};
use super::vertex::Vertex;
use super::walk::Walk;
use super::{Bidirectional, Found};
use crate::trail::{About, RayKind, Witness};

/// Densities of the light's end of a path and of the way to the next point, the geometry there left out. Of a light
/// infinitely far away the direction is its end.
pub fn parts(pdf: EmissionPdf, is_infinite: bool) -> (f32, f32) {
    if is_infinite { (pdf.direction, pdf.place) } else { (pdf.place, pdf.direction) }
}

/// The unit normal at the end of a way, zero where there is none.
pub fn normal(end: &Target) -> Vec3 {
    match end {
        Target::Surface { n, .. } => *n,
        Target::Point(_) | Target::Infinity => Vec3::ZERO,
    }
}

/// Solid angle per area of the end of a way along the unit vector `w`; 1 where it has no area.
pub fn spread(end: &Target, w: Vec3, distance2: f32) -> f32 {
    match end {
        Target::Surface { n, .. } => n.dot(w).abs() / distance2,
        Target::Point(_) | Target::Infinity => 1.0,
    }
}

impl Bidirectional<'_> {
    /// `s = 0`: the glow of a surface that the camera's path meets.
    ///
    /// * `from`: the point before, `None` where that is the lens
    pub(super) fn meet(
        &self,
        walk: &Walk<'_, '_, impl Witness>,
        at: &Interaction,
        from: Option<&Vertex>,
    ) -> Option<Found> {
        let glow = self.scene().glow(at, walk.ray.d, &walk.wavelengths)?;
        let weight = from.map_or(1.0, |from| {
            let (p, n, wi) = (at.point.p, at.point.ng, walk.ray.d);
            let cosine = n.dot(wi).abs();
            let drawn = self.light_pdf(glow.emitter(), (from, walk.ray.time), [p, n], wi) * cosine
                / p.distance_squared(from.at.p);
            let (end, rest) = self.emission_parts((glow.emitter(), walk.ray.time), [p, n], -wi, false);
            weight_of_chance(&walk.rivals(p, cosine), drawn, end, rest)
        });
        Some(walk.found(glow.radiance, glow.group, weight))
    }

    /// `s = 0`: hands the light to `found` of the background and of the discs in the sky that the camera's path comes to.
    pub(super) fn leave(
        &self,
        walk: &Walk<'_, '_, impl Witness>,
        from: Option<&Vertex>,
        mut found: impl FnMut(Found),
    ) {
        let scene = self.scene();
        let wi = walk.ray.d;
        let mut meet = |radiance: Spectrum, group: u8, light: Option<u32>| {
            let weight = from.zip(light).map_or(1.0, |(from, light)| {
                let drawn = self.light_pdf(light, (from, walk.ray.time), [Vec3::ZERO; 2], wi);
                let place = [from.at.p, Vec3::ZERO];
                let (end, rest) = self.emission_parts((light, walk.ray.time), place, -wi, true);
                weight_of_chance(&walk.rivals_at_infinity(), drawn, end, rest)
            });
            found(walk.found(radiance, group, weight));
        };
        let radiance = scene.background.radiance(wi, &walk.wavelengths);
        if !radiance.is_black() {
            meet(radiance, scene.emitters.sky_group(), scene.emitters.sky());
        }
        for sun in scene.suns(wi, &walk.wavelengths) {
            meet(sun.radiance, sun.group, Some(sun.light));
        }
    }

    /// `s = 1`: a light drawn for a point of the camera's path.
    pub(super) fn light(
        &self,
        witness: &mut impl Witness,
        draws: &mut Draws<'_>,
        z: &Vertex,
        (wavelengths, time): (&Wavelengths, f32),
        t: u32,
    ) -> Option<Found> {
        let scene = self.scene();
        let u = draws.number_if(scene.emitters.len() > 1);
        let place = draws.next_2d();
        let choice = self.settings.light_choice;
        let sample = scene.light_towards(&z.receiver(time), u, place, wavelengths, choice)?;
        let LightSample { wi, radiance, pdf, is_delta, target, light } = sample;
        let scattered = z.gathered(wi);
        if radiance.is_black() || scattered.is_black() {
            return None;
        }
        witness.counters().shadow += 1;
        let shadow_ray = z.at.ray_to_light(&sample, time);
        let carried = (z.beta * scattered, wavelengths);
        let visible = scene.visibility(&shadow_ray, wavelengths, z.eta(wi));
        if visible.is_black() {
            self.tell(witness, RayKind::Shadow, &shadow_ray, carried, Some(light), None);
            return None;
        }
        let (p, distance) = match target {
            Target::Surface { p, .. } | Target::Point(p) => (p, p.distance(z.at.p)),
            Target::Infinity => (z.at.p, f32::INFINITY),
        };
        let is_infinite = distance.is_infinite();
        let (end, rest) = self.emission_parts((light, time), [p, normal(&target)], -wi, is_infinite);
        let thinning = if is_infinite { 1.0 } else { 1.0 / (distance * distance) };
        let drawn = pdf * spread(&target, wi, distance * distance);
        let met = if is_delta { 0.0 } else { square(z.pdf(z.back, wi) / pdf) };
        let before = square(end / drawn) * z.rivals.sum(rest * z.cosine(wi) * thinning, z.pdf(wi, z.back));
        let found = Found {
            way: [1, t],
            light: z.beta * scattered * radiance * z.transmittance(wi, distance) * visible * pdf.recip(),
            weight: weight(met, before),
            is_single: z.is_single,
            group: scene.emitters.group(light),
            raster: None,
        };
        self.tell(witness, RayKind::Shadow, &shadow_ray, carried, Some(light), Some(&found));
        Some(found)
    }

    /// `s > 1, t > 1`: two points that see each other.
    pub(super) fn join(
        &self,
        witness: &mut impl Witness,
        y: &Vertex,
        z: &Vertex,
        way: [u32; 2],
        (wavelengths, time): (&Wavelengths, f32),
    ) -> Option<Found> {
        let distance2 = y.at.p.distance_squared(z.at.p);
        if y.bsdf.is_delta() || distance2 == 0.0 {
            return None;
        }
        let distance = distance2.sqrt();
        let wi = (y.at.p - z.at.p) / distance;
        let scattered = z.gathered(wi) * y.passed_on(-wi);
        if scattered.is_black() {
            return None;
        }
        witness.counters().shadow += 1;
        let target = Target::Surface { p: y.at.p, p_error: y.at.p_error, n: y.at.ng };
        let way_there = z.at.ray_to(&target, wi, time);
        let carried = (z.beta * scattered, wavelengths);
        let visible = self.scene().visibility(&way_there, wavelengths, z.eta(wi));
        if visible.is_black() {
            self.tell(witness, RayKind::Connection, &way_there, carried, None, None);
            return None;
        }
        let by_camera = z.pdf(z.back, wi) * y.cosine(wi) / distance2;
        let by_light = y.pdf(y.back, -wi) * z.cosine(wi) / distance2;
        let light_side = y.rivals.sum(by_camera, y.pdf(-wi, y.back));
        let camera_side = z.rivals.sum(by_light, z.pdf(wi, z.back));
        let found = Found {
            way,
            light: y.beta * scattered * z.beta * z.transmittance(wi, distance) * visible * distance2.recip(),
            weight: weight(light_side, camera_side),
            is_single: y.is_single || z.is_single,
            group: y.group,
            raster: None,
        };
        self.tell(witness, RayKind::Connection, &way_there, carried, None, Some(&found));
        Some(found)
    }

    /// `t = 1`: a point of the light's path that the camera sees.
    ///
    /// * `lens`: uniform in [0, 1)²
    pub(super) fn see(
        &self,
        witness: &mut impl Witness,
        y: &Vertex,
        way: [u32; 2],
        lens: Vec2,
        (wavelengths, time): (&Wavelengths, f32),
    ) -> Option<Found> {
        if y.bsdf.is_delta() {
            return None;
        }
        let (to, raster) = self.view.connect(y.at.p, lens, time)?;
        let scattered = y.passed_on(to.wi);
        if scattered.is_black() {
            return None;
        }
        witness.counters().shadow += 1;
        let is_parallel = to.distance.is_infinite();
        let target = if is_parallel { Target::Infinity } else { Target::Point(y.at.p + to.distance * to.wi) };
        let way_there = y.at.ray_to(&target, to.wi, time);
        self.tell(witness, RayKind::Splat, &way_there, (y.beta * scattered, wavelengths), None, None);
        let visible = self.scene().visibility(&way_there, wavelengths, y.eta(to.wi));
        if visible.is_black() {
            return None;
        }
        let rivals = || y.rivals.sum(to.pdf_across * y.cosine(to.wi), y.pdf(to.wi, y.back));
        Some(Found {
            way,
            light: y.beta * scattered * y.transmittance(to.wi, to.distance) * visible * (to.we / to.pdf),
            weight: if self.settings.only_from_lights { 1.0 } else { weight(rivals(), 0.0) },
            is_single: y.is_single,
            group: y.group,
            raster: Some(raster),
        })
    }

    /// Tells of a ray that joins two points.
    ///
    /// * `carried`: what light from its far end is multiplied by
    /// * `emitter`: the light that it is cast to
    /// * `found`: what it adds to the sample
    fn tell(
        &self,
        witness: &mut impl Witness,
        kind: RayKind,
        ray: &Ray,
        (carried, wavelengths): (Spectrum, &Wavelengths),
        light: Option<u32>,
        found: Option<&Found>,
    ) {
        let about = || About {
            eta: 1.0,
            weight: sensor::to_rgb(carried, wavelengths),
            light: light.map(|light| self.scene().emitters.id(light)),
        };
        let light = || found.map_or([0.0; 3], |found| found.value(wavelengths));
        witness.joined(kind, self.scene(), ray, about, light);
    }

    /// Density per solid angle with which [`Bidirectional::light`] draws an emitter and the way to a place of it.
    fn light_pdf(&self, light: u32, (from, time): (&Vertex, f32), at: [Vec3; 2], wi: Vec3) -> f32 {
        self.scene().light_pdf(light, &from.receiver(time), at, wi, self.settings.light_choice)
    }

    /// [`parts`] of the light of an emitter along `d`, with the choice of the emitter.
    fn emission_parts(
        &self,
        (light, time): (u32, f32),
        at: [Vec3; 2],
        d: Vec3,
        is_infinite: bool,
    ) -> (f32, f32) {
        let pdf = self.scene().emission_pdf(&self.departures, light, time, at, d);
        let (end, rest) = parts(pdf, is_infinite);
        (end * self.departures.probability(light), rest)
    }
}

/// The weight of light that was met by chance.
///
/// * `drawn`: density of the light's end of the path among lights drawn for a point
/// * `end`, `rest`: densities of the end and of the way on among paths from lights
fn weight_of_chance(rivals: &Rivals, drawn: f32, end: f32, rest: f32) -> f32 {
    weight(0.0, square(drawn) * rivals.last + square(end) * square(rest) * rivals.earlier)
}
