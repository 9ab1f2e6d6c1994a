//! What a medium of density 1 does to light.

use std::sync::Arc;

use kajo_color::{Emission, Reflectance, Spectrum, Unbounded, Wavelengths};
use kajo_math::Vec3;

use super::{AlbedoGrid, Heat, Phase, albedo_of};

/// Absorption, scattering and the phase function of a medium, all per unit of density.
///
/// ```text
/// sigma_t = sigma_a + sigma_s,    albedo = sigma_s / sigma_t,    mean free path = 1 / sigma_t
/// ```
///
/// A medium may also give light of its own, radiance per unit length, to all sides alike.
#[derive(Clone, Debug)]
pub struct Coefficients {
    sigma_a: Unbounded,
    sigma_s: Unbounded,
    scatters: bool,
    phase: Phase,
    emission: Option<Arc<Emission>>,
    heat: Option<Arc<Heat>>,
    colors: Option<Arc<AlbedoGrid>>,
    is_subsurface: bool,
    separates_colors: bool,
}

/// How many times as large the largest of three extinctions may be as the least one, so that walks are shared by all colours.
const LIKE_COLORS: f32 = 2.5;

/// Why there are no such coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CoefficientsError {
    /// Negative, infinite or no number.
    #[error("coefficients of a medium are finite and not negative")]
    Coefficient,
    /// An albedo that is none.
    #[error("an albedo is from 0 to 1")]
    Albedo,
}

impl Coefficients {
    /// Coefficients per unit length, in linear RGB.
    ///
    /// # Errors
    /// [`CoefficientsError::Coefficient`].
    pub fn new(
        sigma_a: [f32; 3],
        sigma_s: [f32; 3],
        phase: Phase,
    ) -> Result<Coefficients, CoefficientsError> {
        let usable = |v: &f32| v.is_finite() && *v >= 0.0;
        if !sigma_a.iter().chain(&sigma_s).all(usable) {
            return Err(CoefficientsError::Coefficient);
        }
        let scatters = sigma_s.iter().any(|&v| v > 0.0);
        let [sigma_a, sigma_s] = [sigma_a, sigma_s].map(Unbounded::from_rgb);
        Ok(Coefficients { sigma_a, sigma_s, scatters, phase, ..Coefficients::clear() })
    }

    /// Of a clear medium.
    pub fn clear() -> Coefficients {
        let nothing = Unbounded::from_rgb([0.0; 3]);
        Coefficients {
            sigma_a: nothing.clone(),
            sigma_s: nothing,
            scatters: false,
            phase: Phase::Isotropic,
            emission: None,
            heat: None,
            colors: None,
            is_subsurface: false,
            separates_colors: false,
        }
    }

    /// By the share of light that a collision scatters, and the extinction per unit length; both in linear RGB.
    ///
    /// # Errors
    /// [`CoefficientsError`].
    pub fn from_albedo(
        albedo: [f32; 3],
        sigma_t: [f32; 3],
        phase: Phase,
    ) -> Result<Coefficients, CoefficientsError> {
        if !albedo.iter().all(|v| (0.0..=1.0).contains(v)) {
            return Err(CoefficientsError::Albedo);
        }
        let sigma_s = [0, 1, 2].map(|i| sigma_t[i] * albedo[i]);
        let sigma_a = [0, 1, 2].map(|i| sigma_t[i] * (1.0 - albedo[i]));
        Coefficients::new(sigma_a, sigma_s, phase)
    }

    /// What is below the surface of a body that looks as if it had a diffuse surface: a half space of it that light enters
    /// and leaves without reflection gives back the share `color` of light that comes from all around; see [`super::albedo_of`].
    ///
    /// * `color`: by wavelength
    /// * `radius`: mean free path, `1 / sigma_t`, in linear RGB
    ///
    /// # Errors
    /// [`CoefficientsError::Coefficient`] for a radius that is not above 0.
    pub fn subsurface(
        color: &Reflectance,
        radius: [f32; 3],
        phase: Phase,
    ) -> Result<Coefficients, CoefficientsError> {
        let sigma_t = radius.map(f32::recip);
        if !sigma_t.iter().all(|v| v.is_finite() && *v > 0.0) {
            return Err(CoefficientsError::Coefficient);
        }
        let [least, most] = [f32::min, f32::max].map(|of| sigma_t.into_iter().reduce(of).unwrap_or(1.0));
        let separates_colors = most > LIKE_COLORS * least;
        let sigma_t = Unbounded::from_rgb(sigma_t);
        let albedo = |color| albedo_of(color, phase.mean_cosine());
        let sigma_a = Unbounded::from_each(color, &sigma_t, |color, sigma_t| sigma_t * (1.0 - albedo(color)));
        let sigma_s = Unbounded::from_each(color, &sigma_t, |color, sigma_t| sigma_t * albedo(color));
        let scatters = color.rgb().iter().any(|&v| v > 0.0);
        let made =
            Coefficients { sigma_a, sigma_s, scatters, phase, separates_colors, ..Coefficients::clear() };
        Ok(Coefficients { is_subsurface: true, ..made })
    }

    /// Whether it was made by [`Coefficients::subsurface`], so that light is scattered many times on its way out again.
    #[inline]
    pub fn is_subsurface(&self) -> bool {
        self.is_subsurface
    }

    /// Whether it was made by [`Coefficients::subsurface`] with radii so different that a walk of one colour says little of the others.
    #[inline]
    pub fn separates_colors(&self) -> bool {
        self.separates_colors
    }

    /// Absorption per unit length.
    #[inline]
    pub fn sigma_a(&self, wavelengths: &Wavelengths) -> Spectrum {
        self.sigma_a.at(wavelengths)
    }

    /// Scattering per unit length.
    #[inline]
    pub fn sigma_s(&self, wavelengths: &Wavelengths) -> Spectrum {
        self.sigma_s.at(wavelengths)
    }

    /// Whether it scatters light at all.
    #[inline]
    pub fn scatters(&self) -> bool {
        self.scatters
    }

    /// The same medium that also gives light.
    ///
    /// * `emission`: radiance per unit length
    #[must_use]
    pub fn with_emission(self, emission: Emission) -> Coefficients {
        Coefficients { emission: Some(Arc::new(emission)).filter(|emission| !emission.is_black()), ..self }
    }

    /// The same medium that also emits by its temperature.
    #[must_use]
    pub fn with_heat(self, heat: Heat) -> Coefficients {
        Coefficients { heat: Some(Arc::new(heat)), ..self }
    }

    /// The same medium with an albedo that differs from place to place.
    #[must_use]
    pub fn with_colors(self, colors: AlbedoGrid) -> Coefficients {
        Coefficients { colors: Some(Arc::new(colors)), ..self }
    }

    /// What scattering is multiplied by at each place, at the cost of more absorption, where that is not 1.
    #[inline]
    pub fn colors(&self) -> Option<&AlbedoGrid> {
        self.colors.as_deref()
    }

    /// What it gives by its temperature, where it does.
    #[inline]
    pub fn heat(&self) -> Option<&Heat> {
        self.heat.as_deref()
    }

    /// Radiance per unit length that it gives itself, where that is the same everywhere but for the density.
    #[inline]
    pub fn emission(&self, wavelengths: &Wavelengths) -> Option<Spectrum> {
        self.emission.as_ref().map(|emission| emission.at(wavelengths))
    }

    /// Radiance per unit length that the density 1 of it gives itself at a point, where it gives any.
    ///
    /// * `p`: in world space, where its matter was at the moment that its grids are of
    #[inline]
    pub fn emission_at(&self, p: Vec3, wavelengths: &Wavelengths) -> Option<Spectrum> {
        match self.heat() {
            Some(heat) => Some(heat.emission(p, wavelengths)),
            None => self.emission(wavelengths),
        }
    }

    /// Whether it gives light.
    #[inline]
    pub fn emits(&self) -> bool {
        self.emission.is_some() || self.heat.is_some()
    }

    /// Whether it gives light that any amount of it does not weaken.
    pub fn emits_without_extinction(&self) -> bool {
        let rgb = &Wavelengths::RGB;
        let sigma_t = (self.sigma_a(rgb) + self.sigma_s(rgb)).to_rgb();
        self.emits() && sigma_t.iter().any(|&sigma| sigma <= 0.0)
    }

    /// Its phase function.
    #[inline]
    pub fn phase(&self) -> &Phase {
        &self.phase
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_albedo_splits_the_extinction() {
        let made = Coefficients::from_albedo([0.25, 0.5, 1.0], [4.0; 3], Phase::Isotropic).unwrap();
        let rgb = Wavelengths::RGB;
        assert_eq!(made.sigma_s(&rgb).to_rgb(), [1.0, 2.0, 4.0]);
        assert_eq!(made.sigma_a(&rgb).to_rgb(), [3.0, 2.0, 0.0]);
        assert!(made.scatters());
        let clear = Coefficients::new([1.0; 3], [0.0; 3], Phase::Isotropic).unwrap();
        assert!(!clear.scatters());
    }

    #[test]
    fn a_body_below_a_surface_is_inverted_by_wavelength() {
        let color = Reflectance::from_rgb([0.8, 0.5, 0.0]);
        let made = Coefficients::subsurface(&color, [1.0, 0.5, 0.1], Phase::Isotropic).unwrap();
        assert!(made.is_subsurface() && made.scatters());
        for lambda in [Wavelengths::RGB, Wavelengths::sample(0.3), Wavelengths::sample(0.8)] {
            let [sigma_a, sigma_s] = [made.sigma_a(&lambda), made.sigma_s(&lambda)];
            let (albedo, color) = (sigma_s.safe_div(sigma_s + sigma_a), color.at(&lambda));
            for lane in 0..3 {
                let exact = albedo_of(color[lane], 0.0);
                assert!((albedo[lane] - exact).abs() < 3e-3, "{lambda:?} {lane}: {} {exact}", albedo[lane]);
            }
        }
        let rgb = Wavelengths::RGB;
        let sigma_t = (made.sigma_a(&rgb) + made.sigma_s(&rgb)).to_rgb();
        assert!((0..3).all(|i| (sigma_t[i] / [1.0, 2.0, 10.0][i] - 1.0).abs() < 1e-6), "{sigma_t:?}");
        for radius in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-39] {
            let made = Coefficients::subsurface(&color, [1.0, radius, 1.0], Phase::Isotropic);
            assert_eq!(made.err(), Some(CoefficientsError::Coefficient), "{radius}");
        }
    }

    #[test]
    fn a_medium_may_give_light() {
        let clear = Coefficients::clear();
        assert!(!clear.emits() && clear.emission(&Wavelengths::RGB).is_none());
        let flame = clear.clone().with_emission(Emission::from_rgb([3.0, 2.0, 1.0]));
        assert_eq!(flame.emission(&Wavelengths::RGB).map(Spectrum::to_rgb), Some([3.0, 2.0, 1.0]));
        assert!(!clear.with_emission(Emission::from_rgb([0.0; 3])).emits());
    }

    #[test]
    fn what_is_no_medium_is_refused() {
        let of = |sigma_a: f32, sigma_s: f32| {
            Coefficients::new([sigma_a; 3], [0.0, 1.0, sigma_s], Phase::Isotropic).err()
        };
        for (a, s) in [(-1.0, 1.0), (1.0, -1e-9), (f32::NAN, 0.0), (0.0, f32::INFINITY)] {
            assert_eq!(of(a, s), Some(CoefficientsError::Coefficient), "{a} {s}");
        }
        let albedo = |albedo: f32| Coefficients::from_albedo([albedo; 3], [1.0; 3], Phase::Isotropic).err();
        assert_eq!(albedo(1.001), Some(CoefficientsError::Albedo));
        assert_eq!(albedo(f32::NAN), Some(CoefficientsError::Albedo));
        assert_eq!(albedo(1.0), None);
    }
}
