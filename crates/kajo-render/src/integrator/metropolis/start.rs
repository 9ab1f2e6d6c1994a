//! How bright the picture is, and where chains begin.

use kajo_math::rng::{Key, mix};

use super::chain::{Brightness, Evaluation, Start};
use super::mutated::Mutated;
use crate::{RayCounters, Setup, SetupError};

/// Independent samples, and how many of them a pixel of a small picture has.
const SAMPLES: u32 = 1 << 17;
const SAMPLES_OF_PIXEL: u32 = 256;

/// The least of them.
const FEWEST: u32 = 1 << 12;

/// Samples of each class, where there are several, and of all of them together.
const SAMPLES_OF_CLASS: u32 = 1 << 16;
const SAMPLES_OF_CLASSES: u32 = 1 << 20;

/// Samples of one task.
const SAMPLES_A_TASK: u32 = 2048;

/// 2^64 times the golden section, an odd number.
const GOLDEN_SECTION: u64 = 0x9E37_79B9_7F4A_7C15;

/// Sets the seeds of these samples, and of the choice among them, apart from all others.
const SALT: u64 = 0x7374_6172_7473;

/// Importances of independent samples.
pub struct Starts {
    seed: u64,
    /// The first class. All classes have as many samples, those of the first one first.
    first_class: u32,
    /// Mean importance of each class.
    means: Vec<f64>,
    /// Sums of the importances of all samples up to each.
    sums: Vec<f64>,
    /// Standard error of the sum of the means.
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
    /// Of samples of several classes each has its mean `b_k` of as many of them, and `b` is the sum of these.
    ///
    /// # Errors
    /// [`SetupError`]
    pub fn find(
        mutated: Mutated<'_>,
        size: [u32; 2],
        setup: &Setup<'_>,
    ) -> Result<(Starts, RayCounters), SetupError> {
        let pixels = size[0].saturating_mul(size[1]);
        let samples = pixels.saturating_mul(SAMPLES_OF_PIXEL).clamp(FEWEST, SAMPLES);
        let samples = match mutated.classes().len() as u32 {
            1 => samples,
            n => samples.min(SAMPLES_OF_CLASS).min(SAMPLES_OF_CLASSES / n),
        };
        Starts::of_samples(samples, mutated, size, setup)
    }

    /// The same with a number of samples of each class.
    pub fn of_samples(
        samples: u32,
        mutated: Mutated<'_>,
        size: [u32; 2],
        setup: &Setup<'_>,
    ) -> Result<(Starts, RayCounters), SetupError> {
        let classes = mutated.classes();
        let n_classes = classes.len() as u32;
        let (of_class, samples) = (samples, samples * n_classes);
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
            let mut evaluation = Evaluation::alone(mutated, size);
            let start = |i| Start { seed, number: i, class: classes.start + i / of_class };
            let importance = |i| evaluation.begin(&start(i)).importance;
            let found: Vec<f32> = (begin..(begin + SAMPLES_A_TASK).min(samples)).map(importance).collect();
            Ok((found, evaluation.rays()))
        })?;
        let mut rays = RayCounters::default();
        let mut sums = Vec::with_capacity(samples as usize);
        let mut sum = 0.0;
        // For each class, the sum of importances and that of their squares.
        let mut of_classes = vec![[0.0; 2]; classes.len()];
        for (found, cast) in tasks {
            rays += cast;
            for importance in found.into_iter().map(f64::from) {
                let class = &mut of_classes[sums.len() / of_class as usize];
                class[0] += importance;
                class[1] += importance * importance;
                sum += importance;
                sums.push(sum);
            }
        }
        let n = f64::from(of_class.max(1));
        let variance = |[sum, squares]: &[f64; 2]| (squares / n - (sum / n) * (sum / n)).max(0.0);
        let standard_error = of_classes.iter().map(|class| variance(class) / n).sum::<f64>().sqrt();
        let means = of_classes.iter().map(|[sum, _]| sum / n).collect();
        Ok((Starts { seed, first_class: classes.start, means, sums, standard_error }, rays))
    }

    /// `b`: the mean importance of all samples, summed over their classes.
    pub fn brightness(&self) -> f64 {
        self.means.iter().sum()
    }

    /// `b_k` and `b`, for a chain that begins there.
    pub fn brightness_of(&self, start: &Start) -> Brightness {
        let of_class = self.means[(start.class - self.first_class) as usize];
        Brightness { of_class, of_all: self.brightness() }
    }

    /// Its standard error.
    pub fn standard_error(&self) -> f64 {
        self.standard_error
    }

    /// A sample drawn in proportion to its importance, for sample `index` of a block; `None` where all are dark.
    ///
    /// * `chain`: number of the chain in the picture. Where there are several classes, chains in a row are shared out among these evenly, by a
    ///   sequence of steps of the golden section.
    pub fn draw(&self, seed: u64, block: [u32; 2], index: u32, chain: u64) -> Option<Start> {
        let all = *self.sums.last().filter(|&&all| all > 0.0)?;
        let key = Key::new(seed ^ SALT);
        let [high, low] = match self.means.len() {
            1 => {
                let [high, low, _] = key.part(block).words([index, 0]);
                [high, low]
            }
            _ => {
                let [high, low, _] = key.words([0, 1]);
                let begin = u64::from(high) << 32 | u64::from(low);
                let at = begin.wrapping_add(chain.wrapping_mul(GOLDEN_SECTION));
                [(at >> 32) as u32, at as u32]
            }
        };
        let u = (f64::from(high) + f64::from(low) / 4_294_967_296.0) / 4_294_967_296.0;
        let number = self.sums.partition_point(|&sum| sum <= u * all).min(self.sums.len() - 1);
        let class = self.first_class + (number * self.means.len() / self.sums.len()) as u32;
        Some(Start { seed: self.seed, number: number as u32, class })
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
