//! How far a picture is from the one it should be.

use kajo_image::Image;

/// Share of pixels, in [0, 1], of which any channel is off by more than `steps`/255.
///
/// A value that is no finite number is off unless the other picture has the same. Pictures of different sizes
/// are off everywhere.
pub fn share_off_by(found: &Image, expected: &Image, steps: f32) -> f64 {
    let shape = |image: &Image| (image.width(), image.height(), image.channels());
    if shape(found) != shape(expected) {
        return 1.0;
    }
    // Half of a thousandth of a step is left to rounding.
    let limit = (steps + 5e-4) / 255.0;
    let is_off =
        |(a, b): (&f32, &f32)| a.to_bits() != b.to_bits() && ((a - b).abs() > limit || (a - b).is_nan());
    let pixels = found.pixels().zip(expected.pixels());
    let off = pixels.filter(|(a, b)| a.iter().zip(*b).any(is_off)).count();
    off as f64 / (f64::from(found.width()) * f64::from(found.height()))
}

/// Asserts that at most `share` of the pixels are off by more than `steps`/255, and says how many are.
///
/// # Panics
/// When more are.
#[track_caller]
pub fn assert_close(found: &Image, expected: &Image, steps: f32, share: f64) {
    let off = share_off_by(found, expected, steps);
    assert!(
        off <= share,
        "{:.3} % of the pixels are off by more than {steps}/255; at most {:.3} % may be",
        100.0 * off,
        100.0 * share
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Image {
        Image::from_data(values.len() as u32, 1, 1, values.to_vec()).expect("one row")
    }

    #[test]
    fn shares_are_counted_by_pixel() {
        let black = grey(&[0.0; 4]);
        let image = grey(&[0.0, 1.0 / 255.0, -2.0 / 255.0, 0.5]);
        for (steps, share) in [(0.0, 0.75), (1.0, 0.5), (2.0, 0.25), (200.0, 0.0)] {
            assert_eq!(share_off_by(&image, &black, steps), share, "{steps}");
        }
        let rgb = |r, g, b| Image::from_data(1, 1, 3, vec![r, g, b]).expect("one pixel");
        assert_eq!(share_off_by(&rgb(0.0, 0.0, 0.1), &rgb(0.0, 0.0, 0.0), 2.0), 1.0);
        assert_eq!(share_off_by(&black, &grey(&[0.0; 3]), 255.0), 1.0);
    }

    #[test]
    fn what_is_not_finite_is_off() {
        let one = grey(&[1.0]);
        for bad in [f32::NAN, f32::INFINITY] {
            assert_eq!(share_off_by(&grey(&[bad]), &one, 255.0), 1.0);
            assert_eq!(share_off_by(&grey(&[bad]), &grey(&[bad]), 0.0), 0.0);
        }
    }

    #[test]
    #[should_panic(expected = "100.000 % of the pixels are off by more than 2/255")]
    fn the_assertion_says_how_many() {
        assert_close(&grey(&[1.0]), &grey(&[0.0]), 2.0, 0.005);
    }
}
