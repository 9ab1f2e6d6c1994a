//! Chains of refraction, or of one reflection, between two given points: walks on the manifold of specular paths.
//!
//! Between a receiver `x0` and a point `y` of a light stand the smooth boundaries of clear media. A ray that leaves `x0` in the
//! direction `w` is refracted at each of them by Snell's law, and passes `y` by
//!
//! ```text
//! e(w) = the point of the last segment nearest to y, less y;     of light from infinitely far: its direction less that of y
//! ```
//!
//! A chain that joins both is a root of these two equations for the two coordinates of `w`. Newton's method finds it from a
//! direction to begin with [Hanika, Droske and Fascione 2015, 3]:
//!
//! ```text
//! w <- w - s J^-1 e,       J = de/dw,       s = 1, 1/2, 1/4, ..
//! ```
//!
//! Each step traces the whole chain anew, so that what is walked on is always the manifold of true refractions [Jakob and
//! Marschner 2012, 4.3]; `s` is halved until the chain exists and misses `y` by less. `J` is what ray differentials carry along the
//! chain [Igehy 1999]; by the matrix of the constraints it would be the same. Its determinant is the area across the last
//! segment for a solid angle at `x0`,
//!
//! ```text
//! dw / dA_y = |cos_y| / |det J|
//! ```
//!
//! the generalized geometry term but for the cosine at `x0` [Jakob and Marschner 2012, eq. 11]. Walks take no random numbers, and are
//! the same for the same ends: for a `y` that was sampled by scattering through some chain, it can be decided whether a
//! walk would have found that very chain.
//!
//! Walks begin at one object, a caster, in a few directions that depend on its box and both ends. The chain of such a direction is as long
//! as it comes nearest to `y`, and those that Newton's method would turn least are walked on from. So several chains may be found, each kept once.
//!
//! Those that are not found so can be looked for from a random direction [Zeltner, Georgiev and Jakob 2020, 4.2]. A walk from there ends
//! in a chain with some probability `p`, which nobody knows; but walks made anew until one ends in the same chain are `1/p` in the mean.

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::ObjectId;
use kajo_core::bsdf::{Bsdf, BsdfSample, Transport};
use kajo_core::differential::RayDifferential;
use kajo_core::interaction::SurfacePoint;
use kajo_core::light::LightPoint;
use kajo_core::sampler::SampleStream;
use kajo_core::scene::{Interaction, Scene};
use kajo_core::shading::Shading;
use kajo_math::{Frame, Ray, Vec2, Vec3};

use super::{Event, LocalFrame, MediumStack, PathState, SurfaceInteraction, advance, follow, shade};
use crate::ray_counters::RayCounters;
use crate::trail::Counting;

/// Boundaries that a chain may cross: in and out of the wall of a hollow body on both sides.
pub const MOST_INTERFACES: u32 = 4;

/// Chains that one walk may trace.
const MOST_TRACED: u32 = 16;

/// Largest turn of one step, radians.
const LARGEST_TURN: f32 = 0.5;

/// Halvings of a step before the walk is given up.
const MOST_HALVINGS: u32 = 4;

/// Convergence threshold of Newton's method: distance by which the end is missed, over the distance of the two ends.
const GOAL: f32 = 5e-5;

/// Convergence threshold on the last Newton step, radians. Near a fold of the caustic, where solutions meet and vanish, no step is that small.
const LAST_TURN: f32 = 5e-4;

/// Looser threshold on the missed distance, where rounding lets no step reduce it any more.
const NEAR_ENOUGH: f32 = 2e-4;

/// Solutions whose directions differ by less than this, in radians, are taken for one; for small casters by less than a
/// share of their angular extent.
const SAME: f32 = 1e-3;
const SAME_OF_CASTER: f32 = 0.02;

/// Step of the finite differences, radians: small beside the curvature of surfaces.
const STEP: f32 = 1e-4;

/// Chooses refraction wherever there is any.
const REFRACT: f32 = 1.0f32.next_down();

/// Number of seed directions.
const SEEDS: usize = 7;

/// Offsets of the seeds from the middle of a caster, as shares of its extent.
const BESIDE: [f32; 4] = [0.5, -0.5, 0.85, -0.85];

/// Largest number of seeds that walks begin in.
const MOST_WALKS: usize = 3;

/// A seed is skipped if its first Newton step lands within this share of the step's length of a known solution.
const KNOWN: f32 = 0.25;

/// Seeds after the first are used only if their first Newton step is shorter than this share of the caster's angular extent.
const FARTHEST_STEP: f32 = 0.6;

/// Largest number of solutions per caster.
pub const MOST_CHAINS: usize = 3;

/// Walks from random directions after which a chain is not looked for again.
const MOST_TRIALS: u32 = 256;

/// The specular events of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Via {
    /// So many smooth boundaries of clear media, which refract it.
    Boundaries(u32),
    /// One smooth mirror.
    Mirror,
}

impl Via {
    /// How often light is scattered there.
    pub fn bounces(self) -> u32 {
        match self {
            Via::Boundaries(n) => n,
            Via::Mirror => 1,
        }
    }
}

/// Kind of a specular vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    /// A smooth boundary of clear media.
    Boundary,
    /// A smooth mirror.
    Mirror,
}

impl Link {
    /// The kind of vertex that a surface with this scattering is; `None` where it is not specular.
    pub fn of(bsdf: &Bsdf<'_>) -> Option<Link> {
        match bsdf {
            Bsdf::Dielectric(_) if bsdf.is_delta() => Some(Link::Boundary),
            Bsdf::Conductor(_) if bsdf.is_delta() => Some(Link::Mirror),
            _ => None,
        }
    }

    /// The same for a surface whose normals are those of its shape and that is there in every sample; `None` for
    /// others, on which chains cannot be found again.
    pub fn at(
        scene: &Scene,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        shading: &Shading,
    ) -> Option<Link> {
        let link = Link::of(bsdf).filter(|_| !shading.leans && !scene.is_mixture(&surface.at))?;
        let is_real = surface.interface.is_some_and(|interface| interface.is_real);
        (is_real == (link == Link::Boundary)).then_some(link)
    }
}

/// An object that chains may begin at.
#[derive(Clone, Copy, Debug)]
pub struct Caster {
    /// The object.
    pub object: ObjectId,
    /// What it is.
    pub link: Link,
    /// The middle of its box.
    pub center: Vec3,
    /// Half the extents of that.
    pub half: Vec3,
}

/// Where chains begin.
#[derive(Clone, Copy, Debug)]
pub struct ChainStart {
    /// The receiver.
    pub point: SurfacePoint,
    /// Moment within the shutter interval.
    pub time: f32,
    /// Cosine with the geometric normal, of any length, of directions on the side that chains leave it on.
    pub side: f32,
    /// The media on that side.
    pub media: MediumStack,
}

/// A chain that was found.
#[derive(Clone, Copy, Debug)]
pub struct SpecularChain {
    /// Unit direction in which it leaves the receiver.
    pub d: Vec3,
    /// Unit direction of its last segment, towards the light.
    pub arrives: Vec3,
    /// What is left of radiance that comes along it: Fresnel transmittances, with the squares of the indices, and absorption.
    pub beta: Spectrum,
    /// Probability that a path which leaves along `d` is refracted all along the chain.
    pub probability: f32,
    /// Area across the last segment at its end for a solid angle at the receiver; solid angle of light from infinitely far.
    pub spread: f32,
    /// What it goes through.
    pub via: Via,
    /// The first object that it meets.
    pub first: ObjectId,
    /// Whether one of them refracts by wavelength, so that the chain is that of the first alone.
    pub is_dispersive: bool,
    /// From the last boundary to the light, of unit direction.
    pub last: Ray,
    /// Around the last segment.
    pub media: MediumStack,
    /// Directions that differ by less are those of one chain, radians.
    pub tolerance: f32,
}

impl SpecularChain {
    /// Whether a path that left the receiver along the unit vector `d` and came through this has gone along this chain.
    pub fn is_along(&self, d: Vec3, via: Via) -> bool {
        self.via == via && (self.d - d).length_squared() < self.tolerance * self.tolerance
    }
}

/// Walks from a receiver to points of lights.
pub struct ManifoldWalk<'a, 's> {
    scene: &'a Scene,
    start: &'a ChainStart,
    wavelengths: Wavelengths,
    draws: SampleStream<'s>,
    observer: Counting<'static>,
}

/// A chain that was traced, and by how much it misses its end.
struct Traced {
    chain: SpecularChain,
    frame: Frame,
    /// In shares of the distance.
    miss: f32,
    /// Length of the last segment.
    along: f32,
    /// The turn of the first segment that would make up for it, if all were linear.
    turn: Vec2,
}

/// Where a walk is to end.
#[derive(Clone, Copy)]
struct Goal {
    end: LightPoint,
    /// Unit direction of the straight line.
    straight: Vec3,
    /// Length of it; infinite for light from infinitely far.
    distance: f32,
}

impl<'a, 's> ManifoldWalk<'a, 's> {
    /// * `draws`: of the path; none are taken from it
    pub fn new(
        scene: &'a Scene,
        start: &'a ChainStart,
        wavelengths: &Wavelengths,
        draws: SampleStream<'s>,
    ) -> ManifoldWalk<'a, 's> {
        ManifoldWalk { scene, start, wavelengths: *wavelengths, draws, observer: Counting::default() }
    }

    /// The rays that were cast.
    pub fn rays(&self) -> RayCounters {
        self.observer.rays
    }

    /// The chains to a point of a light that begin at a caster, as far as walks come to them. Whether anything is in the way of their last
    /// segments is not asked.
    ///
    /// * `end`: where to
    /// * `wi`: unit direction of the straight line to it
    pub fn by_caster(
        &mut self,
        end: &LightPoint,
        wi: Vec3,
        caster: &Caster,
    ) -> [Option<SpecularChain>; MOST_CHAINS] {
        let mut found = [None; MOST_CHAINS];
        let goal = self.goal(end, wi);
        let (seeds, reach) = seeds(caster, self.start.point.p, wi);
        let mut begun = seeds.map(|d| self.trace_any(d, caster, &goal));
        for walked in 0..MOST_WALKS {
            let turn = |begun: &Option<(Traced, Via)>| {
                let length = begun.as_ref().map_or(f32::INFINITY, |(at, _)| at.turn.length());
                if length.is_nan() { f32::INFINITY } else { length }
            };
            let nearest = begun.iter_mut().min_by(|a, b| turn(a).total_cmp(&turn(b)));
            let Some((traced, via)) = nearest.and_then(Option::take) else { break };
            let length = traced.turn.length();
            if walked > 0 && length > reach {
                break;
            }
            // It leads to where another one ended.
            let ahead = turned(&traced.frame, traced.turn);
            let is_known =
                |known: &SpecularChain| known.via == via && (known.d - ahead).length() < KNOWN * length;
            if found.iter().flatten().any(is_known) {
                continue;
            }
            let Some(chain) = self.walk(traced, via, caster, reach, &goal) else { continue };
            let is_new =
                |slot: &Option<SpecularChain>| slot.is_none_or(|known| !known.is_along(chain.d, chain.via));
            if found.iter().all(is_new)
                && let Some(slot) = found.iter_mut().find(|slot| slot.is_none())
            {
                *slot = Some(chain);
            }
        }
        found
    }

    /// A chain to the same point that a walk from a random direction ends in and that is none of the `known`, and an
    /// unbiased estimate of one over the probability that such a walk does so, but for chains of less than a hundredth.
    ///
    /// * `known`: those of [`ManifoldWalk::by_caster`]
    /// * `random`: taken for nothing else; the walk takes its first three numbers, so that chains of mutated numbers keep what it finds
    pub fn by_chance(
        &mut self,
        end: &LightPoint,
        wi: Vec3,
        caster: &Caster,
        known: &[Option<SpecularChain>],
        random: &SampleStream<'_>,
    ) -> Option<(SpecularChain, f32)> {
        let goal = self.goal(end, wi);
        let p = self.start.point.p;
        let (_, reach) = seeds(caster, p, wi);
        let mut trial = |i: u32| {
            let u = Vec3::from_array([0, 1, 2].map(|axis| random.independent(3 * i + axis)));
            let d = (caster.center + caster.half * (2.0 * u - 1.0) - p).normalize_or_zero();
            let (traced, via) = self.trace_any(d, caster, &goal)?;
            self.walk(traced, via, caster, reach, &goal)
        };
        let chain = trial(0)?;
        if known.iter().flatten().any(|known| known.is_along(chain.d, chain.via)) {
            return None;
        }
        let again = |i: &u32| trial(*i).is_some_and(|again| chain.is_along(again.d, again.via));
        let trials = (1..MOST_TRIALS).find(again).unwrap_or(MOST_TRIALS);
        Some((chain, trials as f32))
    }

    /// * `wi`: unit direction of the straight line to `end`
    fn goal(&self, end: &LightPoint, wi: Vec3) -> Goal {
        let far = if end.is_infinite() { f32::INFINITY } else { (end.p() - self.start.point.p).length() };
        Goal { end: *end, straight: wi, distance: far }
    }

    /// The chain by way of a caster that a walk ends in.
    ///
    /// * `reach`: of [`seeds`]
    fn walk(
        &mut self,
        from: Traced,
        via: Via,
        caster: &Caster,
        reach: f32,
        goal: &Goal,
    ) -> Option<SpecularChain> {
        let chain = self.newton(from, via, goal).filter(|chain| chain.first == caster.object)?;
        Some(SpecularChain { tolerance: SAME.min(SAME_OF_CASTER * reach), ..chain })
    }

    /// Newton's method.
    fn newton(&mut self, mut at: Traced, via: Via, goal: &Goal) -> Option<SpecularChain> {
        let mut traced = 1;
        while at.miss > GOAL || at.turn.length() > LAST_TURN {
            match self.step(&at, via, goal, &mut traced) {
                Some(nearer) => at = nearer,
                None if at.miss < NEAR_ENOUGH && at.turn.length() <= LAST_TURN => break,
                None => return None,
            }
        }
        let d = turned(&at.frame, at.turn);
        (at.chain.spread > 0.0 && at.chain.beta.is_finite() && d.is_finite())
            .then_some(SpecularChain { d, ..at.chain })
    }

    /// One step of Newton's method from a chain to one that misses the end by less; `None` where there is none.
    ///
    /// * `traced`: chains that were traced so far
    fn step(&mut self, at: &Traced, via: Via, goal: &Goal, traced: &mut u32) -> Option<Traced> {
        let length = at.turn.length();
        if !length.is_finite() {
            return None;
        }
        let mut turn = at.turn * (LARGEST_TURN / length.max(LARGEST_TURN));
        for _ in 0..=MOST_HALVINGS {
            if *traced == MOST_TRACED {
                return None;
            }
            *traced += 1;
            if let Some(nearer) =
                self.trace(turned(&at.frame, turn), via, goal).filter(|next| next.miss < at.miss)
            {
                return Some(nearer);
            }
            turn *= 0.5;
        }
        None
    }

    /// A path that leaves the receiver.
    fn path_along(&self, d: Vec3) -> PathState<'s> {
        let ray = self.start.point.ray_towards(d, f32::INFINITY, self.start.time, kajo_core::RayOffset::Auto);
        let mode = Transport::Radiance;
        PathState::new(ray, self.wavelengths, Spectrum::WHITE, mode, self.start.media, self.draws)
    }

    /// The chain that leaves the receiver in the unit direction `d`; `None` where there is none, or on another side of the
    /// receiver than it is to.
    fn trace(&mut self, d: Vec3, via: Via, goal: &Goal) -> Option<Traced> {
        let mut tracing = self.begin(d)?;
        for _ in 0..via.bounces() {
            self.extend(&mut tracing, if via == Via::Mirror { Link::Mirror } else { Link::Boundary })?;
        }
        tracing.ended(via, goal)
    }

    /// The chain that leaves the receiver in the unit direction `d` for a caster, as long as it comes nearest to its end.
    fn trace_any(&mut self, d: Vec3, caster: &Caster, goal: &Goal) -> Option<(Traced, Via)> {
        let mut tracing = self.begin(d)?;
        self.extend(&mut tracing, caster.link)?;
        if tracing.first != caster.object {
            return None;
        }
        if caster.link == Link::Mirror {
            return Some((tracing.ended(Via::Mirror, goal)?, Via::Mirror));
        }
        let mut nearest: Option<(Traced, Via)> = None;
        for n in 1..=MOST_INTERFACES {
            let via = Via::Boundaries(n);
            let ended = tracing.ended(via, goal);
            let goes_on = n < MOST_INTERFACES && self.extend(&mut tracing, Link::Boundary).is_some();
            // What lies beyond the next boundary is not met before it.
            let ended = ended.filter(|ended| !goes_on || ended.along <= tracing.surface.length);
            if let Some(ended) = ended
                && nearest.as_ref().is_none_or(|(nearest, _)| ended.miss < nearest.miss)
            {
                nearest = Some((ended, via));
            }
            if !goes_on {
                break;
            }
        }
        nearest
    }

    fn begin(&self, d: Vec3) -> Option<Tracing<'s>> {
        if d.dot(self.start.point.ng) * self.start.side <= 0.0 {
            return None;
        }
        let frame = Frame::from_normal(d);
        let mut path = self.path_along(d);
        path.differential =
            Some(RayDifferential { dp: [Vec3::ZERO; 2], dd: [STEP * frame.s, STEP * frame.t] });
        Some(Tracing {
            d,
            frame,
            path,
            surface: SurfaceInteraction::default(),
            first: ObjectId::default(),
            probability: 1.0,
            is_dispersive: false,
        })
    }

    /// Takes a chain to the next surface and scatters it there, if that is such a link.
    fn extend(&mut self, tracing: &mut Tracing<'s>, link: Link) -> Option<()> {
        let (scene, observer) = (self.scene, &mut self.observer);
        let Tracing { path, surface, .. } = tracing;
        let first = &mut Some(Interaction::default());
        if !matches!(advance(scene, path, surface, first, observer), Event::Surface) {
            return None;
        }
        if surface.is_dispersive() {
            path.wavelengths.terminate_secondary();
            tracing.is_dispersive = true;
        }
        let bsdf = shade(scene, path, surface);
        let shading = scene.shading(&surface.at, surface.u);
        if Link::at(scene, surface, &bsdf, &shading)? != link {
            return None;
        }
        let local = LocalFrame::new(&shading, surface.wo);
        let sample = bsdf.sample(local.wo, Vec2::ZERO, REFRACT, Transport::Radiance)?;
        let wi = local.to_world(&sample)?;
        if sample.kind.transmission != (link == Link::Boundary) {
            return None;
        }
        leave(scene, path, surface, wi, &sample)?;
        follow(path, surface, wi, &sample, observer);
        tracing.probability *= sample.pdf;
        if path.scatterings == 1 {
            tracing.first = surface.at.object;
        }
        Some(())
    }
}

/// A chain that is being traced.
struct Tracing<'s> {
    /// Unit direction in which it left the receiver.
    d: Vec3,
    frame: Frame,
    path: PathState<'s>,
    /// The last surface that it met.
    surface: SurfaceInteraction,
    /// The first object.
    first: ObjectId,
    probability: f32,
    is_dispersive: bool,
}

impl Tracing<'_> {
    /// The chain as it is, if it were to end now.
    fn ended(&self, via: Via, goal: &Goal) -> Option<Traced> {
        let &Tracing { d, frame, first, probability, is_dispersive, .. } = self;
        let path = &self.path;
        let chain = SpecularChain {
            d,
            arrives: path.ray.d,
            beta: path.beta * probability,
            probability,
            spread: 0.0,
            via,
            first,
            is_dispersive,
            last: path.ray,
            media: path.media,
            tolerance: SAME,
        };
        missing(chain, frame, path.differential.as_ref()?, goal)
    }
}

/// Directions from a receiver in which walks to a caster begin, and how far their first steps may lead, radians.
///
/// Those from outside its box are in the plane through its middle and the straight line to the light, where the chains of a ball lie, and one
/// lies across that plane; those from inside lead to the sides of the box, or are what mirrors along its sides would make of the straight line.
/// The last is that of the straight line.
fn seeds(caster: &Caster, p: Vec3, wi: Vec3) -> ([Vec3; SEEDS], f32) {
    let to_center = caster.center - p;
    let half = caster.half;
    let Vec3 { x, y, z } = wi;
    let turned = [[-x, y, z], [x, y, -z], [-x, y, -z], [x, -y, z], [-x, -y, z], [x, -y, -z]];
    let turned = turned.map(Vec3::from_array);
    // A receiver beside a hollow mirror is inside, one that touches a body of glass is not.
    let is_inside = |share: f32| to_center.abs().cmple(share * half).all();
    match caster.link {
        Link::Mirror if is_inside(1.25) => {
            let [a, b, c, d, e, f] = turned;
            return ([a, b, c, d, e, f, wi], 1.0);
        }
        Link::Boundary if is_inside(0.98) => {
            let to = |axis: Vec3| (to_center + half * axis).normalize_or(axis);
            let [a, b, c, d, e, f] = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z].map(to);
            return ([a, b, c, d, e, f, wi], 1.0);
        }
        _ => {}
    }
    let distance = to_center.length();
    let axis = to_center / distance;
    let Frame { s, t, .. } = Frame::from_tangent(axis, wi);
    // Of the ellipsoid in the box.
    let [across, other] = [s, t].map(|e| (half * e).length());
    let reach = FARTHEST_STEP * across.max(other) / distance;
    let [a, b, c, d] = BESIDE.map(|step| (to_center + s * (step * across)).normalize_or(axis));
    let beside = (to_center + t * (0.5 * other)).normalize_or(axis);
    match caster.link {
        Link::Boundary => ([axis, a, b, c, d, beside, wi], reach),
        // Walls that stand upright, or along the axes, send light back so.
        Link::Mirror => ([axis, a, b, turned[0], turned[1], turned[2], wi], reach),
    }
}

/// The unit direction that a turn leads to.
fn turned(frame: &Frame, turn: Vec2) -> Vec3 {
    (frame.n + frame.s * turn.x + frame.t * turn.y).normalize()
}

/// Takes the differential of a path from a link along the unit vector `wi`.
fn leave(
    scene: &Scene,
    path: &mut PathState<'_>,
    surface: &SurfaceInteraction,
    wi: Vec3,
    sample: &BsdfSample,
) -> Option<()> {
    let (differential, d) = (path.differential?, path.ray.d);
    let side = if d.dot(surface.at.point.n) > 0.0 { -1.0 } else { 1.0 };
    let n = side * surface.at.point.n;
    let dn = differential.dp.map(|dp| normal_change(scene, &surface.at, dp) * side);
    let left = match sample.kind.transmission {
        true => differential.refracted(d, wi, n, dn, 1.0 / sample.eta),
        false => differential.reflected(d, n, dn),
    };
    path.differential = Some(left.usable());
    Some(())
}

/// How the shading normal changes over a small displacement within the surface.
///
/// By the difference to one point beside, which is half the work of that between two and right to the thousandth part of what walks go by.
fn normal_change(scene: &Scene, at: &Interaction, dp: Vec3) -> Vec3 {
    /// Steps are this much larger than what is uncertain about the point.
    const CLEAR: f32 = 128.0;
    let length = dp.length();
    if length == 0.0 || !length.is_finite() {
        return Vec3::ZERO;
    }
    let step = (CLEAR * at.point.p_error.max_element() / length).max(1.0);
    for step in [step, -step] {
        if let Some(there) = scene.normal_beside(at, step * dp) {
            return (there - at.point.n) / step;
        }
    }
    Vec3::ZERO
}

/// By how much a chain misses its end, and what would make up for it; `None` where the end lies behind it.
///
/// * `frame`: about the direction in which it leaves the receiver
fn missing(
    mut chain: SpecularChain,
    frame: Frame,
    differential: &RayDifferential,
    goal: &Goal,
) -> Option<Traced> {
    let w = chain.arrives;
    let (miss, changes, along, scale) = if goal.end.is_infinite() {
        if w.dot(goal.straight) <= 0.0 {
            return None;
        }
        (w - goal.straight, differential.dd, f32::INFINITY, 1.0)
    } else {
        let to_end = goal.end.p() - chain.last.o;
        let along = to_end.dot(w);
        if along <= 0.0 {
            return None;
        }
        chain.beta *= chain.media.transmittance(along);
        chain.last.t_max = along;
        (along * w - to_end, differential.transferred(w, along, w).dp, along, goal.distance)
    };
    let across = Frame::from_normal(w);
    let flat = |v: Vec3| Vec2::new(across.s.dot(v), across.t.dot(v));
    let e = flat(miss);
    let [by_s, by_t] = changes.map(|change| flat(change) / STEP);
    let determinant = by_s.perp_dot(by_t);
    chain.spread = determinant.abs();
    // Cramer's rule for by_s x + by_t y = -e.
    let turn = Vec2::new(by_t.perp_dot(e), -by_s.perp_dot(e)) / determinant;
    Some(Traced { chain, frame, miss: miss.length() / scale, along, turn })
}

#[cfg(test)]
mod tests {
    use kajo_core::compile::{CompileOptions, compile};
    use kajo_core::sampler::{Sampler, SamplerKind};
    use kajo_scene::{MemoryAssets, SceneDesc};

    use super::*;

    /// All chains by way of a small caster leave a receiver in nearly the same direction: they are told apart by what the caster fills.
    #[test]
    fn chains_by_way_of_a_bead_are_told_apart() {
        for radius in [0.7, 0.0007f32] {
            let text = format!(
                "PerspectiveCamera {{ center 0 0 9  direction 0 0 -1  up 0 1 0  angle 40 }}
                 Materials {{ Glass glass {{ indexOfRefraction 1.5 }} }}
                 Group {{ MaterialIndex glass Sphere {{ center 0 2 0 radius {radius} }} }}"
            );
            let mut parsed = SceneDesc::parse_str(&text);
            let assets = MemoryAssets::new();
            let scene =
                compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut parsed.diagnostics);
            let scene = scene.unwrap_or_else(|| panic!("{:?}", parsed.diagnostics));
            let point = SurfacePoint { n: Vec3::Y, ng: Vec3::Y, ..SurfacePoint::default() };
            let start = ChainStart { point, time: 0.0, side: 1.0, media: MediumStack::default() };
            let object = ObjectId::from_index(0);
            let (center, half) = (2.0 * Vec3::Y, Vec3::splat(radius));
            let caster = Caster { object, link: Link::Boundary, center, half };
            let sampler = Sampler::new(SamplerKind::Uniform, 1);
            let draws = SampleStream::new(&sampler, 0, [0, 0], 0);
            let mut walk = ManifoldWalk::new(&scene, &start, &Wavelengths::RGB, draws);
            let found = walk.by_caster(&LightPoint::Position(4.0 * Vec3::Y), Vec3::Y, &caster);
            let chain = found.iter().flatten().next().expect("the chain through the middle");
            assert!(chain.d.abs_diff_eq(Vec3::Y, 1e-4 * radius), "{radius}: {}", chain.d);
            // An edge of the ball is `radius / 2` away.
            let beside = |turn: f32| (Vec3::Y + turn * Vec3::X).normalize();
            assert!(!chain.is_along(beside(0.4 * radius), chain.via), "{radius}");
            assert!(chain.is_along(beside(1e-3 * radius), chain.via), "{radius}");
        }
    }
}
