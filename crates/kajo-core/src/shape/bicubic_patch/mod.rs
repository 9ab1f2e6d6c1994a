//! Bicubic Bézier patches: sixteen control points.
//!
//! ```text
//! p(u, v) = sum_ij B_i(u) B_j(v) p_ij,        B_i(t) = C(3, i) t^i (1 - t)^(3 - i)
//! ```
//!
//! Seen along a ray, with the ray as the origin of a plane, the patch is met where a map of the unit square to the plane is zero.
//! A piece of the patch lies within the hull of its control points: if all of these are on one side of a line through the origin,
//! it is not met. If the differences of control points along u, and those along v, turn the same way for every pair of them, the
//! map folds nowhere over the piece: it is met once or not at all, and Newton's method finds where. Any other piece is halved
//! [Nishita, Sederberg and Kakimoto 1990], across the direction in which it is seen longer. So every crossing is found, and what
//! is seen too small to halve is one.
//!
//! Scene: `BicubicPatch { row0 0 0 0  1 0 1  2 0 1  3 0 0  row1 .. row2 .. row3 .. }`

mod net;

use std::cell::Cell;
use std::sync::Arc;

use kajo_bvh::{BuildSettings, Bvh};
use kajo_math::solid_angle::basis64;
use kajo_math::{Aabb, DVec2, DVec3, Ray, Vec2, Vec3};

use self::net::{Net, SubPatch};
use super::{
    Patch, Ray64, Surface, Tessellation, TracedPatch, in_range, nearest_crossing, nearest_uv, stored,
};
use crate::interaction::{Hit, SurfacePoint, Tangents};

/// A patch is divided into this many pieces each way, whose boxes a tree holds.
const SUB_PATCHES: u32 = 4;

/// A bicubic patch. A clone is the same patch.
#[derive(Clone, Debug)]
pub struct BicubicPatch(Arc<Parts>);

#[derive(Debug)]
struct Parts {
    net: Net<DVec3>,
    /// Of the pieces, row by row along v.
    nets: Vec<Net<DVec3>>,
    tree: Bvh,
    /// Extent of the control points, and their largest coordinate.
    extent: f64,
    reach: f64,
}

/// Memory that rays use again and again.
#[derive(Default)]
struct Scratch {
    crossings: Vec<DVec2>,
    stack: Vec<SubPatch>,
}

thread_local! {
    /// Taken while it is in use.
    static SCRATCH: Cell<Scratch> = Cell::default();
}

impl BicubicPatch {
    /// * `points`: four rows of four; u runs along rows, v from row to row
    ///
    /// `None` where all points are on one line.
    pub fn new(points: [[Vec3; 4]; 4]) -> Option<BicubicPatch> {
        let net = Net(points.map(|row| row.map(Vec3::as_dvec3)));
        let all = || net.0.into_iter().flatten().map(|p| p - net.0[0][0]);
        let longest = all().fold(DVec3::ZERO, |a, b| if b.length() > a.length() { b } else { a });
        let has_area = all().any(|p| p.cross(longest).length() > 1e-12 * longest.length_squared());
        has_area.then_some(())?;
        let nets: Vec<Net<DVec3>> = net.grid(SUB_PATCHES);
        let bounds =
            |net: &Net<DVec3>| Aabb::around(net.0.into_iter().flatten().map(DVec3::as_vec3)).padded(1e-6);
        let tree = Bvh::build(&nets.iter().map(bounds).collect::<Vec<_>>(), &BuildSettings::default());
        let reach = net.0.iter().flatten().fold(0.0, |reach: f64, p| reach.max(p.abs().max_element()));
        Some(BicubicPatch(Arc::new(Parts { net, nets, tree, extent: longest.length(), reach })))
    }

    /// Finds where a ray's line crosses the patch.
    fn find_crossings(&self, ray: &Ray, Scratch { crossings, stack }: &mut Scratch) {
        let line = Ray64::new(ray);
        let (x, y) = basis64(line.d.normalize_or_zero());
        crossings.clear();
        if line.d == DVec3::ZERO || !(line.o.is_finite() && line.d.is_finite()) {
            return;
        }
        let seen = |p: DVec3| DVec2::new((p - line.o).dot(x), (p - line.o).dot(y));
        self.0.tree.each(ray, |i| {
            let net = self.0.nets[i as usize].map(seen);
            let low = DVec2::new((i % SUB_PATCHES).into(), (i / SUB_PATCHES).into()) / f64::from(SUB_PATCHES);
            let sub_patch = SubPatch { net, low, size: DVec2::splat(1.0 / f64::from(SUB_PATCHES)) };
            let smallest = 4.0 * f64::EPSILON * (self.0.reach + line.o.abs().max_element());
            sub_patch.zeros(smallest, crossings, stack);
        });
    }

    /// The unit normal. Where it is not defined by the tangents, as at an edge that is a point, it is the limit on the way from
    /// the middle of the patch, along which `dpdu x dpdv` vanishes as its derivative says.
    fn normal(&self, uv: DVec2) -> DVec3 {
        let Derivatives { u, v, uu, uv: mixed, vv, .. } = self.derivatives(uv);
        let least = 1e-7 * self.0.extent * self.0.extent;
        let n = u.cross(v);
        if n.length() > least {
            return n.normalize();
        }
        let way = DVec2::splat(0.5) - uv;
        let (by_u, by_v) = (way.x * uu + way.y * mixed, way.x * mixed + way.y * vv);
        let change = by_u.cross(v) + u.cross(by_v);
        if change.length() > least {
            return change.normalize();
        }
        let beside = self.derivatives(uv + 0.01 * way);
        beside.u.cross(beside.v).normalize_or(DVec3::Y)
    }

    fn derivatives(&self, uv: DVec2) -> Derivatives {
        let rows = self.0.net.0.map(|row| curve(row, uv.x));
        let [p, u, uu] = [0, 1, 2].map(|k| curve(rows.map(|row| row[k]), uv.y));
        Derivatives { p: p[0], u: u[0], v: p[1], uu: uu[0], uv: u[1], vv: p[2] }
    }
}

/// A point of the patch and its derivatives.
struct Derivatives {
    p: DVec3,
    u: DVec3,
    v: DVec3,
    uu: DVec3,
    uv: DVec3,
    vv: DVec3,
}

/// A cubic at `t`: value, first and second derivative.
fn curve([a, b, c, d]: [DVec3; 4], t: f64) -> [DVec3; 3] {
    let [ab, bc, cd] = [a.lerp(b, t), b.lerp(c, t), c.lerp(d, t)];
    let (left, right) = (ab.lerp(bc, t), bc.lerp(cd, t));
    let second = 6.0 * ((c - 2.0 * b + a) * (1.0 - t) + (d - 2.0 * c + b) * t);
    [left.lerp(right, t), 3.0 * (right - left), second]
}

impl Surface for BicubicPatch {
    fn bounds(&self) -> Aabb {
        self.0.tree.bounds()
    }

    fn is_finite(&self) -> bool {
        self.0.reach.is_finite()
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        nearest_crossing(self, ray)
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        let line = Ray64::new(ray);
        let mut scratch = SCRATCH.take();
        self.find_crossings(ray, &mut scratch);
        for uv in &scratch.crossings {
            let t = (self.derivatives(*uv).p - line.o).dot(line.d) / line.d.length_squared();
            in_range(ray, t)
                .into_iter()
                .for_each(|t| visit(Hit { t, u: uv.x as f32, v: uv.y as f32, part: 0 }));
        }
        SCRATCH.set(scratch);
    }

    fn surface_at(&self, _ray: &Ray, hit: &Hit) -> SurfacePoint {
        let uv = DVec2::new(hit.u.into(), hit.v.into());
        let (p, p_error) = stored(self.derivatives(uv).p, self.0.reach);
        SurfacePoint::flat(p, p_error, self.normal(uv).as_vec3())
    }

    fn uv_at(&self, hit: &Hit, _p: Vec3) -> Vec2 {
        Vec2::new(hit.u, hit.v)
    }

    fn tangents_at(&self, hit: &Hit, _p: Vec3) -> Tangents {
        let at = self.derivatives(DVec2::new(hit.u.into(), hit.v.into()));
        Tangents { dpdu: at.u.as_vec3(), dpdv: at.v.as_vec3() }
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn hit_at(&self, part: u32, p: Vec3) -> Hit {
        let uv = nearest_uv(p.as_dvec3(), |uv| {
            let at = self.derivatives(uv);
            (at.p, at.u, at.v)
        });
        Hit { t: 0.0, u: uv.x as f32, v: uv.y as f32, part }
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        let patch = TracedPatch::new(self.clone(), 0);
        patch.into_iter().for_each(|patch| visit(0, Patch::Traced(Box::new(patch))));
    }

    fn tessellate(&self, around: u32, out: &mut Tessellation) {
        let segments = around.div_ceil(2);
        out.grid(0, [segments, segments], |x, y| {
            let uv = DVec2::new(x, y);
            (self.derivatives(uv).p, self.normal(uv))
        });
    }

    fn heap_bytes(&self) -> usize {
        size_of::<Parts>() + size_of_val(&*self.0.nets) + self.0.tree.stats().bytes
    }
}

#[cfg(test)]
mod tests;
