//! The steps of a path in scenes with participating media.

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::medium::PhaseSample;
use kajo_core::sampler::SampleStream;
use kajo_core::scene::{Interaction, Scene};
use kajo_math::{Ray, robust::offset_origin};

use super::steps::MOST_SURFACES;
use super::{MediumInteraction, MediumStack, Passage, PathState};
use crate::trail::{PathObserver, RayKind};

/// Goes on along a direction drawn by the phase function, whose value over its density is 1 in the lane that drew it.
pub fn follow_phase(
    path: &mut PathState<'_>,
    at: &MediumInteraction<'_>,
    PhaseSample { wi, value }: PhaseSample,
    observer: &mut impl PathObserver,
) {
    observer.next(RayKind::Scattered);
    path.connectable = true;
    path.lanes.r_l = path.lanes.r_u;
    if let Some(colors) = value.colors {
        path.turn_by_lanes(colors);
    }
    if let Some(differential) = &mut path.differential {
        let (d, t) = (path.ray.d, at.p.distance(path.ray.o));
        *differential = differential.transferred(d, t, d).scattered(wi).usable();
    }
    path.ray = Ray { time: at.time, ..Ray::new(at.p, wi) };
    path.scatterings += 1;
}

/// What a segment that joins two vertices is followed with.
pub struct Joining<'p, 's> {
    pub wavelengths: &'p Wavelengths,
    /// The lane that draws collisions.
    pub hero: u32,
    /// Densities of the paths to its ends, by lanes.
    pub r_u: Spectrum,
    /// The random numbers that are left.
    pub draws: &'p mut SampleStream<'s>,
}

impl<'p, 's> Joining<'p, 's> {
    /// From the last vertex of a path.
    pub fn from(path: &'p mut PathState<'s>) -> Joining<'p, 's> {
        let PathState { wavelengths, lanes, draws, .. } = path;
        Joining { wavelengths, hero: lanes.hero, r_u: lanes.r_u, draws }
    }
}

/// Transmittance of a segment between two vertices: of media, their boundaries, holes and panes.
///
/// As [`super::connect`], with what media absorb, and by lanes.
///
/// * `media`: around the start of the segment
///
/// May take random numbers.
pub fn connect_through_media(
    scene: &Scene,
    segment: &Ray,
    mut media: MediumStack,
    mut with: Joining<'_, '_>,
    observer: &mut impl PathObserver,
) -> Passage {
    if !media.connects(scene) {
        return Passage::closed();
    }
    observer.counters().shadow += 1;
    let mut passage = Passage::open(with.r_u);
    if !scene.appearance.has_passages {
        if scene.occluded(segment) {
            return Passage::closed();
        }
        through_media(scene, &unit(segment), &media, &mut with, &mut passage);
        return passage;
    }
    // Boundaries have to be met in their order, one after the other.
    let mut ray = *segment;
    let mut at = Interaction::default();
    for _ in 0..MOST_SURFACES {
        let hits = scene.trace_into(None, &ray, &mut at);
        if hits {
            ray.t_max = at.hit.t;
        }
        through_media(scene, &unit(&ray), &media, &mut with, &mut passage);
        if !hits || passage.t.is_black() {
            return passage;
        }
        if !cross(scene, &ray, &at, &mut media, with.wavelengths, &mut passage) {
            break;
        }
        let o = offset_origin(at.point.p, at.point.p_error, at.point.ng, ray.d);
        ray = match segment.t_max.is_finite() {
            true => Ray { o, d: segment.at(segment.t_max) - o, t_max: 1.0, ..ray },
            false => Ray { o, t_max: f32::INFINITY, ..ray },
        };
    }
    Passage::closed()
}

/// Passes a surface straight on; `false` where nothing does.
fn cross(
    scene: &Scene,
    ray: &Ray,
    at: &Interaction,
    media: &mut MediumStack,
    wavelengths: &Wavelengths,
    passage: &mut Passage,
) -> bool {
    let cos = at.crossing_cosine(ray.d.normalize());
    let passed = scene.passage(at, media.eta(), wavelengths, cos);
    if passed.is_black() {
        return false;
    }
    passage.t *= passed;
    let Some(interior) = scene.interior(at, wavelengths, 0.5) else { return true };
    let interface = media.interface(at.object, &interior, ray.d.dot(at.point.ng) < 0.0);
    media.cross(&interface);
    // Paths that meet a hidden surface are not weighed against connections.
    interface.is_real
}

/// Goes on through the medium around the start of a ray of unit direction, to its end.
pub(super) fn through_media(
    scene: &Scene,
    ray: &Ray,
    media: &MediumStack,
    with: &mut Joining<'_, '_>,
    passage: &mut Passage,
) {
    passage.t *= media.transmittance(ray.t_max);
    if media.differs_by_lanes(scene) {
        passage.through_all(scene, media, ray, with.wavelengths, with.hero, with.draws);
    } else if let Some(medium) = media.medium() {
        passage.through(scene, medium, ray, with.wavelengths, with.hero, with.draws);
    }
}

/// The same ray with a direction of unit length.
fn unit(ray: &Ray) -> Ray {
    let length = ray.d.length();
    Ray { d: ray.d / length, t_max: ray.t_max * length, ..*ray }
}
