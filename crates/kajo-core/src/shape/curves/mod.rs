//! Curves: strands of cubics with a width, for hair, grass and wires.
//!
//! A **tube** is swept by a disk across the curve `c(s)` with the radius `r(s)`, so that points of its side satisfy
//!
//! ```text
//! (p - c(s)) . c'(s) = 0,    |p - c(s)| = r(s).
//! ```
//!
//! Along a ray, `s` follows from the first equation, and `g(t) = |p - c(s)|^2 - r(s)^2` changes its sign where the ray crosses; of a
//! straight span of one width it is the quadratic of a cylinder. Curves are cut into spans that turn by a few degrees, on
//! each of which `g` has one extremum at most. No tube is made of cylinders or cones: what is met is the surface itself.
//!
//! A **ribbon** is flat and faces the viewer: seen along a ray, it is what is nearer to the curve than the radius. The
//! nearest places of the curve are roots of a quintic, which are isolated by Bernstein coefficients [`kajo_math::roots`].
//!
//! Spans of all strands lie in one tree. Neighbours share the numbers where they join, see [`span`].
//!
//! Scene: `Curves { radius 0.05  tipRadius 0  strand { points 0 0 0  0 1 0  0.3 2 0 } }`

mod span;
mod strands;

use std::f64::consts::TAU;
use std::sync::Arc;

use kajo_bvh::{BuildSettings, Bvh};
use kajo_math::solid_angle::basis64;
use kajo_math::{Aabb, DVec3, Ray, Vec2, Vec3, fmath, roots};

use self::span::{CurvePoint, CurveSpan, End, SpanHit};
use self::strands::Node;
pub use self::strands::Strands;
use super::{Patch, Ray64, Surface, Tessellation, TracedPatch, in_range, stored};
use crate::interaction::{Hit, SurfacePoint, Tangents};

/// How far a span may turn, in radians.
const MOST_TURN: f64 = 0.26;

/// A segment is cut into 2 to this many spans at most.
const MOST_LEVELS: u32 = 6;

/// Neighbours whose directions differ by more than the square root of this, in radians, meet in a corner.
const CORNER: f64 = 1e-10;

/// Tubes of more spans are met by chance if they give light.
const MOST_PATCHES: usize = 512;

/// From so many spans on two neighbours share a box of the tree, which halves its size.
const MANY: usize = 50_000;

/// How control points make a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveBasis {
    /// Straight from point to point.
    Linear,
    /// Cubics of four points, each beginning with the last point of the one before.
    Bezier,
    /// A uniform cubic B-spline, from the first point to the last.
    BSpline,
    /// Through all points.
    CatmullRom,
}

/// What is made of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveForm {
    /// Round, with flat ends.
    Tube,
    /// Flat, facing the ray.
    Ribbon,
}

/// Why strands make no curves.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CurvesError {
    /// Counts from 0.
    #[error("strand {} has {points} points, which make no curve", strand + 1)]
    PointCount {
        /// The strand.
        strand: usize,
        /// How many there are.
        points: usize,
    },
    /// A coordinate or a radius that is no finite number, or a radius below zero.
    #[error("a point of strand {} has a coordinate or a radius that cannot be", strand + 1)]
    BadNumber {
        /// The strand.
        strand: usize,
    },
    /// More than 32-bit numbers tell apart.
    #[error("there are more spans of curves than can be told apart")]
    TooMany,
    /// No strand is longer than a point.
    #[error("there are no curves: the points of each strand are all the same")]
    Empty,
}

/// Curves. A clone is the same curves.
#[derive(Clone, Debug)]
pub struct Curves(Arc<Parts>);

#[derive(Debug)]
struct Parts {
    basis: CurveBasis,
    form: CurveForm,
    nodes: Vec<Node>,
    /// Where the nodes of each strand begin.
    strands: Vec<u32>,
    leaves: Vec<Leaf>,
    /// How many leaves share a box of the tree.
    group: u32,
    tree: Bvh,
    bounds: Aabb,
    /// The largest coordinate.
    reach: f64,
    dropped: usize,
}

/// A span of a segment, or a corner.
#[derive(Clone, Copy, Debug)]
struct Leaf {
    node: u32,
    /// Which of 2 to the power of `level` spans.
    span: u8,
    level: u8,
    kind: LeafKind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum LeafKind {
    /// With disks where the strand begins and ends.
    Side { begins: bool, ends: bool },
    /// A ball, or a disk that faces the ray, where straight lines or Béziers meet at an angle.
    Corner,
}

/// [`Hit::u`] of the disks at the two ends of a strand.
const CAPS: [f32; 2] = [-1.0, 2.0];

impl Curves {
    /// Curves of these control points. Strands whose points are all the same are left out and counted.
    ///
    /// # Errors
    /// The first mistake in the strands, in their order.
    pub fn new(strands: &Strands, basis: CurveBasis, form: CurveForm) -> Result<Curves, CurvesError> {
        let mut parts = Parts {
            basis,
            form,
            nodes: Vec::new(),
            strands: Vec::new(),
            leaves: Vec::new(),
            group: 1,
            tree: Bvh::default(),
            bounds: Aabb::EMPTY,
            reach: 0.0,
            dropped: 0,
        };
        for strand in 0..strands.len() {
            let range = strands.range(strand);
            let (points, radii) = (&strands.points[range.clone()], &strands.radii[range]);
            if !basis.takes(points.len()) {
                return Err(CurvesError::PointCount { strand, points: points.len() });
            }
            let usable =
                points.iter().all(|p| p.is_finite()) && radii.iter().all(|r| *r >= 0.0 && r.is_finite());
            if !usable {
                return Err(CurvesError::BadNumber { strand });
            }
            let first = parts.nodes.len();
            if u32::try_from(first + 2 * points.len()).is_err() {
                return Err(CurvesError::TooMany);
            }
            basis.nodes(points, radii, &mut parts.nodes);
            if !parts.add_leaves(first) {
                parts.nodes.truncate(first);
                parts.dropped += 1;
                continue;
            }
            parts.strands.push(first as u32);
        }
        if parts.leaves.is_empty() {
            return Err(CurvesError::Empty);
        }
        if u32::try_from(parts.leaves.len()).is_err() {
            return Err(CurvesError::TooMany);
        }
        parts.group = if parts.leaves.len() < MANY { 1 } else { 2 };
        let around =
            |leaves: &[Leaf]| leaves.iter().fold(Aabb::EMPTY, |all, leaf| all.union(parts.leaf_bounds(leaf)));
        let boxes: Vec<Aabb> = parts.leaves.chunks(parts.group as usize).map(around).collect();
        parts.bounds = boxes.iter().fold(Aabb::EMPTY, |all, part| all.union(*part));
        parts.tree = Bvh::build(&boxes, &BuildSettings::default());
        parts.reach = parts.bounds.min.abs().max(parts.bounds.max.abs()).max_element().into();
        Ok(Curves(Arc::new(parts)))
    }

    /// How many segments and corners there are, cut into spans that turn little.
    #[cfg(test)]
    pub fn span_count(&self) -> usize {
        self.0.leaves.len()
    }

    /// Whether they can be lights; see [`Surface::patches`].
    pub fn has_patches(&self) -> bool {
        self.0.form == CurveForm::Tube && self.0.leaves.len() <= MOST_PATCHES
    }

    /// How many strands were left out.
    pub fn dropped(&self) -> usize {
        self.0.dropped
    }

    /// Bytes that are kept for so many control points, and while they are worked on; an estimate.
    pub fn memory(points: usize) -> (usize, usize) {
        /// A node, a leaf and its share of the tree.
        const KEPT: usize = size_of::<Node>() + size_of::<Leaf>() + 44;
        /// Points and radii, a box and what the tree is built of.
        const BUILDING: usize = 16 + size_of::<Aabb>() + 64;
        (KEPT * points, BUILDING * points)
    }
}

impl Parts {
    /// Adds the spans of the strand whose nodes begin here; whether there are any.
    fn add_leaves(&mut self, first: usize) -> bool {
        let (stride, last) = (self.basis.stride(), self.nodes.len() - 1);
        let before = self.leaves.len();
        let mut previous: Option<DVec3> = None;
        for node in (first..last).step_by(stride) {
            let whole = self.segment(node as u32);
            // Of a point alone there is nothing to see.
            if whole.hull().iter().all(|(p, _)| *p == whole.ends[0].p) {
                continue;
            }
            let [starts, ends] = whole.ends.map(|end| end.axis.normalize_or_zero());
            if previous.is_some_and(|previous| {
                starts.cross(previous).length_squared() > CORNER || starts.dot(previous) < 0.0
            }) {
                self.leaves.push(Leaf { node: node as u32, span: 0, level: 0, kind: LeafKind::Corner });
            }
            previous = Some(ends);
            let turn = whole.turn();
            let level = (0..MOST_LEVELS).find(|level| turn <= MOST_TURN * f64::from(1_u32 << level));
            let level = level.unwrap_or(MOST_LEVELS);
            for span in 0..1_u32 << level {
                let kind = LeafKind::Side { begins: false, ends: false };
                self.leaves.push(Leaf { node: node as u32, span: span as u8, level: level as u8, kind });
            }
        }
        let mark = |leaf: Option<&mut Leaf>, of: fn(&mut bool, &mut bool)| {
            if let Some(Leaf { kind: LeafKind::Side { begins, ends }, .. }) = leaf {
                of(begins, ends);
            }
        };
        mark(self.leaves[before..].first_mut(), |begins, _| *begins = true);
        mark(self.leaves[before..].last_mut(), |_, ends| *ends = true);
        self.leaves.len() > before
    }

    /// The cubic from a node to the next.
    fn segment(&self, node: u32) -> CurveSpan {
        let [a, b] = [&self.nodes[node as usize], &self.nodes[node as usize + 1]];
        if self.basis == CurveBasis::Linear {
            return CurveSpan::line(a.position(), b.position());
        }
        let ends = [a, b].map(|node| {
            let ((p, r), (m, mr)) = (node.position(), node.slope());
            End { p, m, r, mr, axis: m }
        });
        // Where a tangent is zero the curve goes towards the other control points.
        let mut ends = ends;
        let towards = |p: DVec3, others: [DVec3; 2]| {
            others.into_iter().map(|q| q - p).find(|way| *way != DVec3::ZERO).unwrap_or_default()
        };
        let third = 1.0 / 3.0;
        let [p, q] = [ends[0].p + third * ends[0].m, ends[1].p - third * ends[1].m];
        if ends[0].m == DVec3::ZERO {
            ends[0].axis = towards(ends[0].p, [q, ends[1].p]);
        }
        if ends[1].m == DVec3::ZERO {
            ends[1].axis = -towards(ends[1].p, [p, ends[0].p]);
        }
        CurveSpan::new(ends)
    }

    fn span(&self, leaf: &Leaf) -> CurveSpan {
        self.segment(leaf.node).part(leaf.span.into(), leaf.level.into())
    }

    fn leaf_bounds(&self, leaf: &Leaf) -> Aabb {
        let (p, r) = self.nodes[leaf.node as usize].position();
        match leaf.kind {
            LeafKind::Side { .. } => self.span(leaf).bounds(),
            LeafKind::Corner => Aabb { min: (p - r).as_vec3(), max: (p + r).as_vec3() }.padded(1e-6),
        }
    }

    /// The leaves in a box of the tree.
    fn in_box(&self, index: u32) -> std::ops::Range<u32> {
        self.group * index..(self.group * (index + 1)).min(self.leaves.len() as u32)
    }

    /// Visits where a line meets a leaf: the parameter, and what a hit says.
    fn intersect(&self, index: u32, line: &Ray64, mut visit: impl FnMut(f64, [f32; 2])) {
        let leaf = &self.leaves[index as usize];
        let LeafKind::Side { begins, ends } = leaf.kind else {
            return self.hit_corner(leaf, line, |t| visit(t, [0.0; 2]));
        };
        let span = self.span(leaf);
        if self.form == CurveForm::Ribbon {
            return span.hit_ribbon(line, &mut |SpanHit { t, s, across }| {
                visit(t, [leaf.in_segment(s), across as f32]);
            });
        }
        span.cross_tube(line, &mut |t| visit(t, [0.5, 0.0]));
        for (i, is_cap) in [begins, ends].into_iter().enumerate() {
            if is_cap && let Some(t) = span.cross_cap(line, i) {
                visit(t, [CAPS[i], 0.0]);
            }
        }
    }

    fn hit_corner(&self, leaf: &Leaf, line: &Ray64, mut visit: impl FnMut(f64)) {
        let (p, r) = self.nodes[leaf.node as usize].position();
        let dd = line.d.dot(line.d);
        let shift = (p - line.o).dot(line.d) / dd;
        let w = line.at(shift) - p;
        let rest = w.dot(w) - r * r;
        if self.form == CurveForm::Ribbon {
            if rest < 0.0 {
                visit(shift);
            }
        } else if let Some((a, b)) = roots::quadratic(dd, 0.0, rest)
            && rest < 0.0
        {
            visit(shift + a);
            visit(shift + b);
        }
    }

    /// The strand of a node: its first node, and how many segments it has.
    fn strand(&self, node: u32) -> (u32, u32) {
        let i = self.strands.partition_point(|&first| first <= node).saturating_sub(1);
        let end = self.strands.get(i + 1).map_or(self.nodes.len(), |&next| next as usize) as u32;
        let (first, stride) = (self.strands[i], self.basis.stride() as u32);
        (first, if stride == 2 { (end - first) / 2 } else { end - first - 1 })
    }

    /// A direction across the strand of a node, from which angles around it count.
    fn reference(&self, node: u32) -> DVec3 {
        let (first, count) = self.strand(node);
        let last = first + count * self.basis.stride() as u32 - u32::from(self.basis.stride() == 2);
        let [a, b] = [first, last].map(|node| self.nodes[node as usize].position().0);
        basis64((b - a).try_normalize().unwrap_or(DVec3::Y)).0
    }

    /// The place along a leaf that a point of it belongs to, and where in the leaf that is.
    fn point_at(&self, leaf: &Leaf, hit: &Hit, q: DVec3) -> (CurvePoint, f64, CurveSpan) {
        let span = self.span(leaf);
        let s = match self.form {
            _ if hit.u < 0.0 => 0.0,
            _ if hit.u > 1.0 => 1.0,
            CurveForm::Tube => span.along(q),
            CurveForm::Ribbon => leaf.in_span(hit.u.into()),
        };
        let mut point = span.at(s);
        if point.m == DVec3::ZERO {
            point.m = span.ends[usize::from(s > 0.5)].axis;
        }
        (point, s, span)
    }

    /// Unit vectors around a place of a tube: along it, from its middle to a point, and across both; with how fast the
    /// direction from which angles count turns around it.
    fn frame(&self, leaf: &Leaf, point: &CurvePoint, q: DVec3) -> Around {
        let along = point.m.normalize_or(DVec3::Y);
        let reference = self.reference(leaf.node);
        let flat = reference - reference.dot(along) * along;
        let zero = flat.try_normalize().unwrap_or_else(|| basis64(along).0);
        let w = q - point.p;
        let out = (w - w.dot(along) * along).normalize_or(zero);
        let bend = (point.k - point.k.dot(along) * along) / point.m.length();
        let twist = -reference.dot(along) * bend.dot(along.cross(zero)) / flat.length();
        let twist = if twist.is_finite() { twist } else { 0.0 };
        Around { along, out, across: along.cross(out), zero, bend, twist }
    }
}

/// See [`Parts::frame`].
struct Around {
    along: DVec3,
    out: DVec3,
    across: DVec3,
    zero: DVec3,
    /// How `along` changes along the span.
    bend: DVec3,
    twist: f64,
}

impl Around {
    /// How a point of the side changes along the span.
    fn slope(&self, point: &CurvePoint) -> DVec3 {
        let turned = self.twist * self.across - self.out.dot(self.bend) * self.along;
        point.m + point.mr * self.out + point.r * turned
    }

    /// Normal of the side.
    fn normal(&self, point: &CurvePoint) -> DVec3 {
        self.across.cross(self.slope(point)).normalize_or(self.out)
    }
}

impl Leaf {
    /// The place within the segment, from that within the leaf.
    fn in_segment(&self, s: f64) -> f32 {
        ((f64::from(self.span) + s) / f64::from(1_u32 << self.level)) as f32
    }

    /// And back.
    fn in_span(&self, u: f64) -> f64 {
        (u * f64::from(1_u32 << self.level) - f64::from(self.span)).clamp(0.0, 1.0)
    }
}

impl Surface for Curves {
    fn bounds(&self) -> Aabb {
        self.0.bounds
    }

    fn is_finite(&self) -> bool {
        self.0.bounds.is_finite()
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let line = Ray64::new(ray);
        let mut nearest: Option<Hit> = None;
        self.0.tree.closest(ray, |index, far| {
            let mut least = far;
            for part in self.0.in_box(index) {
                self.0.intersect(part, &line, |t, [u, v]| {
                    let Some(t) = in_range(ray, t) else { return };
                    // Of equally near ones the first in the file.
                    let is_first = || nearest.is_none_or(|hit| hit.t > t || hit.part > part);
                    if t < least || (t == least && is_first()) {
                        least = t;
                        nearest = Some(Hit { t, u, v, part });
                    }
                });
            }
            least
        });
        nearest
    }

    fn blocks(&self, ray: &Ray) -> bool {
        let line = Ray64::new(ray);
        self.0.tree.any(ray, |index| {
            let mut found = false;
            for part in self.0.in_box(index) {
                self.0.intersect(part, &line, |t, _| found |= in_range(ray, t).is_some());
            }
            found
        })
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        let line = Ray64::new(ray);
        self.0.tree.each(ray, |index| {
            for part in self.0.in_box(index) {
                self.0.intersect(part, &line, |t, [u, v]| {
                    if let Some(t) = in_range(ray, t) {
                        visit(Hit { t, u, v, part });
                    }
                });
            }
        });
    }

    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let (parts, line) = (&*self.0, Ray64::new(ray));
        let leaf = &parts.leaves[hit.part as usize];
        let q = line.at(hit.t.into());
        let facing = |along: DVec3| {
            let back = -line.d.normalize_or_zero();
            (back - back.dot(along) * along).normalize_or(back)
        };
        if leaf.kind == LeafKind::Corner {
            let (center, r) = parts.nodes[leaf.node as usize].position();
            let is_ball = parts.form == CurveForm::Tube;
            let n = if is_ball { (q - center).normalize_or(DVec3::Y) } else { facing(DVec3::ZERO) };
            let (p, p_error) = stored(if is_ball { center + r * n } else { q }, parts.reach);
            let p_error = if is_ball { p_error } else { p_error + r as f32 };
            return SurfacePoint::flat(p, p_error, n.as_vec3());
        }
        let (point, _, span) = parts.point_at(leaf, hit, q);
        if parts.form == CurveForm::Ribbon {
            let n = facing(point.m.normalize_or_zero());
            let off = q - point.p;
            let (p, p_error) = stored(point.p + off - off.dot(n) * n, parts.reach);
            // A ray that starts here is faced by the ribbon again, and must not hit the ribbon that it leaves.
            return SurfacePoint::flat(p, p_error + point.r as f32, n.as_vec3());
        }
        let cap = CAPS.iter().position(|cap| *cap == hit.u);
        let (p, n) = match cap {
            Some(i) => {
                let n = span.ends[i].axis.normalize_or(DVec3::Y);
                (q - (q - span.ends[i].p).dot(n) * n, if i == 0 { -n } else { n })
            }
            None => {
                let around = parts.frame(leaf, &point, q);
                (point.p + point.r * around.out, around.normal(&point))
            }
        };
        let (p, p_error) = stored(p, parts.reach);
        SurfacePoint::flat(p, p_error, n.as_vec3())
    }

    fn hit_at(&self, part: u32, p: Vec3) -> Hit {
        let parts = &*self.0;
        let leaf = &parts.leaves[part as usize];
        let mut hit = Hit { u: 0.5, part, ..Hit::default() };
        let LeafKind::Side { begins, ends } = leaf.kind else { return hit };
        let (span, q) = (parts.span(leaf), p.as_dvec3());
        for (i, is_cap) in [begins, ends].into_iter().enumerate() {
            let End { p, axis, r, .. } = span.ends[i];
            let w = q - p;
            let height = w.dot(axis.normalize_or_zero()).abs();
            if is_cap && height <= 1e-5 * r && w.length() < r * (1.0 - 1e-5) {
                hit.u = CAPS[i];
            }
        }
        hit
    }

    /// `u` runs along the strand, `v` around a tube, or across a ribbon.
    fn uv_at(&self, hit: &Hit, p: Vec3) -> Vec2 {
        let parts = &*self.0;
        let leaf = &parts.leaves[hit.part as usize];
        let (first, count) = parts.strand(leaf.node);
        let segment = f64::from((leaf.node - first) / parts.basis.stride() as u32);
        let along = |s: f64| ((segment + s) / f64::from(count)) as f32;
        if leaf.kind == LeafKind::Corner {
            return Vec2::new(along(0.0), 0.5);
        }
        let q = p.as_dvec3();
        let (point, s, _) = parts.point_at(leaf, hit, q);
        let u = along(leaf.in_segment(s).into());
        if parts.form == CurveForm::Ribbon {
            return Vec2::new(u, hit.v);
        }
        let around = parts.frame(leaf, &point, q);
        let y = around.out.dot(around.along.cross(around.zero));
        let turn = fmath::atan2_64(y, around.out.dot(around.zero)) / TAU;
        Vec2::new(u, (if turn < 0.0 { turn + 1.0 } else { turn }) as f32)
    }

    /// Along the strand, and around a tube. A ribbon has no direction across it but that seen by the viewer.
    fn tangents_at(&self, hit: &Hit, p: Vec3) -> Tangents {
        let parts = &*self.0;
        let leaf = &parts.leaves[hit.part as usize];
        if leaf.kind == LeafKind::Corner {
            return Tangents::default();
        }
        let q = p.as_dvec3();
        let (point, _, _) = parts.point_at(leaf, hit, q);
        let (_, count) = parts.strand(leaf.node);
        let scale = f64::from(count) * f64::from(1_u32 << leaf.level);
        if parts.form == CurveForm::Ribbon {
            return Tangents { dpdu: (scale * point.m).as_vec3(), dpdv: Vec3::ZERO };
        }
        let around = parts.frame(leaf, &point, q);
        if CAPS.contains(&hit.u) {
            let off = (q - point.p).dot(around.out);
            return Tangents { dpdu: Vec3::ZERO, dpdv: (TAU * off * around.across).as_vec3() };
        }
        let dpdu = scale * around.slope(&point);
        Tangents { dpdu: dpdu.as_vec3(), dpdv: (TAU * point.r * around.across).as_vec3() }
    }

    /// Tubes have caps, but where they bend more tightly than they are wide their surface crosses itself.
    fn is_closed(&self) -> bool {
        false
    }

    fn part_count(&self) -> u32 {
        self.0.leaves.len() as u32
    }

    fn without_patches(&self) -> Option<&'static str> {
        (!self.has_patches()).then_some("a ribbon, or a bundle of many tubes,")
    }

    /// A span of a tube is one. Ribbons, which look different from everywhere, and many spans are met by chance.
    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        let parts = &*self.0;
        if !self.has_patches() {
            return;
        }
        for (i, leaf) in parts.leaves.iter().enumerate() {
            let own = parts.leaf_bounds(leaf);
            let (center, radius) = (own.center().as_dvec3(), 0.5 * own.extent().as_dvec3().length());
            if let Some(patch) = TracedPatch::new(self.clone(), i as u32) {
                let patch = patch.within(center, radius);
                let patch = match leaf.kind {
                    LeafKind::Side { .. } => patch.covered_by(&[self.0.span(leaf).cover()]),
                    LeafKind::Corner => patch,
                };
                visit(i as u32, Patch::Traced(Box::new(patch)));
            }
        }
    }

    /// Ribbons are shown as tubes; of very many strands some are left out, and the others have fewer sides.
    fn tessellate(&self, around: u32, out: &mut Tessellation) {
        const MOST_SIDES: usize = 1 << 20;
        let parts = &*self.0;
        let n = parts.leaves.len();
        let sides = ((MOST_SIDES / n) as u32).clamp(3, around.clamp(3, 12));
        let skip = (n * sides as usize).div_ceil(MOST_SIDES);
        let mut strand = 0;
        for (i, leaf) in parts.leaves.iter().enumerate() {
            while parts.strands.get(strand + 1).is_some_and(|&first| first <= leaf.node) {
                strand += 1;
            }
            if strand % skip != 0 || leaf.kind == LeafKind::Corner {
                continue;
            }
            let span = parts.span(leaf);
            let rows = if leaf.level == 0 && parts.basis != CurveBasis::Linear { 2 } else { 1 };
            out.grid(i as u32, [sides, rows], |x, y| {
                let point = span.at(y);
                let probe = parts.frame(leaf, &point, point.p);
                let (sin, cos) = fmath::sincos64(TAU * x);
                let e = cos * probe.zero + sin * probe.along.cross(probe.zero);
                let there = parts.frame(leaf, &point, point.p + e);
                (point.p + point.r * e, there.normal(&point))
            });
        }
    }

    fn heap_bytes(&self) -> usize {
        let parts = &*self.0;
        size_of::<Parts>()
            + size_of_val(&*parts.nodes)
            + size_of_val(&*parts.strands)
            + size_of_val(&*parts.leaves)
            + parts.tree.stats().bytes
    }
}

#[cfg(test)]
mod tests;
