//! Affine maps between two spaces, with both directions at hand.

use crate::{Aabb, Affine3A, DAffine3, Ray, Vec3};

/// An invertible affine map `world_from_object`.
///
/// Composed and inverted in double precision, stored in single. The fourth row of a matrix
/// is never used, as in the classic format.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Object space to world space.
    pub world_from_object: Affine3A,
    /// World space to object space.
    pub object_from_world: Affine3A,
}

impl Transform {
    /// The map that changes nothing.
    pub const IDENTITY: Transform =
        Transform { world_from_object: Affine3A::IDENTITY, object_from_world: Affine3A::IDENTITY };

    /// The map `m`, or `None` when it has no finite inverse.
    pub fn new(m: &DAffine3) -> Option<Transform> {
        let transform = Transform::of_invertible(m);
        let finite = transform.world_from_object.is_finite() && transform.object_from_world.is_finite();
        (finite && m.matrix3.determinant() != 0.0).then_some(transform)
    }

    /// The map `m`, which is known to have a finite inverse.
    #[inline]
    pub fn of_invertible(m: &DAffine3) -> Transform {
        Transform { world_from_object: single(m), object_from_world: single(&m.inverse()) }
    }

    /// Whether this is exactly the identity.
    pub fn is_identity(&self) -> bool {
        self.world_from_object == Affine3A::IDENTITY
    }

    /// Whether the map turns right-handed into left-handed.
    pub fn mirrors(&self) -> bool {
        self.world_from_object.matrix3.determinant() < 0.0
    }

    /// The ray in object space. The direction is not normalised: `t` keeps its meaning.
    #[inline]
    pub fn ray_in_object(&self, ray: &Ray) -> Ray {
        Ray {
            o: self.object_from_world.transform_point3(ray.o),
            d: self.object_from_world.transform_vector3(ray.d),
            ..*ray
        }
    }

    /// A point in world space.
    #[inline]
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.world_from_object.transform_point3(p)
    }

    /// A direction in world space.
    #[inline]
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.world_from_object.transform_vector3(v)
    }

    /// A unit normal in world space, by the inverse transpose; never flipped.
    #[inline]
    pub fn normal(&self, n: Vec3) -> Vec3 {
        let m = &self.object_from_world.matrix3;
        let v: Vec3 = (m.transpose() * crate::Vec3A::from(n)).into();
        v.normalize_or(n)
    }

    /// A box in world space around a box in object space.
    pub fn bounds(&self, b: &Aabb) -> Aabb {
        b.transformed(&self.world_from_object)
    }
}

fn single(m: &DAffine3) -> Affine3A {
    Affine3A::from_cols(
        m.matrix3.x_axis.as_vec3a(),
        m.matrix3.y_axis.as_vec3a(),
        m.matrix3.z_axis.as_vec3a(),
        m.translation.as_vec3a(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DVec3;

    #[test]
    fn normals_stay_perpendicular_and_rays_keep_t() {
        let m = DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0))
            * DAffine3::from_rotation_x(0.3)
            * DAffine3::from_scale(DVec3::new(2.0, -0.5, 3.0));
        let t = Transform::new(&m).unwrap();
        assert!(t.mirrors());
        let (tangent, n) = (Vec3::new(1.0, 1.0, 0.0), Vec3::new(1.0, -1.0, 0.0).normalize());
        assert!(t.vector(tangent).dot(t.normal(n)).abs() < 1e-6);
        let ray = Ray::new(Vec3::new(4.0, 5.0, 6.0), Vec3::new(0.1, 0.2, -1.0));
        let in_object = t.ray_in_object(&ray);
        assert!(t.point(in_object.at(2.0)).distance(ray.at(2.0)) < 1e-4);
    }

    #[test]
    fn singular_maps_are_refused() {
        assert!(Transform::new(&DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0))).is_none());
        assert!(Transform::new(&DAffine3::from_scale(DVec3::splat(f64::NAN))).is_none());
    }
}
