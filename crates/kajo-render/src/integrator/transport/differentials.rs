//! Differentials along a path; see [`kajo_core::differential`].

use kajo_core::bsdf::BsdfSample;
use kajo_core::differential::{RayDifferential, SkyFootprint, SurfaceFootprint, sample_side};
use kajo_core::scene::Scene;
use kajo_math::Vec3;

use super::{PathState, SurfaceInteraction};

/// Takes the differential to the surface that the path has met, which learns what a sample covers of it.
#[cold]
#[inline(never)]
pub fn arrive(path: &mut PathState<'_>, surface: &mut SurfaceInteraction) {
    let Some(differential) = &mut path.differential else { return };
    let at = &mut surface.at;
    *differential = differential.transferred(path.ray.d, at.hit.t, at.point.ng).usable();
    at.footprint = SurfaceFootprint { dp: differential.dp };
}

/// What the pixel of a path covers of all that is infinitely far away, for a path that no other way of finding its light competes with: that of
/// a camera, or of mirrors and glass.
#[inline]
pub fn sky_footprint(path: &PathState<'_>) -> SkyFootprint {
    match &path.differential {
        Some(differential) if !path.connectable => of_pixel(path, differential),
        _ => SkyFootprint::POINT,
    }
}

#[cold]
#[inline(never)]
fn of_pixel(path: &PathState<'_>, differential: &RayDifferential) -> SkyFootprint {
    let across = 1.0 / sample_side(path.draws.samples_of_pixel());
    SkyFootprint { dd: differential.dd.map(|dd| across * dd) }
}

/// Takes the differential from a surface along a direction that was sampled there.
///
/// * `wi`: the direction in world space
#[cold]
#[inline(never)]
pub fn leave(
    scene: &Scene,
    path: &mut PathState<'_>,
    surface: &SurfaceInteraction,
    wi: Vec3,
    sample: &BsdfSample,
) {
    let Some(differential) = &mut path.differential else { return };
    let d = -surface.wo;
    if !sample.kind.delta {
        *differential = differential.scattered(wi).usable();
        return;
    }
    if sample.kind.straight {
        return;
    }
    let side = if d.dot(surface.at.point.n) > 0.0 { -1.0 } else { 1.0 };
    let dn = scene.normal_changes(&surface.at, differential.dp).map(|dn| side * dn);
    let left = if sample.kind.transmission {
        differential.refracted(d, wi, side * surface.at.point.n, dn, 1.0 / sample.eta)
    } else {
        // The normal of the mirror is that of the relief, too.
        let n = (wi - d).normalize_or(side * surface.at.point.n);
        differential.reflected(d, n, dn)
    };
    *differential = left.usable();
}
