//! The shape of a black body's spectrum, in single precision.

use kajo_math::fmath;

/// Planck's law over its value at 560 nm, without large intermediate numbers.
pub(crate) fn black_body_shape(nm: f32, kelvin: f32) -> f32 {
    const CENTER_NM: f32 = 560.0;
    /// `h c / k` in nm K.
    const C2: f32 = 1.438_776_9e7;
    let (x0, x) = (C2 / (CENTER_NM * kelvin), C2 / (nm * kelvin));
    let tail = (1.0 - fmath::exp(-x0)) / (1.0 - fmath::exp(-x));
    fmath::powi(CENTER_NM / nm, 5) * fmath::exp(x0 - x) * tail
}
