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
//! s > 1, t = 1    a point of the light's path is seen by the camera; its light is a splat
//! s = 1, t = 1    a light drawn for a point of the lens, where that has an extent; its light is a splat, too
//! ```
//!
//! What can be found in several ways counts with the weights of the power heuristic; see `partial_mis.rs`. Light on its way
//! through glass to a matt surface, a caustic, is left to `t = 1`, which is where path tracing has no good way.
//!
//! Light tracing [Arvo 1986], [Dutré, Lafortune and Willems 1993] is what remains when `t = 1` alone is used, with weight
//! one. Lights and the background are then seen by the camera's own ray, and what is behind mirrors and glass
//! is not seen at all.

mod connect;
mod partial_mis;
mod settings;
mod subpath;
mod vertex;

use std::mem;

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::LightGroup;
use kajo_core::bsdf::{Bsdf, Transport};
use kajo_core::camera::Camera;
use kajo_core::light::{LeNumbers, LightLeSample, MAX_LIGHT_GROUPS, PowerLightSampler, SampledLight};
use kajo_core::sampler::SampleStream;
use kajo_core::scene::{Interaction, Scene};
use kajo_math::{Ray, Vec2};

use super::Integrator;
use super::camera_view::{CameraView, in_white_light};
use super::transport::{Event, MediumStack, PathState, SurfaceInteraction, advance, pass_straight, shade};
use crate::trail::{PathObserver, RayKind};
use crate::{LayerSet, PixelSample, SampleContext};
use connect::parts;
use partial_mis::{PartialMis, square, weighted_pdf_across};
pub use settings::{BIDIRECTIONAL, BidirectionalSettings, LIGHT};
pub(super) use subpath::Subpath;
pub(super) use vertex::Vertex;

/// The bidirectional path tracer over one scene and one picture size.
pub struct Bidirectional<'a> {
    view: CameraView<'a>,
    settings: BidirectionalSettings,
    power_sampler: PowerLightSampler,
}

/// The vertices of a path from a light, kept from sample to sample.
#[derive(Default)]
struct LightPath(Vec<Vertex<'static>>);

/// Light that was found in one way.
#[derive(Clone, Copy, Debug)]
struct Contribution {
    /// Vertices drawn from the light and from the camera.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests look at each way by itself"))]
    way: [u32; 2],
    /// Its estimate by this way alone.
    light: Spectrum,
    /// How much that counts.
    weight: f32,
    /// Whether only one wavelength is followed.
    is_single: bool,
    /// The light group.
    group: LightGroup,
    /// Where it is seen; with the camera's ray where absent.
    raster: Option<Vec2>,
}

impl Contribution {
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
struct VisibleSurface {
    first: Option<Interaction>,
    /// Linear RGB.
    albedo: Option<[f32; 3]>,
}

/// The path from the camera while it grows.
struct CameraEnd<'a, 's, 'b> {
    path: Subpath<'s>,
    /// Where its ray ended.
    surface: SurfaceInteraction,
    /// The vertex before, where that is not the lens.
    from: Option<Vertex<'b>>,
    /// Vertices once the ray has ended, the lens included.
    t: u32,
    visible: VisibleSurface,
    /// The camera's ray, and the wavelengths that the sample began with.
    began: (&'a Ray, &'a Wavelengths),
}

impl<'a> Bidirectional<'a> {
    /// The integrator for a picture of `size` pixels with these `layers`.
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
        Bidirectional {
            view: CameraView::new(scene, camera, size, layers).spectral(settings.spectral),
            settings,
            power_sampler: scene.power_light_sampler(),
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

    /// Hands all light that one sample finds to `found`.
    fn estimate<O: PathObserver>(
        &self,
        mut draws: SampleStream<'_>,
        observer: &mut O,
        raster: Vec2,
        light_path: &mut Vec<Vertex<'a>>,
        found: &mut impl FnMut(Contribution, &Wavelengths),
    ) -> VisibleSurface {
        light_path.clear();
        let from_light = draws.split(0, 0, 1);
        let Some(ray) = self.view.ray(raster, &mut draws) else { return VisibleSurface::default() };
        let wavelengths = self.view.wavelengths(&mut draws);
        let root = observer.mark();
        let mut from_light = self.follow_light(observer, light_path, from_light, ray.time, &wavelengths);
        if self.joins_lens() {
            let carried = (&wavelengths, ray.time);
            if let Some(seen) = self.light_on_lens(carried, &mut from_light, observer) {
                found(seen, &wavelengths);
            }
        }
        let seen = if self.connects() { &light_path[..] } else { &[] };
        for (s, y) in (2..).zip(seen) {
            observer.back_to_noted(s - 2);
            if let Some(seen) = self.splat(y, [s, 1], (&wavelengths, ray.time), &mut from_light, observer) {
                found(seen, &wavelengths);
            }
        }
        observer.back_to(root);
        self.follow_camera(observer, light_path, (draws, ray), &wavelengths, found)
    }

    /// Fills `vertices` with a path from a light. Returns the random numbers that are left.
    ///
    /// The path carries power: `beta` begins as `Le |cos| / (p_light p_place p_direction)`, and the power that arrives at a
    /// surface is scattered on by `f |cos| / p`.
    fn follow_light<'s, O: PathObserver>(
        &self,
        observer: &mut O,
        vertices: &mut Vec<Vertex<'a>>,
        mut draws: SampleStream<'s>,
        time: f32,
        wavelengths: &Wavelengths,
    ) -> SampleStream<'s> {
        let scene = self.scene();
        let world = self.power_sampler.world();
        draws.skip(1);
        let [position, direction] = [draws.next_2d(), draws.next_2d()];
        let Some(chosen) = self.power_sampler.sample(position.x) else { return draws };
        let SampledLight { light, probability, .. } = chosen;
        let numbers = LeNumbers { position: chosen.pair(position), direction };
        let Some(emitted) = scene.sample_le(light, time, numbers, wavelengths, world) else { return draws };
        let mut path = light_end(scene, &emitted, (time, probability), wavelengths, draws);
        let group = scene.lighting.sampler.group(light);
        observer.counters().light += 1;
        observer.next(RayKind::Light);
        let (mut surface, mut first) = (SurfaceInteraction::default(), None);
        while let Event::Surface = advance(scene, &mut path.state, &mut surface, &mut first, observer) {
            let mut bsdf = shade_one_way(scene, &mut path.state, &surface);
            if pass_straight(scene, &mut path.state, &surface, &mut bsdf) {
                continue;
            }
            if vertices.is_empty() {
                path.state.beta *= emitted.share_at(surface.at.point.p.distance(emitted.at.p()));
            }
            let mut vertex = path.vertex(scene, &surface, bsdf, group);
            if vertices.is_empty() {
                // A connection with the light itself draws a point anew. [Georgiev 2012, eq. 31]
                let wi = -emitted.d;
                let pdf_li = self.pdf_li(light, &vertex.receiver(time), &emitted.at, wi);
                let distance2 = emitted.at.p().distance_squared(vertex.at.p);
                let spread = emitted.at.solid_angle_per_area(wi, distance2);
                let end = probability * parts(emitted.pdf, emitted.at.is_infinite()).0;
                vertex.mis.d_vcm *= square(pdf_li * spread / end);
            }
            vertices.push(vertex);
            observer.note();
            let is_last = vertices.len() as u32 + 2 == self.longest();
            if is_last || !path.scatter(&vertex, &surface, self.settings.roulette, observer) {
                break;
            }
        }
        path.state.draws
    }

    /// Follows a path from the camera and connects each of its vertices with the light's path.
    fn follow_camera<O: PathObserver>(
        &self,
        observer: &mut O,
        light_path: &[Vertex<'_>],
        (draws, ray): (SampleStream<'_>, Ray),
        wavelengths: &Wavelengths,
        found: &mut impl FnMut(Contribution, &Wavelengths),
    ) -> VisibleSurface {
        let media = self.view.media_around(&ray, wavelengths);
        let carried = (*wavelengths, Spectrum::WHITE);
        let state = PathState::new(ray, carried, Transport::Radiance, media, draws);
        let mut end = CameraEnd {
            path: Subpath::from_camera(PathState { connectable: true, ..state }),
            surface: SurfaceInteraction::default(),
            from: None,
            t: 2,
            visible: VisibleSurface::default(),
            began: (&ray, wavelengths),
        };
        observer.counters().camera += 1;
        observer.next(RayKind::Camera);
        while let Some(bsdf) = self.next_vertex(&mut end, observer, found) {
            let z = end.path.vertex(self.scene(), &end.surface, bsdf, LightGroup::default());
            let visible = &mut end.visible;
            if visible.albedo.is_none() && self.view.wants_albedo() && !bsdf.is_delta() {
                visible.albedo = Some(in_white_light(bsdf.albedo(z.local(z.wo).wo), wavelengths));
            }
            if self.settings.only_from_lights {
                break;
            }
            if !bsdf.is_delta() {
                self.connect_vertex(&mut end, &z, light_path, observer, found);
            }
            if !end.path.scatter(&z, &end.surface, self.settings.roulette, observer) {
                break;
            }
            end.from = Some(z);
            end.t += 1;
        }
        end.visible
    }

    /// Follows the camera's path to its next vertex, and hands over the light that it meets on its way there (`s = 0`). Returns
    /// the scattering there; `None` where the path ends.
    fn next_vertex<O: PathObserver>(
        &self,
        end: &mut CameraEnd<'_, '_, 'a>,
        observer: &mut O,
        found: &mut impl FnMut(Contribution, &Wavelengths),
    ) -> Option<Bsdf<'a>> {
        let scene = self.scene();
        let CameraEnd { path, surface, from, t, visible, began: (camera_ray, wavelengths) } = end;
        let is_last = *t == self.longest();
        loop {
            match advance(scene, &mut path.state, surface, &mut visible.first, observer) {
                Event::Surface => {}
                Event::Escaped(d) => {
                    self.met_background(path, d, (camera_ray, from.as_ref()), |far| {
                        observer.found(|| far.value(wavelengths));
                        found(far, wavelengths);
                    });
                    return None;
                }
                // Its paths carry no media.
                Event::Medium(_) | Event::Absorbed => return None,
            }
            if *t == 2 {
                // Seen from the light's side the lens is one more point to connect with. [Georgiev 2012, eq. 31]
                let pdf = self.view.pdf_across(camera_ray, surface.at.point.p);
                match pdf.filter(|_| self.connects()) {
                    Some(pdf) => path.departure.pdf = weighted_pdf_across(pdf),
                    None => path.state.connectable = false,
                }
            }
            if let Some(met) = self.met_emission(path, &surface.at, surface.wo, (camera_ray, from.as_ref())) {
                observer.found(|| met.value(wavelengths));
                found(met, wavelengths);
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

    /// Joins a vertex of the camera's path with a light drawn for it (`s = 1`) and with all vertices of the light's path
    /// (`s > 1`).
    fn connect_vertex<O: PathObserver>(
        &self,
        end: &mut CameraEnd<'_, '_, 'a>,
        z: &Vertex<'_>,
        light_path: &[Vertex<'_>],
        observer: &mut O,
        found: &mut impl FnMut(Contribution, &Wavelengths),
    ) {
        let (t, (ray, wavelengths)) = (end.t, end.began);
        if let Some(lit) = self.direct_light(&mut end.path.state, z, t, observer) {
            found(lit, wavelengths);
        }
        let draws = &mut end.path.state.draws;
        for (s, y) in (2..=self.longest() - t).zip(light_path) {
            if let Some(joined) = self.join([y, z], [s, t], (wavelengths, ray.time), draws, observer) {
                found(joined, wavelengths);
            }
        }
    }
}

/// The beginning of a path from a light.
///
/// * `chance`: probability with which the light was chosen
pub(super) fn light_end<'s>(
    scene: &Scene,
    emitted: &LightLeSample,
    (time, chance): (f32, f32),
    wavelengths: &Wavelengths,
    draws: SampleStream<'s>,
) -> Subpath<'s> {
    let is_infinite = emitted.at.is_infinite();
    let (end, pdf) = parts(emitted.pdf, is_infinite);
    let end = chance * end;
    // [Georgiev 2012, eq. 31 and 32], for lights without extent [eq. 48]
    let d_vcm = if emitted.is_delta { 0.0 } else { square(end).recip() };
    let departure = subpath::Departure {
        p: emitted.at.p(),
        pdf,
        is_parallel: is_infinite,
        cosine: emitted.cosine(),
        eta: 1.0,
        pdf_back: 0.0,
        mis: PartialMis { d_vcm, d_vc: 0.0 },
    };
    let carried = (*wavelengths, emitted.power() * (1.0 / chance));
    let ray = emitted.ray(time);
    let media = match is_infinite {
        true => MediumStack::default(),
        false => MediumStack::around(scene, &ray, wavelengths),
    };
    let state = PathState::new(ray, carried, Transport::Importance, media, draws);
    let departure = subpath::Departure { eta: media.eta(), ..departure };
    Subpath { state: PathState { connectable: true, ..state }, departure }
}

/// How a surface scatters, for a path that follows one wavelength from there on if it is refracted by wavelength.
pub(super) fn shade_one_way<'s>(
    scene: &'s Scene,
    path: &mut PathState<'_>,
    surface: &SurfaceInteraction,
) -> Bsdf<'s> {
    if surface.is_dispersive() {
        path.wavelengths.terminate_secondary();
    }
    shade(scene, path, surface)
}

impl LightPath {
    /// Keeps the memory of a path that has been followed.
    fn keep(&mut self, mut path: Vec<Vertex<'_>>) {
        path.clear();
        // Nothing is left that could borrow from a scene; collecting reuses the memory.
        self.0 = path.into_iter().map_while(|_| None).collect();
    }
}

impl Integrator for Bidirectional<'_> {
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        _pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        let SampleContext { draws, aux, splats, scratch, .. } = ctx;
        let mut path: Vec<Vertex<'_>> = mem::take(&mut scratch.get::<LightPath>().0);
        let mut radiance = [0.0; 3];
        let mut groups = [[0.0; 3]; MAX_LIGHT_GROUPS];
        let visible = self.estimate(*draws, observer, raster, &mut path, &mut |found, wavelengths| {
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
        scratch.get::<LightPath>().keep(path);
        if self.view.wants_light_groups() {
            aux.lights = groups;
        }
        if self.view.wants_albedo() {
            aux.albedo = visible.albedo.unwrap_or_default();
        }
        PixelSample { radiance, first: visible.first.map(|at| self.view.first_hit(&at, aux)) }
    }
}

#[cfg(test)]
mod tests;
