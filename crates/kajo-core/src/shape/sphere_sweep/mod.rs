//! Sphere sweeps: all balls whose middles and radii a path goes through.
//!
//! Of a ray each curve of the path has some pieces inside, as many as its degree at most; see `chord.rs`. Their union is what the ray
//! has inside of the sweep, so there is one outside surface whatever crosses itself, crossings come in pairs, and balls at joints
//! close every gap. Straight pieces are cones with round ends.
//!
//! Scene: `SphereSweep { path { line 0 0 0 0.3  1 0 0 0.2  1 1 0 0.1 } }`

use std::cell::Cell;
use std::f64::consts::TAU;
use std::sync::Arc;

use kajo_bvh::{BuildSettings, Bvh};
use kajo_math::solid_angle::basis64;
use kajo_math::{Aabb, DVec3, DVec4, Ray, Vec2, Vec3, fmath};

use super::{
    Bezier, CoverSegment, Patch, Path, Ray64, Surface, Tessellation, TracedPatch, in_range, nearest_crossing,
    stored,
};
use crate::interaction::{Hit, NO_UV, SurfacePoint, Tangents};

mod chord;

/// Curves fewer than this are looked at one by one.
const CURVES_FOR_A_TREE: usize = 6;

/// Pieces are one if they are nearer than this to each other, in parts of the size.
const SAME: f64 = 64.0 * f64::EPSILON;

/// Balls along paths. A clone is the same sweep.
#[derive(Clone, Debug)]
pub struct SphereSweep(Arc<Parts>);

#[derive(Debug)]
struct Parts {
    /// The middle and the radius along each.
    curves: Vec<Bezier<DVec4>>,
    boxes: Vec<Aabb>,
    tree: Option<Bvh>,
    bounds: Aabb,
    /// The largest coordinate or radius.
    reach: f64,
}

/// An end of a piece of a ray: its parameter, and the ball there.
#[derive(Clone, Copy, Debug)]
struct End {
    t: f64,
    curve: u32,
    s: f64,
}

thread_local! {
    /// Memory that rays use again and again.
    static SCRATCH: Cell<Vec<[End; 2]>> = const { Cell::new(Vec::new()) };
}

impl SphereSweep {
    /// * `paths`: x, y and z are the middle of a ball, w its radius, which is taken as its absolute value
    ///
    /// `None` where no ball has a radius, or there are more curves than can be told apart.
    pub fn new(paths: &[Path<DVec4>]) -> Option<SphereSweep> {
        let curves: Vec<Bezier<DVec4>> =
            paths.iter().flat_map(|path| path.curves().iter().copied()).collect();
        let has_ball = curves.iter().flat_map(Bezier::points).any(|p| p.w != 0.0);
        if !has_ball || curves.len() >= 1 << 24 {
            return None;
        }
        let boxes: Vec<Aabb> = curves.iter().map(bounds_of).collect();
        let tree = (boxes.len() >= CURVES_FOR_A_TREE).then(|| Bvh::build(&boxes, &BuildSettings::default()));
        let bounds = boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        let reach = curves.iter().flat_map(Bezier::points).fold(0.0f64, |m, p| m.max(p.abs().max_element()));
        Some(SphereSweep(Arc::new(Parts { curves, boxes, tree, bounds, reach })))
    }
}

/// A box around the balls of a curve: that of the balls at the control points of pieces of it.
fn bounds_of(curve: &Bezier<DVec4>) -> Aabb {
    const LEVELS: u32 = 3;
    let pieces = curve.subdivided(if curve.points().len() > 2 { LEVELS } else { 0 });
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for p in pieces.iter().flat_map(Bezier::points) {
        let (middle, radius) = (p.truncate(), p.w.abs());
        (min, max) = (min.min(middle - radius), max.max(middle + radius));
    }
    Aabb { min: min.as_vec3(), max: max.as_vec3() }.padded(1e-6)
}

/// The segment from the first point of curves to the last one, around their balls.
fn segment_along(curves: &[Bezier<DVec4>]) -> CoverSegment {
    let ends = [curves.first().map(Bezier::start), curves.last().map(Bezier::end)];
    let balls = curves.iter().flat_map(Bezier::points).map(|p| (p.truncate(), p.w.abs()));
    CoverSegment::around(ends.map(|end| end.unwrap_or_default().truncate()), balls)
}

impl Parts {
    /// Segments along which the surface lies: curves halved until they are nearly straight, or many.
    fn cover(&self) -> Vec<CoverSegment> {
        const MOST: usize = 64;
        const WIDE: f64 = 1.25;
        if self.curves.len() > MOST {
            let group = self.curves.len().div_ceil(MOST);
            return self.curves.chunks(group).map(segment_along).collect();
        }
        // How many times as wide as the balls.
        let width = |curve: &Bezier<DVec4>| {
            let widest = curve.points().iter().map(|p| p.w.abs()).fold(0.0, f64::max);
            segment_along(&[*curve]).radius / widest.max(f64::MIN_POSITIVE)
        };
        let measured = |curve: Bezier<DVec4>| (curve, width(&curve));
        let mut pieces: Vec<_> = self.curves.iter().copied().map(measured).collect();
        while pieces.len() < MOST {
            let widest = (0..pieces.len()).max_by(|&i, &k| pieces[i].1.total_cmp(&pieces[k].1));
            let Some(i) = widest.filter(|&i| pieces[i].1 > WIDE) else { break };
            let (curve, _) = pieces.swap_remove(i);
            pieces.extend(curve.split(0.5).map(measured));
        }
        pieces.iter().map(|(curve, _)| segment_along(&[*curve])).collect()
    }

    /// Visits the pieces of a ray's line that are inside, in ascending order; none if it passes the box within its range.
    fn intervals(&self, ray: &Ray, mut visit: impl FnMut([End; 2])) {
        let Some((near, _)) = self.bounds.clip(ray) else { return };
        let from = if near.is_finite() { f64::from(near) } else { 0.0 };
        let line = Ray64::new(ray);
        let (o, length) = (line.at(from), line.d.length());
        let d = line.d / length;
        if !(d.is_finite() && o.is_finite()) {
            return;
        }
        let mut pieces = SCRATCH.take();
        pieces.clear();
        let mut curve = |i: u32| {
            let curve = &self.curves[i as usize];
            // From the place nearest to its beginning, so that far-away origins cost no digits.
            let shift = (curve.start().truncate() - o).dot(d);
            chord::chords(curve, o + shift * d, d, |chord| {
                let end = |k: usize| End { t: shift + chord.t[k], curve: i, s: chord.s[k] };
                pieces.push([end(0), end(1)]);
            });
        };
        // The whole line counts: what is inside before the ray's range says where the ray comes out.
        let whole = Ray { t_min: f32::NEG_INFINITY, t_max: f32::INFINITY, ..*ray };
        match &self.tree {
            Some(tree) => tree.each(&whole, curve),
            None => {
                (0u32..)
                    .zip(&self.boxes)
                    .filter(|(_, b)| b.clip(&whole).is_some())
                    .for_each(|(i, _)| curve(i));
            }
        }
        pieces.sort_unstable_by(|a, b| a[0].t.total_cmp(&b[0].t).then(a[0].curve.cmp(&b[0].curve)));
        let nearer = SAME * self.reach;
        let mut emit = |[enter, leave]: [End; 2]| {
            if leave.t - enter.t > nearer {
                visit([enter, leave].map(|end| End { t: from + end.t / length, ..end }));
            }
        };
        let mut last: Option<[End; 2]> = None;
        for &[enter, leave] in &pieces {
            last = Some(match last {
                Some([first, end]) if enter.t - end.t <= nearer => {
                    [first, if leave.t > end.t { leave } else { end }]
                }
                Some(piece) => {
                    emit(piece);
                    [enter, leave]
                }
                None => [enter, leave],
            });
        }
        last.into_iter().for_each(emit);
        SCRATCH.set(pieces);
    }

    /// The ball of a hit that touches the surface at a point, by Newton's method from the ball that was found: the one for which
    /// `|p - c|² - r²` is least.
    fn ball(&self, hit: &Hit, p: DVec3) -> DVec4 {
        let curve = &self.curves[(hit.v as usize).min(self.curves.len() - 1)];
        curve.at(nearest_ball(curve, p, hit.u.into()))
    }
}

/// The parameter of the ball that is nearest to a point, by Newton's method from `s`.
fn nearest_ball(curve: &Bezier<DVec4>, p: DVec3, mut s: f64) -> f64 {
    const STEPS: u32 = 3;
    const BESIDE: f64 = 1e-4;
    for _ in 0..STEPS {
        let slope = |s: f64| {
            let (at, by) = (curve.at(s), curve.derivative(s));
            (at.truncate() - p).dot(by.truncate()) - at.w * by.w
        };
        let bend = (slope(s + BESIDE) - slope(s - BESIDE)) / (2.0 * BESIDE);
        let next = s - slope(s) / bend;
        // Only towards a least value.
        s = if bend > 0.0 && next.is_finite() { next.clamp(0.0, 1.0) } else { s };
    }
    s
}

impl End {
    fn hit(&self) -> Hit {
        Hit { t: 0.0, u: self.s as f32, v: self.curve as f32, part: 0 }
    }
}

impl Surface for SphereSweep {
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
        self.0.intervals(ray, |ends| {
            for end in ends {
                if let Some(t) = in_range(ray, end.t) {
                    visit(Hit { t, ..end.hit() });
                }
            }
        });
    }

    /// The point is brought onto the ball that touches the surface there.
    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let p = Ray64::new(ray).at(hit.t.into());
        let ball = self.0.ball(hit, p);
        let (middle, radius) = (ball.truncate(), ball.w.abs());
        let n = (p - middle).normalize_or(DVec3::Y);
        let (p, p_error) = stored(middle + radius * n, self.0.reach);
        SurfacePoint::flat(p, p_error, n.as_vec3())
    }

    fn hit_at(&self, _part: u32, p: Vec3) -> Hit {
        const STEPS: u32 = 16;
        let p = p.as_dvec3();
        let off = |ball: DVec4| ball.truncate().distance(p) - ball.w.abs();
        let nearest = |(i, curve): (u32, &Bezier<DVec4>)| {
            let starts = (0..=STEPS).map(|k| f64::from(k) / f64::from(STEPS));
            let start = starts.min_by(|&a, &b| off(curve.at(a)).total_cmp(&off(curve.at(b))));
            let s = nearest_ball(curve, p, start.unwrap_or_default());
            (End { t: 0.0, curve: i, s }, off(curve.at(s)))
        };
        let places = (0u32..).zip(&self.0.curves).map(nearest);
        places.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(end, _)| end.hit()).unwrap_or_default()
    }

    fn uv_at(&self, _hit: &Hit, _p: Vec3) -> Vec2 {
        NO_UV
    }

    fn tangents_at(&self, _hit: &Hit, _p: Vec3) -> Tangents {
        Tangents::default()
    }

    fn is_closed(&self) -> bool {
        true
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        let patch = TracedPatch::new(self.clone(), 0).map(|patch| patch.covered_by(&self.0.cover()));
        patch.into_iter().for_each(|patch| visit(0, Patch::Traced(Box::new(patch))));
    }

    /// Circles along which neighbouring balls meet, and the balls at the ends of curves; also where others hide them.
    fn tessellate(&self, around: u32, out: &mut Tessellation) {
        const STEPS: u32 = 24;
        let around = around.max(3);
        let ball = |at: DVec4, out: &mut Tessellation| {
            out.patch(0, &Patch::Sphere { center: at.truncate(), radius: at.w.abs() }, around);
        };
        let mut last: Option<DVec4> = None;
        for curve in &self.0.curves {
            if last != Some(curve.start()) {
                ball(curve.start(), out);
            }
            let rows = if curve.points().len() > 2 { STEPS } else { 1 };
            out.grid(0, [around, rows], |u, s| {
                let (at, by) = (curve.at(s), curve.derivative(s));
                let (middle, way) = (at.truncate(), by.truncate());
                let (x, y) = basis64(way.try_normalize().unwrap_or(DVec3::Z));
                let (sin, cos) = fmath::sincos64(TAU * u);
                // Normals lean back where radii grow.
                let lean = (-by.w / way.length().max(f64::MIN_POSITIVE)).clamp(-1.0, 1.0);
                let across = (1.0 - lean * lean).sqrt();
                let n = lean * way.normalize_or_zero() + across * (cos * x + sin * y);
                (middle + at.w.abs() * n, n)
            });
            ball(curve.end(), out);
            last = Some(curve.end());
        }
    }

    fn heap_bytes(&self) -> usize {
        let parts = &*self.0;
        let tree = parts.tree.as_ref().map_or(0, |tree| tree.stats().bytes);
        size_of::<Parts>() + size_of_val(&*parts.curves) + size_of_val(&*parts.boxes) + tree
    }
}

#[cfg(test)]
mod tests;
