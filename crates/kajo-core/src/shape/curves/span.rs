//! A span of a curve that turns little, and where a ray meets it as a tube or as a ribbon.
//!
//! Both ends of a span are numbers that its neighbours share. Whether a ray crosses the surface on the plane between two spans is
//! worked out from these numbers alone, so that both give the same answer and no ray passes between them.

use kajo_math::solid_angle::basis64;
use kajo_math::{Aabb, DVec3, Vec3, roots};

use super::super::{CoverSegment, Ray64};

/// An end of a span.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    /// Where it is, and how that changes along the span, which is 1 long.
    pub p: DVec3,
    pub m: DVec3,
    /// The radius, and how it changes.
    pub r: f64,
    pub mr: f64,
    /// Normal of the disk that ends here, of any length: along `m`, and what it tends to where that is zero.
    pub axis: DVec3,
}

/// Where a ray meets a span.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpanHit {
    pub t: f64,
    /// Position along the span, in [0, 1].
    pub s: f64,
    /// Position across a ribbon, in [0, 1].
    pub across: f64,
}

/// A point of the curve with what is known of it there.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurvePoint {
    pub p: DVec3,
    pub m: DVec3,
    /// Second derivative.
    pub k: DVec3,
    pub r: f64,
    pub mr: f64,
}

/// A cubic in space with a cubic radius, `s` in [0, 1].
#[derive(Clone, Copy, Debug)]
pub(super) struct CurveSpan {
    pub ends: [End; 2],
    /// Coefficients of the powers of `s`.
    p: [DVec3; 4],
    r: [f64; 4],
}

/// A sample along a ray, in the disk of the tube that it lies in.
#[derive(Clone, Copy)]
struct Sample {
    /// Ray parameter.
    t: f64,
    /// Squared distance from the curve less the squared radius: negative inside of the tube.
    g: f64,
    /// `dg/dt`.
    slope: f64,
}

impl CurveSpan {
    pub fn new(ends: [End; 2]) -> CurveSpan {
        let [a, b] = &ends;
        let (dp, dr) = (b.p - a.p, b.r - a.r);
        let p = [a.p, a.m, 3.0 * dp - 2.0 * a.m - b.m, a.m + b.m - 2.0 * dp];
        let r = [a.r, a.mr, 3.0 * dr - 2.0 * a.mr - b.mr, a.mr + b.mr - 2.0 * dr];
        CurveSpan { ends, p, r }
    }

    /// The straight line between two places, with a radius that changes steadily.
    pub fn line(from: (DVec3, f64), to: (DVec3, f64)) -> CurveSpan {
        let (m, mr) = (to.0 - from.0, to.1 - from.1);
        let end = |(p, r)| End { p, m, r, mr, axis: m };
        let none = (DVec3::ZERO, 0.0);
        CurveSpan {
            ends: [end(from), end(to)],
            p: [from.0, m, none.0, none.0],
            r: [from.1, mr, none.1, none.1],
        }
    }

    #[inline]
    pub fn at(&self, s: f64) -> CurvePoint {
        let [p0, p1, p2, p3] = self.p;
        let [r0, r1, r2, r3] = self.r;
        CurvePoint {
            p: p0 + s * (p1 + s * (p2 + s * p3)),
            m: p1 + s * (2.0 * p2 + (3.0 * s) * p3),
            k: 2.0 * p2 + (6.0 * s) * p3,
            r: r0 + s * (r1 + s * (r2 + s * r3)),
            mr: r1 + s * (2.0 * r2 + 3.0 * s * r3),
        }
    }

    /// The span `k` of `2^level`. Ends of neighbours have the same bits.
    pub fn part(&self, k: u32, level: u32) -> CurveSpan {
        if level == 0 {
            return *self;
        }
        // A power of two, so that nothing is rounded by it.
        let width = 1.0 / f64::from(1_u32 << level);
        let end = |k: u32| {
            let whole = match k {
                0 => self.ends[0],
                _ if k == 1 << level => self.ends[1],
                _ => {
                    let CurvePoint { p, m, r, mr, .. } = self.at(width * f64::from(k));
                    End { p, m, r, mr, axis: m }
                }
            };
            End { m: width * whole.m, mr: width * whole.mr, ..whole }
        };
        CurveSpan::new([end(k), end(k + 1)])
    }

    /// The control points of the curve and its radii.
    pub fn hull(&self) -> [(DVec3, f64); 4] {
        let [a, b] = &self.ends;
        let third = 1.0 / 3.0;
        [
            (a.p, a.r),
            (a.p + third * a.m, a.r + third * a.mr),
            (b.p - third * b.m, b.r - third * b.mr),
            (b.p, b.r),
        ]
    }

    /// How far its direction turns at most, in radians: along the control points.
    pub fn turn(&self) -> f64 {
        let [a, b, c, d] = self.hull().map(|(p, _)| p);
        let mut sides = [b - a, c - b, d - c].into_iter().filter_map(DVec3::try_normalize);
        let Some(mut before) = sides.next() else { return 0.0 };
        sides.fold(0.0, |sum, side| {
            let angle = kajo_math::fmath::acos64(before.dot(side).clamp(-1.0, 1.0));
            before = side;
            sum + angle
        })
    }

    pub fn largest_radius(&self) -> f64 {
        self.hull().iter().fold(0.0, |most, (_, r)| f64::max(most, *r))
    }

    /// The chord, and how far the tube reaches from it.
    pub fn cover(&self) -> CoverSegment {
        let [a, b] = &self.ends;
        CoverSegment::around([a.p, b.p], self.hull().into_iter().map(|(p, r)| (p, r.max(0.0))))
    }

    pub fn bounds(&self) -> Aabb {
        let r = self.largest_radius();
        let hull = self.hull();
        let low = hull.iter().fold(DVec3::INFINITY, |low, (p, _)| low.min(*p)) - r;
        let high = hull.iter().fold(DVec3::NEG_INFINITY, |high, (p, _)| high.max(*p)) + r;
        let outwards = |v: DVec3| v.as_vec3();
        Aabb {
            min: outwards(low).to_array().map(f32::next_down).into(),
            max: Vec3::from(outwards(high).to_array().map(f32::next_up)),
        }
    }

    /// The place of the disk that a point near the curve lies in: where `(p - c(s)) . c'(s) = 0`.
    pub fn along(&self, p: DVec3) -> f64 {
        const MOST_STEPS: u32 = 64;
        let chord = self.ends[1].p - self.ends[0].p;
        let start = (p - self.ends[0].p).dot(chord) / chord.dot(chord);
        let mut s = if start.is_nan() { 0.5 } else { start.clamp(0.0, 1.0) };
        let (mut lo, mut hi) = (0.0, 1.0);
        for _ in 0..MOST_STEPS {
            let at = self.at(s);
            let w = p - at.p;
            let ahead = w.dot(at.m);
            if ahead > 0.0 {
                lo = s
            } else {
                hi = s
            }
            let newton = s + ahead / (at.m.dot(at.m) - w.dot(at.k));
            let next = if newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
            if (next - s).abs() <= 2.0 * f64::EPSILON {
                break;
            }
            s = next;
        }
        s
    }

    fn sample(&self, line: &Ray64, t: f64) -> Sample {
        let q = line.at(t);
        self.sample_in(&self.at(self.along(q)), q, line.d, t)
    }

    /// What a sample says that lies in the disk at a place.
    fn sample_in(&self, at: &CurvePoint, q: DVec3, d: DVec3, t: f64) -> Sample {
        let w = q - at.p;
        let turns = d.dot(at.m) / (at.m.dot(at.m) - w.dot(at.k));
        let turns = if turns.is_finite() { turns } else { 0.0 };
        Sample { t, g: w.dot(w) - at.r * at.r, slope: 2.0 * (w.dot(d) - at.r * at.mr * turns) }
    }

    /// The sample at an end, of which the sign is known to neighbours as well.
    fn sample_at_end(&self, i: usize, line: &Ray64, t: f64) -> Sample {
        let End { p, m, r, mr, .. } = self.ends[i];
        let k = if i == 0 { 2.0 * self.p[2] } else { 2.0 * self.p[2] + 6.0 * self.p[3] };
        self.sample_in(&CurvePoint { p, m, k, r, mr }, line.at(t), line.d, t)
    }

    /// Where a line comes between the planes of the two ends and where it leaves, each with the end that is met there.
    fn between_ends(&self, line: &Ray64) -> Option<[(f64, Option<usize>); 2]> {
        let (mut from, mut to) = ((f64::NEG_INFINITY, None), (f64::INFINITY, None));
        for (i, end) in self.ends.iter().enumerate() {
            // Inside is ahead of the first and behind the last.
            let (off, rise) = ((end.p - line.o).dot(end.axis), line.d.dot(end.axis));
            let t = off / rise;
            if rise == 0.0 {
                if (off <= 0.0) != (i == 0) {
                    return None;
                }
            } else if (rise > 0.0) == (i == 0) {
                if t > from.0 {
                    from = (t, Some(i));
                }
            } else if t < to.0 {
                to = (t, Some(i));
            }
        }
        (from.0 < to.0).then_some([from, to])
    }

    /// Where a line is in a cylinder around the chord that holds the tube.
    fn around_chord(&self, line: &Ray64) -> Option<[f64; 2]> {
        let [a, b, c, d] = self.hull().map(|(p, _)| p);
        let u = (d - a).normalize_or_zero();
        let off = |p: DVec3| (p - a).cross(u).length();
        let radius = (self.largest_radius() + off(b).max(off(c))) * (1.0 + 1e-9);
        let dd = line.d.dot(line.d);
        let shift = (a - line.o).dot(line.d) / dd;
        let w = line.at(shift) - a;
        let (wu, du) = (w.cross(u), line.d.cross(u));
        let (across, h) = (du.dot(du), wu.dot(du));
        let rest = wu.dot(wu) - radius * radius;
        if across <= 1e-24 * dd {
            return (rest < 0.0).then_some([f64::NEG_INFINITY, f64::INFINITY]);
        }
        let root = (h * h - across * rest).sqrt();
        (root > 0.0).then(|| [shift + (-h - root) / across, shift + (-h + root) / across])
    }

    /// Visits the places where a line crosses the side of the tube, in ascending order.
    pub fn cross_tube(&self, line: &Ray64, visit: &mut impl FnMut(f64)) {
        let Some([from, to]) = self.between_ends(line) else { return };
        let Some([near, far]) = self.around_chord(line) else { return };
        let sample = |(t, end): (f64, Option<usize>), border: f64, is_beyond: bool| match end {
            Some(i) if !is_beyond => self.sample_at_end(i, line, t),
            _ => self.sample(line, border),
        };
        let lo = sample(from, near, from.0 < near);
        let hi = sample(to, far, to.0 > far);
        if lo.t >= hi.t || !(lo.g.is_finite() && hi.g.is_finite()) {
            return;
        }
        if self.p[2] == DVec3::ZERO && self.p[3] == DVec3::ZERO {
            return self.isolate(line, lo, hi, visit);
        }
        let middle = self.sample(line, 0.5 * (lo.t + hi.t));
        self.isolate(line, lo, middle, visit);
        self.isolate(line, middle, hi, visit);
    }

    /// Visits the sign changes between two samples. Along a span that turns little the function has one extremum at most, or is as good
    /// as flat.
    fn isolate(&self, line: &Ray64, mut a: Sample, mut b: Sample, visit: &mut impl FnMut(f64)) {
        const MOST_STEPS: u32 = 64;
        if (a.g < 0.0) != (b.g < 0.0) {
            return visit(self.single_root(line, a, b));
        }
        let side = if a.g < 0.0 { -1.0 } else { 1.0 };
        for _ in 0..MOST_STEPS {
            // Towards the other sign from both ends.
            if !(side * a.slope < 0.0 && side * b.slope > 0.0) {
                return;
            }
            let t = a.t + (b.t - a.t) * (a.slope / (a.slope - b.slope));
            let t = if t > a.t && t < b.t { t } else { 0.5 * (a.t + b.t) };
            let between = self.sample(line, t);
            if (between.g < 0.0) != (a.g < 0.0) {
                visit(self.single_root(line, a, between));
                return visit(self.single_root(line, between, b));
            }
            let width = b.t - a.t;
            if 0.5 * between.g.abs() > between.slope.abs() * width || width <= 1e-14 * (a.t.abs() + b.t.abs())
            {
                return;
            }
            if side * between.slope < 0.0 { a = between } else { b = between }
        }
    }

    fn single_root(&self, line: &Ray64, a: Sample, b: Sample) -> f64 {
        let chord = a.t + (b.t - a.t) * (a.g / (a.g - b.g));
        let start = if chord > a.t && chord < b.t { chord } else { 0.5 * (a.t + b.t) };
        roots::bracketed([a.t, b.t], start, a.g < 0.0, 2.0 * f64::EPSILON, |t| {
            let at = self.sample(line, t);
            (at.g, at.slope)
        })
    }

    /// Where a line crosses the disk at an end.
    pub fn cross_cap(&self, line: &Ray64, i: usize) -> Option<f64> {
        let End { p, r, axis, .. } = self.ends[i];
        let t = (p - line.o).dot(axis) / line.d.dot(axis);
        let w = line.at(t) - p;
        (w.dot(w) - r * r < 0.0).then_some(t)
    }

    /// Visits the places where a line meets the ribbon that faces it.
    ///
    /// Seen along the line, the ribbon is what is nearer than the radius to the curve. The nearest places are those where
    /// `C . C' = 0` for the curve `C` in the plane across the line, as seen from it: a quintic.
    pub fn hit_ribbon(&self, line: &Ray64, visit: &mut impl FnMut(SpanHit)) {
        let length = line.d.length();
        let (x, y) = basis64(line.d / length);
        let flat = |v: DVec3| [v.dot(x), v.dot(y)];
        let [a, b] = &self.ends;
        let [p0, p3] = [flat(a.p - line.o), flat(b.p - line.o)];
        let [m0, m1] = [flat(a.m), flat(b.m)];
        let third = 1.0 / 3.0;
        let p1 = [0, 1].map(|i| p0[i] + third * m0[i]);
        let p2 = [0, 1].map(|i| p3[i] - third * m1[i]);
        let widest = self.largest_radius();
        let misses = |i: usize| {
            let all = [p0[i], p1[i], p2[i], p3[i]];
            all.iter().all(|v| *v > widest) || all.iter().all(|v| *v < -widest)
        };
        if misses(0) || misses(1) {
            return;
        }
        let inner = [0, 1].map(|i| 3.0 * (p2[i] - p1[i]));
        let dot = |p: [f64; 2], m: [f64; 2]| p[0] * m[0] + p[1] * m[1];
        // The product of a cubic and a quadratic in Bernstein form; the ends are those of the factors.
        let quintic = [
            dot(p0, m0),
            (3.0 * dot(p1, m0) + 2.0 * dot(p0, inner)) / 5.0,
            (3.0 * dot(p2, m0) + 6.0 * dot(p1, inner) + dot(p0, m1)) / 10.0,
            (dot(p3, m0) + 6.0 * dot(p2, inner) + 3.0 * dot(p1, m1)) / 10.0,
            (2.0 * dot(p3, inner) + 3.0 * dot(p2, m1)) / 5.0,
            dot(p3, m1),
        ];
        roots::sign_changes(&quintic, |s| {
            let at = self.at(s);
            let w = at.p - line.o;
            let t = w.dot(line.d) / (length * length);
            let off = line.at(t) - at.p;
            if off.dot(off) < at.r * at.r {
                let across = at.m.cross(line.d).normalize_or_zero();
                visit(SpanHit { t, s, across: 0.5 + 0.5 * off.dot(across) / at.r });
            }
        });
    }
}
