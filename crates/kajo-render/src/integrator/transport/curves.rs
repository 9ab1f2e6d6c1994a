//! The step of a path inside of a body that bends light.

use kajo_color::sensor;
use kajo_core::ObjectId;
use kajo_core::bsdf::Transport;
use kajo_core::curved_light::Outcome;
use kajo_core::differential::SurfaceFootprint;
use kajo_core::medium::MediumId;
use kajo_core::scene::Scene;
use kajo_core::space::{CurveArrival, DifferentialRay};
use kajo_math::{Ray, Vec3};

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
/// No connection finds what the path hits at the end, so it counts in full. Its differential is taken along, but by steps of a fixed length.
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
    if path.surfaces == 1 && path.mode == Transport::Radiance {
        observe(scene, path, medium);
    }
    let eta = path.media.eta();
    let weight = path.beta;
    let wavelengths = path.wavelengths;
    let about = || About { eta, weight: sensor::to_rgb(weight, &wavelengths), light: None };
    let chords = |chord: &Ray| observer.bent(scene, chord, about);
    let from = DifferentialRay { ray: &path.ray, differential: path.differential.as_ref() };
    let way = scene.follow(from, medium, body, &path.wavelengths, &mut surface.at, chords);
    let Some(way) = way else { return Curve::GoesOn };
    let CurveArrival { outcome, d, length, chord, eta, eta_scale, g, ends, differential } = way;
    path.connectable = false;
    path.differential = differential;
    surface.at.footprint =
        differential.map_or(SurfaceFootprint::POINT, |around| SurfaceFootprint { dp: around.dp });
    if path.mode == Transport::Radiance {
        path.beta *= eta_scale;
        path.eta_scale *= 1.0 / eta_scale;
    }
    path.media.set_eta(body, eta);
    path.shift_frequency(g);
    observer.keeps(|| scene.conserved(&ends, medium, body, &wavelengths));
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

/// Makes the camera's first ray that of a camera which moves through the medium.
fn observe(scene: &Scene, path: &mut PathState<'_>, medium: MediumId) {
    let Some((d, ratio)) = scene.appearance.media.observed(medium, &path.ray) else { return };
    if let Some(differential) = &mut path.differential {
        let seen = |d: Vec3| scene.appearance.media.observed(medium, &Ray { d, ..path.ray });
        differential.dd = differential.dd.map(|dd| observed_difference(seen, path.ray.d, dd));
    }
    path.ray.d = d;
    path.shift_frequency(ratio);
}

/// How a small difference of directions is seen from a camera that moves; zero where there is none.
///
/// * `seen`: a unit direction and a ratio of frequencies for a unit direction
fn observed_difference(seen: impl Fn(Vec3) -> Option<(Vec3, f32)>, d: Vec3, dd: Vec3) -> Vec3 {
    /// Large against rounding, small against a radian.
    const DIFFERENCE: f32 = 1e-2;
    let size = dd.length();
    if size == 0.0 {
        return dd;
    }
    let e = DIFFERENCE / size;
    let at = |e: f32| seen((d + e * dd).normalize()).map(|(d, _)| d);
    match (at(e), at(-e)) {
        (Some(there), Some(back)) => (there - back) / (2.0 * e),
        _ => Vec3::ZERO,
    }
}
