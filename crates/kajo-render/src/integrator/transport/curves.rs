//! The step of a path inside of a body that bends light.

use kajo_color::sensor;
use kajo_core::ObjectId;
use kajo_core::bsdf::Transport;
use kajo_core::curved_light::Outcome;
use kajo_core::differential::SurfaceFootprint;
use kajo_core::medium::MediumId;
use kajo_core::scene::Scene;
use kajo_core::space::Arrival;
use kajo_math::Ray;

use super::arrival::{TracedSegment, arrive};
use super::{PathState, SurfaceInteraction};
use crate::trail::{About, PathObserver};

/// What becomes of a path in a body that bends light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curve {
    /// It hits a surface, which is known.
    Meets,
    /// It is outside of the body without having met its surface: its ray is to be followed from there.
    GoesOn,
    /// Nothing of it gets anywhere.
    Ends,
}

/// Follows the path's ray along its curve to the next surface, which is that of the body if nothing is in it.
///
/// ```text
/// beta <- beta (n / n')^2 T
/// ```
///
/// for radiance, with the index `n` where the way begins and `n'` where it ends: radiance over `n^2` stays the same. Power is what it was.
/// Frequencies change by [`PathState::shift_frequency`].
///
/// Where the path is a camera's first ray, it is seen as the camera moves.
///
/// No connection finds what the path hits at the end, so it counts in full. What neighbouring samples cover there is not known.
/// Where the way depends on the wavelength only one is followed from here on.
#[cold]
#[inline(never)]
pub fn trace_curve(
    scene: &Scene,
    path: &mut PathState<'_>,
    medium: MediumId,
    body: ObjectId,
    surface: &mut SurfaceInteraction,
    observer: &mut impl PathObserver,
) -> Curve {
    if scene.appearance.media.is_dispersive(medium) && !path.wavelengths.secondary_terminated() {
        path.end_secondary_wavelengths();
    }
    let is_first = path.surfaces == 1 && path.mode == Transport::Radiance;
    if is_first && let Some((d, ratio)) = scene.appearance.media.observed(medium, &path.ray) {
        path.ray.d = d;
        path.shift_frequency(ratio);
    }
    let eta = path.media.eta();
    let weight = path.beta;
    let wavelengths = path.wavelengths;
    let about = || About { eta, weight: sensor::to_rgb(weight, &wavelengths), light: None };
    let chords = |chord: &Ray| observer.bent(scene, chord, about);
    let way = scene.follow(&path.ray, medium, body, &path.wavelengths, &mut surface.at, chords);
    let Some(Arrival { outcome, d, length, chord, eta, eta_scale, g }) = way else { return Curve::GoesOn };
    path.connectable = false;
    path.differential = None;
    surface.at.footprint = SurfaceFootprint::default();
    if path.mode == Transport::Radiance {
        path.beta *= eta_scale;
        path.eta_scale *= 1.0 / eta_scale;
    }
    path.media.set_eta(body, eta);
    path.shift_frequency(g);
    match outcome {
        Outcome::Lost => {
            observer.counters().lost += 1;
            Curve::Ends
        }
        Outcome::Absorbed => {
            observer.ended(scene, &chord, None, about);
            Curve::Ends
        }
        Outcome::Leaves => {
            observer.bent(scene, &chord, about);
            path.media.leave(body);
            path.ray = Ray { time: path.ray.time, ..Ray::new(chord.at(1.0), d) };
            Curve::GoesOn
        }
        Outcome::Meets => {
            observer.ended(scene, &chord, Some(&surface.at), about);
            // As for a straight ray, `t` is the length of the path: layers record that of the first hit.
            surface.at.hit.t = length;
            arrive(scene, path, surface, TracedSegment { wo: -d, length });
            Curve::Meets
        }
    }
}
