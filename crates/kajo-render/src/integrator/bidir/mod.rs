//! Bidirectional path tracing [Lafortune and Willems 1993], [Veach and Guibas 1994], and light tracing.
//!
//! For each sample one path is followed from the camera and one from a light. Every point of the one is connected with
//! every point of the other. A technique is named by the points `s` that come from the light and `t` that come
//! from the camera, light and lens counted:
//!
//! ```text
//! s = 0           the path from the camera hits a light or leaves the scene
//! s = 1           a point of the camera's path is lit by a light drawn for it
//! s > 1, t > 1    two points are connected:  beta f G f' beta'
//! s > 1, t = 1    a point of the light's path is seen by the camera; its light is a splat
//! s = 1, t = 1    a light drawn for a point of the lens, where that has an extent; its light is a splat, too
//! ```
//!
//! What several techniques find counts with the weights of the power heuristic; see `partial_mis.rs`. Light on its way
//! through glass to a matt surface, a caustic, is left to `t = 1`, where path tracing has no technique of small variance.
//!
//! Light tracing [Arvo 1986], [Dutré, Lafortune and Willems 1993] is what remains when `t = 1` alone is used, with weight
//! one. Lights and the background are then seen by the camera's own ray, and what is behind mirrors and glass
//! is not seen at all.
//!
//! In scenes with participating media points may be collisions with these; see `volume.rs`. Where vertices of many paths from lights are kept,
//! they can be merged with those of the camera's path; see `merge.rs`.

mod connect;
mod light_path;
mod merge;
mod partial_mis;
mod settings;
mod subpath;
mod techniques;
mod vertex;
mod volume;

use std::marker::PhantomData;
use std::mem;

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::LightGroup;
use kajo_core::bsdf::{Bsdf, Transport};
use kajo_core::camera::Camera;
use kajo_core::light::{
    LeNumbers, LightLeSample, LightPoint, MAX_LIGHT_GROUPS, PowerLightSampler, SampledLight,
};
use kajo_core::sampler::SampleStream;
use kajo_core::scene::{Interaction, Scene};
use kajo_math::{Ray, Vec2, Vec3};

use super::Integrator;
use super::camera_view::{CameraView, in_white_light};
use super::transport::{
    Event, LaneMis, MediumInteraction, MediumStack, PathState, SurfaceInteraction, advance, pass_straight,
    shade,
};
use crate::context::emptied;
use crate::trail::{Counting, PathObserver, RayKind};
use crate::{LayerSet, PixelIntegrator, PixelSample, SampleContext};
use connect::LightEndPdf;
pub(super) use connect::SegmentShare;
pub(super) use light_path::ReusedVolume;
#[cfg(test)]
pub(super) use merge::LightVertex;
pub(super) use merge::{MergePass, Merging};
use partial_mis::{PartialMis, square, weighted_pdf_across};
pub use settings::{BIDIRECTIONAL, BidirectionalSettings, LIGHT};
pub(super) use subpath::{LightStep, Subpath};
pub(super) use techniques::VertexCounts;
use techniques::{AllTechniques, Techniques};
pub(super) use vertex::Vertex;
pub(super) use volume::{NoMedia, Volume, WithMedia};

/// The bidirectional path tracer over one scene and one picture size: of surfaces alone, or with the participating media between them.
pub struct Bidirectional<'a, V = NoMedia> {
    view: CameraView<'a>,
    settings: BidirectionalSettings,
    power_sampler: PowerLightSampler,
    /// Whether the air is a medium without end, so that no path begins infinitely far away.
    in_endless_air: bool,
    volume: PhantomData<V>,
}

/// The bidirectional path tracer for a scene: with media where it has any.
pub(super) fn integrator_of<'a>(
    camera: &'a Camera,
    scene: &'a Scene,
    settings: BidirectionalSettings,
    size: [u32; 2],
    layers: LayerSet,
) -> Box<dyn PixelIntegrator + 'a> {
    match scene.has_media() {
        false => Box::new(Bidirectional::<NoMedia>::made(camera, scene, settings, size, layers)),
        true => Box::new(Bidirectional::<WithMedia>::made(camera, scene, settings, size, layers)),
    }
}

/// What both ends of a sample's paths begin with.
#[derive(Clone, Copy, Debug)]
struct Carried<'a, T = AllTechniques<'a, Merging>> {
    wavelengths: &'a Wavelengths,
    /// Moment within the shutter interval.
    time: f32,
    /// The lane that draws distances in media.
    hero: u32,
    /// The techniques that are evaluated.
    techniques: T,
}

/// Light that one technique has found.
#[derive(Clone, Copy, Debug)]
struct Contribution {
    #[cfg_attr(not(test), expect(dead_code, reason = "tests look at each technique by itself"))]
    technique: VertexCounts,
    /// Whether the last vertices of both subpaths are one.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests look at each technique by itself"))]
    is_merged: bool,
    /// The estimate by this technique alone.
    light: Spectrum,
    /// Its MIS weight.
    weight: f32,
    /// Whether only one wavelength is followed.
    secondary_terminated: bool,
    /// The light group.
    group: LightGroup,
    /// Where it is seen; with the camera's ray where absent.
    raster: Option<Vec2>,
}

impl Contribution {
    /// What it adds to the picture, linear RGB.
    fn value(&self, wavelengths: &Wavelengths) -> [f32; 3] {
        let mut wavelengths = *wavelengths;
        if self.secondary_terminated {
            wavelengths.terminate_secondary();
        }
        sensor::to_rgb(self.light * self.weight, &wavelengths)
    }
}

/// What the camera's ray has seen besides light.
#[derive(Default)]
struct VisibleSurface {
    first: Option<Interaction>,
    /// Whether light was scattered by a medium before that, so that what `first` has is none.
    begins_in_medium: bool,
    /// Linear RGB.
    albedo: Option<[f32; 3]>,
}

impl VisibleSurface {
    /// Light was scattered by a medium where the camera's ray has come to no surface yet.
    fn begin_in_medium(&mut self) {
        if self.first.is_none() {
            self.begins_in_medium = true;
            self.first = Some(Interaction::default());
        }
    }
}

/// The path from the camera while it grows.
struct CameraEnd<'a, 's, 'b, V, T> {
    path: Subpath<'s>,
    /// Where its ray ended.
    surface: SurfaceInteraction,
    /// Where it was scattered by a medium before that.
    collision: Option<MediumInteraction<'b>>,
    /// The vertex before, where that is not the lens.
    from: Option<Vertex<'b, V>>,
    /// Vertices once the ray has ended, the lens included.
    t: u32,
    visible: VisibleSurface,
    camera_ray: &'a Ray,
    /// What the sample began with.
    carried: Carried<'a, T>,
}

impl<'a> Bidirectional<'a> {
    /// The integrator of surfaces alone for a picture of `size` pixels with these `layers`.
    pub fn new(
        scene: &'a Scene,
        settings: BidirectionalSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Bidirectional<'a> {
        Bidirectional::through(&scene.output.camera, scene, settings, size, layers)
    }

    /// The same through another camera than the scene's.
    pub fn through(
        camera: &'a Camera,
        scene: &'a Scene,
        settings: BidirectionalSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Bidirectional<'a> {
        Bidirectional::made(camera, scene, settings, size, layers)
    }
}

impl<'a, V: Volume<'a>> Bidirectional<'a, V> {
    /// The integrator for a picture of `size` pixels with these `layers`.
    pub(super) fn made(
        camera: &'a Camera,
        scene: &'a Scene,
        settings: BidirectionalSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Bidirectional<'a, V> {
        Bidirectional {
            view: CameraView::new(scene, camera, size, layers).spectral(settings.spectral),
            settings,
            power_sampler: scene.power_light_sampler(),
            in_endless_air: is_endless(scene),
            volume: PhantomData,
        }
    }

    fn scene(&self) -> &'a Scene {
        self.view.scene
    }

    /// Whether vertices of the light's path are joined with the camera. Light groups are recorded for each
    /// sample's own pixel, so there all light must come with the camera's ray.
    fn connects(&self) -> bool {
        self.settings.only_from_lights || !self.view.wants_light_groups()
    }

    /// Whether lights are drawn for points of the lens, so that small ones out of focus are found.
    fn joins_lens(&self) -> bool {
        self.view.camera.has_lens() && !self.settings.only_from_lights && self.connects()
    }

    /// Most vertices of a path, light and lens included.
    fn longest(&self) -> u32 {
        self.settings.bounces.saturating_add(3)
    }

    /// Hands all light that one sample finds by these techniques to `found`.
    fn estimate<O: PathObserver, T: Techniques<Merging>>(
        &self,
        mut draws: SampleStream<'_>,
        observer: &mut O,
        raster: Vec2,
        light_path: &mut Vec<Vertex<'a, V>>,
        techniques: T,
        found: &mut impl FnMut(Contribution, &Wavelengths),
    ) -> VisibleSurface {
        light_path.clear();
        let from_light = draws.split(0, 0, 1);
        let Some(ray) = self.view.ray(raster, &mut draws) else { return VisibleSurface::default() };
        let own = self.view.wavelengths(&mut draws);
        let wavelengths = techniques.merging().map_or(own, |merging| *merging.wavelengths());
        let hero = if V::HAS_MEDIA { LaneMis::new(&wavelengths, draws.next_1d()).hero } else { 0 };
        let carried = Carried { wavelengths: &wavelengths, time: ray.time, hero, techniques };
        let root = observer.mark();
        let mut from_light = self.follow_light(observer, light_path, from_light, carried);
        if self.joins_lens()
            && techniques.has(1, 1)
            && let Some(seen) = self.light_on_lens(carried, &mut from_light, observer)
        {
            found(seen, &wavelengths);
        }
        let seen = if self.connects() { &light_path[..] } else { &[] };
        for (s, y) in (2..).zip(seen) {
            if !techniques.has(s, 1) {
                continue;
            }
            observer.back_to_noted(s - 2);
            if let Some(seen) = self.splat(y, VertexCounts { s, t: 1 }, carried, &mut from_light, observer) {
                found(seen, &wavelengths);
            }
        }
        if !techniques.needs_camera_vertex_after(1) {
            return VisibleSurface::default();
        }
        observer.back_to(root);
        self.follow_camera(observer, light_path, draws, ray, carried, found)
    }

    /// Fills `vertices` with a path from a light. Returns the random numbers that are left.
    ///
    /// The path carries power: `beta` begins as `Le |cos| / (p_light p_position p_direction)`, and the power that arrives at a
    /// surface is scattered on by `f |cos| / p`.
    fn follow_light<'s, O: PathObserver, T: Techniques<Merging>>(
        &self,
        observer: &mut O,
        vertices: &mut Vec<Vertex<'a, V>>,
        mut draws: SampleStream<'s>,
        carried: Carried<'_, T>,
    ) -> SampleStream<'s> {
        let scene = self.scene();
        let Carried { wavelengths, time, hero, techniques } = carried;
        if !techniques.needs_light_vertex_after(1) {
            return draws;
        }
        let drawn = sample_emitted(scene, &self.power_sampler, time, wavelengths, &mut draws);
        let Some((chosen, emitted)) = drawn else { return draws };
        let SampledLight { light, probability, .. } = chosen;
        if V::HAS_MEDIA && self.is_hidden(&emitted.at) {
            return draws;
        }
        let mut path = light_end(scene, &emitted, time, probability, wavelengths, draws);
        if V::HAS_MEDIA {
            path.state.carry_media(hero);
        }
        let group = scene.lighting.sampler.group(light);
        observer.counters().light += 1;
        observer.next(RayKind::Light);
        let (mut surface, mut first) = (SurfaceInteraction::default(), None);
        while let Some((bsdf, collision)) =
            path.next_from_light::<V>(scene, &emitted, &mut surface, &mut first, observer)
        {
            let mut vertex = match &collision {
                None => path.vertex(scene, &surface, bsdf, group),
                Some(at) => path.vertex_in_medium(scene, at, group),
            };
            if vertices.is_empty() {
                self.weigh_first(&mut vertex, &emitted, chosen, time);
            }
            if let Some(merging) = techniques.merging() {
                match collision {
                    None => merging.weigh(scene, &surface, &mut vertex),
                    Some(_) => {
                        merging.weigh_in_medium(&mut vertex, path.state.connectable);
                    }
                }
            }
            vertices.push(vertex);
            observer.note();
            let (s, roulette) = (vertices.len() as u32 + 1, self.settings.roulette);
            let is_last = s + 1 == self.longest() || !techniques.needs_light_vertex_after(s);
            if is_last || !path.scatter_at(&vertex, &surface, collision.as_ref(), roulette, observer) {
                break;
            }
        }
        path.state.draws
    }

    /// Weighs the first vertex of a path from a light: a connection of the vertex with the light itself draws a point of that anew.
    /// [Georgiev 2012, eq. 31]
    #[inline]
    fn weigh_first(
        &self,
        vertex: &mut Vertex<'a, V>,
        emitted: &LightLeSample,
        chosen: SampledLight,
        time: f32,
    ) {
        let wi = -emitted.d;
        let pdf_li = self.pdf_li(chosen.light, &vertex.receiver(time), &emitted.at, wi);
        let distance2 = emitted.at.p().distance_squared(vertex.at.p);
        let spread = emitted.at.jacobian_to_end_measure(wi, distance2);
        let end = chosen.probability * LightEndPdf::new(emitted.pdf, emitted.at.is_infinite()).end;
        vertex.mis.d_vcm *= square(pdf_li * spread / end);
    }

    /// Follows a path from the camera and connects each of its vertices with the light's path.
    fn follow_camera<O: PathObserver, T: Techniques<Merging>>(
        &self,
        observer: &mut O,
        light_path: &[Vertex<'a, V>],
        draws: SampleStream<'_>,
        ray: Ray,
        carried: Carried<'_, T>,
        found: &mut impl FnMut(Contribution, &Wavelengths),
    ) -> VisibleSurface {
        let wavelengths = carried.wavelengths;
        let media = self.view.media_around(&ray, wavelengths);
        let mut state = PathState::new(ray, *wavelengths, Spectrum::WHITE, Transport::Radiance, media, draws);
        if V::HAS_MEDIA {
            state.carry_media(carried.hero);
        }
        let mut end = CameraEnd {
            path: Subpath::from_camera(PathState { connectable: true, ..state }),
            surface: SurfaceInteraction::default(),
            collision: None,
            from: None,
            t: 2,
            visible: VisibleSurface::default(),
            camera_ray: &ray,
            carried,
        };
        observer.counters().camera += 1;
        observer.next(RayKind::Camera);
        while let Some(bsdf) = self.next_vertex(&mut end, observer, found) {
            let (path, visible) = (&end.path, &mut end.visible);
            let mut z = match &end.collision {
                None => path.vertex(self.scene(), &end.surface, bsdf, LightGroup::default()),
                Some(at) => path.vertex_in_medium(self.scene(), at, LightGroup::default()),
            };
            if visible.albedo.is_none() && self.view.wants_albedo() && !bsdf.is_delta() {
                visible.albedo = Some(in_white_light(bsdf.albedo(z.local(z.wo).wo), wavelengths));
            }
            if self.settings.only_from_lights {
                break;
            }
            if let Some(merging) = carried.techniques.merging() {
                self.merge(&end, &mut z, merging, observer, found);
            }
            if !z.is_delta() {
                self.connect_vertex(&mut end, &z, light_path, observer, found);
            }
            let (collision, roulette) = (end.collision.as_ref(), self.settings.roulette);
            let goes_on = carried.techniques.needs_camera_vertex_after(end.t)
                && end.path.scatter_at(&z, &end.surface, collision, roulette, observer);
            if !goes_on {
                break;
            }
            end.from = Some(z);
            end.t += 1;
        }
        if V::HAS_MEDIA && end.visible.begins_in_medium {
            end.visible.first = None;
        }
        end.visible
    }

    /// Follows the camera's path to its next vertex, and hands over the light that it hits before (`s = 0`). Returns
    /// the scattering there, that of nothing in a medium; `None` where the path ends.
    fn next_vertex<O: PathObserver, T: Techniques<Merging>>(
        &self,
        end: &mut CameraEnd<'_, '_, 'a, V, T>,
        observer: &mut O,
        found: &mut impl FnMut(Contribution, &Wavelengths),
    ) -> Option<Bsdf<'a>> {
        let scene = self.scene();
        let CameraEnd { path, surface, from, t, visible, collision, camera_ray, carried } = end;
        let wavelengths = carried.wavelengths;
        if V::HAS_MEDIA {
            *collision = None;
        }
        let (is_last, hits) = (*t == self.longest(), carried.techniques.has(0, *t));
        let mut hit = |light: Contribution, observer: &mut O| {
            if hits {
                observer.emitter_met(|| light.value(wavelengths));
                found(light, wavelengths);
            }
        };
        loop {
            let event = advance(scene, &mut path.state, surface, &mut visible.first, observer);
            if V::HAS_MEDIA && !path.state.emitted.is_black() {
                hit(path.medium_contribution(scene), observer);
            }
            match event {
                Event::Surface => {}
                Event::Escaped(d) => {
                    self.hit_background(path, d, camera_ray, from.as_ref(), |far| hit(far, observer));
                    return None;
                }
                Event::Medium(at) if V::HAS_MEDIA => {
                    if *t == 2 {
                        self.set_first_pdf(path, camera_ray, at.p);
                        visible.begin_in_medium();
                    }
                    *collision = Some(at);
                    return (!is_last).then_some(Bsdf::Null);
                }
                Event::Medium(_) | Event::Absorbed => return None,
            }
            if *t == 2 {
                self.set_first_pdf(path, camera_ray, surface.at.point.p);
            }
            if let Some(light) = self.hit_emission(path, &surface.at, surface.wo, camera_ray, from.as_ref()) {
                hit(light, observer);
            }
            // The last surface may be a hole or a pane.
            if is_last && !scene.appearance.has_passages {
                return None;
            }
            let mut bsdf = shade_one_way(scene, &mut path.state, surface);
            if !pass_straight(scene, &mut path.state, surface, &mut bsdf) {
                return (!is_last).then_some(bsdf);
            }
            if path.state.scatterings == 0 && matches!(bsdf, Bsdf::Null) {
                visible.first = None;
            }
        }
    }

    /// Notes the density of the first point that the camera's ray comes to. Seen from the light's side the lens is one more point to
    /// connect with. [Georgiev 2012, eq. 31]
    #[inline]
    fn set_first_pdf(&self, path: &mut Subpath<'_>, camera_ray: &Ray, p: Vec3) {
        let pdf = self.view.pdf_across(camera_ray, p);
        match pdf.filter(|_| self.connects()) {
            Some(pdf) => path.last.pdf = weighted_pdf_across(pdf),
            None => path.state.connectable = false,
        }
    }

    /// Whether light from an emitter is found from the camera alone.
    fn is_hidden(&self, at: &LightPoint) -> bool {
        self.in_endless_air && at.is_infinite()
    }

    /// Joins a vertex of the camera's path with a light and media that emit, drawn for it (`s = 1`), and with all vertices of the light's path
    /// (`s > 1`).
    fn connect_vertex<O: PathObserver, T: Techniques<Merging>>(
        &self,
        end: &mut CameraEnd<'_, '_, 'a, V, T>,
        z: &Vertex<'a, V>,
        light_path: &[Vertex<'a, V>],
        observer: &mut O,
        found: &mut impl FnMut(Contribution, &Wavelengths),
    ) {
        let (t, carried) = (end.t, end.carried);
        let wavelengths = carried.wavelengths;
        if carried.techniques.has(1, t)
            && let Some(lit) = self.direct_light(&mut end.path.state, z, t, observer)
        {
            found(lit, wavelengths);
        }
        let draws = &mut end.path.state.draws;
        for (s, y) in (2..=self.longest() - t).zip(light_path) {
            if carried.techniques.has(s, t)
                && let Some(joined) = self.join(y, z, VertexCounts { s, t }, carried, draws, observer)
            {
                found(joined, wavelengths);
            }
        }
        if V::HAS_MEDIA && carried.techniques.has(1, t) {
            self.add_volume_light(end, z, observer, found);
        }
    }
}

impl<'a, V: Volume<'a>> Bidirectional<'a, V> {
    /// Hands over the light of media that comes directly to a vertex of the camera's path.
    #[inline(never)]
    fn add_volume_light<O: PathObserver, T: Techniques<Merging>>(
        &self,
        end: &CameraEnd<'_, '_, 'a, V, T>,
        z: &Vertex<'a, V>,
        observer: &mut O,
        found: &mut impl FnMut(Contribution, &Wavelengths),
    ) {
        let technique = VertexCounts { s: 1, t: end.t };
        let hit = end.path.hit(Spectrum::BLACK, LightGroup::default(), 1.0);
        let (scene, collision) = (self.scene(), end.collision.as_ref());
        end.path.volume_light(scene, z, &end.surface, collision, observer, |light, wavelengths, observer| {
            let secondary_terminated = wavelengths.secondary_terminated();
            let contribution = Contribution { technique, light, secondary_terminated, ..hit };
            observer.emitter_met(|| contribution.value(end.carried.wavelengths));
            found(contribution, end.carried.wavelengths);
        });
    }
}

/// Light that leaves a light chosen by its power; `None` where none does.
///
/// Leaves one number out and takes four.
#[inline]
pub(super) fn sample_emitted(
    scene: &Scene,
    lights: &PowerLightSampler,
    time: f32,
    wavelengths: &Wavelengths,
    draws: &mut SampleStream<'_>,
) -> Option<(SampledLight, LightLeSample)> {
    draws.skip(1);
    let [position, direction] = [draws.next_2d(), draws.next_2d()];
    let chosen = lights.sample(position.x)?;
    let numbers = LeNumbers { position: chosen.pair(position), direction };
    let emitted = scene.sample_le(chosen.light, time, numbers, wavelengths, lights.world())?;
    Some((chosen, emitted))
}

/// The beginning of a path from a light.
///
/// * `probability`: probability with which the light was chosen
pub(super) fn light_end<'s>(
    scene: &Scene,
    emitted: &LightLeSample,
    time: f32,
    probability: f32,
    wavelengths: &Wavelengths,
    draws: SampleStream<'s>,
) -> Subpath<'s> {
    let is_infinite = emitted.at.is_infinite();
    let LightEndPdf { end, onward } = LightEndPdf::new(emitted.pdf, is_infinite);
    let end = probability * end;
    // [Georgiev 2012, eq. 31 and 32], for lights without extent [eq. 48]
    let d_vcm = if emitted.is_delta { 0.0 } else { square(end).recip() };
    let last = subpath::LastVertex {
        p: emitted.at.p(),
        pdf: onward,
        is_parallel: is_infinite,
        cosine: emitted.cosine(),
        eta: 1.0,
        pdf_back: 0.0,
        mis: PartialMis { d_vcm, d_vc: 0.0 },
        merged: 0.0,
    };
    let power = emitted.power() * (1.0 / probability);
    let ray = emitted.ray(time);
    let media = match is_infinite {
        true => MediumStack::air(scene),
        false => MediumStack::around(scene, &ray, wavelengths),
    };
    let state = PathState::new(ray, *wavelengths, power, Transport::Importance, media, draws);
    let last = subpath::LastVertex { eta: media.eta(), ..last };
    Subpath { state: PathState { connectable: true, ..state }, last }
}

/// Whether the air is a medium without end.
pub(super) fn is_endless(scene: &Scene) -> bool {
    scene.lighting.air.is_some_and(|air| scene.appearance.media.bounds(air).is_none())
}

/// How a surface scatters, for a path that follows one wavelength from there on if it is refracted by wavelength.
pub(super) fn shade_one_way<'s>(
    scene: &'s Scene,
    path: &mut PathState<'_>,
    surface: &SurfaceInteraction,
) -> Bsdf<'s> {
    if surface.is_dispersive() {
        path.end_secondary_wavelengths();
    }
    shade(scene, path, surface)
}

impl<'a, V: ReusedVolume<'a>> Bidirectional<'a, V> {
    /// As [`Integrator::observe`], with vertices merged or not.
    pub(super) fn observe_merging<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        raster: Vec2,
        merging: Option<&Merging>,
        observer: &mut O,
    ) -> PixelSample {
        self.observe_techniques(ctx, raster, AllTechniques(merging), observer)
    }

    /// As [`Integrator::observe`] by these techniques.
    fn observe_techniques<O: PathObserver, T: Techniques<Merging>>(
        &self,
        ctx: &mut SampleContext<'_>,
        raster: Vec2,
        techniques: T,
        observer: &mut O,
    ) -> PixelSample {
        let SampleContext { draws, aux, splats, scratch, .. } = ctx;
        let mut path = V::reused(mem::take(scratch.get::<Vec<Vertex<'static, V::Kept>>>()));
        let mut radiance = [0.0; 3];
        let mut groups = [[0.0; 3]; MAX_LIGHT_GROUPS];
        let visible =
            self.estimate(*draws, observer, raster, &mut path, techniques, &mut |found, wavelengths| {
                let value = found.value(wavelengths);
                match found.raster {
                    Some(raster) => splats.add(raster, value),
                    None => {
                        for sum in [&mut radiance, &mut groups[found.group.index()]] {
                            *sum = [0, 1, 2].map(|i| sum[i] + value[i]);
                        }
                    }
                }
            });
        *scratch.get::<Vec<Vertex<'static, V::Kept>>>() = emptied(path);
        if self.view.wants_light_groups() {
            aux.lights = groups;
        }
        if self.view.wants_albedo() {
            aux.albedo = visible.albedo.unwrap_or_default();
        }
        PixelSample { radiance, first: visible.first.map(|at| self.view.first_hit(&at, aux)) }
    }
}

impl<'a, V: ReusedVolume<'a>> Integrator for Bidirectional<'a, V> {
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        _pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        self.observe_merging(ctx, raster, None, observer)
    }
}

/// Takes samples by one technique alone.
pub(super) trait SingleTechnique: Sync {
    /// The light that a sample finds by the technique, with its weight among all of them; as [`PixelIntegrator::sample`].
    fn sample_by(&self, ctx: &mut SampleContext<'_>, raster: Vec2, technique: VertexCounts) -> PixelSample;
}

impl<'a, V: ReusedVolume<'a>> SingleTechnique for Bidirectional<'a, V> {
    fn sample_by(&self, ctx: &mut SampleContext<'_>, raster: Vec2, technique: VertexCounts) -> PixelSample {
        let mut counting = Counting::new(ctx);
        let sample = self.observe_techniques(ctx, raster, technique, &mut counting);
        ctx.rays = counting.rays;
        sample
    }
}

#[cfg(test)]
mod tests;
