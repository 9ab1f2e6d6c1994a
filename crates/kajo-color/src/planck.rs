//! Planck's law.

use kajo_math::fmath;

/// Spectral radiance of a black body at a wavelength in nm, in W m⁻² sr⁻¹ nm⁻¹.
pub fn planck(nm: f64, kelvin: f64) -> f64 {
    /// Planck's constant in J s, the speed of light in m/s, Boltzmann's constant in J/K.
    const H: f64 = 6.626_070_15e-34;
    const C: f64 = 299_792_458.0;
    const K: f64 = 1.380_649e-23;
    let m = nm * 1e-9;
    2.0 * H * C * C / (m * m * m * m * m) / fmath::exp_m1_64(H * C / (m * K * kelvin)) * 1e-9
}

/// Planck's law over its value at 560 nm, without large intermediate numbers.
pub(crate) fn black_body_shape(nm: f32, kelvin: f32) -> f32 {
    const CENTER_NM: f32 = 560.0;
    /// `h c / k` in nm K.
    const C2: f32 = 1.438_776_9e7;
    let (x0, x) = (C2 / (CENTER_NM * kelvin), C2 / (nm * kelvin));
    let tail = (1.0 - fmath::exp(-x0)) / (1.0 - fmath::exp(-x));
    fmath::powi(CENTER_NM / nm, 5) * fmath::exp(x0 - x) * tail
}
