//! One path while it is being made, for the integrators that follow paths from the camera.

use std::cell::Cell;
use std::f32::consts::FRAC_1_PI;
use std::mem;

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::RayOffset;
use kajo_core::bsdf::{Bsdf, BsdfSample, ScatterKind, Transport};
use kajo_core::light::MAX_LIGHT_GROUPS;
use kajo_core::lighting::Receiver;
use kajo_core::sampler::Draws;
use kajo_core::scene::{Interaction, Scene};
use kajo_core::settings::{Directions, Technique};
use kajo_core::shading::Shading;
use kajo_math::{Frame, Ray, Vec2, Vec3, warp};

use super::bodies::{Bodies, Boundary};
use super::path::PathSettings;
use super::view::View;
use crate::trail::{About, RayKind, Witness};

/// Bounces after which paths may end at random.
pub(super) const SAFE_BOUNCES: u32 = 3;

/// The largest chance to go on at random ends: a path between perfect mirrors must end some day.
pub(super) const LARGEST_SURVIVAL: f32 = 0.98;

/// Surfaces that one path may meet, those that it passes straight on included.
///
/// Bounces are counted on their own; but holes, panes and surfaces hidden in a body of higher priority cost none, and
/// rounding may put a path in front of the same one for ever.
pub(super) const MOST_SURFACES: u32 = 1 << 14;

/// A path while it is being made.
pub(super) struct Walk<'a, 'b, W> {
    view: &'a View<'a>,
    settings: &'a PathSettings,
    draws: Draws<'b>,
    /// Who is told.
    pub witness: W,
    ray: Ray,
    wavelengths: Wavelengths,
    /// What later light is multiplied by.
    throughput: Spectrum,
    /// The same without the squeezing of rays at boundaries, which a later one undoes.
    squeeze: f32,
    /// Light found under the present wavelengths.
    light: Spectrum,
    /// What the sensor has of light found under earlier ones.
    seen: [f32; 3],
    /// What the sensor has of the light of each group of emitters, where that is asked for.
    groups: Option<&'a LightGroups>,
    bodies: Bodies,
    bounces: u32,
    /// Mirrors that may still be met before the first bounce without counting as one.
    free_mirrors: u32,
    /// How the present ray was found.
    origin: Origin,
    /// Whether the present ray is followed for lights that it may meet, and no further.
    ends_at_lights: bool,
    /// Whether the path has split up.
    is_branch: bool,
    /// The first surface.
    pub first: Option<Interaction>,
    /// The albedo of the first surface that is no mirror.
    pub albedo: Option<Spectrum>,
}

/// Linear RGB of each group of lights. All branches of a path add to one set.
pub(super) type LightGroups = [Cell<[f32; 3]>; MAX_LIGHT_GROUPS];

/// How a ray was found, to weigh what it meets.
#[derive(Clone, Copy)]
struct Origin {
    /// Where it started.
    receiver: Receiver,
    /// The density of its direction; `None` where lights could not have been drawn.
    pdf: Option<f32>,
}

impl<'a, 'b, W: Witness> Walk<'a, 'b, W> {
    /// A path that starts with a camera ray, whose direction has unit length.
    pub fn new(
        view: &'a View<'a>,
        settings: &'a PathSettings,
        ray: Ray,
        wavelengths: Wavelengths,
        draws: Draws<'b>,
        witness: W,
    ) -> Walk<'a, 'b, W> {
        Walk {
            view,
            settings,
            draws,
            witness,
            ray,
            wavelengths,
            throughput: Spectrum::WHITE,
            squeeze: 1.0,
            light: Spectrum::BLACK,
            seen: [0.0; 3],
            groups: None,
            bodies: view.bodies_around(&ray, &wavelengths),
            bounces: 0,
            free_mirrors: settings.free_mirrors,
            origin: Origin { receiver: Receiver::default(), pdf: None },
            ends_at_lights: false,
            is_branch: false,
            first: None,
            albedo: None,
        }
    }

    /// From here on the light of each group of emitters is added to `groups` as well.
    pub fn tell_groups_apart(&mut self, groups: Option<&'a LightGroups>) {
        self.groups = groups;
    }

    fn scene(&self) -> &'a Scene {
        self.view.scene
    }

    /// Follows the path to its end.
    pub fn run(&mut self) {
        let mut at = Interaction::default();
        for _ in 0..MOST_SURFACES {
            let meets = self.scene().trace_into(None, &self.ray, &mut at);
            let (throughput, wavelengths, bodies) = (self.throughput, self.wavelengths, &self.bodies);
            self.witness.ended(self.view.scene, &self.ray, meets.then_some(&at), || About {
                eta: bodies.eta(),
                weight: sensor::to_rgb(throughput, &wavelengths),
                light: None,
            });
            if !meets {
                self.escape();
                return;
            }
            if !self.bodies.is_empty() {
                self.throughput *= self.bodies.transmittance(at.hit.t);
            }
            if self.first.is_none() {
                self.first = Some(at);
            }
            let u = self.draws.number_if(self.scene().is_mixture(&at));
            let boundary = self.boundary(&at, u);
            if let Some(boundary) = boundary.filter(|boundary| !boundary.is_real) {
                self.bodies = self.bodies.beyond(&boundary);
                // Shadow rays are held up here: what is met from here on could not have been drawn.
                self.origin.pdf = None;
                self.witness.next(RayKind::Transmitted);
                self.ray = at.point.ray_towards(self.ray.d, f32::INFINITY, self.ray.time, RayOffset::Auto);
                continue;
            }
            self.meet_light(&at);
            // The last surface may be a hole or a pane.
            let is_last = self.ends_at_lights && !self.scene().has_passages;
            if is_last || !self.scatter(&at, boundary.as_ref(), u) {
                return;
            }
        }
    }

    /// The light of the whole path as the sensor sees it.
    pub fn finished(&self) -> [f32; 3] {
        let rest = sensor::to_rgb(self.light, &self.wavelengths);
        [0, 1, 2].map(|i| self.seen[i] + rest[i])
    }

    /// How the path meets the surface of a body that light passes.
    ///
    /// * `u`: as in [`Scene::bsdf`]
    fn boundary(&self, at: &Interaction, u: f32) -> Option<Boundary> {
        let interior = self.scene().interior(at, &self.wavelengths, u)?;
        Some(self.bodies.meet(at.primitive, interior, self.ray.d.dot(at.point.ng) < 0.0))
    }

    /// Follows one wavelength from here on.
    fn end_secondary_wavelengths(&mut self) {
        if self.wavelengths.is_spectral() && !self.wavelengths.secondary_terminated() {
            self.seen = self.finished();
            self.light = Spectrum::BLACK;
            self.wavelengths.terminate_secondary();
        }
    }

    /// The weight of light that was met by chance; `drawn` is the density with which it would have been drawn.
    fn weight_of_chance(&self, drawn: impl FnOnce(&Receiver) -> f32) -> f32 {
        match (self.origin.pdf, self.settings.technique) {
            (None, _) | (_, Technique::Scattering) => 1.0,
            (Some(_), Technique::Lights) => 0.0,
            (Some(pdf), Technique::Combined) => power_heuristic(pdf, drawn(&self.origin.receiver)),
        }
    }

    /// Adds light of a group of emitters.
    fn add(&mut self, light: Spectrum, group: u8) {
        self.light += light;
        if let Some(groups) = self.groups {
            let sum = &groups[usize::from(group)];
            let (rgb, before) = (sensor::to_rgb(light, &self.wavelengths), sum.get());
            sum.set([0, 1, 2].map(|i| before[i] + rgb[i]));
        }
    }

    fn escape(&mut self) {
        let radiance = self.scene().background.radiance(self.ray.d, &self.wavelengths);
        if !radiance.is_black() {
            let choice = self.settings.light_choice;
            let weight = self.weight_of_chance(|from| self.scene().sky_pdf(from, self.ray.d, choice));
            self.meet(self.throughput * radiance * weight, self.scene().emitters.sky_group());
        }
        let (scene, d, wavelengths) = (self.scene(), self.ray.d, self.wavelengths);
        for sun in scene.suns(d, &wavelengths) {
            let choice = self.settings.light_choice;
            let weight =
                self.weight_of_chance(|from| scene.light_pdf(sun.light, from, [Vec3::ZERO; 2], d, choice));
            self.meet(self.throughput * sun.radiance * weight, sun.group);
        }
    }

    /// Adds light that the present ray has met.
    fn meet(&mut self, light: Spectrum, group: u8) {
        self.witness.found(|| sensor::to_rgb(light, &self.wavelengths));
        self.add(light, group);
    }

    fn meet_light(&mut self, at: &Interaction) {
        let scene = self.scene();
        if let Some(glow) = scene.glow(at, self.ray.d, &self.wavelengths) {
            let choice = self.settings.light_choice;
            let weight = self.weight_of_chance(|from| scene.glow_pdf(&glow, at, from, choice));
            self.meet(self.throughput * glow.radiance * weight, glow.group);
        }
    }

    /// Adds the light of an emitter and goes on from the surface; `false` when the path ends here.
    fn scatter(&mut self, at: &Interaction, boundary: Option<&Boundary>, u: f32) -> bool {
        if boundary.is_some_and(|boundary| boundary.is_dispersive()) {
            self.end_secondary_wavelengths();
        }
        let eta_outside = boundary.map_or_else(|| self.bodies.eta(), |boundary| boundary.eta_outside);
        let mut bsdf = self.scene().bsdf(at, &self.wavelengths, eta_outside, u);
        if self.scene().has_passages && self.passes(at, &mut bsdf) {
            return true;
        }
        if self.ends_at_lights {
            return false;
        }
        let local = Local::new(self.scene().shading(at, u), self.ray.d);
        if self.albedo.is_none() && self.view.wants_albedo() && !bsdf.is_delta() {
            self.albedo = Some(bsdf.albedo(local.wo));
        }
        if !bsdf.is_delta() && self.settings.technique != Technique::Scattering {
            self.add_light(at, &bsdf, &local, boundary);
        }
        let splits = !self.is_branch && self.settings.branches > 1 && !bsdf.is_delta();
        if !splits && self.settings.directions == Directions::Scattering {
            return self.go_on(at, &bsdf, &local, boundary, Part::All);
        }
        let branches = if self.is_branch { 1 } else { self.settings.branches.max(1) };
        let surface = self.witness.mark();
        for i in 0..if bsdf.is_delta() { 0 } else { branches } {
            if branches > 1 && self.witness.interrupted() {
                return false;
            }
            let mut branch = self.branch(i, branches);
            if branch.go_on(at, &bsdf, &local, boundary, Part::Diffuse) {
                branch.run();
            }
            let Walk { light, seen, wavelengths, draws, witness, .. } = branch;
            (self.light, self.seen, self.wavelengths, self.witness) = (light, seen, wavelengths, witness);
            self.witness.back_to(surface);
            if branches == 1 {
                self.draws = draws;
            }
        }
        self.go_on(at, &bsdf, &local, boundary, Part::Mirror)
    }

    /// Goes straight on through a hole or a pane, as shadow rays do; `false` where the path meets the surface.
    ///
    /// * `bsdf`: scattering there; of a pane that is not passed a mirror is left
    fn passes(&mut self, at: &Interaction, bsdf: &mut Bsdf) -> bool {
        let (draws, d) = (&mut self.draws, self.ray.d);
        let Some(share) = bsdf.cross(|| (at.crossing_cosine(d), draws.next_1d())) else { return false };
        let is_first = self.bounces == 0 && self.free_mirrors == self.settings.free_mirrors;
        if is_first && matches!(bsdf, Bsdf::Null) {
            self.first = None;
        }
        self.throughput *= share;
        self.ray = at.point.ray_towards(d, f32::INFINITY, self.ray.time, RayOffset::Auto);
        true
    }

    /// Path `i` of `n` like this one from here on.
    fn branch(&mut self, i: u32, n: u32) -> Walk<'a, 'b, W> {
        Walk {
            witness: mem::take(&mut self.witness),
            throughput: self.throughput * (1.0 / n as f32),
            is_branch: true,
            draws: if n > 1 { self.draws.split(0, i, n) } else { self.draws },
            ..*self
        }
    }

    /// Takes the path along a scattered ray; `false` when it ends.
    fn go_on(
        &mut self,
        at: &Interaction,
        bsdf: &Bsdf,
        local: &Local,
        boundary: Option<&Boundary>,
        part: Part,
    ) -> bool {
        let (u, choice) = (self.draws.next_2d(), self.draws.number_if(bsdf.is_choosy()));
        let drawn = match (part, self.settings.directions) {
            (Part::Diffuse, Directions::Cosine | Directions::Uniform) => {
                self.hemisphere(bsdf, local.wo, u, choice)
            }
            _ => bsdf.sample(local.wo, u, choice, Transport::Radiance),
        };
        let wanted = |sample: &BsdfSample| match part {
            Part::All => true,
            Part::Diffuse => !sample.kind.delta,
            Part::Mirror => sample.kind.delta,
        };
        let Some(sample) = drawn.filter(wanted) else { return false };
        let Some(wi) = local.outgoing(&sample) else { return false };
        let settings = self.settings;
        let is_free = sample.kind.delta && self.bounces == 0 && self.free_mirrors > 0;
        if is_free {
            self.free_mirrors -= 1;
        }
        self.ends_at_lights =
            (self.bounces == settings.bounces && !is_free) || (settings.only_mirrors && !sample.kind.delta);
        if self.ends_at_lights && settings.technique == Technique::Lights && !sample.kind.delta {
            return false;
        }
        let kind = if sample.kind.transmission {
            self.witness.counters().refracted += 1;
            self.bodies = boundary.map_or(self.bodies, |boundary| self.bodies.beyond(boundary));
            RayKind::Transmitted
        } else {
            self.witness.counters().reflected += 1;
            RayKind::Reflected
        };
        self.witness.next(if sample.kind.delta { kind } else { RayKind::Scattered });
        self.throughput *= sample.weight;
        self.squeeze *= sample.eta * sample.eta;
        self.origin = Origin {
            receiver: Receiver { p: at.point.p, n: local.frame.n, time: at.time },
            pdf: (!sample.kind.delta).then_some(sample.pdf),
        };
        self.ray = at.point.ray_towards(wi, f32::INFINITY, self.ray.time, RayOffset::Auto);
        self.bounces += u32::from(!is_free);
        self.survives()
    }

    /// A direction drawn without regard to the surface's scattering, on either side if light passes.
    fn hemisphere(&self, bsdf: &Bsdf, wo: Vec3, u: Vec2, choice: f32) -> Option<BsdfSample> {
        let local = match self.settings.directions {
            Directions::Uniform => warp::uniform_hemisphere(u),
            _ => warp::cosine_hemisphere(u),
        };
        let other_side = bsdf.transmits() && choice < 0.5;
        let side = if (wo.z > 0.0) == other_side { -1.0 } else { 1.0 };
        let wi = Vec3::new(local.x, local.y, side * local.z);
        let pdf = self.direction_pdf(bsdf, wo, wi);
        let weight = bsdf.eval(wo, wi, Transport::Radiance) * (1.0 / pdf);
        let kind = ScatterKind { transmission: other_side, delta: false, straight: false };
        (pdf > 0.0 && weight.is_finite()).then_some(BsdfSample { wi, weight, pdf, kind, eta: 1.0 })
    }

    /// Density of a direction among those that [`Walk::go_on`] draws for surfaces that are no mirrors.
    fn direction_pdf(&self, bsdf: &Bsdf, wo: Vec3, wi: Vec3) -> f32 {
        let sides = if bsdf.transmits() { 0.5 } else { 1.0 };
        let reachable = bsdf.transmits() || wo.z * wi.z > 0.0;
        match self.settings.directions {
            Directions::Scattering => bsdf.pdf(wo, wi),
            _ if !reachable => 0.0,
            Directions::Cosine => sides * wi.z.abs() * FRAC_1_PI,
            Directions::Uniform => sides * 0.5 * FRAC_1_PI,
        }
    }

    /// Adds the light of one emitter, drawn for this surface.
    fn add_light(&mut self, at: &Interaction, bsdf: &Bsdf, local: &Local, boundary: Option<&Boundary>) {
        let u = self.draws.number_if(self.scene().emitters.len() > 1);
        let place = self.draws.next_2d();
        let settings = &self.settings;
        let receiver = Receiver { p: at.point.p, n: local.frame.n, time: at.time };
        let drawn = self.scene().light_towards(&receiver, u, place, &self.wavelengths, settings.light_choice);
        let Some(emitter) = drawn.filter(|emitter| !emitter.radiance.is_black()) else { return };
        let wi = local.frame.to_local(emitter.wi);
        if !local.agrees(emitter.wi, wi) {
            return;
        }
        let scattered = bsdf.eval(local.wo, wi, Transport::Radiance);
        if scattered.is_black() {
            return;
        }
        self.witness.counters().shadow += 1;
        let shadow_ray = at.point.ray_to_light(&emitter, self.ray.time);
        let far = boundary.filter(|_| wi.z * local.wo.z < 0.0).map(|boundary| self.bodies.beyond(boundary));
        let around = far.as_ref().unwrap_or(&self.bodies);
        let passed = around.transmittance(shadow_ray.length());
        let weight_of_light = self.throughput * scattered * passed;
        let (bodies, wavelengths) = (&self.bodies, &self.wavelengths);
        let about = || About {
            eta: bodies.eta(),
            weight: sensor::to_rgb(weight_of_light, wavelengths),
            light: Some(self.view.scene.emitters.id(emitter.light)),
        };
        let visible = self.scene().visibility(&shadow_ray, wavelengths, around.eta());
        if visible.is_black() {
            self.witness.joined(RayKind::Shadow, self.view.scene, &shadow_ray, about, || [0.0; 3]);
            return;
        }
        let weight = match settings.technique {
            Technique::Combined if !emitter.is_delta => {
                power_heuristic(emitter.pdf, self.direction_pdf(bsdf, local.wo, wi))
            }
            _ => 1.0,
        };
        let light = weight_of_light * emitter.radiance * visible * (weight / emitter.pdf);
        self.witness.joined(RayKind::Shadow, self.view.scene, &shadow_ray, about, || {
            sensor::to_rgb(light, wavelengths)
        });
        self.add(light, self.scene().emitters.group(emitter.light));
    }

    /// Whether the path goes on, decided at random where it carries little.
    fn survives(&mut self) -> bool {
        let carried = self.wavelengths.max_lane(self.throughput);
        if carried.is_nan() || carried <= 0.0 {
            return false;
        }
        if !self.settings.roulette || self.bounces <= SAFE_BOUNCES {
            return true;
        }
        let chance = (carried * self.squeeze).min(LARGEST_SURVIVAL);
        if self.draws.next_1d() >= chance {
            return false;
        }
        self.throughput *= 1.0 / chance;
        true
    }
}

/// Which of a surface's scattering a path follows.
#[derive(Clone, Copy)]
enum Part {
    All,
    /// Without the single directions of mirrors and clear boundaries.
    Diffuse,
    /// Only those.
    Mirror,
}

/// The shading frame at a surface and the direction back along the path.
struct Local {
    frame: Frame,
    /// Unit direction to where the path came from, in the frame.
    wo: Vec3,
    /// Unit geometric normal on the side of the shading normal.
    ng: Vec3,
}

impl Local {
    /// * `d`: unit direction of the ray that has come to the surface
    #[inline]
    fn new(shading: Shading, d: Vec3) -> Local {
        let frame = shading.frame(-d);
        Local { wo: frame.to_local(-d), frame, ng: shading.ng }
    }

    /// Whether a direction is on the same side by the true surface as it is by the shading normal.
    fn agrees(&self, world: Vec3, local: Vec3) -> bool {
        world.dot(self.ng) * local.z > 0.0
    }

    /// A sampled direction in world space; `None` for one that the true surface hides.
    fn outgoing(&self, sample: &BsdfSample) -> Option<Vec3> {
        let wi = self.frame.to_world(sample.wi);
        self.agrees(wi, sample.wi).then_some(wi)
    }
}

/// Weight of an estimate of density `p` against another of density `q`.
#[inline]
fn power_heuristic(p: f32, q: f32) -> f32 {
    // By their ratio, since the squares may overflow.
    if p > q { 1.0 / (1.0 + (q / p) * (q / p)) } else { (p / q) * (p / q) / (1.0 + (p / q) * (p / q)) }
}
