//! Do groups of samples have the same mean? One-way analysis of variance [Fisher 1925].
//!
//! With `n` samples in each of `G` groups, means `m_g` and the mean `m` of all,
//!
//! ```text
//! F = n sum of (m_g - m)^2 / (G - 1)   over   sum of (x_gi - m_g)^2 / (G (n - 1))
//! ```
//!
//! is about one where all samples come from one distribution, and follows Fisher's with `G - 1` and `G (n - 1)` degrees of
//! freedom. `p` is the probability that chance alone makes it as large.

use crate::special::beta;

/// The probability that the groups' means are as far apart as they are by chance.
///
/// * `groups`: at least two of them, with the same number of samples each, at least two, that are not all alike
pub fn p_of_equal_means(groups: &[Vec<f64>]) -> f64 {
    let (n_groups, n) = (groups.len() as f64, groups[0].len() as f64);
    assert!(groups.iter().all(|group| group.len() as f64 == n), "groups are of one size");
    let mean_of = |group: &[f64]| group.iter().sum::<f64>() / group.len() as f64;
    let means: Vec<f64> = groups.iter().map(|group| mean_of(group)).collect();
    let mean = mean_of(&means);
    let between: f64 = means.iter().map(|m| n * (m - mean).powi(2)).sum();
    let within: f64 =
        groups.iter().zip(&means).flat_map(|(group, m)| group.iter().map(move |x| (x - m).powi(2))).sum();
    // With d1 and d2 degrees of freedom the tail beyond F is I(d2/2, d1/2) at d2 / (d2 + d1 F).
    beta(within / (within + between), 0.5 * n_groups * (n - 1.0), 0.5 * (n_groups - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::rng::Stream;

    /// Groups of uniform numbers, each moved by `shift` times its number.
    fn groups(seed: u64, shift: f64) -> Vec<Vec<f64>> {
        let group = |g: u32| {
            let stream = Stream::new(seed, [g, 0], 0);
            (0..8).map(|i| f64::from(stream.uniform(i)) + shift * f64::from(g)).collect()
        };
        (0..16).map(group).collect()
    }

    #[test]
    fn published_examples() {
        // Means 5, 9 and 10: F = 84/2 over 68/15 = 9.26.
        let yields = [
            [6.0, 8.0, 4.0, 5.0, 3.0, 4.0],
            [8.0, 12.0, 9.0, 11.0, 6.0, 8.0],
            [13.0, 9.0, 11.0, 8.0, 7.0, 12.0],
        ];
        let p = p_of_equal_means(&yields.map(Vec::from));
        assert!((p - 0.002_399).abs() < 1e-6, "{p}");
        assert_eq!(p_of_equal_means(&[vec![0.0, 1.0], vec![1.0, 0.0]]), 1.0);
    }

    #[test]
    fn p_is_uniform_where_means_are_equal_and_small_where_they_are_not() {
        let below = |p: f64| (0..2000).filter(|&seed| p_of_equal_means(&groups(seed, 0.0)) < p).count();
        for (p, count) in [(0.1, 200), (0.5, 1000)] {
            let sigma = (2000.0_f64 * p * (1.0 - p)).sqrt();
            assert!((below(p) as f64 - f64::from(count)).abs() < 4.0 * sigma, "{} for {count}", below(p));
        }
        assert!((0..20).all(|seed| p_of_equal_means(&groups(seed, 0.06)) < 1e-3));
    }
}
