//! The Sobol (0, 2)-sequence in base 2 and Owen's random scrambling.
//!
//! With the bits of the index `i = i0 + 2 i1 + 4 i2 + ...`, the first two coordinates of point `i` are
//!
//! ```text
//! x = i0/2 + i1/4 + i2/8 + ...                       van der Corput
//! y = j0/2 + j1/4 + j2/8 + ...    ja = sum over b of binomial(b, a) ib mod 2
//! ```
//!
//! [Sobol 1967]. Every aligned block of `2^m` points has exactly one in each of the elementary intervals
//! `[a 2^-p, (a+1) 2^-p) x [b 2^(p-m), (b+1) 2^(p-m))`: it is a (0, m, 2)-net.
//!
//! Owen's scrambling swaps the two halves of the unit interval or not, then the halves of each half, and so on, each
//! by a coin of its own [Owen 1995]. Nets stay nets, each point becomes uniform over the square, and the error
//! on smooth integrands falls to n^-1.5. A hash in which every bit depends on the higher ones only does that in a
//! few instructions [Laine and Karras 2011], [Burley 2020]. The same function applied to the index shuffles
//! the order of points such that aligned blocks stay blocks, which makes further pairs of dimensions out of two.
//!
//! Coordinates are fractions of 2^32; [`crate::rng::unit`] makes them numbers in [0, 1).

/// Point `index` of the sequence.
#[inline]
pub fn point(index: u32) -> [u32; 2] {
    [index.reverse_bits(), pascal(index).reverse_bits()]
}

/// Point `index`, each coordinate scrambled with a seed of its own.
#[inline]
pub fn scrambled_point(index: u32, seeds: [u32; 2]) -> [u32; 2] {
    let (x, y) = (scramble_reversed(index, seeds[0]), scramble_reversed(pascal(index), seeds[1]));
    // Both turned round by what turns one.
    let both = (u64::from(y) << 32 | u64::from(x)).reverse_bits();
    [(both >> 32) as u32, both as u32]
}

/// The first coordinate of [`scrambled_point`].
#[inline]
pub fn scrambled_number(index: u32, seed: u32) -> u32 {
    scramble_reversed(index, seed).reverse_bits()
}

/// The product of Pascal's matrix modulo 2 with the bits of `i`.
///
/// By Lucas, `binomial(b, a)` is odd where the bits of `a` are among those of `b`; so the product is a sum over
/// supersets, which goes bit by bit of the place.
#[inline]
fn pascal(mut i: u32) -> u32 {
    i ^= (i >> 1) & 0x5555_5555;
    i ^= (i >> 2) & 0x3333_3333;
    i ^= (i >> 4) & 0x0F0F_0F0F;
    i ^= (i >> 8) & 0x00FF_00FF;
    i ^ (i >> 16)
}

/// Owen's scrambling number `seed` of the fraction `x / 2^32`.
///
/// A bijection; the leading `m` bits of the result depend on the leading `m` bits of `x` and on the seed. The
/// constants are those of [Vegdahl 2021].
#[inline]
pub fn owen_scramble(x: u32, seed: u32) -> u32 {
    scramble_reversed(x.reverse_bits(), seed).reverse_bits()
}

/// The same of a fraction whose bits stand in reverse order; so do those of the result.
#[inline]
fn scramble_reversed(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3D20_ADEA);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6C56);
    x ^ x.wrapping_mul(0x53A2_2864)
}

/// A permutation of indices that keeps aligned blocks of `2^m` together.
#[inline]
pub fn shuffle(index: u32, seed: u32) -> u32 {
    owen_scramble(index, seed)
}

/// [`shuffle`] of an index whose bits stand in reverse order, for those who shuffle one index many times.
#[inline]
pub fn shuffle_reversed(reversed: u32, seed: u32) -> u32 {
    scramble_reversed(reversed, seed).reverse_bits()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Key, mix, unit};

    fn hash(i: u32) -> u32 {
        (mix(u64::from(i)) >> 32) as u32
    }

    /// Whether the points have one in every elementary interval; their number is a power of two.
    fn is_net(points: &[[u32; 2]]) -> bool {
        let m = points.len().ilog2();
        (0..=m).all(|p| {
            let mut hit = vec![false; points.len()];
            points.iter().for_each(|&[x, y]| {
                let (x, y) = (u64::from(x) >> (32 - p), u64::from(y) >> (32 - (m - p)));
                hit[(x << (m - p) | y) as usize] = true;
            });
            hit.iter().all(|&h| h)
        })
    }

    #[test]
    fn first_points_are_those_of_the_tables() {
        let eighths = |i| point(i).map(|c| unit(c) * 8.0);
        let expected =
            [[0., 0.], [4., 4.], [2., 6.], [6., 2.], [1., 5.], [5., 1.], [3., 3.], [7., 7.]].map(|p| p);
        for (i, p) in (0..).zip(expected) {
            assert_eq!(eighths(i), p, "point {i}");
        }
    }

    /// Direction numbers by their recurrence for the primitive polynomial x + 1.
    #[test]
    fn the_second_coordinate_follows_its_recurrence() {
        for i in (0..10_000u32).chain((0..1000).map(hash)) {
            let (mut v, mut y) = (1u32 << 31, 0);
            for bit in 0..32 {
                y ^= v * (i >> bit & 1);
                v ^= v >> 1;
            }
            assert_eq!(point(i)[1], y, "{i}");
        }
    }

    #[test]
    fn scrambled_and_shuffled_prefixes_are_nets() {
        for seed in 0..20 {
            let seeds = [hash(3 * seed + 1), hash(3 * seed + 2)];
            let points: Vec<_> =
                (0..1024).map(|i| scrambled_point(shuffle(i, hash(3 * seed)), seeds)).collect();
            let ninth = shuffle(9, hash(3 * seed));
            let [x, y] = point(ninth);
            assert_eq!(points[9], [owen_scramble(x, seeds[0]), owen_scramble(y, seeds[1])]);
            assert_eq!(scrambled_number(ninth, seeds[0]), points[9][0]);
            assert_eq!(shuffle_reversed(9u32.reverse_bits(), hash(3 * seed)), ninth);
            for m in 0..=10 {
                assert!(is_net(&points[..1 << m]), "seed {seed}, 2^{m} points");
            }
        }
        let mut spoiled: Vec<_> = (0..16).map(point).collect();
        spoiled[3][0] ^= 1 << 31;
        assert!(!is_net(&spoiled), "the test would not see a fault");
    }

    /// Two numbers that part at bit `k` part there after scrambling, in half of the seeds the other way round.
    #[test]
    fn scrambling_swaps_halves_of_halves_by_coins() {
        for k in 0..24 {
            let mut swapped = 0;
            for s in 0..2000 {
                let a = hash(s ^ 0x5555);
                let b = a ^ (1 << (31 - k));
                let (c, d) = (owen_scramble(a, hash(s)), owen_scramble(b, hash(s)));
                assert_eq!((c ^ d).leading_zeros(), k);
                swapped += u32::from((c ^ a) >> (31 - k) & 1 == 1);
            }
            // Six standard deviations of 2000 coins.
            assert!(swapped.abs_diff(1000) < 135, "bit {k}: {swapped}");
        }
    }

    /// How far two coins, each thrown for all keys, are from knowing nothing of each other, in standard errors.
    fn bond(a: &[u64], b: &[u64]) -> f64 {
        let differ: u32 = a.iter().zip(b).map(|(a, b)| (a ^ b).count_ones()).sum();
        let n = 64.0 * a.len() as f64;
        (2.0 * f64::from(differ) - n).abs() / n.sqrt()
    }

    /// The coins of level `k` on the way to `x`, over seeds; [`scramble_reversed`] has the first level at the lowest bit.
    fn coins(seeds: &[u32], x: impl Fn(usize) -> u32, k: u32) -> Vec<u64> {
        let coin = |(i, &seed): (usize, &u32)| u64::from((scramble_reversed(x(i), seed) ^ x(i)) >> k & 1);
        let coins: Vec<u64> = seeds.iter().enumerate().map(coin).collect();
        coins.chunks(64).map(|word| word.iter().rev().fold(0, |word, coin| word << 1 | coin)).collect()
    }

    /// Neighbouring pixels, two neighbouring dimensions, the three words of each: what samplers scramble and shuffle by.
    fn seeds() -> Vec<Vec<u32>> {
        let keys: Vec<Key> = (0..1 << 16).map(|i| Key::new(1).part([i & 255, i >> 8])).collect();
        let word = |(d, w)| keys.iter().map(|key| key.words([d, 0xA076_1D64])[w]).collect();
        [0, 2].into_iter().flat_map(|d| [(d, 0), (d, 1), (d, 2)]).map(word).collect()
    }

    /// The coins of 24 levels of both coordinates and of the order in two dimensions are independent: none of
    /// 10,296 pairs is off by six standard errors over 2^16 pixels, as it is by chance once in 5e4 tests. The largest found
    /// is 4.4; the mean square is 1 within 2 per cent.
    #[test]
    fn scrambles_of_dimensions_know_nothing_of_each_other() {
        let place = |i: usize| hash(i as u32 ^ 0x5555);
        let levels = |seeds: &Vec<u32>| (0..24).map(|k| coins(seeds, place, k)).collect::<Vec<_>>();
        let all: Vec<Vec<u64>> = seeds().iter().flat_map(levels).collect();
        let mut squares = 0.0;
        for i in 0..all.len() {
            for j in 0..i {
                let bond = bond(&all[i], &all[j]);
                assert!(bond < 6.0, "coins {i} and {j}: {bond} standard errors");
                squares += bond * bond;
            }
        }
        // Twice the variance of chi-square, over independent pairs.
        let mean = squares / 10_296.0;
        assert!((mean - 1.0).abs() < 5.0 * (2.0f64 / 10_296.0).sqrt(), "{mean}");
    }

    /// In one scramble each interval of a level throws a coin of its own [Owen 1995]: of 20 pairs in each of 14 levels none
    /// is off by 5.5 standard errors over 2^16 pixels, as one is by chance once in 1e5 tests.
    #[test]
    fn intervals_of_a_level_have_coins_of_their_own() {
        for (which, seeds) in seeds().iter().enumerate() {
            for k in 1..15 {
                for pair in 0..20 {
                    let [a, b] = [2 * pair, 2 * pair + 1].map(|i| hash(i << 8 | k) & ((1 << k) - 1));
                    let b = if a == b { b ^ 1 } else { b };
                    let bond = bond(&coins(seeds, |_| a, k), &coins(seeds, |_| b, k));
                    assert!(
                        bond < 5.5,
                        "word {which}, level {k}, intervals {a} and {b}: {bond} standard errors"
                    );
                }
            }
        }
    }

    #[test]
    fn a_scrambled_number_is_uniform() {
        for x in [0, 1, u32::MAX, 0x8000_0000] {
            let mut bins = [0f64; 32];
            (0..32_000).for_each(|s| bins[(owen_scramble(x, hash(s)) >> 27) as usize] += 1.0);
            // 31 degrees of freedom: below 85 with probability 1 - 1e-6.
            let chi2: f64 = bins.iter().map(|c| (c - 1000.0).powi(2) / 1000.0).sum();
            assert!(chi2 < 85.0, "{x}: {chi2}");
        }
    }
}
