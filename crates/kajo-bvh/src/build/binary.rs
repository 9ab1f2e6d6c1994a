//! The binary tree that wide nodes are made of.
//!
//! Sets of primitives are split by the surface area heuristic until they fill a leaf block.
//! Large sets are binned and parted by all threads together and their halves built side by
//! side; a set below [`TASK`] is built by one thread into a [`Grove`] of its own. Every
//! decision depends on sizes and boxes alone, so the tree does not depend on the number of
//! threads.
//!
//! Most nodes are [`Twig`]s, in groves, of 32 bytes each; the few above are [`Stem`]s.

use kajo_math::Vec3;

use super::LeafShape;
use super::plan::Plan;
use super::prim::{Box4, Prim};
use super::split::{self, Split};

/// Sets up to this size are built by one thread.
pub(super) const TASK: usize = 1 << 13;
/// Most levels above the sets of one thread.
pub(super) const TOP_LEVELS: usize = 32;
/// Most levels within such a set.
pub(super) const TASK_LEVELS: usize = 32;
/// Most nodes on the way from the root to a leaf.
pub(crate) const MAX_LEVELS: usize = TOP_LEVELS + TASK_LEVELS;

/// A node of a grove. Its left child is the next one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Twig {
    lo: Vec3,
    hi: Vec3,
    /// Primitives below.
    len: u16,
    /// The right child; zero for a leaf.
    pub(super) right: u16,
    pub(super) plan: Plan,
}

impl Twig {
    /// A leaf of up to [`TASK`] primitives, until it gets a right child.
    pub(super) fn new(bounds: Box4, len: usize) -> Twig {
        let mut twig = Twig { lo: Vec3::ZERO, hi: Vec3::ZERO, len: len as u16, right: 0, plan: Plan::LEAF };
        twig.set_bounds(bounds);
        twig
    }

    pub(super) fn set_bounds(&mut self, bounds: Box4) {
        (self.lo, self.hi) = (bounds.lo.truncate(), bounds.hi.truncate());
    }

    pub(super) fn bounds(&self) -> Box4 {
        Box4 { lo: self.lo.extend(0.0), hi: self.hi.extend(0.0) }
    }

    pub(super) fn len(&self) -> usize {
        usize::from(self.len)
    }

    pub(super) fn set_len(&mut self, len: usize) {
        self.len = len as u16;
    }
}

/// A part of the binary tree, parents before children. It holds the twigs of its own spots only.
#[derive(Default)]
pub(super) struct Grove {
    pub(super) twigs: Vec<Twig>,
    /// Primitives from left to right.
    pub(super) ids: Vec<u32>,
    /// Whether a primitive may stand in the tree more than once.
    pub(super) cut: bool,
}

/// A node above the groves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stem {
    pub(super) bounds: Box4,
    pub(super) next: Next,
    pub(super) plan: Plan,
}

/// What follows a stem.
#[derive(Clone, Copy, Debug)]
pub(super) enum Next {
    /// The next stem and this one.
    Right(u32),
    /// It stands for this twig.
    Twig(Spot),
}

/// A twig's place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub(super) grove: u32,
    pub(super) twig: u32,
    /// Where its primitives begin among those of the grove.
    pub(super) first: u32,
}

impl Stem {
    pub(super) fn new(bounds: Box4, next: Next) -> Stem {
        Stem { bounds, next, plan: Plan::LEAF }
    }
}

/// The binary tree. It is empty or begins with the first stem.
#[derive(Default)]
pub(super) struct Forest {
    /// Parents before children.
    pub(super) stems: Vec<Stem>,
    pub(super) groves: Vec<Grove>,
}

/// The binary tree or a part of it, for what works on either.
pub(super) trait Binary {
    /// A node.
    type At: Copy;

    fn plan(&self, at: Self::At) -> Plan;

    /// The children of a node, unless it is a leaf.
    fn children(&self, at: Self::At) -> Option<[Self::At; 2]>;
}

/// A node of the binary tree.
#[derive(Clone, Copy, Debug)]
pub(super) enum At {
    /// A stem that does not stand for a twig.
    Stem(usize),
    Twig(Spot),
}

impl Forest {
    /// The root of a tree that is not empty.
    pub(super) fn root(&self) -> At {
        self.follow(0)
    }

    /// The node at a stem: the twig that it stands for, or itself.
    fn follow(&self, stem: usize) -> At {
        match self.stems[stem].next {
            Next::Twig(spot) => At::Twig(spot),
            Next::Right(_) => At::Stem(stem),
        }
    }

    pub(super) fn bounds(&self, at: At) -> Box4 {
        match at {
            At::Stem(place) => self.stems[place].bounds,
            At::Twig(spot) => self.twig(spot).bounds(),
        }
    }

    /// Whether a primitive may stand in it more than once.
    pub(super) fn is_cut(&self) -> bool {
        self.groves.iter().any(|grove| grove.cut)
    }

    /// The grove of a twig.
    pub(super) fn grove(&self, spot: Spot) -> &Grove {
        &self.groves[spot.grove as usize]
    }

    fn twig(&self, spot: Spot) -> &Twig {
        self.grove(spot).twig(spot)
    }

    /// Adds a grove, and a stem that stands for its root.
    pub(super) fn push(&mut self, grove: Grove) {
        let spot = Spot { grove: self.groves.len() as u32, twig: 0, first: 0 };
        self.stems.push(Stem::new(grove.twigs[0].bounds(), Next::Twig(spot)));
        self.groves.push(grove);
    }
}

impl Binary for Forest {
    type At = At;

    fn plan(&self, at: At) -> Plan {
        match at {
            At::Stem(place) => self.stems[place].plan,
            At::Twig(spot) => self.twig(spot).plan,
        }
    }

    fn children(&self, at: At) -> Option<[At; 2]> {
        match at {
            At::Stem(place) => match self.stems[place].next {
                Next::Right(right) => Some([self.follow(place + 1), self.follow(right as usize)]),
                Next::Twig(_) => None,
            },
            At::Twig(spot) => self.grove(spot).children(spot).map(|spots| spots.map(At::Twig)),
        }
    }
}

impl Binary for Grove {
    type At = Spot;

    #[inline]
    fn plan(&self, spot: Spot) -> Plan {
        self.twig(spot).plan
    }

    #[inline]
    fn children(&self, spot: Spot) -> Option<[Spot; 2]> {
        let twig = self.twig(spot);
        if twig.right == 0 {
            return None;
        }
        let left = Spot { twig: spot.twig + 1, ..spot };
        let first = spot.first + self.twig(left).len() as u32;
        Some([left, Spot { twig: u32::from(twig.right), first, ..spot }])
    }
}

/// A set of primitives on its way into the tree.
pub(super) struct Set<'a> {
    pub(super) prims: &'a mut [Prim],
    pub(super) bounds: Box4,
}

/// The upper part of the tree while it is built.
pub(super) enum Upper {
    Grove(Grove),
    Node(Box4, Box<[Upper; 2]>),
}

/// The binary tree over a set that is not empty.
pub(super) fn build(set: Set<'_>, shape: LeafShape) -> Forest {
    let mut forest = Forest::default();
    flatten(upper(set, shape, 0), &mut forest);
    forest
}

fn upper(set: Set<'_>, shape: LeafShape, depth: usize) -> Upper {
    if set.prims.len() <= TASK {
        let n = set.prims.len();
        let mut grove = Grove { twigs: Vec::with_capacity(n), ids: Vec::with_capacity(n), cut: false };
        grove.grow(set, shape, 0);
        grove.twigs.shrink_to_fit();
        return Upper::Grove(grove);
    }
    let bounds = set.bounds;
    let (left, right) = set.split(shape, TASK << (TOP_LEVELS - depth - 1).min(32));
    let (left, right) = rayon::join(|| upper(left, shape, depth + 1), || upper(right, shape, depth + 1));
    Upper::Node(bounds, Box::new([left, right]))
}

pub(super) fn flatten(upper: Upper, forest: &mut Forest) {
    match upper {
        Upper::Grove(grove) => forest.push(grove),
        Upper::Node(bounds, children) => {
            let place = forest.stems.len();
            forest.stems.push(Stem::new(bounds, Next::Right(0)));
            let [left, right] = *children;
            flatten(left, forest);
            forest.stems[place].next = Next::Right(forest.stems.len() as u32);
            flatten(right, forest);
        }
    }
}

impl Grove {
    #[inline]
    pub(super) fn twig(&self, spot: Spot) -> &Twig {
        &self.twigs[spot.twig as usize]
    }

    /// The primitives below a twig.
    #[inline]
    pub(super) fn ids(&self, spot: Spot) -> &[u32] {
        &self.ids[spot.first as usize..][..self.twig(spot).len()]
    }

    fn grow(&mut self, set: Set<'_>, shape: LeafShape, depth: usize) {
        let (place, len) = (self.twigs.len(), set.prims.len());
        self.twigs.push(Twig::new(set.bounds, len));
        if len <= shape.block() {
            self.ids.extend(set.prims.iter().map(Prim::id));
            return;
        }
        let (left, right) = set.split(shape, shape.block() << (TASK_LEVELS - depth - 1));
        self.grow(left, shape, depth + 1);
        self.twigs[place].right = self.twigs.len() as u16;
        self.grow(right, shape, depth + 1);
    }
}

impl<'a> Set<'a> {
    /// Two sets, not empty, by the cheapest split; two halves where there is none, or where a
    /// side could hold more than `most`, the primitives that fit below.
    fn split(self, shape: LeafShape, most: usize) -> (Set<'a>, Set<'a>) {
        let prims = self.prims;
        let best = if prims.len() > most { None } else { Split::best(prims, shape) };
        let Some(split) = best else {
            let (left, right) = prims.split_at_mut(prims.len() / 2);
            return (Set::around(left), Set::around(right));
        };
        split.part(prims);
        let (left, right) = prims.split_at_mut(split.left());
        let [bounds_left, bounds_right] = split.sides();
        (Set { prims: left, bounds: bounds_left }, Set { prims: right, bounds: bounds_right })
    }

    pub(super) fn around(prims: &'a mut [Prim]) -> Set<'a> {
        Set { bounds: split::bounds(prims), prims }
    }
}
