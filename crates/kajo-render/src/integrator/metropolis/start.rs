//! How bright the picture is, and where chains begin.

use std::iter::repeat_n;

use kajo_math::rng::{Key, mix};

use super::allotment::{self, Moments};
use super::chain::{Brightness, Evaluation, Start};
use super::mutated::Mutated;
use crate::{RayCounters, Setup, SetupError};

/// The most independent samples, and how many of them a pixel of a small picture has.
const SAMPLES: u32 = 1 << 17;
const SAMPLES_OF_PIXEL: u32 = 256;

/// The least of them.
const FEWEST: u32 = 1 << 12;

/// The most samples of each class, where there are several, and of all of them together.
const SAMPLES_OF_CLASS: u32 = 1 << 16;
const SAMPLES_OF_CLASSES: u32 = 1 << 20;

/// Samples of one task.
const SAMPLES_A_TASK: u32 = 2048;

/// 2^64 times the golden section, an odd number.
const GOLDEN_SECTION: u64 = 0x9E37_79B9_7F4A_7C15;

/// Sets the seeds of these samples, and of the choice among them, apart from all others.
const SALT: u64 = 0x7374_6172_7473;

/// Sets those of a pilot apart from them.
const PILOT_SALT: u64 = 0x70_696C_6F74;

/// Importances of independent samples.
#[derive(Debug, PartialEq)]
pub struct Starts {
    seed: u64,
    /// The first class. Samples are numbered class by class.
    first_class: u32,
    /// What the samples of each class are worth.
    classes: Vec<Moments>,
    /// For each sample, the sum over it and all before it of the importance over the number of samples of its class.
    sums: Vec<f64>,
}

/// Where samples are taken.
#[derive(Clone, Copy)]
struct Source<'a> {
    mutated: Mutated<'a>,
    size: [u32; 2],
    setup: &'a Setup<'a>,
    seed: u64,
}

impl Source<'_> {
    /// Importances of so many samples of each class, class by class, which are added to the moments of their classes, too.
    ///
    /// * `first`: number of the first of them
    fn take(
        &self,
        first: u32,
        numbers: &[u32],
        classes: &mut [Moments],
    ) -> Result<(Vec<f32>, RayCounters), SetupError> {
        let samples: u32 = numbers.iter().sum();
        let bytes = u64::from(samples) * 2 * size_of::<f64>() as u64;
        if bytes > self.setup.memory {
            return Err(SetupError::Refused(format!(
                "Markov chains need {bytes} bytes to begin with, more than the {} that can be had",
                self.setup.memory
            )));
        }
        let ends = ends(numbers);
        let first_class = self.mutated.classes().start;
        let tasks = self.setup.tasks(samples.div_ceil(SAMPLES_A_TASK), |task| {
            let begin = task * SAMPLES_A_TASK;
            let mut evaluation = Evaluation::alone(self.mutated, self.size);
            let class = |i| first_class + ends.partition_point(|&end| end <= i) as u32;
            let start = |i| Start { seed: self.seed, number: first + i, class: class(i) };
            let importance = |i| evaluation.begin(&start(i)).importance;
            let found: Vec<f32> = (begin..(begin + SAMPLES_A_TASK).min(samples)).map(importance).collect();
            Ok((found, evaluation.rays()))
        })?;
        let mut rays = RayCounters::default();
        let mut importances = Vec::with_capacity(samples as usize);
        for (found, cast) in tasks {
            rays += cast;
            importances.extend(found);
        }
        let mut rest = importances.iter();
        for (class, &n) in classes.iter_mut().zip(numbers) {
            rest.by_ref().take(n as usize).for_each(|&importance| class.add(importance.into()));
        }
        Ok((importances, rays))
    }
}

/// For each class, the number of the first sample behind its last one.
fn ends(numbers: &[u32]) -> Vec<u32> {
    let end = |end: &mut u32, &n: &u32| {
        *end += n;
        Some(*end)
    };
    numbers.iter().scan(0, end).collect()
}

impl Starts {
    /// Takes as many independent samples as it takes to know the brightness of the picture well, which a
    /// [pilot](super::allotment) says, but no more than 131,072 of one class and a million of many, fewer for pictures
    /// of less than 512 pixels. The integral of the importance `I` over all primary samples of a class is estimated by
    /// the mean of its samples,
    ///
    /// ```text
    /// b_k = 1/n_k sum of I(u_i),    u_i uniform in the unit cube                       [Kelemen et al. 2002]
    /// ```
    ///
    /// and `b` is the sum of these, with the variance `sum of Var I_k / n_k`.
    ///
    /// # Errors
    /// [`SetupError`]
    pub fn find(
        mutated: Mutated<'_>,
        size: [u32; 2],
        setup: &Setup<'_>,
    ) -> Result<(Starts, RayCounters), SetupError> {
        let pixels = size[0].saturating_mul(size[1]);
        let most = pixels.saturating_mul(SAMPLES_OF_PIXEL).clamp(FEWEST, SAMPLES);
        let most = match mutated.classes().len() as u32 {
            1 => most,
            n => most.min(SAMPLES_OF_CLASS).min(SAMPLES_OF_CLASSES / n) * n,
        };
        Starts::within([FEWEST, most], mutated, size, setup)
    }

    /// The same with at least and at most so many samples of all classes together, but for those of the pilot.
    pub fn within(
        limits: [u32; 2],
        mutated: Mutated<'_>,
        size: [u32; 2],
        setup: &Setup<'_>,
    ) -> Result<(Starts, RayCounters), SetupError> {
        let (numbers, mut rays) = numbers_by_pilot(limits, mutated, size, setup)?;
        let (starts, cast) = Starts::of_samples(&numbers, mutated, size, setup)?;
        rays += cast;
        Ok((starts, rays))
    }

    /// The same with a number of samples of each class.
    pub fn of_samples(
        numbers: &[u32],
        mutated: Mutated<'_>,
        size: [u32; 2],
        setup: &Setup<'_>,
    ) -> Result<(Starts, RayCounters), SetupError> {
        let seed = mix(setup.seed ^ SALT);
        let mut classes = vec![Moments::default(); numbers.len()];
        let source = Source { mutated, size, setup, seed };
        let (importances, rays) = source.take(0, numbers, &mut classes)?;
        let shares = numbers.iter().flat_map(|&n| repeat_n(1.0 / f64::from(n), n as usize));
        let summed = |sum: &mut f64, (importance, share): (f32, f64)| {
            *sum += f64::from(importance) * share;
            Some(*sum)
        };
        let sums = importances.into_iter().zip(shares).scan(0.0, summed).collect();
        Ok((Starts { seed, first_class: mutated.classes().start, classes, sums }, rays))
    }

    /// `b`: the mean importance of all samples, summed over their classes.
    pub fn brightness(&self) -> f64 {
        self.classes.iter().map(Moments::mean).sum()
    }

    /// `b_k` and `b`, for a chain that begins there.
    pub fn brightness_of(&self, start: &Start) -> Brightness {
        let of_class = self.classes[(start.class - self.first_class) as usize].mean();
        Brightness { of_class, of_all: self.brightness() }
    }

    /// Number of all samples.
    pub fn number(&self) -> usize {
        self.sums.len()
    }

    /// Standard error of the [brightness](Self::brightness).
    pub fn standard_error(&self) -> f64 {
        self.classes.iter().map(Moments::variance_of_mean).sum::<f64>().sqrt()
    }

    /// A sample drawn in proportion to its importance over the number of samples of its class, for sample `index` of a
    /// block; `None` where all are dark.
    ///
    /// * `chain`: number of the chain in the picture. Where there are several classes, chains in a row are shared out among these evenly, by a
    ///   sequence of steps of the golden section.
    pub fn draw(&self, seed: u64, block: [u32; 2], index: u32, chain: u64) -> Option<Start> {
        let all = *self.sums.last().filter(|&&all| all > 0.0)?;
        let key = Key::new(seed ^ SALT);
        let [high, low] = match self.classes.len() {
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
        let ends = ends(&self.classes.iter().map(|class| class.n).collect::<Vec<u32>>());
        let class = self.first_class + ends.partition_point(|&end| end <= number as u32) as u32;
        Some(Start { seed: self.seed, number: number as u32, class })
    }

    /// What the user should know.
    pub fn notes(&self) -> Vec<String> {
        let (b, n) = (self.brightness(), self.number());
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

/// How many samples of each class it takes, by a pilot.
fn numbers_by_pilot(
    limits: [u32; 2],
    mutated: Mutated<'_>,
    size: [u32; 2],
    setup: &Setup<'_>,
) -> Result<(Vec<u32>, RayCounters), SetupError> {
    let source = Source { mutated, size, setup, seed: mix(setup.seed ^ PILOT_SALT) };
    let (mut first, mut rays) = (0, RayCounters::default());
    let more = |numbers: &[u32], pilot: &mut [Moments]| {
        let (importances, cast) = source.take(first, numbers, pilot)?;
        rays += cast;
        first += importances.len() as u32;
        Ok(())
    };
    let numbers = allotment::numbers(mutated.classes().len(), limits, more)?;
    Ok((numbers, rays))
}
