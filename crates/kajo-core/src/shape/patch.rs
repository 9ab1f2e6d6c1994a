//! Emissive patches of surface in world space, and how a point samples a position on them.
//!
//! Flat patches and spheres are drawn uniformly over the solid angle they fill, so that the estimate of
//! unobstructed light has no variance but the cosine's; ellipsoids, cylinders and cones are drawn through their silhouettes; ellipses, tori
//! and what is seen too small or from too near are drawn uniformly over the area, and what has no closed form is met by
//! rays. Every density given out is per solid angle at the receiver,
//!
//! ```text
//! p = p_area d^2 / |n . w|,
//! ```
//!
//! and [`Patch::pdf`] goes by the very rules of [`Patch::sample`]: two estimators combined by weights need
//! one truth about the density, on the light itself and inside it too.

mod coordinates;
mod cover;
mod moved;
mod silhouette;
mod traced;

pub use cover::CoverSegment;
pub use moved::PlacedPatch;
pub use traced::{PlacedTraced, TracedPatch};

use std::f64::consts::{PI, TAU};

use kajo_math::solid_angle::{Rectangle, SPHERE, SphericalCap, SphericalRectangle, SphericalTriangle};
use kajo_math::{Aabb, DAffine3, DMat3, DVec3, Vec2, Vec3, fmath, robust::gamma};

use super::triangle_error;

/// Below this solid angle a density per area and one per solid angle are proportional to single precision, and the area is computed more exactly.
const SMALLEST_SOLID_ANGLE: f64 = 1e-5;

/// Where the squared extent of a flat patch is below this share of the squared distance, its solid angle and its area
/// are all but proportional, and the area costs less.
const FAR: f64 = 0.4;

/// Nearly a hemisphere: the receiver lies in the plane of the patch.
const LARGEST_SOLID_ANGLE: f64 = 0.9995 * TAU;

/// A receiver whose squared distance from the centre of a sphere differs by less than this factor from the squared
/// radius is on the sphere, where area is what to draw by: rounding must not decide what it sees.
const ON_SPHERE: f64 = 1.001;

/// A patch of surface.
#[derive(Clone, Debug)]
pub enum Patch {
    /// A triangle.
    Triangle([DVec3; 3]),
    /// A rectangle.
    Rectangle(Rectangle),
    /// A parallelogram that is no rectangle.
    Quad(QuadPatch),
    /// An ellipse or elliptic ring.
    Disk(DiskPatch),
    /// A sphere.
    Sphere {
        /// Centre.
        center: DVec3,
        /// Radius.
        radius: f64,
    },
    /// The image of a curved surface under an affine map.
    Curved(Box<CurvedPatch>),
    /// A surface of no closed form, which has no coordinates.
    Traced(Box<TracedPatch>),
}

/// A parallelogram.
#[derive(Clone, Copy, Debug)]
pub struct QuadPatch {
    /// One corner.
    pub corner: DVec3,
    /// The edges from there.
    pub edges: [DVec3; 2],
}

/// `center + r (cos phi a + sin phi b)` with `r` in `[inner, 1]`.
#[derive(Clone, Copy, Debug)]
pub struct DiskPatch {
    /// Centre.
    pub center: DVec3,
    /// The two half axes.
    pub axes: [DVec3; 2],
    /// Inner radius over outer radius.
    pub inner: f64,
}

/// Which surface is mapped.
#[derive(Clone, Copy, Debug)]
pub enum Canonical {
    /// The unit sphere.
    Sphere,
    /// The side of a cone around z, of these radii at z = 0 and z = 1.
    Frustum([f64; 2]),
    /// A torus around z, whose tube's middle is the unit circle.
    Torus {
        /// Radius of the tube.
        minor: f64,
        /// Angle around the tube, from its outermost circle, up to which it counts.
        widest: f64,
    },
}

/// A curved surface and its map to world space.
#[derive(Clone, Debug)]
pub struct CurvedPatch {
    pub(super) surface: Canonical,
    pub(super) map: DAffine3,
    pub(super) inverse: DAffine3,
    area: f64,
    /// Whether it is drawn by area even where a silhouette would do.
    by_area: bool,
}

/// A position on a patch.
#[derive(Clone, Copy, Debug)]
pub struct PatchPoint {
    /// The position.
    pub p: Vec3,
    /// Bound on the error of each of its coordinates.
    pub p_error: Vec3,
    /// Unit normal, on the outer side.
    pub n: Vec3,
}

/// A position sampled independently of any receiver.
#[derive(Clone, Copy, Debug)]
pub struct PatchSample {
    /// The position.
    pub at: PatchPoint,
    /// Its density per area.
    pub pdf_area: f32,
}

/// A position sampled for a receiver.
#[derive(Clone, Copy, Debug)]
pub struct PatchDirection {
    /// The position.
    pub at: PatchPoint,
    /// Unit direction from the receiver to it.
    pub wi: Vec3,
    /// Its density per solid angle at the receiver.
    pub pdf: f32,
}

impl Patch {
    /// The parallelogram at `corner` between two edges.
    pub fn parallelogram(corner: DVec3, edges: [DVec3; 2]) -> Patch {
        Rectangle::new(corner, edges).map_or(Patch::Quad(QuadPatch { corner, edges }), Patch::Rectangle)
    }

    /// The image of this patch under an affine map; `None` where it would have no area.
    pub fn transformed(&self, m: &DAffine3) -> Option<Patch> {
        let flips = m.matrix3.determinant() < 0.0;
        Some(match self {
            Patch::Triangle(corners) => {
                let mut corners = corners.map(|p| m.transform_point3(p));
                if flips {
                    corners.swap(1, 2);
                }
                Patch::Triangle(corners)
            }
            Patch::Rectangle(rectangle) => mapped(m, rectangle.corner(), rectangle.edges(), flips),
            Patch::Quad(quad) => mapped(m, quad.corner, quad.edges, flips),
            Patch::Disk(DiskPatch { center, axes, inner }) => {
                let mut axes = axes.map(|a| m.transform_vector3(a));
                if flips {
                    axes.swap(0, 1);
                }
                Patch::Disk(DiskPatch { center: m.transform_point3(*center), axes, inner: *inner })
            }
            Patch::Sphere { center, radius } => match scale_of_similarity(&m.matrix3) {
                Some(scale) => Patch::Sphere { center: m.transform_point3(*center), radius: radius * scale },
                None => {
                    let placed =
                        DAffine3::from_translation(*center) * DAffine3::from_scale(DVec3::splat(*radius));
                    Patch::curved(Canonical::Sphere, *m * placed)?
                }
            },
            Patch::Curved(curved) => {
                let image = Patch::curved(curved.surface, *m * curved.map)?;
                if curved.by_area { image.by_area()? } else { image }
            }
            Patch::Traced(traced) => Patch::Traced(Box::new(traced.mapped(m)?)),
        })
    }

    /// The same surface, drawn by area, or all of it alike, where it would be drawn by what of it a point sees from outside; `None`
    /// where it has none.
    pub fn by_area(self) -> Option<Patch> {
        match self {
            Patch::Sphere { center, radius } => {
                let placed = DAffine3::from_translation(center) * DAffine3::from_scale(DVec3::splat(radius));
                Patch::curved(Canonical::Sphere, placed)?.by_area()
            }
            Patch::Curved(curved) => Some(Patch::Curved(Box::new(CurvedPatch { by_area: true, ..*curved }))),
            Patch::Traced(traced) => Some(Patch::Traced(Box::new(traced.all_alike()))),
            _ => Some(self),
        }
    }

    /// The image of a canonical surface; `None` when the map has no inverse.
    pub fn curved(surface: Canonical, map: DAffine3) -> Option<Patch> {
        let inverse = map.inverse();
        let mut patch = CurvedPatch { surface, map, inverse, area: 0.0, by_area: false };
        patch.area = patch.measured_area();
        let usable = inverse.is_finite() && patch.area.is_finite() && patch.area > 0.0;
        usable.then(|| Patch::Curved(Box::new(patch)))
    }

    /// Area of one side.
    pub fn area(&self) -> f64 {
        match self {
            Patch::Triangle([a, b, c]) => 0.5 * (b - a).cross(c - a).length(),
            Patch::Rectangle(rectangle) => rectangle.area(),
            Patch::Quad(quad) => quad.edges[0].cross(quad.edges[1]).length(),
            Patch::Disk(disk) => disk.area(),
            Patch::Sphere { radius, .. } => 4.0 * PI * radius * radius,
            Patch::Curved(curved) => curved.area,
            Patch::Traced(traced) => traced.area(),
        }
    }

    /// A box around the patch.
    pub fn bounds(&self) -> Aabb {
        let single = |p: DVec3| p.as_vec3();
        let around =
            |center: DVec3, reach: DVec3| Aabb { min: single(center - reach), max: single(center + reach) };
        match self {
            Patch::Triangle(corners) => Aabb::around(corners.map(single)),
            Patch::Rectangle(rectangle) => {
                let ([a, b], corner) = (rectangle.edges(), rectangle.corner());
                Aabb::around([corner, corner + a, corner + b, corner + a + b].map(single))
            }
            Patch::Quad(QuadPatch { corner, edges: [a, b] }) => {
                Aabb::around([*corner, corner + a, corner + b, corner + a + b].map(single))
            }
            Patch::Disk(disk) => around(disk.center, ellipse_reach(disk.axes)),
            Patch::Sphere { center, radius } => around(*center, DVec3::splat(*radius)),
            Patch::Curved(curved) => curved.bounds(),
            Patch::Traced(traced) => traced.bounds(),
        }
    }

    /// The unit normal where it is the same everywhere.
    pub fn normal(&self) -> Option<DVec3> {
        match self {
            Patch::Triangle([a, b, c]) => (b - a).cross(c - a).try_normalize(),
            Patch::Rectangle(rectangle) => Some(rectangle.normal()),
            Patch::Quad(QuadPatch { edges: [a, b], .. }) | Patch::Disk(DiskPatch { axes: [a, b], .. }) => {
                a.cross(*b).try_normalize()
            }
            Patch::Sphere { .. } | Patch::Curved(_) | Patch::Traced(_) => None,
        }
    }

    /// A position sampled for the receiver `from`.
    #[inline]
    pub fn sample(&self, from: Vec3, u: Vec2) -> Option<PatchDirection> {
        let o = from.as_dvec3();
        if let Some(view) = self.view(o) {
            let p = view.sample(o, u, self)?;
            let (at, pdf) = (self.placed_point(p), (1.0 / view.solid_angle()) as f32);
            return Some(PatchDirection { at, wi: (at.p - from).normalize_or_zero(), pdf });
        }
        match self {
            Patch::Traced(traced) => traced.placed(None).sample(from, u),
            Patch::Curved(curved) => curved.sample(from, u),
            _ => self.sample_area(u)?.seen_from(from),
        }
    }

    /// Density per solid angle at `from` with which [`Patch::sample`] draws the position `p` of this patch.
    ///
    /// * `n`: unit geometric normal at `p`
    #[inline]
    pub fn pdf(&self, from: Vec3, p: Vec3, n: Vec3) -> f32 {
        match self.view(from.as_dvec3()) {
            Some(view) => (1.0 / view.solid_angle()) as f32,
            None => match self {
                Patch::Traced(traced) => traced.placed(None).pdf(from, p),
                Patch::Curved(curved) => curved.pdf(from, p, n),
                _ => per_solid_angle(self.pdf_area(p), from, p, n).unwrap_or(0.0),
            },
        }
    }

    /// A position sampled by area; `None` for traced surfaces, see [`PlacedPatch::traced`].
    pub fn sample_area(&self, u: Vec2) -> Option<PatchSample> {
        let (x, y) = (f64::from(u.x), f64::from(u.y));
        let p = match self {
            Patch::Triangle([a, b, c]) => {
                let root = x.sqrt();
                a + root * (1.0 - y) * (b - a) + root * y * (c - a)
            }
            Patch::Curved(curved) => return curved.sample_area(u),
            _ => self.point(x, y)?,
        };
        let pdf_area = (1.0 / self.area()) as f32;
        (pdf_area.is_finite() && pdf_area > 0.0).then(|| PatchSample { at: self.placed_point(p), pdf_area })
    }

    /// Density per area with which [`Patch::sample_area`] draws the position `p`.
    pub fn pdf_area(&self, p: Vec3) -> f32 {
        match self {
            Patch::Curved(curved) => curved.pdf_area(p.as_dvec3()) as f32,
            Patch::Traced(_) => 0.0,
            _ => (1.0 / self.area()) as f32,
        }
    }

    /// How the patch is seen from `o`, where it is drawn by solid angle.
    fn view(&self, o: DVec3) -> Option<SphericalProjection> {
        if self.is_far_from(o) {
            return None;
        }
        let view = match self {
            Patch::Triangle(corners) => SphericalProjection::Triangle(SphericalTriangle::new(o, *corners)?),
            Patch::Rectangle(rectangle) => {
                SphericalProjection::Rectangle(SphericalRectangle::new(o, rectangle)?)
            }
            Patch::Quad(quad) => {
                let [first, second] = quad.halves().map(|half| SphericalTriangle::new(o, half));
                SphericalProjection::Halves([first?, second?])
            }
            Patch::Sphere { center, radius } => {
                let reach = o.distance_squared(*center) / (radius * radius);
                if reach < 1.0 / ON_SPHERE {
                    SphericalProjection::Around
                } else if reach > ON_SPHERE {
                    SphericalProjection::Cap(SphericalCap::new(o, *center, *radius)?)
                } else {
                    return None;
                }
            }
            Patch::Disk(_) | Patch::Curved(_) | Patch::Traced(_) => return None,
        };
        let flat = !matches!(view, SphericalProjection::Cap(_) | SphericalProjection::Around);
        let usable = !flat || (SMALLEST_SOLID_ANGLE..LARGEST_SOLID_ANGLE).contains(&view.solid_angle());
        usable.then_some(view)
    }

    /// Whether [`Patch::sample`] draws positions by area for the receiver `from`, as far as can be told by its distance.
    #[inline]
    pub fn is_drawn_by_area(&self, from: Vec3) -> bool {
        match self {
            Patch::Disk(_) => true,
            Patch::Curved(curved) => !curved.has_silhouette(),
            _ => self.is_far_from(from.as_dvec3()),
        }
    }

    /// Whether a flat patch is seen as if from infinitely far.
    #[inline]
    fn is_far_from(&self, o: DVec3) -> bool {
        let (middle, extent2) = match self {
            Patch::Triangle([a, b, c]) => {
                ((a + b + c) / 3.0, (b - a).length_squared().max((c - a).length_squared()))
            }
            Patch::Rectangle(rectangle) => (rectangle.middle(), rectangle.extent2()),
            Patch::Quad(QuadPatch { corner, edges: [a, b] }) => {
                (corner + 0.5 * (a + b), a.length_squared() + b.length_squared())
            }
            _ => return false,
        };
        extent2 < FAR * middle.distance_squared(o)
    }

    /// Where the ray from `o` along the unit vector `d` meets a sphere: at the nearer or the farther crossing by `side`.
    fn along(&self, o: DVec3, d: DVec3, side: f64) -> Option<DVec3> {
        let Patch::Sphere { center, radius } = *self else { return None };
        let to_center = center - o;
        let along = to_center.dot(d);
        // A direction on the very rim touches at the middle of its chord.
        let half_chord2 = radius * radius - (to_center - along * d).length_squared();
        let p = o + (along + side * half_chord2.max(0.0).sqrt()) * d;
        Some(center + radius * (p - center).normalize_or(DVec3::Z))
    }

    /// A position with its normal and the bound on its error.
    fn placed_point(&self, p: DVec3) -> PatchPoint {
        let n = match self {
            Patch::Sphere { center, .. } => (p - center).normalize_or(DVec3::Z),
            Patch::Curved(curved) => return curved.placed_point(p),
            _ => self.normal().unwrap_or(DVec3::Z),
        };
        let single = p.as_vec3();
        // A triangle may be one of a mesh, which is tested in single precision.
        let of_test = if let Patch::Triangle(corners) = *self { triangle_error(corners) } else { 0.0 };
        let p_error = gamma(4) * (single.abs() + self.reach()) + Vec3::splat(of_test);
        PatchPoint { p: single, p_error, n: n.as_vec3() }
    }

    /// The size of the coordinates that a position is put together from.
    fn reach(&self) -> Vec3 {
        match self {
            Patch::Triangle([a, b, c]) => a.abs().max(b.abs()).max(c.abs()).as_vec3(),
            Patch::Rectangle(rectangle) => {
                let [a, b] = rectangle.edges();
                (rectangle.corner().abs() + a.abs() + b.abs()).as_vec3()
            }
            Patch::Quad(QuadPatch { corner, edges: [a, b] }) => (corner.abs() + a.abs() + b.abs()).as_vec3(),
            Patch::Disk(DiskPatch { center, axes: [a, b], .. }) => {
                (center.abs() + a.abs() + b.abs()).as_vec3()
            }
            Patch::Sphere { center, radius } => (center.abs() + *radius).as_vec3(),
            Patch::Curved(curved) => curved.reach(),
            Patch::Traced(traced) => traced.bounds().min.abs().max(traced.bounds().max.abs()),
        }
    }
}

/// The image of a parallelogram.
fn mapped(m: &DAffine3, corner: DVec3, edges: [DVec3; 2], flips: bool) -> Patch {
    let mut edges = edges.map(|e| m.transform_vector3(e));
    if flips {
        edges.swap(0, 1);
    }
    Patch::parallelogram(m.transform_point3(corner), edges)
}

impl PatchSample {
    /// A position drawn by area, as the receiver `from` has it; `None` where it is seen edge on.
    #[inline]
    pub(crate) fn seen_from(self, from: Vec3) -> Option<PatchDirection> {
        let PatchSample { at, pdf_area } = self;
        let (pdf, wi) = seen_from(pdf_area, from, at.p, at.n)?;
        Some(PatchDirection { at, wi, pdf })
    }
}

/// Density per solid angle at `from` of a density per area at `p`; `None` where the position is seen edge on.
#[inline]
pub(crate) fn per_solid_angle(pdf_area: f32, from: Vec3, p: Vec3, n: Vec3) -> Option<f32> {
    seen_from(pdf_area, from, p, n).map(|(pdf, _)| pdf)
}

/// The same with the unit direction from `from` to `p`.
#[inline]
fn seen_from(pdf_area: f32, from: Vec3, p: Vec3, n: Vec3) -> Option<(f32, Vec3)> {
    let to = p - from;
    let distance2 = to.length_squared();
    let wi = to * (1.0 / distance2.sqrt());
    let pdf = pdf_area * distance2 / wi.dot(n).abs();
    (pdf.is_finite() && pdf > 0.0).then_some((pdf, wi))
}

/// A patch projected to the unit sphere around a point.
enum SphericalProjection {
    Triangle(SphericalTriangle),
    Rectangle(SphericalRectangle),
    /// The two triangles of a parallelogram.
    Halves([SphericalTriangle; 2]),
    Cap(SphericalCap),
    /// A sphere from inside.
    Around,
}

impl SphericalProjection {
    fn solid_angle(&self) -> f64 {
        match self {
            SphericalProjection::Triangle(view) => view.solid_angle(),
            SphericalProjection::Rectangle(view) => view.solid_angle(),
            SphericalProjection::Halves([a, b]) => a.solid_angle() + b.solid_angle(),
            SphericalProjection::Cap(view) => view.solid_angle(),
            SphericalProjection::Around => SPHERE,
        }
    }

    /// A position of `patch` whose direction from `o` is uniform over the view.
    fn sample(&self, o: DVec3, u: Vec2, patch: &Patch) -> Option<DVec3> {
        match self {
            SphericalProjection::Triangle(view) => onto_plane(o, view.sample(u), patch),
            SphericalProjection::Rectangle(view) => Some(o + view.sample(u)),
            SphericalProjection::Halves([a, b]) => {
                let share = (a.solid_angle() / self.solid_angle()) as f32;
                let (half, x) =
                    if u.x < share { (a, u.x / share) } else { (b, (u.x - share) / (1.0 - share)) };
                onto_plane(o, half.sample(Vec2::new(x.min(1.0f32.next_down()), u.y)), patch)
            }
            SphericalProjection::Cap(view) => patch.along(o, view.sample(u), -1.0),
            SphericalProjection::Around => patch.along(o, on_unit_sphere(u.x.into(), u.y.into()), 1.0),
        }
    }
}

/// Where the ray from `o` along `d` meets the plane of a flat patch.
fn onto_plane(o: DVec3, d: DVec3, patch: &Patch) -> Option<DVec3> {
    let corner = match patch {
        Patch::Triangle([a, ..]) => *a,
        Patch::Quad(quad) => quad.corner,
        // Rectangles and round patches have their points at once.
        _ => return None,
    };
    let n = patch.normal()?;
    let t = n.dot(corner - o) / n.dot(d);
    (t.is_finite() && t > 0.0).then(|| o + t * d)
}

impl QuadPatch {
    fn halves(&self) -> [[DVec3; 3]; 2] {
        let QuadPatch { corner: p, edges: [a, b] } = *self;
        [[p, p + a, p + a + b], [p, p + a + b, p + b]]
    }
}

impl DiskPatch {
    fn area(&self) -> f64 {
        PI * (1.0 - self.inner * self.inner) * self.axes[0].cross(self.axes[1]).length()
    }

    fn point(&self, x: f64, y: f64) -> DVec3 {
        let inner2 = self.inner * self.inner;
        let (r, phi) = ((inner2 + x * (1.0 - inner2)).sqrt(), TAU * y);
        self.center + r * (fmath::cos64(phi) * self.axes[0] + fmath::sin64(phi) * self.axes[1])
    }
}

impl CurvedPatch {
    /// Area by the midpoint rule over the surface's own coordinates.
    fn measured_area(&self) -> f64 {
        const STEPS: u32 = 128;
        let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS);
        let places = (0..STEPS * STEPS).map(|i| self.canonical(middle(i / STEPS), middle(i % STEPS)));
        let mean: f64 = places.map(|q| self.stretch(q)).sum::<f64>() / f64::from(STEPS * STEPS);
        mean * self.canonical_area()
    }

    fn canonical_area(&self) -> f64 {
        match self.surface {
            Canonical::Sphere => 4.0 * PI,
            Canonical::Frustum([r0, r1]) => PI * (r0 + r1) * (1.0 + (r1 - r0) * (r1 - r0)).sqrt(),
            Canonical::Torus { minor, widest } => 2.0 * TAU * minor * tube_area(minor, widest),
        }
    }

    /// A position of the canonical surface, uniform over its area.
    fn canonical(&self, x: f64, y: f64) -> DVec3 {
        match self.surface {
            Canonical::Sphere => on_unit_sphere(x, y),
            Canonical::Frustum([r0, r1]) => {
                let r = (r0 * r0 + x * (r1 * r1 - r0 * r0)).max(0.0).sqrt();
                let z = if r1 == r0 { x } else { (r - r0) / (r1 - r0) };
                DVec3::new(r * fmath::cos64(TAU * y), r * fmath::sin64(TAU * y), z)
            }
            Canonical::Torus { minor, widest } => on_torus(minor, angle_of_tube(minor, widest, x), TAU * y),
        }
    }

    /// See [`Patch::sample_area`].
    fn sample_area(&self, u: Vec2) -> Option<PatchSample> {
        let p = self.map.transform_point3(self.canonical(u.x.into(), u.y.into()));
        let at = self.placed_point(p);
        let pdf_area = self.pdf_area(at.p.as_dvec3()) as f32;
        (pdf_area.is_finite() && pdf_area > 0.0).then_some(PatchSample { at, pdf_area })
    }

    fn placed_point(&self, p: DVec3) -> PatchPoint {
        let single = p.as_vec3();
        let p_error = gamma(4) * (single.abs() + self.reach());
        PatchPoint { p: single, p_error, n: self.normal(p).as_vec3() }
    }

    fn reach(&self) -> Vec3 {
        let bounds = self.bounds();
        bounds.max.abs().max(bounds.min.abs())
    }

    fn canonical_normal(&self, q: DVec3) -> DVec3 {
        match self.surface {
            Canonical::Sphere => q.normalize_or(DVec3::Z),
            Canonical::Frustum([r0, r1]) => {
                let out = DVec3::new(q.x, q.y, 0.0).normalize_or(DVec3::X);
                (out + (r0 - r1) * DVec3::Z).normalize()
            }
            Canonical::Torus { .. } => {
                let out = DVec3::new(q.x, q.y, 0.0).normalize_or(DVec3::X);
                (q - out).normalize_or(out)
            }
        }
    }

    /// How much area the map makes of area at a position of the canonical surface.
    fn stretch(&self, q: DVec3) -> f64 {
        let normal = self.inverse.matrix3.transpose() * self.canonical_normal(q);
        self.map.matrix3.determinant().abs() * normal.length()
    }

    fn normal(&self, p: DVec3) -> DVec3 {
        let q = self.inverse.transform_point3(p);
        (self.inverse.matrix3.transpose() * self.canonical_normal(q)).normalize_or(DVec3::Z)
    }

    fn pdf_area(&self, p: DVec3) -> f64 {
        1.0 / (self.canonical_area() * self.stretch(self.inverse.transform_point3(p)))
    }

    fn bounds(&self) -> Aabb {
        let m = &self.map.matrix3;
        let around = |center: DVec3, reach: DVec3| Aabb {
            min: (center - reach).as_vec3(),
            max: (center + reach).as_vec3(),
        };
        let rows = m.transpose();
        let of_ball = DVec3::new(rows.x_axis.length(), rows.y_axis.length(), rows.z_axis.length());
        match self.surface {
            Canonical::Sphere => around(self.map.translation, of_ball),
            Canonical::Torus { minor, .. } => {
                around(self.map.translation, ellipse_reach([m.x_axis, m.y_axis]) + minor * of_ball)
            }
            Canonical::Frustum([r0, r1]) => {
                let reach = ellipse_reach([m.x_axis, m.y_axis]);
                around(self.map.translation, r0 * reach)
                    .union(around(self.map.translation + m.z_axis, r1 * reach))
            }
        }
    }
}

/// A position on the unit sphere, uniform over it.
fn on_unit_sphere(x: f64, y: f64) -> DVec3 {
    let z = 1.0 - 2.0 * x;
    let (r, phi) = ((1.0 - z * z).max(0.0).sqrt(), TAU * y);
    DVec3::new(r * fmath::cos64(phi), r * fmath::sin64(phi), z)
}

/// The point of a torus around z at an angle around its tube, from the outermost circle, and one around the axis.
pub(super) fn on_torus(minor: f64, around_tube: f64, around_axis: f64) -> DVec3 {
    let (sin, cos) = fmath::sincos64(around_tube);
    let (sin_axis, cos_axis) = fmath::sincos64(around_axis);
    let r = 1.0 + minor * cos;
    DVec3::new(r * cos_axis, r * sin_axis, minor * sin)
}

/// Area of a tube around the unit circle up to an angle from its outermost circle, in units of `2 pi r`.
fn tube_area(minor: f64, angle: f64) -> f64 {
    angle + minor * fmath::sin64(angle)
}

/// The angle below which a share `x` of a tube's area lies: Newton's method, kept within its bracket.
fn angle_of_tube(minor: f64, widest: f64, x: f64) -> f64 {
    const MOST_STEPS: u32 = 60;
    let target = (2.0 * x - 1.0) * tube_area(minor, widest);
    let (mut lo, mut hi) = (-widest, widest);
    let mut angle = lo + x * (hi - lo);
    for _ in 0..MOST_STEPS {
        let excess = tube_area(minor, angle) - target;
        if excess < 0.0 {
            lo = angle;
        } else {
            hi = angle;
        }
        let newton = angle - excess / (1.0 + minor * fmath::cos64(angle));
        let next = if newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
        if (next - angle).abs() <= 1e-15 * widest {
            return next;
        }
        angle = next;
    }
    angle
}

/// How far an ellipse with these half axes reaches along each coordinate.
fn ellipse_reach([a, b]: [DVec3; 2]) -> DVec3 {
    (a * a + b * b).map(f64::sqrt)
}

/// The factor of a map that keeps all angles, if it does.
fn scale_of_similarity(m: &DMat3) -> Option<f64> {
    let columns = [m.x_axis, m.y_axis, m.z_axis];
    let scale2 = columns[0].length_squared();
    let same = |v: f64, expected: f64| (v - expected).abs() <= 1e-9 * scale2;
    let keeps =
        (0..3).all(|i| (0..3).all(|j| same(columns[i].dot(columns[j]), if i == j { scale2 } else { 0.0 })));
    keeps.then(|| scale2.sqrt())
}
