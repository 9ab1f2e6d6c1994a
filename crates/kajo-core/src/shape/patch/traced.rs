//! Surfaces that give light and are of no closed form: their points are found by rays.
//!
//! For a receiver a direction is drawn uniformly over the solid angle `W` that a sphere around the surface fills, over all
//! directions from within that sphere. Of the `n` points where the ray meets the surface one is chosen: the nearest one, which
//! hides the others unless light passes there, with the probability 7/8. Per solid angle
//!
//! ```text
//! p = q_k / W            q_0 = 7/8, q_k = 1 / (8 (n - 1))            q_0 = 1 where n = 1
//! ```
//!
//! Where a surface is long and thin most of such rays pass it by. So it may be known to lie along segments: see `cover.rs`.
//!
//! A ray that leaves begins with a line, uniform among those that meet the sphere of radius `R`: a direction, and a point of the
//! disk across it. Of the `n` points where the line meets the surface each is chosen alike, and light goes along the line. Of the
//! lines in `dw` those through an element `dA` of the surface have the density `|cos| dA dw / (4 pi . pi R^2)`, and each of two
//! directions is as good for light that leaves on both sides; so
//!
//! ```text
//! p(x, w) = |cos| / (4 pi^2 R^2) . 2 / (s n) = p_position |cos| / (s pi)            p_position = 1 / (2 pi R^2 n)
//! ```
//!
//! for `s` sides. The position's density depends on the direction by `n` alone, which is 2 for a convex body. The sum over all
//! points of a line instead of one of them has the density `1 / (2 pi R^2)` everywhere, hence the area of the surface
//!
//! ```text
//! A = 2 pi R^2 E[n]            [Cauchy 1850; Crofton 1868]
//! ```

use std::cell::RefCell;
use std::f64::consts::{PI, TAU};
use std::sync::{Arc, OnceLock};

use kajo_math::solid_angle::{SPHERE, SphericalCap, basis64};
use kajo_math::{Aabb, DAffine3, DMat3, DVec3, Ray, Transform, Vec2, Vec3, fmath, rng, sobol};

use super::cover::{self, CoverSegment, SegmentView};
use super::{PatchDirection, PatchPoint, PatchSample, on_unit_sphere, scale_of_similarity};
use crate::interaction::Hit;
use crate::shape::{AnyShape, ShapeId, Shapes};

/// Probability of the nearest of several points.
const NEAREST: f32 = 7.0 / 8.0;

/// What is nearer to the receiver than this share of the sphere's radius is not drawn: it may be the receiver.
const TOO_NEAR: f32 = 1e-4;

/// Lines that the area is measured with.
const LINES: u32 = 4096;

/// A surface whose points are found by rays, and its map to world space.
#[derive(Clone, Debug)]
pub struct TracedPatch {
    alone: Arc<Alone>,
    map: DAffine3,
    /// Around the surface, in its own space.
    center: DVec3,
    radius: f64,
    /// Segments that all of it lies along, where they are known.
    cover: Option<Arc<[CoverSegment]>>,
    /// Whether all points of a ray are drawn alike: where the nearest one may not be there.
    alike: bool,
    area: OnceLock<f64>,
}

/// A part of a shape.
#[derive(Debug)]
struct Alone {
    shapes: Shapes,
    id: ShapeId,
    part: u32,
}

/// The surface where it is at some moment.
pub struct PlacedTraced<'a> {
    patch: &'a TracedPatch,
    world_from_object: Transform,
    center: DVec3,
    radius: f64,
    /// How much longer the map makes vectors at most.
    stretch: f64,
    map: DAffine3,
}

thread_local! {
    /// Points of the ray at hand, by their parameters.
    static HITS: RefCell<Vec<Hit>> = const { RefCell::new(Vec::new()) };
}

impl TracedPatch {
    /// A part of a shape; `None` where there is nothing, or no end of it.
    ///
    /// * `shape`: cheap to clone
    pub fn new(shape: impl Into<AnyShape>, part: u32) -> Option<TracedPatch> {
        let mut shapes = Shapes::default();
        let id = shape.into().store(&mut shapes)?;
        let bounds = shapes.bounds(id);
        let usable = bounds.is_finite() && !bounds.is_empty();
        usable.then(|| TracedPatch {
            alone: Arc::new(Alone { shapes, id, part }),
            map: DAffine3::IDENTITY,
            center: bounds.center().as_dvec3(),
            radius: 0.5 * bounds.extent().as_dvec3().length(),
            cover: None,
            alike: false,
            area: OnceLock::new(),
        })
    }

    /// The same where all of it is known to lie in a smaller sphere.
    pub fn within(self, center: DVec3, radius: f64) -> TracedPatch {
        if radius < self.radius { TracedPatch { center, radius, ..self } } else { self }
    }

    /// The same where all of it is known to lie along some of these segments.
    pub fn covered_by(self, segments: &[CoverSegment]) -> TracedPatch {
        TracedPatch { cover: (!segments.is_empty()).then(|| Arc::from(segments)), ..self }
    }

    /// The same where a part of it may be missing, so that what is behind can be seen.
    pub(super) fn all_alike(self) -> TracedPatch {
        TracedPatch { alike: true, ..self }
    }

    /// The image under a map; `None` when that has no inverse.
    pub(super) fn mapped(&self, m: &DAffine3) -> Option<TracedPatch> {
        let map = *m * self.map;
        Transform::new(&map)?;
        Some(TracedPatch { map, area: OnceLock::new(), ..self.clone() })
    }

    /// Area of one side.
    pub(super) fn area(&self) -> f64 {
        *self.area.get_or_init(|| self.placed(None).measured_area())
    }

    /// A box around it.
    pub(super) fn bounds(&self) -> Aabb {
        let PlacedTraced { world_from_object, .. } = self.placed(None);
        world_from_object.bounds(&self.alone.shapes.bounds(self.alone.id))
    }

    /// It as it is after a move.
    pub(super) fn placed(&self, moved: Option<&DAffine3>) -> PlacedTraced<'_> {
        let map = moved.map_or(self.map, |m| *m * self.map);
        let stretch = scale_of_similarity(&map.matrix3).unwrap_or_else(|| largest_stretch(&map.matrix3));
        PlacedTraced {
            patch: self,
            world_from_object: Transform::of_invertible(&map),
            center: map.transform_point3(self.center),
            radius: stretch * self.radius,
            stretch,
            map,
        }
    }
}

/// How much longer a map makes vectors at most, and a little more than rounding: the root of the largest eigenvalue of `mᵀ m` [Smith 1961].
fn largest_stretch(m: &DMat3) -> f64 {
    let a = m.transpose() * *m;
    let trace = |m: &DMat3| m.x_axis.x + m.y_axis.y + m.z_axis.z;
    let mean = trace(&a) / 3.0;
    let rest = a - DMat3::from_diagonal(DVec3::splat(mean));
    let p = (trace(&(rest * rest)) / 6.0).max(0.0).sqrt();
    let cos = if p > 0.0 { (0.5 * (rest * (1.0 / p)).determinant()).clamp(-1.0, 1.0) } else { 0.0 };
    (mean + 2.0 * p * fmath::cos64(fmath::acos64(cos) / 3.0)).sqrt() * (1.0 + 1e-7)
}

impl PlacedTraced<'_> {
    /// See [`Patch::sample`].
    pub(super) fn sample(&self, from: Vec3, u: Vec2) -> Option<PatchDirection> {
        let (wi, pdf_direction) = self.sample_direction(from, u)?;
        let wi = wi.as_vec3();
        let ray = Ray::new(from, wi).over(self.too_near(), f32::INFINITY);
        let (k, n, hit) = self.with_hits(&ray, |hits| {
            let k = self.choose(hits.len(), hashed_uniform([u.x, u.y]))?;
            Some((k, hits.len(), hits[k]))
        })?;
        let at = self.at(&ray, &hit);
        let pdf = self.probability(k, n) * pdf_direction;
        Some(PatchDirection { at, wi: (at.p - from).normalize_or(wi), pdf })
    }

    /// See [`Patch::pdf`].
    pub(super) fn pdf(&self, from: Vec3, p: Vec3) -> f32 {
        let distance = from.distance(p);
        if distance < self.too_near() {
            return 0.0;
        }
        let wi = (p - from) / distance;
        let ray = Ray::new(from, wi).over(self.too_near(), f32::INFINITY);
        let (k, n) = self.with_hits(&ray, |hits| {
            let off = |hit: &Hit| (hit.t - distance).abs();
            let nearest = (0..hits.len()).min_by(|&a, &b| off(&hits[a]).total_cmp(&off(&hits[b])));
            (nearest.unwrap_or(0), hits.len().max(1))
        });
        self.probability(k, n) * self.pdf_direction(from, wi.as_dvec3().normalize())
    }

    /// A unit direction from `from` into which the surface may be, and its density per solid angle.
    fn sample_direction(&self, from: Vec3, u: Vec2) -> Option<(DVec3, f32)> {
        if let Some(cover) = &self.patch.cover {
            return cover::sample(self.views(cover, from), from, u);
        }
        let cap = self.cap(from);
        let wi = cap.as_ref().map_or_else(|| on_unit_sphere(u.x.into(), u.y.into()), |cap| cap.sample(u));
        Some((wi, 1.0 / solid_angle(cap.as_ref())))
    }

    /// Density per solid angle with which [`PlacedTraced::sample_direction`] draws the unit direction `wi` of a point of the surface.
    fn pdf_direction(&self, from: Vec3, wi: DVec3) -> f32 {
        match &self.patch.cover {
            Some(cover) => cover::pdf(self.views(cover, from), from, wi),
            None => 1.0 / solid_angle(self.cap(from).as_ref()),
        }
    }

    /// The segments as a point sees them.
    fn views<'a>(
        &'a self,
        cover: &'a [CoverSegment],
        from: Vec3,
    ) -> impl Iterator<Item = SegmentView> + Clone + 'a {
        cover.iter().map(move |segment| segment.mapped(&self.map, self.stretch).seen_from(from.as_dvec3()))
    }

    /// A position sampled with a direction through it, independently of any receiver; see the head of the file.
    pub(crate) fn sample_line(&self, position: Vec2, direction: Vec2) -> Option<(PatchSample, Vec3)> {
        let (o, d) = self.line(position, direction);
        let ray = Ray::new(o, d).over(f32::NEG_INFINITY, f32::INFINITY);
        let u = hashed_uniform([position.x, position.y, direction.x, direction.y]);
        let (n, hit) = self.with_hits(&ray, |hits| {
            let n = hits.len();
            (n > 0).then(|| (n, hits[((u * n as f32) as usize).min(n - 1)]))
        })?;
        Some((PatchSample { at: self.at(&ray, &hit), pdf_area: self.pdf_of_line(n) }, d))
    }

    /// The density per area with which [`PlacedTraced::sample_line`] draws the position `p` on the line along `d`.
    pub(crate) fn pdf_line(&self, p: Vec3, d: Vec3) -> f32 {
        let line = Ray::new(p, d).over(f32::NEG_INFINITY, f32::INFINITY);
        self.pdf_of_line(self.with_hits(&line, |hits| hits.len().max(1)))
    }

    fn pdf_of_line(&self, n: usize) -> f32 {
        (1.0 / (TAU * self.radius * self.radius * n as f64)) as f32
    }

    /// A line through the sphere: its point that is nearest to the centre, and its direction.
    fn line(&self, position: Vec2, direction: Vec2) -> (Vec3, Vec3) {
        let d = on_unit_sphere(direction.x.into(), direction.y.into());
        let (x, y) = basis64(d);
        let r = self.radius * f64::from(position.x).sqrt();
        let (sin, cos) = fmath::sincos64(TAU * f64::from(position.y));
        ((self.center + r * (cos * x + sin * y)).as_vec3(), d.as_vec3())
    }

    fn measured_area(&self) -> f64 {
        let pair = |i: u32, seeds: [u32; 2]| {
            let [x, y] = sobol::scrambled_point(i, seeds);
            Vec2::new(rng::unit(x), rng::unit(y))
        };
        let mut met = 0;
        for i in 0..LINES {
            let (o, d) = self.line(pair(i, [1, 2]), pair(sobol::shuffle(i, 3), [4, 5]));
            let ray = Ray::new(o, d).over(f32::NEG_INFINITY, f32::INFINITY);
            met += self.with_hits(&ray, |hits| hits.len());
        }
        2.0 * PI * self.radius * self.radius * met as f64 / f64::from(LINES)
    }

    /// `f` of all points of a ray, the nearest first.
    fn with_hits<T>(&self, ray: &Ray, f: impl FnOnce(&[Hit]) -> T) -> T {
        let own = self.world_from_object.ray_in_object(ray);
        let Alone { shapes, id, part } = &*self.patch.alone;
        HITS.with_borrow_mut(|hits| {
            hits.clear();
            shapes.crossings(*id, &own, &mut |hit| {
                if hit.part == *part {
                    hits.push(hit);
                }
            });
            hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t));
            f(hits)
        })
    }

    /// The position of a hit.
    fn at(&self, ray: &Ray, hit: &Hit) -> PatchPoint {
        let Alone { shapes, id, .. } = &*self.patch.alone;
        let point = shapes
            .surface_at(*id, &self.world_from_object.ray_in_object(ray), hit)
            .transformed(&self.world_from_object);
        PatchPoint { p: point.p, p_error: point.p_error, n: point.ng }
    }

    /// Which of `n` points a number in [0, 1) chooses.
    fn choose(&self, n: usize, u: f32) -> Option<usize> {
        let among = |n: usize, u: f32| ((u * n as f32) as usize).min(n - 1);
        match n {
            0 => None,
            1 => Some(0),
            _ if self.patch.alike => Some(among(n, u)),
            _ if u < NEAREST => Some(0),
            _ => Some(1 + among(n - 1, (u - NEAREST) / (1.0 - NEAREST))),
        }
    }

    /// The probability with which [`PlacedTraced::choose`] chooses point `k` of `n`.
    fn probability(&self, k: usize, n: usize) -> f32 {
        match (k, n) {
            (_, 1) => 1.0,
            _ if self.patch.alike => 1.0 / n as f32,
            (0, _) => NEAREST,
            _ => (1.0 - NEAREST) / (n - 1) as f32,
        }
    }

    /// How the sphere is seen; `None` from within.
    fn cap(&self, from: Vec3) -> Option<SphericalCap> {
        SphericalCap::new(from.as_dvec3(), self.center, self.radius)
    }

    fn too_near(&self) -> f32 {
        TOO_NEAR * self.radius as f32
    }
}

fn solid_angle(cap: Option<&SphericalCap>) -> f32 {
    cap.map_or(SPHERE, SphericalCap::solid_angle) as f32
}

/// Another uniform number in [0, 1), a hash of these.
pub(super) fn hashed_uniform<const N: usize>(numbers: [f32; N]) -> f32 {
    let key = numbers.iter().fold(rng::Key::new(0), |key, u| key.part([u.to_bits(), 0]));
    let [bits, ..] = key.words([0, 0]);
    rng::unit(bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_stretch_is_reached() {
        let turns = DMat3::from_rotation_x(0.4) * DMat3::from_rotation_z(1.1);
        for scales in [DVec3::new(0.5, 3.0, 1.0), DVec3::ONE, DVec3::new(2.0, 2.0, 0.1)] {
            let m = turns * DMat3::from_diagonal(scales) * DMat3::from_rotation_y(0.3);
            let (found, expected) = (largest_stretch(&m), scales.max_element());
            assert!((0.0..2e-7).contains(&(found / expected - 1.0)), "{found} for {expected}");
        }
    }
}
