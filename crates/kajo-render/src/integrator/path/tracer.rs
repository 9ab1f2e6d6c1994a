//! One sample of the path tracer: a path from the camera and what branches off it.

mod casters;
mod caustics;
mod colors;
mod crossed;
mod guided;
mod indirect;
mod through_media;
mod volumes;

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::LightGroup;
use kajo_core::bsdf::{Bsdf, BsdfSample, Transport};
use kajo_core::differential::SkyFootprint;
use kajo_core::interaction::SurfacePoint;
use kajo_core::light::{LightHit, LightPoint, LightSelection, MAX_LIGHT_GROUPS, Receiver};
use kajo_core::scene::{Interaction, Scene};
use kajo_core::settings::{Directions, Technique};
use kajo_math::{Ray, Vec3};

use super::PathSettings;
use super::directions::{self, Part};
use crate::integrator::camera_view::CameraView;
use crate::integrator::transport::{
    CollisionOnRay, DrawnLight, EquiangularRay, Event, Joining, LocalFrame, MediumInteraction, MediumStack,
    PathState, SurfaceInteraction, advance, choose_light, connect, connect_through_media, follow,
    follow_phase, lane_densities, leave, light_of_choice, pass_straight, power_heuristic, sample_light,
    shade, sky_footprint, survives, survives_guided, survives_in_medium,
};
use crate::trail::{About, PathObserver, RayKind};
pub use casters::Casters;
pub use caustics::ThroughGlass;
use colors::SplitPath;
pub use indirect::{DiffuseVertex, GuidedDirection, Indirect, IndirectLight, Sampled, Worth};

/// A path from the camera, and what the weights of the light that it hits go by.
#[derive(Clone, Copy)]
pub(in crate::integrator) struct CameraPath<'s> {
    pub state: PathState<'s>,
    /// The last vertex.
    pub receiver: Receiver,
    /// Density per solid angle with which the ray's direction was drawn there.
    pub pdf: f32,
    /// Scatterings that count.
    bounces: u32,
    /// Mirrors that may still be met before the first bounce without counting as one.
    free_mirrors: u32,
    /// Whether the ray is followed for lights that it may meet, and no further.
    pub ends_at_lights: bool,
    /// Whether the path has branched off another.
    is_branch: bool,
    /// The ray at hand, where light was drawn for a point along it.
    along: Option<EquiangularRay>,
    /// The last collision, where light was drawn for a point along the ray to it.
    collided: Option<CollisionOnRay>,
    /// Surfaces that were met by a path that media scatter.
    surfaces: u32,
}

impl<'s> CameraPath<'s> {
    #[inline(always)]
    pub fn new(state: PathState<'s>, settings: &PathSettings) -> CameraPath<'s> {
        CameraPath {
            state,
            receiver: Receiver::default(),
            pdf: 0.0,
            bounces: 0,
            free_mirrors: settings.free_mirrors,
            ends_at_lights: false,
            is_branch: false,
            along: None,
            collided: None,
            surfaces: 0,
        }
    }

    /// A path that goes on from a surface which has scattered it once.
    pub fn from_surface(state: PathState<'s>) -> CameraPath<'s> {
        CameraPath {
            state,
            receiver: Receiver::default(),
            pdf: 0.0,
            bounces: 1,
            free_mirrors: 0,
            ends_at_lights: false,
            is_branch: false,
            along: None,
            collided: None,
            surfaces: 0,
        }
    }

    /// Takes the path along a direction drawn by the surface's scattering, or by a rule of the settings; `false` when it
    /// ends.
    ///
    /// Takes two numbers for the direction, one more where scattering has parts to choose from, and one for roulette where it
    /// is played.
    pub fn go_on(
        &mut self,
        scene: &Scene,
        settings: &PathSettings,
        at: Shaded<'_>,
        part: Part,
        observer: &mut impl PathObserver,
    ) -> bool {
        let Shaded { bsdf, local, .. } = at;
        let state = &mut self.state;
        let (u, choice) = (state.draws.next_2d(), state.draws.number_if(bsdf.is_choosy()));
        let drawn = match (part, settings.directions) {
            (Part::Diffuse, Directions::Cosine | Directions::Uniform) => {
                directions::sample(settings.directions, bsdf, local.wo, u, choice)
            }
            _ => bsdf.sample(local.wo, u, choice, Transport::Radiance),
        };
        let Some(sample) = drawn.filter(|sample| part.holds(sample)) else { return false };
        let Some(wi) = local.to_world(&sample) else { return false };
        self.go_along(scene, settings, at, SampledDirection { sample: &sample, wi }, observer)
            && survives(&mut self.state, self.bounces, settings.roulette)
    }

    /// Takes the path along a direction that was drawn, before roulette; `false` when it ends.
    #[inline(always)]
    fn go_along(
        &mut self,
        scene: &Scene,
        settings: &PathSettings,
        Shaded { surface, local, .. }: Shaded<'_>,
        SampledDirection { sample, wi }: SampledDirection<'_>,
        observer: &mut impl PathObserver,
    ) -> bool {
        let state = &mut self.state;
        let is_free = sample.kind.delta && self.bounces == 0 && self.free_mirrors > 0;
        if is_free {
            self.free_mirrors -= 1;
        }
        self.ends_at_lights =
            (self.bounces == settings.bounces && !is_free) || (settings.only_mirrors && !sample.kind.delta);
        if self.ends_at_lights && settings.technique == Technique::Lights && !sample.kind.delta {
            return false;
        }
        if state.differential.is_some() {
            leave(scene, state, surface, wi, sample);
        }
        follow(state, surface, wi, sample, observer);
        self.receiver = receiver(surface, local);
        self.pdf = sample.pdf;
        self.bounces += u32::from(!is_free);
        true
    }
}

/// A direction that was drawn at a surface.
#[derive(Clone, Copy)]
struct SampledDirection<'v> {
    sample: &'v BsdfSample,
    /// The direction in world space.
    wi: Vec3,
}

/// A surface and how it scatters.
#[derive(Clone, Copy)]
pub(in crate::integrator) struct Shaded<'v> {
    pub surface: &'v SurfaceInteraction,
    pub bsdf: &'v Bsdf<'v>,
    pub local: &'v LocalFrame,
}

/// A vertex at which a path forks, until all branches have been taken from it.
pub(in crate::integrator) struct Fork<'s, M> {
    path: CameraPath<'s>,
    surface: SurfaceInteraction,
    bsdf: Bsdf<'s>,
    local: LocalFrame,
    /// Branches into directions that are no mirror's; what goes on along single directions comes after them.
    branches: u32,
    /// How many of them have been taken.
    taken: u32,
    mark: M,
}

impl<'s, M> Fork<'s, M> {
    fn shaded(&self) -> Shaded<'_> {
        Shaded { surface: &self.surface, bsdf: &self.bsdf, local: &self.local }
    }

    /// Puts the next branch in the place of the path that has ended, and says which directions it goes on in.
    ///
    /// Wavelengths that the ended path no longer follows are followed no more, since the sensor has the light that was found
    /// under them. Without a split all that follows shares one sequence of random numbers.
    fn take(&mut self, path: &mut CameraPath<'s>) -> Part {
        let (n, i) = (self.branches, self.taken);
        self.taken += 1;
        let own = &self.path.state;
        let draws = match n {
            1 if i > 0 => path.state.draws,
            2.. if i < n => own.draws.split(0, i, n),
            _ => own.draws,
        };
        let state = PathState { wavelengths: path.state.wavelengths, draws, ..*own };
        *path = CameraPath { state, ..self.path };
        if i == n {
            return Part::Mirror;
        }
        path.state.beta *= 1.0 / n as f32;
        path.is_branch = true;
        Part::Diffuse
    }
}

/// What one sample has found so far.
#[derive(Clone, Copy)]
pub(in crate::integrator) struct Estimate {
    /// Light found under the present wavelengths.
    light: Spectrum,
    /// What the sensor has of light found under earlier ones, linear RGB.
    sensed: [f32; 3],
    /// The part of each light group, where that is asked for.
    pub groups: Option<[[f32; 3]; MAX_LIGHT_GROUPS]>,
    /// The first surface.
    pub first: Option<Interaction>,
    /// Whether light was scattered by a medium before that, so that what `first` has is none.
    begins_in_medium: bool,
    /// The albedo of the first surface that is no mirror.
    pub albedo: Option<Spectrum>,
}

/// Follows the paths of one sample.
pub(in crate::integrator) struct PathTracer<'a, 's, O: PathObserver, C> {
    view: &'a CameraView<'a>,
    settings: &'a PathSettings,
    /// How lights are chosen.
    lights: LightSelection<'a>,
    observer: &'a mut O,
    estimate: Estimate,
    indirect: C,
    /// The share that the path carries beyond the ray at hand, from a surface whose indirect light was known.
    beside: Option<Spectrum>,
    /// Vertices with branches that remain to be followed; those of the last one are next.
    forks: Vec<Fork<'s, O::Mark>>,
    /// The path whose colours are followed one after the other.
    split: Option<SplitPath<'s, O::Mark>>,
}

impl<'a: 's, 's, O: PathObserver, C: IndirectLight> PathTracer<'a, 's, O, C> {
    /// * `indirect`: a source of indirect light
    /// * `forks`: room for them
    pub fn new(
        view: &'a CameraView<'a>,
        settings: &'a PathSettings,
        observer: &'a mut O,
        indirect: C,
        forks: Vec<Fork<'s, O::Mark>>,
    ) -> PathTracer<'a, 's, O, C> {
        let groups = view.wants_light_groups().then_some([[0.0; 3]; MAX_LIGHT_GROUPS]);
        let (light, sensed) = (Spectrum::BLACK, [0.0; 3]);
        let begins_in_medium = false;
        let lights = settings.light_selection();
        let estimate = Estimate { light, sensed, groups, first: None, begins_in_medium, albedo: None };
        PathTracer { view, settings, lights, observer, estimate, indirect, beside: None, forks, split: None }
    }

    /// The same with another choice of lights than that of the settings.
    pub fn choosing(self, lights: LightSelection<'a>) -> PathTracer<'a, 's, O, C> {
        PathTracer { lights, ..self }
    }

    /// Follows a path and all that branches off it. Returns the light of it all as the sensor sees it, linear RGB, with
    /// what else was found.
    pub fn run(&mut self, mut path: CameraPath<'s>) -> ([f32; 3], &Estimate) {
        let mut surface = SurfaceInteraction::default();
        self.run_branch(&mut path, &mut surface);
        while self.take_color(&mut path) || self.take_branch(&mut path) {
            self.run_branch(&mut path, &mut surface);
        }
        if self.estimate.begins_in_medium {
            self.estimate.first = None;
        }
        (self.estimate.sensed_with(&path.state), &self.estimate)
    }

    /// The memory of the list of forks, and the source of indirect light.
    pub fn into_parts(self) -> (Vec<Fork<'s, O::Mark>>, C) {
        (self.forks, self.indirect)
    }

    fn scene(&self) -> &'a Scene {
        self.view.scene
    }

    /// Follows a path until it ends or forks.
    fn run_branch(&mut self, path: &mut CameraPath<'s>, surface: &mut SurfaceInteraction) {
        let scene = self.scene();
        loop {
            let event = match path.state.carries_media {
                false => advance(scene, &mut path.state, surface, &mut self.estimate.first, self.observer),
                true => self.advance_through_media(path, surface),
            };
            match event {
                Event::Surface => {}
                Event::Medium(at) => match self.scatter_in_medium(path, &at) {
                    true => continue,
                    false => return,
                },
                Event::Escaped(d) => return self.add_background(path, d),
                Event::Absorbed => return,
            }
            if path.state.carries_media {
                // How often media have scattered the path differs from sample to sample.
                path.surfaces += 1;
                path.state.draws.begin_part(path.surfaces);
            }
            if C::IS_ASKED {
                self.indirect.hit(path.bounces, Some(surface.at.point.p));
            }
            self.add_emission(path, surface);
            // The last surface may be a hole or a pane.
            if path.ends_at_lights && !scene.appearance.has_passages {
                return;
            }
            if surface.is_dispersive() {
                self.estimate.end_secondary_wavelengths(&mut path.state);
            }
            let mut bsdf = shade(scene, &path.state, surface);
            if pass_straight(scene, &mut path.state, surface, &mut bsdf) {
                if C::WALKS {
                    self.forget_crossed();
                }
                if path.state.scatterings == 0 && matches!(bsdf, Bsdf::Null) {
                    self.estimate.first = None;
                }
            } else if path.ends_at_lights || !self.scatter(path, surface, &bsdf) {
                return;
            }
        }
    }

    /// Takes the next branch from the last fork; `false` where no forks are left.
    ///
    /// * `path`: the path that has ended, which is replaced
    fn take_branch(&mut self, path: &mut CameraPath<'s>) -> bool {
        if C::GUIDES {
            return self.take_guided_branch(path);
        }
        while let Some(fork) = self.forks.last_mut() {
            self.observer.back_to(fork.mark);
            let splits = fork.branches > 1 && fork.taken < fork.branches;
            if splits && self.observer.interrupted() {
                self.forks.clear();
                return false;
            }
            let part = fork.take(path);
            let goes_on = path.go_on(self.view.scene, self.settings, fork.shaded(), part, self.observer);
            if C::WALKS {
                let (surface, bsdf) = (fork.surface, fork.bsdf);
                self.note_crossed(path, &surface, &bsdf);
            }
            if part == Part::Mirror {
                self.forks.pop();
            }
            if goes_on {
                return true;
            }
        }
        false
    }

    /// Adds the light that arrives directly and goes on from a surface; `false` when the path ends here or forks.
    fn scatter(&mut self, path: &mut CameraPath<'s>, surface: &SurfaceInteraction, bsdf: &Bsdf<'s>) -> bool {
        let settings = self.settings;
        let shading = self.scene().shading(&surface.at, surface.u);
        let local = LocalFrame::new(&shading, surface.wo);
        let bumped = local.bumped(bsdf);
        let bsdf = bumped.as_ref().unwrap_or(bsdf);
        let is_delta = bsdf.is_delta();
        if C::IS_ASKED && !is_delta && !self.settle(path) {
            return false;
        }
        if self.estimate.albedo.is_none() && self.view.wants_albedo() && !is_delta {
            self.estimate.albedo = Some(bsdf.albedo(local.wo));
        }
        if C::IS_ASKED
            && !is_delta
            && let Some(goes_on) = self.take_indirect(path, surface, bsdf, &local, &shading)
        {
            return goes_on;
        }
        if C::GUIDES {
            // What light comes through from the other side is left to scattering.
            match is_delta || bsdf.transmits() {
                false => self.indirect.comes_to(surface.at.point.p, local.n(), path.state.beta),
                true => self.indirect.comes_to_unguided(),
            }
        }
        if !is_delta && settings.technique != Technique::Scattering {
            self.add_drawn_light(path, surface, bsdf, &local);
        }
        if C::GUIDES {
            return self.scatter_guided(path, surface, bsdf, &local);
        }
        let splits = !path.is_branch && settings.branches > 1 && !is_delta;
        if !splits && settings.directions == Directions::Scattering {
            return self.go_on(path, Shaded { surface, bsdf, local: &local }, Part::All);
        }
        if is_delta {
            return self.go_on(path, Shaded { surface, bsdf, local: &local }, Part::Mirror);
        }
        let branches = if path.is_branch { 1 } else { settings.branches.max(1) };
        let mark = self.observer.mark();
        let fork = Fork { path: *path, surface: *surface, bsdf: *bsdf, local, branches, taken: 0, mark };
        self.forks.push(fork);
        false
    }

    /// [`CameraPath::go_on`], noted where lights behind glass are drawn.
    #[inline]
    fn go_on(&mut self, path: &mut CameraPath<'s>, at: Shaded<'_>, part: Part) -> bool {
        let may_split = self.may_split_colors(path);
        let goes_on = path.go_on(self.scene(), self.settings, at, part, self.observer);
        if may_split && goes_on && path.state.media.separates_colors(self.scene()) {
            self.split_colors(path);
        }
        if C::WALKS {
            self.note_crossed(path, at.surface, at.bsdf);
        }
        goes_on
    }

    /// The weight of light that the path met by its own scattering.
    ///
    /// With the density `p` of the ray's direction per solid angle and the density `q` with which [`sample_light`] would have
    /// drawn it from the last vertex, the estimate `f Le / p` counts by the power heuristic
    ///
    /// ```text
    /// w = p^2 / (p^2 + q^2)                                           [Veach 1997, eq. 9.15]
    /// ```
    ///
    /// and in full where no light could have been drawn: for the camera's own ray, behind mirrors, and behind interfaces
    /// that hold a shadow ray up.
    ///
    /// * `at`: the point of the light
    /// * `d`: unit direction of the ray that hit it
    fn mis_weight(&self, path: &CameraPath<'s>, hit: &LightHit, at: &LightPoint, d: Vec3) -> f32 {
        weight_of_hit(self.settings.technique, path.state.connectable, || {
            let pdf_li = self.scene().pdf_li(hit.light, &path.receiver, at, d, self.lights);
            if path.state.carries_media {
                return self.mis_weight_through_media(path, hit, pdf_li);
            }
            power_heuristic(path.pdf, pdf_li)
        })
    }

    /// The same with the densities of all lanes, where some are carried through media.
    ///
    /// * `pdf_li`: density with which light would have been drawn
    #[inline(never)]
    fn mis_weight_through_media(&self, path: &CameraPath<'s>, hit: &LightHit, pdf_li: f32) -> f32 {
        // The mean of `r_u` is 1.
        let weight = power_heuristic(path.pdf, pdf_li * path.state.mean(path.state.lanes.r_l));
        match &path.collided {
            Some(collided) if path.receiver.n == Vec3::ZERO => {
                weight * collided.weight(self.scene(), hit.light, self.lights)
            }
            _ => weight,
        }
    }

    /// Light from infinitely far away along a ray that leaves the scene: `beta Le(d) w`.
    fn add_background(&mut self, path: &CameraPath<'s>, d: Vec3) {
        if C::IS_ASKED {
            self.indirect.hit(path.bounces, None);
        }
        let (scene, state) = (self.scene(), &path.state);
        let at = LightPoint::Infinite { through: path.receiver.p };
        let footprint = if C::WALKS { SkyFootprint::POINT } else { sky_footprint(state) };
        for hit in scene.lights_at_infinity(d, &footprint, &state.wavelengths) {
            if C::IS_ASKED {
                if let Some(weight) = self.weight_from_infinity(path, &hit, &at, d) {
                    self.add_hit(state, state.beta * hit.radiance * weight, hit.group);
                }
                continue;
            }
            let weight = match C::WALKS && !state.connectable {
                true => self.weight_behind_glass(path, &hit, &at, d),
                false => self.mis_weight(path, &hit, &at, d),
            };
            self.add_hit(state, state.beta * hit.radiance * weight, hit.group);
        }
    }

    /// Light that the surface itself sends back along the path: `beta Le(wo) w`.
    fn add_emission(&mut self, path: &CameraPath<'s>, surface: &SurfaceInteraction) {
        if C::IS_ASKED && !self.indirect.counts_lights() {
            return;
        }
        let (state, d) = (&path.state, -surface.wo);
        if let Some(hit) = self.scene().surface_light(&surface.at, d, &state.wavelengths) {
            let at = LightPoint::on(&surface.at.point);
            let weight = match C::WALKS && !state.connectable {
                true => self.weight_behind_glass(path, &hit, &at, d),
                false => self.mis_weight(path, &hit, &at, d),
            };
            self.add_hit(state, state.beta * hit.radiance * weight, hit.group);
        }
    }

    /// Adds light that the path has met.
    fn add_hit(&mut self, state: &PathState<'s>, light: Spectrum, group: LightGroup) {
        self.observer.emitter_met(|| sensor::to_rgb(light, &state.wavelengths));
        self.add(state, light, group);
    }

    /// Adds light that a path has found, of a group of lights, to the sample.
    #[inline(always)]
    fn add(&mut self, state: &PathState<'s>, light: Spectrum, group: LightGroup) {
        if C::GUIDES {
            self.indirect.finds(light);
        }
        self.estimate.add(state, light, group);
    }

    /// Direct light by next-event estimation. The integral over the hemisphere of directions `wi`
    ///
    /// ```text
    /// Ld = integral of  f(wo, wi) |cos| Li(wi)  dwi
    /// ```
    ///
    /// is estimated by one direction to a light, drawn with the density `q` per solid angle by what the lights may
    /// contribute: `f |cos| T V Le / q`, with the transmittance `T` of the medium on the side of the light, and `V` that of
    /// holes and panes. Directions that scattering finds with the density `p` are found in two ways, so this one counts
    ///
    /// ```text
    /// w = q^2 / (p^2 + q^2)                                           [Veach 1997, eq. 9.15]
    /// ```
    ///
    /// and in full where the light has no extent that a ray could meet.
    fn add_direct_light(
        &mut self,
        path: &mut CameraPath<'s>,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'s>,
        local: &LocalFrame,
    ) {
        let (scene, settings) = (self.scene(), self.settings);
        let receiver = receiver(surface, local);
        let Some(chosen) = choose_light(scene, &mut path.state, &receiver, self.lights) else { return };
        if C::WALKS {
            self.add_light_through_glass(path, Shaded { surface, bsdf, local }, &chosen);
        }
        let drawn = light_of_choice(scene, &path.state, &receiver, &chosen, self.lights);
        let Some(DrawnLight { light, li, pdf }) = drawn else { return };
        let Some(wi) = local.to_local(li.wi) else { return };
        let towards = TwoFrames { local: wi, world: li.wi };
        let scattered = bsdf.eval(local.wo, wi, Transport::Radiance);
        let crosses = wi.z * local.wo.z < 0.0;
        if scattered.is_black() || (crosses && self.finds_light_by_colors(path, surface)) {
            return;
        }
        let state = &mut path.state;
        let segment = surface.at.point.ray_to(&li.at, li.wi, state.ray.time);
        let beyond = surface.interface.filter(|_| crosses).map(|interface| state.media.across(&interface));
        let media = beyond.as_ref().unwrap_or(&state.media);
        if state.carries_media {
            let pdf_by_scattering = self.pdf_of_path(bsdf, local.wo, towards);
            let carried = state.beta * scattered;
            let joined =
                Joined { receiver, segment, media: *media, carried, pdf_by_scattering, densities: None };
            return self.add_light_through_media(path, &DrawnLight { light, li, pdf }, joined);
        }
        let carried = state.beta * scattered * media.transmittance(segment.length());
        let eta = media.eta_of_segment(scene);
        let visible = connect(scene, &segment, eta, &state.wavelengths, self.observer);
        self.observer.light_drawn(&receiver, light, || !visible.is_black());
        let about = || About {
            eta: state.media.eta(),
            weight: sensor::to_rgb(carried, &state.wavelengths),
            light: Some(scene.lighting.sampler.id(light)),
        };
        if visible.is_black() {
            self.observer.joined(RayKind::Shadow, scene, &segment, about, || [0.0; 3]);
            return;
        }
        // [Veach 1997, eq. 9.15]
        let weight = match settings.technique {
            Technique::Combined if !li.is_delta => {
                power_heuristic(pdf, self.pdf_of_path(bsdf, local.wo, towards))
            }
            _ => 1.0,
        };
        let added = carried * li.radiance * visible * (weight / pdf);
        let rgb = || sensor::to_rgb(added, &state.wavelengths);
        self.observer.joined(RayKind::Shadow, scene, &segment, about, rgb);
        self.add(state, added, scene.lighting.sampler.group(light));
    }
}

impl<'a: 's, 's, O: PathObserver, C: IndirectLight> PathTracer<'a, 's, O, C> {
    /// Density per solid angle with which the path itself would go on in a direction.
    #[inline(always)]
    fn pdf_of_path(&self, bsdf: &Bsdf<'_>, wo: Vec3, wi: TwoFrames) -> f32 {
        let pdf = directions::pdf(self.settings.directions, bsdf, wo, wi.local);
        if C::GUIDES { self.indirect.mixed(wi.world, pdf).0 } else { pdf }
    }
}

/// A unit direction in the local frame of a surface, and in world space.
#[derive(Clone, Copy)]
struct TwoFrames {
    local: Vec3,
    world: Vec3,
}

/// What joins a vertex and a point of a light.
struct Joined {
    /// The vertex.
    receiver: Receiver,
    segment: Ray,
    /// Around the start of the segment.
    media: MediumStack,
    /// `beta f |cos|`, in a medium `beta p`.
    carried: Spectrum,
    /// Density per solid angle with which the path itself would have gone there.
    pdf_by_scattering: f32,
    /// Densities of the lanes over that, where they differ.
    densities: Option<Spectrum>,
}

/// Vertices in media.
impl<'a: 's, 's, O: PathObserver, C: IndirectLight> PathTracer<'a, 's, O, C> {
    /// Adds the light that arrives directly at a point in a medium and goes on from there; `false` when the path ends.
    ///
    /// The integral over all directions of `p(wo, wi) Li(wi)` is estimated as at surfaces, with the phase function `p` in the
    /// place of `f |cos|`. It is its own density, so that a direction drawn by it leaves `beta` what it is.
    ///
    /// Takes three numbers for the light, and what a connection takes; then two for the direction and one for roulette
    /// where it is played.
    #[cold]
    #[inline(never)]
    fn scatter_in_medium(&mut self, path: &mut CameraPath<'s>, at: &MediumInteraction<'_>) -> bool {
        if path.state.scatterings == 0 && self.estimate.first.is_none() {
            self.estimate.begins_in_medium = true;
            self.estimate.first = Some(Interaction::default());
        }
        if C::IS_ASKED {
            self.indirect.hit(path.bounces, Some(at.p));
        }
        if path.ends_at_lights || (C::IS_ASKED && !self.settle(path)) {
            return false;
        }
        let settings = self.settings;
        let receiver = Receiver { p: at.p, n: Vec3::ZERO, time: at.time };
        if settings.technique != Technique::Scattering {
            self.add_direct_light_in_medium(path, at, &receiver);
            self.add_volume_light_in_medium(path, at);
        }
        path.ends_at_lights = path.bounces == settings.bounces || settings.only_mirrors;
        if path.ends_at_lights && settings.technique == Technique::Lights {
            return false;
        }
        let sample = at.phase.sample(at.wo, path.state.draws.next_2d(), path.state.lanes.hero);
        follow_phase(&mut path.state, at, sample, self.observer);
        path.receiver = receiver;
        path.collided = path.along.map(|along| along.collision(at.length, &path.state));
        path.pdf = sample.value.pdf;
        path.bounces += 1;
        survives_in_medium(&mut path.state, path.bounces, settings.roulette, self.gain())
    }

    /// Direct light at a point `x` in a medium, by next-event estimation. The integral over directions of `p(wo, wi)
    /// Li(wi)`, with the phase function `p`, is estimated by one light, drawn with the density `q` per solid angle: `p
    /// T Le / q`, with the estimate `T` of the transmittance in [`PathTracer::add_light_through_media`]. Scattering has
    /// the density `p` itself, against which that is weighed. Where light was drawn for the ray that `x` lies on too,
    /// the share of this estimate is [`CollisionOnRay::weight`].
    fn add_direct_light_in_medium(
        &mut self,
        path: &mut CameraPath<'s>,
        at: &MediumInteraction<'_>,
        receiver: &Receiver,
    ) {
        let (scene, state) = (self.scene(), &mut path.state);
        let drawn = sample_light(scene, state, receiver, self.lights);
        let Some(drawn) = drawn else { return };
        let scattered = at.phase.eval(at.wo, drawn.li.wi);
        let point = SurfacePoint { p: at.p, ..SurfacePoint::default() };
        let segment = point.ray_to(&drawn.li.at, drawn.li.wi, at.time);
        let joined = Joined {
            receiver: *receiver,
            segment,
            media: state.media,
            carried: state.beta * scattered.value(),
            pdf_by_scattering: scattered.pdf,
            densities: scattered.colors.map(lane_densities),
        };
        let lights = self.lights;
        let collision = path.along.map(|along| along.collision(at.length, &path.state));
        let share = collision.map_or(1.0, |collision| collision.weight(scene, drawn.light, lights));
        let joined = Joined { carried: joined.carried * share, ..joined };
        self.add_light_through_media(path, &drawn, joined);
    }

    /// Adds light that was drawn for a vertex, weakened by the media on its way.
    ///
    /// Each lane might have been the hero, for this estimate and for that of light met by chance alike, so the densities that
    /// are weighed against each other are means over the lanes; see `transport/collisions.rs`.
    #[inline(never)]
    fn add_light_through_media(&mut self, path: &mut CameraPath<'s>, drawn: &DrawnLight, joined: Joined) {
        let (scene, state) = (self.scene(), &mut path.state);
        let &DrawnLight { light, li, pdf } = drawn;
        let Joined { receiver, segment, media, carried, pdf_by_scattering, densities } = joined;
        let passage = connect_through_media(scene, &segment, media, Joining::from(state), self.observer);
        self.observer.light_drawn(&receiver, light, || !passage.t.is_black());
        let about = || About {
            eta: state.media.eta(),
            weight: sensor::to_rgb(carried, &state.wavelengths),
            light: Some(scene.lighting.sampler.id(light)),
        };
        let r_u = densities.map_or(passage.r_u, |densities| passage.r_u * densities);
        let [by_light, by_scattering] = [passage.r_l, r_u].map(|r| state.mean(r));
        if passage.t.is_black() || by_light <= 0.0 {
            self.observer.joined(RayKind::Shadow, scene, &segment, about, || [0.0; 3]);
            return;
        }
        // [Veach 1997, eq. 9.15], with the means over the lanes of the densities by free paths and by ratio tracking.
        let weight = match self.settings.technique {
            Technique::Combined if !li.is_delta => {
                power_heuristic(pdf * by_light, pdf_by_scattering * by_scattering)
            }
            _ => 1.0,
        };
        let added = carried * li.radiance * passage.t * (weight / (pdf * by_light));
        let rgb = || sensor::to_rgb(added, &state.wavelengths);
        self.observer.joined(RayKind::Shadow, scene, &segment, about, rgb);
        self.add(state, added, scene.lighting.sampler.group(light));
    }
}

impl Estimate {
    /// Adds light of a light group.
    fn add(&mut self, path: &PathState<'_>, light: Spectrum, group: LightGroup) {
        self.light += light;
        if let Some(groups) = &mut self.groups {
            let (sum, rgb) = (&mut groups[group.index()], sensor::to_rgb(light, &path.wavelengths));
            *sum = [0, 1, 2].map(|i| sum[i] + rgb[i]);
        }
    }

    /// Adds light that was found under these wavelengths of a path, or some of them.
    fn add_sensed(
        &mut self,
        path: &PathState<'_>,
        wavelengths: &Wavelengths,
        light: Spectrum,
        group: LightGroup,
    ) {
        if *wavelengths == path.wavelengths {
            return self.add(path, light, group);
        }
        let rgb = sensor::to_rgb(light, wavelengths);
        self.sensed = [0, 1, 2].map(|i| self.sensed[i] + rgb[i]);
        if let Some(groups) = &mut self.groups {
            let sum = &mut groups[group.index()];
            *sum = [0, 1, 2].map(|i| sum[i] + rgb[i]);
        }
    }

    /// All light as the sensor sees it, of which the latest was found under the wavelengths of a path.
    fn sensed_with(&self, path: &PathState<'_>) -> [f32; 3] {
        let rest = sensor::to_rgb(self.light, &path.wavelengths);
        [0, 1, 2].map(|i| self.sensed[i] + rest[i])
    }

    /// Follows one wavelength from here on.
    fn end_secondary_wavelengths(&mut self, path: &mut PathState<'_>) {
        if path.wavelengths.is_spectral() && !path.wavelengths.secondary_terminated() {
            self.sensed = self.sensed_with(path);
            self.light = Spectrum::BLACK;
            path.end_secondary_wavelengths();
        }
    }
}

/// The weight of light that a path has hit: that of multiple importance sampling where lights are drawn as well, and one could have been drawn.
#[inline(always)]
pub(super) fn weight_of_hit(
    technique: Technique,
    is_connectable: bool,
    combined: impl FnOnce() -> f32,
) -> f32 {
    match technique {
        _ if !is_connectable => 1.0,
        Technique::Scattering => 1.0,
        Technique::Lights => 0.0,
        Technique::Combined => combined(),
    }
}

/// The receiver of light at a surface.
pub(super) fn receiver(surface: &SurfaceInteraction, local: &LocalFrame) -> Receiver {
    Receiver { p: surface.at.point.p, n: local.n(), time: surface.at.time }
}
