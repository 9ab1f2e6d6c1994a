//! Light by the classic formula and by physical quantities.

use std::f32::consts::PI;

use kajo_color::{Emission, Spectrum};

use super::spectra::Written;
use crate::light::classic_factor;

/// The factor of the classic formula, and the irradiance that makes a white surface just as bright.
pub(super) fn classic(color: Written<Emission>) -> (Spectrum, Emission) {
    (color.rgb, color.value.scaled(PI))
}

/// The same from the physical quantity: a white surface under the irradiance `pi` has the radiance 1.
pub(super) fn physical(quantity: Emission) -> (Spectrum, Emission) {
    (classic_factor(&quantity), quantity)
}
