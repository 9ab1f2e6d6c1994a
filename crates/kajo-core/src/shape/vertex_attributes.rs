//! What vertices of a mesh have besides normals, texture coordinates and colours.

use kajo_math::{Vec2, Vec3, Vec4};

use crate::interaction::{Hit, Tangents};

/// Lists of values, each empty or with one for every vertex.
#[derive(Clone, Debug, Default)]
pub struct VertexAttributes {
    /// A second set of texture coordinates.
    pub second_uvs: Vec<Vec2>,
    /// The unit direction in which the first texture coordinate grows, and the sign that makes of the cross product of
    /// normal and that the direction in which the second one does.
    pub tangents: Vec<Vec4>,
}

impl VertexAttributes {
    /// Whether there are no values at all.
    pub fn is_empty(&self) -> bool {
        self.second_uvs.is_empty() && self.tangents.is_empty()
    }

    /// Bytes of the lists.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.second_uvs) + size_of_val(&*self.tangents)
    }

    /// The second texture coordinates of the corners of a triangle.
    pub(super) fn second_uvs(&self, vertices: [u32; 3]) -> Option<[Vec2; 3]> {
        corners(&self.second_uvs, vertices)
    }

    /// The second texture coordinates where a triangle of these vertices is hit.
    pub(super) fn second_uv(&self, vertices: [u32; 3], hit: &Hit) -> Option<Vec2> {
        let [a, b, c] = self.second_uvs(vertices)?;
        Some((1.0 - hit.u - hit.v) * a + hit.u * b + hit.v * c)
    }

    /// The tangents where a triangle of these vertices is hit: in the directions of the vertices, as long as `own`.
    ///
    /// * `n`: unit shading normal
    /// * `own`: those of the triangle's texture coordinates
    pub(super) fn tangents(&self, vertices: [u32; 3], hit: &Hit, n: Vec3, own: Tangents) -> Tangents {
        let Some([a, b, c]) = corners(&self.tangents, vertices) else { return own };
        let mean = (1.0 - hit.u - hit.v) * a.truncate() + hit.u * b.truncate() + hit.v * c.truncate();
        let sign = if a.w < 0.0 { -1.0 } else { 1.0 };
        let (Some(along), Some(up)) = (mean.try_normalize(), (sign * n.cross(mean)).try_normalize()) else {
            return own;
        };
        let length = |v: Vec3| if v == Vec3::ZERO { 1.0 } else { v.length() };
        Tangents { dpdu: length(own.dpdu) * along, dpdv: length(own.dpdv) * up }
    }
}

fn corners<T: Copy>(values: &[T], vertices: [u32; 3]) -> Option<[T; 3]> {
    let [a, b, c] = vertices.map(|v| values.get(v as usize).copied());
    Some([a?, b?, c?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_mixed_by_the_place_of_the_hit() {
        let attributes = VertexAttributes {
            second_uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
            tangents: vec![Vec4::new(1.0, 0.0, 0.0, -1.0); 3],
        };
        let hit = Hit { u: 0.25, v: 0.5, ..Hit::default() };
        assert_eq!(attributes.second_uv([0, 1, 2], &hit), Some(Vec2::new(0.25, 0.5)));
        let own = Tangents { dpdu: 2.0 * Vec3::Y, dpdv: Vec3::ZERO };
        let found = attributes.tangents([0, 1, 2], &hit, Vec3::Z, own);
        assert_eq!(found, Tangents { dpdu: 2.0 * Vec3::X, dpdv: Vec3::NEG_Y });
        let none = VertexAttributes::default();
        assert_eq!(none.tangents([0, 1, 2], &hit, Vec3::Z, own), own);
        assert_eq!(none.second_uv([0, 1, 2], &hit), None);
    }
}
