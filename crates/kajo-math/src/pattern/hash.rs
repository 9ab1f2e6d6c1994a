//! Hashes of lattice cells.
//!
//! Each step is a bijection of 32 bits by two multiplications, the one of least bias known [Wellons 2018]; coordinates go in one after
//! the other, so that the corners of a cell share most of the work.

/// A bijection of 32 bits that spreads every bit over all others.
#[inline]
pub fn spread_bits(x: u32) -> u32 {
    let x = (x ^ (x >> 16)).wrapping_mul(0x7FEB_352D);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}

/// The hash `h` with another whole number.
#[inline]
pub fn with(h: u32, v: i32) -> u32 {
    spread_bits(h.wrapping_add(0x9E37_79B9) ^ v.cast_unsigned())
}

/// The hash of a cell.
#[inline]
pub fn cell([x, y, z]: [i32; 3], seed: u32) -> u32 {
    with(with(with(seed, x), y), z)
}

/// The `i`-th number in [0, 1) that is drawn from a hash.
#[inline]
pub fn uniform(h: u32, i: u32) -> f32 {
    crate::rng::unit(spread_bits(h ^ i.wrapping_add(1).wrapping_mul(0x85EB_CA6B)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_depends_on_every_bit() {
        // Of a flipped bit of any coordinate each bit of the hash is flipped in half of the cells.
        let n = 4096u32;
        for axis in 0..3 {
            for bit in 0..20 {
                let mut flips = [0u32; 32];
                for i in 0..n {
                    let at = [0, 1, 2].map(|k| (spread_bits(3 * i + k) >> 12) as i32);
                    let mut other = at;
                    other[axis] ^= 1 << bit;
                    let difference = cell(at, 7) ^ cell(other, 7);
                    (0..32).for_each(|b| flips[b] += (difference >> b) & 1);
                }
                // Six standard deviations of a fair coin.
                let far = flips.iter().any(|&f| (f as f32 - n as f32 / 2.0).abs() > 6.0 * 32.0);
                assert!(!far, "axis {axis} bit {bit}: {flips:?}");
            }
        }
    }

    #[test]
    fn numbers_drawn_from_a_hash_are_uniform() {
        let n = 40_000;
        for i in 0..4 {
            let numbers = (0..n).map(|k| f64::from(uniform(cell([k, -k, 3], 1), i)));
            let (sum, squares) = numbers.fold((0.0, 0.0), |(s, q), u| (s + u, q + u * u));
            let (mean, square) = (sum / f64::from(n), squares / f64::from(n));
            assert!((mean - 0.5).abs() < 0.008 && (square - 1.0 / 3.0).abs() < 0.008, "{mean} {square}");
        }
    }
}
