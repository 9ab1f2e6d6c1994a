//! Numbers that look random and are a function of their place: the PCG hash [Jarzynski & Olano 2020].

/// 32 bits to 32 bits.
pub fn hash(x: u32) -> u32 {
    let s = x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let w = ((s >> ((s >> 28) + 4)) ^ s).wrapping_mul(277_803_737);
    (w >> 22) ^ w
}

/// Number `k` of item `i`, uniform in [0, 1) in steps of 2^-24.
pub fn uniform(i: u32, k: u32) -> f64 {
    unit(hash(hash(i).wrapping_add(k)))
}

/// The upper 24 bits as a number in [0, 1).
pub fn unit(bits: u32) -> f64 {
    f64::from(bits >> 8) * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_uniform_and_differ_by_dimension() {
        let n = 10_000;
        for k in 0..4 {
            let numbers: Vec<f64> = (0..n).map(|i| uniform(i, k)).collect();
            assert!(numbers.iter().all(|u| (0.0..1.0).contains(u)));
            // The mean of n uniform numbers has a standard deviation of 1/sqrt(12 n), here 0.0029.
            let mean = numbers.iter().sum::<f64>() / f64::from(n);
            assert!((mean - 0.5).abs() < 0.012, "dimension {k}: {mean}");
        }
        assert_ne!(uniform(1, 0), uniform(1, 1));
    }
}
