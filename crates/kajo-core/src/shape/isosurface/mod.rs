//! Isosurfaces: where a function of the place is zero.
//!
//! A place of a box is inside where `f(x, y, z) < 0`; outside where `f` is zero, positive or has no value. The surface is
//! the border of the inside, and of a closed one the faces of the box belong to it where they cut through the inside.
//!
//! Before anything is rendered the box is halved along its axes again and again, and interval arithmetic tells which parts
//! `f` has one sign in; cells stay that it may be zero in, with bounds on the gradient of `f` in each ([`cells`]). A ray asks
//! those cells that it passes. Where the bounds say that `f` rises or falls all along the ray, the values at both ends of
//! the passage decide whether there is the one crossing that there can be; anywhere else the passage is halved, by
//! intervals of value and derivative [Mitchell 1990]. So every crossing is found that is wider than rounding, whatever the
//! function, and nobody has to know how steep it is. Cells share the planes between them, bit for bit, and what is known of
//! a cell holds for points that rounding has moved out of it, so that crossings of a closed surface come in pairs.
//!
//! Scene: `Isosurface { function = x^2 + y^2 + z^2 - 1  min -1 -1 -1  max 1 1 1 }`

mod cells;

use std::cell::{self, RefCell};
use std::sync::Arc;

use kajo_bvh::{BuildSettings, Bvh};
use kajo_math::interval::{Domain, Interval};
use kajo_math::tape::{Dual, Tape};
use kajo_math::{Aabb, DVec3, Ray, Vec2, Vec3, roots};

use self::cells::{Cell, Cells};
use super::{Patch, Ray64, Surface, Tessellation, TracedPatch, box_faces, in_range, stored};
use crate::interaction::{Hit, NO_UV, SurfacePoint, Tangents};

/// An isosurface. A clone is the same surface.
#[derive(Clone, Debug)]
pub struct Isosurface(Arc<Parts>);

#[derive(Debug)]
struct Parts {
    function: Arc<Tape>,
    cells: Cells,
    tree: Bvh,
    bounds: Aabb,
    closed: bool,
    /// The largest coordinate.
    reach: f64,
}

/// Memory that evaluations use again and again.
#[derive(Default)]
struct Scratch {
    values: Vec<f64>,
    slopes: Vec<Dual<f64, 1>>,
    gradients: Vec<Dual<f64, 3>>,
    bounds: Vec<Dual<Interval, 1>>,
}

/// Memory for the crossings of a line.
#[derive(Default)]
struct Crossings {
    /// What the line has of each cell, and the number of that.
    intervals: Vec<([f64; 2], u32)>,
    hits: Vec<Hit>,
}

thread_local! {
    static SCRATCH: RefCell<Scratch> = RefCell::default();
    /// Taken while it is in use.
    static CROSSINGS: cell::Cell<Crossings> = cell::Cell::default();
}

/// What a ray does within cells.
struct Passage<'a> {
    parts: &'a Parts,
    line: &'a Ray64,
    /// Halvings left, so that no function takes forever: one that is zero but for rounding would.
    work: u32,
    /// The value at a parameter where a cell ends and the next may begin.
    last: Option<(f64, f64)>,
    /// The farthest parameter up to which a cell was asked, and whether the line is inside there.
    end: Option<(f64, bool)>,
}

/// More than that of a sum, in parts of its terms.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Halvings of a ray's passages at most. A ray that touches a surface needs some forty.
const MOST_WORK: u32 = 2048;

impl Isosurface {
    /// * `function`: of x, y and z
    /// * `min`, `max`: corners of the box, each coordinate of `min` less than that of `max`
    /// * `closed`: whether the faces of the box belong to it
    ///
    /// `None` for a box that is none.
    pub fn new(function: Arc<Tape>, min: Vec3, max: Vec3, closed: bool) -> Option<Isosurface> {
        let is_box = min.is_finite() && max.is_finite() && min.cmplt(max).all();
        is_box.then_some(())?;
        let cells = Cells::of(&function, [min.as_dvec3(), max.as_dvec3()]);
        let boxes: Vec<Aabb> = cells.iter().map(|cell| cells.bounds(cell)).collect();
        let tree = Bvh::build(&boxes, &BuildSettings::default());
        let whole = Aabb { min, max };
        let bounds = if closed && cells.fills_faces() {
            whole
        } else {
            boxes.iter().fold(Aabb::EMPTY, |all, cell| all.union(*cell))
        };
        let reach = min.abs().max(max.abs()).max_element().into();
        Some(Isosurface(Arc::new(Parts { function, cells, tree, bounds, closed, reach })))
    }

    /// Whether there is no surface in the box.
    pub fn is_empty(&self) -> bool {
        self.0.bounds.is_empty()
    }

    /// The value of the function.
    pub fn value(&self, p: DVec3) -> f64 {
        self.0.value(p)
    }

    /// The value of the function, and its gradient.
    pub fn gradient(&self, p: DVec3) -> (f64, DVec3) {
        let [x, y, z] = p.to_array();
        let of = |value: f64, axis: usize| Dual {
            value,
            slopes: std::array::from_fn(|k| f64::from(u8::from(k == axis))),
        };
        SCRATCH.with_borrow_mut(|scratch| {
            let found = self.0.function.at(&[of(x, 0), of(y, 1), of(z, 2)], &mut scratch.gradients);
            (found.value, DVec3::from_array(found.slopes))
        })
    }
}

impl Parts {
    fn value(&self, p: DVec3) -> f64 {
        SCRATCH.with_borrow_mut(|scratch| self.function.at(&p.to_array(), &mut scratch.values))
    }

    /// Whether a place is inside, whose coordinates are those of the box or between them.
    fn is_inside(&self, p: DVec3) -> bool {
        self.value(p) < 0.0
    }

    /// Where a line is in the box, and through which faces it comes and goes.
    fn faces(&self, line: &Ray64) -> Option<[(f64, u32); 2]> {
        box_faces::faces(self.cells.corners(), line)
    }

    /// The hit of a face of the box, if it is in the ray's range and cuts through the inside.
    fn cap(&self, ray: &Ray, line: &Ray64, face: (f64, u32)) -> Option<Hit> {
        box_faces::cap(ray, line, face, |p| self.is_inside(p))
    }

    /// A passage that no cell has been asked of.
    fn passage<'a>(&'a self, line: &'a Ray64) -> Passage<'a> {
        Passage { parts: self, line, work: MOST_WORK, last: None, end: None }
    }
}

impl Passage<'_> {
    /// The value of the function at a parameter.
    fn value(&self, t: f64) -> f64 {
        self.parts.value(self.line.at(t))
    }

    /// The value and how it changes along the ray.
    fn value_and_slope(&self, t: f64) -> (f64, f64) {
        let (p, d) = (self.line.at(t), self.line.d);
        let along = [0, 1, 2].map(|axis| Dual { value: p[axis], slopes: [d[axis]] });
        let found = SCRATCH.with_borrow_mut(|scratch| self.parts.function.at(&along, &mut scratch.slopes));
        (found.value, found.slopes[0])
    }

    /// Bounds on both over a piece of the ray.
    fn bounds(&self, [a, b]: [f64; 2]) -> Dual<Interval, 1> {
        let (o, d) = (self.line.o, self.line.d);
        let along = [0, 1, 2].map(|axis| {
            let slope = Interval::point(d[axis]);
            Dual { value: Interval::point(o[axis]) + Interval::new(a, b) * slope, slopes: [slope] }
        });
        SCRATCH.with_borrow_mut(|scratch| self.parts.function.at(&along, &mut scratch.bounds))
    }

    /// The hit of the face that the line enters by; the value there is that of the first cell, if that begins there.
    fn front(&mut self, ray: &Ray, (t, face): (f64, u32)) -> Option<Hit> {
        let single = in_range(ray, t)?;
        let value = self.value(t);
        self.last = Some((t, value));
        self.end = Some((t, value < 0.0));
        (value < 0.0).then(|| box_faces::on_face(single, face))
    }

    /// The hit of the face that the line leaves by, once all cells on the way have been asked: from the last of them on
    /// the function has one sign.
    fn back(&self, ray: &Ray, face: (f64, u32)) -> Option<Hit> {
        match self.end {
            Some((_, inside)) => box_faces::cap(ray, self.line, face, |_| inside),
            None => self.parts.cap(ray, self.line, face),
        }
    }

    /// Visits the changes of sign in a cell between two parameters in ascending order, until `visit` says that it is enough:
    /// two parameters between which there is one, and a function that tells where. Returns whether it was enough.
    fn cross(
        &mut self,
        cell: &Cell,
        [a, b]: [f64; 2],
        visit: &mut impl FnMut([f64; 2], &dyn Fn() -> f64) -> bool,
    ) -> bool {
        // Neighbours agree on the value between them.
        let known = self.last.filter(|(t, _)| *t == a).map(|(_, value)| value);
        let at_a = known.unwrap_or_else(|| self.value(a));
        let (at_b, is_enough) = self.cross_from(cell, [a, b], at_a, visit);
        self.last = at_b.map(|value| (b, value));
        if self.end.is_none_or(|(t, _)| b > t) {
            self.end = Some((b, at_b.unwrap_or(at_a) < 0.0));
        }
        is_enough
    }

    /// The same from a known value at `a` on.
    ///
    /// Returns the value at `b`, unless it was not asked for, as there is no change of sign; and whether it was enough.
    fn cross_from(
        &mut self,
        cell: &Cell,
        [a, b]: [f64; 2],
        at_a: f64,
        visit: &mut impl FnMut([f64; 2], &dyn Fn() -> f64) -> bool,
    ) -> (Option<f64>, bool) {
        let [rise, most] = cell.slope_along(self.line.d);
        // As sharp as the bounds of the cell itself, but for this ray.
        let length = (b - a) * (1.0 + ROUNDING);
        let rounding = ROUNDING * at_a.abs();
        if at_a + rise.min(0.0) * length > rounding || at_a + most.max(0.0) * length < -rounding {
            return (None, false);
        }
        if rise > 0.0 || most < 0.0 {
            let at_b = self.value(b);
            let changes = (at_a < 0.0) != (at_b < 0.0);
            let least = rise.max(-most);
            let curvature = cell.curvature_along(self.line.d);
            let root = || match curvature.is_finite() {
                true => self.steep_root([a, b], [at_a, at_b], least, curvature),
                false => self.single_root([a, b], [at_a, at_b]),
            };
            return (Some(at_b), changes && visit([a, b], &root));
        }
        let curvature = cell.curvature_along(self.line.d);
        if curvature.is_finite() {
            let ends = [a, b].map(|t| self.value_and_slope(t));
            return (Some(ends[1].0), self.bend([a, b], ends, curvature, visit));
        }
        let at_b = self.value(b);
        (Some(at_b), self.isolate([a, b], [at_a, at_b], visit))
    }

    /// Visits the changes of sign between two parameters with these values and slopes, as [`Passage::cross`].
    ///
    /// * `curvature`: bound on the second derivative. The function departs from its chord by an eighth of it times the
    ///   square of the length, and its slope from the mean of the slopes at the ends by half of it times the length.
    fn bend(
        &mut self,
        [a, b]: [f64; 2],
        [(at_a, slope_a), (at_b, slope_b)]: [(f64, f64); 2],
        curvature: f64,
        visit: &mut impl FnMut([f64; 2], &dyn Fn() -> f64) -> bool,
    ) -> bool {
        let (changes, length) = ((at_a < 0.0) != (at_b < 0.0), b - a);
        if !changes && at_a.abs().min(at_b.abs()) > 0.125 * curvature * length * length {
            return false;
        }
        let middle = 0.5 * (a + b);
        self.work = self.work.saturating_sub(1);
        if (slope_a + slope_b).abs() > curvature * length || is_narrow([a, b]) || self.work == 0 {
            return changes && visit([a, b], &|| self.single_root([a, b], [at_a, at_b]));
        }
        let at_middle = self.value_and_slope(middle);
        self.bend([a, middle], [(at_a, slope_a), at_middle], curvature, visit)
            || self.bend([middle, b], [at_middle, (at_b, slope_b)], curvature, visit)
    }

    /// Visits the changes of sign between two parameters with these values, as [`Passage::cross`].
    fn isolate(
        &mut self,
        [a, b]: [f64; 2],
        [at_a, at_b]: [f64; 2],
        visit: &mut impl FnMut([f64; 2], &dyn Fn() -> f64) -> bool,
    ) -> bool {
        let found = self.bounds([a, b]);
        let (value, slope) = (found.value, found.slopes[0]);
        let changes = (at_a < 0.0) != (at_b < 0.0);
        let has_values = value.domain == Domain::Everywhere;
        if !changes && (value.lo >= 0.0 || value.domain == Domain::Nowhere || (value.hi < 0.0 && has_values))
        {
            return false;
        }
        let middle = 0.5 * (a + b);
        self.work = self.work.saturating_sub(1);
        let is_monotone = has_values && (slope.lo > 0.0 || slope.hi < 0.0);
        if is_narrow([a, b]) || is_monotone || self.work == 0 {
            return changes && visit([a, b], &|| self.single_root([a, b], [at_a, at_b]));
        }
        let at_middle = self.value(middle);
        self.isolate([a, middle], [at_a, at_middle], visit)
            || self.isolate([middle, b], [at_middle, at_b], visit)
    }

    /// The crossing between two parameters at whose ends the function has different signs.
    fn single_root(&self, [a, b]: [f64; 2], [at_a, at_b]: [f64; 2]) -> f64 {
        let start = start_of([a, b], [at_a, at_b]);
        roots::bracketed([a, b], start, at_a < 0.0, self.tolerance([a, b]), |t| self.value_and_slope(t))
    }

    /// The same where the function rises or falls all along.
    ///
    /// A step of Newton's method from `t` lands at a distance of at most `c f(t)^2 / (2 m^3)` from the root where the second
    /// derivative is at most `c` and the slope at least `m`: so the last step needs no look at where it lands.
    ///
    /// * `least`: a bound from below on how steep it is
    /// * `curvature`: a bound on its second derivative
    fn steep_root(&self, [a, b]: [f64; 2], [at_a, at_b]: [f64; 2], least: f64, curvature: f64) -> f64 {
        const MOST_STEPS: u32 = 8;
        let tolerance = self.tolerance([a, b]) * a.abs().max(b.abs());
        let mut t = start_of([a, b], [at_a, at_b]);
        for _ in 0..MOST_STEPS {
            let (value, slope) = self.value_and_slope(t);
            let newton = t - value / slope;
            if !(newton > a && newton < b) {
                break;
            }
            if curvature * value * value <= 2.0 * tolerance * least * least * least {
                return newton;
            }
            t = newton;
        }
        self.single_root([a, b], [at_a, at_b])
    }

    /// How exact a crossing has to be, in parts of the parameter.
    fn tolerance(&self, [a, b]: [f64; 2]) -> f64 {
        /// Of the box's coordinates; some places more than single precision has, and fewer than rounding leaves.
        const TOLERANCE: f64 = 1e-13;
        (TOLERANCE * self.parts.reach / a.abs().max(b.abs())).max(4.0 * f64::EPSILON)
    }
}

/// Where to begin to look for the crossing between two parameters with these values: where their chord has it.
fn start_of([a, b]: [f64; 2], [at_a, at_b]: [f64; 2]) -> f64 {
    let secant = a + (b - a) * (at_a / (at_a - at_b));
    if secant > a && secant < b { secant } else { 0.5 * (a + b) }
}

/// Whether nothing is left to halve.
fn is_narrow([a, b]: [f64; 2]) -> bool {
    let middle = 0.5 * (a + b);
    b - a <= 4.0 * f64::EPSILON * (a.abs() + b.abs()) || middle <= a || middle >= b
}

impl Surface for Isosurface {
    fn bounds(&self) -> Aabb {
        self.0.bounds
    }

    fn is_finite(&self) -> bool {
        true
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let parts = &*self.0;
        let line = Ray64::new(ray);
        let faces = if parts.closed { parts.faces(&line) } else { None };
        let mut passage = parts.passage(&line);
        if let Some(front) = faces.and_then(|[front, _]| passage.front(ray, front)) {
            return Some(front);
        }
        let mut nearest = None;
        parts.tree.closest(ray, |index, far| {
            let cell = &parts.cells[index];
            let range = [f64::from(ray.t_min), f64::from(far)];
            let Some(piece) = parts.cells.clip(cell, &line, range) else { return far };
            let mut first = None;
            passage.cross(cell, piece, &mut |_, root| {
                first = in_range(ray, root());
                first.is_some()
            });
            match first {
                Some(t) if t < far => {
                    nearest = Some(Hit { t, ..Hit::default() });
                    t
                }
                _ => far,
            }
        });
        nearest.or_else(|| faces.and_then(|[_, back]| passage.back(ray, back)))
    }

    fn blocks(&self, ray: &Ray) -> bool {
        let parts = &*self.0;
        let line = Ray64::new(ray);
        let faces = if parts.closed { parts.faces(&line) } else { None };
        let mut passage = parts.passage(&line);
        let range = [f64::from(ray.t_min), f64::from(ray.t_max)];
        faces.is_some_and(|[front, _]| passage.front(ray, front).is_some())
            || parts.tree.any(ray, |index| {
                let cell = &parts.cells[index];
                let piece = parts.cells.clip(cell, &line, range);
                piece.is_some_and(|piece| {
                    passage.cross(cell, piece, &mut |between, root| {
                        let is_within = between.into_iter().all(|t| in_range(ray, t).is_some());
                        is_within || in_range(ray, root()).is_some()
                    })
                })
            })
            || faces.is_some_and(|[_, back]| passage.back(ray, back).is_some())
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        let parts = &*self.0;
        let line = Ray64::new(ray);
        let faces = if parts.closed { parts.faces(&line) } else { None };
        let mut crossings = CROSSINGS.take();
        let Crossings { intervals, hits } = &mut crossings;
        parts.tree.each(ray, |index| {
            let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
            let interval = parts.cells.clip(&parts.cells[index], &line, everywhere);
            intervals.extend(interval.map(|interval| (interval, index)));
        });
        intervals.sort_unstable_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]));
        let mut passage = parts.passage(&line);
        for (interval, index) in intervals.drain(..) {
            passage.cross(&parts.cells[index], interval, &mut |_, root| {
                hits.extend(in_range(ray, root()).map(|t| Hit { t, ..Hit::default() }));
                false
            });
        }
        let faces = faces.into_iter().flatten();
        hits.extend(faces.filter_map(|face| parts.cap(ray, &line, face)));
        // `visit` may intersect another surface, which takes memory of its own.
        hits.drain(..).for_each(&mut visit);
        CROSSINGS.set(crossings);
    }

    /// The point is brought onto the surface along the gradient, or onto the face of the box.
    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        const STEPS: u32 = 2;
        let mut p = Ray64::new(ray).at(hit.t.into());
        if let Some((p, n)) = box_faces::face_point(self.0.cells.corners(), hit, p) {
            let (p, p_error) = stored(p, self.0.reach);
            return SurfacePoint::flat(p, p_error, n.as_vec3());
        }
        let [shortest, short, longest] = [1e-13, 1e-6, 1e-4].map(|part| part * self.0.reach);
        let mut gradient = DVec3::ZERO;
        for step_number in 0..=STEPS {
            let value;
            (value, gradient) = self.gradient(p);
            let step = value / gradient.length_squared() * gradient;
            let length = step.length();
            // Rounding is more, and the normal stays what it is.
            if step_number == STEPS || length < shortest {
                break;
            }
            // Not across a jump of the function.
            if length < longest {
                p -= step;
            }
            // The next step would be shorter than the square of that, and the normal turns by less than the point is known to.
            if length < short {
                break;
            }
        }
        let n = gradient.normalize_or(-Ray64::new(ray).d.normalize_or(DVec3::Z));
        let (p, p_error) = stored(p, self.0.reach);
        SurfacePoint::flat(p, p_error, n.as_vec3())
    }

    /// An isosurface has no surface coordinates.
    fn uv_at(&self, _hit: &Hit, _p: Vec3) -> Vec2 {
        NO_UV
    }

    fn tangents_at(&self, _hit: &Hit, _p: Vec3) -> Tangents {
        Tangents::default()
    }

    fn is_closed(&self) -> bool {
        self.0.closed
    }

    fn hit_at(&self, _part: u32, p: Vec3) -> Hit {
        let face = box_faces::face_at(self.0.cells.corners(), p).filter(|_| self.0.closed);
        face.map_or(Hit::default(), |face| box_faces::on_face(0.0, face))
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        TracedPatch::new(self.clone(), 0)
            .into_iter()
            .for_each(|patch| visit(0, Patch::Traced(Box::new(patch))));
    }

    fn tessellate(&self, around: u32, out: &mut Tessellation) {
        let corners = self.0.cells.corners();
        box_faces::tessellate(corners, self.0.bounds, self.0.closed, around, out, |p| {
            let (value, gradient) = self.gradient(p);
            (if value.is_finite() { -value } else { -1.0 }, gradient)
        });
    }

    fn heap_bytes(&self) -> usize {
        size_of::<Parts>()
            + self.0.function.heap_bytes()
            + self.0.cells.heap_bytes()
            + self.0.tree.stats().bytes
    }
}

#[cfg(test)]
mod tests;
