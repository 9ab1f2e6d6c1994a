//! A tree over triangles.

use std::collections::BTreeSet;

use kajo_math::{Aabb, DVec3, Ray, Vec3, Vec3A};
use rayon::prelude::*;

use crate::array::Array;
use crate::build::{self, Box4, Built, LeafShape, Prims};
use crate::group::{Group, LANES, Shear, TriangleHit};
use crate::simd::{Simd, dispatch};
use crate::walk::Tree;
use crate::{BuildError, BuildSettings, Stats};

/// A leaf names its first group and, in the low bits, how many follow it.
const MORE_BITS: u32 = 3;
/// Groups that the rest of a leaf's 31 bits can tell apart.
const MOST_GROUPS: usize = 1 << (31 - MORE_BITS);

const SHAPE: LeafShape =
    LeafShape { block_bits: LANES.ilog2(), most: LANES << MORE_BITS, limit: MOST_GROUPS };

/// A tree over triangles, and the triangles.
///
/// Closed meshes are watertight: a ray cannot pass between triangles that share vertices.
/// Both sides of a triangle count, and its edges belong to it.
#[derive(Clone, Debug)]
pub struct TriangleBvh {
    pub(crate) tree: Tree,
    pub(crate) groups: Array<Group>,
    leaves: usize,
    dropped: usize,
    /// Whether a triangle may stand in several leaves.
    pub(crate) cut: bool,
}

impl Default for TriangleBvh {
    fn default() -> TriangleBvh {
        TriangleBvh { tree: Tree::EMPTY, groups: Array::EMPTY, leaves: 0, dropped: 0, cut: false }
    }
}

impl TriangleBvh {
    /// Builds a tree over `triangles`, three indices into `positions` each. What it needs of
    /// them is copied. Triangles without area or with a coordinate that is not finite are
    /// left out and counted.
    ///
    /// Threads of the current rayon pool share the work; their number does not change the
    /// tree.
    pub fn build(
        positions: &[Vec3],
        triangles: &[[u32; 3]],
        settings: &BuildSettings,
    ) -> Result<TriangleBvh, BuildError> {
        check(positions, triangles)?;
        let corners = |triangle: u32| triangles[triangle as usize].map(|i| positions[i as usize]);
        let bounds = |id: u32| {
            Some(corners(id)).filter(can_be_hit).map(|corners| Box4::around(corners.map(Vec3A::from)))
        };
        let prims = Prims::new(triangles.len(), bounds);
        let dropped = triangles.len() - prims.len();
        let leaf = |ids: &[u32], groups: &mut [Group], first: usize| {
            for (ids, group) in ids.chunks(LANES).zip(&mut *groups) {
                *group = Group::new(ids, corners);
            }
            (first << MORE_BITS) as u32 | (groups.len() - 1) as u32
        };
        let built = build::build(prims, SHAPE, settings.quality, Some(corners), leaf);
        let Some(Built { tree, blocks, leaves, cut }) = built else {
            return Err(BuildError::TooMany(triangles.len()));
        };
        Ok(TriangleBvh { tree, groups: blocks, leaves, dropped, cut })
    }

    /// Takes new corners for the same triangles and keeps the shape of the tree: fast, and fine
    /// for small changes; after large ones a new tree is faster to trace.
    ///
    /// A triangle that is missing, has no area or is not finite is not hit until it gets better
    /// corners. What was left out by [`TriangleBvh::build`] stays out.
    ///
    /// # Errors
    /// When a triangle names a vertex that does not exist; the tree stays as it was.
    pub fn refit(&mut self, positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<(), BuildError> {
        check(positions, triangles)?;
        let corners = |triangle: u32| {
            let corners = triangles.get(triangle as usize)?.map(|i| positions[i as usize]);
            Some(corners).filter(can_be_hit)
        };
        let groups = self.groups.par_iter_mut().with_min_len(1 << 10);
        let bounds: Vec<Aabb> = groups.map(|group| group.refit(corners)).collect();
        self.tree.refit(|payload| leaf(&bounds, payload).iter().copied().fold(Aabb::EMPTY, Aabb::union));
        Ok(())
    }

    /// The nearest hit in the ray's range; of equally near ones that of the lowest number.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<TriangleHit> {
        dispatch!(wide: simd => self.closest_on(simd, ray))
    }

    /// Whether anything is hit in the ray's range.
    #[inline]
    pub fn any(&self, ray: &Ray) -> bool {
        dispatch!(wide: simd => self.any_on(simd, ray))
    }

    /// Calls `visit` once for every crossing in the ray's range, in no set order.
    ///
    /// A ray through an edge or vertex crosses exactly one of the triangles on either side,
    /// so a ray from outside a closed mesh to outside crosses it an even number of times.
    #[inline]
    pub fn all(&self, ray: &Ray, visit: impl FnMut(TriangleHit)) {
        dispatch!(simd => self.all_on(simd, ray, visit))
    }

    /// The box around everything; empty when there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds
    }

    /// Size, depth and memory of the tree.
    pub fn stats(&self) -> Stats {
        let tree = self.tree.stats(self.leaves, self.dropped);
        Stats { bytes: tree.bytes + size_of_val(&*self.groups), ..tree }
    }

    #[inline(always)]
    pub(crate) fn closest_on<S: Simd>(&self, simd: S, ray: &Ray) -> Option<TriangleHit> {
        self.closest_by(simd, ray, |_| {})
    }

    /// Calls `test` before the triangles of a leaf are tested.
    #[inline(always)]
    pub(crate) fn closest_by<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        mut test: impl FnMut(&[Group]),
    ) -> Option<TriangleHit> {
        let (shear, groups) = (Shear::new(ray), &*self.groups);
        let mut best: Option<TriangleHit> = None;
        self.tree.nearest(
            simd,
            ray,
            Vec3::ZERO,
            #[inline(always)]
            |payload, mut t_max| {
                let groups = leaf(groups, payload);
                test(groups);
                for group in groups {
                    let tie = best.map_or(0, |b| b.triangle);
                    if let Some(hit) = group.closest(simd, &shear, t_max, tie) {
                        t_max = hit.t;
                        best = Some(hit);
                    }
                }
                t_max
            },
        );
        best
    }

    #[inline(always)]
    pub(crate) fn any_on<S: Simd>(&self, simd: S, ray: &Ray) -> bool {
        self.any_by(simd, ray, || {})
    }

    /// Calls `test` before a group of triangles is tested.
    #[inline(always)]
    pub(crate) fn any_by<S: Simd>(&self, simd: S, ray: &Ray, mut test: impl FnMut()) -> bool {
        let (shear, groups) = (Shear::new(ray), &*self.groups);
        self.tree.any(
            simd,
            ray,
            Vec3::ZERO,
            #[inline(always)]
            |payload| {
                for group in leaf(groups, payload) {
                    test();
                    if group.any(simd, &shear, ray.t_max) {
                        return true;
                    }
                }
                false
            },
        )
    }

    #[inline(always)]
    pub(crate) fn all_on<S: Simd>(&self, simd: S, ray: &Ray, mut visit: impl FnMut(TriangleHit)) {
        let (shear, groups) = (Shear::new(ray), &*self.groups);
        // A cut triangle is met in several leaves and counts in the first.
        let mut seen = BTreeSet::new();
        let mut once = |hit: TriangleHit| {
            if !self.cut || seen.insert(hit.triangle) {
                visit(hit);
            }
        };
        self.tree.any(simd, ray, Vec3::ZERO, |payload| {
            for group in leaf(groups, payload) {
                group.all(simd, &shear, ray.t_max, &mut once);
            }
            false
        });
    }
}

/// Of the groups, or what there is for each, those of a leaf.
#[inline(always)]
pub(crate) fn leaf<T>(groups: &[T], payload: u32) -> &[T] {
    let (first, more) = (payload >> MORE_BITS, payload & ((1 << MORE_BITS) - 1));
    &groups[first as usize..=(first + more) as usize]
}

fn check(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<(), BuildError> {
    if triangles.len() > MOST_GROUPS * LANES {
        return Err(BuildError::TooMany(triangles.len()));
    }
    let vertices = positions.len();
    // The largest index first: that takes no decision for each triangle.
    let largest = |triangles: &[[u32; 3]]| triangles.as_flattened().iter().copied().fold(0, u32::max);
    let largest = triangles.par_chunks(1 << 14).map(largest).reduce(|| 0, u32::max);
    if (largest as usize) < vertices || triangles.is_empty() {
        return Ok(());
    }
    let bad = triangles.iter().position(|t| t.iter().any(|&i| i as usize >= vertices));
    let Some(triangle) = bad else { return Ok(()) };
    let index = triangles[triangle].into_iter().max().unwrap_or_default();
    Err(BuildError::IndexOutOfRange { triangle, index, vertices })
}

/// Whether the corners are finite and not on one line.
#[inline]
pub(crate) fn can_be_hit(&[a, b, c]: &[Vec3; 3]) -> bool {
    let normal = (Vec3A::from(b) - Vec3A::from(a)).cross(Vec3A::from(c) - Vec3A::from(a));
    // A corner that is not finite spreads to at least two of its numbers.
    if normal.is_finite() && normal != Vec3A::ZERO {
        return true;
    }
    // The product may have vanished in f32 for smallness alone, or overflowed.
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    let normal = (b - a).cross(c - a);
    normal.is_finite() && normal != DVec3::ZERO
}
