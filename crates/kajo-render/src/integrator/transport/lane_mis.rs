//! Which lane of a path draws distances in media, and how likely the path was by the others.

use kajo_color::{Spectrum, Wavelengths};

/// Which lane draws distances in media, and the densities of the other lanes; see `collisions.rs`.
#[derive(Clone, Copy, Debug)]
pub struct LaneMis {
    /// Densities of the path if other lanes were the hero.
    pub r_u: Spectrum,
    /// The same with the last segment found by a connection.
    pub r_l: Spectrum,
    /// The lane that draws.
    pub hero: u32,
}

impl LaneMis {
    /// Of a path that begins.
    ///
    /// Wavelengths are alike in how they are drawn, so that the first can be the hero. Red, green and blue are not, and one is
    /// chosen by a number.
    ///
    /// * `u`: uniform in [0, 1)
    pub fn new(wavelengths: &Wavelengths, u: f32) -> LaneMis {
        let hero = if wavelengths.is_spectral() { 0 } else { ((3.0 * u) as u32).min(2) };
        LaneMis { hero, ..LaneMis::default() }
    }
}

impl Default for LaneMis {
    fn default() -> LaneMis {
        LaneMis { r_u: Spectrum::WHITE, r_l: Spectrum::WHITE, hero: 0 }
    }
}
