//! The mean of a picture, from independent batches.

use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

use kajo_image::Format;
use kajo_math::rng::mix;
use kajo_render::Silent;
use kajo_scene::MemoryAssets;

use kajo::{Defaults, LoadOptions, RenderSettings, Resources, SamplerKind, Scene, Settings, View};

/// Independent renders of a scene; fewer would make the standard error itself too uncertain.
pub const BATCHES: u64 = 32;

/// Samples of a picture in the first round; each further round takes four times as many, or what is missing.
const FIRST_SAMPLES: u32 = 64;

/// Memory that a picture may take: they are tiny.
const MEMORY: u64 = 1 << 28;

/// A scene and the size of its picture; what counts is the mean of the picture.
#[derive(Clone, Debug)]
pub struct Exposure {
    /// The scene file.
    pub text: String,
    /// Files that it names, with their content.
    pub files: Vec<(String, String)>,
    /// Columns and rows.
    pub size: [u32; 2],
}

/// What a mean is compared with, and how sharp it must be for that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The expected value.
    pub mu: f64,
    /// Error that single precision alone may make, as a share of `mu`.
    pub rounding: f64,
    /// Largest standard error of the mean.
    pub sigma: f64,
    /// Samples after which no more are taken.
    pub most_samples: u64,
}

/// A mean and how far to trust it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Mean of all batches.
    pub mean: f64,
    /// Standard deviation of that mean.
    pub standard_error: f64,
    /// Camera rays it took.
    pub samples: u64,
    /// Whether the standard error came below what was asked for.
    pub is_sharp: bool,
}

impl Estimate {
    /// Whether it may be an estimate of what is expected.
    pub fn agrees(&self, target: &Target) -> bool {
        (self.mean - target.mu).abs() <= (4.0 * self.standard_error).max(target.rounding * target.mu.abs())
    }

    /// Whether batches without any spread may be off by chance, and more samples show it.
    ///
    /// Of `n` stratified samples `n o` meet a surface of opacity `o`, rounded up or down. Where that is almost a whole number, all
    /// batches are likely to agree on a mean that is off by a part of one sample. What is off by more is wrong.
    fn may_be_even_by_chance(&self, target: &Target, samples_each: u64) -> bool {
        /// Brightness of a sample, at most, in units of the mean.
        const BRIGHTEST: f64 = 16.0;
        let off = (self.mean / target.mu - 1.0).abs();
        !self.agrees(target) && off < BRIGHTEST / samples_each as f64
    }

    /// From the sums of the batches over the same number of samples each.
    fn of(sums: &[f64], samples_each: u64, sigma: f64) -> Estimate {
        let n = sums.len() as f64;
        let means = sums.iter().map(|sum| sum / samples_each as f64);
        let mean = means.clone().sum::<f64>() / n;
        let variance = means.map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let standard_error = (variance / n).sqrt();
        let samples = samples_each * sums.len() as u64;
        Estimate { mean, standard_error, samples, is_sharp: standard_error <= sigma }
    }
}

impl Exposure {
    /// Renders until the standard error of the mean is at most that of the target, or about as many samples are taken
    /// as it allows.
    ///
    /// * `threads`: 0 for one on each core
    ///
    /// # Errors
    /// Why there is no picture.
    pub fn measure(&self, seed: u64, target: &Target, threads: usize) -> Result<Estimate, String> {
        let scene = self.load()?;
        let pixels = u64::from(self.size[0]) * u64::from(self.size[1]);
        let mut samples = (u64::from(FIRST_SAMPLES) / pixels).max(1) as u32;
        let mut sums = [0.0; BATCHES as usize];
        let mut samples_each = 0;
        for round in 0.. {
            let batch = |i: u64| self.render(&scene, samples, mix(seed ^ mix(round * BATCHES + i)));
            let taken = pixels * u64::from(samples);
            for (sum, mean) in sums.iter_mut().zip(on_threads(BATCHES, threads, batch)?) {
                *sum += mean * taken as f64;
            }
            samples_each += taken;
            let estimate = Estimate::of(&sums, samples_each, target.sigma);
            // A few samples may agree with each other by chance.
            let settled = match estimate.standard_error {
                0.0 => !estimate.may_be_even_by_chance(target, samples_each),
                _ => estimate.is_sharp && round > 0,
            };
            let noise = if estimate.standard_error == 0.0 {
                f64::INFINITY
            } else {
                estimate.standard_error / target.sigma
            };
            samples = next_round(samples, samples_each / pixels, noise);
            if settled || estimate.samples + BATCHES * pixels * u64::from(samples) > target.most_samples {
                return Ok(estimate);
            }
        }
        unreachable!("the rounds grow until one of them is the last")
    }

    /// What is wrong with the scene.
    #[cfg(test)]
    pub fn complaints(&self) -> Option<String> {
        self.load().err()
    }

    fn load(&self) -> Result<Scene, String> {
        const NAME: &str = "selftest.txt";
        let assets = MemoryAssets::new().with(NAME, &self.text);
        let assets = self.files.iter().fold(assets, |assets, (name, content)| assets.with(name, content));
        let loaded = kajo::load_from(NAME, &assets, &LoadOptions::default());
        let complaints: Vec<String> = loaded.lines().collect();
        loaded.scene.filter(|_| complaints.is_empty()).ok_or_else(|| complaints.join("; "))
    }

    /// The mean of a picture's red channel.
    fn render(&self, scene: &Scene, samples: u32, seed: u64) -> Result<f64, String> {
        let pattern = scene.output.settings.samples.map_or(SamplerKind::Sobol, |(pattern, _)| pattern);
        let asked = Settings {
            size: Some(self.size),
            samples: Some((pattern, samples)),
            seed: Some(seed),
            ..Settings::default()
        };
        let settings = RenderSettings::resolve(scene, &asked, Defaults::Modern, false);
        let settings = settings.map_err(|error| error.to_string())?;
        let resources = Resources { threads: 1, memory: Some(MEMORY), ..Resources::default() };
        let outputs = [(View::Color, Format::Exr)];
        let picture =
            kajo::render(&kajo::RenderRequest::new(scene, &settings, &outputs).with(resources), &Silent)
                .map_err(|error| error.to_string())?;
        match picture.non_finite() {
            0 => {}
            n => return Err(format!("{n} samples were no numbers")),
        }
        let light = picture.light().map_err(|error| error.to_string())?;
        let pixels = light.rgb_pixels().map(|pixel| f64::from(pixel[0]));
        Ok(pixels.sum::<f64>() / light.rgb_pixels().len() as f64)
    }
}

/// Samples of a pixel in the next round: those that are missing by what is known, as a power of two, which patterns are
/// best at; from a quarter to four times as many as in the last round, `samples`.
///
/// * `taken`: in all rounds
/// * `noise`: standard error over what is asked for; infinite where it is not known
fn next_round(samples: u32, taken: u64, noise: f64) -> u32 {
    /// The noise is an estimate too.
    const MARGIN: f64 = 1.2;
    let missing = MARGIN * taken as f64 * (noise * noise - 1.0);
    let most = samples.saturating_mul(4);
    // Not a number where neither noise nor light is expected; large ones are held to the largest.
    (missing as u32).checked_next_power_of_two().unwrap_or(most).clamp(samples.div_ceil(4), most)
}

/// `work(0)` to `work(n - 1)`, in order, on several threads; or the first error.
fn on_threads<T: Send>(
    n: u64,
    threads: usize,
    work: impl Fn(u64) -> Result<T, String> + Sync,
) -> Result<Vec<T>, String> {
    let cores = || thread::available_parallelism().map_or(1, usize::from);
    let threads = if threads == 0 { cores() } else { threads };
    let next = AtomicU64::new(0);
    let done = Mutex::new(Vec::with_capacity(n as usize));
    thread::scope(|scope| {
        for _ in 0..threads.min(n as usize) {
            scope.spawn(|| {
                loop {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    if i >= n {
                        return;
                    }
                    let result = work(i);
                    done.lock().unwrap_or_else(PoisonError::into_inner).push((i, result));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_by_key(|(i, _)| *i);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_take_what_is_missing() {
        assert_eq!(next_round(16, 21, 1e3), 64, "far from sharp");
        assert_eq!(next_round(1 << 12, 5461, 1.07), 1 << 10, "1.2 * 791 samples are missing");
        assert_eq!(next_round(16, 21, 0.5), 4, "sharp by chance");
        assert_eq!([f64::NAN, f64::INFINITY].map(|noise| next_round(8, 10, noise)), [2, 32]);
    }
}
