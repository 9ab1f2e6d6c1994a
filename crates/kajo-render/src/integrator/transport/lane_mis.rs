//! Which lane of a path draws distances in media, and how likely the path was by the others.
//!
//! One lane, the hero `h`, draws the distances `x` for all, and light counts by the balance heuristic over the lanes that might have been the hero,
//!
//! ```text
//! f_i(x) / (1/n sum over k of p_k(x))  =  f_i(x) / p_h(x)  /  (1/n sum over k of r[k]),        r[k] = p_k(x) / p_h(x)
//! ```
//!
//! with the density `p_k` of drawing the same path, null collisions included, if lane `k` were the hero: hero wavelengths [Wilkie et al. 2014] by the
//! densities of null collisions, the spectral MIS of [Miller, Georgiev and Jarosz 2019]. Two techniques end a path, so
//! there are two of these ratios: `r_u` where the last segment is a free path (unidirectional), and `r_l` where it is a
//! connection (to a light), which ratio tracking goes along.

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
    /// Of the last collision: the probability of getting there from the vertex before without another one, the mean over all lanes.
    pub reach: f32,
    /// Of the last collision: extinction per unit length there, the mean over all lanes.
    pub sigma_t: f32,
    /// The same where the current ray starts, 1 at surfaces and lights. It is kept for paths from both ends alone.
    pub sigma_t_from: f32,
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

    /// The probability of getting from the vertex before to where the path has arrived without a collision, the mean over all lanes.
    pub fn arrival(&self, wavelengths: &Wavelengths) -> f32 {
        all_lanes(self.r_u.safe_div(self.r_l), wavelengths)
    }
}

/// The mean of the lanes that paths begin with, whether or not they are followed yet: the same for paths from both ends.
pub fn all_lanes(s: Spectrum, wavelengths: &Wavelengths) -> f32 {
    if wavelengths.is_spectral() { s.mean() } else { (s[0] + s[1] + s[2]) * (1.0 / 3.0) }
}

impl Default for LaneMis {
    fn default() -> LaneMis {
        LaneMis {
            r_u: Spectrum::WHITE,
            r_l: Spectrum::WHITE,
            hero: 0,
            reach: 1.0,
            sigma_t: 1.0,
            sigma_t_from: 1.0,
        }
    }
}
