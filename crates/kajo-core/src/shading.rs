//! The frame in which a surface scatters: the normal that it shows, and where its grain runs.
//!
//! A relief makes the normal lean, so far that a mirror would send light from the viewer into the surface. There no light could come
//! from, and black seams would be left: a normal that leans too far is turned back, in the plane of both normals, until the mirror
//! direction rises above the surface. Because that depends on the viewer, frames are made for one.
//!
//! Grain runs by surface coordinates: the x axis of the frame is the direction in which `u` grows, turned about the
//! normal. Where there are no coordinates it is any direction, the same for all rays that meet the point.

use kajo_color::Wavelengths;
use kajo_math::{Frame, Vec2, Vec3, fmath};

use crate::interaction::{SurfacePoint, Tangents};
use crate::material::{Lean, Orientation, ShadingPoint};
use crate::scene::{Interaction, Scene};

/// Directions that belong to a point of a surface, from whatever side it is viewed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shading {
    /// Unit shading normal, outward.
    pub n: Vec3,
    /// Unit geometric normal, outward.
    pub ng: Vec3,
    /// Whether a relief made `n` lean.
    pub leans: bool,
    /// Along the x axis of the frame; zero where that may point anywhere.
    pub tangent: Vec3,
}

impl Shading {
    /// That of a surface whose material asks for nothing.
    #[inline]
    pub fn plain(point: &SurfacePoint) -> Shading {
        Shading { n: point.n, ng: point.ng, leans: false, tangent: Vec3::ZERO }
    }

    /// Whether shading and geometric normal agree on which side of the surface `w` is.
    #[inline]
    fn agrees_on(&self, w: Vec3) -> bool {
        w.dot(self.n) * w.dot(self.ng) > 0.0
    }

    /// The normal for light that goes to the viewer in the unit direction `wo`.
    ///
    /// A shading normal that turns a visible side away is none.
    #[inline]
    pub fn normal(&self, wo: Vec3) -> Vec3 {
        match self.leans {
            true => limited_tilt(self.n, self.ng, wo),
            false if self.agrees_on(wo) => self.n,
            false => self.ng,
        }
    }

    /// Whether two viewers see the same frame.
    #[inline]
    pub fn is_shared(&self, wo: Vec3, other: Vec3) -> bool {
        match self.leans {
            true => self.normal(wo) == self.normal(other),
            false => self.agrees_on(wo) == self.agrees_on(other),
        }
    }

    /// The frame for light that goes to the viewer in the unit direction `wo`.
    #[inline(always)]
    pub fn frame(&self, wo: Vec3) -> Frame {
        let n = self.normal(wo);
        if self.tangent == Vec3::ZERO { Frame::from_normal(n) } else { along(n, self.tangent) }
    }
}

impl Interaction {
    /// The cosine of the angle between a ray of the direction `d`, of any length, and the normal of a pane: the shading
    /// normal without any relief, the same for both directions of the light.
    #[inline]
    pub fn crossing_cosine(&self, d: Vec3) -> f32 {
        (Shading::plain(&self.point).normal(d).dot(d) / d.length()).abs().min(1.0)
    }
}

impl Scene {
    /// The directions by which light is scattered at an interaction.
    ///
    /// * `u`: as in [`Scene::bsdf`]
    #[inline]
    pub fn shading(&self, at: &Interaction, u: f32) -> Shading {
        if self.appearance.has_orientations { self.oriented(at, u) } else { Shading::plain(&at.point) }
    }

    #[inline(never)]
    fn oriented(&self, at: &Interaction, u: f32) -> Shading {
        let plain = Shading::plain(&at.point);
        if !self.appearance.is_oriented(at.material) {
            return plain;
        }
        let context = &self.texture_context(at);
        let point = ShadingPoint { context, wavelengths: &Wavelengths::RGB, eta_outside: 1.0, u };
        let orientation = self.appearance.orientation(at.material, &point);
        if orientation == Orientation::default() {
            return plain;
        }
        let tangents = self.geometry.tangents(at);
        let Frame { s, t, n } = Frame::from_tangent(plain.n, tangents.dpdu);
        // Turns go from u to v, whichever way round the coordinates are.
        let t = if t.dot(tangents.dpdv) < 0.0 { -t } else { t };
        let leaning = orientation.lean.map(|lean| match lean {
            Lean::Tangent(m) => (m.x * s + m.y * t + m.z * n).normalize_or(n),
            Lean::Slope { by_uv, by_p } => raised(n, &tangents, by_uv, by_p),
        });
        let tangent = orientation.turn.map_or(Vec3::ZERO, |turn| {
            let (sin, cos) = fmath::sin_cos(std::f32::consts::TAU * turn);
            cos * s + sin * t
        });
        Shading { n: leaning.unwrap_or(n), leans: leaning.is_some(), tangent, ..plain }
    }
}

/// A frame with grain, out of the way of those without: they are made at every surface that a path meets.
#[inline(never)]
fn along(n: Vec3, tangent: Vec3) -> Frame {
    Frame::from_tangent(n, tangent)
}

/// The normal of a surface that rises by the sum of both from place to place.
///
/// * `by_uv`: for each unit of its coordinates; `by_p`: for each unit of the world
fn raised(n: Vec3, tangents: &Tangents, by_uv: Vec2, by_p: Vec3) -> Vec3 {
    let raised = raised_by_uv(n, tangents, by_uv);
    let cos = raised.dot(n);
    if by_p == Vec3::ZERO || cos <= 0.0 {
        return raised;
    }
    // Both parts are taken off the normal; the first one was made a unit vector.
    (raised / cos - by_p.reject_from_normalized(n)).normalize_or(n)
}

/// The normal of a surface that rises by `slope` for each unit of its coordinates [Mikkelsen 2010, eq. 4].
fn raised_by_uv(n: Vec3, tangents: &Tangents, slope: Vec2) -> Vec3 {
    let Tangents { dpdu, dpdv } = *tangents;
    let (across_v, across_u) = (dpdv.cross(n), n.cross(dpdu));
    let d = dpdu.dot(across_v);
    let rise = slope.x * across_v + slope.y * across_u;
    let raised = d.abs() * n - d.signum() * rise;
    if raised.is_finite() { raised.normalize_or(n) } else { n }
}

/// The unit normal nearest to `n`, in its plane with `ng`, about which `wo` is mirrored to the outside of the surface.
///
/// With `z` along `ng` on the side of `wo` and `x` so that `n` has no `y`, the mirror direction rises by `r` where
///
/// ```text
/// 2 (nx wx + nz wz) nz - wz = r,   nx² + nz² = 1
/// ```
///
/// a quadratic in `nz²`, as in Cycles.
#[inline(never)]
fn limited_tilt(n: Vec3, ng: Vec3, wo: Vec3) -> Vec3 {
    /// Mirror directions rise so far at least, or nearly as far as the viewer does.
    const RISE: f32 = 0.01;
    let side = if wo.dot(ng) < 0.0 { -1.0 } else { 1.0 };
    let (n, z) = (side * n, side * ng);
    let wz = wo.dot(z);
    let rise = RISE.min(0.9 * wz);
    let mirrored = 2.0 * n.dot(wo) * n.dot(z) - wz;
    if mirrored >= rise && n.dot(wo) > 0.0 && n.dot(z) > 0.0 {
        return side * n;
    }
    let x = (n - n.dot(z) * z).normalize_or_zero();
    let wx = wo.dot(x);
    let (a, b) = (wx * wx + wz * wz, wx * wx + wz * (wz + rise));
    let c = (rise + wz) * (rise + wz);
    let root = (b * b - a * c).max(0.0).sqrt();
    // Of the two solutions the one nearer to n: leaning towards the viewer there are more upright ones.
    let nz2 = 0.5 * (if wx < 0.0 { b + root } else { b - root }) / a;
    let nz2 = if nz2.is_finite() { nz2.clamp(0.0, 1.0) } else { 1.0 };
    side * ((1.0 - nz2).sqrt() * x + nz2.sqrt() * z)
}

#[cfg(test)]
mod tests {
    use kajo_math::{rng::Stream, warp};

    use super::*;

    /// The mirror direction of the viewer rises as far as asked for and no farther, in the plane of both normals.
    #[test]
    fn normals_lean_no_farther_than_mirrors_allow() {
        let mut held = 0;
        for i in 0..20_000 {
            let s = Stream::new(21, [i, 0], 0);
            let [n, ng, wo] =
                [0, 2, 4].map(|k| warp::uniform_sphere(Vec2::new(s.uniform(k), s.uniform(k + 1))));
            if n.dot(ng) < 0.05 || wo.dot(ng).abs() < 1e-3 {
                continue;
            }
            let shading = Shading { n, ng, leans: true, tangent: Vec3::ZERO };
            let found = shading.normal(wo);
            let side = wo.dot(ng).signum();
            let rise = |n: Vec3| side * (2.0 * n.dot(wo) * n - wo).dot(ng);
            let least = (0.9 * wo.dot(ng).abs()).min(0.01);
            assert!(
                (found.length() - 1.0).abs() < 1e-4 && found.dot(n.cross(ng)).abs() < 1e-4,
                "{n} {ng} {wo}"
            );
            assert!(found.dot(ng) > 0.0 && side * found.dot(wo) > 0.0, "{n} {ng} {wo}: {found}");
            if found == n {
                assert!(rise(n) >= least - 1e-6);
                continue;
            }
            held += 1;
            assert!((rise(found) - least).abs() < 1e-3, "{n} {ng} {wo}: {found} rises {}", rise(found));
            // Between the two normals, where a little more of the leaning would be too much.
            assert!(found.dot(ng) >= n.dot(ng) - 1e-3, "{n} {ng} {wo}: {found}");
        }
        assert!(held > 3000);
    }

    #[test]
    fn a_normal_that_turns_a_visible_side_away_is_none() {
        let shading = Shading { n: Vec3::new(0.6, 0.0, 0.8), ng: Vec3::Z, ..Shading::default() };
        assert_eq!(shading.frame(Vec3::Z).n, shading.n);
        assert_eq!(shading.frame(Vec3::new(-0.9, 0.0, 0.43)).n, Vec3::Z);
    }
}
