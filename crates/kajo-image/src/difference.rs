//! Pictures of a difference.

use crate::colormap::magma;
use crate::metrics::check_same_size;
use crate::{Image, ImageError};

/// An error map in [0, 1], such as [`metrics::flip`](crate::metrics::flip) gives, in the
/// colours of magma, sRGB-encoded: write it as it is.
///
/// # Errors
/// [`ImageError::Parameter`] when there is no memory for the picture.
pub fn error_map(errors: &Image) -> Result<Image, ImageError> {
    Image::from_fn(errors.width(), errors.height(), |x, y| magma(errors.pixel(x, y)[0]))
}

/// `gain · |test - reference|` per channel: black where the pictures agree.
///
/// # Errors
/// [`ImageError::Parameter`] when the sizes differ.
pub fn absolute(reference: &Image, test: &Image, gain: f32) -> Result<Image, ImageError> {
    per_value(reference, test, |r, x| gain * (x - r).abs())
}

/// `½ + ½ gain · (test - reference)` per channel: middle grey where the pictures agree,
/// brighter where `test` is.
///
/// # Errors
/// [`ImageError::Parameter`] when the sizes differ.
pub fn signed(reference: &Image, test: &Image, gain: f32) -> Result<Image, ImageError> {
    per_value(reference, test, |r, x| 0.5 + 0.5 * gain * (x - r))
}

/// Red, green and blue of the result, value by value.
fn per_value(reference: &Image, test: &Image, f: impl Fn(f32, f32) -> f32) -> Result<Image, ImageError> {
    check_same_size(reference, test)?;
    Image::from_fn(reference.width(), reference.height(), |x, y| {
        let (r, t) = (reference.rgb(x, y), test.rgb(x, y));
        std::array::from_fn::<f32, 3, _>(|c| if r[c] == t[c] { f(0.0, 0.0) } else { f(r[c], t[c]) })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agreement_is_black_or_middle_grey() {
        let a = Image::filled(2, 1, &[0.25, f32::INFINITY, 1.0]).unwrap();
        assert!(absolute(&a, &a, 8.0).unwrap().data().iter().all(|&v| v == 0.0));
        assert!(signed(&a, &a, 8.0).unwrap().data().iter().all(|&v| v == 0.5));
    }

    #[test]
    fn differences_are_amplified_with_their_sign() {
        let a = Image::filled(1, 1, &[0.5]).unwrap();
        let b = Image::filled(1, 1, &[0.25, 0.5, 0.75, 0.0]).unwrap();
        assert_eq!(absolute(&a, &b, 2.0).unwrap().data(), [0.5, 0.0, 0.5]);
        assert_eq!(signed(&a, &b, 2.0).unwrap().data(), [0.25, 0.5, 0.75]);
        assert!(signed(&a, &Image::new(1, 2, 1).unwrap(), 1.0).is_err());
    }

    #[test]
    fn error_maps_take_the_colours_of_magma() {
        let map = error_map(&Image::from_data(3, 1, 1, vec![0.0, 0.5, 1.0]).unwrap()).unwrap();
        assert_eq!(map.pixel(1, 0), magma(0.5));
        assert_eq!(map.pixel(2, 0), magma(1.0));
    }
}
