//! How bright the picture is, and where chains begin.

use kajo_math::rng::{Key, mix};

use super::chain::{Evaluation, Start};
use crate::{PixelIntegrator, RayCounters};
use crate::{Setup, SetupError};

/// Independent samples, and how many of them a pixel of a small picture has.
const SAMPLES: u32 = 1 << 17;
const SAMPLES_OF_PIXEL: u32 = 256;

/// The least of them.
const FEWEST: u32 = 1 << 12;

/// Samples of one task.
const SAMPLES_A_TASK: u32 = 2048;

/// Sets the seeds of these samples, and of the choice among them, apart from all others.
const SALT: u64 = 0x7374_6172_7473;

/// Importances of independent samples.
pub struct Starts {
    seed: u64,
    /// Sums of the importances of all samples up to each.
    sums: Vec<f64>,
    /// Standard error of their mean.
    standard_error: f64,
}

impl Starts {
    /// Takes `N` independent samples, fewer for pictures of less than 512 pixels. The integral of the importance `I` over all primary samples is
    /// estimated by its mean, and the standard error of that is `sqrt(Var I / N)`:
    ///
    /// ```text
    /// b = 1/N sum of I(u_i),    u_i uniform in the unit cube                       [Kelemen et al. 2002]
    /// ```
    ///
    /// # Errors
    /// [`SetupError`]
    pub fn find(
        integrator: &dyn PixelIntegrator,
        size: [u32; 2],
        setup: &Setup<'_>,
    ) -> Result<(Starts, RayCounters), SetupError> {
        let pixels = size[0].saturating_mul(size[1]);
        let samples = pixels.saturating_mul(SAMPLES_OF_PIXEL).clamp(FEWEST, SAMPLES);
        Starts::of_samples(samples, integrator, size, setup)
    }

    /// The same with a number of samples.
    pub fn of_samples(
        samples: u32,
        integrator: &dyn PixelIntegrator,
        size: [u32; 2],
        setup: &Setup<'_>,
    ) -> Result<(Starts, RayCounters), SetupError> {
        let bytes = u64::from(samples) * 2 * size_of::<f64>() as u64;
        if bytes > setup.memory {
            return Err(SetupError::Refused(format!(
                "Markov chains need {bytes} bytes to begin with, more than the {} that can be had",
                setup.memory
            )));
        }
        let seed = mix(setup.seed ^ SALT);
        let tasks = setup.tasks(samples.div_ceil(SAMPLES_A_TASK), |task| {
            let begin = task * SAMPLES_A_TASK;
            let mut evaluation = Evaluation::alone(integrator, size);
            let importance = |i| evaluation.begin(&Start { seed, number: i }).importance;
            let found: Vec<f32> = (begin..(begin + SAMPLES_A_TASK).min(samples)).map(importance).collect();
            Ok((found, evaluation.rays()))
        })?;
        let mut rays = RayCounters::default();
        let mut sums = Vec::with_capacity(samples as usize);
        let (mut sum, mut squares) = (0.0, 0.0);
        for (found, cast) in tasks {
            rays += cast;
            for importance in found.into_iter().map(f64::from) {
                sum += importance;
                squares += importance * importance;
                sums.push(sum);
            }
        }
        let n = f64::from(samples.max(1));
        let variance = (squares / n - (sum / n) * (sum / n)).max(0.0);
        Ok((Starts { seed, sums, standard_error: (variance / n).sqrt() }, rays))
    }

    /// `b`: the mean importance of all samples.
    pub fn brightness(&self) -> f64 {
        self.sums.last().map_or(0.0, |sum| sum / self.sums.len() as f64)
    }

    /// Its standard error.
    pub fn standard_error(&self) -> f64 {
        self.standard_error
    }

    /// A sample drawn in proportion to its importance, for sample `index` of a block; `None` where all are dark.
    pub fn draw(&self, seed: u64, block: [u32; 2], index: u32) -> Option<Start> {
        let all = *self.sums.last().filter(|&&all| all > 0.0)?;
        let [high, low, _] = Key::new(seed ^ SALT).part(block).words([index, 0]);
        let u = (f64::from(high) + f64::from(low) / 4_294_967_296.0) / 4_294_967_296.0;
        let number = self.sums.partition_point(|&sum| sum <= u * all).min(self.sums.len() - 1);
        Some(Start { seed: self.seed, number: number as u32 })
    }

    /// What the user should know.
    pub fn notes(&self) -> Vec<String> {
        let (b, n) = (self.brightness(), self.sums.len());
        if b <= 0.0 {
            return vec![format!("none of {n} samples found any light, so chains have nowhere to begin")];
        }
        let error = self.standard_error() / b;
        let note = || {
            format!(
                "the brightness of the picture is known to {:.1} % only, by the standard error of {n} independent samples",
                100.0 * error
            )
        };
        (error > super::UNSURE).then(note).into_iter().collect()
    }
}
