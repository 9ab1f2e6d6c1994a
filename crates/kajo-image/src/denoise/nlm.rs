//! Joint non-local means, guided by albedo, normals and the variance of the picture.
//!
//! A pixel `p` becomes the weighted mean of the pixels `q` of a window around it, `Σ w(p, q) c_q / Σ w(p,
//! q)`. Two pixels are alike when the patches around them differ by no more than their noise explains: with
//! `V` the variance, averaged over 3 × 3 pixels,
//!
//! ```text
//! d²(p, q) = mean over patch and channels of ((c_p - c_q)² - (V_p + min(V_p, V_q))) / (ε + k² (V_p + V_q))
//! w_c = exp(-max(0, d²))
//! ```
//!
//! [Rousselle, Knaus and Zwicker 2012, eq. 5 and 6]. Albedo and normals keep edges that the noise hides,
//!
//! ```text
//! w_f = exp(-(|a_p - a_q|² / k_a² + |n_p - n_q|² / k_n²)),    w = min(w_c, w_f)
//! ```
//!
//! [Rousselle, Manzi and Zwicker 2013]. The picture is divided by the albedo before and multiplied by it
//! afterwards, so that patterns of surfaces do not count as differences of light. Where a picture has
//! converged its variance is next to nothing, and it stays as it is.
//!
//! Before all that, single pixels that are far too bright are held down.
//!
//! Rows are worked on in bands of a fixed height, so the result does not depend on the number of threads.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use kajo_math::fmath;

use super::{Guided, spikes};
use crate::{Image, ImageError};

/// The window reaches this far to each side.
const WINDOW: i32 = 8;

/// The patch reaches this far to each side.
const PATCH: i32 = 3;

/// How many standard deviations of the noise two values may be apart, about.
const K: f32 = 0.6;

/// Distances of albedos and of normals that count as different.
const K_ALBEDO: f32 = 0.1;
const K_NORMAL: f32 = 0.3;

/// Added to variances, so that equal values without noise are alike.
const EPSILON: f32 = 1e-10;

/// Darkest albedo that the picture is divided by.
const LEAST_ALBEDO: f32 = 0.02;

/// Rows of a band.
const BAND: usize = 16;

/// The picture with less noise.
///
/// * `threads`: at least 1; the result does not depend on it
///
/// # Errors
/// [`ImageError::Parameter`] when the images do not fit together.
pub fn denoise(picture: &Guided<'_>, threads: usize) -> Result<Image, ImageError> {
    picture.check()?;
    let planes = Planes::new(picture);
    let mut result = picture.color.clone();
    let row = 3 * planes.width.max(1);
    let bands: Vec<Mutex<&mut [f32]>> = result.data_mut().chunks_mut(BAND * row).map(Mutex::new).collect();
    let next = AtomicUsize::new(0);
    let work = || {
        let mut scratch = Scratch::default();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(band) = bands.get(index) else { return };
            // Each band is taken once, so no thread waits for it.
            let mut out = band.lock().unwrap_or_else(PoisonError::into_inner);
            planes.smooth(index * BAND, &mut out, &mut scratch);
        }
    };
    thread::scope(|scope| {
        for _ in 1..threads.max(1) {
            // Fewer threads than asked for make the same picture.
            if thread::Builder::new().spawn_scoped(scope, work).is_err() {
                break;
            }
        }
        work();
    });
    Ok(result)
}

/// What is compared, with three values for each pixel.
struct Planes {
    width: usize,
    height: usize,
    /// The picture over the albedo.
    light: Vec<[f32; 3]>,
    /// Its variance, smoothed.
    variance: Vec<[f32; 3]>,
    /// What the picture was divided by.
    albedo: Vec<[f32; 3]>,
    /// Albedo and normal in units of the distances that count.
    features: Vec<[f32; 6]>,
}

/// Memory for one band and one shift of it.
#[derive(Default)]
struct Scratch {
    /// Differences of pixels; a row of patches reaches beyond the band.
    differences: Vec<f32>,
    /// The same summed over the rows of patches.
    rows: Vec<f32>,
    /// Sums of weighted light and of weights.
    sums: Vec<[f32; 4]>,
}

impl Planes {
    fn new(picture: &Guided<'_>) -> Planes {
        let [width, height] = [picture.color.width(), picture.color.height()].map(|n| n as usize);
        let albedo: Vec<[f32; 3]> = triples(picture.albedo).map(|a| a.map(|v| v.max(LEAST_ALBEDO))).collect();
        let over = |(values, albedo): ([f32; 3], &[f32; 3])| [0, 1, 2].map(|c| values[c] / albedo[c]);
        let mut light: Vec<[f32; 3]> = triples(picture.color).zip(&albedo).map(over).collect();
        let mut variance: Vec<[f32; 3]> =
            triples(picture.variance).zip(&albedo).map(over).zip(&albedo).map(over).collect();
        let feature = |(a, n): ([f32; 3], [f32; 3])| {
            let (a, n) = (a.map(|v| v / K_ALBEDO), n.map(|v| v / K_NORMAL));
            [a[0], a[1], a[2], n[0], n[1], n[2]]
        };
        let features: Vec<_> = triples(picture.albedo).zip(triples(picture.normal)).map(feature).collect();
        if width > 0 {
            spikes::hold_down(width, &mut light, &mut variance, &features);
        }
        let variance = smoothed(&variance, width, height);
        Planes { width, height, light, variance, albedo, features }
    }

    /// Smooths the rows from `y0` on, as many as `out` has.
    fn smooth(&self, y0: usize, out: &mut [f32], scratch: &mut Scratch) {
        let count = out.len() / (3 * self.width);
        scratch.sums.clear();
        scratch.sums.resize(count * self.width, [0.0; 4]);
        for dy in -WINDOW..=WINDOW {
            for dx in -WINDOW..=WINDOW {
                self.differences(y0, count, dx, dy, scratch);
                self.gather(y0, count, dx, dy, scratch);
            }
        }
        for (i, (out, sums)) in out.chunks_exact_mut(3).zip(&scratch.sums).enumerate() {
            let albedo = self.albedo[y0 * self.width + i];
            for c in 0..3 {
                out[c] = sums[c] / sums[3] * albedo[c];
            }
        }
    }

    /// `d²` of single pixels and those shifted by `(dx, dy)`, over the rows of the band and of patches around it.
    fn differences(&self, y0: usize, count: usize, dx: i32, dy: i32, scratch: &mut Scratch) {
        scratch.differences.clear();
        for y in y0 as i32 - PATCH..(y0 + count) as i32 + PATCH {
            let (row, shifted) = (self.row(y), self.row(y + dy));
            for x in 0..self.width as i32 {
                let (p, q) = (row + x as usize, shifted + clamped(x + dx, self.width));
                let (c, d, v, w) = (self.light[p], self.light[q], self.variance[p], self.variance[q]);
                let term = |i: usize| {
                    let difference = c[i] - d[i];
                    (difference * difference - (v[i] + v[i].min(w[i]))) / (EPSILON + K * K * (v[i] + w[i]))
                };
                scratch.differences.push((term(0) + term(1) + term(2)) / 3.0);
            }
        }
        let width = self.width;
        scratch.rows.clear();
        for row in scratch.differences.chunks_exact(width) {
            for x in 0..width as i32 {
                scratch.rows.push((x - PATCH..=x + PATCH).map(|x| row[clamped(x, width)]).sum());
            }
        }
    }

    /// Adds the pixels shifted by `(dx, dy)` to the sums of the band, where there are such.
    fn gather(&self, y0: usize, count: usize, dx: i32, dy: i32, scratch: &mut Scratch) {
        /// Pixels of a patch.
        const AREA: f32 = ((2 * PATCH + 1) * (2 * PATCH + 1)) as f32;
        let width = self.width;
        for y in 0..count {
            let shifted = (y0 + y) as i32 + dy;
            if !(0..self.height as i32).contains(&shifted) {
                continue;
            }
            let from = 0.max(-dx)..(width as i32).min(width as i32 - dx);
            for x in from {
                let patch = (0..=2 * PATCH as usize).map(|row| scratch.rows[(y + row) * width + x as usize]);
                let distance = (patch.sum::<f32>() / AREA).max(0.0);
                let (p, q) = ((y0 + y) * width + x as usize, shifted as usize * width + (x + dx) as usize);
                let features = self.features[p].iter().zip(&self.features[q]);
                let distance = distance.max(features.map(|(a, b)| (a - b) * (a - b)).sum());
                // What is farther apart adds less than rounding takes away.
                if distance > 16.0 {
                    continue;
                }
                let weight = fmath::exp(-distance);
                let (sums, light) = (&mut scratch.sums[y * width + x as usize], self.light[q]);
                for c in 0..3 {
                    sums[c] += weight * light[c];
                }
                sums[3] += weight;
            }
        }
    }

    /// Where row `y` begins; beyond the picture the nearest row counts.
    fn row(&self, y: i32) -> usize {
        clamped(y, self.height) * self.width
    }
}

fn triples(image: &Image) -> impl Iterator<Item = [f32; 3]> {
    image.pixels().map(|v| [v[0], v[1], v[2]])
}

/// The nearest index of `n`.
fn clamped(i: i32, n: usize) -> usize {
    i.clamp(0, n as i32 - 1) as usize
}

/// Means over 3 × 3 pixels.
fn smoothed(plane: &[[f32; 3]], width: usize, height: usize) -> Vec<[f32; 3]> {
    let mean = |i: usize| {
        let (x, y) = ((i % width) as i32, (i / width) as i32);
        let mut sum = [0.0; 3];
        for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
            let value = plane[clamped(y + dy, height) * width + clamped(x + dx, width)];
            (0..3).for_each(|c| sum[c] += value[c]);
        }
        sum.map(|v| v / 9.0)
    };
    (0..plane.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::rng::Stream;

    const SIZE: [u32; 2] = [72, 56];

    /// A wall with a pattern, a ball before it and an emitter: light, albedo and normal at a pixel.
    fn truth(x: u32, y: u32) -> ([f32; 3], [f32; 3], [f32; 3]) {
        let (u, v) = (x as f32 - 36.0, y as f32 - 28.0);
        if u > 22.0 && v.abs() < 8.0 {
            return ([12.0, 11.0, 9.0], [1.0; 3], [0.0, 0.0, 1.0]);
        }
        let (albedo, n) = if u * u + v * v < 300.0 {
            let n = [u / 18.0, -v / 18.0, (1.0 - (u * u + v * v) / 324.0).sqrt()];
            ([0.8, 0.3, 0.2], n)
        } else {
            (if (x / 5 + y / 5).is_multiple_of(2) { [0.7; 3] } else { [0.2, 0.25, 0.3] }, [0.0, 0.0, 1.0])
        };
        let light = 0.2 + 0.8 * (0.6 * n[2] + 0.4 * n[0] + 0.01 * v).max(0.0);
        (albedo.map(|a| a * light), albedo, n)
    }

    struct Layers {
        truth: Image,
        color: Image,
        variance: Image,
        albedo: Image,
        normal: Image,
    }

    /// The mean of `n` samples of exponential distribution, with its estimated variance.
    fn noisy(n: u32) -> Layers {
        let image = |f: &dyn Fn(u32, u32) -> [f32; 3]| Image::from_fn(SIZE[0], SIZE[1], f).unwrap();
        let sample = |x, y, k, c: usize| {
            let u = Stream::new(3, [x, y], k).uniform(c as u32);
            -truth(x, y).0[c] * fmath::ln(1.0 - u)
        };
        let moments = |x, y, c| {
            let values = (0..n).map(|k| sample(x, y, k, c));
            let (sum, squares) =
                values.fold((0.0, 0.0), |(a, b), v| (a + f64::from(v), b + f64::from(v * v)));
            let mean = sum / f64::from(n);
            (mean as f32, ((squares / f64::from(n) - mean * mean) / f64::from(n - 1)) as f32)
        };
        Layers {
            truth: image(&|x, y| truth(x, y).0),
            color: image(&|x, y| [0, 1, 2].map(|c| moments(x, y, c).0)),
            variance: image(&|x, y| [0, 1, 2].map(|c| moments(x, y, c).1)),
            albedo: image(&|x, y| truth(x, y).1),
            normal: image(&|x, y| truth(x, y).2),
        }
    }

    impl Layers {
        fn guided(&self) -> Guided<'_> {
            let Layers { color, variance, albedo, normal, .. } = self;
            Guided { color, variance, albedo, normal }
        }

        /// Mean squared relative error of a picture.
        fn error(&self, image: &Image) -> f64 {
            let pairs = image.data().iter().zip(self.truth.data());
            let error = |(a, b): (&f32, &f32)| f64::from((a - b) * (a - b) / (b * b + 0.01));
            pairs.map(error).sum::<f64>() / image.data().len() as f64
        }
    }

    #[test]
    fn sixteen_samples_lose_most_of_their_noise() {
        let layers = noisy(16);
        let smooth = denoise(&layers.guided(), 2).unwrap();
        let (before, after) = (layers.error(&layers.color), layers.error(&smooth));
        assert!(before > 5.0 * after, "{before} to {after}");
        let mean = |image: &Image| image.data().iter().map(|&v| f64::from(v)).sum::<f64>();
        assert!((mean(&smooth) / mean(&layers.color) - 1.0).abs() < 0.02, "no light is lost");
    }

    #[test]
    fn fireflies_leave_no_squares() {
        let mut layers = noisy(16);
        let calm = layers.error(&denoise(&layers.guided(), 2).unwrap());
        for (x, y) in [(8, 9), (20, 50), (36, 28), (50, 12), (51, 12), (60, 45)] {
            let i = (y * SIZE[0] as usize + x) * 3;
            layers.color.data_mut()[i..i + 3].fill(60.0);
            layers.variance.data_mut()[i..i + 3].fill(3600.0);
        }
        let smooth = denoise(&layers.guided(), 2).unwrap();
        let error = layers.error(&smooth);
        assert!(error < 20.0 * calm, "{calm} without fireflies, {error} with them");
    }

    #[test]
    fn a_converged_picture_stays() {
        let mut layers = noisy(16);
        layers.color = layers.truth.clone();
        // As after four million samples, and without any noise.
        for variance in [2.5e-7, 0.0] {
            layers.variance =
                Image::from_fn(SIZE[0], SIZE[1], |x, y| truth(x, y).0.map(|v| v * v * variance)).unwrap();
            let smooth = denoise(&layers.guided(), 2).unwrap();
            for (a, b) in smooth.data().iter().zip(layers.truth.data()) {
                assert!((a.min(1.0) - b.min(1.0)).abs() < 0.5 / 255.0, "{b} became {a}");
            }
        }
    }

    #[test]
    fn threads_change_nothing_and_any_size_works() {
        let layers = noisy(4);
        let one = denoise(&layers.guided(), 1).unwrap();
        assert!(one == denoise(&layers.guided(), 5).unwrap());
        for size in [[1, 1], [3, 40], [40, 2]] {
            let image = Image::filled(size[0], size[1], &[0.5; 3]).unwrap();
            let guided = Guided { color: &image, variance: &image, albedo: &image, normal: &image };
            let smooth = denoise(&guided, 1).unwrap();
            assert!(smooth.data().iter().all(|v| (v - 0.5).abs() < 1e-6));
        }
        let grey = Image::new(SIZE[0], SIZE[1], 1).unwrap();
        assert!(denoise(&Guided { albedo: &grey, ..layers.guided() }, 1).is_err());
    }
}
