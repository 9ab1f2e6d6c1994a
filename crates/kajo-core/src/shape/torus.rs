//! Tori.
//!
//! With the origin in the middle, the z axis along the torus's, `R` the radius of the circle in the middle of the tube and
//! `r` that of the tube, a point of the surface satisfies
//!
//! ```text
//! (|p|^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + y^2) = 0,
//! ```
//!
//! along a ray a quartic. It is taken between the places where the ray enters and leaves the sphere and the slab around
//! the torus, so that far-away origins cost no digits, and its roots are isolated by Bernstein coefficients, which are
//! formed without the powers of `t`. Outside the slab and sphere it is not negative: crossings come in pairs.
//!
//! Where the tube is wider than its circle the surface crosses itself on the axis; what counts is its outer part, which is
//! closed.
//!
//! Scene: `Torus { center 0 0 0  axis 0 1 0  majorRadius 1  minorRadius 0.3 }`

use std::f64::consts::{PI, TAU};

use kajo_math::solid_angle::basis64;
use kajo_math::{Aabb, DAffine3, DMat3, DVec3, Ray, Vec2, Vec3, fmath, roots};

use super::{Canonical, Patch, Ray64, Surface, in_range, stored};
use crate::interaction::{Hit, SurfacePoint, Tangents};

/// A tube bent to a circle.
#[derive(Clone, Copy, Debug)]
pub struct Torus {
    center: DVec3,
    /// Unit axis, and two directions across it.
    axis: DVec3,
    across: [DVec3; 2],
    major: f64,
    minor: f64,
    /// Largest angle around the tube, from its outermost circle: `pi`, or where a wide tube meets itself on the axis.
    widest: f64,
}

impl Torus {
    /// A torus around `axis`, which may have any length but zero. Radii are taken as absolute values.
    ///
    /// * `major`: radius of the circle in the middle of the tube
    /// * `minor`: radius of the tube; zero is never hit
    ///
    /// `None` without an axis or a major radius.
    pub fn new(center: Vec3, axis: Vec3, major: f32, minor: f32) -> Option<Torus> {
        let axis = axis.as_dvec3().try_normalize()?;
        let (major, minor) = (f64::from(major.abs()), f64::from(minor.abs()));
        let (x, y) = basis64(axis);
        let widest = if minor > major { fmath::acos64(-major / minor) } else { PI };
        let torus = Torus { center: center.as_dvec3(), axis, across: [x, y], major, minor, widest };
        (major != 0.0).then_some(torus)
    }

    /// Visits the parameters of all crossings of a line, in ascending order, until `visit` says that it is enough.
    fn roots(&self, line: &Ray64, mut visit: impl FnMut(f64) -> bool) {
        let Ray64 { o, d } = *line;
        let shift = (self.center - o).dot(d) / d.dot(d);
        let w = o + shift * d - self.center;
        let Some([lo, hi]) = self.extent_along(w, d) else { return };
        let (q, e) = (w + lo * d, (hi - lo) * d);
        let mut quartic = self.quartic(q, e);
        // Outside of the surface it is not negative, but for rounding.
        quartic[0] = quartic[0].max(0.0);
        quartic[4] = quartic[4].max(0.0);
        roots::sign_changes_until(&quartic, |s| {
            let is_there = self.minor <= self.major || self.is_outer(q + s * e);
            is_there && visit(shift + lo + s * (hi - lo))
        });
    }

    /// Whether a ray crosses the surface, which is asked of the signs of the quartic alone; not for tubes that meet themselves.
    fn is_crossed(&self, ray: &Ray) -> bool {
        let Ray64 { o, d } = Ray64::new(ray);
        let shift = (self.center - o).dot(d) / d.dot(d);
        let w = o + shift * d - self.center;
        let Some([lo, hi]) = self.extent_along(w, d) else { return false };
        let [first, last] = [ray.t_min, ray.t_max].map(|t| f64::from(t) - shift);
        let [from, to] = [lo.max(first), hi.min(last)];
        if from >= to {
            return false;
        }
        let mut quartic = self.quartic(w + from * d, (to - from) * d);
        if from == lo {
            quartic[0] = quartic[0].max(0.0);
        }
        if to == hi {
            quartic[4] = quartic[4].max(0.0);
        }
        roots::changes_sign(&quartic)
    }

    /// Where a line is in the sphere around the torus and between the planes that touch it above and below.
    ///
    /// * `w`: the point of the line nearest to the middle, from there
    fn extent_along(&self, w: DVec3, d: DVec3) -> Option<[f64; 2]> {
        let outer = self.major + self.minor;
        let room = outer * outer - w.dot(w);
        if room < 0.0 {
            return None;
        }
        let half_chord = (room / d.dot(d)).sqrt();
        let (height, rise) = (w.dot(self.axis), d.dot(self.axis));
        let (mut lo, mut hi) = (-half_chord, half_chord);
        if rise == 0.0 {
            // Also for numbers that are none.
            return (height.abs() < self.minor && lo < hi).then_some([lo, hi]);
        }
        let [a, b] = [(-self.minor - height) / rise, (self.minor - height) / rise];
        (lo, hi) = (lo.max(a.min(b)), hi.min(a.max(b)));
        (half_chord >= 0.0 && lo < hi).then_some([lo, hi])
    }

    /// Bernstein coefficients of the quartic at `q + s e`, `s` in [0, 1].
    fn quartic(&self, q: DVec3, e: DVec3) -> [f64; 5] {
        let quadratic = |a: f64, h: f64, c: f64| [c, c + h, c + 2.0 * h + a];
        let [height, rise] = [q.dot(self.axis), e.dot(self.axis)];
        let (a, h, c) = (e.dot(e), q.dot(e), q.dot(q));
        let squares = (self.major - self.minor) * (self.major + self.minor);
        let [u0, u1, u2] = quadratic(a, h, c + squares);
        let across = quadratic(a - rise * rise, h - height * rise, c - height * height);
        let [v0, v1, v2] = across.map(|v| 4.0 * self.major * self.major * v);
        // A square, less a quadratic that is raised by two degrees.
        [
            u0 * u0 - v0,
            u0 * u1 - 0.5 * (v0 + v1),
            (u0 * u2 + 2.0 * u1 * u1) / 3.0 - (v0 + 4.0 * v1 + v2) / 6.0,
            u1 * u2 - 0.5 * (v1 + v2),
            u2 * u2 - v2,
        ]
    }

    /// Whether a point of the surface is not of the part that a wide tube hides within itself, where
    /// `|p|^2 + R^2 - r^2 = -2 R sqrt(x^2 + y^2)`.
    fn is_outer(&self, p: DVec3) -> bool {
        p.dot(p) + self.major * self.major >= self.minor * self.minor
    }

    /// A point from the middle: its distance along the axis, and how far from the axis in which unit direction.
    fn cylindrical(&self, w: DVec3) -> (f64, f64, DVec3) {
        let height = w.dot(self.axis);
        let across = w - height * self.axis;
        (height, across.length(), across.normalize_or(self.across[0]))
    }
}

impl Surface for Torus {
    fn bounds(&self) -> Aabb {
        let circle = self.major * (DVec3::ONE - self.axis * self.axis).max(DVec3::ZERO).map(f64::sqrt);
        let reach = circle + self.minor;
        Aabb { min: (self.center - reach).as_vec3(), max: (self.center + reach).as_vec3() }.padded(1e-6)
    }

    fn is_finite(&self) -> bool {
        self.center.is_finite() && self.axis.is_finite() && (self.major + self.minor).is_finite()
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let mut first = None;
        self.roots(&Ray64::new(ray), |t| {
            first = in_range(ray, t).map(|t| Hit { t, ..Hit::default() });
            first.is_some()
        });
        first
    }

    fn blocks(&self, ray: &Ray) -> bool {
        if self.minor <= self.major { self.is_crossed(ray) } else { self.hit(ray).is_some() }
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        self.roots(&Ray64::new(ray), |t| {
            if let Some(t) = in_range(ray, t) {
                visit(Hit { t, ..Hit::default() });
            }
            false
        });
    }

    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let (height, distance, radial) = self.cylindrical(Ray64::new(ray).at(hit.t.into()) - self.center);
        let n = ((distance - self.major) * radial + height * self.axis).normalize_or(radial);
        let scale = self.center.abs().max_element() + self.major;
        let (p, p_error) = stored(self.center + self.major * radial + self.minor * n, scale);
        SurfacePoint::flat(p, p_error, n.as_vec3())
    }

    /// `u` runs once around the axis; `v` around the tube, from the innermost circle below the outermost to above it.
    fn uv_at(&self, _hit: &Hit, p: Vec3) -> Vec2 {
        let w = p.as_dvec3() - self.center;
        let (height, distance, _) = self.cylindrical(w);
        let [x, y] = self.across.map(|axis| w.dot(axis));
        let turn = fmath::atan2_64(y, x) / TAU;
        let around = fmath::atan2_64(height, distance - self.major);
        let v = 0.5 + (around / (2.0 * self.widest)).clamp(-0.5, 0.5);
        Vec2::new((if turn < 0.0 { turn + 1.0 } else { turn }) as f32, v as f32)
    }

    /// Around the axis, and around the tube.
    fn tangents_at(&self, _hit: &Hit, p: Vec3) -> Tangents {
        let (height, distance, radial) = self.cylindrical(p.as_dvec3() - self.center);
        let dpdu = TAU * distance * self.axis.cross(radial);
        let dpdv = 2.0 * self.widest * ((distance - self.major) * self.axis - height * radial);
        Tangents { dpdu: dpdu.as_vec3(), dpdv: dpdv.as_vec3() }
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        let [x, y] = self.across;
        let matrix3 = self.major * DMat3::from_cols(x, y, self.axis);
        let map = DAffine3 { matrix3, translation: self.center };
        let canonical = Canonical::Torus { minor: self.minor / self.major, widest: self.widest };
        Patch::curved(canonical, map).into_iter().for_each(|patch| visit(0, patch));
    }

    fn is_closed(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn roots_of(torus: &Torus, o: DVec3, d: DVec3) -> Vec<f64> {
        let mut found = Vec::new();
        torus.roots(&Ray64 { o, d }, |t| {
            found.push(t);
            false
        });
        found
    }

    /// Crossings that were worked out in 30 digits, also from ten thousand units away.
    #[test]
    fn crossings_are_right_to_a_billionth() {
        let torus = Torus::new(Vec3::ZERO, Vec3::Z, 1.0, 0.3).unwrap();
        // The radius in single precision, as scenes have it, is not 0.3.
        let torus = Torus { minor: 0.3, ..torus };
        let (o, d) = (DVec3::new(-3.0, 0.4, 0.1), DVec3::new(1.0, -0.05, 0.02));
        let expected = [1.77372368727098, 2.32207619424711, 3.73052497419647, 4.2282087245808];
        for (from, length) in [(o, d.length()), (o - 1e4 * d, d.length())] {
            let unit = d / length;
            let shift = (o - from).dot(unit);
            let found = roots_of(&torus, from, unit);
            assert_eq!(found.len(), 4);
            let off =
                |(t, want): (&f64, f64)| ((t - shift) / length - want).abs().min((t - shift - want).abs());
            assert!(found.iter().zip(expected).all(|pair| off(pair) < 1e-9), "{found:?}");
        }
        let found = roots_of(&torus, DVec3::new(-9.0, 0.0, 0.0), DVec3::X);
        assert!(
            found.iter().zip([7.7, 8.3, 9.7, 10.3]).all(|(t, want)| (t - want).abs() < 1e-12),
            "{found:?}"
        );
    }

    /// What is in the way of a ray is what it hits, wherever it begins and ends.
    #[test]
    fn rays_are_blocked_by_what_they_hit() {
        let mut blocked = 0;
        for (major, minor) in [(1.0, 0.3), (1.0, 0.02), (0.5, 0.8)] {
            let torus =
                Torus::new(Vec3::new(0.2, -0.1, 0.4), Vec3::new(1.0, 2.0, -0.5), major, minor).unwrap();
            for i in 0..20_000 {
                let s = kajo_math::rng::Stream::new(7, [i, 0], 0);
                let point = |k: u32| Vec3::from_array([k, k + 1, k + 2].map(|k| 5.0 * s.uniform(k) - 2.5));
                let (o, to) = (point(0), point(3));
                let ray = Ray::new(o, to - o).over(0.0, 2.0 * s.uniform(6));
                let is_hit = torus.hit(&ray).is_some();
                blocked += usize::from(is_hit);
                assert_eq!(torus.blocks(&ray), is_hit, "{major} {minor}: ray {i}");
            }
        }
        assert!(blocked > 1000);
    }

    /// Rays that graze the silhouette from inside and outside, by less and less: none or two crossings.
    #[test]
    fn tangent_rays_cross_twice_or_not_at_all() {
        let torus = Torus::new(Vec3::ZERO, Vec3::Z, 1.0, 0.25).unwrap();
        for i in 0..200_000 {
            let angle = 1e-3 * f64::from(i % 2000);
            let (n, along) = (
                DVec3::new(angle.cos(), angle.sin(), 0.0),
                DVec3::new(0.3 * angle.sin(), -0.3 * angle.cos(), 1.0),
            );
            let off = 1e-9 * f64::from(i / 2000 - 50) / 50.0;
            let found = roots_of(&torus, (1.25 + off) * n - 3.0 * along, along).len();
            assert!(found.is_multiple_of(2), "{found} at {off}");
        }
    }

    /// The number of crossings against the sign of the function on a fine grid of the line.
    #[test]
    fn no_crossing_is_missed() {
        for (major, minor) in [(1.0, 0.3), (1.0, 0.01), (1.0, 1.0), (0.5, 0.8)] {
            let torus =
                Torus::new(Vec3::new(0.2, -0.1, 0.4), Vec3::new(1.0, 2.0, -0.5), major, minor).unwrap();
            for i in 0..2000 {
                let s = kajo_math::rng::Stream::new(5, [i, 0], 0);
                let point = |k: u32| {
                    DVec3::from_array([k, k + 1, k + 2].map(|k| f64::from(2.6 * s.uniform(k) - 1.3)))
                };
                let (o, to) = (point(0), point(3));
                let line = Ray64 { o: o - 4.0 * (to - o), d: to - o };
                let found = roots_of(&torus, line.o, line.d);
                let is_inside = |t: f64| {
                    let (height, distance, _) = torus.cylindrical(line.at(t) - torus.center);
                    (distance - torus.major).powi(2) + height * height < torus.minor * torus.minor
                };
                const STEPS: u32 = 4000;
                let step = 9.0 / f64::from(STEPS);
                for k in 0..STEPS {
                    let (a, b) = (step * f64::from(k), step * f64::from(k + 1));
                    let between = found.iter().filter(|&&t| a <= t && t < b).count();
                    let changes = is_inside(a) != is_inside(b);
                    assert_eq!(
                        changes,
                        between % 2 == 1,
                        "{major} {minor}: ray {i} between {a} and {b}: {found:?}"
                    );
                }
            }
        }
    }
}
