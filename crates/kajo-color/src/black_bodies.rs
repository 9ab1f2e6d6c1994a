//! Black bodies of any temperature, bright in proportion to each other.
//!
//! [`Emission::blackbody`](crate::Emission::blackbody) is one body of luminance 1. Where the temperature differs from
//! place to place, or is seen shifted, radiances have to be compared:
//!
//! ```text
//! L(λ) = B(λ, T) / Y(T₀)
//! ```
//!
//! with Planck's law `B` and the luminance `Y` of a black body of a reference temperature. In RGB mode the colour comes from a table
//! over the logarithm of `T`.

use kajo_math::fmath;

use crate::planck::planck;
use crate::{Spectrum, Wavelengths, matrix, observer, sensor};

/// Temperatures in K between which colours are tabulated. Colder bodies are dark; hotter ones have the colour of the hottest, and
/// are brighter in proportion to their temperature.
const COLDEST: f64 = 400.0;
const HOTTEST: f64 = 4e5;

/// Entries of the table.
const ENTRIES: usize = 768;

/// Black bodies, of luminance 1 at one temperature.
#[derive(Clone, Debug)]
pub struct BlackBodies {
    /// Of radiance.
    scale: f64,
    /// Logarithm of the luminance, and red, green and blue over the luminance.
    table: Vec<[f32; 4]>,
}

impl BlackBodies {
    /// * `reference`: temperature in kelvin of luminance 1; held to [400, 4e5]
    pub fn new(reference: f64) -> BlackBodies {
        let reference = if reference > COLDEST { reference.min(HOTTEST) } else { COLDEST };
        let scale = 1.0 / luminance(reference);
        let step = fmath::ln64(HOTTEST / COLDEST) / (ENTRIES - 1) as f64;
        let entry = |i: usize| {
            let kelvin = COLDEST * fmath::exp64(step * i as f64);
            let xyz = observer::xyz(&[], |nm| planck(nm.into(), kelvin));
            let rgb = matrix::apply(&sensor::RGB_FROM_XYZ, xyz).map(|v| (v / xyz[1]).max(0.0) as f32);
            [fmath::ln64(xyz[1] * scale) as f32, rgb[0], rgb[1], rgb[2]]
        };
        BlackBodies { scale, table: (0..ENTRIES).map(entry).collect() }
    }

    /// The radiance of a body in the lanes of a path; none below absolute zero.
    pub fn at(&self, kelvin: f64, lambda: &Wavelengths) -> Spectrum {
        if kelvin.is_nan() || kelvin <= 0.0 {
            return Spectrum::BLACK;
        }
        match lambda.nm() {
            Some(nm) => Spectrum::from(nm.map(|nm| (self.scale * planck(nm.into(), kelvin)) as f32)),
            None => self.rgb(kelvin),
        }
    }

    /// The colour of a body, linear sRGB without negative components.
    fn rgb(&self, kelvin: f64) -> Spectrum {
        if kelvin < COLDEST {
            return Spectrum::BLACK;
        }
        let beyond = (kelvin / HOTTEST).max(1.0);
        let step = fmath::ln64(HOTTEST / COLDEST) / (ENTRIES - 1) as f64;
        let place = fmath::ln64(kelvin.min(HOTTEST) / COLDEST) / step;
        let i = (place as usize).min(ENTRIES - 2);
        let t = (place - i as f64) as f32;
        let [a, b] = [self.table[i], self.table[i + 1]];
        let [y, red, green, blue] = [0, 1, 2, 3].map(|k| a[k] + t * (b[k] - a[k]));
        Spectrum::rgb(red, green, blue) * (fmath::exp(y) * beyond as f32)
    }
}

/// Luminance, up to the factor that all have.
fn luminance(kelvin: f64) -> f64 {
    observer::xyz(&[], |nm| planck(nm.into(), kelvin))[1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Emission;

    #[test]
    fn colder_bodies_are_much_darker() {
        let bodies = BlackBodies::new(2000.0);
        for (kelvin, factor) in [(1500.0, 60.0), (1000.0, 1.7e5)] {
            let found = 1.0 / bodies.at(kelvin, &Wavelengths::RGB).luminance();
            assert!((found / factor - 1.0).abs() < 0.05, "{kelvin}: {found}");
        }
    }

    #[test]
    fn the_table_has_the_colours_of_single_bodies() {
        let bodies = BlackBodies::new(5000.0);
        assert!((bodies.at(5000.0, &Wavelengths::RGB).luminance() - 1.0).abs() < 1e-3);
        for kelvin in [1000.0f32, 2856.0, 6500.0, 40_000.0, 300_000.0] {
            let found = bodies.at(kelvin.into(), &Wavelengths::RGB);
            let single = Emission::blackbody(kelvin).rgb();
            let y = luminance(kelvin.into()) / luminance(5000.0);
            for i in 0..3 {
                let expected = single[i] * y as f32;
                assert!((found[i] - expected).abs() <= 1e-3 * y as f32, "{kelvin}: {found:?} {single:?} {y}");
            }
        }
    }

    #[test]
    fn spectra_are_plancks() {
        let bodies = BlackBodies::new(3000.0);
        let lambda = Wavelengths::sample(0.3);
        for kelvin in [50.0, 1000.0, 3000.0, 1e5, 1e9] {
            let found = bodies.at(kelvin, &lambda);
            for (i, nm) in lambda.nm().unwrap().into_iter().enumerate() {
                let expected = planck(nm.into(), kelvin) / luminance(3000.0);
                assert!((f64::from(found[i]) - expected).abs() <= 1e-6 * expected + 1e-30);
            }
        }
    }

    #[test]
    fn no_temperature_is_too_strange() {
        let bodies = BlackBodies::new(f64::NAN);
        for kelvin in [f64::NAN, -1.0, 0.0, 1e-300, 1.0, 399.0, 4e5, 1e12] {
            for lambda in [Wavelengths::RGB, Wavelengths::sample(0.9)] {
                let found = bodies.at(kelvin, &lambda);
                assert!(found.is_finite() && (0..4).all(|i| found[i] >= 0.0), "{kelvin}: {found:?}");
            }
        }
        // Twice as hot is twice as bright where all light is of long waves.
        let [one, two] = [1e7, 2e7].map(|kelvin| bodies.at(kelvin, &Wavelengths::RGB).luminance());
        assert!((two / one - 2.0).abs() < 1e-3);
    }
}
