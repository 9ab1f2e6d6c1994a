//! The choice of lights by what is known to arrive.
//!
//! [`LightTree`](super::LightTree) chooses by estimates of what lights send, as if nothing were in the way: of a thousand lights, all but one
//! of them behind a wall, it draws that one once in a thousand times. So paths are followed before the picture is made, and for each region of the
//! scene it is counted how often light arrives that is drawn from a node of the tree,
//!
//! ```text
//! q = (arrived + 4 Q) / (drawn + 4)
//! ```
//!
//! where `Q` is the same of the region that this one is a half of, and in the whole scene
//!
//! ```text
//! q = (arrived + 1) / (drawn + 1)        1 / (drawn + 1)^2 where nothing arrived
//! ```
//!
//! Of nodes that have counted children it is the mean of theirs, each weighted by its share of draws by importance:
//! those that went by a table count by the ratio of the probabilities that the tree and the table give to the light.
//!
//! So it is 1 for what was never drawn. A wall hides everything or it is not there: that nothing at all arrives is as likely
//! beforehand as all shares above 0 together, and after `n` draws in vain the share that is to be expected falls by the
//! square of `n`. In a region in shadow, where nothing arrives, the lights that arrive elsewhere are still the likely
//! ones. The walk down the tree then goes by importance times `q`, after [Vévoda et al. 2018], who learn estimates of
//! clusters of lights for regions while they render. What was counted may be wrong for a point: one draw in ten goes by
//! importance alone, which bounds the weight of what arrives against all expectation to ten times that of the tree. The
//! probability of a light is that of the mixture, for the regions' tables are fixed before any light is drawn by them.
//! Between lights infinitely far away and the tree it is decided alike.

use std::array;

use kajo_math::{Aabb, Vec3, warp};

use crate::ids::LightIndex;

/// One draw of a light, and what became of it.
#[derive(Clone, Copy, Debug)]
pub struct LightDraw {
    /// Position of the receiver, world space.
    pub p: Vec3,
    /// The light.
    pub light: LightIndex,
    /// Probability of the light by [`LightSelection::Tree`](super::LightSelection::Tree) over that with which it was drawn.
    pub weight: f32,
    /// Whether anything of it got there.
    pub arrives: bool,
}

/// Share of draws that go by importance alone.
const BY_IMPORTANCE: f32 = 0.1;

/// A choice in steps by a mixture of two rules: by importance alone, and by what is known to arrive too.
///
/// The probability of a light is the sum of both, `0.1 product of s + 0.9 product of t` over the steps to it, and a
/// step is taken with the share that the mixture has given the steps before, so that one number in [0, 1) is enough for
/// both rules and what is near in it stays together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mixture([f32; 2]);

impl Mixture {
    /// Before the first step.
    pub const START: Mixture = Mixture([BY_IMPORTANCE, 1.0 - BY_IMPORTANCE]);

    /// The probability of the steps so far.
    #[inline]
    pub fn probability(self) -> f32 {
        let Mixture([a, b]) = self;
        a + b
    }

    /// After a step that each rule takes with a probability of its own.
    #[inline]
    pub fn after(self, probabilities: [f32; 2]) -> Mixture {
        let (Mixture([a, b]), [p, q]) = (self, probabilities);
        Mixture([a * p, b * q])
    }

    /// Chooses one of two children by the mixture; returns whether it was the first, the mixture after that, and `u` mapped back to [0, 1).
    ///
    /// * `shares`: of the first, by either rule
    /// * `u`: uniform in [0, 1)
    #[inline]
    pub fn step(self, shares: [f32; 2], u: f32) -> (bool, Mixture, f32) {
        let first = self.after(shares);
        let (is_first, u) = warp::choose(u, first.probability() / self.probability());
        let after = if is_first { first } else { self.after(shares.map(|share| 1.0 - share)) };
        (is_first, after, u)
    }
}

/// Nodes of the tree that are counted: the root has the number 1, the children of `k` have `2 k` and `2 k + 1`.
const NODES: usize = 256;

/// Number of training draws from which on a region is divided.
const DRAWS: usize = 512;

/// Weight of the estimate of the region above as a prior, in draws.
const PRIOR: f32 = 4.0;

/// Levels of regions.
const DEEPEST: u32 = 12;

/// How often light arrives that is drawn for a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RegionVisibility<'a> {
    /// The roots of those of the background, of other lights infinitely far away, and of all lights that have a position: irradiances count by
    /// their roots there.
    pub parts: [f32; 3],
    /// Of the nodes of the tree, by their numbers.
    nodes: &'a [f32],
}

impl RegionVisibility<'_> {
    /// Of the two children of a node, with the number of the first; of nodes too deep to be counted nothing is known.
    #[inline]
    pub fn children(&self, node: usize) -> ([f32; 2], usize) {
        let first = 2 * node;
        match self.nodes.get(first..first + 2) {
            Some(&[a, b]) => ([a, b], first),
            _ => ([1.0; 2], NODES),
        }
    }
}

/// The number of the root.
pub(super) const ROOT: usize = 1;

/// For regions of a scene, how often light arrives that is drawn from parts of its lights.
#[derive(Clone, Debug, PartialEq)]
pub struct LightVisibility {
    /// Of inner region `i` the first half is `i + 1`.
    regions: Vec<Region>,
    /// For each undivided region the roots of the shares of the parts.
    parts: Vec<[f32; 3]>,
    /// For each undivided region the shares of the nodes.
    nodes: Vec<f32>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Region {
    /// Positions below `at` along the axis are in the next region, others in that of the index `second`.
    Divided { axis: usize, at: f32, second: u32 },
    /// The number among those that are not divided.
    Undivided(u32),
}

/// What part of the lights one belongs to: an index of [`RegionVisibility::parts`], and the turns to it from the root of the tree.
#[derive(Clone, Copy, Debug)]
pub(super) enum LightPart {
    Background,
    Directional,
    InTree { trail: u64 },
}

/// Numbers of draws.
#[derive(Clone, Copy, Default)]
struct Count {
    drawn: u32,
    arrived: u32,
    /// How many of them there would be by importance.
    weight: f64,
}

impl Count {
    fn add(&mut self, draw: &LightDraw) {
        self.drawn += 1;
        self.arrived += u32::from(draw.arrives);
        self.weight += f64::from(draw.weight);
    }

    /// What is to be expected in the whole scene.
    fn share(self) -> f32 {
        let all = (self.drawn + 1) as f32;
        let share = (self.arrived + 1) as f32 / all;
        if self.arrived == 0 { share / all } else { share }
    }

    /// What is to be expected in a half of a region where `expected` is.
    fn share_within(self, expected: f32) -> f32 {
        (self.arrived as f32 + PRIOR * expected) / (self.drawn as f32 + PRIOR)
    }
}

impl LightVisibility {
    /// * `draws`: their order decides no more than last bits
    pub(super) fn learn(
        mut draws: Vec<LightDraw>,
        part: impl Fn(LightIndex) -> LightPart,
    ) -> LightVisibility {
        let mut learned = LightVisibility { regions: Vec::new(), parts: Vec::new(), nodes: Vec::new() };
        draws.retain(|draw| draw.p.is_finite());
        let counts = Counts::of(&draws, &part);
        let shares = Shares { parts: counts.parts.map(Count::share), nodes: counts.nodes.map(Count::share) };
        learned.add(&mut draws, &part, &counts, &shares, 0);
        learned
    }

    /// Bytes of the tables.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.regions) + size_of_val(&*self.parts) + size_of_val(&*self.nodes)
    }

    /// What is known of the region that a point is in.
    #[inline]
    pub(super) fn region(&self, p: Vec3) -> RegionVisibility<'_> {
        let mut i = 0;
        loop {
            match self.regions[i] {
                Region::Divided { axis, at, second } => {
                    i = if p[axis] < at { i + 1 } else { second as usize }
                }
                Region::Undivided(k) => {
                    let k = k as usize;
                    return RegionVisibility {
                        parts: self.parts[k],
                        nodes: &self.nodes[k * NODES..][..NODES],
                    };
                }
            }
        }
    }

    /// Adds the region that holds some draws, and its halves.
    fn add(
        &mut self,
        draws: &mut [LightDraw],
        part: &impl Fn(LightIndex) -> LightPart,
        counts: &Counts,
        shares: &Shares,
        depth: u32,
    ) {
        let Some((axis, at)) = division(draws, depth) else {
            let shares = shares.averaged(counts);
            self.regions.push(Region::Undivided(self.parts.len() as u32));
            let [background, directional] = shares.parts;
            self.parts.push([background, directional, shares.nodes[ROOT]].map(f32::sqrt));
            return self.nodes.extend(shares.nodes);
        };
        let (here, first) = (self.regions.len(), partition(draws, |draw| draw.p[axis] < at));
        self.regions.push(Region::Undivided(0));
        let (first, second) = draws.split_at_mut(first);
        let counts = Counts::of(first, part);
        self.add(first, part, &counts, &shares.within(&counts), depth + 1);
        self.regions[here] = Region::Divided { axis, at, second: self.regions.len() as u32 };
        let counts = Counts::of(second, part);
        self.add(second, part, &counts, &shares.within(&counts), depth + 1);
    }
}

/// Numbers of draws in a region, by the parts of the lights.
struct Counts {
    parts: [Count; 2],
    nodes: [Count; NODES],
}

impl Counts {
    fn of(draws: &[LightDraw], part: impl Fn(LightIndex) -> LightPart) -> Counts {
        let mut counts = Counts { parts: [Count::default(); 2], nodes: [Count::default(); NODES] };
        for draw in draws {
            let trail = match part(draw.light) {
                LightPart::Background => {
                    counts.parts[0].add(draw);
                    continue;
                }
                LightPart::Directional => {
                    counts.parts[1].add(draw);
                    continue;
                }
                LightPart::InTree { trail } => trail,
            };
            // Beyond a light the turns are 0, and no walk gets to those numbers.
            let (mut node, mut trail) = (ROOT, trail);
            while node < NODES {
                counts.nodes[node].add(draw);
                (node, trail) = (2 * node + (trail & 1) as usize, trail >> 1);
            }
        }
        counts
    }
}

/// What of the parts of the lights is to be expected in a region.
struct Shares {
    /// Of the background and of directional lights.
    parts: [f32; 2],
    nodes: [f32; NODES],
}

impl Shares {
    /// The same in a half of the region.
    fn within(&self, counts: &Counts) -> Shares {
        Shares {
            parts: array::from_fn(|i| counts.parts[i].share_within(self.parts[i])),
            nodes: array::from_fn(|i| counts.nodes[i].share_within(self.nodes[i])),
        }
    }

    /// The same with means in place of what was counted of nodes that have children.
    fn averaged(&self, counts: &Counts) -> Shares {
        let mut nodes = self.nodes;
        for node in (ROOT..NODES / 2).rev() {
            let children = [2 * node, 2 * node + 1];
            let [a, b] = children.map(|child| counts.nodes[child].weight);
            if a + b > 0.0 {
                let [p, q] = children.map(|child| f64::from(nodes[child]));
                nodes[node] = ((a * p + b * q) / (a + b)) as f32;
            }
        }
        Shares { parts: self.parts, nodes }
    }
}

/// Where a region is divided so that both halves have as many draws; `None` where it is not.
fn division(draws: &mut [LightDraw], depth: u32) -> Option<(usize, f32)> {
    if draws.len() < 2 * DRAWS || depth == DEEPEST {
        return None;
    }
    let extent = Aabb::around(draws.iter().map(|draw| draw.p)).extent();
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b]))?;
    let middle = draws.len() / 2;
    let (_, draw, _) = draws.select_nth_unstable_by(middle, |a, b| a.p[axis].total_cmp(&b.p[axis]));
    let at = draw.p[axis];
    draws.iter().any(|draw| draw.p[axis] < at).then_some((axis, at))
}

/// Puts those that `is_first` holds for first; returns how many these are.
fn partition(draws: &mut [LightDraw], is_first: impl Fn(&LightDraw) -> bool) -> usize {
    let mut n = 0;
    for i in 0..draws.len() {
        if is_first(&draws[i]) {
            draws.swap(i, n);
            n += 1;
        }
    }
    n
}
