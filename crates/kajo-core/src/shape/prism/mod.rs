//! Prisms: outlines in a plane, drawn out across it.
//!
//! In its own space the outline is in the plane z = 0, and at the height z it is `k(z) = 1 - n z` times as large. A ray
//! `o + t d` goes along a straight line through the outlines brought to one size: its points `(o + t d) / k` satisfy
//!
//! ```text
//! D x P + o x d = 0,    D = a d - b o,    k(o + t d) = a + b t,
//! ```
//!
//! in x and y. So crossings with curves are roots of polynomials of the curves' degree, isolated by Bernstein coefficients, and
//! come in pairs; see `outline.rs`. The pieces of the line inside of the outline, cut to the slab between both ends, are
//! the pieces inside of the prism: walls and caps follow from one list and leave no gap [van Wijk 1984].
//!
//! With a bevel, what is near the edges of both ends is taken off from each piece; see [`bevel`].
//!
//! Scene: `Prism { depth 0.3  outline { line 0 0  2 0  1 1.5 } }`

mod bevel;

use std::cell::Cell;
use std::sync::Arc;

use kajo_math::{Aabb, DVec2, DVec3, Ray, Vec2, Vec3};

use self::bevel::BevelledEdge;

use super::outline::{
    Border, BoxTree, Crossing, PlaneLine, box_of, direction, inside_intervals, nearest_parameter, segments,
    shares, winding,
};
use super::{
    Bezier, FillRule, Path, Ray64, Surface, Tessellation, fill::fill, in_range, nearest_crossing, stored,
};
use crate::interaction::{Hit, SurfacePoint, Tangents};

pub use self::bevel::{Bevel, BevelProfile};

/// Parts: the two ends, then the curves, and then the bevels of both ends.
const NEAR_END: u32 = 0;
const FAR_END: u32 = 1;
const FIRST_WALL: u32 = 2;

/// Crossings are one if they are nearer than this to each other, in parts of the size.
const SAME: f64 = 64.0 * f64::EPSILON;

/// A prism. A clone is the same prism.
#[derive(Clone, Debug)]
pub struct Prism(Arc<Parts>);

/// Where an outline is in space, and what becomes of it.
#[derive(Clone, Copy, Debug)]
pub struct Sweep {
    /// Where the outline's origin is.
    pub origin: DVec3,
    /// Unit vectors: to the right and up in the outline's plane, and out of it along the prism.
    pub axes: [DVec3; 3],
    /// Length along the axis.
    pub depth: f64,
    /// Size of the far end over that of the near one, around the origin; not negative.
    pub taper: f64,
    /// What of the plane is inside.
    pub rule: FillRule,
    /// What the edges of both ends look like where they are not sharp; only for a `taper` of 1.
    pub bevel: Option<Bevel>,
}

#[derive(Debug)]
struct Parts {
    sweep: Sweep,
    /// By how much outlines shrink per length along the axis.
    narrowing: f64,
    curves: Vec<Bezier<DVec2>>,
    /// What each curve has of the way around its contour: from where, and how much.
    shares: Vec<[f64; 2]>,
    /// Index of the first curve of each contour, and how many there are in all.
    contours: Vec<usize>,
    tree: BoxTree,
    edge: Option<BevelledEdge>,
    bounds: Aabb,
    /// The largest coordinate of the outline.
    reach: f64,
}

/// What a ray does to the outline.
struct Course {
    line: Ray64,
    /// Size of the outline along the ray: `a + b t`.
    a: f64,
    b: f64,
    /// Where the ray is between both ends.
    slab: [f64; 2],
}

thread_local! {
    /// Memory that rays use again and again.
    static SCRATCH: Cell<Vec<Crossing>> = const { Cell::new(Vec::new()) };
}

impl Prism {
    /// * `contours`: closed ones
    ///
    /// `None` where there is nothing inside: without contours or depth, or where all points are on one line; and for a bevel that has no
    /// width, more than half the depth, or a taper.
    pub fn new(sweep: Sweep, contours: &[Path<DVec2>]) -> Option<Prism> {
        let has_room =
            |bevel: Bevel| bevel.width > 0.0 && bevel.width <= 0.5 * sweep.depth && sweep.taper == 1.0;
        let usable = sweep.depth > 0.0
            && sweep.taper >= 0.0
            && sweep.bevel.is_none_or(has_room)
            && contours.iter().all(Path::is_closed);
        let mut first = Vec::with_capacity(contours.len() + 1);
        let (mut curves, mut share) = (Vec::new(), Vec::new());
        for contour in contours {
            first.push(curves.len());
            share.extend(shares(contour.curves()));
            curves.extend_from_slice(contour.curves());
        }
        first.push(curves.len());
        let has_area = curves.iter().any(|curve| is_off_line(curve, &curves[0]));
        if !usable || !has_area || u32::try_from(curves.len()).is_err() {
            return None;
        }
        let tree = BoxTree::new(&curves.iter().map(box_of).collect::<Vec<_>>());
        let [min, max] = tree.bounds();
        let corners = (0..8).map(|i| {
            let pick = |bit: u32, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
            let size = pick(2, 1.0, sweep.taper);
            sweep.world(
                [min.x, max.x].map(|x| size * x)[(i & 1) as usize],
                size * pick(1, min.y, max.y),
                pick(2, 0.0, sweep.depth),
            )
        });
        let bounds = Aabb::around(corners.map(DVec3::as_vec3)).padded(1e-6);
        let reach = min.abs().max(max.abs()).max_element();
        let narrowing = (1.0 - sweep.taper) / sweep.depth;
        let mut parts = Parts {
            sweep,
            narrowing,
            curves,
            shares: share,
            contours: first,
            tree,
            edge: None,
            bounds,
            reach,
        };
        parts.edge = sweep.bevel.map(|bevel| {
            let fills = |p| sweep.rule.fills(parts.winding(p));
            BevelledEdge::new(bevel, &parts.curves, min.distance(max), fills)
        });
        Some(Prism(Arc::new(parts)))
    }
}

/// Whether a control point of a curve is not on the line along which another begins.
fn is_off_line(curve: &Bezier<DVec2>, first: &Bezier<DVec2>) -> bool {
    let start = first.start();
    let along = first.points().iter().map(|p| p - start).find(|d| *d != DVec2::ZERO).unwrap_or(DVec2::X);
    let off = |p: &DVec2| along.perp_dot(p - start).abs() > 1e-9 * along.length() * p.distance(start);
    curve.points().iter().any(off)
}

impl Sweep {
    /// A point of the prism's own space in that of the shape.
    fn world(&self, x: f64, y: f64, z: f64) -> DVec3 {
        self.origin + x * self.axes[0] + y * self.axes[1] + z * self.axes[2]
    }

    fn local_vector(&self, v: DVec3) -> DVec3 {
        DVec3::from_array(self.axes.map(|axis| axis.dot(v)))
    }

    fn local(&self, p: DVec3) -> DVec3 {
        self.local_vector(p - self.origin)
    }
}

impl Parts {
    /// How large the outline is at a height.
    fn size_at(&self, z: f64) -> f64 {
        1.0 - self.narrowing * z
    }

    /// Visits the pieces of a ray's line inside, with a hit for each end, in ascending order; none if it passes the box within its range.
    fn intervals(&self, ray: &Ray, mut visit: impl FnMut([(f64, Hit); 2])) {
        let Some((near, _)) = self.bounds.clip(ray) else { return };
        let shift = if near.is_finite() { f64::from(near) } else { 0.0 };
        let world = Ray64::new(ray);
        let line = Ray64 { o: self.sweep.local(world.at(shift)), d: self.sweep.local_vector(world.d) };
        let Some(course) = self.course(line) else { return };
        let at_end = |t: f64, enters: bool| {
            let part = if (line.d.z > 0.0) == enters { NEAR_END } else { FAR_END };
            (shift + t, Hit { part, ..Hit::default() })
        };
        let at = |border: &Border, end: f64, enters: bool| match border.curve {
            Some(curve) if (border.t > end) == enters && border.t != end => {
                let v = if curve.outside_left { 1.0 } else { -1.0 };
                (shift + border.t, Hit { t: 0.0, u: curve.s as f32, v, part: FIRST_WALL + curve.curve })
            }
            _ => at_end(end, enters),
        };
        self.inside(&course, |[start, end]| {
            let [lo, hi] = course.slab;
            if start.t >= hi || end.t <= lo {
                return;
            }
            let whole = [at(&start, lo, true), at(&end, hi, false)];
            let Some(edge) = &self.edge else { return visit(whole) };
            let bevelled = |t: f64| {
                let is_far = course.line.at(t).z > 0.5 * self.sweep.depth;
                let part = FIRST_WALL + self.curves.len() as u32 + u32::from(is_far);
                (shift + t, Hit { part, ..Hit::default() })
            };
            let mut open = whole[0];
            let range = [start.t.max(lo), end.t.min(hi)];
            let ends_inside = self.bevel_crossings(edge, &course.line, range, |t, enters| {
                if enters {
                    open = bevelled(t);
                } else {
                    visit([open, bevelled(t)]);
                }
            });
            if ends_inside {
                visit([open, whole[1]]);
            }
        });
    }

    /// The bevelled edge, for a hit on it.
    fn edge_of(&self, hit: &Hit) -> Option<&BevelledEdge> {
        self.edge.as_ref().filter(|_| hit.part as usize >= FIRST_WALL as usize + self.curves.len())
    }

    /// What a ray in the prism's own space does; `None` where it is never between both ends.
    fn course(&self, line: Ray64) -> Option<Course> {
        let Ray64 { o, d } = line;
        let slab = if d.z == 0.0 {
            (o.z > 0.0 && o.z < self.sweep.depth).then_some([f64::NEG_INFINITY, f64::INFINITY])?
        } else {
            let [p, q] = [-o.z / d.z, (self.sweep.depth - o.z) / d.z];
            [p.min(q), p.max(q)]
        };
        Some(Course { line, a: self.size_at(o.z), b: -self.narrowing * d.z, slab })
    }

    /// Visits the pieces of a line where it is inside of the outline, were there no ends.
    fn inside(&self, course: &Course, mut visit: impl FnMut([Border; 2])) {
        let Course { line: Ray64 { o, d }, a, b, slab } = *course;
        let (o, d) = (o.truncate(), d.truncate());
        let direction = a * d - b * o;
        // Along the axis, or to the tip: always at the same place of the outline.
        let still = 4.0 * f64::EPSILON * (a.abs() * d.abs().max_element() + b.abs() * o.abs().max_element());
        if direction.abs().max_element() <= still {
            let t = 0.5 * (slab[0] + slab[1]);
            let fills = t.is_finite() && self.sweep.rule.fills(self.winding((o + t * d) / (a + b * t)));
            let ends = [f64::NEG_INFINITY, f64::INFINITY].map(|t| Border { t, curve: None });
            return fills.then_some(ends).into_iter().for_each(visit);
        }
        let side = PlaneLine::new(direction.perp(), o.perp_dot(d), self.reach);
        let mut crossings = SCRATCH.take();
        crossings.clear();
        self.tree.each(
            |bounds| side.overlaps(bounds),
            |i| {
                let curve = &self.curves[i as usize];
                side.crossings(curve, |s, from_right| {
                    let p = curve.at(s);
                    // (o + t d) / (a + b t) = p.
                    let (w, along) = (a * p - o, d - b * p);
                    let t = w.dot(along) / along.length_squared();
                    // Beyond the tip the outline is mirrored.
                    if b == 0.0 || a + b * t > 0.0 {
                        crossings.push(Crossing { t, curve: i, s, from_right });
                    }
                });
            },
        );
        // At the tip the line is infinitely far from the outline.
        let sum: i32 = crossings.iter().map(|crossing| if crossing.from_right { 1 } else { -1 }).sum();
        let before = if b < 0.0 { -sum } else { 0 };
        let nearer = SAME * (self.reach + o.abs().max_element()) / course.line.d.length();
        inside_intervals(&mut crossings, self.sweep.rule, before, nearer, &mut visit);
        SCRATCH.set(crossings);
    }

    /// How often the outline goes around a point, by what is on the right of it.
    fn winding(&self, p: DVec2) -> i32 {
        let right = PlaneLine::new(DVec2::Y, -p.y, self.reach);
        let mut sum = 0;
        self.tree.each(
            |bounds| right.overlaps(bounds) && bounds[1].x >= p.x,
            |i| sum += winding(&self.curves[i as usize..=i as usize], p),
        );
        sum
    }

    /// The parameter of the place of a wall's curve that is nearest to a point, and its height; by Newton's method from `s`.
    fn on_wall(&self, hit: &Hit, p: Vec3) -> (Bezier<DVec2>, f64, f64) {
        let local = self.sweep.local(p.as_dvec3());
        let z = local.z.clamp(0.0, self.sweep.depth);
        let curve = self.curves[(hit.part - FIRST_WALL) as usize];
        let q = local.truncate() / self.size_at(z);
        (curve, nearest_parameter(&curve, q, hit.u.into()), z)
    }

    /// The outline as polygons.
    ///
    /// * `around`: segments of a full circle
    fn polygons(&self, around: u32) -> Vec<Vec<DVec2>> {
        let contour = |range: &[usize]| {
            let curves = &self.curves[range[0]..range[1]];
            let steps = |curve: &Bezier<DVec2>| segments(curve, around);
            let points = |curve: &Bezier<DVec2>| {
                let (curve, n) = (*curve, steps(curve));
                (0..n).map(move |i| curve.at(f64::from(i) / f64::from(n)))
            };
            curves.iter().flat_map(points).collect()
        };
        self.contours.windows(2).map(contour).collect()
    }
}

impl Surface for Prism {
    fn bounds(&self) -> Aabb {
        self.0.bounds
    }

    fn is_finite(&self) -> bool {
        self.0.bounds.is_finite() && self.0.narrowing.is_finite()
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        nearest_crossing(self, ray)
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        self.0.intervals(ray, |ends| {
            for (t, hit) in ends {
                if let Some(t) = in_range(ray, t) {
                    visit(Hit { t, ..hit });
                }
            }
        });
    }

    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let parts = &*self.0;
        let sweep = &parts.sweep;
        let p = Ray64::new(ray).at(hit.t.into());
        let scale = sweep.origin.abs().max_element() + parts.reach * sweep.taper.max(1.0) + sweep.depth;
        if hit.part < FIRST_WALL {
            let local = sweep.local(p);
            let (z, n) =
                if hit.part == NEAR_END { (0.0, -sweep.axes[2]) } else { (sweep.depth, sweep.axes[2]) };
            let (p, p_error) = stored(sweep.world(local.x, local.y, z), scale);
            return SurfacePoint::flat(p, p_error, n.as_vec3());
        }
        if let Some(edge) = parts.edge_of(hit) {
            let local = sweep.local(p);
            let at = parts.bevel_point(edge, local);
            let [x, y, z] = (local + at.depth * at.normal).to_array();
            let [nx, ny, nz] = at.normal.to_array();
            let n = sweep.axes[0] * nx + sweep.axes[1] * ny + sweep.axes[2] * nz;
            let (p, p_error) = stored(sweep.world(x, y, z), scale);
            return SurfacePoint::flat(p, p_error, n.as_vec3());
        }
        let (curve, s, z) = parts.on_wall(hit, p.as_vec3());
        let (at, size) = (curve.at(s), parts.size_at(z));
        let left = direction(&curve, s).perp();
        let out = if hit.v < 0.0 { -left } else { left };
        let n =
            sweep.axes[0] * out.x + sweep.axes[1] * out.y + sweep.axes[2] * (parts.narrowing * at.dot(out));
        let (p, p_error) = stored(sweep.world(size * at.x, size * at.y, z), scale);
        SurfacePoint::flat(p, p_error, n.normalize_or(sweep.axes[2]).as_vec3())
    }

    /// On a wall `u` runs once around its contour and `v` from the near end to the far one; on the ends and their bevels both lie in the
    /// box of the outline.
    fn uv_at(&self, hit: &Hit, p: Vec3) -> Vec2 {
        let parts = &*self.0;
        if hit.part < FIRST_WALL || parts.edge_of(hit).is_some() {
            let local = parts.sweep.local(p.as_dvec3());
            let [min, max] = parts.tree.bounds();
            let q = local.truncate() / if hit.part == FAR_END { parts.sweep.taper } else { 1.0 };
            return ((q - min) / (max - min)).clamp(DVec2::ZERO, DVec2::ONE).as_vec2();
        }
        let (_, s, z) = parts.on_wall(hit, p);
        let [from, share] = parts.shares[(hit.part - FIRST_WALL) as usize];
        Vec2::new((from + share * s) as f32, (z / parts.sweep.depth) as f32)
    }

    fn tangents_at(&self, hit: &Hit, p: Vec3) -> Tangents {
        let parts = &*self.0;
        let sweep = &parts.sweep;
        let [x, y, axis] = sweep.axes;
        if hit.part < FIRST_WALL {
            let [min, max] = parts.tree.bounds();
            let extent = (max - min) * if hit.part == NEAR_END { 1.0 } else { sweep.taper };
            return Tangents { dpdu: (extent.x * x).as_vec3(), dpdv: (extent.y * y).as_vec3() };
        }
        if let Some(edge) = parts.edge_of(hit) {
            let at = parts.bevel_point(edge, sweep.local(p.as_dvec3()));
            let [min, max] = parts.tree.bounds();
            let out = at.normal.truncate().normalize_or_zero();
            // Towards the wall the surface goes down from the end.
            let down = at.slope * out * -at.normal.z.signum();
            let along =
                |axis: DVec3, extent: f64, down: f64| (extent * (axis + down * sweep.axes[2])).as_vec3();
            let extent = max - min;
            return Tangents { dpdu: along(x, extent.x, down.x), dpdv: along(y, extent.y, down.y) };
        }
        let (curve, s, z) = parts.on_wall(hit, p);
        let [_, share] = parts.shares[(hit.part - FIRST_WALL) as usize];
        let (along, at) = (parts.size_at(z) / share * direction(&curve, s), curve.at(s));
        let inward = -parts.narrowing * at;
        let dpdv = sweep.depth * (axis + inward.x * x + inward.y * y);
        Tangents { dpdu: (along.x * x + along.y * y).as_vec3(), dpdv: dpdv.as_vec3() }
    }

    fn is_closed(&self) -> bool {
        true
    }

    fn part_count(&self) -> u32 {
        FIRST_WALL + self.0.curves.len() as u32 + if self.0.edge.is_some() { 2 } else { 0 }
    }

    fn without_patches(&self) -> Option<&'static str> {
        Some("a prism")
    }

    fn tessellate(&self, around: u32, out: &mut Tessellation) {
        let parts = &*self.0;
        let sweep = &parts.sweep;
        let size = parts.tree.bounds()[1].distance(parts.tree.bounds()[0]);
        for triangle in fill(&parts.polygons(around), sweep.rule) {
            for (part, z, n) in [(NEAR_END, 0.0, -sweep.axes[2]), (FAR_END, sweep.depth, sweep.axes[2])] {
                let size = parts.size_at(z);
                let corners = triangle
                    .map(|p| out.vertex(sweep.world(size * p.x, size * p.y, z).as_vec3(), n.as_vec3()));
                out.turned(part, corners);
            }
        }
        for (i, curve) in parts.curves.iter().enumerate() {
            let (middle, beside) =
                (curve.at(0.5), direction(curve, 0.5).normalize_or_zero().perp() * (1e-6 * size));
            let [left, right] =
                [middle + beside, middle - beside].map(|p| sweep.rule.fills(parts.winding(p)));
            if left == right {
                continue;
            }
            out.grid(FIRST_WALL + i as u32, [segments(curve, around), 1], |s, v| {
                let (at, z) = (curve.at(s), v * sweep.depth);
                let p = parts.size_at(z) * at;
                let perp = direction(curve, s).perp();
                let across = if left { -perp } else { perp };
                let n = sweep.axes[0] * across.x
                    + sweep.axes[1] * across.y
                    + sweep.axes[2] * (parts.narrowing * at.dot(across));
                (sweep.world(p.x, p.y, z), n.normalize_or_zero())
            });
        }
    }

    fn heap_bytes(&self) -> usize {
        let parts = &*self.0;
        size_of::<Parts>()
            + size_of_val(&*parts.curves)
            + size_of_val(&*parts.shares)
            + parts.tree.bytes()
            + parts.edge.as_ref().map_or(0, BevelledEdge::bytes)
    }
}

#[cfg(test)]
mod tests;
