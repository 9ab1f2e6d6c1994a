//! The choice of one light among many that have a position.
//!
//! A binary tree over the lights; a walk from the root goes to each child with a probability proportional to a bound on what it
//! can send to the receiver,
//!
//! ```text
//! I = power cos(max(0, a - spread - b)) cos(max(0, i - b)) / d^2
//! ```
//!
//! with `d` the distance to the centre of the child's box, `b` the angle its box fills, `a` the angle
//! between the cone of its axes and the way to the receiver, `i` the receiver's own angle. What cannot send
//! anything is never chosen [Conty Estévez and Kulla 2018]; the layout and the cost of a split follow
//! [Pharr et al. 2023, 12.6]. Lights infinitely far away stand beside the tree: see `infinite.rs`.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use kajo_math::{Aabb, Vec3, fmath};

use super::{Receiver, SampledLight};
use crate::ids::LightIndex;

/// Where a light or a group of them is, where it shines and how strong it is.
#[derive(Clone, Copy, Debug)]
pub struct LightBounds {
    /// A box around the positions that light comes from.
    pub bounds: Aabb,
    /// The middle of the axes around which light leaves.
    pub axis: Vec3,
    /// Cosine of the largest angle between `axis` and the axes.
    pub cos_spread: f32,
    /// Cosine of the largest angle between a position's own axis and the light that leaves it.
    pub cos_reach: f32,
    /// Whether light leaves against the axes as well.
    pub two_sided: bool,
    /// Power; of light that leaves into a narrow cone, that of a light as bright in all directions, since the cone is in the angles.
    pub power: f32,
    /// Whether its light falls off by the square of the distance, as is taken for granted of all.
    pub is_inverse_square: bool,
}

/// How a light is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightChoice {
    /// By what it may contribute.
    #[default]
    Tree,
    /// Each as often as any other.
    Uniform,
}

impl LightChoice {
    /// Names on the command line and in `Settings`, with the rules.
    pub const NAMES: [(&'static str, LightChoice); 2] =
        [("tree", LightChoice::Tree), ("uniform", LightChoice::Uniform)];
}

/// The lights of a scene that have a position, ready to be chosen from.
#[derive(Debug, Default)]
pub struct LightTree {
    /// Of inner node `i` the first child is `i + 1`.
    nodes: Vec<Node>,
    /// For each light of the scene the turns from the root to its leaf, first turn in bit 0.
    trails: Vec<u64>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: LightBounds,
    content: NodeContent,
}

#[derive(Clone, Copy, Debug)]
enum NodeContent {
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

/// The directions around an axis.
#[derive(Clone, Copy, Debug)]
struct DirectionCone {
    axis: Vec3,
    /// Cosine of the largest angle between the axis and a direction.
    cos_spread: f32,
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
        let mut tree = LightTree { trails: vec![NEVER; lights.len()], nodes: Vec::new() };
        let is_light = |bounds: &LightBounds| bounds.power > 0.0 && bounds.bounds.is_finite();
        let placed = LightIndex::all(lights.len()).zip(lights);
        let placed = placed.filter_map(|(light, bounds)| {
            bounds.filter(is_light).map(|bounds| PlacedLight { light, bounds })
        });
        let mut placed: Vec<_> = placed.collect();
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
    pub(super) fn first_step(&self, to: &Receiver) -> FirstStep {
        let Some(root) = self.nodes.first() else { return FirstStep::NONE };
        let importance = |at: usize| self.nodes[at].bounds.importance(to.p, to.n);
        let importances = match root.content {
            NodeContent::Leaf(_) => [importance(0), 0.0],
            NodeContent::Inner { second } => [importance(1), importance(second as usize)],
        };
        FirstStep { importances, is_inverse_square: root.bounds.is_inverse_square }
    }

    /// Chooses a light for a receiver; `None` when none can reach it.
    ///
    /// * `step`: that of the receiver
    /// * `u`: uniform in [0, 1)
    #[inline]
    pub(super) fn sample(&self, to: &Receiver, step: &FirstStep, mut u: f32) -> Option<SampledLight> {
        let (mut at, mut probability) = (0, 1.0);
        let mut first = step.share_of_first();
        loop {
            let second = match self.nodes.get(at)?.content {
                NodeContent::Leaf(light) => return Some(SampledLight::new(light, probability, u)),
                NodeContent::Inner { second } => second as usize,
            };
            let share = first?;
            if u < share {
                u = (u / share).min(1.0f32.next_down());
                probability *= share;
                at += 1;
            } else {
                u = ((u - share) / (1.0 - share)).clamp(0.0, 1.0f32.next_down());
                probability *= 1.0 - share;
                at = second;
            }
            first = self.share_of_first(at, to);
        }
    }

    /// The probability with which [`LightTree::sample`] chooses a light for a receiver.
    #[inline]
    pub(super) fn pmf(&self, light: LightIndex, to: &Receiver, step: &FirstStep) -> f32 {
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

    /// The probability of the first of a node's two children; `None` when neither reaches the receiver, or it has none.
    #[inline]
    fn share_of_first(&self, at: usize, to: &Receiver) -> Option<f32> {
        let NodeContent::Inner { second } = self.nodes[at].content else { return None };
        let importances = [at + 1, second as usize].map(|at| self.nodes[at].bounds.importance(to.p, to.n));
        share_of_first(importances)
    }

    /// Adds the subtree over some lights.
    fn add(&mut self, lights: &mut [PlacedLight], trail: u64, depth: u32) {
        let bounds = lights.iter().map(|light| light.bounds).reduce(LightBounds::union);
        let Some(bounds) = bounds else { return };
        let at = self.nodes.len();
        if let [PlacedLight { light, .. }] = *lights {
            self.trails[light.index()] = trail;
            self.nodes.push(Node { bounds, content: NodeContent::Leaf(light) });
            return;
        }
        self.nodes.push(Node { bounds, content: NodeContent::Inner { second: 0 } });
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

impl LightBounds {
    /// Bounds around both.
    fn union(self, other: LightBounds) -> LightBounds {
        let DirectionCone { axis, cos_spread } = self.cone().union(other.cone());
        LightBounds {
            bounds: self.bounds.union(other.bounds),
            axis,
            cos_spread,
            cos_reach: self.cos_reach.min(other.cos_reach),
            two_sided: self.two_sided || other.two_sided,
            power: self.power + other.power,
            is_inverse_square: self.is_inverse_square && other.is_inverse_square,
        }
    }

    fn cone(&self) -> DirectionCone {
        DirectionCone { axis: self.axis, cos_spread: self.cos_spread }
    }

    /// The solid angle that light fills, weighted by the cosine at its edges, times power and area.
    fn cost(&self) -> f32 {
        let spread = fmath::acos(self.cos_spread.clamp(-1.0, 1.0));
        let reach = fmath::acos(self.cos_reach.clamp(-1.0, 1.0));
        let (sin, cos) = fmath::sin_cos(spread);
        let w = (spread + reach).min(PI);
        let solid_angle = TAU * (1.0 - cos)
            + FRAC_PI_2 * (2.0 * w * sin - fmath::cos(spread - 2.0 * w) - 2.0 * spread * sin + cos);
        self.power * solid_angle * self.bounds.half_area().max(f32::MIN_POSITIVE)
    }

    /// A bound on what arrives at a receiver, up to a common factor.
    #[inline]
    fn importance(&self, p: Vec3, n: Vec3) -> f32 {
        let to_receiver = p - self.bounds.center();
        let radius2 = 0.25 * self.bounds.extent().length_squared();
        let distance2 = to_receiver.length_squared();
        let inside = distance2 <= radius2;
        let w = to_receiver * (1.0 / distance2.sqrt().max(f32::MIN_POSITIVE));
        // The angle that the box fills.
        let (sin_b, cos_b) = if inside {
            (0.0, -1.0)
        } else {
            let sin2 = radius2 / distance2;
            (sin2.sqrt(), (1.0 - sin2).max(0.0).sqrt())
        };
        let cos_w = if self.two_sided { self.axis.dot(w).abs() } else { self.axis.dot(w) };
        let sin_w = sine(cos_w);
        let sin_spread = sine(self.cos_spread);
        let cos_x = cos_of_rest(sin_w, cos_w, sin_spread, self.cos_spread);
        let sin_x = sin_of_rest(sin_w, cos_w, sin_spread, self.cos_spread);
        let cos_leaving = cos_of_rest(sin_x, cos_x, sin_b, cos_b);
        // A hair of tolerance: a light must not be ruled out by rounding.
        if cos_leaving < self.cos_reach - 1e-4 {
            return 0.0;
        }
        let mut importance =
            self.power * cos_leaving.max(1e-4) / distance2.max(radius2).max(f32::MIN_POSITIVE);
        if n != Vec3::ZERO {
            let cos_i = w.dot(n).abs().min(1.0);
            importance *= cos_of_rest(sine(cos_i), cos_i, sin_b, cos_b).max(1e-4);
        }
        importance
    }
}

#[inline]
fn sine(cos: f32) -> f32 {
    (1.0 - cos * cos).max(0.0).sqrt()
}

/// `cos(max(0, a - b))`.
#[inline]
fn cos_of_rest(sin_a: f32, cos_a: f32, sin_b: f32, cos_b: f32) -> f32 {
    if cos_a > cos_b { 1.0 } else { cos_a * cos_b + sin_a * sin_b }
}

/// `sin(max(0, a - b))`.
#[inline]
fn sin_of_rest(sin_a: f32, cos_a: f32, sin_b: f32, cos_b: f32) -> f32 {
    if cos_a > cos_b { 0.0 } else { sin_a * cos_b - cos_a * sin_b }
}

impl DirectionCone {
    /// A cone around both.
    fn union(self, other: DirectionCone) -> DirectionCone {
        let (a, b) = (self.axis, other.axis);
        let angle = |cos: f32| fmath::acos(cos.clamp(-1.0, 1.0));
        let (spread_a, spread_b) = (angle(self.cos_spread), angle(other.cos_spread));
        let between = angle(a.dot(b));
        if (between + spread_b).min(PI) <= spread_a {
            return self;
        }
        if (between + spread_a).min(PI) <= spread_b {
            return other;
        }
        let spread = 0.5 * (spread_a + between + spread_b);
        let turn_around = a.cross(b).normalize_or_zero();
        if spread >= PI || turn_around == Vec3::ZERO {
            return DirectionCone { axis: a, cos_spread: -1.0 };
        }
        // Turn the first axis towards the second until both cones fit.
        let (sin, cos) = fmath::sin_cos(spread - spread_a);
        let axis = (cos * a + sin * turn_around.cross(a)).normalize_or(a);
        DirectionCone { axis, cos_spread: fmath::cos(spread) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::{Vec2, rng::Stream, warp};

    /// Lights of different strength and direction in a box.
    fn lights(n: u32) -> Vec<Option<LightBounds>> {
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
