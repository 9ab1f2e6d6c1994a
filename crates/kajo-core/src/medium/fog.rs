//! Fog that hides what is far away.
//!
//! Over a length with optical depth `tau` the light `L` from behind becomes
//!
//! ```text
//! T L + (1 - T) C,    T = exp(-tau),
//! ```
//!
//! exact for fog that glows with the constant colour `C`. Even fog has `tau = density * length`.
//! Fog that thins with height, `density * exp(-k (y - h0))`, has along `o + s w`, `w` a unit vector,
//!
//! ```text
//! tau = density exp(-k (o.y - h0)) (1 - exp(-k w.y s)) / (k w.y).
//! ```
//!
//! Scene: `Fog { color 0.7 0.8 0.9  density 0.05  heightFalloff 0.5  height 0 }`

use kajo_color::Spectrum;
use kajo_math::{Vec3, fmath};

/// Fog throughout the scene.
#[derive(Clone, Copy, Debug)]
pub struct Fog {
    /// Colour of infinitely thick fog.
    pub color: Spectrum,
    /// Optical depth per unit length, at height `height` when it varies.
    pub density: f32,
    /// `k`: how fast the fog thins with height, per unit; zero for even fog.
    pub falloff: f32,
    /// `h0`: the y coordinate at which the density is `density`.
    pub height: f32,
}

impl Fog {
    /// Light that leaves a stretch of fog at `o`, when `behind` enters at the far end.
    ///
    /// * `w`: unit direction of view
    /// * `length`: world-space length of the stretch, possibly infinite
    pub fn seen_through(&self, behind: Spectrum, o: Vec3, w: Vec3, length: f32) -> Spectrum {
        self.color.lerp(behind, self.transmittance(o, w, length))
    }

    /// `T`: the share of the light from behind a stretch that gets through.
    pub fn transmittance(&self, o: Vec3, w: Vec3, length: f32) -> f32 {
        fmath::exp(-self.optical_depth(o, w, length))
    }

    /// Integral of the density along a stretch; may be infinite.
    pub fn optical_depth(&self, o: Vec3, w: Vec3, length: f32) -> f32 {
        if self.density == 0.0 {
            return 0.0;
        }
        if self.falloff == 0.0 {
            return self.density * length;
        }
        let here =
            f64::from(self.density) * fmath::exp64(-f64::from(self.falloff) * f64::from(o.y - self.height));
        let rate = f64::from(self.falloff) * f64::from(w.y);
        let length = f64::from(length);
        // (1 - exp(-rate length)) / rate, which tends to `length` for level rays.
        let stretch =
            if (rate * length).abs() < 1e-9 { length } else { -fmath::exp_m1_64(-rate * length) / rate };
        (here * stretch).max(0.0) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_fog_is_exponential_and_hides_the_sky() {
        let fog = Fog { color: Spectrum::grey(0.5), density: 0.3, falloff: 0.0, height: 0.0 };
        let seen = fog.seen_through(Spectrum::WHITE, Vec3::ZERO, Vec3::X, 2.0);
        let t = (-0.6f64).exp();
        assert!((f64::from(seen[0]) - (t + (1.0 - t) * 0.5)).abs() < 1e-6);
        assert_eq!(fog.seen_through(Spectrum::WHITE, Vec3::ZERO, Vec3::X, f32::INFINITY), fog.color);
    }

    /// The closed form against the midpoint rule.
    #[test]
    fn height_fog_integrates_its_density() {
        let fog = Fog { color: Spectrum::WHITE, density: 0.2, falloff: 0.7, height: 1.0 };
        for w in [Vec3::X, Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.0, -0.8, 0.6), Vec3::new(1.0, 1e-7, 0.0)] {
            let (o, length, steps) = (Vec3::new(0.3, 2.0, -1.0), 3.0, 100_000);
            let ds = f64::from(length) / f64::from(steps);
            let density = |i: u32| {
                let y = 2.0 + (f64::from(i) + 0.5) * ds * f64::from(w.y);
                0.2 * (-0.7 * (y - 1.0)).exp()
            };
            let expected: f64 = (0..steps).map(density).sum::<f64>() * ds;
            let got = f64::from(fog.optical_depth(o, w, length));
            assert!((got / expected - 1.0).abs() < 1e-6, "{w}: {got} {expected}");
        }
        let up = fog.optical_depth(Vec3::ZERO, Vec3::Y, f32::INFINITY);
        assert!((f64::from(up) - 0.2 * 0.7f64.exp() / 0.7).abs() < 1e-6, "looking up there is an end to it");
        assert_eq!(fog.optical_depth(Vec3::ZERO, Vec3::NEG_Y, f32::INFINITY), f32::INFINITY);
    }
}
