//! The choice of one light among many that have a position.
//!
//! A binary tree over the lights; a walk from the root goes to each child with a probability proportional to an estimate of what it
//! sends to the receiver: see `cluster.rs`. What few lights send is the sum of what each of them does: an estimate for them as one does not
//! know that a spot light shines past the receiver, or that a ray passes one of them closely. The layout and the cost
//! of a split follow [Conty Estévez and Kulla 2018] and [Pharr et al. 2023, 12.6]. Lights infinitely far away stand
//! beside the tree: see `infinite.rs`.

use std::f32::consts::PI;

use kajo_math::{Aabb, warp};

use super::cluster::{LightCluster, LightMoments, LightQuery};
use super::segment::{AngularSpan, RaySegment};
use super::visibility::{self, Mixture, RegionVisibility};
use super::{LightBounds, SampledLight};
use crate::ids::LightIndex;

/// The lights of a scene that have a position, ready to be chosen from.
#[derive(Debug, Default)]
pub struct LightTree {
    /// Of inner node `i` the first child is `i + 1`.
    nodes: Vec<Node>,
    /// For each light of the scene the turns from the root to its leaf, first turn in bit 0.
    trails: Vec<u64>,
    /// Whether all lights fall off by the square of the distance.
    is_inverse_square: bool,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    cluster: LightCluster,
    content: NodeContent,
}

#[derive(Clone, Copy, Debug)]
enum NodeContent {
    /// The first child is the next node.
    Inner {
        /// Index of the second child.
        second: u32,
        /// Number of lights below, if each of them is looked at, or 0.
        few: u8,
    },
    Leaf(LightIndex),
}

/// A light that has a position, and its bounds.
#[derive(Clone, Copy, Debug)]
struct PlacedLight {
    light: LightIndex,
    bounds: LightBounds,
}

/// More turns than a tree of 2^32 balanced lights has; deeper branches are split in halves from here on.
const DEEPEST_BY_COST: u32 = 30;

/// The trail of a light that is never chosen.
const NEVER: u64 = u64::MAX;

const BUCKETS: usize = 12;

/// The most lights that are each looked at.
const FEW: usize = 8;

impl LightTree {
    /// The tree over lights given by their bounds; `None` for those infinitely far away, which are not in it.
    ///
    /// Nor are lights that give none.
    pub fn build(lights: &[Option<LightBounds>]) -> LightTree {
        let mut tree = LightTree { trails: vec![NEVER; lights.len()], ..LightTree::default() };
        let is_light = |bounds: &LightBounds| bounds.power > 0.0 && bounds.bounds.is_finite();
        let placed = LightIndex::all(lights.len()).zip(lights);
        let placed = placed.filter_map(|(light, bounds)| {
            bounds.filter(is_light).map(|bounds| PlacedLight { light, bounds })
        });
        let mut placed: Vec<_> = placed.collect();
        tree.is_inverse_square = placed.iter().all(|light| light.bounds.is_inverse_square);
        tree.add(&mut placed, 0, 0);
        tree
    }

    /// Whether there is no light.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Whether a light is in it.
    pub fn has(&self, light: LightIndex) -> bool {
        self.trails[light.index()] != NEVER
    }

    /// Bytes of the tree.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.trails)
    }

    /// What the root leads to.
    #[inline]
    pub(super) fn first_step(&self, to: &impl LightQuery) -> FirstStep {
        let mut walk = LightWalk::at(self, 0, to);
        if let Some(&Node { cluster, content: NodeContent::Leaf(_) }) = self.nodes.first() {
            walk.importances[0] = to.importance(&cluster);
        }
        FirstStep { walk, is_inverse_square: self.is_inverse_square }
    }

    /// Chooses a light for a receiver; `None` when none can reach it.
    ///
    /// * `step`: that of the receiver
    /// * `u`: uniform in [0, 1)
    #[inline]
    pub(super) fn sample(&self, to: &impl LightQuery, step: &FirstStep, mut u: f32) -> Option<SampledLight> {
        let (mut walk, mut probability) = (step.walk, 1.0);
        loop {
            if let NodeContent::Leaf(light) = self.nodes.get(walk.at)?.content {
                return Some(SampledLight::new(light, probability, u));
            }
            let share = walk.share_of_first()?;
            let is_first;
            (is_first, u) = warp::choose(u, share);
            probability *= if is_first { share } else { 1.0 - share };
            walk.turn(self, is_first, to);
        }
    }

    /// The probability with which [`LightTree::sample`] chooses a light for a receiver.
    #[inline]
    pub(super) fn pmf(&self, light: LightIndex, to: &impl LightQuery, step: &FirstStep) -> f32 {
        let Some(mut trail) = self.trail(light) else { return 0.0 };
        let (mut walk, mut probability) = (step.walk, 1.0);
        while let NodeContent::Inner { .. } = self.nodes[walk.at].content {
            let Some(share) = walk.share_of_first() else { return 0.0 };
            let is_first = trail & 1 == 0;
            probability *= if is_first { share } else { 1.0 - share };
            walk.turn(self, is_first, to);
            trail >>= 1;
        }
        probability
    }

    /// As [`LightTree::sample`], by a mixture that knows what arrives.
    #[inline(never)]
    pub(super) fn sample_learned(
        &self,
        to: &impl LightQuery,
        step: &FirstStep,
        mut u: f32,
        known: &RegionVisibility<'_>,
        mut mixture: Mixture,
    ) -> Option<SampledLight> {
        let (mut walk, mut node) = (step.walk, visibility::ROOT);
        loop {
            if let NodeContent::Leaf(light) = self.nodes.get(walk.at)?.content {
                return Some(SampledLight::new(light, mixture.probability(), u));
            }
            let (shares, first) = learned_shares(walk.importances, known, node)?;
            let is_first;
            (is_first, mixture, u) = mixture.step(shares, u);
            node = if is_first { first } else { first + 1 };
            walk.turn(self, is_first, to);
        }
    }

    /// The probability with which [`LightTree::sample_learned`] chooses a light for a receiver.
    #[inline(never)]
    pub(super) fn pmf_learned(
        &self,
        light: LightIndex,
        to: &impl LightQuery,
        step: &FirstStep,
        known: &RegionVisibility<'_>,
        mut mixture: Mixture,
    ) -> f32 {
        let Some(mut trail) = self.trail(light) else { return 0.0 };
        let (mut walk, mut node) = (step.walk, visibility::ROOT);
        while let NodeContent::Inner { .. } = self.nodes[walk.at].content {
            let Some((shares, first)) = learned_shares(walk.importances, known, node) else { return 0.0 };
            let is_first = trail & 1 == 0;
            mixture = mixture.after(if is_first { shares } else { shares.map(|share| 1.0 - share) });
            node = if is_first { first } else { first + 1 };
            walk.turn(self, is_first, to);
            trail >>= 1;
        }
        mixture.probability()
    }

    /// The turns from the root to a light of the tree, first turn in bit 0.
    pub(super) fn trail(&self, light: LightIndex) -> Option<u64> {
        self.trails.get(light.index()).copied().filter(|&trail| trail != NEVER)
    }

    /// How a light sees a piece of a ray; `None` where it does not, or is not in the tree.
    pub(super) fn seen_from(&self, light: LightIndex, segment: &RaySegment) -> Option<AngularSpan> {
        let mut trail = self.trail(light)?;
        let mut at = 0;
        while let NodeContent::Inner { second, .. } = self.nodes[at].content {
            at = if trail & 1 == 0 { at + 1 } else { second as usize };
            trail >>= 1;
        }
        self.nodes[at].cluster.seen_from(segment)
    }

    /// Adds the subtree over some lights.
    fn add(&mut self, lights: &mut [PlacedLight], trail: u64, depth: u32) {
        let each = lights.iter().map(|light| (light.bounds, LightMoments::of(&light.bounds)));
        let sum = each.reduce(|(bounds, moments), other| (bounds.union(other.0), moments.union(other.1)));
        let Some((bounds, moments)) = sum else { return };
        let (at, cluster) = (self.nodes.len(), LightCluster::new(&bounds, &moments));
        if let [PlacedLight { light, .. }] = *lights {
            self.trails[light.index()] = trail;
            self.nodes.push(Node { cluster, content: NodeContent::Leaf(light) });
            return;
        }
        let few = if lights.len() <= FEW { lights.len() as u8 } else { 0 };
        self.nodes.push(Node { cluster, content: NodeContent::Inner { second: 0, few } });
        let middle = part(lights, &bounds, depth);
        let (first, second) = lights.split_at_mut(middle);
        self.add(first, trail, depth + 1);
        self.nodes[at].content = NodeContent::Inner { second: self.nodes.len() as u32, few };
        self.add(second, trail | 1 << depth, depth + 1);
    }
}

/// A walk from the root towards a light.
#[derive(Clone, Copy, Debug, Default)]
struct LightWalk {
    /// The node that it has come to.
    at: usize,
    /// Of the node's children for the receiver, or of the root alone where that is a light; 0 at other leaves.
    importances: [f32; 2],
    /// Of each of few lights, those of the node from `begin` to `end`; of more lights none is looked at.
    each: [f32; FEW],
    begin: usize,
    end: usize,
}

impl LightWalk {
    /// The walk that has come to a node out of one with many lights.
    #[inline]
    fn at(tree: &LightTree, at: usize, to: &impl LightQuery) -> LightWalk {
        let mut walk = LightWalk { at, ..LightWalk::default() };
        let Some(&NodeContent::Inner { second, few }) = tree.nodes.get(at).map(|node| &node.content) else {
            return walk;
        };
        if few == 0 {
            let importance = |at: usize| to.importance(&tree.nodes[at].cluster);
            walk.importances = [importance(at + 1), importance(second as usize)];
            return walk;
        }
        // The nodes below one follow it.
        walk.end = usize::from(few);
        let below = tree.nodes.iter().skip(at + 1);
        let lights = below.filter(|node| matches!(node.content, NodeContent::Leaf(_)));
        for (importance, node) in walk.each[..walk.end].iter_mut().zip(lights) {
            *importance = to.importance(&node.cluster);
        }
        walk.add_up(tree);
        walk
    }

    /// Goes to a child of the node.
    #[inline]
    fn turn(&mut self, tree: &LightTree, is_first: bool, to: &impl LightQuery) {
        let NodeContent::Inner { second, .. } = tree.nodes[self.at].content else { return };
        let next = if is_first { self.at + 1 } else { second as usize };
        if self.end == 0 {
            *self = LightWalk::at(tree, next, to);
            return;
        }
        let middle = self.middle(second);
        let part = if is_first { &mut self.end } else { &mut self.begin };
        *part = middle;
        self.at = next;
        self.add_up(tree);
    }

    /// The first light of the second child among few.
    #[inline]
    fn middle(&self, second: u32) -> usize {
        self.begin + (second as usize - self.at) / 2
    }

    /// Adds up the importances of few lights for the node's children.
    #[inline]
    fn add_up(&mut self, tree: &LightTree) {
        let NodeContent::Inner { second, .. } = tree.nodes[self.at].content else { return };
        let sum = |part: &[f32]| part.iter().sum();
        let middle = self.middle(second);
        self.importances = [sum(&self.each[self.begin..middle]), sum(&self.each[middle..self.end])];
    }

    /// The probability of the first child; `None` when neither reaches the receiver.
    #[inline]
    fn share_of_first(&self) -> Option<f32> {
        share_of_first(self.importances)
    }
}

/// The first step of a walk from the root.
#[derive(Clone, Copy, Debug)]
pub(super) struct FirstStep {
    walk: LightWalk,
    is_inverse_square: bool,
}

impl FirstStep {
    /// About the irradiance that all lights of the tree make where nothing is in the way, as if each were
    /// a surface that sends its power to one side; `None` where it cannot be told.
    #[inline]
    pub fn irradiance(&self) -> Option<f32> {
        let [first, second] = self.walk.importances;
        self.is_inverse_square.then_some((first + second).min(f32::MAX) / PI)
    }
}

#[inline]
fn share_of_first([first, second]: [f32; 2]) -> Option<f32> {
    let sum = first + second;
    (sum > 0.0).then(|| first / sum)
}

/// The probability of the first of two children by their importance, and by what of it is known to arrive; with the number of the first.
#[inline]
fn learned_shares(
    importances: [f32; 2],
    known: &RegionVisibility<'_>,
    node: usize,
) -> Option<([f32; 2], usize)> {
    let ([q, r], first) = known.children(node);
    let [a, b] = importances;
    let by_importance = share_of_first(importances)?;
    Some(([by_importance, share_of_first([a * q, b * r]).unwrap_or(by_importance)], first))
}

/// Sorts the lights of a node into two parts; returns the length of the first, at least 1.
fn part(lights: &mut [PlacedLight], all: &LightBounds, depth: u32) -> usize {
    let centers = Aabb::around(lights.iter().map(|light| light.bounds.bounds.center()));
    let best = (0..3)
        .filter(|&axis| centers.extent()[axis] > 0.0 && depth < DEEPEST_BY_COST)
        .filter_map(|axis| cheapest_split(lights, all, &centers, axis).map(|(cost, at)| (cost, axis, at)))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((_, axis, split)) = best {
        lights.sort_by_key(|light| (bucket(&light.bounds, &centers, axis), light.light));
        let middle = lights.partition_point(|light| bucket(&light.bounds, &centers, axis) <= split);
        if middle > 0 && middle < lights.len() {
            return middle;
        }
    }
    lights.len() / 2
}

fn bucket(light: &LightBounds, centers: &Aabb, axis: usize) -> usize {
    let share = (light.bounds.center()[axis] - centers.min[axis]) / centers.extent()[axis];
    ((share * BUCKETS as f32) as usize).min(BUCKETS - 1)
}

/// The cheapest of the splits between buckets along an axis, by its last bucket on the near side.
fn cheapest_split(
    lights: &[PlacedLight],
    all: &LightBounds,
    centers: &Aabb,
    axis: usize,
) -> Option<(f32, usize)> {
    let mut buckets = [None::<LightBounds>; BUCKETS];
    for &PlacedLight { bounds, .. } in lights {
        let bucket = &mut buckets[bucket(&bounds, centers, axis)];
        *bucket = Some(bucket.map_or(bounds, |sum| sum.union(bounds)));
    }
    let extent = all.bounds.extent();
    // Thin slabs cost more than their areas say.
    let shape = extent.max_element() / extent[axis].max(f32::MIN_POSITIVE);
    let cost = |part: &[Option<LightBounds>]| {
        part.iter().flatten().copied().reduce(LightBounds::union).map(|sum| sum.cost())
    };
    (0..BUCKETS - 1)
        .filter_map(|split| {
            let (near, far) = buckets.split_at(split + 1);
            Some((shape * (cost(near)? + cost(far)?), split))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
}

#[cfg(test)]
mod tests;
