//! Permutations of any length as functions of a number.
//!
//! A hash that keeps to the `w` lowest bits is a bijection of `0..2^w`; walking on until the value falls below
//! `n` makes it one of `0..n` [Kensler 2013, section 5].

/// Where permutation number `p` of `0..n` sends `i`.
///
/// * `i`: below `n`
/// * `n`: at least 1
#[inline]
pub fn permute(i: u32, n: u32, p: u32) -> u32 {
    debug_assert!(i < n);
    let w = n.wrapping_sub(1).checked_ilog2().map_or(0, |top| u32::MAX >> (31 - top));
    let mut i = i;
    loop {
        i = mix_low_bits(i, w, p);
        if i < n {
            break;
        }
    }
    // The sum modulo n, which 32 bits might not hold.
    let by = p % n;
    if i < n - by { i + by } else { i - (n - by) }
}

/// A bijection of the numbers of `w`'s bits; `w` is one less than a power of two.
#[inline]
fn mix_low_bits(mut i: u32, w: u32, p: u32) -> u32 {
    i ^= p;
    i = i.wrapping_mul(0xE170_893D);
    i ^= p >> 16;
    i ^= (i & w) >> 4;
    i ^= p >> 8;
    i = i.wrapping_mul(0x0929_EB3F);
    i ^= p >> 23;
    i ^= (i & w) >> 1;
    i = i.wrapping_mul(1 | p >> 27);
    i = i.wrapping_mul(0x6935_FA69);
    i ^= (i & w) >> 11;
    i = i.wrapping_mul(0x74DC_B303);
    i ^= (i & w) >> 2;
    i = i.wrapping_mul(0x9E50_1CC3);
    i ^= (i & w) >> 2;
    i = i.wrapping_mul(0xC860_A3DF);
    i &= w;
    i ^ i >> 5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::mix;

    #[test]
    fn every_number_is_hit_once() {
        for n in [1, 2, 3, 5, 8, 16, 17, 100, 255, 256, 1000] {
            for p in 0..50u32 {
                let p = mix(u64::from(p)) as u32;
                let mut hit = vec![false; n as usize];
                for i in 0..n {
                    let j = permute(i, n, p) as usize;
                    assert!(!hit[j], "{n} {p}: {j} twice");
                    hit[j] = true;
                }
            }
        }
    }

    #[test]
    fn every_place_is_as_likely_as_any_other() {
        // Counts of (i, where it goes) over many permutations; chi-square with 12·11 degrees of freedom stays
        // below 230 with probability 1 - 1e-6.
        let (n, permutations) = (12u32, 24_000u32);
        let mut table = vec![0f64; (n * n) as usize];
        for p in 0..permutations {
            for i in 0..n {
                table[(i * n + permute(i, n, mix(u64::from(p)) as u32)) as usize] += 1.0;
            }
        }
        let expected = f64::from(permutations / n);
        let chi2: f64 = table.iter().map(|c| (c - expected).powi(2) / expected).sum();
        assert!(chi2 < 230.0, "{chi2}");
    }
}
