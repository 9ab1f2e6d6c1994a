//! What is worked out where a path has come to a surface, straight or along a curve.

use kajo_core::scene::Scene;
use kajo_math::Vec3;

use super::{PathState, SurfaceInteraction};

/// How a path came to a surface.
#[derive(Clone, Copy, Debug)]
pub struct TracedSegment {
    /// Unit direction back along the path.
    pub wo: Vec3,
    /// Length of the way.
    pub length: f32,
    /// Frequency where it begins over that where it ends.
    pub g: f32,
}

/// Completes what there is to be known of a surface that a path has come to, and weakens the path by the way.
#[inline]
pub fn arrive(scene: &Scene, path: &mut PathState<'_>, surface: &mut SurfaceInteraction, way: TracedSegment) {
    let at = &surface.at;
    TracedSegment { wo: surface.wo, length: surface.length, g: surface.g } = way;
    surface.u = path.draws.number_if(scene.is_mixture(at));
    let enters = surface.wo.dot(at.point.ng) > 0.0;
    let interior = scene.interior(at, &path.wavelengths, surface.u);
    surface.interface = interior.map(|interior| path.media.interface(at.object, &interior, enters));
    attenuate(path, surface);
}

/// Multiplies the throughput by what the way to a surface does to light.
#[inline]
fn attenuate(path: &mut PathState<'_>, surface: &SurfaceInteraction) {
    if !path.media.is_empty() {
        path.beta *= path.media.transmittance(surface.length);
    }
}
