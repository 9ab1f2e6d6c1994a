//! What differentials of rays need of a scene: how normals change, and what a footprint is in surface coordinates.

use kajo_math::{Ray, Vec2, Vec3};

use super::{Interaction, Scene};
use crate::differential::SurfaceFootprint;
use crate::interaction::Tangents;
use crate::texture::TextureFootprint;

impl Scene {
    /// How the shading normal at an interaction changes over small displacements within the surface, in world space.
    ///
    /// By central differences between points of the same object: rays along the normal find them, whatever the
    /// shape is. Nothing changes across an edge behind which there is no such point.
    pub fn normal_changes(&self, at: &Interaction, dp: [Vec3; 2]) -> [Vec3; 2] {
        dp.map(|dp| self.normal_change(at, dp).unwrap_or(Vec3::ZERO))
    }

    fn normal_change(&self, at: &Interaction, dp: Vec3) -> Option<Vec3> {
        /// Steps are this much larger than what is uncertain about the point.
        const CLEAR: f32 = 256.0;
        let length = dp.length();
        if length == 0.0 || !length.is_finite() {
            return None;
        }
        let mut step = (CLEAR * at.point.p_error.max_element() / length).max(1.0);
        // A step may lead beyond the silhouette of something that is smaller than it.
        for _ in 0..4 {
            let [there, back] = [step, -step].map(|step| self.normal_beside(at, step * dp));
            if let (Some(there), Some(back)) = (there, back) {
                return Some((there - back) / (2.0 * step));
            }
            step *= 0.125;
        }
        None
    }

    /// The shading normal of the same object above or below the point beside an interaction; `None` where there is none, or it is that of
    /// another side.
    ///
    /// * `step`: from the point, within the surface, in world space
    pub fn normal_beside(&self, at: &Interaction, step: Vec3) -> Option<Vec3> {
        let (up, height) = (at.point.ng, step.length());
        let ray = Ray {
            o: at.point.p + step + height * up,
            t_min: 0.0,
            d: -up,
            t_max: 2.0 * height,
            time: at.time,
        };
        let hit = self.hit_of(at.object, &ray)?;
        let beside = self.interaction(&ray, at.object, hit);
        // Another side of the same object is none.
        (beside.point.ng.dot(up) > 0.5).then_some(beside.point.n)
    }

    /// What a sample covers at an interaction, as textures are asked.
    #[inline(never)]
    pub(crate) fn texture_footprint(&self, at: &Interaction, needs_uv: bool) -> TextureFootprint {
        let SurfaceFootprint { dp } = at.footprint;
        if at.footprint.is_point() {
            return TextureFootprint::POINT;
        }
        if !needs_uv {
            return TextureFootprint { p: dp, ..TextureFootprint::POINT };
        }
        let uv = in_coordinates(&self.geometry.tangents(at), dp);
        let second = match self.appearance.textures.wants_second_footprint() {
            true => self.geometry.second_tangents(at),
            false => None,
        };
        TextureFootprint { p: dp, uv, second_uv: second.map_or(uv, |tangents| in_coordinates(&tangents, dp)) }
    }
}

/// Displacements within a surface in its own coordinates: the least squares of `dpdu du + dpdv dv = dp`.
fn in_coordinates(tangents: &Tangents, dp: [Vec3; 2]) -> [Vec2; 2] {
    let Tangents { dpdu, dpdv } = *tangents;
    let (a, b, c) = (dpdu.length_squared(), dpdu.dot(dpdv), dpdv.length_squared());
    let determinant = a * c - b * b;
    let duv = dp.map(|dp| {
        let (u, v) = (dpdu.dot(dp), dpdv.dot(dp));
        Vec2::new(c * u - b * v, a * v - b * u) / determinant
    });
    if duv.iter().all(|v| v.is_finite()) { duv } else { [Vec2::ZERO; 2] }
}
