//! What becomes of a path whose light has another frequency in another frame: by gravity, or by motion.

use kajo_core::bsdf::Transport;

use super::PathState;

/// Light that is shifted to less than this part of its frequency is dark; no wavelength may be zero.
const SMALLEST_SHIFT: f32 = 1e-6;

/// What radiance is multiplied by where its frequency is `g` times what it is here: `g^4`, or by wavelength `g^5`.
///
/// Radiance by frequency over its third power stays the same along light, so radiance of all frequencies goes with the fourth power and
/// radiance by wavelength with the fifth [Misner et al. 1973, section 22.6].
#[inline]
pub fn radiance_factor(g: f32, is_spectral: bool) -> f32 {
    let all = g * g * g * g;
    if is_spectral { all * g } else { all }
}

impl PathState<'_> {
    /// Shifts the frequency of the light that the path finds:
    ///
    /// ```text
    /// beta <- beta g^4,    or by wavelength   lambda <- g lambda,  beta <- beta g^5
    /// ```
    ///
    /// In RGB mode colours stay what they are.
    ///
    /// What beams carry through area and solid angle goes with the square of the frequency, so power that is followed from a light is
    /// multiplied by `g^-2`; its wavelengths stay what they are.
    ///
    /// * `g`: frequency at the near end of the way, towards where the path began, over that at the far end
    pub fn shift_frequency(&mut self, g: f32) {
        if g == 1.0 {
            return;
        }
        if self.mode != Transport::Radiance {
            self.beta *= 1.0 / (g * g).max(f32::MIN_POSITIVE);
            return;
        }
        let factor = radiance_factor(g, self.wavelengths.is_spectral());
        self.wavelengths = self.wavelengths.shifted(g.max(SMALLEST_SHIFT));
        self.beta *= factor;
        // What the eye sees darker since it is shifted is no reason to end.
        self.eta_scale *= 1.0 / factor.max(f32::MIN_POSITIVE);
    }
}
