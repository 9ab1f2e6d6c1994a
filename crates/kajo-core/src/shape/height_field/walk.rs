//! The way of a ray through the blocks and cells of a height field.

use kajo_math::{DVec2, DVec3, Ray, roots};

use super::{Cell, FLOOR, Parts, SURFACE};
use crate::shape::Ray64;

/// Room above the highest point and, of a surface without a floor, below the lowest one, in sides of a cell: where a ray enters
/// from above it is above the surface, whatever rounding says.
const MARGIN: f64 = 1e-3;

/// Levels of large blocks in which a ray does not begin: there it would hardly pass over or under one.
const SKIPPED: u32 = 3;

/// Where a ray is in the box of a height field, and through which face it comes and goes; `None` where it begins or ends within.
struct Span {
    lo: f64,
    hi: f64,
    enters: Option<Face>,
    leaves: Option<Face>,
}

/// A face of the box.
#[derive(Clone, Copy, PartialEq)]
enum Face {
    /// That of a solid, by its part.
    Side(u32),
    Top,
}

/// A ray from where it enters the box, in cells from the corner with the least x and z; y is in units of length.
struct CellWalk<'a, V> {
    parts: &'a Parts,
    o: DVec3,
    d: DVec3,
    /// Those across x and across z.
    lines: [Lines; 2],
    /// Ray parameter at `o`.
    from: f64,
    /// Whether the surface is above the ray.
    is_below: bool,
    /// Called with parameter and part of each crossing; whether that is enough.
    visit: V,
}

/// The lines of the grid across an axis, as a ray meets them.
#[derive(Clone, Copy)]
struct Lines {
    /// Where the ray begins.
    o: f64,
    /// One over its direction; of a ray along them larger than whatever it is multiplied by.
    inverse: f64,
    /// Whether it goes backwards.
    is_back: bool,
    /// How many cells there are.
    count: u32,
}

impl Lines {
    /// * `o`, `inverse`: the ray's origin and one over its direction, in cells
    fn new(o: f64, inverse: f64, count: u32) -> Lines {
        /// A ray along the lines is on all of them before it begins, or after it ends.
        const NEVER: f64 = 1e300;
        let inverse = if inverse.is_finite() { inverse } else { NEVER };
        Lines { o, inverse, is_back: inverse < 0.0, count }
    }

    /// The block of `2^level` cells in which the ray begins.
    fn block(&self, level: u32) -> u32 {
        (self.o.max(0.0) as u32).min(self.count - 1) >> level
    }

    /// Where the ray is on a line.
    #[inline(always)]
    fn crossing(&self, line: u32) -> f64 {
        (f64::from(line) - self.o) * self.inverse
    }

    /// Where the ray leaves a block, whose position among those of `2^level` cells is given; infinite at the border of the grid.
    #[inline(always)]
    fn exit(&self, level: u32, at: u32) -> f64 {
        let line = (at + u32::from(!self.is_back)) << level;
        if line.wrapping_sub(1) < self.count - 1 { self.crossing(line) } else { f64::INFINITY }
    }

    /// The half of a block that the ray is in from a parameter on, and where it leaves that.
    ///
    /// * `level`: of the half
    /// * `exit`: where it leaves the block
    #[inline(always)]
    fn half(&self, level: u32, at: u32, from: f64, exit: f64) -> (u32, f64) {
        let line = (2 * at + 1) << level;
        let middle = self.crossing(line);
        let (is_there, is_past) = (line < self.count, middle <= from);
        let half = 2 * at + u32::from(is_there & (is_past != self.is_back));
        (half, if is_there & !is_past { middle } else { exit })
    }

    /// The next block.
    #[inline(always)]
    fn next(&self, at: u32) -> u32 {
        if self.is_back { at - 1 } else { at + 1 }
    }
}

impl Parts {
    /// Visits all crossings of a ray from its least parameter on, in their order, until `visit` has enough.
    pub(super) fn walk(&self, ray: &Ray, mut visit: impl FnMut(f64, u32) -> bool) {
        let line = Ray64::new(ray);
        let inverse = line.d.recip();
        let Some(span) = self.span(ray, &line, inverse) else { return };
        let (start, cell) = (line.at(span.lo), self.cell_size);
        let o = DVec3::new((start.x - self.corner.x) / cell.x, start.y, (start.z - self.corner.y) / cell.y);
        let d = DVec3::new(line.d.x / cell.x, line.d.y, line.d.z / cell.y);
        let is_solid = self.base.is_some();
        let is_below = span.enters != Some(Face::Top) && start.y < self.height(start.x, start.z);
        if let Some(Face::Side(part)) = span.enters
            && is_solid
            && is_below
            && visit(span.lo, part)
        {
            return;
        }
        let [columns, rows] = self.grid.cells();
        let lines = [Lines::new(o.x, inverse.x * cell.x, columns), Lines::new(o.z, inverse.z * cell.y, rows)];
        let mut way = CellWalk { parts: self, o, d, lines, from: span.lo, is_below, visit };
        if way.blocks(span.hi - span.lo) || !way.is_below {
            return;
        }
        match span.leaves {
            Some(Face::Side(part)) if is_solid => (way.visit)(span.hi, part),
            Some(Face::Top) => (way.visit)(span.hi, SURFACE),
            _ => false,
        };
    }

    /// Where a ray is in the box; `None` where it passes by, and for one that is not finite.
    ///
    /// * `inverse`: one over its direction
    fn span(&self, ray: &Ray, line: &Ray64, inverse: DVec3) -> Option<Span> {
        let end = self.corner + self.size;
        let [low, high] = self.y_range;
        if !(line.o.is_finite() && line.d.is_finite()) || line.d == DVec3::ZERO {
            return None;
        }
        let mut span = Span { lo: ray.t_min.into(), hi: ray.t_max.into(), enters: None, leaves: None };
        let mut clip = |o: f64, inverse: f64, [min, max]: [f64; 2], [first, last]: [Face; 2]| {
            if inverse.is_infinite() {
                return (min..=max).contains(&o);
            }
            let (a, b) = ((min - o) * inverse, (max - o) * inverse);
            let (near, far) = if inverse > 0.0 { ((a, first), (b, last)) } else { ((b, last), (a, first)) };
            if near.0 > span.lo {
                (span.lo, span.enters) = (near.0, Some(near.1));
            }
            if far.0 < span.hi {
                (span.hi, span.leaves) = (far.0, Some(far.1));
            }
            true
        };
        let is_there = clip(line.o.x, inverse.x, [self.corner.x, end.x], [Face::Side(1), Face::Side(2)])
            && clip(line.o.y, inverse.y, [low, high], [Face::Side(FLOOR), Face::Top])
            && clip(line.o.z, inverse.z, [self.corner.y, end.y], [Face::Side(3), Face::Side(4)]);
        (is_there && span.lo < span.hi).then_some(span)
    }

    /// The range of heights that a ray is followed in.
    pub(super) fn y_range([low, high]: [f64; 2], base: Option<f64>, cell_size: DVec2) -> [f64; 2] {
        let margin = MARGIN * cell_size.min_element();
        [base.unwrap_or(low - margin), high + margin]
    }
}

impl<V: FnMut(f64, u32) -> bool> CellWalk<'_, V> {
    /// Goes through the grid from block to block until a parameter; whether that is enough.
    ///
    /// Where the surface may pass a block at the height of the ray, the ray goes on in a quarter of it. From there, and from blocks that it
    /// passes over or under, it comes to the block beside it, or where that is the first of two, to the block over both of them
    /// [Tevs, Ihrke and Seidel 2008].
    fn blocks(&mut self, end: f64) -> bool {
        let [across, along] = self.lines;
        let mut level = self.parts.bounds.top().saturating_sub(SKIPPED).max(1);
        let (mut x, mut z) = (across.block(level), along.block(level));
        let (mut x_exit, mut z_exit) = (across.exit(level, x), along.exit(level, z));
        let (mut t0, mut y0) = (0.0, self.o.y);
        loop {
            let t1 = least(least(x_exit, z_exit), end);
            if t0 < t1 {
                let y1 = self.o.y + t1 * self.d.y;
                if level == 0 {
                    if self.cell([x, z], [t0, t1]) {
                        return true;
                    }
                } else {
                    let [lowest, highest] = self.parts.bounds.block(level, [x, z]).map(f64::from);
                    if let Some(is_below) = side(y0, y1, [lowest, highest]) {
                        if self.turns(is_below, t0) {
                            return true;
                        }
                    } else {
                        level -= 1;
                        (x, x_exit) = across.half(level, x, t0, x_exit);
                        (z, z_exit) = along.half(level, z, t0, z_exit);
                        continue;
                    }
                }
                (t0, y0) = (t1, y1);
            }
            if t1 >= end {
                return false;
            }
            // The first of two blocks begins where the one over both of them does.
            let is_first = if x_exit <= z_exit {
                x = across.next(x);
                x & 1 == u32::from(across.is_back)
            } else {
                z = along.next(z);
                z & 1 == u32::from(along.is_back)
            };
            if is_first {
                (level, x, z) = (level + 1, x >> 1, z >> 1);
                (x_exit, z_exit) = (across.exit(level, x), along.exit(level, z));
            } else if x_exit <= z_exit {
                x_exit = across.exit(level, x);
            } else {
                z_exit = along.exit(level, z);
            }
        }
    }

    /// Visits what crosses the surface of a cell between two parameters.
    fn cell(&mut self, at: [u32; 2], [t0, t1]: [f64; 2]) -> bool {
        let (p0, p1) = (self.o + t0 * self.d, self.o + t1 * self.d);
        let corners = self.parts.grid.corners(at);
        let least = corners[0].min(corners[1]).min(corners[2].min(corners[3]));
        let greatest = corners[0].max(corners[1]).max(corners[2].max(corners[3]));
        if let Some(is_below) = side(p0.y, p1.y, [least, greatest].map(f64::from)) {
            return self.turns(is_below, t0);
        }
        let place =
            |p: DVec3| [(p.x - f64::from(at[0])).clamp(0.0, 1.0), (p.z - f64::from(at[1])).clamp(0.0, 1.0)];
        let (cell, q0, q1) = (Cell::new(corners), place(p0), place(p1));
        // Bernstein coefficients of the gap between the ray and the surface.
        let gap = [
            p0.y - cell.at(q0[0], q0[1]),
            0.5 * (p0.y + p1.y) - cell.between(q0, q1),
            p1.y - cell.at(q1[0], q1[1]),
        ];
        let (starts, ends) = (gap[0] < 0.0, gap[2] < 0.0);
        if self.turns(starts, t0) {
            return true;
        }
        let at = |s: f64| t0 + s * (t1 - t0);
        let (a, h, c) = (gap[0] - 2.0 * gap[1] + gap[2], gap[1] - gap[0], gap[0]);
        if starts != ends {
            return self.turns(ends, at(single_root(a, h, c)));
        }
        if (gap[1] < 0.0) == starts {
            return false;
        }
        match roots::quadratic(a, h, c) {
            Some((first, last)) if first < last => {
                self.turns(!starts, at(first.clamp(0.0, 1.0))) || self.turns(ends, at(last.clamp(0.0, 1.0)))
            }
            _ => false,
        }
    }

    /// Notes on which side of the surface the ray is from a parameter on, and visits the crossing if that is news.
    fn turns(&mut self, is_below: bool, t: f64) -> bool {
        let is_news = std::mem::replace(&mut self.is_below, is_below) != is_below;
        is_news && (self.visit)(self.from + t, SURFACE)
    }
}

/// Whether a piece of a ray between two heights is below all of some heights, or above all of them.
#[inline(always)]
fn side(y0: f64, y1: f64, [lowest, highest]: [f64; 2]) -> Option<bool> {
    let (low, high) = if y0 < y1 { (y0, y1) } else { (y1, y0) };
    if low >= highest {
        return Some(false);
    }
    (high < lowest).then_some(true)
}

/// The lesser of two numbers.
#[inline(always)]
fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The root in [0, 1] of `a s^2 + 2 h s + c`, which has different signs at 0 and 1.
#[inline]
fn single_root(a: f64, h: f64, c: f64) -> f64 {
    let Some((first, last)) = roots::quadratic(a, h, c) else {
        // All but zero everywhere.
        return 0.5;
    };
    let off = |s: f64| (s - s.clamp(0.0, 1.0)).abs();
    // Of a product of one very large root and one that is not, the first may be infinite.
    let root = if off(first) <= off(last) { first } else { last };
    if root.is_nan() { 0.5 } else { root.clamp(0.0, 1.0) }
}
