//! How far a picture is from a reference.
//!
//! With x the test picture, r the reference, and the mean taken over all pixels and over
//! red, green and blue (grey is spread, alpha left out):
//!
//! ```text
//! MSE    = mean (x - r)²                 RMSE = √MSE
//! PSNR   = 10 log₁₀(1 / MSE)             in decibels, for values in [0, 1]
//! relMSE = mean (x - r)² / (r² + ε)      ε = 0.01 [Rousselle et al. 2011]
//! ```
//!
//! These compare numbers. [`flip`] models what a person sees when the two pictures
//! alternate on a screen, and [`hdr_flip`] does so over a range of exposures.
//!
//! Sums run in double precision in the order of the pixels: the result depends on the
//! pictures only.

mod flip;
mod hdr_flip;
#[cfg(test)]
mod test_pairs;

pub use flip::{DEFAULT_PIXELS_PER_DEGREE, flip};
pub use hdr_flip::{Exposures, hdr_flip};

use crate::{Image, ImageError};

/// Keeps the relative error of dark pixels finite.
const REL_MSE_EPSILON: f64 = 0.01;

/// Figures that compare two pictures number by number; see the module for their formulas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// Mean squared error.
    pub mse: f64,
    /// Its root, in the units of the pictures.
    pub rmse: f64,
    /// Peak signal to noise ratio in decibels for values in [0, 1]; infinite for equal pictures.
    pub psnr: f64,
    /// Mean squared error relative to the reference.
    pub rel_mse: f64,
    /// Largest absolute difference of any value.
    pub max_abs: f64,
}

/// Compares `test` with `reference`.
///
/// Equal infinities and two NaNs count as equal; any other value that is not finite on
/// one side makes the errors infinite.
///
/// # Errors
/// [`ImageError::Parameter`] when the sizes differ.
pub fn compare(reference: &Image, test: &Image) -> Result<Comparison, ImageError> {
    check_same_size(reference, test)?;
    let (mut squares, mut relative, mut max_abs) = (0.0, 0.0, 0.0f64);
    for (r, x) in values(reference).zip(values(test)) {
        let error = abs_difference(r, x);
        if error > 0.0 {
            squares += error * error;
            relative += if r.is_finite() { error * error / (r * r + REL_MSE_EPSILON) } else { error };
            max_abs = max_abs.max(error);
        }
    }
    let n = 3.0 * reference.pixels().len() as f64;
    let mse = squares / n;
    let psnr = -10.0 * mse.log10();
    Ok(Comparison { mse, rmse: mse.sqrt(), psnr, rel_mse: relative / n, max_abs })
}

/// Share of pixels, 0 to 1, with any of red, green, blue off by more than `steps`/255.
///
/// A difference of exactly `steps` does not count: a thousandth of a step is allowed for
/// the rounding of v/255.
///
/// # Errors
/// [`ImageError::Parameter`] when the sizes differ.
pub fn share_above(reference: &Image, test: &Image, steps: f64) -> Result<f64, ImageError> {
    check_same_size(reference, test)?;
    let limit = (steps + 1e-3) / 255.0;
    let off = |(r, x): &([f32; 3], [f32; 3])| {
        r.iter().zip(x).any(|(&r, &x)| abs_difference(r.into(), x.into()) > limit)
    };
    let count = reference.rgb_pixels().zip(test.rgb_pixels()).filter(off).count();
    Ok(count as f64 / reference.pixels().len() as f64)
}

/// The mean of all values of `image`, as of an error map.
pub fn mean(image: &Image) -> f64 {
    image.data().iter().map(|&v| f64::from(v)).sum::<f64>() / image.data().len() as f64
}

pub(crate) fn check_same_size(reference: &Image, test: &Image) -> Result<(), ImageError> {
    let (a, b) = ((reference.width(), reference.height()), (test.width(), test.height()));
    if a == b {
        return Ok(());
    }
    Err(ImageError::parameter(format!("a picture of {} x {} against one of {} x {}", a.0, a.1, b.0, b.1)))
}

fn values(image: &Image) -> impl Iterator<Item = f64> {
    image.rgb_pixels().flatten().map(f64::from)
}

fn abs_difference(r: f64, x: f64) -> f64 {
    if r == x || (r.is_nan() && x.is_nan()) {
        return 0.0;
    }
    let error = (x - r).abs();
    if error.is_nan() { f64::INFINITY } else { error }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Image {
        Image::from_data(values.len() as u32, 1, 1, values.to_vec()).unwrap()
    }

    #[test]
    fn closed_forms() {
        let c = compare(&grey(&[0.0, 1.0]), &grey(&[0.1, 0.7])).unwrap();
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} {b}");
        close(c.mse, (0.01 + 0.09) / 2.0);
        close(c.rmse, 0.05f64.sqrt());
        close(c.psnr, 10.0 * 20f64.log10());
        close(c.rel_mse, (0.01 / 0.01 + 0.09 / 1.01) / 2.0);
        close(c.max_abs, 0.3);
    }

    #[test]
    fn equal_pictures_have_no_error() {
        let image = grey(&[0.25, f32::NAN, f32::INFINITY]);
        let c = compare(&image, &image).unwrap();
        assert_eq!((c.mse, c.rmse, c.rel_mse, c.max_abs), (0.0, 0.0, 0.0, 0.0));
        assert_eq!(c.psnr, f64::INFINITY);
    }

    #[test]
    fn values_that_are_not_finite_are_never_overlooked() {
        for (r, x) in
            [(f32::NAN, 0.0), (0.0, f32::NAN), (f32::INFINITY, 0.0), (f32::INFINITY, f32::NEG_INFINITY)]
        {
            let c = compare(&grey(&[r, 0.5]), &grey(&[x, 0.5])).unwrap();
            assert_eq!(
                (c.mse, c.rel_mse, c.max_abs),
                (f64::INFINITY, f64::INFINITY, f64::INFINITY),
                "{r} {x}"
            );
            assert_eq!(share_above(&grey(&[r, 0.5]), &grey(&[x, 0.5]), 2.0), Ok(0.5));
        }
    }

    #[test]
    fn grey_equals_its_colour_and_alpha_is_left_out() {
        let colour = Image::from_data(1, 1, 4, vec![0.5, 0.5, 0.5, 0.0]).unwrap();
        assert_eq!(compare(&grey(&[0.5]), &colour).unwrap().max_abs, 0.0);
    }

    #[test]
    fn exactly_so_many_steps_do_not_count() {
        for value in 0..=253u8 {
            let [a, b, c] = [0, 2, 3].map(|step| grey(&[(f32::from(value) + step as f32) / 255.0]));
            assert_eq!(share_above(&a, &b, 2.0), Ok(0.0), "{value}");
            assert_eq!(share_above(&b, &a, 1.0), Ok(1.0), "{value}");
            assert_eq!(share_above(&a, &c, 2.0), Ok(1.0), "{value}");
        }
    }

    #[test]
    fn one_channel_is_enough() {
        let a = Image::filled(2, 2, &[0.5, 0.5, 0.5]).unwrap();
        let mut b = a.clone();
        b.pixel_mut(1, 1)[2] = 0.6;
        assert_eq!(share_above(&a, &b, 2.0), Ok(0.25));
    }

    #[test]
    fn sizes_must_agree() {
        let (a, b) = (grey(&[0.0; 2]), grey(&[0.0; 3]));
        assert!(compare(&a, &b).is_err() && share_above(&a, &b, 1.0).is_err());
        assert!(flip(&a, &b, 67.0).is_err());
    }
}
