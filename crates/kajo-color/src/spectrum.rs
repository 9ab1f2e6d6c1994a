//! The value type of radiance, reflectance and transmittance.

use std::ops::{Add, AddAssign, Index, Mul, MulAssign, Sub};

use kajo_math::{Vec3, Vec4, fmath};

/// Four lanes of radiance, or of a factor applied to it.
///
/// In RGB mode lanes 0 to 2 are linear red, green and blue and lane 3 is zero. The spare lane
/// costs nothing: four floats are one register.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spectrum(Vec4);

impl Spectrum {
    /// No light, or a factor that lets none through.
    pub const BLACK: Spectrum = Spectrum(Vec4::ZERO);

    /// The factor that changes nothing.
    pub const WHITE: Spectrum = Spectrum(Vec4::new(1.0, 1.0, 1.0, 0.0));

    /// Linear RGB.
    #[inline]
    pub const fn rgb(r: f32, g: f32, b: f32) -> Spectrum {
        Spectrum(Vec4::new(r, g, b, 0.0))
    }

    /// The same value in every lane that is in use.
    #[inline]
    pub const fn grey(v: f32) -> Spectrum {
        Spectrum::rgb(v, v, v)
    }

    /// Linear RGB of this spectrum.
    #[inline]
    pub fn to_rgb(self) -> [f32; 3] {
        [self.0.x, self.0.y, self.0.z]
    }

    /// Whether every lane is zero.
    #[inline]
    pub fn is_black(self) -> bool {
        self.0 == Vec4::ZERO
    }

    /// Whether every lane is a finite number.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    /// The length of the colour as a vector, the magnitude that the classic weight cut-off compares.
    #[inline]
    pub fn magnitude(self) -> f32 {
        self.0.length()
    }

    /// The largest lane.
    #[inline]
    pub fn max_lane(self) -> f32 {
        self.0.max_element()
    }

    /// Luminance relative to white, by the weights of Rec. 709.
    #[inline]
    pub fn luminance(self) -> f32 {
        let [r, g, b] = self.to_rgb();
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    /// `f` of every lane in use; lane 3 stays zero.
    #[inline]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Spectrum {
        Spectrum::rgb(f(self.0.x), f(self.0.y), f(self.0.z))
    }

    /// `exp` of every lane in use.
    #[inline]
    pub fn exp(self) -> Spectrum {
        self.map(fmath::exp)
    }

    /// `(1 - t) self + t other`.
    #[inline]
    pub fn lerp(self, other: Spectrum, t: f32) -> Spectrum {
        self * (1.0 - t) + other * t
    }
}

impl From<Vec3> for Spectrum {
    fn from(v: Vec3) -> Spectrum {
        Spectrum::rgb(v.x, v.y, v.z)
    }
}

impl Index<usize> for Spectrum {
    type Output = f32;
    fn index(&self, lane: usize) -> &f32 {
        &self.0[lane]
    }
}

impl Add for Spectrum {
    type Output = Spectrum;
    #[inline]
    fn add(self, other: Spectrum) -> Spectrum {
        Spectrum(self.0 + other.0)
    }
}

impl AddAssign for Spectrum {
    #[inline]
    fn add_assign(&mut self, other: Spectrum) {
        self.0 += other.0;
    }
}

impl Sub for Spectrum {
    type Output = Spectrum;
    #[inline]
    fn sub(self, other: Spectrum) -> Spectrum {
        Spectrum(self.0 - other.0)
    }
}

impl Mul for Spectrum {
    type Output = Spectrum;
    #[inline]
    fn mul(self, other: Spectrum) -> Spectrum {
        Spectrum(self.0 * other.0)
    }
}

impl MulAssign for Spectrum {
    #[inline]
    fn mul_assign(&mut self, other: Spectrum) {
        self.0 *= other.0;
    }
}

impl Mul<f32> for Spectrum {
    type Output = Spectrum;
    #[inline]
    fn mul(self, factor: f32) -> Spectrum {
        Spectrum(self.0 * factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spare_lane_stays_empty() {
        let s = Spectrum::rgb(0.2, 0.4, 0.6);
        for v in [s + s, s * Spectrum::WHITE, s.exp(), s.lerp(Spectrum::WHITE, 0.3), s * 2.0 - s] {
            assert_eq!(v[3], 0.0);
        }
        assert!((Spectrum::WHITE.luminance() - 1.0).abs() < 1e-6);
        assert_eq!(s * Spectrum::WHITE, s);
    }
}
