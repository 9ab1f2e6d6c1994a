//! A binary tree over triangles that may stand on both sides of a split.
//!
//! A long triangle makes the boxes of both sides of any split overlap, unless it is cut: then
//! each side gets a box around its part of it [Stich, Friedrich and Dietrich 2009]. With `A` the
//! surface and `n` the triangles of a side, a set is cut where
//!
//! ```text
//! A(before) n(before) + A(behind) n(behind)
//! ```
//!
//! is less than for its best split, and the boxes of that split overlap. A triangle at the plane
//! is cut only if that is cheaper than to grow the box of one side around it.
//!
//! References to triangles are bounded by the room set aside for them: a set has its share, and
//! passes on what it does not use to its sides, in proportion to their size.

use kajo_math::{Vec3, Vec4};

use super::LeafShape;
use super::binary::{Forest, Grove, Set, TASK, TASK_LEVELS, TOP_LEVELS, Twig, Upper, flatten};
use super::cut::cut;
use super::prim::{Box4, Prim};
use super::slices::{self, Cutting};
use super::split::Split;
use crate::array::Array;

/// References may become more by one in so many.
const EXTRA: (usize, usize) = (3, 10);
/// A set is cut only if the sides of its split overlap by so much of the surface of all.
const OVERLAP: f32 = 1e-3;
/// A set with more of the surface of all is not cut: a large triangle that is cut at the top must be cut
/// over and over further down, where splits set it apart once and for all.
const MOST_AREA: f32 = 0.6;
/// Smaller sets are not cut.
const LEAST: usize = 64;

/// Primitives, and behind them room for more.
struct Room<'a> {
    all: &'a mut [Prim],
    len: usize,
    bounds: Box4,
}

struct Builder<F> {
    corners: F,
    shape: LeafShape,
    /// Half the surface of all.
    area: f32,
}

/// The binary tree over a set of triangles that is not empty.
pub(super) fn build(set: Set<'_>, shape: LeafShape, corners: impl Fn(u32) -> [Vec3; 3] + Sync) -> Forest {
    let len = set.prims.len();
    let mut all = Array::<Prim>::zeroed(len + len / EXTRA.1 * EXTRA.0);
    all[..len].copy_from_slice(set.prims);
    let builder = Builder { corners, shape, area: set.bounds.half_area() };
    let mut forest = Forest::default();
    flatten(builder.upper(Room { all: &mut all, len, bounds: set.bounds }, 0), &mut forest);
    let is_cut = forest.groves.iter().map(|grove| grove.ids.len()).sum::<usize>() > len;
    forest.groves.iter_mut().for_each(|grove| grove.cut = is_cut);
    forest
}

/// Both sides of a plane with all that is cut by it counted to both, but for what has been given to one.
struct SidesAsCut {
    boxes: [Box4; 2],
    counts: [f32; 2],
}

impl SidesAsCut {
    /// What each side gets of a triangle in the box `bounds` that the plane cuts into `parts`: its part, or one of them all of it where
    /// that is cheaper. [Stich, Friedrich and Dietrich 2009, sec. 4.4]
    #[inline]
    fn shares(&mut self, bounds: Box4, [a, b]: [Box4; 2], may_cut: bool) -> [Option<Box4>; 2] {
        let ([before, behind], [n_before, n_behind]) = (self.boxes, self.counts);
        let both = before.half_area() * n_before + behind.half_area() * n_behind;
        let (with_before, with_behind) = (before.union(bounds), behind.union(bounds));
        let to_left = with_before.half_area() * n_before + behind.half_area() * (n_behind - 1.0);
        let to_right = before.half_area() * (n_before - 1.0) + with_behind.half_area() * n_behind;
        if both <= to_left.min(to_right) && may_cut {
            [Some(a), Some(b)]
        } else if to_left <= to_right {
            (self.boxes[0], self.counts[1]) = (with_before, n_behind - 1.0);
            [Some(bounds), None]
        } else {
            (self.boxes[1], self.counts[0]) = (with_behind, n_before - 1.0);
            [None, Some(bounds)]
        }
    }
}

impl<F: Fn(u32) -> [Vec3; 3] + Sync> Builder<F> {
    fn upper(&self, room: Room<'_>, depth: usize) -> Upper {
        if room.all.len() <= TASK {
            let mut grove = Grove::default();
            self.grow(&mut grove, room, 0);
            return Upper::Grove(grove);
        }
        let bounds = room.bounds;
        let [left, right] = self.split(room, TASK << (TOP_LEVELS - depth - 1).min(32));
        let (left, right) = rayon::join(|| self.upper(left, depth + 1), || self.upper(right, depth + 1));
        Upper::Node(bounds, Box::new([left, right]))
    }

    /// As [`Grove`] grows without cuts.
    fn grow(&self, grove: &mut Grove, room: Room<'_>, depth: usize) {
        let (place, first) = (grove.twigs.len(), grove.ids.len());
        grove.twigs.push(Twig::new(room.bounds, room.len));
        if room.len <= self.shape.block() {
            grove.ids.extend(room.all[..room.len].iter().map(Prim::id));
            return;
        }
        let [left, right] = self.split(room, self.shape.block() << (TASK_LEVELS - depth - 1));
        self.grow(grove, left, depth + 1);
        grove.twigs[place].right = grove.twigs.len() as u16;
        self.grow(grove, right, depth + 1);
        // Cutting may have made them more.
        let len = grove.ids.len() - first;
        grove.twigs[place].set_len(len);
    }

    /// Two sets, not empty, by the cheapest cut or split; two halves where there is neither, or
    /// where a side could hold more than `most`, the primitives that fit below.
    fn split<'a>(&self, room: Room<'a>, most: usize) -> [Room<'a>; 2] {
        // Room counts too, as it can fill up; without it, halves are exact.
        if room.all.len() > most {
            let Room { all, len, bounds } = room;
            return Room { all: &mut all[..len], len, bounds }.divided(None);
        }
        let best = Split::best(&room.all[..room.len], self.shape);
        match self.cutting(&room, best.as_ref()) {
            Some(cutting) => self.cut(room, &cutting),
            None => room.divided(best),
        }
    }

    /// Where to cut, if that is cheaper than the best split.
    fn cutting(&self, room: &Room<'_>, best: Option<&Split>) -> Option<Cutting> {
        let (len, spare) = (room.len, room.all.len() - room.len);
        if len < LEAST || spare == 0 || room.bounds.half_area() > MOST_AREA * self.area {
            return None;
        }
        let cost = best.map_or(Some(f32::INFINITY), |best| {
            let [a, b] = best.sides();
            let e = (a.hi.min(b.hi) - a.lo.max(b.lo)).max(Vec4::ZERO);
            let common = e.x * (e.y + e.z) + e.y * e.z;
            let counts = [best.left(), len - best.left()];
            (common > OVERLAP * self.area).then(|| slices::cost([a, b], counts))
        })?;
        Cutting::best(&room.all[..len], room.bounds, spare, &self.corners)
            .filter(|cutting| cutting.cost < cost)
    }

    /// Two sets on either side of a plane. Where that would leave one side empty, by the best
    /// split.
    fn cut<'a>(&self, room: Room<'a>, cutting: &Cutting) -> [Room<'a>; 2] {
        let Room { all, len, .. } = room;
        let mut spare = all.len() - len;
        let (axis, plane) = (cutting.axis, cutting.plane);
        let mut sides_as_cut = SidesAsCut { boxes: cutting.sides, counts: cutting.counts.map(|n| n as f32) };
        let (mut left, mut right) = (0, Vec::with_capacity(cutting.counts[1]));
        let mut sides = [Box4::EMPTY; 2];
        for i in 0..len {
            let (prim, bounds) = (all[i], all[i].bounds());
            let parts = if bounds.hi[axis] <= plane {
                [Some(bounds), None]
            } else if bounds.lo[axis] >= plane {
                [None, Some(bounds)]
            } else {
                match cut((self.corners)(prim.id()), bounds, axis, plane) {
                    [Some(a), Some(b)] => {
                        let parts = sides_as_cut.shares(bounds, [a, b], spare > 0);
                        spare -= usize::from(parts.iter().all(Option::is_some));
                        parts
                    }
                    // Nothing of it is in its box but for rounding.
                    [None, None] => [Some(bounds), None],
                    one => one,
                }
            };
            if let Some(part) = parts[1] {
                right.push(prim.with_bounds(part));
                sides[1] = sides[1].union(part);
            }
            // What is written is never ahead of what has been read.
            if let Some(part) = parts[0] {
                all[left] = prim.with_bounds(part);
                left += 1;
                sides[0] = sides[0].union(part);
            }
        }
        let len = left + right.len();
        all[left..len].copy_from_slice(&right);
        let room = Room { all, len, bounds: room.bounds };
        if left == 0 || left == len {
            let best = Split::best(&room.all[..len], self.shape);
            return room.divided(best);
        }
        room.parted(left, sides)
    }
}

impl<'a> Room<'a> {
    /// By a split, or else into halves.
    fn divided(self, split: Option<Split>) -> [Room<'a>; 2] {
        let prims = &mut self.all[..self.len];
        let Some(split) = split else {
            let left = self.len / 2;
            let (a, b) = prims.split_at_mut(left);
            let sides = [Set::around(a).bounds, Set::around(b).bounds];
            return self.parted(left, sides);
        };
        split.part(prims);
        self.parted(split.left(), split.sides())
    }

    /// The first `left` primitives and the others, each with their share of the room.
    fn parted(self, left: usize, [before, behind]: [Box4; 2]) -> [Room<'a>; 2] {
        let Room { all, len, .. } = self;
        // In 64 bits, which the product may take.
        let spare = ((all.len() - len) as u64 * left as u64 / len as u64) as usize;
        all.copy_within(left..len, left + spare);
        let (a, b) = all.split_at_mut(left + spare);
        [Room { all: a, len: left, bounds: before }, Room { all: b, len: len - left, bounds: behind }]
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::Vec3A;

    use super::*;
    use crate::build::prim::Prims;
    use crate::build::reinsert;
    use crate::tests::meshes::Mesh;

    const SHAPE: LeafShape = LeafShape { block_bits: 2, most: 32, limit: 1 << 28 };

    fn forest(mesh: &Mesh) -> Forest {
        let corners = |id: u32| mesh.corners(id as usize);
        let bounds = |id: u32| Some(Box4::around(corners(id).map(Vec3A::from)));
        build(Set::around(Prims::new(mesh.triangles.len(), bounds).as_mut_slice()), SHAPE, corners)
    }

    /// Number of references; every triangle has one at least, and none has two in a place.
    fn references(forest: &Forest, triangles: usize) -> usize {
        let mut ids: Vec<u32> = forest.groves.iter().flat_map(|grove| &grove.ids).copied().collect();
        let len = ids.len();
        ids.sort_unstable();
        ids.dedup();
        assert!(ids.into_iter().eq(0..triangles as u32));
        len
    }

    #[test]
    fn references_stay_within_their_budget() {
        let long = |p: Vec3| p + Vec3::ONE * (10.0 * p.element_sum());
        for (mesh, is_cut) in [
            (Mesh::sphere(4).moved(long), true),
            (Mesh::sphere(5).moved(long).repeated(3), true),
            (Mesh::soup(20_000, 0.05, 1), true),
            (Mesh::soup(200, 0.2, 4).repeated(100), true),
            (Mesh::grid(60, 0.0, 3), false),
            (Mesh::soup(1, 1.0, 4).repeated(20_000), false),
            (Mesh::soup(9, 1.0, 4), false),
        ] {
            let (mut forest, n) = (forest(&mesh), mesh.triangles.len());
            let len = references(&forest, n);
            assert!(len <= n + n * 3 / 10 && (len > n) == is_cut, "{len} of {n}");
            assert_eq!(forest.is_cut(), is_cut);
            reinsert::improve(&mut forest);
            assert!(references(&forest, n) == len && forest.is_cut() == is_cut);
        }
    }
}
