//! The choice of a light of the tree for a piece of a ray.
//!
//! A ray may pass a light as closely as it likes, and what that light sends along it grows without bound while its neighbours' does not. An estimate for a
//! group does not know that, so the walk down the tree ends where few lights are left, and of these one is chosen by what each of them sends.

use kajo_math::warp;

use super::SampledLight;
use super::cluster::{LightCluster, LightQuery};
use super::segment::{AngularSpan, RaySegment};
use super::tree::{LightTree, NodeContent};
use crate::ids::LightIndex;

/// The most lights that are each looked at.
const FEW: usize = 8;

impl LightTree {
    /// Chooses a light for a piece of a ray; `None` when none can reach it.
    ///
    /// * `u`: uniform in [0, 1)
    pub(super) fn sample_along(&self, segment: &RaySegment, mut u: f32) -> Option<SampledLight> {
        let (mut at, mut lights, mut probability) = (0, self.lights(), 1.0);
        while lights > FEW {
            let [first, second] = self.children(at, lights)?;
            let share = self.share_of_first(at, segment)?;
            let is_first;
            (is_first, u) = warp::choose(u, share);
            probability *= if is_first { share } else { 1.0 - share };
            (at, lights) = if is_first { first } else { second };
        }
        let sent = self.sent_along(at, lights, segment);
        let sum: f32 = sent.iter().sum();
        let (mut rest, mut chosen) = (u * sum, None);
        for ((light, _), sent) in self.leaves(at, lights).zip(sent).filter(|&(_, sent)| sent > 0.0) {
            chosen = Some(SampledLight::new(light, probability * sent / sum, rest / sent));
            if rest < sent {
                break;
            }
            rest -= sent;
        }
        chosen
    }

    /// The probability with which [`LightTree::sample_along`] chooses a light for a piece of a ray.
    pub(super) fn pmf_along(&self, light: LightIndex, segment: &RaySegment) -> f32 {
        let Some(mut trail) = self.trail(light) else { return 0.0 };
        let (mut at, mut lights, mut probability) = (0, self.lights(), 1.0);
        while lights > FEW {
            let Some([first, second]) = self.children(at, lights) else { return 0.0 };
            let Some(share) = self.share_of_first(at, segment) else { return 0.0 };
            let is_first = trail & 1 == 0;
            probability *= if is_first { share } else { 1.0 - share };
            (at, lights) = if is_first { first } else { second };
            trail >>= 1;
        }
        let sent = self.sent_along(at, lights, segment);
        let own = self.leaves(at, lights).zip(sent).find(|&((other, _), sent)| other == light && sent > 0.0);
        own.map_or(0.0, |(_, own)| probability * own / sent.iter().sum::<f32>())
    }

    /// How a light sees a ray; `None` where it does not, or is not in the tree.
    pub(super) fn seen_from(&self, light: LightIndex, segment: &RaySegment) -> Option<AngularSpan> {
        let mut trail = self.trail(light)?;
        let mut at = 0;
        while let NodeContent::Inner { second } = self.nodes[at].content {
            at = if trail & 1 == 0 { at + 1 } else { second as usize };
            trail >>= 1;
        }
        self.nodes[at].cluster.seen_from(segment)
    }

    /// Number of lights in the tree: all inner nodes have two children.
    fn lights(&self) -> usize {
        self.nodes.len().div_ceil(2)
    }

    /// The children of a node over a number of lights, each with its own number; `None` for a leaf.
    fn children(&self, at: usize, lights: usize) -> Option<[(usize, usize); 2]> {
        let NodeContent::Inner { second } = self.nodes[at].content else { return None };
        let second = second as usize;
        let of_first = (second - at) / 2;
        Some([(at + 1, of_first), (second, lights - of_first)])
    }

    /// The lights of a node: the nodes below it follow it.
    fn leaves(&self, at: usize, lights: usize) -> impl Iterator<Item = (LightIndex, &LightCluster)> {
        let nodes = self.nodes.iter().skip(at).take((2 * lights).saturating_sub(1));
        nodes.filter_map(|node| match node.content {
            NodeContent::Leaf(light) => Some((light, &node.cluster)),
            NodeContent::Inner { .. } => None,
        })
    }

    /// What each of the few lights of a node sends along a ray.
    fn sent_along(&self, at: usize, lights: usize, segment: &RaySegment) -> [f32; FEW] {
        let mut sent = [0.0; FEW];
        for (sent, (_, cluster)) in sent.iter_mut().zip(self.leaves(at, lights)) {
            *sent = segment.importance(cluster);
        }
        sent
    }
}

#[cfg(test)]
mod tests {
    use super::super::LightBounds;
    use super::super::tree::tests::lights;
    use super::*;
    use kajo_math::{Aabb, Vec2, Vec3, rng::Stream};

    #[test]
    fn probabilities_along_rays_agree_with_the_walk() {
        let mut drawn = 0;
        for (k, lights) in (0..30u32).zip([200, 1, 2, 8, 9, 60].map(lights).iter().cycle()) {
            let tree = LightTree::build(lights);
            let all = || LightIndex::all(lights.len());
            let s = Stream::new(7, [k, 0], 0);
            let o = 12.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2));
            let d = warp::uniform_sphere(Vec2::new(s.uniform(3), s.uniform(4)));
            let along = RaySegment { o, d, length: 20.0 * s.uniform(5), time: 0.0, extinction: 0.2 };
            let sum: f32 = all().map(|light| tree.pmf_along(light, &along)).sum();
            assert!(sum < 1.0 + 1e-4, "{sum}");
            for j in 0..50 {
                let Some(SampledLight { light, probability, .. }) =
                    tree.sample_along(&along, s.uniform(10 + j))
                else {
                    continue;
                };
                let again = tree.pmf_along(light, &along);
                assert!((again / probability - 1.0).abs() < 1e-4, "{light:?}: {again} {probability}");
                drawn += u32::from(tree.seen_from(light, &along).is_some());
            }
        }
        assert!(drawn > 600, "{drawn}");
    }

    /// Of two lights alike, which a tree over many has in one group, the one that a ray passes closely is chosen.
    #[test]
    fn a_light_that_a_ray_passes_closely_is_chosen() {
        let point = |x: f32| {
            let at = Vec3::new(x, 0.0, 0.0);
            Some(LightBounds {
                bounds: Aabb { min: at, max: at },
                axis: Vec3::Z,
                cos_spread: -1.0,
                cos_reach: 0.0,
                two_sided: false,
                power: 1.0,
                is_inverse_square: true,
            })
        };
        let tree = LightTree::build(&[point(0.0), point(1.0), point(-1.0), point(2.0)]);
        let along =
            RaySegment { o: Vec3::new(1e-3, 0.0, -3.0), d: Vec3::Z, length: 6.0, time: 0.0, extinction: 0.1 };
        let first = LightIndex::new(0).expect("an index");
        assert!(tree.pmf_along(first, &along) > 0.99);
    }
}
