//! The phase function of [Henyey and Greenstein 1941], for dust, mist and skin:
//!
//! ```text
//! p(cos) = (1 - g²) / (4π (1 + g² - 2 g cos)^(3/2))
//! ```
//!
//! `g` is the mean cosine, from nearly -1 (all back) over 0 (isotropic) to nearly 1 (all on). The share of directions below a
//! cosine has a closed inverse. With `t = 2u - 1` it is
//!
//! ```text
//! cos = (t (1 + g²) + g/2 (t² (1 + g²) + 3 - g²)) / (1 + g t)²
//! ```
//!
//! the usual formula with the division by `g` carried out, so that it holds at `g = 0` too.

use std::f32::consts::FRAC_1_PI;

/// A lobe forwards or backwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    g: f32,
}

impl HenyeyGreenstein {
    /// The lobe of a mean cosine; `None` unless that is above -1 and below 1.
    pub fn new(g: f32) -> Option<HenyeyGreenstein> {
        (g.abs() < 1.0).then_some(HenyeyGreenstein { g })
    }

    /// The mean cosine.
    pub fn g(&self) -> f32 {
        self.g
    }

    /// The value for the cosine of the angle by which light is turned; off by at most 5e-7 of itself.
    #[inline]
    pub fn at(&self, cos: f32) -> f32 {
        // 1 + g² - 2 g cos as (1 - |g|)² + 2 |g| (1 - s cos), s the sign of g: that does not cancel for narrow lobes.
        let (size, narrow) = (self.g.abs(), 1.0 - self.g.abs());
        let root = narrow * narrow + 2.0 * size * (1.0 - cos * self.g.signum());
        0.25 * FRAC_1_PI * narrow * (1.0 + size) / (root * root.sqrt())
    }

    /// A cosine for `u` in [0, 1), off by at most `4e-7 / (1 - |g|)²`.
    #[inline]
    pub fn sample(&self, u: f32) -> f32 {
        let (g, t) = (self.g, 2.0 * u - 1.0);
        let g2 = g * g;
        let below = 1.0 + g * t;
        (t * (1.0 + g2) + 0.5 * g * (t * t * (1.0 + g2) + 3.0 - g2)) / (below * below)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_cosines_are_as_exact_as_they_say() {
        for g in [-0.99, -0.9, -0.5, -0.1, 0.0, 1e-3, 0.3, 0.7, 0.85, 0.95, 0.99] {
            let lobe = HenyeyGreenstein::new(g).expect("a mean cosine");
            let g = f64::from(g);
            for i in 0..20_000u16 {
                // Closer to each other at both ends.
                let x = f64::from(i) / 20_000.0;
                let u = (x * x * (3.0 - 2.0 * x)) as f32;
                let cos = (2.0 * u - 1.0).clamp(-1.0, 1.0);
                let root = 1.0 + g * g - 2.0 * g * f64::from(cos);
                let exact = (1.0 - g * g) / (4.0 * std::f64::consts::PI * root * root.sqrt());
                assert!((f64::from(lobe.at(cos)) / exact - 1.0).abs() < 5e-7, "{g} {cos}: {exact}");
                let t = 2.0 * f64::from(u) - 1.0;
                let above = t * (1.0 + g * g) + 0.5 * g * (t * t * (1.0 + g * g) + 3.0 - g * g);
                let exact = above / (1.0 + g * t).powi(2);
                let off = (f64::from(lobe.sample(u)) - exact).abs();
                assert!(off < 4e-7 / (1.0 - g.abs()).powi(2), "{g} {u}: {off}");
            }
        }
    }
}
