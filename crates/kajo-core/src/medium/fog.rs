//! Fog that hides what is far away.
//!
//! Over a length with optical depth `tau` the light `L` from behind becomes
//!
//! ```text
//! T L + (1 - T) C,    T = exp(-tau),
//! ```
//!
//! exact for fog that emits the constant colour `C`. Even fog has `tau = density * length`.
//! Fog that thins with height, `density * exp(-k (y - h0))`, has along `o + s w`, `w` a unit vector,
//!
//! ```text
//! tau = density exp(-k (o.y - h0)) (1 - exp(-k w.y s)) / (k w.y)
//!     = density exp(-k (h - h0)) (1 - exp(-x)) / |k w.y|,    x = |k w.y s|,
//! ```
//!
//! where `h` is the height of the lower end: seen from far above, the first form is a tiny number times a huge one.
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
    ///
    /// As exact as the heights of the ends, which are rounded: off by a few 1e-7 of itself times 1 and the largest exponent.
    pub fn optical_depth(&self, o: Vec3, w: Vec3, length: f32) -> f32 {
        if self.density == 0.0 {
            return 0.0;
        }
        let rate = self.falloff * w.y;
        let (here, thinner) = (-self.falloff * (o.y - self.height), rate * length);
        if rate == 0.0 {
            return self.density * fmath::exp(here) * length;
        }
        let thickest = self.density * fmath::exp(here.max(here - thinner));
        thickest * -fmath::exp_m1(-thinner.abs()) / rate.abs()
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::{Vec2, rng::Stream, warp};

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
        assert_eq!(
            fog.optical_depth(Vec3::ZERO, Vec3::X, f32::INFINITY),
            f32::INFINITY,
            "level there is none"
        );
    }

    /// Random fog against the first form in double precision, from heights where fog is as good as gone and down to where it
    /// is thick.
    #[test]
    fn depths_are_as_exact_as_heights() {
        for i in 0..1 << 18 {
            let number = Stream::new(16, [i, 0], 0);
            let [falloff, height, y, length] = [0, 1, 2, 3].map(|k| 2.0 * number.uniform(k));
            let (o, length) = (Vec3::new(0.0, 100.0 * y - 20.0, 0.0), 3.0 * length.powi(4));
            let w = warp::uniform_sphere(Vec2::new(number.uniform(4), number.uniform(5)));
            let fog = Fog { color: Spectrum::WHITE, density: 0.2, falloff: falloff + 1e-3, height };
            let [k, above, down, s] = [fog.falloff, o.y - fog.height, w.y, length].map(f64::from);
            let exact =
                f64::from(fog.density) * (-k * above).exp() * -fmath::exp_m1_64(-k * down * s) / (k * down);
            let [found, exact] =
                [fog.optical_depth(o, w, length).into(), exact].map(|depth: f64| depth.min(1e30));
            let exponent = 1.0 + (k * above).abs().max((k * down * s).abs());
            let bound = 4e-7 * exponent * exact + f64::from(f32::MIN_POSITIVE);
            assert!((found - exact).abs() < bound, "{fog:?} {o} {w} {length}: {found} {exact}");
        }
    }
}
