//! Where a ray meets a surface.

use kajo_math::{
    DVec3, Ray, Transform, Vec2, Vec3, Vec3A,
    robust::{gamma, offset_origin},
};

/// The cheap record of a hit that traversal keeps: enough to work the rest out for the winner.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hit {
    /// Ray parameter.
    pub t: f32,
    /// First parameter within the part, a barycentric coordinate for triangles.
    pub u: f32,
    /// Second parameter within the part.
    pub v: f32,
    /// Which part of the shape was hit: the triangle of a mesh, the face of a box, the side or a cap.
    pub part: u32,
}

/// Position and orientation of a surface at a hit.
#[derive(Clone, Copy, Debug, Default)]
pub struct SurfacePoint {
    /// The point, brought back onto the surface as exactly as single precision allows.
    pub p: Vec3,
    /// Bound on the absolute error of each coordinate of `p`.
    pub p_error: Vec3,
    /// Unit shading normal, outward; never turned towards the viewer.
    pub n: Vec3,
    /// Unit geometric normal, outward.
    pub ng: Vec3,
}

impl SurfacePoint {
    /// A point of a surface whose shading and geometric normals agree.
    pub(crate) fn flat(p: Vec3, p_error: Vec3, n: Vec3) -> SurfacePoint {
        SurfacePoint { p, p_error, n, ng: n }
    }

    /// The same point in world space.
    pub fn transformed(&self, t: &Transform) -> SurfacePoint {
        let p = t.point(self.p);
        // The error that the map makes of the old one, its own rounding, and the rounding of
        // the way back that a ray leaving from here takes into object space.
        let there = |v: Vec3| Vec3::from(t.world_from_object.matrix3.abs() * Vec3A::from(v));
        let back = |v: Vec3| Vec3::from(t.object_from_world.matrix3.abs() * Vec3A::from(v));
        let [t1, t2] = [&t.world_from_object, &t.object_from_world].map(|m| Vec3::from(m.translation.abs()));
        let return_error = gamma(4) * (back(p.abs()) + t2);
        let p_error =
            (1.0 + gamma(4)) * there(self.p_error + return_error) + gamma(4) * (there(self.p.abs()) + t1);
        SurfacePoint { p, p_error, n: t.normal(self.n), ng: t.normal(self.ng) }
    }
}

/// Where pictures are laid on a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceUv {
    /// Surface coordinates.
    pub first: Vec2,
    /// A second set of them; those of the first where there is none.
    pub second: Vec2,
}

impl From<Vec2> for SurfaceUv {
    fn from(uv: Vec2) -> SurfaceUv {
        SurfaceUv { first: uv, second: uv }
    }
}

impl SurfaceUv {
    /// The place that is this step away in both sets of coordinates.
    pub fn moved(self, step: Vec2) -> SurfaceUv {
        SurfaceUv { first: self.first + step, second: self.second + step }
    }
}

/// How the position changes with surface coordinates.
///
/// Zero where there are no coordinates, and where a coordinate has no direction, as at the poles of a sphere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tangents {
    /// Derivative by the first coordinate.
    pub dpdu: Vec3,
    /// Derivative by the second coordinate.
    pub dpdv: Vec3,
}

impl Tangents {
    /// Those of the affine map that takes the coordinates `uvs` to the corners of a triangle.
    pub(crate) fn of_triangle(corners: [DVec3; 3], uvs: [Vec2; 3]) -> Tangents {
        let [a, b, c] = uvs.map(Vec2::as_dvec2);
        let (e1, e2) = (corners[1] - corners[0], corners[2] - corners[0]);
        let (s1, s2) = (b - a, c - a);
        let area = s1.perp_dot(s2);
        let [dpdu, dpdv] = [(s2.y * e1 - s1.y * e2) / area, (s1.x * e2 - s2.x * e1) / area];
        let usable = dpdu.is_finite() && dpdv.is_finite();
        if usable { Tangents { dpdu: dpdu.as_vec3(), dpdv: dpdv.as_vec3() } } else { Tangents::default() }
    }

    /// The same in world space.
    pub fn transformed(&self, t: &Transform) -> Tangents {
        Tangents { dpdu: t.vector(self.dpdu), dpdv: t.vector(self.dpdv) }
    }
}

/// How rays that leave a surface keep clear of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RayOffset {
    /// Origins outside the error bound of the point, hits from there on. Right at every scale.
    #[default]
    Auto,
    /// Besides that, hits nearer than 0.001 are ignored, as in the reference program.
    Reference,
}

impl SurfacePoint {
    /// A ray that leaves this point in direction `d` and ends before `t_max`.
    #[inline]
    pub fn ray_towards(&self, d: Vec3, t_max: f32, time: f32, offset: RayOffset) -> Ray {
        let t_min = match offset {
            RayOffset::Auto => 0.0,
            RayOffset::Reference => 1e-3,
        };
        Ray { o: offset_origin(self.p, self.p_error, self.ng, d), t_min, d, t_max, time }
    }
}

/// How uncertain the test of a triangle in single precision is, for one that is as large as this seen from the ray's
/// origin: ten roundings.
#[inline]
pub(crate) fn test_error(extent: f32) -> f32 {
    gamma(10) * extent + f32::MIN_POSITIVE
}

/// Texture coordinates of a surface that has none of its own.
pub(crate) const NO_UV: Vec2 = Vec2::ZERO;
