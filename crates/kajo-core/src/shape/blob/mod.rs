//! Blobs: surfaces where the sum of fields around balls, cylinders and half spaces reaches a threshold.
//!
//! ```text
//! f(p) = sum_i b_i k(d_i(p)^2 / r_i^2) = T
//! ```
//!
//! with `d_i` the distance from the core of component `i` and a kernel `k` that falls [Blinn 1982; Wyvill, McPheeters and
//! Wyvill 1986]. Negative strengths take away. Inside is where the sum is larger. Half spaces are cores without an end, and so may be
//! the blob: then it is a solid as a plane is one.
//!
//! Components may have materials. Their shares at a point are those of the fields that add to the sum; surface coordinates of a
//! blob are these shares, from which [`crate::texture::SurfaceShare`] mixes the materials.
//!
//! What of space a surface may pass is known before anything is rendered, with the components whose support overlaps it ([`cells`]): rays
//! look for crossings there alone. Blobs without an end have no such parts, and are asked between the borders of all components.
//!
//! Along a ray each `d_i^2` is convex, so the bounds of a component on a piece of it, and of its derivative, follow from the
//! ends. A piece whose sum cannot reach the threshold holds no crossing, one on which the derivative cannot vanish holds one
//! or none, and any other is halved: every crossing is found, and none that is not there [Mitchell 1990].
//!
//! POV-Ray's kernel around balls needs no bounds: along a ray it is a quartic ([`quartic`]).
//!
//! Scene: `Blob { threshold 0.5  sphere { center 0 0 0  radius 1 }  sphere { center 1.2 0 0  radius 1 } }`

mod cell;
mod cells;
mod extent;
mod field;
mod quartic;

use std::cell::RefCell;
use std::sync::Arc;

use kajo_bvh::{BuildSettings, Bvh};
use kajo_math::roots::bracketed;
use kajo_math::{Aabb, DVec3, Ray, Vec2, Vec3};

use self::cells::{CellSpan, SurfaceCells};
use self::extent::Extent;
use self::field::{Range, Term, sum_of_bounds};
use self::quartic::QuarticBalls;
use super::{Patch, Ray64, Surface, Tessellation, TracedPatch, in_range, stored};
use crate::interaction::{Hit, NO_UV, SurfacePoint, Tangents};
pub use field::{BlobComponent, BlobCore, BlobKernel, MOST_MATERIALS};

/// From this many components on a tree finds those that a ray comes near.
const TERMS_FOR_A_TREE: usize = 8;

/// What is cut off the tails of all Gaussians together may move the surface by about as much as this, in parts of the radius.
const CUT: f64 = 1e-9;

/// A blob. A clone is the same blob.
#[derive(Clone, Debug)]
pub struct Blob(Arc<Parts>);

#[derive(Debug)]
struct Parts {
    kernel: BlobKernel,
    threshold: f64,
    terms: Vec<Term>,
    /// Over the terms with bounds.
    tree: Option<Bvh>,
    /// The terms without.
    unbounded: Vec<u32>,
    bounds: Aabb,
    /// The largest coordinate.
    reach: f64,
    /// More than all the strengths' rounding.
    rounding: f64,
    /// What its surface may pass, if that has an end.
    cells: Option<SurfaceCells>,
    /// Where the field along a ray is a quartic between the borders of components.
    quartic: Option<QuarticBalls>,
    /// How many materials there are.
    materials: usize,
}

/// A component that a ray passes.
#[derive(Clone, Copy)]
struct Passage {
    term: u32,
    from: f64,
    to: f64,
}

/// Memory that rays use again and again.
#[derive(Default)]
struct Scratch {
    passages: Vec<Passage>,
    /// Where the support of components begins or ends.
    borders: Vec<f64>,
    /// Those that do on the piece at hand.
    active: Vec<u32>,
    roots: Vec<f64>,
    /// Components near a point.
    near: Vec<u32>,
    /// Pieces of a ray in cells.
    pieces: Vec<CellSpan>,
    /// Crossings on their way to who asked for them.
    found: Vec<Hit>,
}

thread_local! {
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

impl Blob {
    /// * `threshold`: value of the field at the surface, above zero
    /// * `components`: radii above zero, normals of unit length
    ///
    /// `None` when one of these is not so.
    pub fn new(kernel: BlobKernel, threshold: f64, components: &[BlobComponent]) -> Option<Blob> {
        let is_usable =
            |component: &BlobComponent| component.radius > 0.0 && component.material < MOST_MATERIALS;
        let usable = threshold > 0.0 && components.iter().all(is_usable);
        usable.then_some(())?;
        let negligible = CUT * threshold / components.len().max(1) as f64;
        let said = components.iter().filter(|component| component.strength != 0.0);
        let terms: Vec<Term> = said.map(|component| Term::new(component, kernel, negligible)).collect();
        // Trees leave empty boxes out.
        let tree_box = |term: &Term| if term.is_bounded() { term.bounds() } else { Aabb::EMPTY };
        let boxes: Vec<Aabb> = terms.iter().map(tree_box).collect();
        let (unbounded, without_end): (Vec<u32>, Vec<f64>) = (0..)
            .zip(&terms)
            .filter(|(_, term)| !term.is_bounded())
            .map(|(i, term)| (i, term.strength().max(0.0)))
            .unzip();
        let tree = (boxes.len() >= TERMS_FOR_A_TREE).then(|| Bvh::build(&boxes, &BuildSettings::default()));
        // Only what adds to the field can bring it to the threshold.
        let adds = terms.iter().zip(&boxes).filter(|(term, _)| term.adds()).map(|(_, bounds)| *bounds);
        let reaches = adds.fold(Aabb::EMPTY, Aabb::union);
        // Where half spaces reach the threshold by themselves, they do so for ever.
        let bounds = if without_end.iter().sum::<f64>() >= threshold * (1.0 - 1e-9) {
            Aabb::EVERYWHERE
        } else {
            Extent { kernel, threshold, terms: &terms }.bounds(reaches)
        };
        let far = match bounds.is_finite() {
            true => bounds.min.abs().max(bounds.max.abs()).max_element(),
            false => terms.iter().map(|term| term.scale().iter().sum::<f64>()).fold(0.0, f64::max) as f32,
        };
        let strengths: f64 = components.iter().map(|component| component.strength.abs()).sum();
        let rounding = 64.0 * f64::EPSILON * (strengths + threshold);
        let reach = if bounds.is_empty() { 0.0 } else { far.into() };
        let cells = SurfaceCells::new(kernel, &terms, [threshold - rounding, threshold + rounding], bounds);
        let quartic = QuarticBalls::new(kernel, &terms, threshold).filter(|_| cells.is_some());
        let materials = terms.iter().map(|term| term.material + 1).max().unwrap_or(1);
        Some(Blob(Arc::new(Parts {
            kernel,
            threshold,
            terms,
            tree,
            unbounded,
            bounds,
            reach,
            rounding,
            cells,
            quartic,
            materials,
        })))
    }

    /// The field less the threshold, and its gradient.
    pub fn field(&self, p: DVec3) -> (f64, DVec3) {
        SCRATCH.with_borrow_mut(|Scratch { near, .. }| {
            self.0.find_near(p, self.0.margin(p), near);
            self.0.sum_of(near, p)
        })
    }

    /// [`descend`] by the components that the tree finds.
    fn descend_with_tree(&self, p: DVec3) -> (DVec3, DVec3) {
        let parts = &*self.0;
        SCRATCH.with_borrow_mut(|Scratch { near, .. }| {
            let (mut found_at, margin) = (p, parts.margin(p));
            parts.find_near(p, 2.0 * margin, near);
            let found = descend(p, |p| {
                if p.distance(found_at) > margin {
                    parts.find_near(p, 2.0 * margin, near);
                    found_at = p;
                }
                Some(parts.sum_of(near, p))
            });
            found.unwrap_or((p, DVec3::Z))
        })
    }

    /// Of each material but the first the share that it has at a point of what it and those before it have together.
    ///
    /// Materials have shares by the fields that add to the sum. So the first material, mixed with the second by its share, this
    /// mixture with the third, and so on, have all materials by their fields. The share of the first is 1.
    pub fn shares(&self, p: DVec3) -> [f32; MOST_MATERIALS] {
        let fields = SCRATCH.with_borrow_mut(|Scratch { near, .. }| {
            let parts = &*self.0;
            parts.find_near(p, parts.margin(p), near);
            let mut fields = [0.0; MOST_MATERIALS];
            for &i in &*near {
                let term = &parts.terms[i as usize];
                fields[term.material] += term.at(parts.kernel, p).0.max(0.0);
            }
            fields
        });
        let mut sum = 0.0;
        fields.map(|field| {
            sum += field;
            if sum > 0.0 { (field / sum) as f32 } else { 0.0 }
        })
    }
}

/// A point brought onto the surface along the gradient, and the outward normal there; `None` where the field is not known.
///
/// * `field`: its value less the threshold, and its gradient
#[inline]
fn descend(mut p: DVec3, mut field: impl FnMut(DVec3) -> Option<(f64, DVec3)>) -> Option<(DVec3, DVec3)> {
    const STEPS: u32 = 2;
    for _ in 0..STEPS {
        let (value, gradient) = field(p)?;
        let length2 = gradient.length_squared();
        if length2 > 0.0 {
            p -= value / length2 * gradient;
        }
    }
    let (_, gradient) = field(p)?;
    Some((p, (-gradient).normalize_or(DVec3::Z)))
}

impl Parts {
    /// How far from a point components are looked for.
    fn margin(&self, p: DVec3) -> f64 {
        1e-5 * (self.reach + p.abs().max_element())
    }

    /// The components whose support comes within a margin of a point, in their order.
    fn find_near(&self, p: DVec3, margin: f64, near: &mut Vec<u32>) {
        near.clear();
        let Some(tree) = &self.tree else { return near.extend(0..self.terms.len() as u32) };
        let margin = margin as f32;
        let here = Ray::new(p.as_vec3(), Vec3::X).over(-margin, margin);
        tree.each(&here, |i| near.push(i));
        near.extend_from_slice(&self.unbounded);
        // The sum has the same bits whatever way the tree goes.
        near.sort_unstable();
    }

    /// The field of these components less the threshold, and its gradient.
    fn sum_of(&self, near: &[u32], p: DVec3) -> (f64, DVec3) {
        let (mut value, mut gradient) = (-self.threshold, DVec3::ZERO);
        for &i in near {
            let (v, g) = self.terms[i as usize].at(self.kernel, p);
            value += v;
            gradient += g;
        }
        (value, gradient)
    }

    /// Visits all crossings within a ray's range, in ascending order, until `visit` says that it is enough.
    fn crossings(&self, ray: &Ray, mut visit: impl FnMut(f64) -> bool) {
        SCRATCH.with_borrow_mut(|scratch| match &self.cells {
            Some(cells) => {
                let mut pieces = std::mem::take(&mut scratch.pieces);
                cells.each(ray, &mut pieces, |members, line, piece| {
                    self.cross(members, line, piece, scratch, &mut visit)
                });
                scratch.pieces = pieces;
            }
            None => self.crossings_without_end(ray, scratch, &mut visit),
        });
    }

    /// The first crossing within a ray's range on a piece of it that lies in the support of these components alone.
    #[inline(always)]
    fn first_in(
        &self,
        ray: &Ray,
        (members, line, piece): (&[u32], &Ray64, [f64; 2]),
        scratch: &mut Scratch,
    ) -> Option<f32> {
        let mut first = None;
        self.cross(members, line, piece, scratch, &mut |t| {
            first = in_range(ray, t);
            first.is_some()
        });
        first
    }

    /// Visits the crossings on a piece of a line that lies in the support of these components alone, in ascending order, until `visit` says
    /// that it is enough; whether it did.
    #[inline(always)]
    fn cross(
        &self,
        members: &[u32],
        line: &Ray64,
        piece: [f64; 2],
        scratch: &mut Scratch,
        visit: &mut impl FnMut(f64) -> bool,
    ) -> bool {
        match &self.quartic {
            Some(balls) => balls.cross(members, line, piece, &mut scratch.borders, visit),
            None => {
                RaySpan { parts: self, line, members }.isolate_all(piece, &mut scratch.roots);
                scratch.roots.drain(..).any(visit)
            }
        }
    }

    /// [`Parts::crossings`] of a blob without an end, piece by piece between the borders of components.
    fn crossings_without_end(&self, ray: &Ray, scratch: &mut Scratch, visit: &mut impl FnMut(f64) -> bool) {
        let line = Ray64::new(ray);
        self.gather(ray, &line, scratch);
        let Some([lo, hi]) = between_borders(&scratch.borders, ray) else { return };
        scratch.borders.retain(|&t| t > lo && t < hi);
        scratch.borders.push(hi);
        scratch.borders.sort_unstable_by(f64::total_cmp);
        let (mut from, mut before) = (lo, None);
        for &to in &scratch.borders {
            if to <= from {
                continue;
            }
            let overlaps = |passage: &&Passage| passage.from < to && passage.to > from;
            scratch.active.clear();
            scratch.active.extend(scratch.passages.iter().filter(overlaps).map(|passage| passage.term));
            let span = RaySpan { parts: self, line: &line, members: &scratch.active };
            let [a, b] = [from, to].map(|t| span.at(t).0);
            // At borders components that begin or end are zero but for rounding, which must not hide a crossing.
            let a = before.unwrap_or(a);
            span.isolate([from, to], [a, b], &mut scratch.roots);
            if scratch.roots.drain(..).any(&mut *visit) {
                break;
            }
            (from, before) = (to, Some(b));
        }
    }

    /// The components that a ray passes, in their order.
    fn gather(&self, ray: &Ray, line: &Ray64, scratch: &mut Scratch) {
        let Scratch { passages, borders, roots, .. } = scratch;
        passages.clear();
        borders.clear();
        roots.clear();
        let mut add = |i: u32| {
            let term = &self.terms[i as usize];
            if let Some([from, to]) = term.extent_along(line.o, line.d) {
                passages.push(Passage { term: i, from, to });
                borders.extend([from, to]);
                borders.extend(term.flat_from(line.o, line.d));
            }
        };
        match &self.tree {
            Some(tree) => {
                tree.each(ray, &mut add);
                self.unbounded.iter().for_each(|&i| add(i));
            }
            None => (0..self.terms.len() as u32).for_each(&mut add),
        }
        passages.sort_unstable_by_key(|passage| passage.term);
    }
}

/// The part of a ray outside of which a field without bounds does not change: from before the first border to behind the last.
fn between_borders(borders: &[f64], ray: &Ray) -> Option<[f64; 2]> {
    let finite = || borders.iter().copied().filter(|t| t.is_finite());
    let (first, last) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    let margin = 1e-3 * (last - first) + 1e-9 * first.abs().max(last.abs()) + f64::from(f32::MIN_POSITIVE);
    let (lo, hi) = ((first - margin).max(ray.t_min.into()), (last + margin).min(ray.t_max.into()));
    (lo < hi).then_some([lo, hi])
}

/// A line, and the components whose support overlaps a piece of it.
struct RaySpan<'a> {
    parts: &'a Parts,
    line: &'a Ray64,
    members: &'a [u32],
}

impl RaySpan<'_> {
    /// The field less the threshold, and its derivative.
    fn at(&self, t: f64) -> (f64, f64) {
        let Parts { kernel, threshold, terms, .. } = self.parts;
        let p = self.line.at(t);
        let mut sum = (-threshold, 0.0);
        for &i in self.members {
            let (value, slope) = terms[i as usize].along(*kernel, p, self.line.d);
            sum.0 += value;
            sum.1 += slope;
        }
        sum
    }

    /// Bounds of the field and of its derivative on a piece.
    fn bounds(&self, piece: [f64; 2]) -> (Range, Range) {
        let Parts { kernel, terms, .. } = self.parts;
        sum_of_bounds(terms, self.members, *kernel, (self.line.o, self.line.d), piece)
    }

    /// Whether the field is on one side of the threshold for sure.
    fn is_away(&self, field: Range) -> bool {
        let Parts { threshold, rounding, .. } = self.parts;
        field.lo > threshold + rounding || field.hi < threshold - rounding
    }

    /// Adds the crossings between two parameters.
    fn isolate_all(&self, [a, b]: [f64; 2], roots: &mut Vec<f64>) {
        // Most pieces are passed over by this alone.
        let bounds = self.bounds([a, b]);
        if !self.is_away(bounds.0) {
            self.isolate_within([a, b], [a, b].map(|t| self.at(t).0), bounds, roots);
        }
    }

    /// Adds the crossings between two parameters with these values of the field.
    fn isolate(&self, piece: [f64; 2], ends: [f64; 2], roots: &mut Vec<f64>) {
        self.isolate_within(piece, ends, self.bounds(piece), roots);
    }

    /// The same with the bounds of the field and of its derivative.
    fn isolate_within(
        &self,
        [a, b]: [f64; 2],
        [at_a, at_b]: [f64; 2],
        (value, slope): (Range, Range),
        roots: &mut Vec<f64>,
    ) {
        let changes = (at_a < 0.0) != (at_b < 0.0);
        if !changes && self.is_away(value) {
            return;
        }
        let middle = 0.5 * (a + b);
        let narrow = b - a <= 1e-12 * (a.abs() + b.abs()) || middle <= a || middle >= b;
        if narrow || !slope.contains(0.0) {
            if changes {
                let tolerance = 2.0 * f64::EPSILON;
                roots.push(bracketed([a, b], middle, at_a < 0.0, tolerance, |t| self.at(t)));
            }
            return;
        }
        let at_middle = self.at(middle).0;
        // How far the field may be at the ends from what it is in the middle.
        let change = 0.5 * (b - a) * slope.lo.abs().max(slope.hi.abs());
        if !changes && at_middle.abs() > change + self.parts.rounding {
            return;
        }
        self.isolate([a, middle], [at_a, at_middle], roots);
        self.isolate([middle, b], [at_middle, at_b], roots);
    }
}

impl Surface for Blob {
    fn bounds(&self) -> Aabb {
        self.0.bounds
    }

    fn is_finite(&self) -> bool {
        self.0.reach.is_finite()
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let parts = &*self.0;
        if let Some(cells) = &parts.cells {
            let (t, cell) = SCRATCH.with_borrow_mut(|scratch| {
                cells
                    .nearest(ray, |members, line, piece| parts.first_in(ray, (members, line, piece), scratch))
            })?;
            return Some(Hit { t, u: cell as f32, ..Hit::default() });
        }
        let mut first = None;
        parts.crossings(ray, |t| {
            first = in_range(ray, t).map(|t| Hit { t, ..Hit::default() });
            first.is_some()
        });
        first
    }

    fn blocks(&self, ray: &Ray) -> bool {
        let parts = &*self.0;
        let Some(cells) = &parts.cells else { return self.hit(ray).is_some() };
        SCRATCH.with_borrow_mut(|scratch| {
            cells.any(ray, |members, line, piece| {
                parts.first_in(ray, (members, line, piece), scratch).is_some()
            })
        })
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        // `visit` may intersect another blob.
        let mut all = SCRATCH.with_borrow_mut(|scratch| std::mem::take(&mut scratch.found));
        self.0.crossings(ray, |t| {
            all.extend(in_range(ray, t).map(|t| Hit { t, ..Hit::default() }));
            false
        });
        all.drain(..).for_each(&mut visit);
        SCRATCH.with_borrow_mut(|scratch| scratch.found = all);
    }

    /// The point is brought onto the surface along the gradient.
    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let p = Ray64::new(ray).at(hit.t.into());
        let in_cell = self.0.cells.as_ref().and_then(|cells| {
            // Where single precision takes the number for another one, that cell is not near.
            let cell = hit.u as u32;
            descend(p, |p| Some(self.0.sum_of(cells.members_near(cell, p)?, p)))
        });
        let (p, n) = in_cell.unwrap_or_else(|| self.descend_with_tree(p));
        let (p, p_error) = stored(p, self.0.reach);
        SurfacePoint::flat(p, p_error, n.as_vec3())
    }

    /// The shares of its second and third material; see [`Blob::shares`].
    fn uv_at(&self, _hit: &Hit, p: Vec3) -> Vec2 {
        if self.0.materials < 2 {
            return NO_UV;
        }
        let [_, second, third, ..] = self.shares(p.as_dvec3());
        Vec2::new(second, third)
    }

    /// Those of its fourth and fifth.
    fn second_uv_at(&self, _hit: &Hit, p: Vec3) -> Option<Vec2> {
        let [.., fourth, fifth] = if self.0.materials > 3 { self.shares(p.as_dvec3()) } else { return None };
        Some(Vec2::new(fourth, fifth))
    }

    fn tangents_at(&self, _hit: &Hit, _p: Vec3) -> Tangents {
        Tangents::default()
    }

    fn is_closed(&self) -> bool {
        self.0.bounds.is_empty() || self.0.bounds.is_finite()
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn starts_inside(&self, ray: &Ray) -> bool {
        let parts = &*self.0;
        let line = Ray64::new(ray);
        let at_start = |&i: &u32| parts.terms[i as usize].at_start(parts.kernel, line.o, line.d);
        !self.is_closed()
            && parts.unbounded.iter().map(at_start).fold(-parts.threshold, |sum, v| sum + v) >= 0.0
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        let Parts { kernel, threshold, terms, bounds, .. } = &*self.0;
        if !self.is_closed() {
            return;
        }
        let center = bounds.center().as_dvec3();
        let extent = Extent { kernel: *kernel, threshold: *threshold, terms };
        if let Some(patch) = TracedPatch::new(self.clone(), 0) {
            let patch = patch.within(center, extent.radius(*bounds, center));
            visit(0, Patch::Traced(Box::new(patch)));
        }
    }

    fn tessellate(&self, around: u32, out: &mut Tessellation) {
        let bounds = match self.is_closed() {
            true => self.0.bounds,
            false => {
                let shown = self.0.terms.iter().map(Term::shown).fold(Aabb::EMPTY, Aabb::union);
                shown.padded(0.25 * shown.extent().max_element())
            }
        };
        out.level_set(bounds, around, |p| {
            let (value, gradient) = self.field(p);
            (value, -gradient)
        });
    }

    fn heap_bytes(&self) -> usize {
        size_of::<Parts>()
            + size_of_val(&*self.0.terms)
            + size_of_val(&*self.0.unbounded)
            + self.0.tree.as_ref().map_or(0, |tree| tree.stats().bytes)
            + self.0.cells.as_ref().map_or(0, SurfaceCells::heap_bytes)
            + self.0.quartic.as_ref().map_or(0, QuarticBalls::heap_bytes)
    }
}

#[cfg(test)]
mod tests;
