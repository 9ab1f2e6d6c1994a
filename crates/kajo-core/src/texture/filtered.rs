//! Numbers within a footprint: how much they vary there, and means of functions of them.
//!
//! The mean of a function of a number is not the function of its mean: a ramp with a sharp stop over a pattern that is filtered would
//! show every edge unfiltered. So a number says how it varies within the footprint: by `a` and `b` from a sample to those beside
//! and above it, and by what filtering has taken away from it. Where it changes evenly it is spread as the sum of two boxes, and its variance is
//!
//! ```text
//! V = (a^2 + b^2) / 12 + lost
//! ```
//!
//! The numbers are taken to be those of a box that is held to [0, 1], with the mean and the variance that are known. That is exact for what
//! changes evenly along one axis, and for what is 0 in one part of the footprint and 1 in the other; means of linear functions are always exact.

use super::{SurfaceUv, TextureContext, TextureFootprint};

/// A number, as far as it is known how it varies within [`TextureContext::footprint`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilteredNumber {
    /// Its mean, which is the number itself.
    pub mean: f32,
    /// Its differences to the samples beside and above.
    pub change: [f32; 2],
    /// The variance that filtering has taken away from it, besides these; not negative.
    pub lost: f32,
}

impl FilteredNumber {
    /// A number that does not vary, or of which it is not known.
    pub fn point(mean: f32) -> FilteredNumber {
        FilteredNumber { mean, ..FilteredNumber::default() }
    }

    /// A number by its values at a point, and beside and above it.
    pub(super) fn by_differences(
        at: &TextureContext,
        lost: f32,
        value: impl Fn(&TextureContext) -> f32,
    ) -> FilteredNumber {
        let mean = value(at);
        FilteredNumber { mean, change: [0, 1].map(|i| value(&at.beside(i)) - mean), lost }
    }

    /// Its variance within the footprint.
    pub fn variance(&self) -> f32 {
        let [a, b] = self.change;
        (a * a + b * b) / 12.0 + self.lost
    }

    /// Whether it varies.
    pub fn varies(&self) -> bool {
        self.change != [0.0; 2] || self.lost != 0.0
    }

    /// The numbers that it is within the footprint.
    pub(super) fn numbers(&self) -> HeldBox {
        HeldBox::new(self.mean, self.variance())
    }

    /// A function of it that is about linear: `mean` is its value, and `slope` how it changes with the number.
    pub(super) fn mapped(&self, mean: f32, slope: f32) -> FilteredNumber {
        let change = self.change.map(|change| slope * change);
        FilteredNumber { mean, change, lost: slope * slope * self.lost }
    }

    /// The sum; what was lost of both is independent.
    pub(super) fn plus(&self, other: FilteredNumber) -> FilteredNumber {
        let change = [0, 1].map(|i| self.change[i] + other.change[i]);
        FilteredNumber { mean: self.mean + other.mean, change, lost: self.lost + other.lost }
    }

    /// The product.
    pub(super) fn times(&self, other: FilteredNumber) -> FilteredNumber {
        let mean = self.mean * other.mean;
        let sum = self.mapped(0.0, other.mean).plus(other.mapped(0.0, self.mean));
        FilteredNumber { mean, ..sum }
    }
}

impl TextureContext {
    /// The point of the sample beside (0) or above (1) this one.
    pub(super) fn beside(&self, i: usize) -> TextureContext {
        let TextureFootprint { p, uv, second_uv } = self.footprint;
        let SurfaceUv { first, second } = self.uv;
        let uv = SurfaceUv { first: first + uv[i], second: second + second_uv[i] };
        TextureContext { p: self.p + p[i], uv, ..*self }
    }
}

/// What is narrower than that is a point: single precision has no digits left within.
pub(super) const NARROW: f64 = 1e-6;

/// Numbers in [0, 1]: 0, 1, and all between two bounds alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HeldBox {
    /// How probable 0 and 1 are.
    pub ends: [f64; 2],
    /// Between which bounds they are with what is left of the probability.
    pub bounds: [f64; 2],
}

impl HeldBox {
    /// The box held to [0, 1] that has this mean and variance; where that is no number of [0, 1], the box itself.
    pub fn new(mean: f32, variance: f32) -> HeldBox {
        let (m, v) = (f64::from(mean), f64::from(variance));
        let half = (3.0 * v).sqrt();
        let is_inside = m - half >= 0.0 && m + half <= 1.0;
        if is_inside || !(0.0..=1.0).contains(&m) {
            return HeldBox { ends: [0.0; 2], bounds: [m - half, m + half] };
        }
        if m > 0.5 {
            let HeldBox { ends: [zero, one], bounds: [lo, hi] } = HeldBox::at_zero(1.0 - m, v);
            return HeldBox { ends: [one, zero], bounds: [1.0 - hi, 1.0 - lo] };
        }
        HeldBox::at_zero(m, v)
    }

    /// Of a mean in [0, 1/2], where the box goes beyond 0.
    fn at_zero(m: f64, v: f64) -> HeldBox {
        let square = v + m * m;
        // Even in [0, b] with the density 1/w: m = b^2 / 2w, v + m^2 = b^3 / 3w.
        let b = if m > 0.0 { 1.5 * square / m } else { 0.0 };
        if b <= 1.0 {
            let inside = if b > 0.0 { 2.0 * m / b } else { 0.0 };
            return HeldBox { ends: [1.0 - inside, 0.0], bounds: [0.0, b] };
        }
        // Even in [0, 1] with the density d, and 1 with the probability q: m = q + d/2, v + m^2 = q + d/3.
        let d = (6.0 * (m - square)).max(0.0);
        let one = m - 0.5 * d;
        HeldBox { ends: [1.0 - d - one, one], bounds: [0.0, 1.0] }
    }

    /// The mean of a function.
    ///
    /// * `point`: the function
    /// * `mean`: its mean between two bounds, the first less than the second
    pub fn mean_of<const N: usize>(
        &self,
        point: impl Fn(f32) -> [f32; N],
        mean: impl Fn(f64, f64) -> [f64; N],
    ) -> [f32; N] {
        let [zero, one] = self.ends;
        let [lo, hi] = self.bounds;
        let inside =
            if hi - lo < NARROW { point((0.5 * (lo + hi)) as f32).map(f64::from) } else { mean(lo, hi) };
        let mut sum = inside.map(|v| (1.0 - zero - one) * v);
        for (end, share) in [(0.0, zero), (1.0, one)] {
            if share > 0.0 {
                let value = point(end);
                (0..N).for_each(|i| sum[i] += share * f64::from(value[i]));
            }
        }
        sum.map(|v| v as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_have_the_mean_and_the_variance_that_they_are_made_of() {
        for (i, k) in (0..=40).flat_map(|i| (0..=40).map(move |k| (i, k))) {
            let mean = i as f32 / 40.0;
            let most = mean * (1.0 - mean);
            let variance = most * k as f32 / 40.0;
            let found = HeldBox::new(mean, variance);
            let ([zero, one], [lo, hi]) = (found.ends, found.bounds);
            let inside = 1.0 - zero - one;
            let near = |a: f64, b: f32| (a - f64::from(b)).abs() < 1e-6;
            assert!([zero, one, inside].iter().all(|p| (-1e-6..=1.000_001).contains(p)), "{found:?}");
            assert!(lo >= -1e-6 && lo <= hi && hi <= 1.000_001, "{mean} {variance}: {found:?}");
            let first = one + inside * 0.5 * (lo + hi);
            let second = one + inside * (lo * lo + lo * hi + hi * hi) / 3.0;
            assert!(
                near(first, mean) && near(second - first * first, variance),
                "{mean} {variance}: {found:?}"
            );
        }
        // Two values alone, and no more than that.
        for variance in [0.1875, 5.0] {
            let two = HeldBox::new(0.25, variance);
            assert!((two.ends[0] - 0.75).abs() < 1e-6 && (two.ends[1] - 0.25).abs() < 1e-6, "{two:?}");
        }
        assert_eq!(HeldBox::new(3.0, 1.0 / 12.0).ends, [0.0; 2]);
    }

    #[test]
    fn differences_follow_chains() {
        let a = FilteredNumber { mean: 0.5, change: [0.25, -0.5], lost: 0.125 };
        let b = FilteredNumber { mean: 0.25, change: [-0.25, 0.5], lost: 0.5 };
        assert_eq!(a.plus(b), FilteredNumber { mean: 0.75, change: [0.0; 2], lost: 0.625 });
        let product = FilteredNumber { mean: 0.125, change: [-0.0625, 0.125], lost: 0.125 / 16.0 + 0.125 };
        assert_eq!(a.times(b), product);
        assert_eq!(a.mapped(2.0, -2.0), FilteredNumber { mean: 2.0, change: [-0.5, 1.0], lost: 0.5 });
        assert!((a.variance() - (0.0625 + 0.25) / 12.0 - 0.125).abs() < 1e-7 && a.varies());
        assert!(!FilteredNumber::point(0.5).varies());
    }
}
