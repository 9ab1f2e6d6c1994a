//! The steps themselves.

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::bsdf::{Bsdf, BsdfSample, Transport};
use kajo_core::light::{LightLiSample, LightSelection, Receiver, SampledLight};
use kajo_core::scene::{Interaction, Scene};
use kajo_core::space::Space;
use kajo_core::{LightIndex, RayOffset};
use kajo_math::{Ray, Vec2, Vec3};

use super::arrival::{TracedSegment, arrive};
use super::curves::{self, Curve};
use super::overlap::sample_collision;
use super::{MediumInteraction, PathState, SurfaceInteraction, differentials};
use crate::trail::{About, PathObserver, RayKind};

/// Scatterings after which paths may end at random.
const SAFE_BOUNCES: u32 = 3;

/// Share of what it began with below which a path may end because it carries little. Above it what is saved is less than what the
/// noise costs: in closed rooms of matt and of glossy surfaces the squared error is 6 to 21 % less than with 1, for 5 to 16 % more rays.
const FAINT: f32 = 0.5;

/// Upper bound on the survival probability of Russian roulette, so that paths between perfect mirrors end.
const LARGEST_SURVIVAL: f32 = 0.98;

/// Surfaces that one path may meet, those that it passes straight on included.
///
/// Bounces are counted on their own; but holes, panes and surfaces hidden in a medium of higher priority cost none, and
/// rounding may put a path in front of the same one for ever.
pub const MOST_SURFACES: u32 = 1 << 14;

/// What becomes of a ray that is followed.
///
/// By the time an event is reported the path has been shifted to the frequency at it ([`PathState::shift_frequency`]): light that is
/// found there is asked for at the path's wavelengths and multiplied by its `beta`, and no event has to say how far it was shifted.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// It hits a surface, which was written to a [`SurfaceInteraction`].
    Surface,
    /// It is scattered by a medium before it comes to a surface.
    Medium(MediumInteraction<'a>),
    /// It leaves the scene in this unit direction.
    Escaped(Vec3),
    /// Nothing of it arrives anywhere: the path has met more surfaces than a path may.
    Absorbed,
}

/// Follows the path's ray to the next surface, through the medium around its start:
///
/// ```text
/// beta <- beta T,     T = exp(-sigma_a length)
/// ```
///
/// In a body that bends light along a curve, whose change of frequency is applied as well.
///
/// Random numbers: those of null and real collisions in participating media, then one where the material is a mixture.
#[inline(always)]
pub fn extend<'a>(
    scene: &'a Scene,
    path: &mut PathState<'_>,
    surface: &mut SurfaceInteraction,
    observer: &mut impl PathObserver,
) -> Event<'a> {
    if path.surfaces == MOST_SURFACES {
        return Event::Absorbed;
    }
    path.surfaces += 1;
    if scene.space() == Space::Curved
        && let Some((medium, body)) = path.media.curved(scene)
    {
        match curves::trace_curve(scene, path, medium, body, surface, observer) {
            Curve::Meets => return Event::Surface,
            Curve::Ends => return Event::Absorbed,
            Curve::GoesOn => {}
        }
    }
    let at = &mut surface.at;
    let hits = scene.trace_into(None, &path.ray, at);
    let extent = if hits { at.hit.t } else { f32::INFINITY };
    observer.traced(scene, path, extent);
    if path.carries_media
        && let Some(collision) = sample_collision(scene, path, extent, observer)
    {
        return Event::Medium(collision);
    }
    observer.ended(scene, &path.ray, hits.then_some(&*at), || About {
        eta: path.media.eta(),
        weight: sensor::to_rgb(path.beta, &path.wavelengths),
        light: None,
    });
    if !hits {
        return Event::Escaped(path.ray.d);
    }
    if path.differential.is_some() {
        differentials::arrive(path, surface);
    }
    let (wo, length) = (-path.ray.d, surface.at.hit.t);
    arrive(scene, path, surface, TracedSegment { wo, length });
    Event::Surface
}

/// Follows the path to the next surface that is there, [`extend`] and [`cross_hidden`] in turn.
///
/// * `first`: filled with the first surface, there or not, if it is empty
#[inline(always)]
pub fn advance<'a>(
    scene: &'a Scene,
    path: &mut PathState<'_>,
    surface: &mut SurfaceInteraction,
    first: &mut Option<Interaction>,
    observer: &mut impl PathObserver,
) -> Event<'a> {
    loop {
        let event = extend(scene, path, surface, observer);
        if !matches!(event, Event::Surface) {
            return event;
        }
        if first.is_none() {
            *first = Some(surface.at);
        }
        if !cross_hidden(path, surface, observer) {
            return event;
        }
    }
}

/// Passes an interface inside a medium of higher priority than its own, which is not there; `false` at a surface that is.
#[inline]
pub fn cross_hidden(
    path: &mut PathState<'_>,
    surface: &SurfaceInteraction,
    observer: &mut impl PathObserver,
) -> bool {
    let Some(hidden) = surface.interface.filter(|interface| !interface.is_real) else { return false };
    path.media.cross(&hidden);
    // Shadow rays end here: what the path hits from here on could not have been found by one.
    path.connectable = false;
    observer.next(RayKind::Transmitted);
    path.ray = straight_on(path, surface);
    true
}

/// How the surface scatters.
#[inline(always)]
pub fn shade<'s>(scene: &'s Scene, path: &PathState<'_>, surface: &SurfaceInteraction) -> Bsdf<'s> {
    let eta_outside = surface.interface.map_or_else(|| path.media.eta(), |interface| interface.eta_outside);
    scene.bsdf(&surface.at, &path.wavelengths, eta_outside, surface.u)
}

/// Goes straight on through a hole, or through a pane that the path is to pass, as [`connect`] does; `false` where it is
/// scattered.
///
/// The vertex before stays the previous vertex of the path: connections pass holes and panes too, weakened by the same share. The
/// probability of passing is a common factor of the densities of all sampling techniques, and is left out of all of them.
///
/// * `bsdf`: scattering there; of a pane that is not passed a mirror is left
///
/// Takes a number at panes.
#[inline(always)]
pub fn pass_straight(
    scene: &Scene,
    path: &mut PathState<'_>,
    surface: &SurfaceInteraction,
    bsdf: &mut Bsdf<'_>,
) -> bool {
    if !scene.appearance.has_passages {
        return false;
    }
    let draws = &mut path.draws;
    let passed = bsdf.cross(|| (surface.at.crossing_cosine(-surface.wo), draws.next_1d()));
    let Some(share) = passed else { return false };
    path.beta *= share;
    // A boundary that light does not notice is the end of a medium all the same.
    if let Some(interface) = &surface.interface {
        path.media.cross(interface);
    }
    path.ray = straight_on(path, surface);
    true
}

/// The ray that goes on from a surface as if it were not there.
pub fn straight_on(path: &PathState<'_>, surface: &SurfaceInteraction) -> Ray {
    surface.at.point.ray_towards(-surface.wo, f32::INFINITY, path.ray.time, RayOffset::Auto)
}

/// Light drawn for a vertex.
#[derive(Clone, Copy, Debug)]
pub struct DrawnLight {
    /// The light that was chosen.
    pub light: LightIndex,
    /// What it sends.
    pub li: LightLiSample,
    /// The density of `li` times the probability of the choice.
    pub pdf: f32,
}

/// Light drawn for a vertex, whether or not anything is in the way; `None` where none can arrive.
///
/// Takes three numbers. The first one is left out; the other two are for the light and the position on it.
#[inline]
pub fn sample_light<'a>(
    scene: &Scene,
    path: &mut PathState<'_>,
    receiver: &Receiver,
    by: impl Into<LightSelection<'a>>,
) -> Option<DrawnLight> {
    let by = by.into();
    let chosen = choose_light(scene, path, receiver, by)?;
    light_of_choice(scene, path, receiver, &chosen, by)
}

/// A light chosen for a vertex.
#[derive(Clone, Copy, Debug)]
pub struct ChosenLight {
    /// Which one, and how probable it was.
    pub sampled: SampledLight,
    /// The numbers that it was chosen by, uniform in [0, 1)².
    pub u: Vec2,
}

/// The first half of [`sample_light`]: a light for a vertex.
#[inline]
pub fn choose_light<'a>(
    scene: &Scene,
    path: &mut PathState<'_>,
    receiver: &Receiver,
    by: impl Into<LightSelection<'a>>,
) -> Option<ChosenLight> {
    path.draws.skip(1);
    let u = path.draws.next_2d();
    Some(ChosenLight { sampled: scene.lighting.sampler.sample(receiver, u.x, by)?, u })
}

/// The second half: what the light that was chosen sends.
///
/// * `by`: how it was chosen
#[inline]
pub fn light_of_choice(
    scene: &Scene,
    path: &PathState<'_>,
    receiver: &Receiver,
    chosen: &ChosenLight,
    by: LightSelection<'_>,
) -> Option<DrawnLight> {
    let &ChosenLight { sampled: SampledLight { light, probability, .. }, u } = chosen;
    let li = scene.sample_li(light, receiver, chosen.sampled.pair(u), &path.wavelengths, by)?;
    (!li.radiance.is_black()).then_some(DrawnLight { light, li, pdf: li.pdf * probability })
}

/// The share of light that comes along a segment between two vertices, in one medium: less than 1 through holes and panes,
/// and nothing where anything else is between or where light bends. What the medium absorbs is left out; see [`super::MediumStack::transmittance`].
///
/// * `eta`: index of refraction of the medium, [`super::MediumStack::eta_of_segment`]
#[inline]
pub fn connect(
    scene: &Scene,
    segment: &Ray,
    eta: Option<f32>,
    wavelengths: &Wavelengths,
    observer: &mut impl PathObserver,
) -> Spectrum {
    let Some(eta) = eta else { return Spectrum::BLACK };
    observer.counters().shadow += 1;
    scene.transmittance(segment, eta, wavelengths)
}

/// Goes on along a direction that was sampled at a surface:
///
/// ```text
/// beta <- beta f |cos| / p
/// ```
///
/// * `wi`: the direction in world space
#[inline(always)]
pub fn follow(
    path: &mut PathState<'_>,
    surface: &SurfaceInteraction,
    wi: Vec3,
    sample: &BsdfSample,
    observer: &mut impl PathObserver,
) {
    let kind = if sample.kind.transmission {
        observer.counters().refracted += 1;
        if let Some(interface) = &surface.interface {
            path.media.cross(interface);
        }
        RayKind::Transmitted
    } else {
        observer.counters().reflected += 1;
        RayKind::Reflected
    };
    observer.next(if sample.kind.delta { kind } else { RayKind::Scattered });
    path.beta *= sample.weight;
    if path.mode == Transport::Radiance {
        path.eta_scale *= sample.eta * sample.eta;
    }
    path.connectable = !sample.kind.delta;
    if path.carries_media {
        path.lanes.r_l = path.lanes.r_u;
    }
    path.ray = surface.at.point.ray_towards(wi, f32::INFINITY, path.ray.time, RayOffset::Auto);
    path.scatterings += 1;
}

/// Russian roulette [Arvo and Kirk 1990]: whether the path goes on. Where it carries less than [`FAINT`] it ends with the probability
/// `1 - q`, and what survives counts `1 / q` times.
///
/// * `bounces`: scatterings that count; the first few never end a path
/// * `plays`: whether paths end at random at all; those that carry nothing end anyhow
///
/// Takes a number where chance decides.
#[inline]
pub fn survives(path: &mut PathState<'_>, bounces: u32, plays: bool) -> bool {
    survives_at_most(path, bounces, Roulette { plays, most: LARGEST_SURVIVAL, gain: 1.0 })
}

/// The same for a path whose directions were not drawn by scattering alone: where a guide sends many paths each of them carries little,
/// and is worth following all the same.
///
/// * `gain`: how many times more the path would carry if its directions had been drawn by scattering
pub fn survives_guided(path: &mut PathState<'_>, bounces: u32, plays: bool, gain: f32) -> bool {
    survives_at_most(path, bounces, Roulette { plays, most: LARGEST_SURVIVAL, gain })
}

/// The same behind a collision in a medium.
///
/// In a body that light is scattered in many times paths that have lost nothing go on: with a chance to end each time few of them would
/// come out, each of a large weight.
#[inline]
pub fn survives_in_medium(path: &mut PathState<'_>, bounces: u32, plays: bool, gain: f32) -> bool {
    survives_at_most(path, bounces, Roulette { plays, most: 1.0, gain })
}

/// How Russian roulette is played.
struct Roulette {
    plays: bool,
    /// The largest probability of survival.
    most: f32,
    /// How many times more the path would carry if its directions had been drawn by scattering.
    gain: f32,
}

#[inline]
fn survives_at_most(
    path: &mut PathState<'_>,
    bounces: u32,
    Roulette { plays, most, gain }: Roulette,
) -> bool {
    let left = path.wavelengths.max_lane(path.beta) * path.eta_scale * gain;
    if left.is_nan() || left <= 0.0 {
        return false;
    }
    if !plays || bounces <= SAFE_BOUNCES {
        return true;
    }
    let q = (left / FAINT).min(most);
    if path.draws.next_1d() >= q {
        return false;
    }
    path.beta *= 1.0 / q;
    true
}
