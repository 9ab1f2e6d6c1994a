//! Ellipsoids, cylinders and cones as a point outside sees them: drawn through their silhouettes.
//!
//! What a point `o` sees of an ellipsoid it sees through an ellipse, the image of the circle in which the tangent cone touches a unit
//! sphere. The tangent planes of a cone through `o` touch it along two of its lines, and between these lies a trapezoid through which all
//! of it is seen [after Gamito 2016]. In the space of the cone of the radii `r(z) = r0 + k z`, with `o` at the distance `d` from its axis
//! and `c = r(o_z) / d`, the lines are where the radius makes the angle `acos c` with `o`. The nearest point of a rim of the radius
//! `r_e`, and the farthest one, are seen before those lines at
//!
//! ```text
//! z = o_z + t (z_e - o_z)        t = d (1 + c) / (d (1 + c) - r_e),        t = d (1 - c) / (d (1 - c) + r_e)
//! ```
//!
//! which are the ends of the trapezoid. Beyond the apex, where `c < -1`, all of it is seen through the disk in its
//! wider rim. A position on these flat patches is drawn as on any, by solid angle where that is worth it, and the ray
//! through it meets the surface once or twice; of two points the nearest one, which hides the other unless light passes
//! there, is chosen with the probability 31/32. Per solid angle the density is that of the position times that of the
//! choice.

use kajo_math::solid_angle::basis64;
use kajo_math::{DVec3, Vec2, Vec3};

use super::traced::hashed_uniform;
use super::{Canonical, CurvedPatch, DiskPatch, ON_SPHERE, Patch, PatchDirection};

/// Probability of the nearest of two points.
const NEAREST: f32 = 31.0 / 32.0;

/// How many times as far as the rim of a cone the position before it may be.
const FARTHEST: f64 = 8.0;

/// Flat patches in one plane through which a point sees all of a surface.
struct Silhouette {
    first: Patch,
    /// A second one, and the line between the two.
    second: Option<(Patch, [DVec3; 2])>,
    /// Probability of the first.
    share: f32,
}

/// The points of a surface on a ray, by their parameters, the nearest first.
struct Crossings {
    t: [f64; 2],
    n: usize,
}

impl CurvedPatch {
    /// See [`Patch::sample`].
    pub(super) fn sample(&self, from: Vec3, u: Vec2) -> Option<PatchDirection> {
        let o = from.as_dvec3();
        let Some(silhouette) = self.silhouette(o) else { return self.sample_area(u)?.seen_from(from) };
        let through = silhouette.sample(from, u)?;
        let d = through.at.p.as_dvec3() - o;
        let crossings = self.crossings(o, d);
        let k = match crossings.n {
            0 => return None,
            1 => 0,
            _ => usize::from(hashed_uniform([u.x, u.y]) >= NEAREST),
        };
        let at = self.placed_point(o + crossings.t[k] * d);
        let pdf = through.pdf * crossings.probability(k);
        Some(PatchDirection { at, wi: (at.p - from).normalize_or(through.wi), pdf })
    }

    /// See [`Patch::pdf`].
    pub(super) fn pdf(&self, from: Vec3, p: Vec3, n: Vec3) -> f32 {
        let o = from.as_dvec3();
        let Some(silhouette) = self.silhouette(o) else {
            let pdf_area = self.pdf_area(p.as_dvec3()) as f32;
            return super::per_solid_angle(pdf_area, from, p, n).unwrap_or(0.0);
        };
        let d = p.as_dvec3() - o;
        let crossings = self.crossings(o, d);
        // The point itself has the parameter 1.
        let k = usize::from(crossings.n == 2 && (crossings.t[1] - 1.0).abs() < (crossings.t[0] - 1.0).abs());
        silhouette.pdf(from, d) * crossings.probability(k)
    }

    /// Whether it is drawn through its silhouette from some points.
    pub(crate) fn has_silhouette(&self) -> bool {
        !self.by_area && !matches!(self.surface, Canonical::Torus { .. })
    }

    /// What `o` sees the surface through; `None` from within, from where there is none of use, and for what is drawn by area.
    fn silhouette(&self, o: DVec3) -> Option<Silhouette> {
        if !self.has_silhouette() {
            return None;
        }
        let o = self.inverse.transform_point3(o);
        match self.surface {
            Canonical::Sphere => self.silhouette_of_sphere(o),
            Canonical::Frustum(radii) => self.silhouette_of_frustum(radii, o),
            Canonical::Torus { .. } => None,
        }
    }

    /// * `o`: in the space of the unit sphere
    fn silhouette_of_sphere(&self, o: DVec3) -> Option<Silhouette> {
        let distance2 = o.length_squared();
        if !(distance2 > ON_SPHERE && distance2.is_finite()) {
            return None;
        }
        let radius = (1.0 - 1.0 / distance2).sqrt();
        let (x, y) = basis64(o / distance2.sqrt());
        let axes = [x, y].map(|axis| self.map.transform_vector3(radius * axis));
        let center = self.map.transform_point3(o / distance2);
        Some(Silhouette::alone(Patch::Disk(DiskPatch { center, axes, inner: 0.0 })))
    }

    /// * `o`: in the space of the cone
    fn silhouette_of_frustum(&self, [r0, r1]: [f64; 2], o: DVec3) -> Option<Silhouette> {
        let slope = r1 - r0;
        let radius = |z: f64| (r0 + slope * z).max(0.0);
        let distance = o.x.hypot(o.y);
        let cos = (r0 + slope * o.z) / distance;
        if cos < -ON_SPHERE {
            let (r, z) = if r0 > r1 { (r0, 0.0) } else { (r1, 1.0) };
            let axes = [DVec3::X, DVec3::Y].map(|axis| self.map.transform_vector3(r * axis));
            let center = self.map.transform_point3(z * DVec3::Z);
            return Some(Silhouette::alone(Patch::Disk(DiskPatch { center, axes, inner: 0.0 })));
        }
        if cos.is_nan() || cos.abs() >= 1.0 / ON_SPHERE {
            return None;
        }
        let [lo, hi] = ends_before([r0, r1], o.z, distance, cos)?;
        let x = DVec3::new(o.x, o.y, 0.0) / distance;
        let y = DVec3::new(-x.y, x.x, 0.0);
        let sin = (1.0 - cos * cos).sqrt();
        let corner = |z: f64, side: f64| {
            self.map.transform_point3(radius(z) * (cos * x + side * sin * y) + z * DVec3::Z)
        };
        let [a, b, c, d] = [corner(lo, -1.0), corner(lo, 1.0), corner(hi, 1.0), corner(hi, -1.0)];
        if slope == 0.0 {
            return Some(Silhouette::alone(Patch::parallelogram(a, [b - a, d - a])));
        }
        if radius(lo) == 0.0 {
            return Some(Silhouette::alone(Patch::Triangle([a, c, d])));
        }
        if radius(hi) == 0.0 {
            return Some(Silhouette::alone(Patch::Triangle([a, b, c])));
        }
        let halves = [Patch::Triangle([a, b, c]), Patch::Triangle([a, c, d])];
        let o = self.map.transform_point3(o);
        let sizes = match halves.each_ref().map(|half| half.view(o).map(|view| view.solid_angle())) {
            [Some(first), Some(second)] => [first, second],
            _ => halves.each_ref().map(Patch::area),
        };
        let share = (sizes[0] / (sizes[0] + sizes[1])) as f32;
        let [first, second] = halves;
        Some(Silhouette { first, second: Some((second, [a, c])), share })
    }

    /// The points of the surface on the ray from `o`, outside, along `d`.
    fn crossings(&self, o: DVec3, d: DVec3) -> Crossings {
        let o = self.inverse.transform_point3(o);
        let d = self.inverse.transform_vector3(d);
        // a t^2 + 2 b t + c = 0
        let [a, b, c] = match self.surface {
            Canonical::Sphere => [d.dot(d), o.dot(d), o.dot(o) - 1.0],
            Canonical::Frustum([r0, r1]) => {
                let (r, dr) = (r0 + (r1 - r0) * o.z, (r1 - r0) * d.z);
                let xy = |v: DVec3, w: DVec3| v.x * w.x + v.y * w.y;
                [xy(d, d) - dr * dr, xy(o, d) - r * dr, xy(o, o) - r * r]
            }
            Canonical::Torus { .. } => return Crossings { t: [0.0; 2], n: 0 },
        };
        // A ray through the very rim touches.
        let root = (b * b - a * c).max(0.0).sqrt();
        let q = if b > 0.0 { -b - root } else { -b + root };
        let roots = [q / a, c / q];
        let is_there = |t: f64| {
            let on_side = || (0.0..=1.0).contains(&(o.z + t * d.z));
            t.is_finite() && t > 0.0 && (matches!(self.surface, Canonical::Sphere) || on_side())
        };
        let [first, second] = if roots[0] <= roots[1] { roots } else { [roots[1], roots[0]] };
        match (is_there(first), is_there(second)) {
            (true, true) => Crossings { t: [first, second], n: 2 },
            (true, false) => Crossings { t: [first, 0.0], n: 1 },
            (false, true) => Crossings { t: [second, 0.0], n: 1 },
            (false, false) => Crossings { t: [0.0; 2], n: 0 },
        }
    }
}

/// From where to where along its axis the trapezoid before a cone reaches; `None` where it is too long to be of use.
///
/// * `z`, `distance`: the viewer's coordinate along the axis, and its distance from that
/// * `cos`: of the angle between the viewer and the lines that are touched
fn ends_before([r0, r1]: [f64; 2], z: f64, distance: f64, cos: f64) -> Option<[f64; 2]> {
    let (mut lo, mut hi) = (0.0f64, 1.0f64);
    for (rim, end) in [(r0, 0.0), (r1, 1.0)] {
        let (near, far) = (distance * (1.0 + cos), distance * (1.0 - cos));
        let near = near / (near - rim);
        if !(near > 0.0 && near < FARTHEST) {
            return None;
        }
        for t in [near, far / (far + rim)] {
            let before = z + t * (end - z);
            (lo, hi) = (lo.min(before), hi.max(before));
        }
    }
    // No farther than the apex.
    let apex = r0 / (r0 - r1);
    Some([if r1 > r0 { lo.max(apex) } else { lo }, if r1 < r0 { hi.min(apex) } else { hi }])
}

impl Crossings {
    /// The probability with which point `k` is chosen; where rounding finds none, there was one.
    fn probability(&self, k: usize) -> f32 {
        match (self.n, k) {
            (2, 0) => NEAREST,
            (2, _) => 1.0 - NEAREST,
            _ => 1.0,
        }
    }
}

impl Silhouette {
    fn alone(first: Patch) -> Silhouette {
        Silhouette { first, second: None, share: 1.0 }
    }

    /// A position drawn for the receiver `from`.
    fn sample(&self, from: Vec3, u: Vec2) -> Option<PatchDirection> {
        let Some((second, _)) = &self.second else { return self.first.sample(from, u) };
        let (patch, x, share) = if u.x < self.share {
            (&self.first, u.x / self.share, self.share)
        } else {
            (second, (u.x - self.share) / (1.0 - self.share), 1.0 - self.share)
        };
        let drawn = patch.sample(from, Vec2::new(x.min(1.0f32.next_down()), u.y))?;
        Some(PatchDirection { pdf: share * drawn.pdf, ..drawn })
    }

    /// Density per solid angle at `from` with which [`Silhouette::sample`] draws a position in the direction `d` of any length.
    fn pdf(&self, from: Vec3, d: DVec3) -> f32 {
        let o = from.as_dvec3();
        let (Some(n), Some(on)) = (self.first.normal(), self.first.point(0.5, 0.5)) else { return 0.0 };
        let t = n.dot(on - o) / n.dot(d);
        if !(t > 0.0 && t.is_finite()) {
            return 0.0;
        }
        let p = o + t * d;
        let (patch, share) = match &self.second {
            Some((second, [a, c])) if n.dot((c - a).cross(p - a)) > 0.0 => (second, 1.0 - self.share),
            _ => (&self.first, self.share),
        };
        share * patch.pdf(from, p.as_vec3(), n.as_vec3())
    }
}
