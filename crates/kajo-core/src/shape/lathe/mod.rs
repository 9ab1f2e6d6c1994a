//! Lathes: profiles in a half plane, turned about its edge.
//!
//! A ray's distance from the axis and its height follow a branch of a hyperbola in the plane of the profile; see `course.rs`. Where
//! the profile crosses from one side of it to the other the ray meets the surface: roots of polynomials of twice the degree of a
//! curve, up to 6 [van Wijk 1984], isolated by Bernstein coefficients. Straight pieces are frusta of cones.
//!
//! Where all profiles are closed, or begin and end on the axis, the lathe is a solid: of a ray the pieces inside follow from winding
//! numbers in the half plane, as for prisms, so that crossings come in pairs and no surface is where profiles overlap. Otherwise
//! it is a sheet, whose outside is on the right of the profile.
//!
//! Scene: `Lathe { profile { line 0 0  1 0  0.6 1  0 1 } }`

use std::cell::Cell;
use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;

use kajo_math::solid_angle::basis64;
use kajo_math::{Aabb, DVec2, DVec3, Ray, Vec2, Vec3, fmath, roots};

use self::course::{Course, Rim};
use super::outline::{
    BorderCurve, BoxTree, Crossing, box_of, direction, inside_intervals, nearest_parameter, segments, shares,
    winding,
};
use super::{
    Bezier, FillRule, Patch, Path, Ray64, Surface, Tessellation, TracedPatch, in_range, nearest_crossing,
    stored,
};
use crate::interaction::{Hit, SurfacePoint, Tangents};

mod course;

/// Crossings are one if they are nearer than this to each other, in parts of the size.
const SAME: f64 = 64.0 * f64::EPSILON;

/// A surface of revolution. A clone is the same one.
#[derive(Clone, Debug)]
pub struct Lathe(Arc<Parts>);

/// Where a profile is in space.
#[derive(Clone, Copy, Debug)]
pub struct Turning {
    /// Where `(0, 0)` of the profile is.
    pub origin: DVec3,
    /// The axis: what is up in the profile; of unit length.
    pub axis: DVec3,
    /// What is inside where profiles cross.
    pub rule: FillRule,
}

/// Why there is no such lathe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LatheError {
    /// No point is off the axis, or a closed profile has no area.
    Nothing,
    /// A profile, by its number, goes to the other side of the axis.
    CrossesAxis(usize),
}

impl fmt::Display for LatheError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LatheError::Nothing => {
                f.write_str("there is nothing to turn: all points of a profile are on one line")
            }
            LatheError::CrossesAxis(_) => {
                f.write_str("this profile crosses the axis: distances from it are 0 or more")
            }
        }
    }
}

#[derive(Debug)]
struct Parts {
    turning: Turning,
    /// Two directions across the axis; coordinates begin at the first.
    across: [DVec3; 2],
    curves: Vec<Bezier<DVec2>>,
    /// What each curve has of the way along its profile: from where, and how much.
    shares: Vec<[f64; 2]>,
    tree: BoxTree,
    rim: Rim,
    bounds: Aabb,
    closed: bool,
}

thread_local! {
    /// Memory that rays use again and again.
    static SCRATCH: Cell<Vec<Crossing>> = const { Cell::new(Vec::new()) };
}

impl Lathe {
    /// * `profiles`: x is the distance from the axis, not negative, y the height along it
    ///
    /// # Errors
    ///
    /// Where there is nothing to turn, or a profile crosses the axis.
    pub fn new(turning: Turning, profiles: &[Path<DVec2>]) -> Result<Lathe, LatheError> {
        let (mut curves, mut share) = (Vec::new(), Vec::new());
        for (i, profile) in profiles.iter().enumerate() {
            if !has_extent(profile) {
                return Err(LatheError::Nothing);
            }
            let reach = profile
                .curves()
                .iter()
                .flat_map(Bezier::points)
                .fold(0.0f64, |m, p| m.max(p.abs().max_element()));
            if profile.curves().iter().any(|curve| least_distance(curve) < -1e-9 * reach) {
                return Err(LatheError::CrossesAxis(i));
            }
            share.extend(shares(profile.curves()));
            curves.extend_from_slice(profile.curves());
        }
        if curves.is_empty() || u32::try_from(curves.len()).is_err() {
            return Err(LatheError::Nothing);
        }
        let on_axis = |path: &Path<DVec2>| {
            let ends = [path.curves().first().map(Bezier::start), Some(path.end())];
            ends.iter().flatten().all(|p| p.x == 0.0)
        };
        let closed = profiles.iter().all(|path| path.is_closed() || on_axis(path));
        let boxes: Vec<[DVec2; 2]> = curves.iter().map(box_of).collect();
        let tree = BoxTree::new(&boxes);
        let [min, max] = tree.bounds();
        let rim = Rim { radius: max.x.max(-min.x), low: min.y, high: max.y };
        let bounds =
            boxes.iter().map(|bounds| turning.bounds(*bounds)).fold(Aabb::EMPTY, Aabb::union).padded(1e-6);
        let (x, y) = basis64(turning.axis);
        let parts = Parts { turning, across: [x, y], curves, shares: share, tree, rim, bounds, closed };
        Ok(Lathe(Arc::new(parts)))
    }
}

/// Whether a profile makes a surface: one that is not all on the axis, and where it is closed has an area.
fn has_extent(profile: &Path<DVec2>) -> bool {
    let points = || profile.curves().iter().flat_map(Bezier::points);
    let Some(&first) = points().next() else { return false };
    let Some(along) = points().map(|p| *p - first).find(|d| *d != DVec2::ZERO) else { return false };
    let is_line =
        points().all(|p| along.perp_dot(*p - first).abs() <= 1e-9 * along.length() * p.distance(first));
    points().any(|p| p.x != 0.0) && !(is_line && profile.is_closed())
}

/// The least x of a curve: at an end, or where its derivative vanishes.
fn least_distance(curve: &Bezier<DVec2>) -> f64 {
    let legs: Vec<f64> = curve.points().windows(2).map(|pair| pair[1].x - pair[0].x).collect();
    let flat = match *legs {
        [a, b] => Some((a / (a - b), a / (a - b))),
        [a, b, c] => roots::quadratic(a - 2.0 * b + c, b - a, a),
        _ => None,
    };
    let within = flat.into_iter().flat_map(|(s, t)| [s, t]).filter(|s| (0.0..=1.0).contains(s));
    within.map(|s| curve.at(s).x).fold(curve.start().x.min(curve.end().x), f64::min)
}

impl Turning {
    /// A box around all that points in a box of the half plane become.
    fn bounds(&self, [min, max]: [DVec2; 2]) -> Aabb {
        let reach = max.x.abs().max(min.x.abs())
            * (DVec3::ONE - self.axis * self.axis).max(DVec3::ZERO).map(f64::sqrt);
        let [low, high] = [min.y, max.y].map(|height| self.origin + height * self.axis);
        Aabb { min: (low.min(high) - reach).as_vec3(), max: (low.max(high) + reach).as_vec3() }
    }
}

/// A point beside the axis.
struct ProfilePoint {
    /// Distance from the axis, and height.
    at: DVec2,
    /// Unit direction from the axis.
    radial: DVec3,
}

impl Parts {
    fn profile_point(&self, p: DVec3) -> ProfilePoint {
        let w = p - self.turning.origin;
        let height = w.dot(self.turning.axis);
        let across = w - height * self.turning.axis;
        ProfilePoint { at: DVec2::new(across.length(), height), radial: across.normalize_or(self.across[0]) }
    }

    /// A point of the half plane in a direction from the axis.
    fn world(&self, at: DVec2, radial: DVec3) -> DVec3 {
        self.turning.origin + at.x * radial + at.y * self.turning.axis
    }

    /// Visits all crossings of a ray's line, each with the hit there; none if it passes the box within its range.
    fn each(&self, ray: &Ray, mut visit: impl FnMut(f64, Hit)) {
        let Some((near, _)) = self.bounds.clip(ray) else { return };
        let from = if near.is_finite() { f64::from(near) } else { 0.0 };
        let line = Ray64::new(ray);
        let (o, length) = (line.at(from) - self.turning.origin, line.d.length());
        let [x, y, z] = [self.across[0], self.across[1], self.turning.axis];
        let local = |v: DVec3| DVec3::new(x.dot(v), y.dot(v), z.dot(v));
        let Some(course) = Course::new(local(o), local(line.d / length), &self.rim) else { return };
        let mut crossings = SCRATCH.take();
        crossings.clear();
        self.tree.each(
            |bounds| course.overlaps(bounds),
            |i| {
                course.crossings(&self.curves[i as usize], |at| {
                    crossings.push(Crossing { t: at.t, curve: i, s: at.s, from_right: at.from_right });
                });
            },
        );
        let mut found = |t: f64, border: BorderCurve| visit(from + t / length, border.hit());
        if self.closed {
            let nearer = SAME * (self.rim.radius + o.abs().max_element());
            inside_intervals(&mut crossings, self.turning.rule, 0, nearer, |ends| {
                ends.iter().for_each(|end| end.curve.into_iter().for_each(|curve| found(end.t, curve)));
            });
        } else {
            for crossing in &crossings {
                found(crossing.t, BorderCurve { curve: crossing.curve, s: crossing.s, outside_left: false });
            }
        }
        SCRATCH.set(crossings);
    }

    /// Which side of a curve is outside, if one is: whether it is the left one.
    fn outside(&self, curve: &Bezier<DVec2>, s: f64) -> Option<bool> {
        if !self.closed {
            return Some(false);
        }
        let size = self.rim.radius + self.rim.high - self.rim.low;
        let (at, beside) = (curve.at(s), direction(curve, s).normalize_or_zero().perp() * (1e-6 * size));
        let [left, right] = [at + beside, at - beside]
            .map(|p| p.x > 0.0 && self.turning.rule.fills(winding(&self.curves, p)));
        (left != right).then_some(!left)
    }

    /// The curve of a hit, the parameter of its place nearest to a point, and which side is outside.
    fn curve_at(&self, hit: &Hit, at: DVec2) -> (usize, f64) {
        let i = (hit.v.abs() as usize).clamp(1, self.curves.len()) - 1;
        (i, nearest_parameter(&self.curves[i], at, hit.u.into()))
    }

    /// The normal of a curve at a parameter, outward, in a direction from the axis.
    fn normal(&self, curve: &Bezier<DVec2>, s: f64, outside_left: bool, radial: DVec3) -> DVec3 {
        let left = direction(curve, s).perp();
        let out = if outside_left { left } else { -left };
        (out.x * radial + out.y * self.turning.axis).normalize_or(radial)
    }
}

impl BorderCurve {
    /// A hit at which `v` names the curve, with the sign of the side that is outside.
    fn hit(&self) -> Hit {
        let number = (self.curve + 1) as f32;
        Hit { t: 0.0, u: self.s as f32, v: if self.outside_left { number } else { -number }, part: 0 }
    }
}

impl Surface for Lathe {
    fn bounds(&self) -> Aabb {
        self.0.bounds
    }

    fn is_finite(&self) -> bool {
        self.0.bounds.is_finite()
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        nearest_crossing(self, ray)
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        self.0.each(ray, |t, hit| {
            if let Some(t) = in_range(ray, t) {
                visit(Hit { t, ..hit });
            }
        });
    }

    /// The point is brought onto the curve in its half plane.
    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let parts = &*self.0;
        let ProfilePoint { at, radial } = parts.profile_point(Ray64::new(ray).at(hit.t.into()));
        let (i, s) = parts.curve_at(hit, at);
        let curve = &parts.curves[i];
        let n = parts.normal(curve, s, hit.v > 0.0, radial);
        let heights = parts.rim.low.abs().max(parts.rim.high.abs());
        let scale = parts.turning.origin.abs().max_element() + parts.rim.radius + heights;
        let (p, p_error) = stored(parts.world(curve.at(s), radial), scale);
        SurfacePoint::flat(p, p_error, n.as_vec3())
    }

    fn hit_at(&self, _part: u32, p: Vec3) -> Hit {
        const STEPS: u32 = 8;
        let parts = &*self.0;
        let ProfilePoint { at, .. } = parts.profile_point(p.as_dvec3());
        let nearest = |(i, curve): (usize, &Bezier<DVec2>)| {
            let starts = (0..=STEPS).map(|k| f64::from(k) / f64::from(STEPS));
            let start = starts.min_by(|&a, &b| curve.at(a).distance(at).total_cmp(&curve.at(b).distance(at)));
            let s = nearest_parameter(curve, at, start.unwrap_or_default());
            (i, s, curve.at(s).distance(at))
        };
        let places = parts.curves.iter().enumerate().map(nearest);
        let Some((i, s, _)) = places.min_by(|a, b| a.2.total_cmp(&b.2)) else { return Hit::default() };
        let outside_left = parts.outside(&parts.curves[i], s).unwrap_or(false);
        BorderCurve { curve: i as u32, s, outside_left }.hit()
    }

    /// `u` runs once around the axis, `v` along the profile.
    fn uv_at(&self, hit: &Hit, p: Vec3) -> Vec2 {
        let parts = &*self.0;
        let w = p.as_dvec3() - parts.turning.origin;
        let [x, y] = parts.across.map(|axis| w.dot(axis));
        let turn = fmath::atan2_64(y, x) / TAU;
        let (i, s) = parts.curve_at(hit, parts.profile_point(p.as_dvec3()).at);
        let [from, share] = parts.shares[i];
        Vec2::new((if turn < 0.0 { turn + 1.0 } else { turn }) as f32, (from + share * s) as f32)
    }

    fn tangents_at(&self, hit: &Hit, p: Vec3) -> Tangents {
        let parts = &*self.0;
        let ProfilePoint { at, radial } = parts.profile_point(p.as_dvec3());
        let (i, s) = parts.curve_at(hit, at);
        let along = direction(&parts.curves[i], s) / parts.shares[i][1];
        let dpdu = TAU * at.x * parts.turning.axis.cross(radial);
        let dpdv = along.x * radial + along.y * parts.turning.axis;
        Tangents { dpdu: dpdu.as_vec3(), dpdv: dpdv.as_vec3() }
    }

    fn is_closed(&self) -> bool {
        self.0.closed
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        let patch = TracedPatch::new(self.clone(), 0);
        patch.into_iter().for_each(|patch| visit(0, Patch::Traced(Box::new(patch))));
    }

    fn tessellate(&self, around: u32, out: &mut Tessellation) {
        let parts = &*self.0;
        let [x, y] = parts.across;
        for curve in &parts.curves {
            let Some(outside_left) = parts.outside(curve, 0.5) else { continue };
            // What is on the axis has no area.
            if curve.points().iter().all(|p| p.x == 0.0) {
                continue;
            }
            out.grid(0, [around.max(3), segments(curve, around)], |u, s| {
                let (sin, cos) = fmath::sincos64(TAU * u);
                let radial = cos * x + sin * y;
                (parts.world(curve.at(s), radial), parts.normal(curve, s, outside_left, radial))
            });
        }
    }

    fn heap_bytes(&self) -> usize {
        let parts = &*self.0;
        size_of::<Parts>() + size_of_val(&*parts.curves) + size_of_val(&*parts.shares) + parts.tree.bytes()
    }
}

#[cfg(test)]
mod tests;
