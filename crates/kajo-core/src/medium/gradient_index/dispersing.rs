//! How an index that differs from place to place depends on the wavelength.

use kajo_color::{Dispersion, Wavelengths};

/// How the index depends on the wavelength: `n - 1` at a place is multiplied by a factor that is the same everywhere, and 1 for
/// yellow light.
#[derive(Clone, Debug, Default)]
pub enum Dispersing {
    /// It does not.
    #[default]
    None,
    /// As that of glass of this index, over its own `n - 1` at the d line.
    Glass(Dispersion),
    /// As that of air.
    Air,
}

/// Wavelength of the d line of helium in nm.
const D_LINE: f64 = 587.5618;

impl Dispersing {
    /// The factor of `n - 1` at the first wavelength; 1 for light that has none.
    pub fn factor(&self, wavelengths: &Wavelengths) -> f64 {
        let nm = wavelengths.nm().map(|[nm, ..]| f64::from(nm));
        match (self, nm) {
            (Dispersing::None, _) | (_, None) => 1.0,
            (Dispersing::Glass(dispersion), Some(nm)) => {
                (dispersion.index(nm) - 1.0) / (dispersion.index_d() - 1.0)
            }
            (Dispersing::Air, Some(nm)) => refractivity_of_air(nm) / refractivity_of_air(D_LINE),
        }
    }
}

/// `n - 1` of dry air at 15 degrees and 101325 Pa [Ciddor 1996, eq. 1].
///
/// * `nm`: wavelength in vacuum
pub fn refractivity_of_air(nm: f64) -> f64 {
    // Wave numbers in 1/µm.
    let square = 1e6 / (nm * nm);
    1e-8 * (5_792_105.0 / (238.0185 - square) + 167_917.0 / (57.362 - square))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn air_has_its_published_index() {
        // [Ciddor 1996, table 1]: 27724.0e-8 at 633 nm... of dry air at 15 degrees.
        assert!((refractivity_of_air(633.0) - 2.765_2e-4).abs() < 2e-8, "{}", refractivity_of_air(633.0));
        assert!(refractivity_of_air(400.0) > refractivity_of_air(700.0));
    }

    #[test]
    fn light_without_a_wavelength_is_yellow() {
        assert_eq!(Dispersing::Air.factor(&Wavelengths::RGB), 1.0);
    }
}
