//! Which wavelengths a path carries.
//!
//! The first, the hero, is drawn where the eye is most sensitive. The others follow at quarter turns of
//! the same uniform number `u`, so the four together cover the visible range evenly:
//!
//! ```text
//! λ(u)  = c − artanh(t) / a,     t = t₀ + (t₁ − t₀) u,     tₖ = tanh(a (c − λₖ))
//! p(λ)  = a (1 − t²) / (t₀ − t₁)
//! λᵢ    = λ((u + i/4) mod 1)
//! ```
//!
//! with `c` = 538 nm, `a` = 0.0072 / nm and `λ₀`, `λ₁` the ends of the visible range.
//! Where lights shine in lines, another `λ(u)` finds these: see [`WavelengthChoice`](crate::WavelengthChoice).
//! [Wilkie et al. 2014], [Radziszewski et al. 2009], [Pharr, Jakob and Humphreys 2023, 4.5.4]

use kajo_math::fmath;

use crate::observer::{FIRST_NM, LAST_NM};
use crate::{Spectrum, illuminant};

/// Where the density is greatest, in nm.
const CENTER_NM: f64 = 538.0;
/// How fast it falls, per nm.
const SLOPE: f64 = 0.0072;
/// `tanh(SLOPE (CENTER_NM - FIRST_NM))` and `tanh(SLOPE (CENTER_NM - LAST_NM))`.
const T_FIRST: f64 = 0.856_910_625_469_828;
const T_LAST: f64 = -0.970_591_346_940_269_8;

/// The wavelengths that the lanes of a [`Spectrum`] stand for, with the density of each.
///
/// The mode of a picture is decided here: [`Wavelengths::RGB`] says that lanes are red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wavelengths {
    /// In nm; all zero in RGB mode.
    lambda: [f32; 4],
    /// Per nm; zero for a wavelength that is no longer followed.
    pdf: [f32; 4],
    /// D65 of luminance 1 there, which every light given as a colour shines with; 1 in RGB mode.
    daylight: Spectrum,
    /// The wavelengths over those that the sensor sees them as.
    shift: f32,
}

impl Wavelengths {
    /// No wavelengths: lanes 0 to 2 are linear red, green and blue.
    pub const RGB: Wavelengths =
        Wavelengths { lambda: [0.0; 4], pdf: [1.0, 1.0, 1.0, 0.0], daylight: Spectrum::WHITE, shift: 1.0 };

    /// Four wavelengths of the visible range for a uniform `u` in [0, 1).
    pub fn sample(u: f32) -> Wavelengths {
        Wavelengths::by_turns(u, visible)
    }

    /// Those that `draw` answers to four quarter turns of `u`, each with its density.
    pub(crate) fn by_turns(u: f32, draw: impl Fn(f32) -> (f32, f32)) -> Wavelengths {
        let (mut lambda, mut pdf) = ([0.0; 4], [0.0; 4]);
        for i in 0..4 {
            let turned = u + 0.25 * i as f32;
            (lambda[i], pdf[i]) = draw(if turned < 1.0 { turned } else { turned - 1.0 });
        }
        Wavelengths { lambda, pdf, daylight: Spectrum::from(lambda.map(illuminant::d65)), shift: 1.0 }
    }

    /// Whether lanes are wavelengths.
    #[inline]
    pub fn is_spectral(&self) -> bool {
        self.lambda[0] != 0.0
    }

    /// The wavelengths in nm, `None` in RGB mode. The first is the hero.
    #[inline]
    pub fn nm(&self) -> Option<[f32; 4]> {
        self.is_spectral().then_some(self.lambda)
    }

    /// The wavelengths in nm that the sensor sees, before all shifts; zero in RGB mode.
    #[inline]
    pub(crate) fn seen_nm(&self) -> [f32; 4] {
        self.lambda.map(|nm| nm / self.shift)
    }

    /// D65 of luminance 1, the spectrum of a light of colour 1 1 1; 1 in RGB mode.
    #[inline]
    pub fn daylight(&self) -> Spectrum {
        self.daylight
    }

    /// The density per nm of each wavelength; zero for one that is no longer followed.
    #[inline]
    pub fn pdf(&self) -> [f32; 4] {
        self.pdf
    }

    /// The wavelengths by which an observer tells this light apart in whose frame its frequencies are another multiple of these.
    ///
    /// Those that leave the visible range are followed there: black bodies shine by Planck's law, colours of surfaces stay what
    /// they are at its ends, D65 goes on as a black body of its temperature, and tables are what they say of what lies outside of them.
    /// Densities stay those of the wavelengths that the sensor sees. RGB mode is as it was.
    ///
    /// * `factor`: wavelength there over wavelength here, positive
    #[must_use]
    pub fn shifted(&self, factor: f32) -> Wavelengths {
        if !self.is_spectral() {
            return *self;
        }
        let lambda = self.lambda.map(|nm| nm * factor);
        let daylight = Spectrum::from(lambda.map(illuminant::d65_continued));
        Wavelengths { lambda, pdf: self.pdf, daylight, shift: self.shift * factor }
    }

    /// Follows only the hero from here on, because the path now depends on the wavelength.
    ///
    /// The estimate is a mean over four lanes. With three of them lost the hero counts four times, which
    /// a quarter of its density says. Calling it again changes nothing, and neither does RGB mode.
    pub fn terminate_secondary(&mut self) {
        if self.is_spectral() && !self.secondary_terminated() {
            self.pdf = [0.25 * self.pdf[0], 0.0, 0.0, 0.0];
        }
    }

    /// Whether only the hero is followed.
    #[inline]
    pub fn secondary_terminated(&self) -> bool {
        self.pdf[1..] == [0.0; 3]
    }

    /// `s` with zero in the lanes that no longer count, which include lane 3 in RGB mode.
    #[inline]
    pub fn live(&self, s: Spectrum) -> Spectrum {
        let lane = |i: usize| if self.pdf[i] == 0.0 { 0.0 } else { s[i] };
        Spectrum::from([lane(0), lane(1), lane(2), lane(3)])
    }

    /// The largest lane in use, for Russian roulette.
    #[inline]
    pub fn max_lane(&self, s: Spectrum) -> f32 {
        self.live(s).max_lane()
    }

    /// The mean of the lanes in use.
    #[inline]
    pub fn mean(&self, s: Spectrum) -> f32 {
        let lanes = if self.secondary_terminated() {
            1.0
        } else if self.is_spectral() {
            4.0
        } else {
            3.0
        };
        self.live(s).mean() * (4.0 / lanes)
    }

    /// Whether every lane in use is zero.
    #[inline]
    pub fn is_black(&self, s: Spectrum) -> bool {
        self.live(s).is_black()
    }
}

/// A wavelength of the visible range in nm for a uniform `u` in [0, 1), and its density per nm.
pub fn visible(u: f32) -> (f32, f32) {
    const RANGE: f32 = (T_FIRST - T_LAST) as f32;
    let t = T_FIRST as f32 - RANGE * u;
    let artanh = 0.5 * fmath::ln((1.0 + t) / (1.0 - t));
    let lambda = CENTER_NM as f32 - artanh / SLOPE as f32;
    (lambda.clamp(FIRST_NM as f32, LAST_NM as f32), SLOPE as f32 * (1.0 - t * t) / RANGE)
}

/// The density per nm with which [`visible`] draws `nm`; zero outside the visible range.
pub fn visible_pdf(nm: f32) -> f32 {
    if !(FIRST_NM as f32..=LAST_NM as f32).contains(&nm) {
        return 0.0;
    }
    // 1 - tanh² = 1 / cosh².
    let e = fmath::exp(SLOPE as f32 * (nm - CENTER_NM as f32));
    let cosh = 0.5 * (e + 1.0 / e);
    SLOPE as f32 / ((T_FIRST - T_LAST) as f32 * cosh * cosh)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_the_warp_are_the_ends_of_the_range() {
        assert!((T_FIRST - (SLOPE * (CENTER_NM - FIRST_NM)).tanh()).abs() < 1e-15);
        assert!((T_LAST - (SLOPE * (CENTER_NM - LAST_NM)).tanh()).abs() < 1e-15);
        assert!((visible(0.0).0 - 360.0).abs() < 1e-3);
        let last = visible(1.0 - f32::EPSILON / 2.0).0;
        assert!(last <= 830.0 && last > 829.9, "{last}");
    }

    #[test]
    fn the_density_is_the_slope_of_the_warp() {
        for i in 1..1000 {
            let u = i as f32 / 1000.0;
            let (nm, pdf) = visible(u);
            assert!((visible_pdf(nm) / pdf - 1.0).abs() < 1e-4, "{nm}");
            let h = 2e-3;
            if (0.01..0.99).contains(&u) {
                let slope = (visible(u + h).0 - visible(u - h).0) / (2.0 * h);
                assert!((slope * pdf - 1.0).abs() < 0.01, "{nm}: {slope} {pdf}");
            }
        }
        assert_eq!([visible_pdf(359.0), visible_pdf(831.0)], [0.0; 2]);
    }

    #[test]
    fn the_density_integrates_to_one() {
        let sum: f64 = (0..4700).map(|i| 0.1 * f64::from(visible_pdf(360.05 + 0.1 * i as f32))).sum();
        assert!((sum - 1.0).abs() < 1e-5, "{sum}");
    }

    #[test]
    fn the_four_are_quarter_turns_of_one_number() {
        let lambda = Wavelengths::sample(0.8).lambda;
        for (i, u) in [0.8, 0.05, 0.3, 0.55].into_iter().enumerate() {
            assert!((lambda[i] - visible(u).0).abs() < 1e-3, "{lambda:?}");
        }
        for u in [0.0, 0.25, 0.5, 0.75, 1.0 - f32::EPSILON / 2.0] {
            let w = Wavelengths::sample(u);
            assert!(w.lambda.iter().all(|nm| (360.0..=830.0).contains(nm)), "{w:?}");
            assert!(w.pdf.iter().all(|p| *p > 0.0), "{w:?}");
        }
    }

    #[test]
    fn the_hero_is_left_once() {
        let mut w = Wavelengths::sample(0.4);
        let before = w.pdf();
        assert!(w.is_spectral() && !w.secondary_terminated());
        w.terminate_secondary();
        assert_eq!(w.pdf(), [before[0] / 4.0, 0.0, 0.0, 0.0]);
        let once = w;
        w.terminate_secondary();
        assert_eq!(w, once);

        let mut rgb = Wavelengths::RGB;
        rgb.terminate_secondary();
        assert_eq!(rgb, Wavelengths::RGB);
        assert!(!rgb.secondary_terminated() && rgb.nm().is_none());
    }

    #[test]
    fn shifted_lanes_keep_their_densities() {
        let w = Wavelengths::sample(0.4);
        let shifted = w.shifted(2.5);
        assert_eq!(shifted.pdf(), w.pdf());
        assert_eq!(shifted.nm().unwrap(), w.nm().unwrap().map(|nm| 2.5 * nm));
        let seen = shifted.seen_nm();
        assert!(seen.into_iter().zip(w.nm().unwrap()).all(|(found, nm)| (found / nm - 1.0).abs() < 1e-6));
        assert_eq!(w.shifted(1.0), w);
        assert_eq!(Wavelengths::RGB.shifted(3.0), Wavelengths::RGB);
        for factor in [1e-4, 0.1, 10.0, 1e4] {
            let daylight = w.shifted(factor).daylight();
            assert!(daylight.is_finite() && (0..4).all(|i| daylight[i] >= 0.0), "{factor}: {daylight:?}");
        }
    }

    #[test]
    fn only_lanes_in_use_are_compared() {
        let s = Spectrum::from([1.0, 2.0, 3.0, 10.0]);
        assert_eq!((Wavelengths::RGB.max_lane(s), Wavelengths::RGB.mean(s)), (3.0, 2.0));
        let mut w = Wavelengths::sample(0.2);
        assert_eq!((w.max_lane(s), w.mean(s)), (10.0, 4.0));
        w.terminate_secondary();
        assert_eq!((w.max_lane(s), w.mean(s)), (1.0, 1.0));
        assert!(w.is_black(Spectrum::from([0.0, 1.0, 1.0, 1.0])));
        assert!(Wavelengths::RGB.is_black(Spectrum::from([0.0, 0.0, 0.0, 1.0])));
        assert!(!w.is_black(s));
    }
}
