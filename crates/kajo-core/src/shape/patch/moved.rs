//! Pieces that have moved since they were made, for lights that move: everything is drawn and measured on the
//! image of the piece under a map, and nothing is allocated for it.

use super::{Canonical, CurvedPatch, Patch, PatchSample, PatchWay, per_solid_angle, scale_of_similarity};
use kajo_math::{DAffine3, DVec3, Vec2, Vec3};

impl Patch {
    /// [`Patch::sample`] of the image of this piece under `m`; that of a sphere must be a sphere.
    pub fn sample_moved(&self, m: &DAffine3, from: Vec3, u: Vec2) -> Option<PatchWay> {
        let Patch::Curved(curved) = self else { return self.moved(m)?.sample(from, u) };
        curved.moved(m).sample_area(u)?.seen_from(from)
    }

    /// [`Patch::pdf`] of the image of this piece under `m`.
    ///
    /// * `p`, `n`: the place and its unit geometric normal
    pub fn pdf_moved(&self, m: &DAffine3, from: Vec3, p: Vec3, n: Vec3) -> f32 {
        let Patch::Curved(curved) = self else {
            return self.moved(m).map_or(0.0, |moved| moved.pdf(from, p, n));
        };
        let pdf_area = curved.moved(m).pdf_area(p.as_dvec3()) as f32;
        per_solid_angle(pdf_area, from, p, n).unwrap_or(0.0)
    }

    /// [`Patch::sample_area`] of the image of this piece under `m`.
    pub fn sample_area_moved(&self, m: &DAffine3, u: Vec2) -> Option<PatchSample> {
        match self {
            Patch::Curved(curved) => curved.moved(m).sample_area(u),
            other => other.moved(m)?.sample_area(u),
        }
    }

    /// [`Patch::pdf_area`] of the image of this piece under `m`.
    pub fn pdf_area_moved(&self, m: &DAffine3, p: Vec3) -> f32 {
        match self {
            Patch::Curved(curved) => curved.moved(m).pdf_area(p.as_dvec3()) as f32,
            other => other.moved(m).map_or(0.0, |moved| moved.pdf_area(p)),
        }
    }

    /// The same piece in a form that any map of `maps` can be applied to: a sphere that one of them
    /// deforms is the image of a curved surface from the start. `None` where it would have no area.
    pub fn movable(self, mut maps: impl Iterator<Item = DAffine3>) -> Option<Patch> {
        match self {
            Patch::Sphere { center, radius } if !maps.all(|m| scale_of_similarity(&m.matrix3).is_some()) => {
                let placed = DAffine3::from_translation(center) * DAffine3::from_scale(DVec3::splat(radius));
                Patch::curved(Canonical::Sphere, placed)
            }
            other => Some(other),
        }
    }

    /// The image of a piece that is not curved.
    fn moved(&self, m: &DAffine3) -> Option<Patch> {
        match self {
            Patch::Sphere { center, radius } => Some(Patch::Sphere {
                center: m.transform_point3(*center),
                radius: radius * m.matrix3.x_axis.length(),
            }),
            flat => flat.transformed(m),
        }
    }
}

impl CurvedPatch {
    /// The image; its area is not measured anew.
    fn moved(&self, m: &DAffine3) -> CurvedPatch {
        CurvedPatch { map: *m * self.map, inverse: self.inverse * m.inverse(), ..*self }
    }
}
