//! More samples where a picture is noisy, without bias.
//!
//! Samples of even and of odd index are two independent renders of the picture, `A` and `B`, with seeds of
//! their own. All pixels first get `p` samples of each. What these samples of `A` show decides how many
//! samples `B` gets in each block of 32 × 32 pixels, and the other way round; a pixel is `(mean of A + mean
//! of B)/2` with these fixed weights. The number of samples of `A` is then independent of their values, and
//! so is that of `B`: both means are unbiased, and so is the picture. Deciding by the very samples that are
//! averaged is not: a block that had the luck to miss a rare bright path would stop there for good, and one
//! that met it would go on until it is averaged out.
//!
//! With `σ_b²` the mean variance of a sample of a block and `M_b` the mean of the samples, the squared error
//! of a picture with `n_b` samples of each half in block `b` is the mean of `σ_b²/(2 n_b (M_b² + ε²))`; see
//! [`noise`](crate::film::noise). For a given number of samples it is least when
//!
//! ```text
//! n_b ∝ s_b,    s_b = σ_b / sqrt(M_b² + ε²)
//! ```
//!
//! [Neyman 1934]. No block gets less than `p`, and `s_b` counts as at least a quarter of its mean over the
//! picture, since a block in which few samples saw nothing may still hide something.

use crate::film::noise::{epsilon, scale_squared};
use crate::{Film, film::Spread};

/// Least share of the mean of `s_b` that every block counts with.
const LEAST_SCORE: f64 = 0.25;

/// A block gets at most this many times the samples that it would get if all were equal.
const MOST_TIMES: u32 = 64;

/// Samples of each pixel, an even number, before anything is decided, of `budget` in all.
pub fn pilot_samples(budget: u32) -> u32 {
    (budget / 4).clamp(8, 64) & !1
}

/// The most samples of one half that [`limits`] give a block.
pub(super) fn largest_limit(budget: u32) -> u32 {
    most_of(budget / 2, pilot_samples(budget) / 2)
}

/// * `least`, `budget`: samples of one half, at least and on average
fn most_of(budget: u32, least: u32) -> u32 {
    budget.saturating_mul(MOST_TIMES).max(least)
}

/// For each block of a film, how many samples of even and of odd index its pixels are to get in all.
///
/// * `film`: with halves, [`Layer::Variance`](crate::Layer::Variance) and `pilot` samples in each pixel
/// * `budget`: samples of a pixel on average
/// * `noise`: relative error at which it is enough; `None` to spend the budget
pub(super) fn limits(film: &Film, pilot: u32, budget: u32, noise: Option<f64>) -> Vec<[u32; 2]> {
    let halves = [0, 1].map(|half| counts(&film.spreads(half), pilot / 2, budget / 2, noise));
    halves[1].iter().zip(&halves[0]).map(|(&even, &odd)| [even, odd]).collect()
}

/// Samples of one half in each block, by what the other half showed.
fn counts(blocks: &[Spread], least: u32, budget: u32, noise: Option<f64>) -> Vec<u32> {
    let Some(epsilon) = epsilon(blocks) else { return vec![budget; blocks.len()] };
    let pixels: f64 = blocks.iter().map(|block| block.pixels).sum();
    let raw: Vec<f64> = blocks.iter().map(|block| score(block, epsilon)).collect();
    let mean = raw.iter().zip(blocks).map(|(s, block)| s * block.pixels).sum::<f64>() / pixels;
    if mean == 0.0 {
        // No noise was seen at all.
        return vec![if noise.is_some() { least } else { budget }; blocks.len()];
    }
    let scores: Vec<f64> = raw.iter().map(|&s| s.max(LEAST_SCORE * mean)).collect();
    let most = most_of(budget, least);
    let at = |factor: f64| scores.iter().map(move |s| ((factor * s) as u32).clamp(least, most));
    // Both what is spent and the precision grow with the factor.
    let is_enough = |factor: f64| {
        let spent = at(factor).zip(blocks).map(|(n, block)| f64::from(n) * block.pixels).sum::<f64>();
        let error = at(factor).zip(blocks).zip(&raw);
        let error = error.map(|((n, block), s)| s * s * block.pixels / (2.0 * f64::from(n))).sum::<f64>();
        spent >= f64::from(budget) * pixels || noise.is_some_and(|noise| error / pixels <= noise * noise)
    };
    let (mut low, mut high) = (0.0, f64::from(most) / (LEAST_SCORE * mean));
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        *(if is_enough(middle) { &mut high } else { &mut low }) = middle;
    }
    at(high).collect()
}

/// `s_b`; 0 where nothing was seen.
fn score(block: &Spread, epsilon: f64) -> f64 {
    let score = (block.variance / scale_squared(block, epsilon)).sqrt();
    if score.is_finite() { score } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(mean: f64, deviation: f64) -> Spread {
        Spread { pixels: 100.0, mean, variance: deviation * deviation, variance_of_mean: 0.0 }
    }

    #[test]
    fn noisy_blocks_get_more_and_the_budget_is_kept() {
        let blocks = [block(1.0, 0.0), block(1.0, 1.0), block(1.0, 2.0), block(0.0, 0.0)];
        let counts = counts(&blocks, 4, 100, None);
        let spent: u32 = counts.iter().sum();
        assert!((396..=404).contains(&spent), "{counts:?}");
        assert!((f64::from(counts[2]) / f64::from(counts[1]) - 2.0).abs() < 0.05, "{counts:?}");
        assert!(counts[0] == counts[3] && counts[0] >= 10, "calm blocks are not forgotten: {counts:?}");
    }

    #[test]
    fn a_goal_that_is_reached_ends_the_spending() {
        let blocks = [block(1.0, 1.0), block(1.0, 2.0)];
        let few = counts(&blocks, 2, 100_000, Some(0.05));
        // ε² = 0.1² comes in: s is 1 and 2 over sqrt 1.01. The squared error of two halves is the mean of
        // s²/(2n), which with n = c s is (1.5 / 1.005) / 2c = 0.0025.
        assert!(few[0].abs_diff(297) < 3 && few[1].abs_diff(594) < 5, "{few:?}");
        assert_eq!(counts(&blocks, 2, 1000, Some(10.0)), [2, 2], "the pilot was enough");
    }

    #[test]
    fn without_any_light_nothing_more_is_needed_than_the_budget() {
        let dark = [block(0.0, 0.0), block(0.0, 0.0)];
        assert_eq!(counts(&dark, 4, 64, None), [64, 64]);
        assert_eq!(counts(&dark, 4, 64, Some(0.1)), [4, 4]);
        assert_eq!(counts(&[Spread::default()], 4, 64, None), [64]);
    }

    #[test]
    fn pilots_are_even() {
        assert_eq!([0, 16, 50, 100, 4096].map(pilot_samples), [8, 8, 12, 24, 64]);
    }
}
