//! Superellipsoids: boxes with round edges, balls, cylinders, double cones, octahedra, and what is between them.
//!
//! With exponents `e` around the axis and `n` from pole to pole, the y axis through the poles and the origin in the middle,
//!
//! ```text
//! (|x|^(2/e) + |z|^(2/e))^(e/n) + |y|^(2/n) = 1                                  [Barr 1981]
//! ```
//!
//! in radii. For exponents up to 2 it is the unit ball of a norm: of `h = (|x|^(2/e) + |z|^(2/e))^(e/2)`, a norm in the plane,
//! and `|y|`,
//!
//! ```text
//! N(p) = (h^(2/n) + |y|^(2/n))^(n/2) = 1.
//! ```
//!
//! A norm is convex along a ray, so that two tangents bound it from below between the places where they touch it. A ray whose
//! least bound is not below one misses; one that has a point inside crosses twice, once on either side of that point, and
//! Newton's method finds both within their brackets. No exponent makes the numbers large: norms grow no faster than the ray.
//!
//! Scene: `Superellipsoid { center 0 0 0  radius 1  east 0.3  north 0.3 }`

use std::f64::consts::{PI, TAU};

use kajo_math::{Aabb, DVec3, Ray, Vec2, Vec3, fmath};

use super::{Patch, Ray64, Surface, Tessellation, TracedPatch, in_range, stored};
use crate::interaction::{Hit, SurfacePoint, Tangents};

/// A superellipsoid with exponents up to 2.
#[derive(Clone, Copy, Debug)]
pub struct Superellipsoid {
    center: DVec3,
    radius: f64,
    /// One over half of each exponent: the powers of the two norms.
    east: f64,
    north: f64,
}

impl Superellipsoid {
    /// The largest exponent: beyond it the shape has hollows.
    pub const LARGEST_EXPONENT: f64 = 2.0;

    /// The least exponent: to the eye a box.
    pub const LEAST_EXPONENT: f64 = 0.01;

    /// * `radius`: half of each side of the box around it, above zero
    /// * `east`, `north`: exponents around the y axis and from pole to pole, from 0.01 to 2
    ///
    /// `None` for others.
    pub fn new(center: Vec3, radius: f32, east: f32, north: f32) -> Option<Superellipsoid> {
        // What is written as 0.01 is a little less in single precision.
        let power = |exponent: f32| {
            let exponent = f64::from(exponent);
            let is_usable = exponent > 0.999 * Self::LEAST_EXPONENT && exponent <= Self::LARGEST_EXPONENT;
            is_usable.then(|| 2.0 / exponent)
        };
        let shape = Superellipsoid {
            center: center.as_dvec3(),
            radius: radius.into(),
            east: power(east)?,
            north: power(north)?,
        };
        (radius > 0.0).then_some(shape)
    }

    /// The norm of a point from the middle, in radii, and its gradient.
    fn norm(&self, p: DVec3) -> (f64, DVec3) {
        let (across, by_x, by_z) = norm2(p.x.abs(), p.z.abs(), self.east);
        let (norm, by_across, by_y) = norm2(across, p.y.abs(), self.north);
        (norm, DVec3::new(by_across * by_x, by_y, by_across * by_z) * p.signum())
    }

    /// The norm less one and its derivative along a line.
    fn gap(&self, o: DVec3, d: DVec3, t: f64) -> (f64, f64) {
        let (norm, gradient) = self.norm(o + t * d);
        (norm - 1.0, gradient.dot(d))
    }

    /// What of a line is within the shape; `None` where it passes by.
    fn chord(&self, line: &Ray64) -> Option<Chord<'_>> {
        let d = line.d / self.radius;
        // From the place nearest to the middle, so that far-away origins cost no digits.
        let shift = (self.center - line.o).dot(line.d) / line.d.length_squared();
        let o = (line.at(shift) - self.center) / self.radius;
        let (mut lo, mut hi) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            if d[axis] == 0.0 {
                if o[axis].abs() >= 1.0 {
                    return None;
                }
                continue;
            }
            let (a, b) = ((-1.0 - o[axis]) / d[axis], (1.0 - o[axis]) / d[axis]);
            (lo, hi) = (lo.max(a.min(b)), hi.min(a.max(b)));
        }
        // Also for numbers that are none.
        if !(lo < hi && lo.is_finite() && hi.is_finite()) {
            return None;
        }
        let inside = self.point_inside(o, d, [lo, hi])?;
        Some(Chord { shape: self, o, d, shift, outside: [lo, hi], inside })
    }

    /// A parameter at which a line is inside, if there is one between two where it is not: where tangents meet, until they are
    /// nowhere below zero.
    fn point_inside(&self, o: DVec3, d: DVec3, [mut lo, mut hi]: [f64; 2]) -> Option<f64> {
        const MOST_STEPS: u32 = 200;
        let (mut at_lo, mut at_hi) = (self.gap(o, d, lo), self.gap(o, d, hi));
        for step in 0..MOST_STEPS {
            if at_lo.1 >= 0.0 || at_hi.1 <= 0.0 {
                return None;
            }
            let tangents_meet = (at_hi.0 - at_lo.0 + at_lo.1 * lo - at_hi.1 * hi) / (at_lo.1 - at_hi.1);
            if at_lo.0 + at_lo.1 * (tangents_meet - lo) >= 0.0 {
                return None;
            }
            // Every third place is the middle, which halves the interval for certain.
            let t = if step % 3 == 2 { 0.5 * (lo + hi) } else { tangents_meet };
            if !(t > lo && t < hi) {
                return None;
            }
            let at = self.gap(o, d, t);
            if at.0 < 0.0 {
                return Some(t);
            }
            if at.1 < 0.0 {
                (lo, at_lo) = (t, at);
            } else {
                (hi, at_hi) = (t, at);
            }
        }
        None
    }

    /// The point of the surface in a direction from the middle, from there and in radii.
    fn towards(&self, direction: DVec3) -> DVec3 {
        direction / self.norm(direction).0
    }
}

/// A line that is partly within a shape.
struct Chord<'a> {
    shape: &'a Superellipsoid,
    /// The line in radii from the middle, beginning at the place nearest to it.
    o: DVec3,
    d: DVec3,
    /// The parameter there.
    shift: f64,
    /// Parameters from there of a place before and one behind the shape, and of one within.
    outside: [f64; 2],
    inside: f64,
}

impl Chord<'_> {
    /// Where the line enters, or for `k` of 1 leaves: Newton's method within its bracket.
    fn end(&self, k: usize) -> f64 {
        const MOST_STEPS: u32 = 100;
        let (mut outside, mut inside) = (self.outside[k], self.inside);
        let mut t = outside;
        for _ in 0..MOST_STEPS {
            let (gap, slope) = self.shape.gap(self.o, self.d, t);
            if gap < 0.0 {
                inside = t;
            } else {
                outside = t;
            }
            let newton = t - gap / slope;
            if (newton - t).abs() <= f64::EPSILON * (outside - inside).abs().max(t.abs()) {
                break;
            }
            let (low, high) = (outside.min(inside), outside.max(inside));
            t = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        }
        self.shift + t
    }
}

/// `(a^power + b^power)^(1/power)` of numbers that are not negative, for a power of 1 or more, and its derivatives.
fn norm2(a: f64, b: f64, power: f64) -> (f64, f64, f64) {
    let (small, large) = (a.min(b), a.max(b));
    if large == 0.0 {
        return (0.0, 0.0, 0.0);
    }
    // Of the parts of the larger one, so that no power overflows.
    let ratio = small / large;
    let of_ratio = fmath::pow64(ratio, power);
    let sum = 1.0 + of_ratio;
    let root = fmath::pow64(sum, 1.0 / power);
    // (large / norm)^(power - 1), and the same of the smaller one.
    let by_large = root / sum;
    let by_small = if ratio > 0.0 { by_large * of_ratio / ratio } else { f64::from(power == 1.0) };
    if a < b { (large * root, by_small, by_large) } else { (large * root, by_large, by_small) }
}

impl Surface for Superellipsoid {
    fn bounds(&self) -> Aabb {
        let (min, max) = (self.center - self.radius, self.center + self.radius);
        Aabb { min: min.as_vec3(), max: max.as_vec3() }.padded(f32::EPSILON)
    }

    fn is_finite(&self) -> bool {
        self.center.is_finite() && self.radius.is_finite()
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let chord = self.chord(&Ray64::new(ray))?;
        let t = (0..2).find_map(|k| in_range(ray, chord.end(k)))?;
        Some(Hit { t, ..Hit::default() })
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        let Some(chord) = self.chord(&Ray64::new(ray)) else { return };
        for k in 0..2 {
            in_range(ray, chord.end(k)).into_iter().for_each(|t| visit(Hit { t, ..Hit::default() }));
        }
    }

    /// The point is brought onto the surface towards the middle.
    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let w = self.towards(Ray64::new(ray).at(hit.t.into()) - self.center);
        let n = self.norm(w).1.normalize_or(DVec3::Y);
        let scale = self.center.abs().max_element() + self.radius;
        let (p, p_error) = stored(self.center + self.radius * w, scale);
        SurfacePoint::flat(p, p_error, n.as_vec3())
    }

    /// Longitude and latitude of the direction from the middle: `u` runs once around the y axis, `v` from pole to pole.
    fn uv_at(&self, _hit: &Hit, p: Vec3) -> Vec2 {
        let w = p.as_dvec3() - self.center;
        let turn = fmath::atan2_64(-w.z, w.x) / TAU;
        let v = 0.5 + fmath::atan2_64(w.y, w.x.hypot(w.z)) / PI;
        Vec2::new((if turn < 0.0 { turn + 1.0 } else { turn }) as f32, v as f32)
    }

    fn tangents_at(&self, _hit: &Hit, p: Vec3) -> Tangents {
        let w = (p.as_dvec3() - self.center) / self.radius;
        let across = w.x.hypot(w.z);
        // How the direction changes, and the point with it, which stays on the surface.
        let (norm, gradient) = self.norm(w);
        let on_surface = |dw: DVec3| (self.radius * (dw - w * (gradient.dot(dw) / norm))).as_vec3();
        let around = TAU * DVec3::new(w.z, 0.0, -w.x);
        let up = PI * DVec3::new(-w.x * w.y, across * across, -w.z * w.y) / across;
        if across == 0.0 {
            return Tangents::default();
        }
        Tangents { dpdu: on_surface(around), dpdv: on_surface(up) }
    }

    fn is_closed(&self) -> bool {
        true
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        let patch = TracedPatch::new(*self, 0);
        patch.into_iter().for_each(|patch| visit(0, Patch::Traced(Box::new(patch))));
    }

    fn tessellate(&self, around: u32, out: &mut Tessellation) {
        // By the angles of a ball, bent so that places are even on edges too.
        let bent = |angle: f64, power: f64| {
            let (sin, cos) = fmath::sincos64(angle);
            let raised = |x: f64| fmath::pow64(x.abs(), 2.0 / power).copysign(x);
            (raised(sin), raised(cos))
        };
        out.grid(0, [around, around.div_ceil(2)], |x, y| {
            let ((sin, cos), (up, across)) = (bent(TAU * x, self.east), bent(PI * (y - 0.5), self.north));
            let w = self.towards(DVec3::new(across * cos, up, -across * sin));
            (self.center + self.radius * w, self.norm(w).1.normalize_or(DVec3::Y))
        });
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::{rng::Stream, warp};

    use super::*;

    const EXPONENTS: [[f32; 2]; 9] = [
        [1.0, 1.0],
        [0.01, 0.01],
        [2.0, 2.0],
        [0.1, 1.0],
        [1.0, 0.1],
        [2.0, 0.05],
        [0.05, 2.0],
        [0.3, 0.6],
        [1.7, 1.2],
    ];

    /// Parameters of both crossings of a line.
    fn roots(shape: &Superellipsoid, line: &Ray64) -> Option<[f64; 2]> {
        shape.chord(line).map(|chord| [chord.end(0), chord.end(1)])
    }

    fn shape([east, north]: [f32; 2]) -> Superellipsoid {
        Superellipsoid::new(Vec3::new(0.2, -0.1, 0.3), 0.8, east, north).unwrap()
    }

    fn random_line(i: u32) -> Ray64 {
        let s = Stream::new(101, [i, 0], 0);
        let u = |k| Vec2::new(s.uniform(k), s.uniform(k + 1));
        let d = warp::uniform_sphere(u(0)).as_dvec3();
        let through = Vec3::new(s.uniform(2), s.uniform(3), s.uniform(4)) * 1.8 - 0.9;
        Ray64 { o: through.as_dvec3() + DVec3::new(0.2, -0.1, 0.3) - 3.0 * d, d }
    }

    /// Roots lie on the surface by its equation, also from ten thousand units away, and between and beside them a fine grid of
    /// the line is on the right side.
    #[test]
    fn crossings_are_those_of_the_equation() {
        for exponents in EXPONENTS {
            let (shape, mut hits) = (shape(exponents), 0);
            let [e, n] = exponents.map(f64::from);
            // The equation as it is written; where powers underflow the shape is a box.
            let side = |p: DVec3| {
                let q = ((p - shape.center) / shape.radius).abs();
                let across = (q.x.powf(2.0 / e) + q.z.powf(2.0 / e)).powf(e / n);
                across + q.y.powf(2.0 / n) - 1.0
            };
            for i in 0..3000 {
                let line = random_line(i);
                let found = roots(&shape, &line);
                hits += u32::from(found.is_some());
                let far = roots(&shape, &Ray64 { o: line.o - 1e4 * line.d, d: line.d });
                // Lines that all but touch may be told apart differently by the rounding of the origin.
                if let (Some(near), Some(far)) = (found, far) {
                    let off = (far[0] - near[0] - 1e4).abs().max((far[1] - near[1] - 1e4).abs());
                    assert!(off < 1e-7, "{exponents:?}: {near:?} {far:?}");
                }
                for k in 0..400 {
                    let t = 1.0 + 0.01 * f64::from(k);
                    let is_between = found.is_some_and(|[a, b]| a < t && t < b);
                    let value = side(line.at(t));
                    assert!(
                        value.abs() < 1e-9 || (value < 0.0) == is_between,
                        "{exponents:?}: ray {i} at {t}: {value}"
                    );
                }
                for t in found.into_iter().flatten() {
                    let (gap, _) =
                        shape.gap((line.o - shape.center) / shape.radius, line.d / shape.radius, t);
                    assert!(gap.abs() < 1e-14, "{exponents:?}: {gap}");
                }
            }
            assert!(hits > 800, "{exponents:?}: {hits}");
        }
    }

    /// Rays that graze from inside and outside, by less and less: none or two crossings, and two where they are a billionth deep.
    #[test]
    fn tangent_rays_cross_twice_or_not_at_all() {
        for exponents in EXPONENTS {
            let shape = shape(exponents);
            for i in 0..4000 {
                let s = Stream::new(103, [i, 0], 0);
                let w = shape.towards(warp::uniform_sphere(Vec2::new(s.uniform(0), s.uniform(1))).as_dvec3());
                let n = shape.norm(w).1.normalize();
                let d = n.any_orthonormal_vector();
                let off = 1e-8 * f64::from(s.uniform(2) - 0.5);
                let p = shape.center + shape.radius * w + off * n;
                let found = roots(&shape, &Ray64 { o: p - 2.0 * d, d });
                // On faces that are all but flat the rounding of a unit decides.
                assert!(off < -1e-13 || found.is_none(), "{exponents:?}: {off:e}");
                if let Some([a, b]) = found {
                    assert!(a <= b && off < 1e-13, "{a} {b}");
                }
                let is_deep = shape.gap((p - shape.center) / shape.radius, d, 0.0).0 < -1e-13;
                assert!(!is_deep || found.is_some(), "{exponents:?}: {off:e}");
            }
        }
    }

    /// `V = 2 e n B(n/2 + 1, n) B(e/2, e/2)`.
    #[test]
    fn volumes_are_those_of_the_beta_function() {
        // By the midpoint rule on the integral, after s = x^2 (3 - 2 x), which is flat at the ends.
        let beta = |a: f64, b: f64| {
            // The Beta function by B(a, b) = (a + b) / a * B(a + 1, b), so that nothing is large at the ends.
            let raised = |a: f64, b: f64| {
                const STEPS: u32 = 200_000;
                let h = 1.0 / f64::from(STEPS);
                let f = |k: u32| {
                    let x = h * (f64::from(k) + 0.5);
                    let s = x * x * (3.0 - 2.0 * x);
                    s.powf(a - 1.0) * (1.0 - s).powf(b - 1.0) * 6.0 * x * (1.0 - x)
                };
                h * (0..STEPS).map(f).sum::<f64>()
            };
            (a + b) * (a + b + 1.0) / (a * b) * raised(a + 1.0, b + 1.0)
        };
        assert!((beta(0.5, 0.5) - PI).abs() < 1e-6, "{}", beta(0.5, 0.5));
        for exponents in EXPONENTS {
            let shape = shape(exponents);
            let [e, n] = exponents.map(f64::from);
            let expected =
                2.0 * e * n * beta(0.5 * n + 1.0, n) * beta(0.5 * e, 0.5 * e) * shape.radius.powi(3);
            // A quarter of the lines along y, at places that no edge of the shape lies along.
            const LINES: u32 = 200_000;
            let mean = (0..LINES).map(|k| {
                let at = |step: f64| (step * f64::from(k)).fract();
                let o =
                    DVec3::new(at(0.754_877_666_246_692_7), -3.0, at(0.569_840_290_998_053_2)) * shape.radius;
                roots(&shape, &Ray64 { o: o + shape.center, d: DVec3::Y }).map_or(0.0, |[a, b]| b - a)
            });
            let volume = mean.sum::<f64>() / f64::from(LINES) * 4.0 * shape.radius * shape.radius;
            assert!((volume / expected - 1.0).abs() < 5e-4, "{exponents:?}: {volume} for {expected}");
        }
    }

    #[test]
    fn exponents_have_bounds() {
        let of = |east, north| Superellipsoid::new(Vec3::ZERO, 1.0, east, north).is_some();
        assert!(of(0.01, 2.0) && of(2.0, 0.01));
        assert!(!of(0.0, 1.0) && !of(1.0, 2.1) && !of(f32::NAN, 1.0) && !of(1.0, -1.0));
        assert!(Superellipsoid::new(Vec3::ZERO, 0.0, 1.0, 1.0).is_none());
    }
}
