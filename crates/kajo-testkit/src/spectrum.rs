//! Power spectra of point sets and of images.
//!
//! The periodogram of `N` points on the unit torus is, for whole frequencies `f`,
//!
//! ```text
//! P(f) = |sum over points of exp(-2 pi i f.p)|^2 / N
//! ```
//!
//! whose mean is 1 for independent points, and which vanishes where the points leave nothing to chance
//! [Ulichney 1987], [Lagae and Dutré 2008]. That of an image with `s x s` pixels `e` is likewise
//! `|sum e(x) exp(-2 pi i f.x / s)|^2 / (s^2 variance)`, 1 for white noise.

use std::f64::consts::TAU;

/// A spectrum over the frequencies from `-size/2` to `size/2 - 1` in x and y; row by row, frequency 0 in the middle.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Frequencies along each axis.
    pub size: usize,
    /// Power at each frequency.
    pub power: Vec<f64>,
}

impl Spectrum {
    /// The periodogram of points of the unit square.
    pub fn of_points(points: &[[f64; 2]], size: usize) -> Spectrum {
        // The waves of all frequencies along x, and those along y, of each point.
        let mut power = vec![0.0; size * size];
        let mut sums = vec![(0.0, 0.0); size * size];
        for &[x, y] in points {
            let waves = |c: f64| -> Vec<(f64, f64)> {
                (0..size).map(|i| (-TAU * frequency(i, size) * c).sin_cos()).map(|(s, c)| (c, s)).collect()
            };
            let (along_x, along_y) = (waves(x), waves(y));
            for (row, &b) in sums.chunks_mut(size).zip(&along_y) {
                row.iter_mut().zip(&along_x).for_each(|(sum, &a)| add_product(sum, a, b));
            }
        }
        let n = points.len().max(1) as f64;
        power.iter_mut().zip(sums).for_each(|(p, (re, im))| *p = (re * re + im * im) / n);
        Spectrum { size, power }
    }

    /// The periodogram of a square image, its mean taken away; all zero for an image of one colour.
    pub fn of_image(pixels: &[f64], size: usize) -> Spectrum {
        assert_eq!(pixels.len(), size * size, "not a square image");
        let n = pixels.len() as f64;
        let mean = pixels.iter().sum::<f64>() / n;
        let variance = pixels.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / n;
        let rows: Vec<(f64, f64)> = pixels.iter().map(|p| (p - mean, 0.0)).collect();
        let transformed = transform_rows(&transpose(&transform_rows(&rows, size), size), size);
        let scale = if variance > 0.0 { 1.0 / (n * variance) } else { 0.0 };
        let power =
            transpose(&transformed, size).iter().map(|(re, im)| (re * re + im * im) * scale).collect();
        Spectrum { size, power }
    }

    /// The average of several spectra of the same size.
    pub fn mean(spectra: &[Spectrum]) -> Spectrum {
        let size = spectra.first().map_or(0, |s| s.size);
        let mut power = vec![0.0; size * size];
        for spectrum in spectra {
            power.iter_mut().zip(&spectrum.power).for_each(|(sum, p)| *sum += p / spectra.len() as f64);
        }
        Spectrum { size, power }
    }

    /// Mean power at each distance from frequency 0, rounded; without frequency 0 itself, which stands as 0.
    pub fn radial(&self) -> Vec<f64> {
        let mut bins = vec![(0.0, 0u32); self.size / 2];
        for (i, p) in self.power.iter().enumerate() {
            let radius = frequency(i % self.size, self.size).hypot(frequency(i / self.size, self.size));
            if let Some((sum, count)) = bins.get_mut(radius.round() as usize)
                && radius > 0.0
            {
                *sum += p;
                *count += 1;
            }
        }
        bins.iter().map(|&(sum, count)| sum / f64::from(count.max(1))).collect()
    }
}

fn frequency(i: usize, size: usize) -> f64 {
    i as f64 - (size / 2) as f64
}

fn add_product(sum: &mut (f64, f64), a: (f64, f64), b: (f64, f64)) {
    sum.0 += a.0 * b.0 - a.1 * b.1;
    sum.1 += a.0 * b.1 + a.1 * b.0;
}

/// The Fourier transform of each row, by its definition.
fn transform_rows(values: &[(f64, f64)], size: usize) -> Vec<(f64, f64)> {
    let wave = |k: usize| (-TAU * k as f64 / size as f64).sin_cos();
    let waves: Vec<(f64, f64)> = (0..size).map(wave).map(|(s, c)| (c, s)).collect();
    let coefficient = |row: &[(f64, f64)], i: usize| {
        // Frequencies are the same modulo the size.
        let f = (i + size - size / 2) % size;
        let mut sum = (0.0, 0.0);
        row.iter().enumerate().for_each(|(x, &v)| add_product(&mut sum, v, waves[f * x % size]));
        sum
    };
    values.chunks(size).flat_map(|row| (0..size).map(move |i| coefficient(row, i))).collect()
}

fn transpose(values: &[(f64, f64)], size: usize) -> Vec<(f64, f64)> {
    (0..size * size).map(|i| values[i % size * size + i / size]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::rng::Stream;

    #[test]
    fn independent_points_and_pixels_are_white() {
        let stream = Stream::new(4, [0, 0], 0);
        let points: Vec<[f64; 2]> =
            (0..1000).map(|i| [2 * i, 2 * i + 1].map(|k| stream.uniform(k).into())).collect();
        let pixels: Vec<f64> = (0..64 * 64).map(|i| stream.uniform(5000 + i).into()).collect();
        for spectrum in [Spectrum::of_points(&points, 64), Spectrum::of_image(&pixels, 64)] {
            let radial = spectrum.radial();
            // The power at a frequency has standard deviation 1; frequencies come in pairs.
            for (radius, power) in radial.iter().enumerate().skip(8) {
                let sigma = (1.0 / (std::f64::consts::PI * radius as f64)).sqrt();
                assert!((power - 1.0).abs() < 5.0 * sigma, "{radius}: {power}");
            }
        }
    }

    #[test]
    fn a_grid_has_power_at_its_harmonics_only() {
        let points: Vec<[f64; 2]> = (0..64).map(|i| [(i % 8) as f64 / 8.0, (i / 8) as f64 / 8.0]).collect();
        let spectrum = Spectrum::of_points(&points, 32);
        for (i, &p) in spectrum.power.iter().enumerate() {
            let harmonic = (i % 32) % 8 == 0 && (i / 32) % 8 == 0;
            assert!((p - if harmonic { 64.0 } else { 0.0 }).abs() < 1e-9, "{i}: {p}");
        }
    }

    #[test]
    fn a_wave_is_one_pair_of_frequencies() {
        let size = 16;
        let wave = |i: usize| (TAU * (3 * (i % size) + 5 * (i / size)) as f64 / size as f64).cos();
        let spectrum = Spectrum::of_image(&(0..size * size).map(wave).collect::<Vec<_>>(), size);
        for (i, &p) in spectrum.power.iter().enumerate() {
            let f = (i % size, i / size);
            // All of the power, 16 x 16 pixels' worth, in two places.
            let expected = if f == (11, 13) || f == (5, 3) { 128.0 } else { 0.0 };
            assert!((p - expected).abs() < 1e-9, "{f:?}: {p}");
        }
        assert!(Spectrum::of_image(&[0.5; 64], 8).power.iter().all(|&p| p == 0.0));
    }
}
