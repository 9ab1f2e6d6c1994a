//! What vertices of a mesh have besides normals and texture coordinates.

use kajo_math::{Vec2, Vec3, Vec4};

use crate::interaction::{Hit, SurfaceUv, Tangents};

/// Lists of values, each empty or with one for every vertex.
#[derive(Clone, Debug, Default)]
pub struct VertexAttributes {
    /// A second set of texture coordinates.
    pub second_uvs: Vec<Vec2>,
    /// Linear red, green, blue and opacity, with 65535 for 1.
    pub colors: Vec<[u16; 4]>,
    /// The unit direction in which the first texture coordinate grows, and the sign that makes of the cross product of
    /// normal and that the direction in which the second one does.
    pub tangents: Vec<Vec4>,
}

/// Such values at a place of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexValues {
    /// Of the second set of coordinates, if there is one.
    pub second_uv: Option<Vec2>,
    /// All 1 where there are none.
    pub color: [f32; 4],
}

impl VertexValues {
    /// All that pictures ask for, with the first set of coordinates.
    pub fn at(self, uv: Vec2) -> SurfaceUv {
        SurfaceUv { first: uv, second: self.second_uv.unwrap_or(uv), color: self.color }
    }
}

impl VertexAttributes {
    /// Whether there are no values at all.
    pub fn is_empty(&self) -> bool {
        self.second_uvs.is_empty() && self.colors.is_empty() && self.tangents.is_empty()
    }

    /// Bytes of the lists.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.second_uvs) + size_of_val(&*self.colors) + size_of_val(&*self.tangents)
    }

    /// The values where a triangle of these vertices is hit.
    pub(super) fn values(&self, vertices: [u32; 3], hit: &Hit) -> VertexValues {
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let uvs = corners(&self.second_uvs, vertices);
        let color = corners(&self.colors, vertices).map_or([1.0; 4], |colors| {
            let mean = |c: usize| {
                let sum: f32 =
                    std::iter::zip(colors, weights).map(|(color, w)| w * f32::from(color[c])).sum();
                (sum * (1.0 / 65535.0)).clamp(0.0, 1.0)
            };
            std::array::from_fn(mean)
        });
        let second_uv = uvs.map(|[a, b, c]| weights[0] * a + weights[1] * b + weights[2] * c);
        VertexValues { second_uv, color }
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
            colors: vec![[65535, 0, 0, 65535], [0, 65535, 0, 65535], [0, 0, 65535, 0]],
            tangents: vec![Vec4::new(1.0, 0.0, 0.0, -1.0); 3],
        };
        let hit = Hit { u: 0.25, v: 0.5, ..Hit::default() };
        let found = attributes.values([0, 1, 2], &hit);
        assert_eq!((found.second_uv, found.color), (Some(Vec2::new(0.25, 0.5)), [0.25, 0.25, 0.5, 0.5]));
        let own = Tangents { dpdu: 2.0 * Vec3::Y, dpdv: Vec3::ZERO };
        let found = attributes.tangents([0, 1, 2], &hit, Vec3::Z, own);
        assert_eq!(found, Tangents { dpdu: 2.0 * Vec3::X, dpdv: Vec3::NEG_Y });
        let none = VertexAttributes::default();
        assert_eq!(none.tangents([0, 1, 2], &hit, Vec3::Z, own), own);
        assert_eq!(none.values([0, 1, 2], &hit), VertexValues { second_uv: None, color: [1.0; 4] });
    }
}
