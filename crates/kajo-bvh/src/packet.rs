//! Eight rays side by side, for rays that run together.
//!
//! Neighbours in a picture visit nearly the same nodes. One test finds the children of a node
//! that the beam around all rays meets, and the beam walks the tree as one ray would: of the
//! boxes that it meets, hardly one in fifty is met by no ray. At a leaf each lane of a register
//! is a ray, and all eight are tested at once, first against its box. What they share - walking,
//! loading nodes, waiting for memory - is paid once. Triangles are tested by the arithmetic of
//! [`Group::closest`](crate::group::Group::closest), lane for lane, so hits are the same bits.
//!
//! Rays that do not run into the same octant along the same main axis are traced one by one.

mod boxes;
mod shears;

use kajo_math::Ray;

use self::boxes::Slabs;
use self::shears::{Hits, Shears};
use crate::TriangleBvh;
use crate::group::{Shear, TriangleHit};
use crate::node::{WIDTH, Wide};
use crate::simd::{PacketSimd, Stack, dispatch};
use crate::triangles::leaf;
use crate::walk::{Tree, WAITING, Waiting, descend};

/// Rays in a packet.
const RAYS: usize = 8;

/// Up to so many rays at a leaf are tested one by one.
const FEW: u32 = 2;

/// A number of each ray.
type Lanes = [f32; RAYS];

/// The rays, number by number.
pub(super) struct Rays<S: PacketSimd> {
    pub(super) o: [S::F32x8; 3],
    pub(super) d: [S::F32x8; 3],
    pub(super) t_min: S::F32x8,
    pub(super) t_max: S::F32x8,
}

impl<S: PacketSimd> Rays<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, rays: &[Ray; RAYS]) -> Rays<S> {
        let o = [
            simd.load(&rays.each_ref().map(|ray| ray.o.x)),
            simd.load(&rays.each_ref().map(|ray| ray.o.y)),
            simd.load(&rays.each_ref().map(|ray| ray.o.z)),
        ];
        let d = [
            simd.load(&rays.each_ref().map(|ray| ray.d.x)),
            simd.load(&rays.each_ref().map(|ray| ray.d.y)),
            simd.load(&rays.each_ref().map(|ray| ray.d.z)),
        ];
        let t_min = simd.load(&rays.each_ref().map(|ray| ray.t_min));
        Rays { o, d, t_min, t_max: simd.load(&rays.each_ref().map(|ray| ray.t_max)) }
    }

    /// The axis along which all rays run fastest, by the rule of [`Shear`].
    #[inline(always)]
    pub(super) fn main_axis(&self, simd: S) -> Option<usize> {
        let (x, y, z) = (abs(simd, self.d[0]), abs(simd, self.d[1]), abs(simd, self.d[2]));
        match (simd.le(simd.max(x, y), z), simd.lt(x, y)) {
            (ALL, _) => Some(2),
            (0, ALL) => Some(1),
            (0, 0) => Some(0),
            _ => None,
        }
    }
}

/// All rays of a packet.
pub(super) const ALL: u32 = (1 << RAYS) - 1;

#[inline(always)]
pub(super) fn abs<S: PacketSimd>(simd: S, x: S::F32x8) -> S::F32x8 {
    simd.max(x, simd.sub(simd.splat(0.0), x))
}

#[inline(always)]
pub(super) fn smallest<S: PacketSimd>(simd: S, x: S::F32x8) -> f32 {
    let [a, b] = simd.halves(x);
    a.min(b).min_element()
}

#[inline(always)]
pub(super) fn largest<S: PacketSimd>(simd: S, x: S::F32x8) -> f32 {
    let [a, b] = simd.halves(x);
    a.max(b).max_element()
}

impl Tree {
    /// Visits leaves whose boxes some of the rays meet before their `t_max`, nearest box of the
    /// beam first. `leaf` gets the leaf and which rays meet it, and answers the new `t_max`.
    ///
    /// Returns whether that was done: rays that do not run together are left alone.
    #[inline(always)]
    fn nearest8<S: PacketSimd>(
        &self,
        simd: S,
        rays: &Rays<S>,
        mut leaf: impl FnMut(u32, u32) -> S::F32x8,
    ) -> bool {
        let Some(root) = self.root else { return true };
        let Some(slabs) = Slabs::new(simd, rays, self.reach()) else { return false };
        let mut stack = Stack::<Waiting, WAITING>::new();
        let nodes = &*self.nodes;
        let mut t_max = rays.t_max;
        let mut longest = largest(simd, t_max);
        if root.is_leaf() {
            leaf(root.index(), ALL);
            return true;
        }
        // Where the current child stands: eight times the number of its node, plus its slot.
        let (mut current, mut place) = (root, 0);
        loop {
            if current.is_leaf() {
                let active =
                    slabs.intersect(simd, &nodes[place as usize / WIDTH], place as usize % WIDTH, t_max);
                if active != 0 {
                    t_max = leaf(current.index(), active);
                    longest = largest(simd, t_max);
                }
            } else {
                let node = &nodes[current.index() as usize];
                let (met, near) = slabs.beam.intersect(simd, node, longest);
                if met != 0 {
                    let number = |slot: usize| current.index() * WIDTH as u32 + slot as u32;
                    place = if met & (met - 1) == 0 {
                        number(met.trailing_zeros() as usize)
                    } else {
                        descend(met, &simd.store(near), &mut stack, number)
                    };
                    current = node.child(place as usize % WIDTH);
                    continue;
                }
            }
            // Boxes entered exactly at `t_max` may hold an equally near hit.
            place = loop {
                let Some(waiting) = stack.pop() else { return true };
                if waiting.near() <= longest {
                    break waiting.number();
                }
            };
            current = nodes[place as usize / WIDTH].child(place as usize % WIDTH);
        }
    }
}

impl TriangleBvh {
    /// The nearest hits of eight rays, each what [`TriangleBvh::closest`] finds, to the bit.
    ///
    /// Rays that start near each other and run the same way, such as those through neighbours
    /// in a picture, take half as long together as one by one; others take no longer.
    #[inline]
    pub fn closest8(&self, rays: &[Ray; 8]) -> [Option<TriangleHit>; 8] {
        dispatch!(wide: simd => self.closest8_on(simd, rays))
    }

    #[inline(always)]
    pub(crate) fn closest8_on<S: PacketSimd>(
        &self,
        simd: S,
        rays: &[Ray; RAYS],
    ) -> [Option<TriangleHit>; RAYS] {
        let (together, mut out) = (self.closest_together(simd, rays), [None; RAYS]);
        for (i, out) in out.iter_mut().enumerate() {
            *out = match &together {
                Some(hits) => hits.hit(i),
                None => self.closest_on(simd, &rays[i]),
            };
        }
        out
    }

    #[inline(always)]
    fn closest_together<S: PacketSimd>(&self, simd: S, rays: &[Ray; RAYS]) -> Option<Hits> {
        let (numbers, groups) = (Rays::new(simd, rays), &*self.groups);
        let shears = Shears::new(simd, &numbers)?;
        let mut hits = Hits::before(simd.store(numbers.t_max));
        let done = self.tree.nearest8(
            simd,
            &numbers,
            #[inline(always)]
            |payload, active: u32| {
                for group in leaf(groups, payload) {
                    if active.count_ones() > FEW {
                        shears.closest(simd, group, active, &mut hits);
                        continue;
                    }
                    let mut active = active;
                    while active != 0 {
                        let i = active.trailing_zeros() as usize % RAYS;
                        active &= active - 1;
                        let shear = Shear::new(&rays[i]);
                        if let Some(hit) = group.closest(simd, &shear, hits.t[i], hits.triangle[i]) {
                            hits.offer(i, hit);
                        }
                    }
                }
                simd.join([hits.t(0), hits.t(1)])
            },
        );
        done.then_some(hits)
    }
}
