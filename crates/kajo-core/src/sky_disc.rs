//! A disc in the sky: all directions within an angle `r` around one.
//!
//! ```text
//! solid angle            2 pi h,   h = 1 - cos r
//! projected on its middle     pi sin^2 r = pi h (2 - h)
//! ```

use std::f32::consts::PI;

use kajo_math::{Frame, Vec2, Vec3, warp};

/// A disc in the sky.
#[derive(Clone, Copy, Debug)]
pub struct SkyDisc {
    /// Unit direction to its middle.
    pub middle: Vec3,
    /// `1 - cos r` of its angular radius `r`, in (0, 1].
    pub height: f32,
}

impl SkyDisc {
    /// In steradians.
    #[inline]
    pub fn solid_angle(&self) -> f32 {
        2.0 * PI * self.height
    }

    /// Irradiance of unit radiance on a surface across the middle.
    #[inline]
    pub fn projected_solid_angle(&self) -> f32 {
        PI * self.sin2()
    }

    /// Density per solid angle with which [`SkyDisc::draw`] draws the direction `d`.
    #[inline]
    pub fn pdf(&self, d: Vec3) -> f32 {
        if self.covers(d) { self.solid_angle().recip() } else { 0.0 }
    }

    /// A unit direction uniform over the disc.
    ///
    /// * `u`: uniform in [0, 1)²
    #[inline]
    pub fn draw(&self, u: Vec2) -> Vec3 {
        Frame::from_normal(self.middle).to_world(warp::uniform_cone(u, self.height)).normalize()
    }

    /// Whether it covers the direction `d`, not necessarily of unit length.
    #[inline]
    pub fn covers(&self, d: Vec3) -> bool {
        // By the sine, since the cosine of a small angle has lost its digits.
        d.dot(self.middle) > 0.0 && d.cross(self.middle).length_squared() <= self.sin2() * d.length_squared()
    }

    fn sin2(&self) -> f32 {
        self.height * (2.0 - self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::rng::Stream;

    #[test]
    fn drawn_directions_are_covered_and_fill_the_disc() {
        for height in [1e-10, 1e-5, 0.1, 1.0] {
            let disc = SkyDisc { middle: Vec3::new(0.48, -0.6, 0.64), height };
            let (mut inner, mut rim, n) = (0, 0, 10_000);
            let half = SkyDisc { height: 0.5 * height, ..disc };
            for i in 0..n {
                let s = Stream::new(9, [i, 0], 0);
                let d = disc.draw(Vec2::new(s.uniform(0), s.uniform(1)));
                // On the rim rounding decides.
                rim += u32::from(!disc.covers(d));
                inner += u32::from(half.covers(3.0 * d));
            }
            assert!(
                rim < n / 100 && (f64::from(inner) / f64::from(n) - 0.5).abs() < 0.02,
                "{height}: {rim} {inner}"
            );
            assert!(!disc.covers(-disc.middle) && disc.covers(disc.middle));
            assert_eq!((disc.pdf(disc.middle), disc.pdf(-disc.middle)), (1.0 / disc.solid_angle(), 0.0));
        }
    }
}
