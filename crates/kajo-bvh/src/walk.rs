//! Walks of a ray through a tree.

use kajo_math::{Aabb, Ray, Vec3};

use crate::Stats;
use crate::array::Array;
use crate::build::MAX_LEVELS;
use crate::node::{Child, Node, WIDTH, Wide};
use crate::simd::{Simd, Stack};
use crate::slabs::Slabs;

/// Children that can wait at the same time: all but one of each node on the way to a leaf,
/// and the wide tree is no deeper than the binary one.
pub(crate) const WAITING: usize = MAX_LEVELS * (WIDTH - 1) + 1;

/// The inner nodes of a finished tree. What its leaves hold is known to the owner.
#[derive(Clone, Debug)]
pub(crate) struct Tree<N: Wide = Node> {
    /// Parents before children.
    pub(crate) nodes: Array<N>,
    /// `None` when there is nothing to hit.
    pub(crate) root: Option<Child>,
    pub(crate) bounds: Aabb,
    pub(crate) depth: usize,
}

/// A child that waits, by a number that leads to it, with the parameter at which the ray enters
/// its box.
#[derive(Clone, Copy)]
pub(crate) struct Waiting(u64);

impl Waiting {
    #[inline(always)]
    fn new(near: f32, number: u32) -> Waiting {
        Waiting(u64::from(near.to_bits()) << 32 | u64::from(number))
    }

    #[inline(always)]
    pub(crate) fn near(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    #[inline(always)]
    pub(crate) fn number(self) -> u32 {
        self.0 as u32
    }

    /// The two, nearer one first. Entries before the ray's origin, of rays that reach
    /// backwards, come in the wrong order: slower, not wrong.
    #[inline(always)]
    fn sorted(a: Waiting, b: Waiting) -> (Waiting, Waiting) {
        (Waiting(a.0.min(b.0)), Waiting(a.0.max(b.0)))
    }
}

/// The numbers of the bits that are set, lowest first.
#[inline(always)]
pub(crate) fn take_lowest(bits: &mut u32) -> usize {
    let lowest = bits.trailing_zeros() as usize;
    *bits &= *bits - 1;
    lowest & (WIDTH - 1)
}

impl<N: Wide> Tree<N> {
    pub(crate) const EMPTY: Tree<N> = Tree { nodes: Array::EMPTY, root: None, bounds: Aabb::EMPTY, depth: 0 };

    /// Largest absolute coordinate on each axis.
    #[inline(always)]
    pub(crate) fn reach(&self) -> Vec3 {
        self.bounds.min.abs().max(self.bounds.max.abs())
    }

    /// Size, depth and memory of a tree over so many leaves that left out so many primitives.
    pub(crate) fn stats(&self, leaves: usize, dropped: usize) -> Stats {
        let bytes = size_of_val(&*self.nodes);
        Stats { nodes: self.nodes.len(), leaves, depth: self.depth, dropped, bytes }
    }

    /// Visits leaves whose boxes the ray meets before `t_max`, nearest box first. `leaf`
    /// answers the new `t_max`.
    ///
    /// * `size`: of numbers that went into the ray besides its own, on each axis
    #[inline(always)]
    pub(crate) fn nearest<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        size: Vec3,
        mut leaf: impl FnMut(u32, f32) -> f32,
    ) {
        let slabs = Slabs::new::<N>(simd, ray, self.reach() + size);
        let (Some(root), Some(slabs)) = (self.root, slabs) else { return };
        let mut stack = Stack::<Waiting, WAITING>::new();
        let nodes = &*self.nodes;
        let mut t_max = ray.t_max;
        let mut current = root;
        loop {
            if !current.is_leaf() {
                let node = &nodes[current.index() as usize];
                let (mask, near) = slabs.intersect(node, t_max);
                if mask != 0 {
                    current = if mask & (mask - 1) == 0 {
                        node.child(mask.trailing_zeros() as usize)
                    } else {
                        Child(descend(mask, &simd.store(near), &mut stack, |slot| node.child(slot).0))
                    };
                    continue;
                }
            } else {
                t_max = leaf(current.index(), t_max);
            }
            // Boxes entered exactly at `t_max` may hold an equally near hit.
            current = loop {
                let Some(waiting) = stack.pop() else { return };
                if waiting.near() <= t_max {
                    break Child(waiting.number());
                }
            };
        }
    }

    /// Visits leaves whose boxes the ray meets until `leaf` is true of one, and tells whether
    /// that happened.
    ///
    /// * `size`: as for [`Tree::nearest`]
    #[inline(always)]
    pub(crate) fn any<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        size: Vec3,
        mut leaf: impl FnMut(u32) -> bool,
    ) -> bool {
        let slabs = Slabs::new::<N>(simd, ray, self.reach() + size);
        let (Some(root), Some(slabs)) = (self.root, slabs) else { return false };
        let mut stack = Stack::<Child, WAITING>::new();
        let nodes = &*self.nodes;
        let mut current = root;
        loop {
            if !current.is_leaf() {
                let node = &nodes[current.index() as usize];
                let (mut mask, _) = slabs.intersect(node, ray.t_max);
                if mask != 0 {
                    current = node.child(take_lowest(&mut mask));
                    while mask != 0 {
                        stack.push(node.child(take_lowest(&mut mask)));
                    }
                    continue;
                }
            } else if leaf(current.index()) {
                return true;
            }
            match stack.pop() {
                Some(child) => current = child,
                None => return false,
            }
        }
    }
}

/// The number of the nearest of the children in `mask`, which holds at least two; the others
/// wait on the stack, nearest on top.
#[inline(always)]
pub(crate) fn descend(
    mut mask: u32,
    near: &[f32; WIDTH],
    stack: &mut Stack<Waiting, WAITING>,
    number: impl Fn(usize) -> u32,
) -> u32 {
    let mut next = || {
        let slot = take_lowest(&mut mask);
        (Waiting::new(near[slot], number(slot)), mask == 0)
    };
    let (a, _) = next();
    let (b, last) = next();
    let (a, b) = Waiting::sorted(a, b);
    if last {
        stack.push(b);
        return a.number();
    }
    let (c, last) = next();
    let (b, c) = Waiting::sorted(b, c);
    let (a, b) = Waiting::sorted(a, b);
    if last {
        stack.push(c);
        stack.push(b);
        return a.number();
    }
    let start = stack.len();
    stack.push(c);
    stack.push(b);
    stack.push(a);
    loop {
        let (d, last) = next();
        stack.push(d);
        let waiting = stack.from(start);
        let mut index = waiting.len() - 1;
        while index > 0 && waiting[index - 1].0 < d.0 {
            waiting[index] = waiting[index - 1];
            index -= 1;
        }
        waiting[index] = d;
        if last {
            break;
        }
    }
    match stack.pop() {
        Some(nearest) => nearest.number(),
        None => a.number(),
    }
}
