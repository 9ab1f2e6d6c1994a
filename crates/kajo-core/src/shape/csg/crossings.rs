//! Along a line through a solid: crossings with its leaves, and what of them is its surface.

use std::cell::RefCell;

use kajo_math::{DVec3, Ray, Transform, Vec3};

use super::{Leaf, LeafTransform, Solid};
use crate::interaction::{Hit, SurfacePoint};

/// How well a crossing is known along the ray, in units of the size of the numbers that it is computed from: a few roundings
/// of the way into the space of a leaf, and of its parameter.
const KNOWN: f32 = 8.0 * f32::EPSILON;

/// Where a ray all but touches a surface, its crossing is known less well, up to this factor.
const STEEPEST: f32 = 1e3;

/// A crossing of the line with a leaf.
#[derive(Clone, Copy)]
struct Crossing {
    leaf: u32,
    /// With the part's number in the leaf.
    hit: Hit,
}

/// Memory that walks use again and again.
#[derive(Default)]
pub(super) struct Scratch {
    crossings: Vec<Crossing>,
    /// See [`super::sets::SetTree`].
    counts: Vec<u32>,
    /// Which leaves hold the point.
    holds: Vec<bool>,
    /// Crossings on their way to who asked for them.
    pub found: Vec<Hit>,
}

thread_local! {
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

/// `f` with the memory of this thread.
#[inline]
pub(super) fn with_scratch<T>(f: impl FnOnce(&mut Scratch) -> T) -> T {
    SCRATCH.with_borrow_mut(f)
}

impl Solid {
    /// Visits the crossings with the surface within the ray's range from the nearest to the farthest, until `visit` says that
    /// it is enough.
    pub(super) fn walk(&self, ray: &Ray, scratch: &mut Scratch, mut visit: impl FnMut(Hit) -> bool) {
        let line = Line::new(self, ray);
        self.gather(&line, scratch);
        let Scratch { crossings, counts, holds, .. } = scratch;
        crossings.sort_unstable_by(|a, b| {
            a.hit.t.total_cmp(&b.hit.t).then(a.leaf.cmp(&b.leaf)).then(a.hit.part.cmp(&b.hit.part))
        });
        let mut rest = &mut crossings[..];
        while let Some(first) = rest.first() {
            let mut together = 1;
            while rest.get(together).is_some_and(|next| line.coincide(first, next)) {
                together += 1;
            }
            let (group, later) = rest.split_at_mut(together);
            let nearest = group[0].hit.t;
            if nearest >= ray.t_max {
                return;
            }
            let last = group[together - 1].hit.t;
            let in_range = nearest > ray.t_min && last < ray.t_max;
            if let Some(hit) = self.change(group, counts, holds).filter(|_| in_range)
                && visit(hit)
            {
                return;
            }
            rest = later;
        }
    }

    /// All crossings of the whole line with the leaves that the ray comes near, and which leaves hold where it comes from.
    fn gather(&self, line: &Line<'_>, scratch: &mut Scratch) {
        let Scratch { crossings, counts, holds, .. } = scratch;
        crossings.clear();
        self.sets.reset(counts);
        holds.clear();
        holds.resize(self.leaves.len(), false);
        let mut leaf = |i: u32| {
            let leaf = &self.leaves[i as usize];
            let own = leaf.ray(&line.whole);
            let before = crossings.len();
            self.shapes.crossings(leaf.shape, &own, &mut |hit| crossings.push(Crossing { leaf: i, hit }));
            let starts_inside = self.shapes.starts_inside(leaf.shape, &own);
            // What is entered is left. A line that is found to do only one of them touches an edge.
            if !(crossings.len() - before).is_multiple_of(2) && leaf.bounds.is_finite() {
                crossings.truncate(before);
            } else if starts_inside {
                holds[i as usize] = true;
                self.sets.set(counts, i, true);
            }
        };
        match &self.tree {
            Some(tree) => tree.each(&line.near, |i| leaf(self.bounded[i as usize])),
            None => {
                let near = |&&i: &&u32| self.leaves[i as usize].bounds.clip(&line.near).is_some();
                self.bounded.iter().filter(near).for_each(|&i| leaf(i));
            }
        }
        self.unbounded.iter().for_each(|&i| leaf(i));
    }

    /// Lets the leaves of a group of crossings begin or end to hold the point; the hit where that is the surface of the result.
    ///
    /// It has the part of the first leaf whose crossing alone would be, or else of the first whose own is of this kind: one way
    /// in, or one way out.
    #[inline]
    fn change(&self, group: &mut [Crossing], counts: &mut [u32], holds: &mut [bool]) -> Option<Hit> {
        let before = self.sets.holds(counts);
        let mut toggle = |i: u32, counts: &mut [u32]| {
            holds[i as usize] = !holds[i as usize];
            self.sets.set(counts, i, holds[i as usize]);
        };
        if let [only] = group {
            toggle(only.leaf, counts);
            return (self.sets.holds(counts) != before).then(|| self.named(only));
        }
        group.sort_unstable_by_key(|crossing| (crossing.leaf, crossing.hit.part));
        let mut alone = None;
        for crossing in &*group {
            toggle(crossing.leaf, counts);
            if alone.is_none() && self.sets.holds(counts) != before {
                alone = Some(*crossing);
            }
            toggle(crossing.leaf, counts);
        }
        group.iter().for_each(|crossing| toggle(crossing.leaf, counts));
        let after = self.sets.holds(counts);
        let same_way = |crossing: &&Crossing| {
            let leaf = crossing.leaf as usize;
            (holds[leaf] != self.leaves[leaf].inverted) == after
        };
        let chosen = || alone.or_else(|| group.iter().find(same_way).copied());
        if after == before { None } else { chosen().map(|crossing| self.named(&crossing)) }
    }

    /// A hit by the number of its part among those of all leaves.
    fn named(&self, crossing: &Crossing) -> Hit {
        let first = self.leaves[crossing.leaf as usize].first_part;
        Hit { part: first + crossing.hit.part, ..crossing.hit }
    }

    /// Position and normals of a leaf, in the space of the result.
    pub(super) fn leaf_surface(&self, leaf: &Leaf, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let own = self.shapes.surface_at(leaf.shape, &leaf.ray(ray), hit);
        leaf.in_place(ray.time, own, |own, transform| own.transformed(transform))
    }

    /// Whether membership of the point `p` in the result, at a ray's time, depends on this leaf.
    pub(super) fn depends_on(&self, leaf: u32, p: Vec3, time: f32, scratch: &mut Scratch) -> bool {
        let counts = &mut scratch.counts;
        self.sets.reset(counts);
        let mut count = |i: u32| {
            let other = &self.leaves[i as usize];
            if i != leaf && other.bounds.contains(p) && self.leaf_holds(other, p, time) {
                self.sets.set(counts, i, true);
            }
        };
        match &self.tree {
            // Boxes are widened by more than the length of this ray.
            Some(tree) => {
                let here = Ray::new(p, Vec3::X).over(0.0, f32::MIN_POSITIVE);
                tree.each(&here, |i| count(self.bounded[i as usize]));
            }
            None => self.bounded.iter().for_each(|&i| count(i)),
        }
        self.unbounded.iter().for_each(|&i| count(i));
        let without = self.sets.holds(counts);
        self.sets.set(counts, leaf, true);
        self.sets.holds(counts) != without
    }

    /// Whether a leaf holds a point: it begins to as often as it ends to, on a line that comes from infinity.
    fn leaf_holds(&self, leaf: &Leaf, p: Vec3, time: f32) -> bool {
        /// A direction that few edges have.
        const ASKEW: Vec3 = Vec3::new(0.561_7, 0.803_1, 0.198_9);
        let own = leaf.ray(&Ray { time, ..Ray::new(p, ASKEW).over(f32::NEG_INFINITY, f32::INFINITY) });
        let mut inside = self.shapes.starts_inside(leaf.shape, &own);
        self.shapes.crossings(leaf.shape, &own, &mut |hit| inside ^= hit.t < 0.0);
        inside
    }
}

impl Leaf {
    /// A ray in the leaf's own space.
    #[inline]
    fn ray(&self, ray: &Ray) -> Ray {
        self.in_place(ray.time, *ray, |ray, transform| transform.ray_in_object(&ray))
    }

    /// `value`, taken through `f` with the leaf's map at a ray's time where that is not the identity.
    #[inline]
    pub(super) fn in_place<T>(&self, time: f32, value: T, f: impl FnOnce(T, &Transform) -> T) -> T {
        match &self.transform {
            None => value,
            Some(LeafTransform::Still(transform)) => f(value, transform),
            Some(LeafTransform::Moving(motion)) => f(value, &motion.at(time)),
        }
    }
}

/// A ray, and the line that it is a piece of.
struct Line<'a> {
    solid: &'a Solid,
    /// From infinity to infinity.
    whole: Ray,
    /// The ray, and a little more at its ends, so that groups there are known in full.
    near: Ray,
    /// Error of a parameter of zero.
    at_origin: f32,
}

impl<'a> Line<'a> {
    fn new(solid: &'a Solid, ray: &Ray) -> Line<'a> {
        let size = ray.o.abs().max_element() + solid.reach;
        let at_origin = KNOWN * size / ray.d.abs().max_element();
        let whole = ray.over(f32::NEG_INFINITY, f32::INFINITY);
        let mut line = Line { solid, whole, near: *ray, at_origin };
        line.near = ray
            .over(ray.t_min - STEEPEST * line.error(ray.t_min), ray.t_max + STEEPEST * line.error(ray.t_max));
        line
    }

    /// How well a crossing is known where the surface is perpendicular to the ray.
    #[inline]
    fn error(&self, t: f32) -> f32 {
        self.at_origin + KNOWN * t.abs()
    }

    /// Whether two crossings, of which `b` is not nearer, are too near to each other to say which comes first.
    #[inline]
    fn coincide(&self, a: &Crossing, b: &Crossing) -> bool {
        let (gap, error) = (b.hit.t - a.hit.t, self.error(b.hit.t));
        gap <= error
            || (a.leaf != b.leaf && gap <= STEEPEST * error && self.coincide_slanting(a, b, gap / error))
    }

    /// The same for surfaces that the ray meets at an angle, along which errors across are longer.
    #[cold]
    fn coincide_slanting(&self, a: &Crossing, b: &Crossing, gap: f32) -> bool {
        let steepness = |crossing: &Crossing| {
            let leaf = &self.solid.leaves[crossing.leaf as usize];
            let n = self.solid.leaf_surface(leaf, &self.whole, &crossing.hit).ng;
            let d: DVec3 = self.whole.d.as_dvec3();
            (n.as_dvec3().dot(d).abs() / d.length()) as f32
        };
        gap * steepness(a).min(steepness(b)) <= 1.0
    }
}
