//! The choice of one light among many that have a position.
//!
//! A binary tree over the lights; a walk from the root goes to each child with a probability proportional to an estimate of what it
//! sends to the receiver: see `cluster.rs`. The layout and the cost of a split follow [Conty Estévez and Kulla 2018] and
//! [Pharr et al. 2023, 12.6]. Lights infinitely far away stand beside the tree: see `infinite.rs`.

use std::f32::consts::PI;

use kajo_math::{Aabb, warp};

use super::cluster::{LightCluster, LightMoments, LightQuery};
use super::visibility::{self, Mixture, RegionVisibility};
use super::{LightBounds, SampledLight};
use crate::ids::LightIndex;

/// The lights of a scene that have a position, ready to be chosen from.
#[derive(Debug, Default)]
pub struct LightTree {
    /// Of inner node `i` the first child is `i + 1`.
    pub(super) nodes: Vec<Node>,
    /// For each light of the scene the turns from the root to its leaf, first turn in bit 0.
    trails: Vec<u64>,
    /// Whether all lights fall off by the square of the distance.
    is_inverse_square: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub cluster: LightCluster,
    pub content: NodeContent,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum NodeContent {
    /// The first child is the next node, the second one stands at this index.
    Inner {
        second: u32,
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
        let Some(root) = self.nodes.first() else { return FirstStep::NONE };
        let importance = |at: usize| to.importance(&self.nodes[at].cluster);
        let importances = match root.content {
            NodeContent::Leaf(_) => [importance(0), 0.0],
            NodeContent::Inner { second } => [importance(1), importance(second as usize)],
        };
        FirstStep { importances, is_inverse_square: self.is_inverse_square }
    }

    /// Chooses a light for a receiver; `None` when none can reach it.
    ///
    /// * `step`: that of the receiver
    /// * `u`: uniform in [0, 1)
    #[inline]
    pub(super) fn sample(&self, to: &impl LightQuery, step: &FirstStep, mut u: f32) -> Option<SampledLight> {
        let (mut at, mut probability) = (0, 1.0);
        let mut first = step.share_of_first();
        loop {
            let second = match self.nodes.get(at)?.content {
                NodeContent::Leaf(light) => return Some(SampledLight::new(light, probability, u)),
                NodeContent::Inner { second } => second as usize,
            };
            let share = first?;
            let is_first;
            (is_first, u) = warp::choose(u, share);
            if is_first {
                probability *= share;
                at += 1;
            } else {
                probability *= 1.0 - share;
                at = second;
            }
            first = self.share_of_first(at, to);
        }
    }

    /// The probability with which [`LightTree::sample`] chooses a light for a receiver.
    #[inline]
    pub(super) fn pmf(&self, light: LightIndex, to: &impl LightQuery, step: &FirstStep) -> f32 {
        let mut trail = self.trails[light.index()];
        if trail == NEVER {
            return 0.0;
        }
        let (mut at, mut probability) = (0, 1.0);
        let mut first = step.share_of_first();
        loop {
            let NodeContent::Inner { second } = self.nodes[at].content else { return probability };
            let Some(share) = first else { return 0.0 };
            if trail & 1 == 0 {
                probability *= share;
                at += 1;
            } else {
                probability *= 1.0 - share;
                at = second as usize;
            }
            trail >>= 1;
            first = self.share_of_first(at, to);
        }
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
        let (mut at, mut node, mut importances) = (0, visibility::ROOT, step.importances);
        loop {
            let second = match self.nodes.get(at)?.content {
                NodeContent::Leaf(light) => return Some(SampledLight::new(light, mixture.probability(), u)),
                NodeContent::Inner { second } => second as usize,
            };
            let (shares, first) = learned_shares(importances, known, node)?;
            let is_first;
            (is_first, mixture, u) = mixture.step(shares, u);
            (at, node) = if is_first { (at + 1, first) } else { (second, first + 1) };
            importances = self.importances_below(at, to);
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
        let mut trail = self.trails[light.index()];
        if trail == NEVER {
            return 0.0;
        }
        let (mut at, mut node, mut importances) = (0, visibility::ROOT, step.importances);
        loop {
            let NodeContent::Inner { second } = self.nodes[at].content else { return mixture.probability() };
            let Some((shares, first)) = learned_shares(importances, known, node) else { return 0.0 };
            if trail & 1 == 0 {
                mixture = mixture.after(shares);
                (at, node) = (at + 1, first);
            } else {
                mixture = mixture.after(shares.map(|share| 1.0 - share));
                (at, node) = (second as usize, first + 1);
            }
            trail >>= 1;
            importances = self.importances_below(at, to);
        }
    }

    /// The turns from the root to a light of the tree, first turn in bit 0.
    pub(super) fn trail(&self, light: LightIndex) -> Option<u64> {
        self.trails.get(light.index()).copied().filter(|&trail| trail != NEVER)
    }

    /// What a node's two children may send to a receiver; nothing where it has none.
    #[inline]
    fn importances_below(&self, at: usize, to: &impl LightQuery) -> [f32; 2] {
        let NodeContent::Inner { second } = self.nodes[at].content else { return [0.0; 2] };
        [at + 1, second as usize].map(|at| to.importance(&self.nodes[at].cluster))
    }

    /// The probability of the first of a node's two children; `None` when neither reaches the receiver, or it has none.
    #[inline]
    pub(super) fn share_of_first(&self, at: usize, to: &impl LightQuery) -> Option<f32> {
        share_of_first(self.importances_below(at, to))
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
        self.nodes.push(Node { cluster, content: NodeContent::Inner { second: 0 } });
        let middle = part(lights, &bounds, depth);
        let (first, second) = lights.split_at_mut(middle);
        self.add(first, trail, depth + 1);
        self.nodes[at].content = NodeContent::Inner { second: self.nodes.len() as u32 };
        self.add(second, trail | 1 << depth, depth + 1);
    }
}

/// The first step of a walk from the root.
#[derive(Clone, Copy, Debug)]
pub(super) struct FirstStep {
    /// Of the root's children for the receiver; where the root is a light, of that.
    importances: [f32; 2],
    is_inverse_square: bool,
}

impl FirstStep {
    /// Of a tree without lights.
    const NONE: FirstStep = FirstStep { importances: [0.0; 2], is_inverse_square: true };

    /// About the irradiance that all lights of the tree make where nothing is in the way, as if each were
    /// a surface that sends its power to one side; `None` where it cannot be told.
    #[inline]
    pub fn irradiance(&self) -> Option<f32> {
        let [first, second] = self.importances;
        self.is_inverse_square.then_some((first + second).min(f32::MAX) / PI)
    }

    #[inline]
    fn share_of_first(&self) -> Option<f32> {
        share_of_first(self.importances)
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
pub(super) mod tests {
    use super::super::Receiver;
    use super::*;
    use kajo_math::{Vec2, Vec3, rng::Stream, warp};

    /// Lights of different strength and direction in a box.
    pub fn lights(n: u32) -> Vec<Option<LightBounds>> {
        let light = |i: u32| {
            let s = Stream::new(3, [i, 0], 0);
            let at = 10.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2));
            let size = Vec3::splat(0.1 * s.uniform(3));
            LightBounds {
                bounds: Aabb { min: at - size, max: at + size },
                axis: warp::uniform_sphere(Vec2::new(s.uniform(4), s.uniform(5))),
                cos_spread: if i.is_multiple_of(3) { -1.0 } else { 1.0 },
                cos_reach: 0.0,
                two_sided: i.is_multiple_of(5),
                power: 0.1 + s.uniform(6),
                is_inverse_square: true,
            }
        };
        (0..n).map(|i| (i % 97 != 96).then(|| light(i))).collect()
    }

    #[test]
    fn probabilities_agree_with_the_walk_and_sum_to_one() {
        let lights = lights(200);
        let tree = LightTree::build(&lights);
        assert_eq!(LightIndex::all(200).filter(|&light| tree.has(light)).count(), 198);
        for k in 0..30 {
            let s = Stream::new(5, [k, 0], 0);
            let p = 12.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2));
            let n = if k % 4 == 0 {
                Vec3::ZERO
            } else {
                warp::uniform_sphere(Vec2::new(s.uniform(3), s.uniform(4)))
            };
            let to = Receiver { p, n, time: 0.0 };
            let sum: f32 =
                LightIndex::all(200).map(|light| tree.pmf(light, &to, &tree.first_step(&to))).sum();
            // A walk may end among lights that turn out not to reach the receiver.
            assert!(sum > 0.8 && sum < 1.0 + 1e-4, "{sum}");
            for j in 0..50 {
                let Some(SampledLight { light, probability, .. }) =
                    tree.sample(&to, &tree.first_step(&to), s.uniform(10 + j))
                else {
                    continue;
                };
                let again = tree.pmf(light, &to, &tree.first_step(&to));
                assert!((again / probability - 1.0).abs() < 1e-4, "{light:?}: {again} {probability}");
            }
        }
    }

    #[test]
    fn what_can_send_light_is_never_ruled_out() {
        let lights = lights(150);
        let tree = LightTree::build(&lights);
        for k in 0..40 {
            let s = Stream::new(6, [k, 0], 0);
            let p = 12.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2));
            for (i, light) in LightIndex::all(150).zip(&lights) {
                let Some(light) = light else { continue };
                // From the middle of the light, straight along its axis or sideways within its reach.
                let w = (p - light.bounds.center()).normalize();
                let sends = light.cos_spread < 0.0 || light.axis.dot(w) > 0.0 || light.two_sided;
                let to = Receiver { p, ..Receiver::default() };
                let found = tree.pmf(i, &to, &tree.first_step(&to)) > 0.0;
                assert!(found || !sends, "receiver {k}, light {i:?}");
            }
        }
    }

    #[test]
    fn near_and_strong_lights_are_chosen_more_often() {
        let at = |x: f32, power: f32| {
            let bounds = Aabb { min: Vec3::new(x, 0.0, 0.0), max: Vec3::new(x, 0.0, 0.0) };
            Some(LightBounds {
                bounds,
                axis: Vec3::Z,
                cos_spread: -1.0,
                cos_reach: 0.0,
                two_sided: false,
                power,
                is_inverse_square: true,
            })
        };
        let tree = LightTree::build(&[at(0.0, 1.0), at(10.0, 1.0), at(20.0, 4.0), at(30.0, 0.0)]);
        let to = Receiver { p: Vec3::X, ..Receiver::default() };
        let chances: Vec<f32> =
            LightIndex::all(4).map(|light| tree.pmf(light, &to, &tree.first_step(&to))).collect();
        assert!(chances[0] > 10.0 * chances[1] && chances[2] > 0.5 * chances[1]);
        assert_eq!(chances[3], 0.0);
        assert!(!tree.has(LightIndex::new(3).unwrap()));
    }

    #[test]
    fn no_light_is_no_choice() {
        let tree = LightTree::build(&[]);
        assert!(tree.is_empty());
        assert!(tree.sample(&Receiver::default(), &FirstStep::NONE, 0.5).is_none());
    }
}
