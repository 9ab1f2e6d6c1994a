//! Bilinear patches: four corners and the straight lines between opposite edges.
//!
//! ```text
//! p(u, v) = (1 - u)(1 - v) p_00 + u (1 - v) p_10 + (1 - u) v p_01 + u v p_11
//! ```
//!
//! Seen along a ray, with the ray as the origin of a plane, the line of all `v` at one `u` goes through the origin where
//!
//! ```text
//! cross((1 - u) p_00 + u p_10, (1 - u) p_01 + u p_11) = 0,
//! ```
//!
//! a quadratic in `u` [Reshetov 2019]; `v` is where on that line. Its Bernstein coefficients at the ends are which side of an edge
//! the ray passes on. Whether a patch is crossed an odd number of times is decided by its four edges alone, and of an edge by the
//! same numbers for both patches that share it: no ray passes between them, and none meets both.
//!
//! Scene: `BilinearPatch { vertex0 0 0 0  vertex1 1 0 0  vertex2 1 1 1  vertex3 0 1 0 }`

use kajo_math::solid_angle::basis64;
use kajo_math::{Aabb, DVec2, DVec3, Ray, Vec2, Vec3, roots};

use super::{
    Patch, Ray64, Surface, Tessellation, TracedPatch, in_range, nearest_crossing, nearest_uv, stored,
};
use crate::interaction::{Hit, SurfacePoint, Tangents};

/// A bilinear patch.
#[derive(Clone, Copy, Debug)]
pub struct BilinearPatch {
    /// At (u, v) of (0, 0), (1, 0), (0, 1) and (1, 1).
    corners: [DVec3; 4],
}

impl BilinearPatch {
    /// The patch with these corners, one after the other around it: u runs from the first to the second, v from the first to the
    /// last.
    ///
    /// `None` where all of them are on one line.
    pub fn new([a, b, c, d]: [Vec3; 4]) -> Option<BilinearPatch> {
        let corners = [a, b, d, c].map(Vec3::as_dvec3);
        let [p, others @ ..] = corners.map(|q| q - corners[0]);
        debug_assert_eq!(p, DVec3::ZERO);
        let longest =
            others.into_iter().fold(DVec3::ZERO, |a, b| if b.length() > a.length() { b } else { a });
        let has_area = others.iter().any(|q| q.cross(longest).length() > 1e-12 * longest.length_squared());
        has_area.then_some(BilinearPatch { corners })
    }

    /// Point, and derivatives by both coordinates.
    fn at(&self, uv: DVec2) -> (DVec3, DVec3, DVec3) {
        let [a, b, c, d] = self.corners;
        let (near, far) = (a.lerp(b, uv.x), c.lerp(d, uv.x));
        (near.lerp(far, uv.y), (b - a).lerp(d - c, uv.y), far - near)
    }

    /// The unit normal; at a corner where an edge has shrunk to a point, that of the surface beside it.
    fn normal(&self, uv: DVec2) -> DVec3 {
        const INWARD: f64 = 1e-3;
        let of = |uv: DVec2| {
            let (_, by_u, by_v) = self.at(uv);
            let n = by_u.cross(by_v);
            (n.length() > 1e-9 * self.extent().powi(2)).then(|| n.normalize())
        };
        let inward = || uv.lerp(DVec2::splat(0.5), INWARD);
        of(uv).or_else(|| of(inward())).unwrap_or(DVec3::Y)
    }

    /// Length of the longer diagonal.
    fn extent(&self) -> f64 {
        let [a, b, c, d] = self.corners;
        a.distance(d).max(b.distance(c))
    }

    /// Where a line crosses the patch: none, one or two places.
    fn crossings(&self, line: &Ray64) -> impl Iterator<Item = DVec2> {
        let (x, y) = basis64(line.d.normalize_or_zero());
        let seen = self.corners.map(|p| DVec2::new((p - line.o).dot(x), (p - line.o).dot(y)));
        let [p00, p10, p01, p11] = seen;
        let b = [p00.perp_dot(p01), 0.5 * (p00.perp_dot(p11) + p10.perp_dot(p01)), p10.perp_dot(p11)];
        let is_odd = [(p00, p10), (p10, p11), (p11, p01), (p01, p00)]
            .into_iter()
            .fold(false, |odd, (p, q)| odd != crosses_axis(p, q));
        let mut found: [Option<DVec2>; 2] = [None; 2];
        for (u, uv) in columns(b).into_iter().zip(&mut found) {
            *uv = u.map(|u| {
                let (near, far) = (p00.lerp(p10, u), p01.lerp(p11, u));
                let along = far - near;
                DVec2::new(u, -near.dot(along) / along.length_squared())
            });
        }
        let finite = line.d != DVec3::ZERO && seen.iter().all(|p| p.is_finite());
        let places = if finite { settled(found, seen, is_odd) } else { [None; 2] };
        places.into_iter().flatten()
    }
}

/// Whether an edge crosses the positive first axis; for an edge and the same one backwards the answer is the same.
fn crosses_axis(p: DVec2, q: DVec2) -> bool {
    if (p.y < 0.0) == (q.y < 0.0) {
        return false;
    }
    let (low, high) = if p.y < 0.0 { (p, q) } else { (q, p) };
    low.perp_dot(high) > 0.0
}

/// The places in [0, 1] where a quadratic with these Bernstein coefficients changes its sign.
fn columns(b: [f64; 3]) -> [Option<f64>; 2] {
    let (a, h, c) = (b[0] - 2.0 * b[1] + b[2], b[1] - b[0], b[0]);
    let (starts, ends) = (b[0] < 0.0, b[2] < 0.0);
    if starts == ends && (b[1] < 0.0) == starts {
        return [None; 2];
    }
    let found = roots::quadratic(a, h, c);
    if starts == ends {
        return found.map_or([None; 2], |(u, v)| [Some(u), Some(v)].map(|u| u.map(|u| u.clamp(0.0, 1.0))));
    }
    let off = |u: f64| if u.is_nan() { f64::INFINITY } else { (u - u.clamp(0.0, 1.0)).abs() };
    let one = found.map_or(0.5, |(u, v)| if off(u) <= off(v) { u } else { v });
    [Some(if one.is_nan() { 0.5 } else { one.clamp(0.0, 1.0) }), None]
}

/// The place on the border that is nearest to the origin.
fn nearest_of_border([p00, p10, p01, p11]: [DVec2; 4]) -> DVec2 {
    let edges = [
        (p00, p10, DVec2::ZERO, DVec2::X),
        (p10, p11, DVec2::X, DVec2::ONE),
        (p01, p11, DVec2::Y, DVec2::ONE),
        (p00, p01, DVec2::ZERO, DVec2::Y),
    ];
    let nearest = edges.map(|(p, q, from, to)| {
        let along = q - p;
        let share = (-p.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let share = if share.is_nan() { 0.0 } else { share };
        (p.lerp(q, share).length_squared(), from.lerp(to, share))
    });
    nearest.into_iter().fold((f64::INFINITY, DVec2::ZERO), |a, b| if b.0 < a.0 { b } else { a }).1
}

/// Of the places on the lines that go through the origin, those within a patch seen so: as many, odd or even, as its edges say.
fn settled(found: [Option<DVec2>; 2], seen: [DVec2; 4], is_odd: bool) -> [Option<DVec2>; 2] {
    let inside = found.map(|uv| uv.filter(|uv| (0.0..=1.0).contains(&uv.y)));
    let count = inside.iter().flatten().count();
    if (count % 2 == 1) == is_odd {
        return inside;
    }
    // Rounding disagrees with the edges, and so the origin is on one of them.
    if count == 0 {
        return [Some(nearest_of_border(seen)), None];
    }
    let from_border = |uv: Option<DVec2>| uv.map_or(f64::INFINITY, |uv| uv.y.min(1.0 - uv.y));
    let nearest = usize::from(from_border(inside[1]) < from_border(inside[0]));
    [inside[1 - nearest], None]
}

impl Surface for BilinearPatch {
    fn bounds(&self) -> Aabb {
        Aabb::around(self.corners.map(DVec3::as_vec3)).padded(f32::EPSILON)
    }

    fn is_finite(&self) -> bool {
        self.corners.iter().all(|p| p.is_finite())
    }

    #[inline]
    fn hit(&self, ray: &Ray) -> Option<Hit> {
        nearest_crossing(self, ray)
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        let line = Ray64::new(ray);
        for uv in self.crossings(&line) {
            let t = (self.at(uv).0 - line.o).dot(line.d) / line.d.length_squared();
            in_range(ray, t)
                .into_iter()
                .for_each(|t| visit(Hit { t, u: uv.x as f32, v: uv.y as f32, part: 0 }));
        }
    }

    fn surface_at(&self, _ray: &Ray, hit: &Hit) -> SurfacePoint {
        let uv = DVec2::new(hit.u.into(), hit.v.into());
        let (p, p_error) = stored(
            self.at(uv).0,
            self.corners.map(|p| p.abs().max_element()).into_iter().fold(0.0, f64::max),
        );
        SurfacePoint::flat(p, p_error, self.normal(uv).as_vec3())
    }

    fn uv_at(&self, hit: &Hit, _p: Vec3) -> Vec2 {
        Vec2::new(hit.u, hit.v)
    }

    fn tangents_at(&self, hit: &Hit, _p: Vec3) -> Tangents {
        let (_, dpdu, dpdv) = self.at(DVec2::new(hit.u.into(), hit.v.into()));
        Tangents { dpdu: dpdu.as_vec3(), dpdv: dpdv.as_vec3() }
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn hit_at(&self, part: u32, p: Vec3) -> Hit {
        let uv = nearest_uv(p.as_dvec3(), |uv| self.at(uv));
        Hit { t: 0.0, u: uv.x as f32, v: uv.y as f32, part }
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        let patch = TracedPatch::new(*self, 0);
        patch.into_iter().for_each(|patch| visit(0, Patch::Traced(Box::new(patch))));
    }

    fn tessellate(&self, around: u32, out: &mut Tessellation) {
        let segments = around.div_ceil(4);
        out.grid(0, [segments, segments], |x, y| {
            let uv = DVec2::new(x, y);
            (self.at(uv).0, self.normal(uv))
        });
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::{rng::Stream, warp};

    use super::*;

    fn point(seed: u32, i: u32) -> Vec3 {
        let s = Stream::new(107, [seed, i], 0);
        Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) * 2.0 - 1.0
    }

    fn patch(seed: u32) -> BilinearPatch {
        BilinearPatch::new([0, 1, 2, 3].map(|i| point(seed, i))).unwrap()
    }

    /// Lines through known points of random patches find them, also from ten thousand units away, and all that is found is on the
    /// line.
    #[test]
    fn points_of_the_patch_are_met() {
        for seed in 0..4000 {
            let patch = patch(seed);
            let s = Stream::new(109, [seed, 0], 0);
            let uv = DVec2::new(s.uniform(0).into(), s.uniform(1).into());
            let d = warp::uniform_sphere(Vec2::new(s.uniform(2), s.uniform(3))).as_dvec3();
            if patch.normal(uv).dot(d).abs() < 1e-3 {
                continue;
            }
            for far in [2.0, 1e4] {
                let line = Ray64 { o: patch.at(uv).0 - far * d, d };
                let found: Vec<DVec2> = patch.crossings(&line).collect();
                assert!(
                    found.iter().any(|known| known.distance(uv) < 1e-8),
                    "{seed}: {found:?} without {uv}"
                );
                for uv in found {
                    let w = patch.at(uv).0 - line.o;
                    assert!(w.cross(d).length() < 1e-10, "{seed}: {}", w.cross(d).length());
                }
            }
        }
    }

    /// Four patches around a point, a closed box of six bent faces: rays at edges and corners cross an even number of times.
    #[test]
    fn patches_that_share_edges_leave_no_gap() {
        for seed in 0..20 {
            // A bent cube: every face has corners of its own neighbours.
            let corner = |k: u32| {
                let at = Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32) * 2.0 - 1.0;
                at + 0.4 * point(seed + 9000, k)
            };
            const FACES: [[u32; 4]; 6] =
                [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
            let faces = FACES.map(|face| BilinearPatch::new(face.map(corner)).unwrap());
            let mut hits = 0;
            for i in 0..20_000 {
                let s = Stream::new(113, [i, seed], 0);
                let pick = |k: u32| corner(((s.uniform(k) * 8.0) as u32).min(7));
                let (a, b) = (pick(0), pick(1));
                // At corners, at edges and diagonals, from near and far.
                let target = if i % 3 == 0 { a } else { a.lerp(b, s.uniform(2)) };
                let from = 4.0 * warp::uniform_sphere(Vec2::new(s.uniform(3), s.uniform(4)));
                let d = target - from;
                let line = Ray64::new(&Ray::new(if i % 2 == 0 { from } else { from - 1e3 * d }, d));
                let count: usize = faces.iter().map(|face| face.crossings(&line).count()).sum();
                assert!(count.is_multiple_of(2), "{seed}: ray {i} crosses {count} times");
                hits += count;
            }
            assert!(hits > 20_000);
        }
    }

    /// Points of a patch that does not fold have the coordinates they were made of.
    #[test]
    fn points_know_their_coordinates() {
        for seed in 0..500 {
            let square = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
            let corners = [0, 1, 2, 3].map(|i| square[i as usize] + 0.25 * point(seed, i));
            let (patch, s) = (BilinearPatch::new(corners).unwrap(), Stream::new(163, [seed, 0], 0));
            let uv = DVec2::new(s.uniform(0).into(), s.uniform(1).into());
            let hit = patch.hit_at(0, patch.at(uv).0.as_vec3());
            assert!(DVec2::new(hit.u.into(), hit.v.into()).distance(uv) < 1e-4, "{seed}: {hit:?} for {uv}");
        }
    }

    #[test]
    fn corners_on_a_line_make_no_patch() {
        let on_line = [0.0, 1.0, 3.0, -2.0].map(|x| Vec3::new(x, 2.0 * x, 1.0));
        assert!(BilinearPatch::new(on_line).is_none() && BilinearPatch::new([Vec3::ONE; 4]).is_none());
        // Two corners in one make a triangle, with its normal everywhere.
        let triangle = BilinearPatch::new([Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Y]).unwrap();
        for uv in [DVec2::ZERO, DVec2::ONE, DVec2::new(0.5, 1.0), DVec2::Y] {
            assert!(triangle.normal(uv).distance(DVec3::Z) < 1e-9, "{uv}");
        }
    }
}
