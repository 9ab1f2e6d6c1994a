//! Is the mean of a Monte Carlo estimator right, and would the test have seen that it is not?
//!
//! The samples are cut into independent batches. With `m` the mean of the batches and `s` its standard
//! error, the estimator passes for an expected value `mu` when `|m - mu| < 4 s` *and* `s` is small: an
//! estimate too noisy to be wrong proves nothing.

/// Batches; fewer would make the standard error itself too uncertain.
pub const BATCHES: u32 = 32;

/// A mean and its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Mean of the batches.
    pub mean: f64,
    /// Standard deviation of that mean.
    pub standard_error: f64,
}

impl Estimate {
    /// Runs an estimator for each of 32 batches; `batch(i)` returns the mean of the samples of batch `i`, which
    /// must not depend on those of other batches.
    pub fn of_batches(batch: impl FnMut(u32) -> f64) -> Estimate {
        let means: Vec<f64> = (0..BATCHES).map(batch).collect();
        let n = f64::from(BATCHES);
        let mean = means.iter().sum::<f64>() / n;
        let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0);
        Estimate { mean, standard_error: (variance / n).sqrt() }
    }

    /// Checks the mean against `mu`.
    ///
    /// * `noise`: largest standard error allowed, as a share of `mu`; 0.0005 sees a bias of a quarter of a per cent
    ///
    /// # Errors
    /// What is wrong, for the message of an assertion.
    pub fn check(&self, mu: f64, noise: f64) -> Result<(), String> {
        let Estimate { mean, standard_error } = *self;
        if standard_error.is_nan() || standard_error > noise * mu.abs() {
            return Err(format!("{mean} ± {standard_error} is too noisy to be compared with {mu}"));
        }
        // Rounding to single precision alone may part an estimator without variance from its value.
        let tolerance = (4.0 * standard_error).max(1e-8 * mu.abs());
        if (mean - mu).abs() > tolerance {
            return Err(format!("{mean} ± {standard_error} is not {mu}"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::rng::Stream;

    /// The mean of x² over [0, 1), times a factor.
    fn square(samples: u32, factor: f64) -> Estimate {
        Estimate::of_batches(|batch| {
            let value = |i| f64::from(Stream::new(8, [i, batch], 0).uniform(0)).powi(2) * factor;
            (0..samples).map(value).sum::<f64>() / f64::from(samples)
        })
    }

    #[test]
    fn a_right_mean_passes_and_a_biased_one_does_not() {
        assert_eq!(square(100_000, 1.0).check(1.0 / 3.0, 0.001), Ok(()));
        let biased = square(100_000, 1.005).check(1.0 / 3.0, 0.001);
        assert!(biased.is_err_and(|e| e.contains("is not")));
    }

    #[test]
    fn a_noisy_mean_proves_nothing() {
        assert!(square(100, 1.0).check(1.0 / 3.0, 0.0005).is_err_and(|e| e.contains("too noisy")));
        assert!(Estimate::of_batches(|_| f64::NAN).check(1.0, 0.1).is_err());
    }

    #[test]
    fn the_standard_error_is_that_of_the_variance() {
        // The variance of x² is 4/45.
        let expected = (4.0f64 / 45.0 / 320_000.0).sqrt();
        let found = square(10_000, 1.0).standard_error;
        assert!((found / expected - 1.0).abs() < 0.4, "{found}, expected about {expected}");
        assert_eq!(Estimate::of_batches(|_| 0.1).check(0.1, 1e-12), Ok(()));
    }
}
