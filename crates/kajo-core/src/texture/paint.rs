//! Parameters of materials that may vary over a surface: the same everywhere, or taken from a picture.

use kajo_color::{Reflectance, RgbBasis, Spectrum, Wavelengths};
use kajo_math::Vec3;

use super::{PictureMap, SurfaceUv};

/// A colour of a surface.
#[derive(Clone, Debug)]
pub enum Paint {
    /// The same everywhere.
    Plain(Reflectance),
    /// The colours of a picture, which become spectra by [`RgbBasis`].
    Picture(PictureMap),
}

impl From<Reflectance> for Paint {
    fn from(color: Reflectance) -> Paint {
        Paint::Plain(color)
    }
}

impl Paint {
    /// The reflectance at surface coordinates.
    #[inline]
    pub fn at(&self, uv: SurfaceUv, wavelengths: &Wavelengths) -> Spectrum {
        match self {
            Paint::Plain(color) => color.at(wavelengths),
            Paint::Picture(map) => picture_reflectance(map, uv, wavelengths),
        }
    }

    /// Linear RGB at surface coordinates.
    pub fn rgb(&self, uv: SurfaceUv) -> Spectrum {
        match self {
            Paint::Plain(color) => Spectrum::from(Vec3::from(color.rgb())),
            Paint::Picture(map) => picture_reflectance(map, uv, &Wavelengths::RGB),
        }
    }

    /// Whether it differs between places.
    pub fn varies(&self) -> bool {
        matches!(self, Paint::Picture(_))
    }

    /// Whether all its numbers are finite; reflectances are.
    pub fn is_finite(&self) -> bool {
        match self {
            Paint::Plain(_) => true,
            Paint::Picture(map) => map.is_finite(),
        }
    }
}

/// The colour of a picture as a reflectance.
pub(crate) fn picture_reflectance(map: &PictureMap, uv: SurfaceUv, wavelengths: &Wavelengths) -> Spectrum {
    let [r, g, b, _] = map.at(uv);
    rgb_reflectance([r, g, b], wavelengths)
}

/// Linear RGB in [0, 1] as a reflectance.
pub(crate) fn rgb_reflectance([r, g, b]: [f32; 3], wavelengths: &Wavelengths) -> Spectrum {
    if wavelengths.is_spectral() {
        return RgbBasis::new(wavelengths).reflectance([r, g, b]);
    }
    Spectrum::rgb(r, g, b)
}

/// What of a picture is a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Channel {
    /// Red, which in a grey picture is everything.
    #[default]
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// How much the picture covers.
    Alpha,
}

/// A number in [0, 1].
#[derive(Clone, Debug)]
pub enum Share {
    /// The same everywhere.
    Plain(f32),
    /// A channel of a picture.
    Picture(PictureMap, Channel),
    /// 1 where a channel of a picture is this much or more, and 0 elsewhere.
    Cut(PictureMap, Channel, f32),
}

impl From<f32> for Share {
    fn from(value: f32) -> Share {
        Share::Plain(value)
    }
}

impl Share {
    /// The number at surface coordinates.
    #[inline]
    pub fn at(&self, uv: SurfaceUv) -> f32 {
        self.covered_at(uv, 1.0)
    }

    /// The number at surface coordinates where it, or what is cut, has another factor.
    ///
    /// * `cover`: that factor, in [0, 1]
    #[inline]
    pub fn covered_at(&self, uv: SurfaceUv, cover: f32) -> f32 {
        match self {
            Share::Plain(value) => *value * cover,
            Share::Picture(map, channel) => map.at(uv)[*channel as usize] * cover,
            Share::Cut(map, channel, least) => {
                f32::from(u8::from(map.at(uv)[*channel as usize] * cover >= *least))
            }
        }
    }

    /// Whether it differs between places.
    pub fn varies(&self) -> bool {
        !matches!(self, Share::Plain(_))
    }

    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        match self {
            Share::Plain(value) => value.is_finite(),
            Share::Picture(map, _) => map.is_finite(),
            Share::Cut(map, _, least) => map.is_finite() && least.is_finite(),
        }
    }

    /// Its mean over all texels, about that for a picture that is cut.
    pub fn mean(&self) -> f32 {
        match self {
            Share::Plain(value) => *value,
            Share::Picture(map, channel) | Share::Cut(map, channel, _) => map.mean()[*channel as usize],
        }
    }

    /// The least and the largest number that it may be anywhere.
    pub fn range(&self) -> [f32; 2] {
        match self {
            Share::Plain(value) => [*value; 2],
            Share::Picture(..) | Share::Cut(..) => [0.0, 1.0],
        }
    }
}
