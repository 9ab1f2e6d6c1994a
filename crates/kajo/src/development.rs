//! From light to values for an eye or a file: exposure, white balance, gamut, tone curve.
//!
//! ```text
//! linear   = balance · 2^stops · light
//! display  = tone(linear)                 PNG, TGA, BMP, PPM
//! file     = gamut · linear               EXR, PFM, HDR
//! ```
//!
//! Only colours are developed; distances, normals and the like are what they are.

use kajo_color::gamut::{Gamut, SRGB};
use kajo_color::matrix::{Matrix3, apply_f32};
use kajo_color::{Tone, tone, white};
use kajo_image::{Format, Image};

/// How light becomes values. The default leaves it as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Development {
    /// Factors of two by which the picture is made brighter.
    pub exposure: f32,
    /// Temperature in kelvin and tint of the light that is to look white; daylight of 6500 K, where absent.
    pub white: Option<[f64; 2]>,
    /// The curve of pictures for a display.
    pub tone: Tone,
    /// The primaries of files that hold light.
    pub gamut: Gamut,
}

impl Default for Development {
    fn default() -> Development {
        Development { exposure: 0.0, white: None, tone: Tone::Linear, gamut: SRGB }
    }
}

impl Development {
    /// The values that a file of this format holds of light in linear sRGB.
    pub fn apply(&self, light: &mut Image, format: Format) {
        if *self == Development::default() {
            return;
        }
        let exposure = tone::exposure(self.exposure);
        let balance = self.white.map(|[kelvin, tint]| white::balance(kelvin, tint));
        let gamut = (self.gamut != SRGB).then(|| self.gamut.from(&SRGB));
        let times = |matrix: &Option<Matrix3>, rgb| matrix.as_ref().map_or(rgb, |m| apply_f32(m, rgb));
        for pixel in light.data_mut().chunks_exact_mut(3) {
            let exposed = [pixel[0], pixel[1], pixel[2]].map(|v| held(v * exposure));
            let linear = times(&balance, exposed).map(held);
            let value =
                if format.is_float() { times(&gamut, linear).map(held) } else { self.tone.display(linear) };
            pixel.copy_from_slice(&value);
        }
    }

    /// How many values the exposure makes larger than any number; they become the largest one.
    pub fn overflows(&self, light: &Image) -> usize {
        let exposure = tone::exposure(self.exposure);
        light.data().iter().filter(|v| v.is_finite() && (*v * exposure).is_infinite()).count()
    }

    /// Chromaticities of red, green, blue and white that an OpenEXR file names, where they are not the usual ones.
    pub(crate) fn chromaticities(&self) -> Option<[[f32; 2]; 4]> {
        let [red, green, blue] = self.gamut.primaries;
        let all = [red, green, blue, self.gamut.white];
        (self.gamut != SRGB).then(|| all.map(|xy| xy.map(|v| v as f32)))
    }
}

/// The value, and the largest number of its sign for an infinite one: differences of infinite values are no numbers, and
/// would be black.
fn held(v: f32) -> f32 {
    if v.is_infinite() { f32::MAX.copysign(v) } else { v }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_color::gamut::ACESCG;
    use kajo_color::srgb;

    fn developed(development: Development, format: Format, rgb: [f32; 3]) -> [f32; 3] {
        let mut image = Image::filled(1, 1, &rgb).unwrap();
        development.apply(&mut image, format);
        image.rgb(0, 0)
    }

    #[test]
    fn each_step_does_its_own() {
        let rgb = [0.1, 0.2, 0.4];
        let plain = Development::default();
        assert_eq!(developed(plain, Format::Png, rgb), rgb);
        let brighter = Development { exposure: 1.0, ..plain };
        assert_eq!(developed(brighter, Format::Png, rgb), [0.2, 0.4, 0.8]);
        let encoded = Development { tone: Tone::Srgb, ..brighter };
        for (found, v) in developed(encoded, Format::Png, rgb).into_iter().zip([0.2, 0.4, 0.8]) {
            assert!((found - srgb::encode(v)).abs() < 1e-6, "{found}");
        }
        assert_eq!(developed(encoded, Format::Exr, rgb), [0.2, 0.4, 0.8], "files of light stay linear");
    }

    #[test]
    fn light_beyond_all_numbers_is_the_largest_one() {
        let bright = [1e30, 1e30, 1.0];
        let much = Development { exposure: 100.0, ..Development::default() };
        assert_eq!(much.overflows(&Image::filled(2, 1, &bright).unwrap()), 4);
        assert_eq!(much.overflows(&Image::filled(2, 1, &[1.0, -1.0, f32::INFINITY]).unwrap()), 0);
        assert_eq!(developed(much, Format::Exr, bright)[..2], [f32::MAX; 2]);
        let warm = Development { white: Some([3000.0, 0.0]), gamut: ACESCG, ..much };
        assert!(developed(warm, Format::Exr, bright).iter().all(|v| v.is_finite()));
        for tone in Tone::ALL {
            let shown = developed(Development { tone, ..warm }, Format::Png, bright);
            assert!(shown[0] >= 0.9, "{tone:?}: {shown:?}");
        }
    }

    #[test]
    fn a_warm_light_becomes_white_and_white_stays_white() {
        let warm = Development { white: Some([3000.0, 0.0]), ..Development::default() };
        let [r, _, b] = developed(warm, Format::Exr, [1.0; 3]);
        assert!(r < 1.0 && b > 1.0, "{r} {b}");
        let wide = Development { gamut: ACESCG, ..Development::default() };
        for v in developed(wide, Format::Exr, [0.5; 3]) {
            assert!((v - 0.5).abs() < 1e-5, "{v}");
        }
        assert_eq!(developed(wide, Format::Png, [0.1, 0.5, 0.2]), [0.1, 0.5, 0.2], "a display is sRGB");
        assert_eq!(wide.chromaticities().unwrap()[0], [0.713, 0.293]);
        assert_eq!(Development::default().chromaticities(), None);
    }
}
