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

    /// The value for the cosine of the angle by which light is turned.
    #[inline]
    pub fn at(&self, cos: f32) -> f32 {
        // 1 + g² - 2 g cos as (1 - |g|)² + 2 |g| (1 - s cos), s the sign of g: that does not cancel for narrow lobes.
        let (size, narrow) = (self.g.abs(), 1.0 - self.g.abs());
        let root = narrow * narrow + 2.0 * size * (1.0 - cos * self.g.signum());
        0.25 * FRAC_1_PI * narrow * (1.0 + size) / (root * root.sqrt())
    }

    /// A cosine for `u` in [0, 1).
    #[inline]
    pub fn sample(&self, u: f32) -> f32 {
        let (g, t) = (self.g, 2.0 * u - 1.0);
        let g2 = g * g;
        let below = 1.0 + g * t;
        (t * (1.0 + g2) + 0.5 * g * (t * t * (1.0 + g2) + 3.0 - g2)) / (below * below)
    }
}
