//! Linear RGB as reflectances.

use kajo_color::{RgbBasis, Spectrum, Wavelengths};

/// Linear RGB in [0, 1] as a reflectance.
pub(crate) fn rgb_reflectance([r, g, b]: [f32; 3], wavelengths: &Wavelengths) -> Spectrum {
    if wavelengths.is_spectral() {
        return RgbBasis::new(wavelengths).reflectance([r, g, b]);
    }
    Spectrum::rgb(r, g, b)
}
