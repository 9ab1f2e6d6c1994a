//! Patches that have moved since they were made, for lights that move: everything is drawn and measured on the
//! image of the patch under a map, and nothing is allocated for it.

use super::{Canonical, CurvedPatch, Patch, PatchDirection, PatchSample, PlacedTraced, scale_of_similarity};
use kajo_math::{DAffine3, DVec3, Vec2, Vec3};

impl Patch {
    /// [`Patch::sample`] of the image of this patch under `m`; that of a sphere must be a sphere.
    pub fn sample_moved(&self, m: &DAffine3, from: Vec3, u: Vec2) -> Option<PatchDirection> {
        match self {
            Patch::Curved(curved) => curved.moved(m).sample(from, u),
            Patch::Traced(traced) => traced.placed(Some(m)).sample(from, u),
            other => other.moved(m)?.sample(from, u),
        }
    }

    /// [`Patch::pdf`] of the image of this patch under `m`.
    ///
    /// * `p`, `n`: the position and its unit geometric normal
    pub fn pdf_moved(&self, m: &DAffine3, from: Vec3, p: Vec3, n: Vec3) -> f32 {
        match self {
            Patch::Curved(curved) => curved.moved(m).pdf(from, p, n),
            Patch::Traced(traced) => traced.placed(Some(m)).pdf(from, p),
            other => other.moved(m).map_or(0.0, |moved| moved.pdf(from, p, n)),
        }
    }

    /// [`Patch::sample_area`] of the image of this patch under `m`.
    pub fn sample_area_moved(&self, m: &DAffine3, u: Vec2) -> Option<PatchSample> {
        match self {
            Patch::Curved(curved) => curved.moved(m).sample_area(u),
            Patch::Traced(_) => None,
            other => other.moved(m)?.sample_area(u),
        }
    }

    /// [`Patch::pdf_area`] of the image of this patch under `m`.
    pub fn pdf_area_moved(&self, m: &DAffine3, p: Vec3) -> f32 {
        match self {
            Patch::Curved(curved) => curved.moved(m).pdf_area(p.as_dvec3()) as f32,
            Patch::Traced(_) => 0.0,
            other => other.moved(m).map_or(0.0, |moved| moved.pdf_area(p)),
        }
    }

    /// The same patch in a form that any map of `maps` can be applied to: a sphere that one of them
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

    /// The image of a patch that is not curved.
    pub(super) fn moved(&self, m: &DAffine3) -> Option<Patch> {
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
    pub(super) fn moved(&self, m: &DAffine3) -> CurvedPatch {
        CurvedPatch { map: *m * self.map, inverse: self.inverse * m.inverse(), ..*self }
    }
}

/// A patch where it is at some moment.
#[derive(Clone, Copy, Debug)]
pub struct PlacedPatch<'a> {
    /// The patch where it was once.
    pub patch: &'a Patch,
    /// How it has moved since then; a sphere must stay one.
    pub moved: Option<DAffine3>,
}

impl PlacedPatch<'_> {
    /// See [`Patch::sample`].
    #[inline]
    pub fn sample(&self, from: Vec3, u: Vec2) -> Option<PatchDirection> {
        match &self.moved {
            None => self.patch.sample(from, u),
            Some(m) => self.patch.sample_moved(m, from, u),
        }
    }

    /// See [`Patch::pdf`].
    #[inline]
    pub fn pdf(&self, from: Vec3, p: Vec3, n: Vec3) -> f32 {
        match &self.moved {
            None => self.patch.pdf(from, p, n),
            Some(m) => self.patch.pdf_moved(m, from, p, n),
        }
    }

    /// See [`Patch::sample_area`].
    pub fn sample_area(&self, u: Vec2) -> Option<PatchSample> {
        match &self.moved {
            None => self.patch.sample_area(u),
            Some(m) => self.patch.sample_area_moved(m, u),
        }
    }

    /// See [`Patch::pdf_area`].
    pub fn pdf_area(&self, p: Vec3) -> f32 {
        match &self.moved {
            None => self.patch.pdf_area(p),
            Some(m) => self.patch.pdf_area_moved(m, p),
        }
    }

    /// The surface, if it is one whose points are found by rays.
    #[inline]
    pub fn traced(&self) -> Option<PlacedTraced<'_>> {
        let Patch::Traced(traced) = self.patch else { return None };
        Some(traced.placed(self.moved.as_ref()))
    }

    /// See [`Patch::point_at`].
    pub fn point_at(&self, at: Vec2) -> Option<PatchSample> {
        match &self.moved {
            None => self.patch.point_at(at),
            Some(m) => self.patch.point_at_moved(m, at),
        }
    }

    /// See [`Patch::coordinates`].
    pub fn coordinates(&self, p: Vec3) -> Vec2 {
        match &self.moved {
            None => self.patch.coordinates(p),
            Some(m) => self.patch.coordinates_moved(m, p),
        }
    }

    /// See [`Patch::is_drawn_by_area`]; one that has moved is not asked.
    pub fn is_drawn_by_area(&self, from: Vec3) -> bool {
        self.moved.is_none() && self.patch.is_drawn_by_area(from)
    }
}
