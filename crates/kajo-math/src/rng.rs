//! Random numbers as a function of what they are for.
//!
//! There is no generator to advance: the number for dimension `k` of sample `s` of pixel
//! `(x, y)` under a seed is a hash of these five. Threads, tiles, machines and restarts
//! can therefore not change a picture.

/// A stream of independent uniform numbers, one for each dimension.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    state: u64,
}

impl Stream {
    /// The stream of one sample of one pixel.
    #[inline]
    pub fn new(seed: u64, pixel: [u32; 2], sample: u32) -> Stream {
        Stream::of_pixel(pixel_hash(seed, pixel), sample)
    }

    /// The same from a pixel's [`pixel_hash`].
    #[inline]
    pub fn of_pixel(hash: u64, sample: u32) -> Stream {
        Stream { state: mix(hash ^ u64::from(sample)) }
    }

    /// 32 random bits of a dimension.
    #[inline]
    pub fn bits(&self, dimension: u32) -> u32 {
        (mix(self.state ^ u64::from(dimension)) >> 32) as u32
    }

    /// Uniform in [0, 1), a multiple of 2^-24.
    #[inline]
    pub fn uniform(&self, dimension: u32) -> f32 {
        unit(self.bits(dimension))
    }
}

/// 64 random bits of a pixel under a seed.
#[inline]
pub fn pixel_hash(seed: u64, pixel: [u32; 2]) -> u64 {
    let place = u64::from(pixel[0]) | u64::from(pixel[1]) << 32;
    mix(mix(seed) ^ place)
}

/// The top 24 of 32 random bits as a number in [0, 1).
#[inline]
pub fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// A bijection of 64 bits that spreads every bit over all others: the finaliser of
/// SplitMix64 [Steele, Lea and Flood 2014] on a Weyl step.
#[inline]
pub fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dimensions_samples_and_pixels_are_uniform_and_uncorrelated() {
        // Each neighbouring pair of streams fills an 8 x 8 table evenly: chi-square with 63
        // degrees of freedom stays below 126 with probability 1 - 5e-6.
        let pairs: [fn(u32) -> (f32, f32); 3] = [
            |i| (Stream::new(1, [i, 0], 0).uniform(0), Stream::new(1, [i, 0], 0).uniform(1)),
            |i| (Stream::new(1, [7, 3], i).uniform(0), Stream::new(1, [7, 3], i + 1).uniform(0)),
            |i| (Stream::new(1, [i, 3], 5).uniform(2), Stream::new(1, [i, 4], 5).uniform(2)),
        ];
        for (which, pair) in pairs.iter().enumerate() {
            let n = 65_536u32;
            let mut table = [0f64; 64];
            for i in 0..n {
                let (a, b) = pair(i);
                assert!((0.0..1.0).contains(&a));
                table[(a * 8.0) as usize * 8 + (b * 8.0) as usize] += 1.0;
            }
            let expected = f64::from(n) / 64.0;
            let chi2: f64 = table.iter().map(|c| (c - expected).powi(2) / expected).sum();
            assert!(chi2 < 126.0, "pair {which}: {chi2}");
        }
    }
}
