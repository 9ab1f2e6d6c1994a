//! Light as light sources and skies emit it.
//!
//! A colour `rgb` shines with the spectrum of D65 through a filter of that colour, so that a light of
//! colour 1 1 1 on surfaces given as RGB makes the same picture in both modes. A black body shines by
//! Planck's law
//!
//! ```text
//! B(λ, T) = 2 h c² / λ⁵ / (exp(h c / (λ k T)) − 1)
//! ```
//!
//! [Pharr, Jakob and Humphreys 2023, 4.6.6], [Planck 1901]; constants of the SI [BIPM 2019].

use std::sync::Arc;

use crate::planck::black_body_shape;
pub use crate::planck::planck;
use crate::reflectance::{non_negative, scaled_colour};
use crate::tabulated::Tabulated;
use crate::uplift::Uplift;
use crate::{Spectrum, Wavelengths, observer, sensor};

/// Radiance, or what becomes radiance by a factor: non-negative at every wavelength.
#[derive(Clone, Debug, PartialEq)]
pub struct Emission {
    rgb: [f32; 3],
    luminance: f32,
    scale: f32,
    shape: EmissionSpectrum,
}

#[derive(Clone, Debug, PartialEq)]
enum EmissionSpectrum {
    /// D65 of luminance 1 through a filter.
    Filtered(Uplift),
    Table(Arc<Tabulated>),
    /// The temperature in kelvin; 1 at 560 nm.
    BlackBody(f32),
}

impl Emission {
    /// No light.
    pub const BLACK: Emission = Emission {
        rgb: [0.0; 3],
        luminance: 0.0,
        scale: 0.0,
        shape: EmissionSpectrum::Filtered(Uplift::Constant(0.0)),
    };

    /// The light of a linear sRGB colour. Components below zero, or not numbers, are zero.
    pub fn from_rgb(rgb: [f32; 3]) -> Emission {
        let rgb = rgb.map(non_negative);
        let (scale, filter) = scaled_colour(rgb);
        Emission {
            rgb,
            luminance: Spectrum::rgb(rgb[0], rgb[1], rgb[2]).luminance(),
            scale,
            shape: EmissionSpectrum::Filtered(filter),
        }
    }

    /// `scale` times a table, negative values of which are zero.
    ///
    /// Radiance 1 at every wavelength has luminance 1. What lies outside sRGB, as the light of sodium
    /// does, keeps its spectrum; only [`rgb`](Emission::rgb) is held to non-negative values.
    pub fn from_spectrum(table: Tabulated, scale: f32) -> Emission {
        let table = table.map(non_negative);
        Emission::with_xyz(observer::xyz_of(&table), EmissionSpectrum::Table(Arc::new(table))).scaled(scale)
    }

    /// A black body of luminance 1; the temperature is held to [300, 1e6] K.
    pub fn blackbody(kelvin: f32) -> Emission {
        let kelvin = if kelvin > 300.0 { kelvin.min(1e6) } else { 300.0 };
        let xyz = observer::xyz(&[], |nm| f64::from(black_body_shape(nm, kelvin)));
        let unit = Emission::with_xyz(xyz, EmissionSpectrum::BlackBody(kelvin));
        let brightness = 1.0 / unit.luminance;
        Emission { luminance: 1.0, ..unit.scaled(brightness) }
    }

    /// A spectrum of scale 1 that is seen as `xyz`.
    fn with_xyz(xyz: [f64; 3], shape: EmissionSpectrum) -> Emission {
        let rgb = crate::matrix::apply(&sensor::RGB_FROM_XYZ, xyz).map(|x| non_negative(x as f32));
        Emission { rgb, luminance: xyz[1] as f32, scale: 1.0, shape }
    }

    /// The same light, `factor` times as bright; a negative factor is zero.
    pub fn scaled(self, factor: f32) -> Emission {
        let factor = non_negative(factor);
        Emission {
            rgb: self.rgb.map(|v| v * factor),
            luminance: self.luminance * factor,
            scale: self.scale * factor,
            ..self
        }
    }

    /// The same light with luminance 1; black stays black.
    pub fn normalized(self) -> Emission {
        let luminance = self.luminance;
        if luminance > 0.0 { self.scaled(1.0 / luminance) } else { self }
    }

    /// The radiance in the lanes of a path.
    #[inline]
    pub fn at(&self, lambda: &Wavelengths) -> Spectrum {
        let Some(nm) = lambda.nm() else { return Spectrum::rgb(self.rgb[0], self.rgb[1], self.rgb[2]) };
        let shape: Spectrum = match &self.shape {
            EmissionSpectrum::Filtered(filter) => filter.at(nm) * lambda.daylight(),
            EmissionSpectrum::Table(table) => nm.map(|nm| table.at(nm)).into(),
            EmissionSpectrum::BlackBody(kelvin) => nm.map(|nm| black_body_shape(nm, *kelvin)).into(),
        };
        shape * self.scale
    }

    /// Linear sRGB, without negative components.
    #[inline]
    pub fn rgb(&self) -> [f32; 3] {
        self.rgb
    }

    /// Luminance, 1 for a light of colour 1 1 1.
    #[inline]
    pub fn luminance(&self) -> f32 {
        self.luminance
    }

    /// The spectrum but for its scale, if it is a table.
    pub(crate) fn table(&self) -> Option<&Arc<Tabulated>> {
        match &self.shape {
            EmissionSpectrum::Table(table) => Some(table),
            EmissionSpectrum::Filtered(_) | EmissionSpectrum::BlackBody(_) => None,
        }
    }

    /// The sum of red, green and blue over three times the luminance: how much of it the eye sees in all for the same
    /// luminance, about 1 for white light and more for blue.
    pub(crate) fn strength(&self) -> f64 {
        let sum: f32 = self.rgb.iter().sum();
        if self.luminance > 0.0 { f64::from(sum) / (3.0 * f64::from(self.luminance)) } else { 0.0 }
    }

    /// Whether it is finite at every wavelength.
    pub fn is_finite(&self) -> bool {
        self.scale.is_finite() && self.rgb.iter().all(|v| v.is_finite())
    }

    /// Whether there is no light at any wavelength.
    pub fn is_black(&self) -> bool {
        self.scale == 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gamut::xy_of;
    use crate::illuminant;
    use crate::tabulated::Outside;

    #[test]
    fn planck_is_planck() {
        for (kelvin, expected) in
            [(5800.0, [26154.6, 26310.5, 23098.9]), (6500.0, [47511.7, 43063.1, 35243.5])]
        {
            for (nm, expected) in [450.0, 550.0, 650.0].into_iter().zip(expected) {
                let found = planck(nm, kelvin);
                assert!((found - expected).abs() < 0.06, "{kelvin} K, {nm} nm: {found}");
            }
        }
    }

    #[test]
    fn the_quick_form_has_plancks_shape_at_all_temperatures() {
        for kelvin in [300.0f32, 1000.0, 2856.0, 6500.0, 1e5, 1e6] {
            for nm in [360.0f32, 450.0, 560.0, 700.0, 830.0] {
                let expected = planck(f64::from(nm), f64::from(kelvin)) / planck(560.0, f64::from(kelvin));
                let off = f64::from(black_body_shape(nm, kelvin)) / expected - 1.0;
                assert!(off.abs() < 3e-5, "{kelvin} K, {nm} nm: {off}");
            }
        }
    }

    #[test]
    fn a_black_body_has_luminance_one_and_its_colour() {
        // Illuminant A is a black body of 2855.5 K by today's constants. [CIE 015:2018, table 3]
        let xyz = observer::xyz(&[], |nm| f64::from(black_body_shape(nm, 2855.54)));
        let [x, y] = xy_of(xyz);
        assert!((x - 0.44758).abs() < 2e-5 && (y - 0.40745).abs() < 2e-5, "{x} {y}");
        for kelvin in [-1.0, f32::NAN, 1000.0, 6500.0, f32::INFINITY] {
            let e = Emission::blackbody(kelvin);
            assert_eq!(e.luminance(), 1.0);
            assert!(e.rgb().iter().all(|v| v.is_finite()), "{kelvin}: {:?}", e.rgb());
            assert!(e.at(&Wavelengths::sample(0.2)).is_finite());
        }
        let [r, _, b] = Emission::blackbody(2000.0).rgb();
        assert!(r > 3.0 * b);
    }

    #[test]
    fn white_is_d65_of_luminance_one() {
        let white = Emission::from_rgb([1.0; 3]);
        let lambda = Wavelengths::sample(0.6);
        for (i, nm) in lambda.nm().unwrap().into_iter().enumerate() {
            assert!((white.at(&lambda)[i] - illuminant::d65(nm)).abs() < 1e-6);
        }
        assert!((white.luminance() - 1.0).abs() < 1e-6);
        assert_eq!(white.at(&Wavelengths::RGB), Spectrum::rgb(1.0, 1.0, 1.0));
        assert_eq!(white.scaled(2.5).rgb(), [2.5; 3]);
    }

    #[test]
    fn tables_are_scaled_and_negative_light_is_none() {
        let flat = Tabulated::new([(300.0, 2.0), (900.0, 2.0)], Outside::Zero).unwrap();
        let e = Emission::from_spectrum(flat, 1.5);
        assert!((e.luminance() - 3.0).abs() < 1e-5);
        assert_eq!(e.at(&Wavelengths::sample(0.4)), Spectrum::grey(3.0));
        assert!((e.normalized().luminance() - 1.0).abs() < 1e-6);
        assert!(Emission::from_rgb([-1.0, f32::NAN, 0.0]).is_black());
        assert!(Emission::BLACK.normalized().is_black());
        let dark = Tabulated::new([(500.0, -2.0)], Outside::Clamp).unwrap();
        assert_eq!(Emission::from_spectrum(dark, 1.0).luminance(), 0.0);
    }
}
