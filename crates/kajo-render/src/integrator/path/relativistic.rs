//! Path tracing between things that move at speeds not much below that of light.
//!
//! A path is at an event of one inertial frame at a time. Its ray is followed in all of them [`Scene::trace_light`], and it goes on in
//! that of the surface that it hits, where it is scattered as ever: directions, normals, lengths and densities are those of that frame.
//! With the Doppler factor `D = ν / ν'` of light that goes from frame `'` to the one before along the path,
//!
//! ```text
//! L(λ) = D^5 L'(D λ)            radiance per wavelength, by wavelength
//! L    = D^4 L'                 in red, green and blue, as if it were all of the light
//! p(ω) = D^2 p'(ω')             densities per solid angle
//! ```
//!
//! [Rybicki and Lightman 1979, eq. 4.110], [Weiskopf 2001]. So `beta` takes the first factor at every change of frame, the
//! wavelengths of the path are multiplied by `D`, and a black body of the temperature `T` looks exactly like one of `D T`.
//!
//! Light is drawn in the frame of the emitter for the event of the receiver there: what the emitter sends to it left at the retarded moment, which
//! is no other for the emitter at rest. A shadow ray is light too, tested in every frame.
//!
//! Direct light is a sum over frames: at each vertex the integral over directions of the light of each frame's emitters
//! is estimated by one of them, drawn with the density `q` per solid angle of the vertex's frame, and weighed against
//! the density `p` of scattering by the power heuristic as in path tracing. Light of one emitter belongs to one term,
//! so light that the path hits is weighed against the draw in the emitter's own frame.

use kajo_color::{Spectrum, sensor};
use kajo_core::bsdf::{Bsdf, Transport};
use kajo_core::camera::Camera;
use kajo_core::ids::FrameId;
use kajo_core::interaction::SurfacePoint;
use kajo_core::light::{LightHit, LightPoint, LightSelection, MAX_LIGHT_GROUPS, Receiver};
use kajo_core::scene::{Interaction, LightRay, Relativity, Scene};
use kajo_core::settings::{Directions, Technique};
use kajo_core::{LightGroup, LightIndex};
use kajo_math::lorentz::SpacetimeEvent;
use kajo_math::robust::offset_origin;
use kajo_math::{DQuat, DVec3, Ray, Vec2, Vec3};

use super::tracer::{CameraPath, Shaded, receiver, weight_of_hit};
use super::{PathSettings, directions, directions::Part};
use crate::integrator::Integrator;
use crate::integrator::camera_view::{CameraView, in_white_light};
use crate::integrator::transport::steps::MOST_SURFACES;
use crate::integrator::transport::{
    Event, LocalFrame, MediumStack, PathState, SurfaceInteraction, TracedSegment, arrive, cross_hidden,
    pass_straight, power_heuristic, radiance_factor, shade, sky_footprint,
};
use crate::trail::{About, PathObserver, RayKind};
use crate::{LayerSet, PixelSample, SampleContext};

/// The path tracer of a scene in which something moves that fast, or the camera does.
pub struct RelativisticPath<'a> {
    view: CameraView<'a>,
    all: &'a Relativity,
    settings: PathSettings,
    /// Frames that have lights.
    lit: Vec<FrameId>,
    /// Where the camera is, unless it moves.
    pivot: Option<Vec3>,
}

impl<'a> RelativisticPath<'a> {
    /// * `all`: the frames of the scene
    /// * the rest: as for [`super::Path::through`]
    pub fn new(
        camera: &'a Camera,
        scene: &'a Scene,
        all: &'a Relativity,
        settings: PathSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> RelativisticPath<'a> {
        // One path from each sample, whose directions are drawn by scattering.
        let settings = PathSettings { branches: 1, directions: Directions::Scattering, ..settings };
        let view = CameraView::new(scene, camera, size, layers).spectral(settings.spectral);
        let lit = all.ids().filter(|&frame| !scene.lights_of(frame).is_empty()).collect();
        let pivot = if camera.moves() { None } else { view.pivot(0.0) };
        RelativisticPath { view, all, settings, lit, pivot }
    }
}

impl Integrator for RelativisticPath<'_> {
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        _pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        let mut draws = ctx.draws;
        let differential = self.view.differential(raster, draws, ctx.sampler.samples());
        let Some(ray) = self.view.ray(raster, &mut draws) else { return PixelSample::default() };
        let wavelengths = self.view.wavelengths(&mut draws);
        let media = self.view.media_around(&ray, &wavelengths);
        let mut state = PathState::new(ray, wavelengths, Spectrum::WHITE, Transport::Radiance, media, draws);
        state.differential = differential;
        observer.counters().camera += 1;
        let pivot = self.pivot.or_else(|| self.view.pivot(ray.time)).unwrap_or(ray.o);
        let seen = self.all.observed(&ray, pivot);
        let found = FrameEstimate {
            groups: self.view.wants_light_groups().then_some([[0.0; 3]; MAX_LIGHT_GROUPS]),
            ..FrameEstimate::default()
        };
        let mut path = FramePath {
            path: CameraPath::new(state, &self.settings),
            frame: FrameId::WORLD,
            t: seen.t,
            vertex: Vertex::default(),
            since_vertex: 1.0,
            camera_length_ratio: 1.0,
        };
        // From the camera's own frame, which is the world's where the camera is at rest.
        if self.all.observer.velocity != DVec3::ZERO {
            path.change_frame(&seen);
        }
        let mut tracer = Tracer { integrator: self, observer, found };
        tracer.run(&mut path);
        let found = tracer.found;
        if self.view.wants_albedo() {
            ctx.aux.albedo = in_white_light(found.albedo.unwrap_or(Spectrum::BLACK), &wavelengths);
        }
        if let Some(groups) = found.groups {
            ctx.aux.lights = groups;
        }
        let first = found.first.as_ref().map(|at| self.view.first_hit(at, &mut ctx.aux));
        PixelSample { radiance: found.rgb, first }
    }
}

/// Where a path was scattered last.
#[derive(Clone, Copy, Default)]
struct Vertex {
    frame: FrameId,
    t: f64,
}

/// A path, at an event of a frame.
struct FramePath<'s> {
    /// In the coordinates of the frame, with the wavelengths that its light has there.
    path: CameraPath<'s>,
    frame: FrameId,
    /// The moment at the origin of the ray.
    t: f64,
    /// Where `path.receiver` is.
    vertex: Vertex,
    /// The frequency that light of the ray has at that vertex over the one that it has here.
    since_vertex: f32,
    /// Lengths of the camera's own frame over those along the ray, as long as that is the camera's.
    camera_length_ratio: f32,
}

impl FramePath<'_> {
    /// Goes on in the frame of a ray that is the path's own, with its parameter.
    fn enter(&mut self, own: &LightRay) {
        if own.frame != self.frame {
            self.change_frame(own);
        }
    }

    /// Goes on with a ray that is the path's own in another frame than before.
    fn change_frame(&mut self, own: &LightRay) {
        let doppler = 1.0 / own.ray.d.length();
        let state = &mut self.path.state;
        let d = own.ray.d * doppler;
        if let Some(differential) = &mut state.differential {
            // Aberration keeps angles between directions that are near each other, and solid angles are `D^2` times as large.
            let turn = DQuat::from_rotation_arc(state.ray.d.as_dvec3(), d.as_dvec3());
            let seen = |dd: Vec3| doppler * (turn * dd.as_dvec3()).as_vec3();
            differential.dd = differential.dd.map(seen);
        }
        state.ray = Ray { d, ..own.ray };
        (self.frame, self.t) = (own.frame, own.t);
        state.shift_frequency(doppler);
        self.since_vertex *= doppler;
        self.camera_length_ratio *= doppler;
    }

    fn light(&self) -> LightRay {
        LightRay { frame: self.frame, ray: self.path.state.ray, t: self.t }
    }

    /// The vertex before in another frame, for light of that.
    fn receiver_in(&self, all: &Relativity, frame: FrameId) -> Receiver {
        receiver_in(all, &self.path.receiver, self.vertex, frame).0
    }
}

/// A receiver in another frame, and its moment there. Planes of one frame are none of another, so it has no normal.
fn receiver_in(all: &Relativity, to: &Receiver, from: Vertex, frame: FrameId) -> (Receiver, f64) {
    let Vertex { frame: own, t } = from;
    if own == frame {
        return (*to, t);
    }
    let event = all.event(SpacetimeEvent { t, x: to.p.as_dvec3() }, own, frame);
    (Receiver { p: event.x.as_vec3(), n: Vec3::ZERO, time: to.time }, event.t)
}

/// What one sample has found so far.
#[derive(Default)]
struct FrameEstimate {
    /// Linear RGB, as the sensor sees it.
    rgb: [f32; 3],
    groups: Option<[[f32; 3]; MAX_LIGHT_GROUPS]>,
    first: Option<Interaction>,
    albedo: Option<Spectrum>,
}

/// Light drawn in the frame of its emitter.
struct FrameLightSample {
    light: LightIndex,
    group: LightGroup,
    /// Unit direction in the frame of the receiver.
    wi: Vec3,
    /// Radiance there; of a light without extent its irradiance.
    radiance: Spectrum,
    /// Density per solid angle there, and of the choice.
    pdf: f32,
    is_delta: bool,
    /// The segment to it, from clear of the surface, in the frame of the receiver and in that of the emitter.
    here: LightRay,
    there: LightRay,
}

struct Tracer<'a, 'o, O: PathObserver> {
    integrator: &'a RelativisticPath<'a>,
    observer: &'o mut O,
    found: FrameEstimate,
}

impl<O: PathObserver> Tracer<'_, '_, O> {
    fn scene(&self) -> &Scene {
        self.integrator.view.scene
    }

    /// Follows a path until it ends.
    fn run(&mut self, path: &mut FramePath<'_>) {
        let scene = self.integrator.view.scene;
        let mut surface = SurfaceInteraction::default();
        loop {
            match self.advance(path, &mut surface) {
                Event::Surface => {}
                Event::Escaped(d) => return self.add_background(path, d),
                Event::Medium(_) | Event::Absorbed => return,
            }
            self.add_emission(path, &surface);
            if path.path.ends_at_lights && !scene.appearance.has_passages {
                return;
            }
            if surface.is_dispersive() {
                path.path.state.end_secondary_wavelengths();
            }
            let mut bsdf = shade(scene, &path.path.state, &surface);
            if pass_straight(scene, &mut path.path.state, &surface, &mut bsdf) {
                if path.path.state.scatterings == 0 && matches!(bsdf, Bsdf::Null) {
                    self.found.first = None;
                }
            } else if path.path.ends_at_lights || !self.scatter(path, &surface, &bsdf) {
                return;
            }
        }
    }

    /// Follows the path to the next surface that is there, and into its frame, as [`crate::integrator::transport::advance`].
    fn advance(&mut self, path: &mut FramePath<'_>, surface: &mut SurfaceInteraction) -> Event<'static> {
        loop {
            let event = self.extend(path, surface);
            if !matches!(event, Event::Surface) {
                return event;
            }
            if !cross_hidden(&mut path.path.state, surface, self.observer) {
                return event;
            }
        }
    }

    fn extend(&mut self, path: &mut FramePath<'_>, surface: &mut SurfaceInteraction) -> Event<'static> {
        let (scene, all) = (self.integrator.view.scene, self.integrator.all);
        let state = &mut path.path.state;
        if state.surfaces == MOST_SURFACES || !state.beta.is_finite() {
            return Event::Absorbed;
        }
        state.surfaces += 1;
        // Where light is slower it is light in the frame of the body alone.
        let eta = state.media.eta();
        let only = (eta != 1.0).then_some(path.frame);
        let light = path.light();
        let found = scene.trace_light(all, &light, only, &mut surface.at);
        self.tell(path, &light, found.as_ref(), surface);
        let Some(own) = found else {
            path.enter(&all.ray(&light, FrameId::WORLD));
            return Event::Escaped(path.path.state.ray.d);
        };
        let s = surface.at.hit.t;
        if self.found.first.is_none() {
            let mut first = surface.at;
            first.hit.t = s * path.camera_length_ratio;
            self.found.first = Some(first);
        }
        path.enter(&own);
        path.t = own.time_at(s, eta);
        let state = &mut path.path.state;
        let wo = -state.ray.d;
        arrive(scene, state, surface, TracedSegment { wo, length: s });
        Event::Surface
    }

    /// Reports a ray to the observer, in the world's coordinates.
    fn tell(
        &mut self,
        path: &FramePath<'_>,
        light: &LightRay,
        found: Option<&LightRay>,
        surface: &SurfaceInteraction,
    ) {
        let (scene, all) = (self.integrator.view.scene, self.integrator.all);
        let ray = all.ray(light, FrameId::WORLD).ray;
        let end = found.map(|_| {
            let mut at = surface.at;
            at.point.p = ray.at(at.hit.t);
            at
        });
        let state = &path.path.state;
        self.observer.ended(scene, &ray, end.as_ref(), || About {
            eta: state.media.eta(),
            weight: sensor::to_rgb(state.beta, &path.path.state.wavelengths),
            light: None,
        });
    }

    /// Adds the light that arrives directly and goes on from a surface; `false` when the path ends here.
    fn scatter(&mut self, path: &mut FramePath<'_>, surface: &SurfaceInteraction, bsdf: &Bsdf) -> bool {
        let (scene, settings) = (self.integrator.view.scene, &self.integrator.settings);
        let local = LocalFrame::new(&scene.shading(&surface.at, surface.u), surface.wo);
        let bumped = local.bumped(bsdf);
        let bsdf = bumped.as_ref().unwrap_or(bsdf);
        let is_delta = bsdf.is_delta();
        if self.found.albedo.is_none() && self.integrator.view.wants_albedo() && !is_delta {
            self.found.albedo = Some(bsdf.albedo(local.wo));
        }
        let shaded = Shaded { surface, bsdf, local: &local };
        if !is_delta && settings.technique != Technique::Scattering {
            for i in 0..self.integrator.lit.len() {
                self.add_direct_light(path, shaded, self.integrator.lit[i]);
            }
        }
        path.vertex = Vertex { frame: path.frame, t: path.t };
        path.since_vertex = 1.0;
        path.camera_length_ratio = 0.0;
        // What a pixel covers of the sky is known to camera rays alone: surfaces were met in frames of their own.
        path.path.state.differential = None;
        path.path.go_on(scene, settings, shaded, Part::All, self.observer)
    }

    /// Light of an emitter of some frame for a surface, whether or not anything is in the way; `None` where none can arrive.
    ///
    /// Takes three numbers. The first one is left out; the other two are for the light and the position on it.
    fn sample_light(
        &self,
        path: &mut FramePath<'_>,
        shaded: Shaded<'_>,
        frame: FrameId,
    ) -> Option<FrameLightSample> {
        let (scene, all) = (self.scene(), self.integrator.all);
        let Shaded { surface, local, .. } = shaded;
        let state = &mut path.path.state;
        state.draws.skip(1);
        let u = state.draws.next_2d();
        let own = receiver(surface, local);
        let vertex = Vertex { frame: path.frame, t: path.t };
        let (to, _) = receiver_in(all, &own, vertex, frame);
        let chosen = scene.lights_of(frame).sample(&to, u.x, self.integrator.settings.light_selection())?;
        let (u, alone) = (chosen.pair(u), LightSelection::TreeAlone);
        let mut li = scene.sample_li(chosen.light, &to, u, &state.wavelengths, alone)?;
        let seen = all.light(li.wi.as_dvec3(), frame, path.frame).as_vec3();
        let doppler = seen.length();
        if frame != path.frame && state.wavelengths.is_spectral() {
            // The same position on the emitter, at the wavelengths that it sends there.
            li = scene.sample_li(chosen.light, &to, u, &state.wavelengths.shifted(doppler), alone)?;
        }
        let wi = seen / doppler;
        let factor = match frame == path.frame {
            true => 1.0,
            false => radiance_factor(doppler, state.wavelengths.is_spectral()),
        };
        let point = &surface.at.point;
        let start = offset_origin(point.p, point.p_error, point.ng, wi);
        let clear = Receiver { p: start, ..own };
        let (clear, t) = receiver_in(all, &clear, vertex, frame);
        let segment = if frame == path.frame {
            point.ray_to(&li.at, li.wi, state.ray.time)
        } else {
            let point = SurfacePoint { p: clear.p, ..SurfacePoint::default() };
            point.ray_to(&li.at, li.wi, state.ray.time)
        };
        let there = LightRay { frame, ray: segment, t };
        let d = all.light(segment.d.as_dvec3(), frame, path.frame).as_vec3();
        let here = LightRay { frame: path.frame, ray: Ray { o: start, d, ..segment }, t: path.t };
        let drawn = FrameLightSample {
            light: chosen.light,
            group: scene.lighting.sampler.group(chosen.light),
            wi,
            radiance: li.radiance * factor,
            // p(ω) = D^2 p'(ω'); the choice of the light is a probability in any frame.
            pdf: li.pdf * chosen.probability * doppler * doppler,
            is_delta: li.is_delta,
            here,
            there,
        };
        (!drawn.radiance.is_black() && drawn.pdf > 0.0).then_some(drawn)
    }

    /// Direct light of the emitters of one frame by next-event estimation, as that of the path tracer.
    fn add_direct_light(&mut self, path: &mut FramePath<'_>, shaded: Shaded<'_>, frame: FrameId) {
        let (scene, all, settings) =
            (self.integrator.view.scene, self.integrator.all, &self.integrator.settings);
        let Some(drawn) = self.sample_light(path, shaded, frame) else { return };
        let Shaded { surface, bsdf, local } = shaded;
        let Some(wi) = local.to_local(drawn.wi) else { return };
        let scattered = bsdf.eval(local.wo, wi, Transport::Radiance);
        if scattered.is_black() {
            return;
        }
        let state = &path.path.state;
        let crosses = wi.z * local.wo.z < 0.0;
        let beyond = surface.interface.filter(|_| crosses).map(|interface| state.media.across(&interface));
        let media: &MediumStack = beyond.as_ref().unwrap_or(&state.media);
        // Light of another frame comes into a body through its surface, where it is refracted.
        if media.eta() != 1.0 && frame != path.frame {
            return;
        }
        let carried = state.beta * scattered * media.transmittance(drawn.here.ray.length());
        self.observer.counters().shadow += 1;
        let segment =
            |of: FrameId| if of == path.frame { drawn.here.ray } else { all.ray(&drawn.there, of).ray };
        let wavelengths = |of: FrameId| {
            let ratio = segment(of).d.length() / drawn.here.ray.d.length();
            state.wavelengths.shifted(1.0 / ratio)
        };
        let visible = scene.light_transmittance(all, segment, wavelengths);
        let about = || About {
            eta: media.eta(),
            weight: sensor::to_rgb(carried, &path.path.state.wavelengths),
            light: Some(scene.lighting.sampler.id(drawn.light)),
        };
        let weight = match settings.technique {
            Technique::Combined if !drawn.is_delta => {
                power_heuristic(drawn.pdf, directions::pdf(settings.directions, bsdf, local.wo, wi))
            }
            _ => 1.0,
        };
        let added = carried * drawn.radiance * visible * (weight / drawn.pdf);
        let rgb = || sensor::to_rgb(added, &path.path.state.wavelengths);
        let shown = all.ray(&drawn.there, FrameId::WORLD).ray;
        self.observer.joined(RayKind::Shadow, scene, &shown, about, rgb);
        if !visible.is_black() {
            self.add(path, added, drawn.group);
        }
    }

    /// The MIS weight of light that the path hit, as that of the path tracer. Densities are those at the vertex
    /// before.
    ///
    /// * `at`: the point of the light, in the path's frame
    /// * `d`: unit direction of the ray that hit it there
    fn mis_weight(&self, path: &FramePath<'_>, hit: &LightHit, at: &LightPoint, d: Vec3) -> f32 {
        let settings = &self.integrator.settings;
        weight_of_hit(settings.technique, path.path.state.connectable, || {
            let scene = self.scene();
            let to = path.receiver_in(self.integrator.all, path.frame);
            let choice = scene.lights_of(path.frame).pmf(hit.light, &to, settings.light_selection());
            let lights = &scene.lighting;
            let pdf_li = if choice > 0.0 {
                lights.lights.pdf_li(lights.sampler.id(hit.light), &to, at, d)
            } else {
                0.0
            };
            // [Veach 1997, eq. 9.15], both densities per solid angle of the frame of the vertex before.
            power_heuristic(path.path.pdf, choice * pdf_li * path.since_vertex * path.since_vertex)
        })
    }

    /// Light from infinitely far away, which rests in the world: `beta Le(d) w`.
    fn add_background(&mut self, path: &FramePath<'_>, d: Vec3) {
        let (scene, state) = (self.integrator.view.scene, &path.path.state);
        let footprint = sky_footprint(state);
        let through = path.receiver_in(self.integrator.all, FrameId::WORLD).p;
        let at = LightPoint::Infinite { through };
        for hit in scene.lights_at_infinity(d, &footprint, &state.wavelengths) {
            let weight = self.mis_weight(path, &hit, &at, d);
            self.add_hit(path, state.beta * hit.radiance * weight, hit.group);
        }
    }

    /// Light that the surface itself sends back along the path: `beta Le(wo) w`.
    fn add_emission(&mut self, path: &FramePath<'_>, surface: &SurfaceInteraction) {
        let (state, d) = (&path.path.state, -surface.wo);
        if let Some(hit) = self.scene().surface_light(&surface.at, d, &state.wavelengths) {
            let weight = self.mis_weight(path, &hit, &LightPoint::on(&surface.at.point), d);
            self.add_hit(path, state.beta * hit.radiance * weight, hit.group);
        }
    }

    /// Adds light that the path has hit.
    fn add_hit(&mut self, path: &FramePath<'_>, light: Spectrum, group: LightGroup) {
        self.observer.emitter_met(|| sensor::to_rgb(light, &path.path.state.wavelengths));
        self.add(path, light, group);
    }

    /// Adds light of a light group.
    fn add(&mut self, path: &FramePath<'_>, light: Spectrum, group: LightGroup) {
        if !light.is_finite() {
            return;
        }
        let rgb = sensor::to_rgb(light, &path.path.state.wavelengths);
        let add = |sum: &mut [f32; 3]| *sum = [0, 1, 2].map(|i| sum[i] + rgb[i]);
        add(&mut self.found.rgb);
        if let Some(groups) = &mut self.found.groups {
            add(&mut groups[group.index()]);
        }
    }
}
