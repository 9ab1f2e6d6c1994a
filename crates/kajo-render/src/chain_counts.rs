//! Whether Markov chains agree on where light is.
//!
//! The picture is cut into 8 x 8 tiles. After each mutation a chain counts once, for the tile with the brightest part of its light. So the share of
//! the states with light in tile `t` is the mean over a chain of an indicator, which all chains share in the limit. Chains are dealt out to `G = 32`
//! groups; with `n` states and the share `p_g` in group `g`, the variance within groups, the variance of their means, and the potential scale
//! reduction of a tile are
//!
//! ```text
//! W = mean of p_g (1 - p_g)      V = sum of (p_g - p)^2 / (G - 1)      R = sqrt((n-1)/n + V/W)       [Gelman and Rubin 1992]
//! ```
//!
//! where groups count by their states. Were all states independent, `V` would be `W/n`; as neighbours in a chain are
//! alike, it is `W/m` with the effective number `m < n` of states of a group, so that `R^2` is about `1 + 1/m`. Above
//! 1.05, a group has less than ten of them.
//!
//! Counts are whole numbers, whose sums do not depend on the order in which they come.

use kajo_math::Vec2;

/// Groups that chains are dealt out to: so many that the spread of their shares is known to an eighth.
const GROUPS: usize = 32;

/// Tiles of the picture along an axis.
const SIDE: usize = 8;

/// Tiles of the picture.
const TILES: usize = SIDE * SIDE;

/// The least share of all states for which a tile is looked at: a quarter of the mean.
const LEAST_SHARE: f64 = 0.25 / TILES as f64;

/// [`ChainCounts::r_hat`] above which chains do not agree.
pub const LARGEST_R_HAT: f64 = 1.05;

/// For each group of chains, how many of their states have their light in each tile.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChainCounts(
    /// Group by group; empty without chains.
    Vec<u64>,
);

impl ChainCounts {
    /// Counts a state of a chain.
    ///
    /// * `chain`: its number: chains in a row go to all groups in turn
    /// * `at`: where its light is, as a share of the picture's sides
    pub fn count(&mut self, chain: u32, at: Vec2) {
        self.0.resize(GROUPS * TILES, 0);
        let [x, y] = [at.x, at.y].map(|share| ((share * SIDE as f32) as usize).min(SIDE - 1));
        self.0[chain as usize % GROUPS * TILES + y * SIDE + x] += 1;
    }

    /// Adds the states that others have counted.
    pub fn absorb(&mut self, more: &ChainCounts) {
        if more.0.is_empty() {
            return;
        }
        self.0.resize(GROUPS * TILES, 0);
        self.0.iter_mut().zip(&more.0).for_each(|(sum, more)| *sum = sum.saturating_add(*more));
    }

    /// Drops all chains, keeping the memory.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// The numbers, group by group; none without chains.
    pub(crate) fn numbers(&self) -> &[u64] {
        &self.0
    }

    /// Room for the numbers of chains.
    pub(crate) fn numbers_mut(&mut self) -> &mut [u64] {
        self.0.resize(GROUPS * TILES, 0);
        &mut self.0
    }

    /// The potential scale reduction between groups of chains, the largest of all tiles that have a share of the light
    /// worth mentioning: 1 where they agree, infinite where each group has light in tiles of its own, or there is one
    /// alone. `None` without chains.
    pub fn r_hat(&self) -> Option<f64> {
        let states = |group: &[u64]| group.iter().map(|&n| n as f64).sum::<f64>();
        let groups: Vec<(f64, &[u64])> = self
            .0
            .chunks_exact(TILES)
            .map(|group| (states(group), group))
            .filter(|&(n, _)| n > 0.0)
            .collect();
        let all: f64 = groups.iter().map(|(n, _)| n).sum();
        match groups.len() {
            0 => None,
            1 => Some(f64::INFINITY),
            _ => (0..TILES).filter_map(|tile| of_tile(&groups, all, tile)).reduce(f64::max),
        }
    }
}

/// The potential scale reduction of a tile; `None` where little light is.
///
/// * `groups`: states and counts of each
/// * `all`: states of all
fn of_tile(groups: &[(f64, &[u64])], all: f64, tile: usize) -> Option<f64> {
    let shares = || groups.iter().map(|&(n, counts)| (n, counts[tile] as f64 / n));
    let p = shares().map(|(n, share)| n * share).sum::<f64>() / all;
    if p < LEAST_SHARE {
        return None;
    }
    let n = all / groups.len() as f64;
    let within = shares().map(|(n, share)| n * share * (1.0 - share)).sum::<f64>() / all;
    let between = shares().map(|(n, share)| n * (share - p) * (share - p)).sum::<f64>() / (all - n);
    // [Gelman and Rubin 1992]; all light in one tile is what chains agree on.
    let ratio = if between == 0.0 { 0.0 } else { between / within };
    Some(((n - 1.0) / n + ratio).sqrt())
}

#[cfg(test)]
mod tests {
    use kajo_math::rng::Stream;

    use super::*;

    /// The middle of a tile.
    fn place(tile: usize) -> Vec2 {
        Vec2::new((tile % SIDE) as f32 + 0.5, (tile / SIDE) as f32 + 0.5) / SIDE as f32
    }

    fn counted(chains: u32, states: u32, mut tile: impl FnMut(u32, u32) -> usize) -> ChainCounts {
        let mut counts = ChainCounts::default();
        for chain in 0..chains {
            (0..states).for_each(|state| counts.count(chain, place(tile(chain, state))));
        }
        counts
    }

    #[test]
    fn two_groups_by_hand() {
        assert_eq!(ChainCounts::default().r_hat(), None);
        assert_eq!(counted(1, 9, |_, _| 3).r_hat(), Some(f64::INFINITY), "nothing to compare with");
        assert_eq!(counted(2, 100, |_, _| 3).r_hat(), Some(0.99_f64.sqrt()), "all in one tile");
        assert_eq!(counted(2, 100, |chain, _| chain as usize).r_hat(), Some(f64::INFINITY));
        // Shares of 1/4 and 3/4: W = 3/16, V = 1/8.
        let found = counted(2, 100, |chain, state| usize::from(state % 4 < 1 + 2 * chain)).r_hat().unwrap();
        assert!((found - (0.99 + 2.0 / 3.0_f64).sqrt()).abs() < 1e-12, "{found}");
        // A tile with a five-hundredth of all states, all of them of one group, is left aside.
        let rare = |chain: u32, state: u32| usize::from(chain == 0 && state < 4);
        let counts = counted(2, 1000, rare);
        let groups: Vec<_> = counts.0.chunks_exact(TILES).take(2).map(|group| (1000.0, group)).collect();
        assert_eq!((counts.r_hat(), of_tile(&groups, 2000.0, 1)), (of_tile(&groups, 2000.0, 0), None));
    }

    #[test]
    fn places_are_in_the_picture() {
        let mut counts = ChainCounts::default();
        for at in [[0.0, 0.0], [1.0, 1.0], [0.99, 0.12], [0.13, 0.3]] {
            counts.count(33, Vec2::from(at));
        }
        let at: Vec<usize> = (0..counts.0.len()).filter(|&i| counts.0[i] > 0).collect();
        assert_eq!(at, [0, 7, 2 * 8 + 1, 63].map(|tile| TILES + tile));
    }

    /// A chain that goes to the other one of two tiles with the probability `s` has the autocorrelation time `(1 - s)/s`, so `R^2 - 1` is
    /// that over the states of a group, but for the `-1/n`.
    #[test]
    fn chains_of_known_autocorrelation_have_their_r_hat() {
        let (states, renders) = (4000, 40);
        for (s, tolerance) in [(0.5, 0.1), (0.05, 0.1), (0.01, 0.1)] {
            let excess = |render: u32| {
                let mut tile = 0;
                let counts = counted(GROUPS as u32, states, |chain, state| {
                    let stream = Stream::new(7, [chain, state], render);
                    // It begins where it would be after any number of steps.
                    let turn = if state == 0 { 0.5 } else { s };
                    tile ^= usize::from(stream.uniform(0) < turn);
                    tile
                });
                let r_hat = counts.r_hat().unwrap();
                r_hat * r_hat - 1.0 + 1.0 / f64::from(states)
            };
            let found = (0..renders).map(excess).sum::<f64>() / f64::from(renders);
            let expected = f64::from((1.0 - s) / s) / f64::from(states);
            assert!((found / expected - 1.0).abs() < tolerance, "{s}: {found} instead of {expected}");
        }
    }

    #[test]
    fn sums_are_those_of_all_chains_in_any_order() {
        let tile = |chain: u32, state: u32| (chain * 7 + state * state) as usize % TILES;
        let whole = counted(70, 50, tile);
        let mut parts = [counted(40, 50, tile), ChainCounts::default()];
        for chain in 40..70 {
            (0..50).for_each(|state| parts[1].count(chain, place(tile(chain, state))));
        }
        let [a, b] = parts;
        for (first, second) in [(&a, &b), (&b, &a)] {
            let mut sum = ChainCounts::default();
            for part in [first, second, &ChainCounts::default()] {
                sum.absorb(part);
            }
            assert_eq!(sum, whole);
        }
        assert_eq!(whole.0.iter().sum::<u64>(), 70 * 50);
    }
}
