//! The light of gas that goes around a black hole.
//!
//! Each position of it is a black body of the temperature of the thin disk of [`ThinDisk`], in the frame of gas on a circular
//! orbit. Light that is seen with the frequency ratio `g` is that of a black body of temperature `g T`, in every direction and without
//! any other factor: `L(ν)/ν³` stays the same along light, and Planck's law is a function of `ν/T` times `ν³`.
//!
//! Light is given in the rest frame at the position itself: `g` is the Doppler shift of the orbit. What gravity
//! does to it on its way is part of following the curve.

use std::sync::Arc;

use kajo_color::{BlackBodies, Emission, Spectrum, Wavelengths};
use kajo_math::Vec3;
use kajo_math::gravity::ThinDisk;

use crate::medium::BlackHole;

/// Gas on circular orbits around a black hole.
#[derive(Clone, Debug)]
pub struct OrbitingGas {
    space: Arc<BlackHole>,
    /// Whether it goes around in the right-handed sense about the axis.
    with_axis: bool,
    disk: ThinDisk,
    /// Temperature in kelvin where it is hottest, in its own frame.
    hottest: f64,
    brightness: f32,
    bodies: Arc<BlackBodies>,
}

impl OrbitingGas {
    /// * `hottest`: temperature in kelvin where it is hottest, positive
    /// * `brightness`: luminance there, in the frame of the gas
    pub fn new(space: BlackHole, with_axis: bool, hottest: f32, brightness: f32) -> OrbitingGas {
        OrbitingGas {
            disk: ThinDisk::new(space.spin_along(with_axis)),
            space: Arc::new(space),
            with_axis,
            hottest: hottest.into(),
            brightness,
            bodies: Arc::new(BlackBodies::new(hottest.into())),
        }
    }

    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.hottest.is_finite() && self.brightness.is_finite()
    }

    /// The same light, `factor` times as bright.
    pub fn scaled(&self, factor: f32) -> OrbitingGas {
        OrbitingGas { brightness: self.brightness * factor.max(0.0), ..self.clone() }
    }

    /// The radiance of a position.
    ///
    /// * `p`: world space
    /// * `leaving`: unit direction in which the light goes, in the rest frame; of none it is that in the frame of the gas
    /// * `wavelengths`: in the rest frame; in RGB mode the colour is that of the light far away
    pub fn radiance(&self, p: Vec3, leaving: Option<Vec3>, wavelengths: &Wavelengths) -> Spectrum {
        let mass = self.space.hole().mass();
        let temperature = self.hottest * self.disk.relative_temperature(self.space.radius(p) / mass);
        if temperature <= 0.0 {
            return Spectrum::BLACK;
        }
        let Some(d) = leaving else {
            return self.bodies.at(temperature, wavelengths) * self.brightness;
        };
        let Some((doppler, far_away)) = self.space.shift_of_orbit(p, d, self.with_axis) else {
            return Spectrum::BLACK;
        };
        let temperature = temperature * doppler;
        if wavelengths.is_spectral() {
            return self.bodies.at(temperature, wavelengths) * self.brightness;
        }
        // The step along the curve multiplies the light by the fourth power of the shift by gravity, which this emission leaves out.
        let bolometric = far_away * far_away * far_away * far_away;
        if bolometric <= 0.0 {
            return Spectrum::BLACK;
        }
        self.bodies.at(temperature * far_away, wavelengths) * (self.brightness / bolometric as f32)
    }

    /// About what a position gives on average.
    pub fn mean(&self) -> Emission {
        // The mean over the rings up to four times the radius of the hottest one, as seen by the gas.
        const RINGS: u16 = 64;
        let (inner, outer) = (self.disk.innermost(), 4.0 * self.disk.peak().0);
        let (mut sum, mut area) = (Spectrum::BLACK, 0.0f32);
        for i in 0..RINGS {
            let r = inner + (outer - inner) * (f64::from(i) + 0.5) / f64::from(RINGS);
            let temperature = self.hottest * self.disk.relative_temperature(r);
            sum += self.bodies.at(temperature, &Wavelengths::RGB) * (self.brightness * r as f32);
            area += r as f32;
        }
        Emission::from_rgb([0, 1, 2].map(|i| sum[i] / area))
    }
}
