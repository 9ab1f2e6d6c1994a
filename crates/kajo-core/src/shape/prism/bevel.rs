//! Bevelled edges of prisms.
//!
//! Where an end of the prism is nearer than the width `b` of the bevel, what is inside keeps away from the walls: with the
//! distance `δ` to the outline and `h` to the end,
//!
//! ```text
//! g = (δ + h - b) / √2            of a chamfer,
//! g = b - |(b - δ)⁺, (b - h)⁺|    of a round edge,
//! ```
//!
//! a point is inside where `g ≥ 0`. Distances change no faster than the point moves, and so does `g`: a ray goes on by `|g|` and
//! passes nothing by [Hart 1996], and where `g` has changed its sign the crossing is found by its slope. Strokes
//! that are narrower than both bevels end in a ridge, along what has two nearest points of the outline.

use kajo_math::{DVec2, DVec3};

use super::Parts;
use crate::shape::Bezier;
use crate::shape::outline::{BoxTree, box_of, direction};

/// What edges of both ends look like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bevel {
    /// How far it reaches along the ends and along the walls; more than 0, and no more than half the depth.
    pub width: f64,
    /// What it looks like from the side.
    pub profile: BevelProfile,
}

/// What a bevel looks like from the side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BevelProfile {
    /// Flat, at 45 degrees.
    #[default]
    Chamfer,
    /// A quarter of a circle.
    Round,
}

/// Crossings nearer to each other than this part of the width are none, or one.
const FINEST: f64 = 1e-3;

impl Bevel {
    /// How far a point is inside, at most; negative outside.
    ///
    /// * `wall`, `end`: its distances to the outline and to the nearer end
    #[inline]
    fn depth(&self, wall: f64, end: f64) -> f64 {
        let [u, w] = self.missing(wall, end);
        match self.profile {
            BevelProfile::Chamfer => std::f64::consts::FRAC_1_SQRT_2 * (self.width - u - w),
            BevelProfile::Round => self.width - u.hypot(w),
        }
    }

    /// By how much each distance is less than the width.
    #[inline]
    fn missing(&self, wall: f64, end: f64) -> [f64; 2] {
        [wall, end].map(|distance| (self.width - distance).max(0.0))
    }

    /// The outward normal: parts towards the wall and towards the end.
    fn normal(&self, wall: f64, end: f64) -> DVec2 {
        match self.profile {
            BevelProfile::Chamfer => DVec2::splat(std::f64::consts::FRAC_1_SQRT_2),
            BevelProfile::Round => DVec2::from(self.missing(wall, end)).normalize_or(DVec2::Y),
        }
    }
}

/// Bevelled edges: what they look like, and the border of what the outline fills, for distances to it.
#[derive(Clone, Debug)]
pub(super) struct BevelledEdge {
    bevel: Bevel,
    /// Curves that hardly turn.
    curves: Vec<Bezier<DVec2>>,
    tree: BoxTree,
}

impl BevelledEdge {
    /// What of curves is border.
    ///
    /// * `fills`: whether a point is inside
    /// * `size`: of the outline
    pub fn new(
        bevel: Bevel,
        curves: &[Bezier<DVec2>],
        size: f64,
        fills: impl Fn(DVec2) -> bool,
    ) -> BevelledEdge {
        const LEVELS: u32 = 3;
        let mut kept = Vec::with_capacity(curves.len());
        for curve in curves {
            let levels = if curve.points().len() > 2 { LEVELS } else { 0 };
            curve
                .subdivided(levels)
                .into_iter()
                .for_each(|piece| keep_border(piece, size, &fills, 0, &mut kept));
        }
        let tree = BoxTree::new(&kept.iter().map(box_of).collect::<Vec<_>>());
        BevelledEdge { bevel, curves: kept, tree }
    }

    /// The distance to the border and the point of it that is nearest; none farther away than `most`.
    pub fn nearest(&self, p: DVec2, most: f64) -> Option<(f64, DVec2)> {
        let mut found = None;
        let mut least = most * most;
        self.tree.each_near(p, least, |i| {
            let at = nearest_of(&self.curves[i as usize], p);
            let distance = at.distance_squared(p);
            if distance < least {
                (least, found) = (distance, Some(at));
            }
            least
        });
        found.map(|at| (least.sqrt(), at))
    }

    pub fn bytes(&self) -> usize {
        size_of_val(&*self.curves) + self.tree.bytes()
    }
}

/// Keeps those parts of a curve that have the inside on one side only.
fn keep_border(
    curve: Bezier<DVec2>,
    size: f64,
    fills: &impl Fn(DVec2) -> bool,
    level: u32,
    kept: &mut Vec<Bezier<DVec2>>,
) {
    /// Curves are halved so often at most, to find where they come out of what others fill.
    const MOST_LEVELS: u32 = 16;
    let is_border = |s: f64| {
        let beside = direction(&curve, s).normalize_or_zero().perp() * (1e-6 * size);
        let at = curve.at(s);
        fills(at + beside) != fills(at - beside)
    };
    // A little off the ends, where other curves begin.
    let found = [0.01, 0.3, 0.5, 0.7, 0.99].map(is_border);
    if found.iter().all(|&border| border == found[0]) || level == MOST_LEVELS {
        kept.extend(found[2].then_some(curve));
        return;
    }
    curve.split(0.5).into_iter().for_each(|half| keep_border(half, size, fills, level + 1, kept));
}

/// The point of a curve that is nearest to another point, by Newton's method from where that is beside the chord.
fn nearest_of(curve: &Bezier<DVec2>, p: DVec2) -> DVec2 {
    const STEPS: u32 = 4;
    let (a, b) = (curve.start(), curve.end());
    let chord = b - a;
    let along = ((p - a).dot(chord) / chord.length_squared()).clamp(0.0, 1.0);
    if curve.points().len() == 2 {
        return if along.is_nan() { a } else { a + along * chord };
    }
    let mut s = if along.is_nan() { 0.5 } else { along };
    for _ in 0..STEPS {
        let (off, tangent) = (curve.at(s) - p, curve.derivative(s));
        let bend = off.dot(curve.second_derivative(s));
        let slope = tangent.length_squared() + bend.max(-0.5 * tangent.length_squared());
        let step = off.dot(tangent) / slope;
        s = if step.is_finite() { (s - step).clamp(0.0, 1.0) } else { s };
    }
    let ends = [a, b, curve.at(s)];
    ends.into_iter().min_by(|x, y| x.distance_squared(p).total_cmp(&y.distance_squared(p))).unwrap_or(a)
}

/// A point of a bevelled edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct BevelPoint {
    /// How far it is inside.
    pub depth: f64,
    /// Outward in the outline's plane, and along the axis.
    pub normal: DVec3,
    /// How fast the surface goes inward along the axis where the wall comes nearer.
    pub slope: f64,
}

impl Parts {
    /// How far a point of the prism's own space is inside of its bevelled edges, were there no others; see [`Bevel::depth`].
    fn bevel_depth(&self, edge: &BevelledEdge, p: DVec3) -> f64 {
        let bevel = &edge.bevel;
        let end = p.z.min(self.sweep.depth - p.z).max(0.0);
        let wall = edge.nearest(p.truncate(), bevel.width).map_or(bevel.width, |(distance, _)| distance);
        bevel.depth(wall, end)
    }

    /// The surface of the bevel at a point on it, but for rounding.
    pub(super) fn bevel_point(&self, edge: &BevelledEdge, p: DVec3) -> BevelPoint {
        let bevel = &edge.bevel;
        let q = p.truncate();
        let is_near = p.z < 0.5 * self.sweep.depth;
        let end = if is_near { p.z } else { self.sweep.depth - p.z };
        let (wall, at) = edge.nearest(q, 2.0 * bevel.width).unwrap_or((bevel.width, q));
        let out = (at - q).normalize_or_zero();
        let n = bevel.normal(wall, end);
        let normal = (out * n.x).extend(if is_near { -n.y } else { n.y });
        BevelPoint { depth: bevel.depth(wall, end), normal, slope: n.x / n.y.max(1e-3) }
    }

    /// Visits where a ray passes a bevelled edge between `from` and `to`, where it is within the outline and both ends.
    ///
    /// * `visit`: the parameter, and whether the ray comes inside there
    /// * returns: whether what is before `to` is inside
    pub(super) fn bevel_crossings(
        &self,
        edge: &BevelledEdge,
        line: &super::Ray64,
        [from, to]: [f64; 2],
        mut visit: impl FnMut(f64, bool),
    ) -> bool {
        let bevel = &edge.bevel;
        let depth = |t: f64| self.bevel_depth(edge, line.at(t));
        let speed = line.d.length();
        // Between both bevels nothing is to be found.
        let heights = [bevel.width, self.sweep.depth - bevel.width].map(|z| (z - line.o.z) / line.d.z);
        let [calm, rough] = if line.d.z == 0.0 {
            let is_calm = line.o.z.min(self.sweep.depth - line.o.z) >= bevel.width;
            if is_calm { [from, to] } else { [f64::INFINITY, f64::NEG_INFINITY] }
        } else {
            [heights[0].min(heights[1]), heights[0].max(heights[1])]
        };
        let finest = (FINEST * bevel.width / speed).max((to - from) / 4096.0);
        let mut t = from;
        let mut g = if calm <= t && t < rough { 0.0 } else { depth(t) };
        let mut inside = g >= 0.0;
        while t < to {
            if calm <= t && t < rough {
                // All of it is inside.
                if !inside {
                    visit(t, true);
                    inside = true;
                }
                t = rough.min(to);
                g = 0.0;
                continue;
            }
            let limit = if t < calm { calm.min(to) } else { to };
            let next = (t + (g.abs() / speed).max(finest)).min(limit);
            let g_next = depth(next);
            if (g_next >= 0.0) != inside {
                let at = crossing(depth, [t, next], [g, g_next]);
                inside = !inside;
                visit(at, inside);
            }
            (t, g) = (next, g_next);
        }
        inside
    }
}

/// Where a function has changed its sign, by the method of Illinois.
fn crossing(f: impl Fn(f64) -> f64, [mut a, mut b]: [f64; 2], [mut fa, mut fb]: [f64; 2]) -> f64 {
    const MOST_STEPS: u32 = 40;
    const ENOUGH: f64 = 1e-15;
    let mut last = 0;
    for _ in 0..MOST_STEPS {
        let t = if fa == fb { 0.5 * (a + b) } else { (a * fb - b * fa) / (fb - fa) };
        let t = if t > a && t < b { t } else { 0.5 * (a + b) };
        if !(t > a && t < b) {
            break;
        }
        let ft = f(t);
        if ft == 0.0 || (b - a) <= ENOUGH * (a.abs() + b.abs()) {
            return t;
        }
        if (ft >= 0.0) == (fb >= 0.0) {
            (b, fb) = (t, ft);
            fa *= if last == 1 { 0.5 } else { 1.0 };
            last = 1;
        } else {
            (a, fa) = (t, ft);
            fb *= if last == -1 { 0.5 } else { 1.0 };
            last = -1;
        }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests;
