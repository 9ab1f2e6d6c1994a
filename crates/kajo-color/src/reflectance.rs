//! Colours of surfaces, factors that differ between wavelengths, and how they look to a path.
//!
//! Colour data is read here and in [`emission`](crate::emission): the places that ask which mode a path is in.

use std::sync::Arc;

use crate::tabulated::{Outside, Tabulated};
use crate::uplift::Uplift;
use crate::{Spectrum, Wavelengths, illuminant, observer, sensor};

/// The share of light that a surface gives back, in [0, 1] at every wavelength.
///
/// A colour becomes the smooth spectrum that has this colour under D65.
/// [Jakob and Hanika 2019]
#[derive(Clone, Debug, PartialEq)]
pub struct Reflectance {
    rgb: [f32; 3],
    shape: ReflectanceSpectrum,
    was_clamped: bool,
}

#[derive(Clone, Debug, PartialEq)]
enum ReflectanceSpectrum {
    Colour(Uplift),
    Table(Arc<Tabulated>),
}

impl ReflectanceSpectrum {
    #[inline]
    fn at(&self, nm: [f32; 4]) -> Spectrum {
        match self {
            ReflectanceSpectrum::Colour(uplift) => uplift.at(nm),
            ReflectanceSpectrum::Table(table) => nm.map(|nm| table.at(nm)).into(),
        }
    }
}

impl Reflectance {
    /// The reflectance of a linear sRGB colour. Components outside [0, 1] are held to it, and not a number
    /// is 0; [`was_clamped`](Reflectance::was_clamped) tells.
    pub fn from_rgb(rgb: [f32; 3]) -> Reflectance {
        let (rgb, was_clamped) = clamped(rgb);
        Reflectance { rgb, shape: ReflectanceSpectrum::Colour(Uplift::of(rgb)), was_clamped }
    }

    /// The same at every wavelength, held to [0, 1].
    pub fn constant(v: f32) -> Reflectance {
        Reflectance::from_rgb([v; 3])
    }

    /// A measured reflectance, held to [0, 1].
    pub fn from_spectrum(table: &Tabulated) -> Reflectance {
        let bounded = table.map(|v| v.clamp(0.0, 1.0));
        let (rgb, colour_clamped) = clamped(rgb_under_d65(&bounded));
        let was_clamped = colour_clamped || bounded != *table;
        Reflectance { rgb, shape: ReflectanceSpectrum::Table(Arc::new(bounded)), was_clamped }
    }

    /// The reflectance in the lanes of a path.
    #[inline]
    pub fn at(&self, lambda: &Wavelengths) -> Spectrum {
        match lambda.nm() {
            None => Spectrum::rgb(self.rgb[0], self.rgb[1], self.rgb[2]),
            Some(nm) => self.shape.at(nm),
        }
    }

    /// The colour under D65, linear sRGB in [0, 1].
    #[inline]
    pub fn rgb(&self) -> [f32; 3] {
        self.rgb
    }

    /// Whether what was asked for lay outside the range or, for a measured spectrum, outside what sRGB
    /// can show.
    pub fn was_clamped(&self) -> bool {
        self.was_clamped
    }
}

/// A factor or a rate without an upper bound, such as absorption per metre or an index.
#[derive(Clone, Debug, PartialEq)]
pub struct Unbounded {
    rgb: [f32; 3],
    scale: f32,
    shape: ReflectanceSpectrum,
}

/// The first wavelength of [`Unbounded::from_each`]'s table in nm.
const TABLE_START: f64 = 360.0;
/// The distance of its wavelengths in nm.
const TABLE_STEP: f64 = 5.0;
/// How many it has.
const TABLE_LEN: usize = 95;

impl Unbounded {
    /// The quantity whose three values are `rgb`. Components below zero, or not numbers, are zero.
    ///
    /// It is a scale times the reflectance of a colour with a largest component of one half, which is
    /// where the spectra of colours are smoothest.
    pub fn from_rgb(rgb: [f32; 3]) -> Unbounded {
        let rgb = rgb.map(non_negative);
        let (scale, shape) = scaled_colour(rgb);
        Unbounded { rgb, scale, shape: ReflectanceSpectrum::Colour(shape) }
    }

    /// The same at every wavelength.
    pub fn constant(v: f32) -> Unbounded {
        Unbounded::from_rgb([v; 3])
    }

    /// A tabulated quantity; negative values become zero. Its three values are what the sensor sees of
    /// D65 multiplied by it.
    pub fn from_spectrum(table: &Tabulated) -> Unbounded {
        let bounded = table.map(non_negative);
        let rgb = rgb_under_d65(&bounded).map(non_negative);
        Unbounded { rgb, scale: 1.0, shape: ReflectanceSpectrum::Table(Arc::new(bounded)) }
    }

    /// What `f` makes of a reflectance and a quantity: of their three values, and by wavelength in a table with a step of 5 nm.
    /// What is negative, or no finite number, becomes zero.
    pub fn from_each(
        reflectance: &Reflectance,
        quantity: &Unbounded,
        f: impl Fn(f32, f32) -> f32,
    ) -> Unbounded {
        let f = |r: f32, q: f32| Some(f(r, q)).filter(|v| v.is_finite()).map_or(0.0, non_negative);
        let rgb = [0, 1, 2].map(|i| f(reflectance.rgb[i], quantity.rgb[i]));
        let values: Vec<f64> = (0..TABLE_LEN)
            .map(|i| {
                let nm = [(TABLE_START + TABLE_STEP * i as f64) as f32; 4];
                f64::from(f(reflectance.shape.at(nm)[0], quantity.shape.at(nm)[0] * quantity.scale))
            })
            .collect();
        let table = Tabulated::regular(TABLE_START, TABLE_STEP, &values, Outside::Clamp);
        Unbounded { rgb, scale: 1.0, shape: ReflectanceSpectrum::Table(Arc::new(table)) }
    }

    /// The quantity in the lanes of a path.
    #[inline]
    pub fn at(&self, lambda: &Wavelengths) -> Spectrum {
        match lambda.nm() {
            None => Spectrum::rgb(self.rgb[0], self.rgb[1], self.rgb[2]),
            Some(nm) => self.shape.at(nm) * self.scale,
        }
    }

    /// The three values of RGB mode.
    #[inline]
    pub fn rgb(&self) -> [f32; 3] {
        self.rgb
    }
}

/// A non-negative colour as a scale times a spectrum in [0, 1].
pub(crate) fn scaled_colour(rgb: [f32; 3]) -> (f32, Uplift) {
    let largest = rgb[0].max(rgb[1]).max(rgb[2]);
    let scale = 2.0 * largest;
    if scale > 0.0 && scale.is_finite() {
        (scale, Uplift::of(rgb.map(|v| v / scale)))
    } else {
        (largest, Uplift::Constant(1.0))
    }
}

/// Linear sRGB of D65 light of luminance 1 on a reflectance.
fn rgb_under_d65(table: &Tabulated) -> [f32; 3] {
    let xyz = observer::xyz(table.nm(), |nm| f64::from(table.at(nm)) * f64::from(illuminant::d65(nm)));
    crate::matrix::apply(&sensor::RGB_FROM_XYZ, xyz).map(|x| x as f32)
}

/// `v` without negative numbers and what is none.
pub(crate) fn non_negative(v: f32) -> f32 {
    if v > 0.0 { v } else { 0.0 }
}

/// A colour held to [0, 1], and whether that changed it by more than rounding.
fn clamped(rgb: [f32; 3]) -> ([f32; 3], bool) {
    let held = rgb.map(|v| non_negative(v).min(1.0));
    let as_asked = (0..3).all(|i| (held[i] - rgb[i]).abs() <= 1e-5);
    (held, !as_asked)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_colour_is_itself_in_rgb_mode() {
        let r = Reflectance::from_rgb([0.1, 0.5, 0.9]);
        assert_eq!(r.at(&Wavelengths::RGB), Spectrum::rgb(0.1, 0.5, 0.9));
        assert!(!r.was_clamped());
        assert_eq!(Unbounded::from_rgb([3.0, 0.5, 0.0]).at(&Wavelengths::RGB), Spectrum::rgb(3.0, 0.5, 0.0));
    }

    #[test]
    fn what_lies_outside_is_held_and_said() {
        for rgb in [[1.1, 0.5, 0.5], [-0.1, 0.5, 0.5], [f32::NAN, 0.5, 0.5], [f32::INFINITY, 0.5, 0.5]] {
            let r = Reflectance::from_rgb(rgb);
            assert!(r.was_clamped(), "{rgb:?}");
            let s = r.at(&Wavelengths::sample(0.3));
            assert!(s.is_finite() && s == s.clamp(0.0, 1.0), "{rgb:?}: {s:?}");
        }
        assert_eq!(Reflectance::constant(2.0).rgb(), [1.0; 3]);
        for odd in [f32::NAN, f32::INFINITY, -1.0, 0.0, f32::MIN_POSITIVE] {
            let lanes = Unbounded::from_rgb([odd, 0.0, 0.0]).at(&Wavelengths::sample(0.7));
            assert!((0..4).all(|i| lanes[i] >= 0.0), "{odd}: {lanes:?}");
        }
    }

    #[test]
    fn what_is_made_of_two_is_made_at_each_wavelength() {
        let (color, rate) = (Reflectance::from_rgb([0.9, 0.4, 0.2]), Unbounded::from_rgb([1.0, 5.0, 10.0]));
        let product = Unbounded::from_each(&color, &rate, |r, q| r * q);
        let exact = |lambda: &Wavelengths| color.at(lambda) * rate.at(lambda);
        assert_eq!(product.at(&Wavelengths::RGB), exact(&Wavelengths::RGB));
        for i in 0..20 {
            let lambda = Wavelengths::sample((i as f32 + 0.5) / 20.0);
            let (a, b) = (product.at(&lambda), exact(&lambda));
            for lane in 0..4 {
                assert!((a[lane] - b[lane]).abs() < 2e-3 * b[lane], "{a:?} {b:?}");
            }
        }
        let odd = Unbounded::from_each(&color, &rate, |r, _| if r > 0.5 { f32::INFINITY } else { -1.0 });
        assert_eq!(odd.rgb(), [0.0; 3]);
    }

    #[test]
    fn a_measured_grey_is_grey() {
        let grey = Tabulated::new([(300.0, 0.4), (900.0, 0.4)], Outside::Clamp).unwrap();
        let r = Reflectance::from_spectrum(&grey);
        for v in r.rgb() {
            assert!((v - 0.4).abs() < 1e-6, "{:?}", r.rgb());
        }
        assert_eq!(r.at(&Wavelengths::sample(0.1)), Spectrum::grey(0.4));
        assert!(!r.was_clamped());
        let bright = Tabulated::new([(300.0, 0.5), (900.0, 1.5)], Outside::Clamp).unwrap();
        assert!(Reflectance::from_spectrum(&bright).was_clamped());
    }

    #[test]
    fn the_lanes_are_the_spectrum_at_each_wavelength() {
        let table = Tabulated::new([(300.0, 0.0), (900.0, 1.0)], Outside::Clamp).unwrap();
        let lambda = Wavelengths::sample(0.37);
        let lanes = Reflectance::from_spectrum(&table).at(&lambda);
        let twice = Unbounded::from_spectrum(&table.map(|v| 2.0 * v)).at(&lambda);
        for (i, nm) in lambda.nm().unwrap().into_iter().enumerate() {
            assert!((lanes[i] - (nm - 300.0) / 600.0).abs() < 1e-6);
            assert!((twice[i] - 2.0 * lanes[i]).abs() < 1e-6);
        }
    }
}
