//! A line as a profile sees it that turns about the z axis.
//!
//! With the line's place nearest to the axis as its origin, or the place where it comes into view, its distance `ρ` from the axis and its
//! height are
//!
//! ```text
//! ρ² = a t² + 2 b t + c,    z = z0 + m t.
//! ```
//!
//! In the half plane of profiles it is a branch of a hyperbola, which has the axis on one side of it. On which side a point
//! `(r, z)` lies is said by
//!
//! ```text
//! G = w (a w + 2 b m) + m² (c - r²),    w = z - z0,
//! ```
//!
//! positive towards the axis. Where the line is in view all terms but the last are positive, so that nothing cancels, and beyond
//! that the axis' side is known. Along a Bézier curve of degree `n` this is a polynomial of degree `2 n`, and its value at a point that
//! curves share is the same for all of them, so crossings of closed profiles come in pairs.

use kajo_math::{DVec2, DVec3, roots};

use super::Bezier;
use crate::shape::outline::PlaneLine;

/// A cylinder about the axis around everything.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rim {
    pub radius: f64,
    pub low: f64,
    pub high: f64,
}

/// What a line does.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    a: f64,
    b: f64,
    c: f64,
    z0: f64,
    /// How it rises: `m`; 0 for what is too little to be told from a level line.
    rise: f64,
    /// The parameter of the place that is its origin here, on the line as it was given.
    pub shift: f64,
    /// Parameters between which it is in view, from there.
    span: [f64; 2],
    /// Heights between which it is in view, from `z0`.
    heights: [f64; 2],
    rounding: f64,
}

/// A place of a curve that a line meets.
#[derive(Clone, Copy, Debug)]
pub(super) struct CourseCrossing {
    /// On the line as it was given.
    pub t: f64,
    /// On the curve.
    pub s: f64,
    /// Whether the curve comes from the right, seen along the line in the half plane.
    pub from_right: bool,
}

impl Course {
    /// * `o`, `d`: the line; `d` of unit length
    ///
    /// `None` for a line that passes by.
    pub fn new(o: DVec3, d: DVec3, rim: &Rim) -> Option<Course> {
        /// Lines that rise less than this are level: over the whole they rise by some last places.
        const LEVEL: f64 = 1e-12;
        /// Beyond the rounding of all that is asked here, in parts of the size.
        const MARGIN: f64 = 1e-9;
        let size = rim.radius.max(rim.high - rim.low);
        let (low, high, radius) =
            (rim.low - MARGIN * size, rim.high + MARGIN * size, rim.radius + MARGIN * size);
        let rise = if d.z.abs() <= LEVEL { 0.0 } else { d.z };
        let (across, way) = (o.truncate(), d.truncate());
        let (a, b, c) = (way.length_squared(), across.dot(way), across.length_squared());
        let (mut lo, mut hi) = roots::quadratic(a, b, c - radius * radius).unwrap_or_else(|| {
            let along = a == 0.0 && c < radius * radius;
            if along { (f64::NEG_INFINITY, f64::INFINITY) } else { (1.0, 0.0) }
        });
        if rise == 0.0 {
            if !(o.z >= low && o.z <= high) {
                return None;
            }
        } else {
            let [p, q] = [(low - o.z) / rise, (high - o.z) / rise];
            (lo, hi) = (lo.max(p.min(q)), hi.min(p.max(q)));
        }
        // Also for numbers that are none.
        if !(lo < hi && lo.is_finite() && hi.is_finite()) {
            return None;
        }
        let nearest = if a > 0.0 { -b / a } else { lo };
        let shift = nearest.clamp(lo, hi);
        let p = o + shift * d;
        let (b, c) = if shift == nearest && a > 0.0 {
            let off = across.perp_dot(way);
            (0.0, off * off / a)
        } else {
            (p.truncate().dot(way), p.truncate().length_squared())
        };
        let span = [lo - shift, hi - shift];
        let [p0, p1] = span.map(|t| rise * t);
        let heights = [p0.min(p1), p0.max(p1)];
        Some(Course { a, b, c, z0: p.z, rise, shift, span, heights, rounding: 1e-12 * size })
    }

    /// On which side of the line a point of the half plane is: negative away from the axis.
    fn side(&self, p: DVec2) -> f64 {
        let w = p.y - self.z0;
        // What is nothing is not less for rounding.
        let squared = (w * (self.a * w + 2.0 * self.b * self.rise) + self.rise * self.rise * self.c).max(0.0);
        let side = squared - (self.rise * p.x) * (self.rise * p.x);
        let in_view = w >= self.heights[0] && w <= self.heights[1];
        if in_view { side } else { side.abs() }
    }

    /// Whether the line may meet anything in a box, or find it on another side than a neighbour.
    #[inline]
    pub fn overlaps(&self, [min, max]: [DVec2; 2]) -> bool {
        let (below, above) = (min.y - self.z0 - self.rounding, max.y - self.z0 + self.rounding);
        // Not for boxes of nothing.
        if below > above {
            return false;
        }
        if self.rise == 0.0 {
            return below <= 0.0 && above >= 0.0 && self.c <= (max.x + self.rounding).powi(2);
        }
        let [p, q] = [below / self.rise, above / self.rise];
        let (lo, hi) = (p.min(q).max(self.span[0]), p.max(q).min(self.span[1]));
        if lo > hi {
            return false;
        }
        let squared = |t: f64| t * (self.a * t + 2.0 * self.b) + self.c;
        let farthest = squared(lo).max(squared(hi));
        let nearest = squared(0.0f64.clamp(lo, hi));
        let inner = (min.x - self.rounding).max(0.0);
        nearest <= (max.x + self.rounding).powi(2) && farthest >= inner * inner
    }

    /// Visits the places at which the line meets a curve.
    pub fn crossings(&self, curve: &Bezier<DVec2>, mut visit: impl FnMut(CourseCrossing)) {
        if self.rise == 0.0 {
            return self.level_crossings(curve, visit);
        }
        // Going up, what is away from the axis is on the right.
        let mut from_right = (self.side(curve.start()) < 0.0) == (self.rise > 0.0);
        let mut add = |s: f64| {
            visit(CourseCrossing { t: self.shift + self.parameter(curve.at(s)), s, from_right });
            from_right = !from_right;
        };
        self.segment(curve, [0.0, 1.0], &mut add);
    }

    /// Of a level line, which comes in from far away and goes out again at the same height.
    fn level_crossings(&self, curve: &Bezier<DVec2>, mut visit: impl FnMut(CourseCrossing)) {
        let height = PlaneLine { n: DVec2::Y, c: -self.z0, rounding: 0.0 };
        height.crossings(curve, |s, rises| {
            let squared = curve.at(s).x.powi(2) - self.c;
            if squared > 0.0 {
                let away = (squared / self.a).sqrt();
                visit(CourseCrossing { t: self.shift - away, s, from_right: !rises });
                visit(CourseCrossing { t: self.shift + away, s, from_right: rises });
            }
        });
    }

    /// Visits the places at which a piece of a curve changes its side, in ascending order.
    fn segment(&self, curve: &Bezier<DVec2>, [from, width]: [f64; 2], visit: &mut impl FnMut(f64)) {
        /// Below this width all that is left of a curve is rounding.
        const NARROWEST: f64 = 1.0 / (1u64 << 50) as f64;
        /// How much higher than what is in view a piece may be, so that its polynomial does not lose what is.
        const MUCH: f64 = 16.0;
        let ends = [curve.start(), curve.end()].map(|p| self.side(p));
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for p in curve.points() {
            (least, most) = (least.min(p.y - self.z0), most.max(p.y - self.z0));
        }
        if most < self.heights[0] || least > self.heights[1] {
            return;
        }
        let most_told = MUCH * self.heights[0].abs().max(self.heights[1].abs());
        if least.abs().max(most.abs()) > most_told {
            if width > NARROWEST {
                let [left, right] = curve.split(0.5);
                self.segment(&left, [from, 0.5 * width], visit);
                self.segment(&right, [from + 0.5 * width, 0.5 * width], visit);
            } else if (ends[0] < 0.0) != (ends[1] < 0.0) {
                visit(from + 0.5 * width);
            }
            return;
        }
        let mut add = |s: f64| visit(from + width * s);
        match *curve.points() {
            [a, b] => roots::sign_changes(
                &self.polynomial::<2, 3>([a, b], [[1.0, 0.5], [0.5, 1.0]], ends),
                &mut add,
            ),
            [a, b, c] => {
                let weights = [[1.0, 0.5, 1.0 / 6.0], [0.5, 4.0 / 6.0, 0.5], [1.0 / 6.0, 0.5, 1.0]];
                roots::sign_changes(&self.polynomial::<3, 5>([a, b, c], weights, ends), &mut add);
            }
            [a, b, c, d] => {
                let weights = [
                    [1.0, 0.5, 0.2, 0.05],
                    [0.5, 0.6, 0.45, 0.2],
                    [0.2, 0.45, 0.6, 0.5],
                    [0.05, 0.2, 0.5, 1.0],
                ];
                roots::sign_changes(&self.polynomial::<4, 7>([a, b, c, d], weights, ends), &mut add);
            }
            _ => {}
        }
    }

    /// The Bernstein coefficients of the side along a curve.
    ///
    /// * `weights`: `C(n, i) C(n, j) / C(2 n, i + j)`, what the product of two coefficients counts [Farouki 2012, eq. 44]
    /// * `ends`: its values at the ends
    fn polynomial<const N: usize, const M: usize>(
        &self,
        points: [DVec2; N],
        weights: [[f64; N]; N],
        ends: [f64; 2],
    ) -> [f64; M] {
        let w = points.map(|p| p.y - self.z0);
        let u = w.map(|w| self.a * w + 2.0 * self.b * self.rise);
        let r = points.map(|p| self.rise * p.x);
        let mut sum = [self.rise * self.rise * self.c; M];
        for i in 0..N {
            for j in 0..N {
                sum[i + j] += weights[i][j] * (w[i] * u[j] - r[i] * r[j]);
            }
        }
        (sum[0], sum[M - 1]) = (ends[0], ends[1]);
        sum
    }

    /// The parameter at which the line is at a point of the half plane that is on it: by its height where it rises faster than it comes
    /// nearer to the axis or goes away from it, otherwise by its distance from the axis.
    fn parameter(&self, p: DVec2) -> f64 {
        let by_height = (p.y - self.z0) / self.rise;
        if (self.a * by_height + self.b).abs() <= self.rise.abs() * p.x.abs() {
            return by_height;
        }
        let outward = if self.b == 0.0 { by_height >= 0.0 } else { self.b > 0.0 };
        match roots::quadratic(self.a, self.b, self.c - p.x * p.x) {
            Some((inner, outer)) => {
                if outward {
                    outer
                } else {
                    inner
                }
            }
            None => -self.b / self.a,
        }
    }
}
