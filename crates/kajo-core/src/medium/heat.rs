//! Media that emit by their temperature: flames by a grid of temperatures.
//!
//! What is in equilibrium with its own temperature `T` gives what it absorbs of the light of a black body [Kirchhoff 1860]: the radiance per
//! unit length is in proportion to the density `d`,
//!
//! ```text
//! dL/ds = d e B(λ, T) / Y(T₀),    T = scale * value + offset
//! ```
//!
//! with Planck's law `B` and the luminance `Y` of a black body of `T₀` = 2000 K.
//!
//! Scene: `Media { GridMedium fire { file fire.vdb  density 4  temperature flame  temperatureScale 1500  brightness 20 } }`

use kajo_color::{BlackBodies, Spectrum, Wavelengths};
use kajo_math::Vec3;

use super::PlacedVoxels;

/// The temperature in kelvin at which a medium of density 1 gives its brightness.
pub const REFERENCE_KELVIN: f64 = 2000.0;

/// Temperatures by place, and what they give.
#[derive(Clone, Debug)]
pub struct Heat {
    grid: PlacedVoxels,
    scale: f32,
    offset: f32,
    brightness: f32,
    bodies: BlackBodies,
}

impl Heat {
    /// * `grid`: the numbers, 0 outside of their box
    /// * `scale`, `offset`: kelvin of the number 1 more, and of the number 0
    /// * `brightness`: luminance per unit length of the density 1 at [`REFERENCE_KELVIN`]
    pub fn new(grid: PlacedVoxels, [scale, offset]: [f32; 2], brightness: f32) -> Heat {
        Heat { grid, scale, offset, brightness, bodies: BlackBodies::new(REFERENCE_KELVIN) }
    }

    /// The temperature in kelvin at a world-space point.
    pub fn kelvin(&self, p: Vec3) -> f32 {
        self.scale * self.grid.within(p).unwrap_or(0.0) + self.offset
    }

    /// Radiance per unit length that the density 1 gives at a world-space point.
    pub fn emission(&self, p: Vec3, wavelengths: &Wavelengths) -> Spectrum {
        self.bodies.at(self.kelvin(p).into(), wavelengths) * self.brightness
    }
}
