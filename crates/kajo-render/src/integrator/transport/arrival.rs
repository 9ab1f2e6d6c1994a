//! What is worked out where a path has come to a surface, along a straight line or a curve.

use kajo_core::scene::Scene;
use kajo_math::Vec3;

use super::{PathState, SurfaceInteraction};

/// How a path came to a surface.
#[derive(Clone, Copy, Debug)]
pub struct TracedSegment {
    /// Unit direction back along the path.
    pub wo: Vec3,
    /// Length along the path since the last event.
    pub length: f32,
}

/// Fills in a [`SurfaceInteraction`] behind its hit (the number for a mixture, the interface) and multiplies `beta` by the absorption along the
/// segment.
#[inline(always)]
pub fn arrive(
    scene: &Scene,
    path: &mut PathState<'_>,
    surface: &mut SurfaceInteraction,
    segment: TracedSegment,
) {
    let at = &surface.at;
    TracedSegment { wo: surface.wo, length: surface.length } = segment;
    surface.u = path.draws.number_if(scene.is_mixture(at));
    let enters = surface.wo.dot(at.point.ng) > 0.0;
    let interior = scene.interior(at, &path.wavelengths, surface.u);
    surface.interface = interior.map(|interior| path.media.interface(at.object, &interior, enters));
    attenuate(path, surface);
}

/// Multiplies the throughput by the absorption along the segment to a surface.
#[inline]
fn attenuate(path: &mut PathState<'_>, surface: &SurfaceInteraction) {
    if !path.media.is_empty() {
        path.beta *= path.media.transmittance(surface.length);
    }
}
