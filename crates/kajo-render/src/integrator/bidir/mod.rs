//! Bidirectional path tracing [Lafortune and Willems 1993], [Veach and Guibas 1994], and light tracing.
//!
//! For each sample one path is followed from the camera and one from a light. Every point of the one is connected with
//! every point of the other. A way to find a path is named by the points `s` that come from the light and `t` that come
//! from the camera, light and lens counted:
//!
//! ```text
//! s = 0           the path from the camera meets a light or leaves the scene
//! s = 1           a point of the camera's path is lit by a light drawn for it
//! s > 1, t > 1    two points are connected:  beta f G f' beta'
//! t = 1           a point of the emitter's path is seen by the camera; its light is a splat
//! ```
//!
//! What can be found in several ways counts with the weights of the power heuristic; see `rivals.rs`. Light on its way
//! through glass to a matt surface, a caustic, is left to `t = 1`, which is where path tracing has no good way.
//!
//! Light tracing [Arvo 1986], [Dutré, Lafortune and Willems 1993] is what remains when `t = 1` alone is used, with weight
//! one. Lights and the background are then seen by the camera's own ray, and what is behind mirrors and glass
//! is not seen at all.

mod connect;
mod rivals;
mod vertex;
mod walk;

use std::mem;

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::bsdf::Transport;
use kajo_core::camera::Camera;
use kajo_core::light::{Departures, LightChoice, MAX_LIGHT_GROUPS};
use kajo_core::sampler::Draws;
use kajo_core::scene::{Interaction, Scene};
use kajo_math::{Ray, Vec2};

use super::bodies::Bodies;
use super::view::{View, in_white_light};
use crate::trail::{Counting, RayKind, Witness};
use crate::{LayerSet, PixelIntegrator, PixelSample, SampleContext, Trail};
use connect::{normal, parts, spread};
use rivals::{Rivals, square};
use vertex::Vertex;
use walk::{Step, Walk};

/// Options of [`Bidirectional`].
#[derive(Clone, Copy, Debug)]
pub struct BidirectionalSettings {
    /// How often light is scattered on its way from one surface to another; 0 shows what emitters light themselves.
    pub bounces: u32,
    /// Whether light is followed from emitters only.
    pub only_from_lights: bool,
    /// How lights are chosen for a point.
    pub light_choice: LightChoice,
    /// Whether paths of little weight end at random.
    pub roulette: bool,
    /// Whether light is followed by wavelength.
    pub spectral: bool,
}

impl Default for BidirectionalSettings {
    fn default() -> BidirectionalSettings {
        BidirectionalSettings {
            bounces: 16,
            only_from_lights: false,
            light_choice: LightChoice::Tree,
            roulette: true,
            spectral: false,
        }
    }
}

/// The bidirectional path tracer over one scene and one picture size.
pub struct Bidirectional<'a> {
    view: View<'a>,
    settings: BidirectionalSettings,
    departures: Departures,
}

/// The points of a path from a light, kept from sample to sample.
#[derive(Default)]
struct LightPath(Vec<Vertex>);

/// Light that was found.
#[derive(Clone, Copy, Debug)]
struct Found {
    /// Points drawn from the light and from the camera.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests look at each way by itself"))]
    way: [u32; 2],
    /// Its estimate by this way alone.
    light: Spectrum,
    /// How much that counts.
    weight: f32,
    /// Whether only one wavelength is followed.
    is_single: bool,
    /// The group of the light.
    group: u8,
    /// Where it is seen; with the camera's ray where absent.
    raster: Option<Vec2>,
}

impl Found {
    /// What it adds to the picture, linear RGB.
    fn value(&self, wavelengths: &Wavelengths) -> [f32; 3] {
        let mut wavelengths = *wavelengths;
        if self.is_single {
            wavelengths.terminate_secondary();
        }
        sensor::to_rgb(self.light * self.weight, &wavelengths)
    }
}

/// What the camera's ray has seen besides light.
#[derive(Default)]
struct Seen {
    first: Option<Interaction>,
    /// Linear RGB.
    albedo: Option<[f32; 3]>,
}

impl<'a> Bidirectional<'a> {
    /// The integrator for a picture of `size` pixels with these `layers`.
    pub fn new(
        scene: &'a Scene,
        settings: BidirectionalSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Bidirectional<'a> {
        Bidirectional {
            view: View::new(scene, size, layers).spectral(settings.spectral),
            settings,
            departures: scene.departures(),
        }
    }

    /// The same through another camera than the scene's.
    pub fn through(self, camera: &'a Camera) -> Bidirectional<'a> {
        Bidirectional { view: self.view.through(camera), ..self }
    }

    fn scene(&self) -> &'a Scene {
        self.view.scene
    }

    /// Whether points of the emitter's path are joined with the camera. The light of groups of emitters is recorded for each
    /// sample's own pixel, so there all of it must come with the camera's ray.
    fn connects(&self) -> bool {
        self.settings.only_from_lights || !self.view.wants_light_groups()
    }

    /// Most points of a path, light and lens included.
    fn longest(&self) -> u32 {
        self.settings.bounces.saturating_add(3)
    }

    /// Hands all light that one sample finds to `found`.
    fn estimate<W: Witness>(
        &self,
        mut draws: Draws<'_>,
        witness: &mut W,
        raster: Vec2,
        path: &mut Vec<Vertex>,
        found: &mut impl FnMut(Found, &Wavelengths),
    ) -> Seen {
        path.clear();
        let from_light = draws.split(0, 0, 1);
        let Some(ray) = self.view.ray(raster, &mut draws) else { return Seen::default() };
        let wavelengths = self.view.wavelengths(&mut draws);
        let root = witness.mark();
        let mut from_light = self.follow_light(witness, path, from_light, ray.time, &wavelengths);
        let seen = if self.connects() { &path[..] } else { &[] };
        for (s, y) in (2..).zip(seen) {
            let lens = from_light.pair_if(self.view.camera.has_lens());
            witness.back_to_noted(s - 2);
            if let Some(seen) = self.see(witness, y, [s, 1], lens, (&wavelengths, ray.time)) {
                found(seen, &wavelengths);
            }
        }
        witness.back_to(root);
        self.follow_view(witness, path, draws, ray, &wavelengths, found)
    }

    /// Fills `path` with a path from a light.
    fn follow_light<'b, W: Witness>(
        &self,
        witness: &mut W,
        path: &mut Vec<Vertex>,
        mut draws: Draws<'b>,
        time: f32,
        wavelengths: &Wavelengths,
    ) -> Draws<'b> {
        let u = draws.number_if(self.scene().emitters.len() > 1);
        let ways = [draws.next_2d(), draws.next_2d()];
        let scene = self.scene();
        let Some((emitted, emitter, chance)) = scene.emit(&self.departures, time, u, ways, wavelengths)
        else {
            return draws;
        };
        let (end, rest) = parts(emitted.pdf, emitted.is_infinite());
        let end = chance * end;
        let step = Step {
            from: emitted.p,
            pdf: rest,
            is_parallel: emitted.is_infinite(),
            cosine: emitted.cosine(),
            back: 0.0,
            rivals: Rivals { last: if emitted.is_delta { 0.0 } else { square(end).recip() }, earlier: 0.0 },
            joins: true,
        };
        let carried = (emitted.power() * (1.0 / chance), *wavelengths);
        let ray = (emitted.ray(time), step);
        let bodies = match emitted.is_infinite() {
            true => Bodies::default(),
            false => Bodies::around(scene, &ray.0, wavelengths),
        };
        let roulette = self.settings.roulette;
        let told = mem::take(witness);
        let mut walk = Walk::new(scene, draws, Transport::Importance, ray, (carried, bodies), roulette, told);
        walk.witness.counters().light += 1;
        walk.witness.next(RayKind::Light);
        let group = scene.emitters.group(emitter);
        while let Some(mut met) = walk.trace() {
            if walk.passes(&mut met) {
                continue;
            }
            if path.is_empty() {
                walk.beta *= emitted.share_at(met.at.point.p.distance(emitted.p));
            }
            let mut vertex = walk.vertex(&met);
            vertex.group = group;
            if path.is_empty() {
                // A connection with the light itself draws a place anew.
                let (place, wi) = ([emitted.p, normal(&emitted.origin)], -emitted.d);
                let choice = self.settings.light_choice;
                let drawn = scene.light_pdf(emitter, &vertex.receiver(time), place, wi, choice);
                let spread = spread(&emitted.origin, wi, emitted.p.distance_squared(vertex.at.p));
                vertex.rivals.last *= square(drawn * spread / end);
            }
            path.push(vertex);
            walk.witness.note();
            let is_last = path.len() as u32 + 2 == self.longest();
            if is_last || !walk.scatter(&vertex, &met) {
                break;
            }
        }
        *witness = walk.witness;
        walk.draws
    }

    /// Follows a path from the camera and connects each of its points.
    fn follow_view<W: Witness>(
        &self,
        witness: &mut W,
        path: &[Vertex],
        draws: Draws<'_>,
        ray: Ray,
        wavelengths: &Wavelengths,
        found: &mut impl FnMut(Found, &Wavelengths),
    ) -> Seen {
        let scene = self.scene();
        let step = Step {
            from: ray.o,
            pdf: 1.0,
            is_parallel: true,
            cosine: 1.0,
            back: 0.0,
            rivals: Rivals::default(),
            joins: true,
        };
        let carried = (Spectrum::WHITE, *wavelengths);
        let bodies = self.view.bodies_around(&ray, wavelengths);
        let roulette = self.settings.roulette;
        let told = mem::take(witness);
        let mut walk =
            Walk::new(scene, draws, Transport::Radiance, (ray, step), (carried, bodies), roulette, told);
        walk.witness.counters().camera += 1;
        walk.witness.next(RayKind::Camera);
        let mut seen = Seen::default();
        // Who is lit by what the present ray may meet.
        let mut origin = None;
        let mut t = 2;
        loop {
            let Some(mut met) = walk.trace() else {
                let mut told = mem::take(&mut walk.witness);
                self.leave(&walk, origin.as_ref(), |far| {
                    told.found(|| far.value(wavelengths));
                    found(far, wavelengths);
                });
                walk.witness = told;
                break;
            };
            if t == 2 {
                match self.view.pdf_across(&ray, met.at.point.p).filter(|_| self.connects()) {
                    Some(pdf) => walk.step.pdf = pdf,
                    None => walk.step.joins = false,
                }
            }
            if let Some(glow) = self.meet(&walk, &met.at, origin.as_ref()) {
                walk.witness.found(|| glow.value(wavelengths));
                found(glow, wavelengths);
            }
            if walk.passes(&mut met) {
                continue;
            }
            if t == self.longest() {
                break;
            }
            let z = walk.vertex(&met);
            if seen.albedo.is_none() && self.view.wants_albedo() && !z.bsdf.is_delta() {
                seen.albedo = Some(in_white_light(z.bsdf.albedo(z.local(z.back).wo), wavelengths));
            }
            if self.settings.only_from_lights {
                break;
            }
            if !z.bsdf.is_delta() {
                let at_hand = (&walk.wavelengths, ray.time);
                if let Some(lit) = self.light(&mut walk.witness, &mut walk.draws, &z, at_hand, t) {
                    found(lit, wavelengths);
                }
                let shorter = (2..=self.longest() - t).zip(path);
                for (s, y) in shorter {
                    let at_hand = (wavelengths, ray.time);
                    if let Some(joined) = self.join(&mut walk.witness, y, &z, [s, t], at_hand) {
                        found(joined, wavelengths);
                    }
                }
            }
            if !walk.scatter(&z, &met) {
                break;
            }
            origin = Some(z);
            t += 1;
        }
        *witness = walk.witness;
        seen.first = walk.first;
        seen
    }
}

impl Bidirectional<'_> {
    fn cast<W: Witness>(&self, ctx: &mut SampleContext<'_>, raster: Vec2, witness: &mut W) -> PixelSample {
        let SampleContext { draws, aux, splats, scratch, .. } = ctx;
        let mut path = mem::take(&mut scratch.get::<LightPath>().0);
        let mut radiance = [0.0; 3];
        let mut groups = [[0.0; 3]; MAX_LIGHT_GROUPS];
        let seen = self.estimate(*draws, witness, raster, &mut path, &mut |found, wavelengths| {
            let value = found.value(wavelengths);
            match found.raster {
                Some(raster) => splats.add(raster, value),
                None => {
                    for sum in [&mut radiance, &mut groups[usize::from(found.group)]] {
                        *sum = [0, 1, 2].map(|i| sum[i] + value[i]);
                    }
                }
            }
        });
        scratch.get::<LightPath>().0 = path;
        if self.view.wants_light_groups() {
            aux.lights = groups;
        }
        if self.view.wants_albedo() {
            aux.albedo = seen.albedo.unwrap_or_default();
        }
        PixelSample { radiance, first: seen.first.map(|at| self.view.first_hit(&at, aux)) }
    }
}

impl PixelIntegrator for Bidirectional<'_> {
    fn sample(&self, ctx: &mut SampleContext<'_>, _pixel: [u32; 2], raster: Vec2) -> PixelSample {
        let mut counting = Counting::new(ctx);
        let sample = self.cast(ctx, raster, &mut counting);
        ctx.rays = counting.rays;
        sample
    }

    fn trail(&self, ctx: &mut SampleContext<'_>, _pixel: [u32; 2], raster: Vec2) -> (PixelSample, Trail) {
        let mut trail = Trail::default();
        (self.cast(ctx, raster, &mut trail), trail)
    }
}

#[cfg(test)]
mod tests;
