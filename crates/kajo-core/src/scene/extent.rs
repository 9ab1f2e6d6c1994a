//! How far things reach: the point of some objects that lies farthest in a direction, which is all that is asked of a
//! convex hull.
//!
//! A ball answers by its centre and radius, a mesh by the farthest of its vertices, and things that move or are nested by
//! their boxes. Objects whose box cannot reach beyond what has been found are passed over.

use kajo_math::{Aabb, DAffine3, DMat3, DVec3, Vec3};

use super::Geometry;
use super::geometry::Primitive;
use crate::family::Pooled;
use crate::nested::Placement;
use crate::objects::Object;
use crate::shape::{Mesh, ShapeId, Shapes, Sphere, Tessellation};

/// What some objects of a scene reach to.
#[derive(Debug)]
pub struct Extent<'a> {
    bodies: Vec<ExtentPart<'a>>,
}

#[derive(Debug)]
struct ExtentPart<'a> {
    /// World space.
    bounds: Aabb,
    form: Form<'a>,
}

#[derive(Debug)]
enum Form<'a> {
    /// The whole box.
    Box,
    /// The image of a ball.
    Ball { center: DVec3, radius: f64, map: DAffine3 },
    /// Points in a space of their own.
    Points { points: &'a [Vec3], map: DAffine3 },
    /// A shape that keeps no points.
    Shape { shapes: &'a Shapes, shape: ShapeId, map: DAffine3 },
}

impl Geometry {
    /// What the objects reach to that are wanted and have bounds.
    pub fn extent(&self, is_wanted: impl Fn(&Object<'_>) -> bool) -> Extent<'_> {
        let single = std::iter::zip(&self.primitives, self.objects.iter());
        let wanted =
            single.filter(|(_, object)| is_wanted(object)).map(|(primitive, _)| self.body(primitive));
        let nested = self
            .aggregate
            .nested()
            .into_iter()
            .flat_map(|nested| std::iter::zip(&nested.placements, nested.placement_bounds(&self.shapes)));
        // Names within a definition are those of many objects, so what places them is asked for by the first of each.
        let of_nested = |(placement, bounds): (&Placement, Aabb)| {
            let object = self.object(self.first_nested().after(placement.first))?;
            is_wanted(&object).then_some(ExtentPart { bounds, form: Form::Box })
        };
        let bodies = wanted.chain(nested.filter_map(of_nested));
        Extent { bodies: bodies.filter(|body| body.bounds.is_finite() && !body.bounds.is_empty()).collect() }
    }

    fn body(&self, primitive: &Primitive) -> ExtentPart<'_> {
        let bounds = self.world_bounds(primitive);
        let form = match primitive.pose.still_in(&self.transforms) {
            Some(transform) => self.form(primitive.shape, transform.world_from_object),
            None => Form::Box,
        };
        ExtentPart { bounds, form }
    }

    fn form(&self, shape: ShapeId, map: kajo_math::Affine3A) -> Form<'_> {
        let map = DAffine3::from_mat3_translation(
            DMat3::from_cols_array(&map.matrix3.to_cols_array().map(f64::from)),
            map.translation.as_dvec3(),
        );
        if let Some(ball) = Sphere::find(&self.shapes, shape) {
            return Form::Ball { center: ball.center.as_dvec3(), radius: ball.radius.into(), map };
        }
        if let Some(mesh) = Mesh::find(&self.shapes, shape) {
            return Form::Points { points: mesh.positions(), map };
        }
        Form::Shape { shapes: &self.shapes, shape, map }
    }
}

/// Segments of a full circle of shapes that are neither balls nor meshes: an arc rises above the line between two of its
/// points by a ten-thousandth of the radius.
const AROUND: u32 = 256;

impl Extent<'_> {
    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// A box around it all, in world space.
    pub fn bounds(&self) -> Aabb {
        self.bodies.iter().map(|body| body.bounds).fold(Aabb::EMPTY, Aabb::union)
    }

    /// The middle of its box.
    pub fn middle(&self) -> DVec3 {
        let bounds = self.bounds();
        0.5 * (bounds.min.as_dvec3() + bounds.max.as_dvec3())
    }

    /// The point that lies farthest in a direction of any length; the origin when there is nothing.
    pub fn farthest(&self, direction: DVec3) -> DVec3 {
        let mut best = (f64::NEG_INFINITY, DVec3::ZERO);
        for body in &self.bodies {
            let corner = corner(&body.bounds, direction);
            // Boxes are rounded outwards.
            if corner.dot(direction) <= best.0 {
                continue;
            }
            let p = body.form.farthest(direction).unwrap_or(corner);
            let reach = p.dot(direction);
            if reach > best.0 {
                best = (reach, p);
            }
        }
        best.1
    }

    /// What a camera is fitted to: these objects, or where there are none a ball of radius 1 around the origin.
    pub fn support(&self, direction: DVec3) -> DVec3 {
        if self.is_empty() { direction.normalize_or_zero() } else { self.farthest(direction) }
    }
}

impl Form<'_> {
    /// The farthest point in world space; `None` where only the box is known.
    fn farthest(&self, direction: DVec3) -> Option<DVec3> {
        let mut pieces = Tessellation::default();
        let (points, map) = match self {
            Form::Box => return None,
            Form::Ball { center, radius, map } => {
                let own = (map.matrix3.transpose() * direction).normalize_or_zero();
                return Some(map.transform_point3(*center + *radius * own));
            }
            Form::Points { points, map } => (*points, map),
            Form::Shape { shapes, shape, map } => {
                shapes.tessellate(*shape, AROUND, &mut pieces);
                (&*pieces.positions, map)
            }
        };
        let own = map.matrix3.transpose() * direction;
        let mut best = (f64::NEG_INFINITY, None);
        for p in points {
            let reach = p.as_dvec3().dot(own);
            if reach > best.0 {
                best = (reach, Some(p));
            }
        }
        best.1.map(|p| map.transform_point3(p.as_dvec3()))
    }
}

/// The corner of a box that lies farthest in a direction.
fn corner(bounds: &Aabb, direction: DVec3) -> DVec3 {
    let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    DVec3::select(direction.cmpgt(DVec3::ZERO), high, low)
}
