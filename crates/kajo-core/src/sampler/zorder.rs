//! One sequence for a whole neighbourhood of pixels, in the order of a shuffled Z-curve.
//!
//! Samples are numbered along a Z-curve through the pixels, each pixel having a block of consecutive numbers. Blocks of
//! a (0, 2)-sequence of any aligned size are well spread. So are therefore the samples of a pixel, of each 2 × 2
//! pixels, each 4 × 4 and so on: what one pixel has too little of, its neighbours have too much of, and the error of the
//! picture is blue noise, which the eye averages away. The order in which the curve visits each four quarters, and the
//! samples of a pixel, is shuffled at random, else the curve would show [Ahmed and Wonka 2020], [Pharr, Jakob and
//! Humphreys 2023, section 8.7].
//!
//! Neighbourhoods of up to 256 × 256 pixels have sequences of their own, which keeps numbers within 32 bits.

use kajo_math::rng::Key;

/// Binary digits of a pixel's place in its neighbourhood, at most.
const NEIGHBORHOOD_BITS: u32 = 8;

/// The orders of four things.
const ORDERS: [[u8; 4]; 24] = orders();

/// Sets the bits that scramble a sequence apart from those that shuffle its digits, which have numbers up to 32.
const SCRAMBLING: u32 = 64;

/// The number of a last digit to base 2.
const LAST_DIGIT: u32 = 65;

/// The number in its neighbourhood's sequence of a sample, and random bits of that sequence.
///
/// * `count`: samples of each pixel
#[inline]
pub(super) fn index(seed: Key, pixel: [u32; 2], sample: u32, count: u32, dimension: u32) -> (u32, [u32; 2]) {
    let bits = count.max(1).wrapping_sub(1).checked_ilog2().map_or(0, |top| top + 1);
    let side = NEIGHBORHOOD_BITS.min((32 - bits) / 2);
    let block = 1u32.checked_shl(bits).unwrap_or(0).wrapping_sub(1);
    // Samples beyond the block begin another sequence.
    let later = sample.checked_shr(bits).unwrap_or(0);
    let sequence = seed.part(pixel.map(|place| place >> side)).part([dimension, later]);
    let place = interleave(pixel[0], side) | interleave(pixel[1], side) << 1;
    let number = place.checked_shl(bits).unwrap_or(0) | sample & block;
    let [x, y, _] = sequence.words([0, SCRAMBLING]);
    (shuffle(number, bits + 2 * side, sequence), [x, y])
}

/// Shuffles the digits to base 4 of a number, each by an order that depends on the digits before it. Where the
/// number of bits is odd, the last digit has one.
#[inline]
fn shuffle(number: u32, bits: u32, sequence: Key) -> u32 {
    let mut shuffled = 0;
    let mut low = bits;
    while low >= 2 {
        low -= 2;
        let [coin, ..] = sequence.words([number.checked_shr(low + 2).unwrap_or(0), low]);
        // One of 24 by the top 24 bits: orders differ in probability by two in a million.
        let order = ORDERS[(((coin >> 8) * 24) >> 24) as usize];
        shuffled |= u32::from(order[(number >> low & 3) as usize]) << low;
    }
    if low == 1 {
        let [coin, ..] = sequence.words([number >> 1, LAST_DIGIT]);
        shuffled |= (number & 1) ^ coin >> 31;
    }
    shuffled
}

/// The lowest `bits` bits, spread to the even places.
#[inline]
fn interleave(x: u32, bits: u32) -> u32 {
    let mut x = x & ((1 << bits) - 1);
    x = (x | x << 8) & 0x00FF_00FF;
    x = (x | x << 4) & 0x0F0F_0F0F;
    x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

const fn orders() -> [[u8; 4]; 24] {
    let mut orders = [[0; 4]; 24];
    let mut found = 0;
    let mut code = 0u16;
    while code < 256 {
        let order = [code & 3, code >> 2 & 3, code >> 4 & 3, code >> 6];
        if 1 << order[0] | 1 << order[1] | 1 << order[2] | 1 << order[3] == 15u16 {
            orders[found] = [order[0] as u8, order[1] as u8, order[2] as u8, order[3] as u8];
            found += 1;
        }
        code += 1;
    }
    orders
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_orders_of_four_are_there_once() {
        for (i, order) in ORDERS.iter().enumerate() {
            let mut sorted = *order;
            sorted.sort_unstable();
            assert_eq!(sorted, [0, 1, 2, 3]);
            assert!(!ORDERS[..i].contains(order));
        }
    }

    /// Every aligned square of pixels has an aligned block of the sequence to itself.
    #[test]
    fn squares_of_pixels_have_blocks_of_the_sequence() {
        for count in [1, 2, 3, 4, 8, 16] {
            let block = u32::next_power_of_two(count);
            for level in 0..=3 {
                let side = 1u32 << level;
                let size = block * side * side;
                for (x0, y0) in [(0, 0), (8, 16), (1000, 504)] {
                    let mut numbers: Vec<u32> = (0..size)
                        .map(|i| {
                            let (k, p) = (i % block, i / block);
                            index(Key::new(5), [x0 + p % side, y0 + p / side], k, count, 2).0
                        })
                        .collect();
                    numbers.sort_unstable();
                    let start = numbers[0];
                    assert_eq!(start % size, 0, "{count} samples, {side} pixels");
                    assert!(numbers.into_iter().eq(start..start + size), "{count} samples, {side} pixels");
                }
            }
        }
    }

    #[test]
    fn extremes_stay_in_range() {
        for count in [0, 1, 1 << 20, u32::MAX >> 1, u32::MAX] {
            for sample in [0, 1, u32::MAX] {
                index(Key::new(0), [u32::MAX, u32::MAX], sample, count, u32::MAX);
            }
        }
    }
}
