//! Long and thin surfaces as a point sees them: along segments.
//!
//! All points of a surface are within some distance of one of a few segments. From outside such a round-ended cylinder is seen through a
//! rectangle between the two lines in which planes through the point touch it; see `silhouette.rs`, of which this is the case of
//! `r(z) = r`, longer by the radius at both ends. From near its axis it is seen within the cap of a sphere, or all around. A segment is chosen by
//! its solid angle `W_i`, or about that, and directions have the density
//!
//! ```text
//! p(w) = sum W_i p_i(w) / sum W_i
//! ```
//!
//! over the segments in whose views they are.

use kajo_math::solid_angle::{Rectangle, SPHERE, SphericalCap};
use kajo_math::{DAffine3, DVec3, Vec2, Vec3};

use super::{Patch, on_unit_sphere};

/// From nearer than this many radii to the axis there is no rectangle of use.
const NEAR: f64 = 1.05;

/// Where a part of a surface is, in its own space.
#[derive(Clone, Copy, Debug)]
pub struct CoverSegment {
    /// The ends.
    pub ends: [DVec3; 2],
    /// The largest distance of its points from the segment.
    pub radius: f64,
}

/// Directions in which the part may be.
#[derive(Clone, Debug)]
pub(super) enum SegmentView {
    Rectangle { rectangle: Rectangle, weight: f64 },
    Cap(SphericalCap),
    Around,
}

impl CoverSegment {
    /// The segment between two points, around the convex hull of balls, given by their centres and radii.
    pub fn around(ends: [DVec3; 2], balls: impl Iterator<Item = (DVec3, f64)>) -> CoverSegment {
        let [a, b] = ends;
        let reach = |(p, r): (DVec3, f64)| {
            let along = (p - a).dot(b - a) / a.distance_squared(b);
            let along = if along.is_finite() { along.clamp(0.0, 1.0) } else { 0.0 };
            p.distance(a + along * (b - a)) + r
        };
        // Distances from a segment are convex: none in the hull is larger.
        CoverSegment { ends, radius: balls.map(reach).fold(0.0, f64::max) * (1.0 + 1e-6) }
    }

    /// The image under a map.
    ///
    /// * `stretch`: how much longer the map makes vectors at most
    pub(super) fn mapped(&self, map: &DAffine3, stretch: f64) -> CoverSegment {
        CoverSegment { ends: self.ends.map(|p| map.transform_point3(p)), radius: stretch * self.radius }
    }

    /// It as the point `o` sees it.
    pub(super) fn seen_from(&self, o: DVec3) -> SegmentView {
        self.rectangle(o).unwrap_or_else(|| {
            let [a, b] = self.ends;
            let cap = SphericalCap::new(o, 0.5 * (a + b), 0.5 * a.distance(b) + self.radius);
            cap.map_or(SegmentView::Around, SegmentView::Cap)
        })
    }

    fn rectangle(&self, o: DVec3) -> Option<SegmentView> {
        let [a, b] = self.ends;
        let (length, r) = (a.distance(b), self.radius);
        let axis = (b - a) / length;
        let along = (o - a).dot(axis);
        let off = o - a - along * axis;
        let distance = off.length();
        if !(distance > NEAR * r && axis.is_finite()) {
            return None;
        }
        let cos = r / distance;
        let x = off / distance;
        let y = axis.cross(x);
        let (mut lo, mut hi) = (-r, length + r);
        for (end, t) in [(-r, 1.0 + cos), (-r, 1.0 - cos), (length + r, 1.0 + cos), (length + r, 1.0 - cos)] {
            let z = along + t * (end - along);
            (lo, hi) = (lo.min(z), hi.max(z));
        }
        let half_width = r * (1.0 - cos * cos).sqrt();
        let corner = a + r * cos * x - half_width * y + lo * axis;
        let rectangle = Rectangle::new(corner, [2.0 * half_width * y, (hi - lo) * axis])?;
        let patch = Patch::Rectangle(rectangle);
        let weight = patch.view(o).map_or_else(
            || {
                let to = rectangle.middle() - o;
                rectangle.area() * to.dot(rectangle.normal()).abs() / (to.length_squared() * to.length())
            },
            |view| view.solid_angle(),
        );
        (weight > 0.0 && weight.is_finite()).then_some(SegmentView::Rectangle { rectangle, weight })
    }
}

impl SegmentView {
    fn weight(&self) -> f64 {
        match self {
            SegmentView::Rectangle { weight, .. } => *weight,
            SegmentView::Cap(cap) => cap.solid_angle(),
            SegmentView::Around => SPHERE,
        }
    }

    /// A unit direction from `from`.
    fn sample(&self, from: Vec3, u: Vec2) -> Option<DVec3> {
        match self {
            SegmentView::Rectangle { rectangle, .. } => {
                let at = Patch::Rectangle(*rectangle).sample(from, u)?.at.p;
                (at.as_dvec3() - from.as_dvec3()).try_normalize()
            }
            SegmentView::Cap(cap) => Some(cap.sample(u)),
            SegmentView::Around => Some(on_unit_sphere(u.x.into(), u.y.into())),
        }
    }

    /// Density per solid angle at `from` with which the unit direction `wi` is drawn.
    fn pdf(&self, from: Vec3, wi: DVec3) -> f64 {
        match self {
            SegmentView::Rectangle { rectangle, .. } => {
                let (o, n) = (from.as_dvec3(), rectangle.normal());
                let t = n.dot(rectangle.corner() - o) / n.dot(wi);
                let p = o + t * wi;
                let within = rectangle.edges().iter().all(|edge| {
                    let along = (p - rectangle.corner()).dot(*edge) / edge.length_squared();
                    (0.0..=1.0).contains(&along)
                });
                let patch = Patch::Rectangle(*rectangle);
                if t > 0.0 && within { patch.pdf(from, p.as_vec3(), n.as_vec3()).into() } else { 0.0 }
            }
            SegmentView::Cap(cap) => {
                if cap.contains(wi) {
                    1.0 / cap.solid_angle()
                } else {
                    0.0
                }
            }
            SegmentView::Around => 1.0 / SPHERE,
        }
    }
}

/// A unit direction from `from` into one of the views, and its density per solid angle.
pub(super) fn sample(
    views: impl Iterator<Item = SegmentView> + Clone,
    from: Vec3,
    u: Vec2,
) -> Option<(DVec3, f32)> {
    let sum: f64 = views.clone().map(|view| view.weight()).sum();
    let mut rest = f64::from(u.x) * sum;
    let mut chosen = None;
    for view in views.clone() {
        let weight = view.weight();
        let x = (rest / weight) as f32;
        chosen = Some((view, x.min(1.0f32.next_down())));
        if rest < weight {
            break;
        }
        rest -= weight;
    }
    let (view, x) = chosen?;
    let wi = view.sample(from, Vec2::new(x, u.y))?;
    let pdf = pdf(views, from, wi);
    (pdf > 0.0).then_some((wi, pdf))
}

/// Density per solid angle with which [`sample`] draws the unit direction `wi`.
pub(super) fn pdf(views: impl Iterator<Item = SegmentView>, from: Vec3, wi: DVec3) -> f32 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for view in views {
        let weight = view.weight();
        weights += weight;
        sum += weight * view.pdf(from, wi);
    }
    (sum / weights) as f32
}
