//! Manifold next-event estimation: lights that are drawn for a vertex though glass stands before them, or by way of a mirror [Hanika, Droske and
//! Fascione 2015; Zeltner, Georgiev and Jakob 2020].
//!
//! For a vertex `x0` a light is chosen as for direct light, and a point `y` of it drawn with the density `p_A` per area: of all its surface, since
//! through glass other parts of it may shine than those that are seen straight. Then a [`ManifoldWalk`] looks for
//! the directions `w` in which chains of refractions join both, or one reflection, by way of a caster: an object of smooth glass or
//! metal, chosen with the probability `c`. Per solid angle at `x0` such a direction has been drawn with the density
//!
//! ```text
//! q(w) = c p_A dA/dw = c p_A |det J| / |cos_y|
//! ```
//!
//! and `f |cos| T Le / q` is an estimate of the light that comes so, with `T` the product of Fresnel's factors, squares of indices and
//! absorption. The path's own scattering finds the same light with the density `p(w)`, which is that of `w` at `x0` times the
//! probabilities of all that happens on the way. Each counts by the power heuristic of `p` and `q`, as for direct light.
//!
//! There may be more chains from `x0` to `y` than walks find. They are deterministic, so for a path that has met `y` by chance the same walks
//! are made, and
//!
//! ```text
//! q = 0   unless one of them ends in the chain that the path has gone along
//! ```
//!
//! Then it counts in full. So nothing is counted twice or left out, whichever chains walks miss. Lights without extent are met by no path:
//! there one more walk begins in a random direction, and a chain that it finds and the others do not counts as often as such walks have to
//! be made to find it again.

use kajo_color::{Spectrum, sensor};
use kajo_core::ObjectId;
use kajo_core::bsdf::{Bsdf, Transport};
use kajo_core::light::{LightHit, LightLiSample, LightPoint, Receiver};
use kajo_core::scene::Interaction;
use kajo_core::settings::Technique;
use kajo_math::{Ray, Vec2, Vec3};

use super::casters::Casters;
use super::crossed::Crossed;
use super::{CameraPath, IndirectLight, PathTracer, Shaded, directions};
use crate::integrator::transport::{
    Caster, ChainStart, ChosenLight, DrawnLight, Link, MOST_CHAINS, ManifoldWalk, MediumStack, PathState,
    SpecularChain, SurfaceInteraction, Via, connect, power_heuristic,
};
use crate::trail::{About, PathObserver, RayKind};

/// Lights are drawn that shine through glass or by way of mirrors.
pub struct ThroughGlass<'c> {
    casters: &'c Casters,
    crossed: Option<Crossed>,
}

impl<'c> ThroughGlass<'c> {
    /// * `casters`: of the scene
    pub fn new(casters: &'c Casters) -> ThroughGlass<'c> {
        ThroughGlass { casters, crossed: None }
    }
}

impl IndirectLight for ThroughGlass<'_> {
    const IS_ASKED: bool = false;
    const WALKS: bool = true;

    fn crossed(&mut self) -> Option<&mut Option<Crossed>> {
        Some(&mut self.crossed)
    }

    fn casters(&self) -> Option<&Casters> {
        (!self.casters.is_empty()).then_some(self.casters)
    }
}

/// How near a ray to a point of a light has to come to it, in shares of its length.
const REACH: f32 = 1e-3;

/// How far before a point of a light, in shares of its distance, a ray that is aimed at it may end on it by rounding. The near side of a
/// closed light is farther off than that.
const ROUNDING: f32 = 2e-5;

/// Lights that would fill more of what a receiver sees than this, in steradians, are met by chance often enough.
const LARGEST_LIGHT: f32 = 0.02;

/// Tells the random numbers of walks from those of branches.
const WALKS_BY_CHANCE: u32 = 0x57A1;

/// A point of a light that chains lead to.
#[derive(Clone, Copy)]
struct End {
    at: LightPoint,
    /// Unit direction of the straight line to it.
    wi: Vec3,
}

/// A chain whose last segment is clear.
#[derive(Clone, Copy)]
struct Found {
    chain: SpecularChain,
    /// Density of its direction at the receiver per solid angle over that of its end per area; over that of the straight line where the end is no
    /// point of a surface.
    density: f32,
    /// The point of the light, where that is a surface.
    lit: Option<Interaction>,
}

impl<'a: 's, 's, O: PathObserver, C: IndirectLight> PathTracer<'a, 's, O, C> {
    /// Forgets where the path was scattered last, since it has not come along a chain.
    pub(super) fn forget_crossed(&mut self) {
        if let Some(crossed) = self.indirect.crossed() {
            *crossed = None;
        }
    }

    /// Notes that the path goes on from a surface.
    #[inline(never)]
    pub(super) fn note_crossed(
        &mut self,
        path: &CameraPath<'s>,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
    ) {
        let scene = self.scene();
        let Some(noted) = self.indirect.crossed() else { return };
        let state = &path.state;
        if state.connectable {
            let start = leaving(surface, state.media);
            let (d, pdf, first) = (state.ray.d, path.pdf, ObjectId::default());
            *noted = Some(Crossed { start, receiver: path.receiver, d, pdf, via: None, first });
            return;
        }
        let Some(crossed) = noted else { return };
        let link = Link::at(scene, surface, bsdf, &scene.shading(&surface.at, surface.u));
        let ng = surface.at.point.ng;
        let is_refracted = state.ray.d.dot(ng) * surface.wo.dot(ng) < 0.0;
        let via = match (link, crossed.via) {
            (Some(Link::Boundary), None) if is_refracted => Via::Boundaries(1),
            (Some(Link::Boundary), Some(Via::Boundaries(n))) if is_refracted => Via::Boundaries(n + 1),
            (Some(Link::Mirror), None) => Via::Mirror,
            _ => return *noted = None,
        };
        if crossed.via.is_none() {
            crossed.first = surface.at.object;
        }
        crossed.via = Some(via);
    }

    /// The weight of light that the path has met behind mirrors or clear boundaries.
    ///
    /// * `at`, `d`: as for [`PathTracer::mis_weight`]
    #[inline(never)]
    pub(super) fn weight_behind_glass(
        &mut self,
        path: &CameraPath<'s>,
        hit: &LightHit,
        at: &LightPoint,
        d: Vec3,
    ) -> f32 {
        let technique = self.settings.technique;
        let crossed = self.indirect.crossed().and_then(|crossed| *crossed);
        let Some((crossed, via)) = crossed.and_then(|crossed| Some((crossed, crossed.via?))) else {
            return 1.0;
        };
        if technique == Technique::Scattering {
            return 1.0;
        }
        let Crossed { start, receiver, .. } = &crossed;
        let scene = self.scene();
        let (end, pdf) = match at {
            LightPoint::Infinite { .. } => {
                let at = LightPoint::Infinite { through: receiver.p };
                let pdf = scene.pdf_li(hit.light, receiver, &at, d, self.lights);
                (End { at, wi: d }, pdf)
            }
            _ => {
                let end = End { at: *at, wi: (at.p() - receiver.p).normalize_or_zero() };
                let chosen = scene.lighting.sampler.pmf(hit.light, receiver, self.lights);
                let id = scene.lighting.sampler.id(hit.light);
                let pdf = scene.lighting.lights.pdf_area(id, at.p(), receiver.time);
                (end, if is_small(receiver, at.p(), pdf) { chosen * pdf } else { 0.0 })
            }
        };
        if pdf <= 0.0 {
            return 1.0;
        }
        let before = self.before(start, &end);
        let caster =
            self.indirect.casters().and_then(|casters| casters.find(receiver.p, before, crossed.first));
        let Some((caster, choice)) = caster else { return 1.0 };
        let chains = self.chains_by_caster(&path.state, start, &end, &caster);
        let is_gone = |found: &Found| found.chain.is_along(crossed.d, via);
        let Some(found) = chains.into_iter().flatten().find(is_gone) else { return 1.0 };
        match technique {
            Technique::Lights => 0.0,
            _ => power_heuristic(crossed.pdf * found.chain.probability, choice * pdf * found.density),
        }
    }

    /// Adds light of a light that was chosen for a vertex, as it comes through glass or by way of mirrors. On the straight line it may send nothing.
    ///
    /// Takes a number for the choice of a caster, and two for the point of a surface.
    #[inline(never)]
    pub(super) fn add_light_through_glass(
        &mut self,
        path: &mut CameraPath<'s>,
        at: Shaded<'_>,
        chosen: &ChosenLight,
    ) {
        if path.bounces >= self.settings.bounces || self.settings.only_mirrors {
            return;
        }
        let (state, surface) = (&mut path.state, at.surface);
        let to = Receiver { p: surface.at.point.p, n: Vec3::ZERO, time: surface.at.time };
        let choice_of_caster = state.draws.next_1d();
        let Some((li, pdf)) = self.end_of_chains(state, &to, chosen) else { return };
        let end = End { at: li.at, wi: li.wi };
        let start = leaving(surface, state.media);
        let before = self.before(&start, &end);
        let caster =
            self.indirect.casters().and_then(|casters| casters.choose(to.p, before, choice_of_caster));
        let Some((caster, choice)) = caster else { return };
        let drawn = DrawnLight { light: chosen.sampled.light, li, pdf };
        let state = path.state;
        let mut walk = ManifoldWalk::new(self.scene(), &start, &state.wavelengths, state.draws);
        let chains = walk.by_caster(&end.at, end.wi, &caster);
        let by_chance = drawn.li.is_delta.then(|| {
            let random = state.draws.split(WALKS_BY_CHANCE, 0, 1);
            walk.by_chance(&end.at, end.wi, &caster, &chains, &random)
        });
        *self.observer.counters() += walk.rays();
        let certain = chains.iter().flatten().map(|chain| (*chain, 1.0));
        for (chain, times) in certain.chain(by_chance.flatten()) {
            let Some(found) = self.clear(&state, &start, &end, chain) else { continue };
            self.add_light_of_chain(path, at, &drawn, &found, choice / times);
        }
    }

    /// The end of chains to a light: a point of its surface, a position, or a direction, which alone has its radiance;
    /// and the density with which it was drawn, the choice of the light included.
    fn end_of_chains(
        &self,
        state: &mut PathState<'s>,
        to: &Receiver,
        &ChosenLight { sampled, u }: &ChosenLight,
    ) -> Option<(LightLiSample, f32)> {
        let (scene, light) = (self.scene(), sampled.light);
        let (lights, id) = (&scene.lighting.lights, scene.lighting.sampler.id(light));
        let end = |at: LightPoint, is_delta: bool| {
            let wi = (at.p() - to.p).normalize_or_zero();
            LightLiSample { wi, radiance: Spectrum::BLACK, pdf: 1.0, is_delta, at }
        };
        if lights.is_surface(id) {
            let (at, pdf_area) = lights.sample_area(id, state.draws.next_2d(), to.time)?;
            let is_drawn = is_small(to, at.p(), pdf_area);
            return is_drawn.then(|| (end(at, false), sampled.probability * pdf_area));
        }
        if let Some(apex) = lights.apex(id) {
            return Some((end(LightPoint::Position(apex), true), sampled.probability));
        }
        let li = scene.sample_li(light, to, sampled.pair(u), &state.wavelengths, self.lights)?;
        // Of other lights that have a place no point is drawn.
        li.at.is_infinite().then_some((li, sampled.probability * li.pdf))
    }

    /// Adds light that comes along a chain.
    ///
    /// * `choice`: the probability with which it was found
    fn add_light_of_chain(
        &mut self,
        path: &CameraPath<'s>,
        Shaded { surface, bsdf, local }: Shaded<'_>,
        drawn: &DrawnLight,
        found: &Found,
        choice: f32,
    ) {
        let (scene, settings, state) = (self.scene(), self.settings, &path.state);
        let DrawnLight { light, li, pdf } = drawn;
        let chain = &found.chain;
        if path.bounces + chain.via.bounces() > settings.bounces {
            return;
        }
        let Some(wi) = local.to_local(chain.d) else { return };
        let scattered = bsdf.eval(local.wo, wi, Transport::Radiance);
        let mut wavelengths = state.wavelengths;
        if chain.is_dispersive {
            wavelengths.terminate_secondary();
        }
        let radiance = match (&li.at, &found.lit) {
            (LightPoint::Surface { .. }, Some(lit)) => {
                let hit = scene.surface_light(lit, chain.arrives, &wavelengths);
                hit.filter(|hit| hit.light == *light).map(|hit| hit.radiance)
            }
            // Of a point with a falloff of its own light has gone as far as the straight line is long.
            (LightPoint::Position(p), _) => {
                let p = *p - chain.arrives * (*p - surface.at.point.p).length();
                let to = Receiver { p, n: Vec3::ZERO, time: surface.at.time };
                let li = scene.sample_li(*light, &to, Vec2::ZERO, &wavelengths, self.lights);
                li.map(|li| li.radiance)
            }
            _ => Some(li.radiance),
        };
        let Some(radiance) = radiance else { return };
        let carried = state.beta * scattered * chain.beta;
        let q = choice * pdf * found.density;
        let p = directions::pdf(settings.directions, bsdf, local.wo, wi) * chain.probability;
        // [Veach 1997, eq. 9.15], both densities per solid angle of the direction in which the chain leaves the surface.
        let weight = match settings.technique {
            Technique::Combined if !li.is_delta => power_heuristic(q, p),
            _ => 1.0,
        };
        let added = carried * radiance * (weight / q);
        if !added.is_finite() || added.is_black() {
            return;
        }
        let rgb = sensor::to_rgb(added, &wavelengths);
        let about = || About {
            eta: state.media.eta(),
            weight: sensor::to_rgb(carried, &wavelengths),
            light: Some(scene.lighting.sampler.id(*light)),
        };
        self.observer.joined(RayKind::Shadow, scene, &chain.last, about, || rgb);
        self.estimate.add_sensed(state, &wavelengths, added, scene.lighting.sampler.group(*light));
    }

    /// The object that the straight line to an end meets first.
    fn before(&mut self, start: &ChainStart, end: &End) -> Option<ObjectId> {
        let ray = start.point.ray_to(&end.at, end.wi, start.time);
        self.observer.counters().shadow += 1;
        let mut at = Interaction::default();
        self.scene().trace_into(None, &ray, &mut at).then_some(at.object)
    }

    /// The chains by way of a caster whose last segments are clear.
    fn chains_by_caster(
        &mut self,
        state: &PathState<'s>,
        start: &ChainStart,
        end: &End,
        caster: &Caster,
    ) -> [Option<Found>; MOST_CHAINS] {
        let mut walk = ManifoldWalk::new(self.scene(), start, &state.wavelengths, state.draws);
        let chains = walk.by_caster(&end.at, end.wi, caster);
        *self.observer.counters() += walk.rays();
        chains.map(|chain| self.clear(state, start, end, chain?))
    }

    /// A chain, if nothing is in the way of its last segment.
    fn clear(
        &mut self,
        state: &PathState<'s>,
        start: &ChainStart,
        end: &End,
        chain: SpecularChain,
    ) -> Option<Found> {
        let scene = self.scene();
        let mut found = Found { chain, density: chain.spread, lit: None };
        match end.at {
            LightPoint::Surface { p, n, .. } => {
                let to_end = p - chain.last.o;
                let distance = to_end.length();
                let ray = Ray { d: to_end / distance, t_max: distance * (1.0 + REACH), ..chain.last };
                self.observer.counters().shadow += 1;
                let mut at = Interaction::default();
                let hits = scene.trace_into(None, &ray, &mut at);
                if !hits || at.hit.t < distance * (1.0 - ROUNDING) {
                    return None;
                }
                found.density /= n.dot(chain.arrives).abs();
                found.lit = Some(at);
            }
            LightPoint::Position(p) => {
                self.is_clear(state, &chain, &Ray { d: p - chain.last.o, t_max: 1.0, ..chain.last })?;
                found.density /= (p - start.point.p).length_squared();
            }
            LightPoint::Infinite { .. } => self.is_clear(state, &chain, &chain.last)?,
        }
        (found.density > 0.0 && found.density.is_finite()).then_some(found)
    }

    /// Panes that a path passes at random are in the way: it has then not come along a chain.
    fn is_clear(&mut self, state: &PathState<'s>, chain: &SpecularChain, last: &Ray) -> Option<()> {
        let scene = self.scene();
        let eta = chain.media.eta_of_segment(scene);
        let visible = connect(scene, last, eta, &state.wavelengths, self.observer);
        (visible == Spectrum::WHITE).then_some(())
    }
}

/// Whether a light is worth being drawn.
///
/// * `p`: a point of it, drawn with the density `pdf_area` per area
fn is_small(to: &Receiver, p: Vec3, pdf_area: f32) -> bool {
    pdf_area * (p - to.p).length_squared() > 1.0 / LARGEST_LIGHT
}

/// A surface as chains leave it: on the side of the path.
///
/// * `media`: around there
fn leaving(surface: &SurfaceInteraction, media: MediumStack) -> ChainStart {
    let point = surface.at.point;
    ChainStart { point, time: surface.at.time, side: surface.wo.dot(point.ng), media }
}
