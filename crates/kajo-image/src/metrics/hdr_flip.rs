//! ꟻLIP for linear pictures without an upper bound [Andersson et al. 2021].
//!
//! Nobody sees such a picture at once, so both are shown at n exposures c, tone mapped
//! and encoded for a screen, and each pixel keeps its largest [`flip`] error:
//!
//! ```text
//! E = max over i of ꟻLIP(T(2^c_i r), T(2^c_i x))      c_i from start to stop
//! start = log₂(x₀ / Y_max)   stop = log₂(x₀ / Y_median)   n = max(2, ⌈stop - start⌉)
//! ```
//!
//! Y is the reference's luminance and T(x₀) = 0.85: the first exposure shows the
//! brightest pixel well, the last one the median. T is Narkowicz's fit of the ACES curve.

use kajo_color::srgb;
use kajo_math::fmath;

use super::{check_same_size, flip};
use crate::quantise::clamp_or_zero;
use crate::{Image, ImageError};

/// T(x) = (K0 x² + K1 x) / (K2 x² + K3 x + K4), with the fit's own exposure of 0.6 taken out.
const K0: f32 = 0.6 * 0.6 * 2.51;
const K1: f32 = 0.6 * 0.03;
const K2: f32 = 0.6 * 0.6 * 2.43;
const K3: f32 = 0.6 * 0.59;
const K4: f32 = 0.14;
/// What the brightest and the median luminance are mapped to.
const TARGET: f32 = 0.85;
/// Darker medians count as this, or black pictures would need endless exposures.
const MIN_MEDIAN: f32 = f32::EPSILON;
/// Brighter values count as this, far beyond where T reaches 1 at any exposure used.
const MAX_VALUE: f32 = 1e30;
/// Exposed values are bounded before they are squared.
const MAX_EXPOSED: f32 = 1e9;

/// Evenly spaced exposures in stops, from `start` to `stop`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exposures {
    /// First exposure, for the brightest parts.
    pub start: f32,
    /// Last exposure.
    pub stop: f32,
    /// How many, at least one.
    pub count: u32,
}

impl Exposures {
    /// The exposures the method prescribes for `reference`; a black picture is shown as it is.
    pub fn of(reference: &Image) -> Self {
        let mut luminances: Vec<f32> = reference
            .rgb_pixels()
            .map(|rgb| {
                let [r, g, b] = rgb.map(sane);
                0.2126 * r + 0.7152 * g + 0.0722 * b
            })
            .collect();
        let middle = luminances.len() / 2;
        let median = *luminances.select_nth_unstable_by(middle, f32::total_cmp).1;
        let max = luminances.iter().copied().fold(0.0, f32::max);
        if max == 0.0 {
            return Self { start: 0.0, stop: 0.0, count: 1 };
        }
        let log2 = |x: f32| fmath::ln(x) / std::f32::consts::LN_2;
        let start = log2(exposed_to_target() / max);
        let stop = log2(exposed_to_target() / median.max(MIN_MEDIAN)).max(start);
        Self { start, stop, count: ((stop - start).ceil() as u32).max(2) }
    }

    fn iter(self) -> impl Iterator<Item = f32> {
        let step = (self.stop - self.start) / (self.count.max(2) - 1) as f32;
        (0..self.count).map(move |i| self.start + i as f32 * step)
    }
}

/// The error map: `height × width × 1`, values in [0, 1].
///
/// * `reference`, `test`: linear values with sRGB's primaries; negative and NaN are black
/// * `exposures`: from [`Exposures::of`] the reference, or the caller's own
/// * `pixels_per_degree`: as for [`flip`]
///
/// # Errors
/// [`ImageError::Parameter`] when sizes differ, `pixels_per_degree` is out of range, or
/// the exposures are not finite or none.
pub fn hdr_flip(
    reference: &Image,
    test: &Image,
    exposures: Exposures,
    pixels_per_degree: f32,
) -> Result<Image, ImageError> {
    check_same_size(reference, test)?;
    if exposures.count == 0 || !exposures.start.is_finite() || !exposures.stop.is_finite() {
        return Err(ImageError::parameter(format!("{exposures:?} show nothing")));
    }
    let mut largest = Image::new(reference.width(), reference.height(), 1)?;
    for exposure in exposures.iter() {
        let map = flip(&on_screen(reference, exposure)?, &on_screen(test, exposure)?, pixels_per_degree)?;
        for (largest, error) in largest.data_mut().iter_mut().zip(map.data()) {
            *largest = largest.max(*error);
        }
    }
    Ok(largest)
}

/// Exposed by `exposure` stops, tone mapped and sRGB-encoded.
fn on_screen(image: &Image, exposure: f32) -> Result<Image, ImageError> {
    let scale = fmath::pow(2.0, exposure);
    let show = |v: f32| srgb::encode(tone_map((scale * sane(v)).min(MAX_EXPOSED)));
    let data = image.rgb_pixels().flat_map(|rgb| rgb.map(show)).collect();
    Image::from_data(image.width(), image.height(), 3, data)
}

fn tone_map(x: f32) -> f32 {
    ((K0 * x * x + K1 * x) / (K2 * x * x + K3 * x + K4)).clamp(0.0, 1.0)
}

/// x₀ with T(x₀) = TARGET: the positive root of a quadratic.
fn exposed_to_target() -> f32 {
    let [a, b, c] = [K0 - TARGET * K2, K1 - TARGET * K3, -TARGET * K4];
    let half = -0.5 * b / a;
    half + (half * half - c / a).sqrt()
}

fn sane(v: f32) -> f32 {
    clamp_or_zero(v, MAX_VALUE)
}

#[cfg(test)]
mod tests {
    use super::super::test_pairs::{PAIRS, Pair};
    use super::super::{DEFAULT_PIXELS_PER_DEGREE, mean};
    use super::*;

    /// The pictures of a pair made linear and eight times as bright as a screen.
    fn bright(image: &Image) -> Image {
        let data = image.data().iter().map(|v| v * v * 8.0).collect();
        Image::from_data(image.width(), image.height(), 3, data).unwrap()
    }

    #[test]
    fn agrees_with_the_authors_evaluator() {
        for Pair { name, hdr_flip: expected, hdr_start, hdr_stop, .. } in PAIRS {
            let (reference, test) = Pair::images(name);
            let (reference, test) = (bright(&reference), bright(&test));
            let exposures = Exposures::of(&reference);
            assert!((exposures.start - hdr_start).abs() < 1e-5, "{name} {exposures:?}");
            assert!((exposures.stop - hdr_stop).abs() < 1e-5, "{name} {exposures:?}");
            assert_eq!(exposures.count, 2, "{name}");
            let map = hdr_flip(&reference, &test, exposures, DEFAULT_PIXELS_PER_DEGREE).unwrap();
            assert!((mean(&map) - expected).abs() < 1e-4, "{name} {} {expected}", mean(&map));
        }
    }

    #[test]
    fn a_wide_range_takes_an_exposure_per_stop() {
        // The evaluator's own answer for one bright pixel among black ones.
        let mut image = Image::new(5, 5, 3).unwrap();
        image.pixel_mut(0, 0).fill(1.0);
        let exposures = Exposures::of(&image);
        assert!((exposures.start - 1.083_297).abs() < 1e-5 && (exposures.stop - 24.083_298).abs() < 1e-5);
        assert_eq!(exposures.count, 23);
        assert_eq!(exposures.iter().count(), 23);
        assert!((exposures.iter().last().unwrap() - exposures.stop).abs() < 1e-4);
    }

    #[test]
    fn any_floats_give_errors_between_zero_and_one() {
        let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1.0, 0.0, 1e-30];
        let image = |k| Image::from_fn(7, 6, |x, y| [wild[((x * 3 + y * 5 + k) % 7) as usize]; 3]).unwrap();
        let black = Image::new(7, 6, 3).unwrap();
        for (reference, test) in [(image(0), image(1)), (black.clone(), image(2)), (image(3), black)] {
            let exposures = Exposures::of(&reference);
            assert!(exposures.count <= 130, "{exposures:?}");
            let map = hdr_flip(&reference, &test, exposures, 67.0).unwrap();
            assert!(map.data().iter().all(|e| (0.0..=1.0).contains(e)));
        }
    }

    #[test]
    fn exposures_that_show_nothing_are_refused() {
        let image = Image::new(1, 1, 1).unwrap();
        for (start, stop, count) in [(0.0, 1.0, 0), (f32::NAN, 1.0, 2), (0.0, f32::INFINITY, 2)] {
            assert!(hdr_flip(&image, &image, Exposures { start, stop, count }, 67.0).is_err());
        }
    }
}
