//! The value type of radiance, reflectance and transmittance.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Sub};

use kajo_math::{Vec3, Vec4, fmath};

/// Four lanes of radiance, or of a factor applied to it.
///
/// In spectral mode the lanes belong to the four wavelengths of a [`Wavelengths`](crate::Wavelengths).
/// In RGB mode lanes 0 to 2 are linear red, green and blue. Lane 3 of radiance and of colours is zero
/// there, so products stay harmless; a pure factor, [`grey`](Spectrum::grey) or the result of
/// [`exp`](Spectrum::exp), fills all four lanes in either mode. Code that compares or averages lanes of a
/// factor that may be pure takes the number of lanes in use from `Wavelengths`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spectrum(Vec4);

impl Spectrum {
    /// No light, or a factor that lets none through.
    pub const BLACK: Spectrum = Spectrum(Vec4::ZERO);

    /// The factor that changes nothing.
    pub const WHITE: Spectrum = Spectrum(Vec4::ONE);

    /// Linear RGB, of the primaries of sRGB; lane 3 is zero.
    #[inline]
    pub const fn rgb(r: f32, g: f32, b: f32) -> Spectrum {
        Spectrum(Vec4::new(r, g, b, 0.0))
    }

    /// The same value in every lane: a factor that does not depend on wavelength.
    #[inline]
    pub const fn grey(v: f32) -> Spectrum {
        Spectrum(Vec4::splat(v))
    }

    /// Lanes 0 to 2: the colour in RGB mode. [`sensor::to_rgb`](crate::sensor::to_rgb) is right in both.
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

    /// The length of an RGB colour as a vector, the magnitude that the classic weight cut-off compares.
    #[inline]
    pub fn magnitude(self) -> f32 {
        self.0.truncate().length()
    }

    /// The largest of the four lanes.
    #[inline]
    pub fn max_lane(self) -> f32 {
        self.0.max_element()
    }

    /// The mean of the four lanes.
    #[inline]
    pub fn mean(self) -> f32 {
        0.25 * ((self.0.x + self.0.y) + (self.0.z + self.0.w))
    }

    /// Luminance of an RGB colour relative to white, by the weights of Rec. 709.
    #[inline]
    pub fn luminance(self) -> f32 {
        let [r, g, b] = self.to_rgb();
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    /// `f` of every lane.
    #[inline]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Spectrum {
        Spectrum(Vec4::new(f(self.0.x), f(self.0.y), f(self.0.z), f(self.0.w)))
    }

    /// `exp` of every lane.
    #[inline]
    pub fn exp(self) -> Spectrum {
        self.map(fmath::exp)
    }

    /// Square root of every lane.
    #[inline]
    pub fn sqrt(self) -> Spectrum {
        Spectrum(self.0.sqrt())
    }

    /// Every lane held between `low` and `high`.
    #[inline]
    pub fn clamp(self, low: f32, high: f32) -> Spectrum {
        Spectrum(self.0.clamp(Vec4::splat(low), Vec4::splat(high)))
    }

    /// The lanes of `self` over those of `divisor`, and zero where `divisor` is zero.
    #[inline]
    pub fn safe_div(self, divisor: Spectrum) -> Spectrum {
        Spectrum(Vec4::select(divisor.0.cmpeq(Vec4::ZERO), Vec4::ZERO, self.0 / divisor.0))
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

impl From<Vec4> for Spectrum {
    #[inline]
    fn from(lanes: Vec4) -> Spectrum {
        Spectrum(lanes)
    }
}

impl From<[f32; 4]> for Spectrum {
    #[inline]
    fn from(lanes: [f32; 4]) -> Spectrum {
        Spectrum(Vec4::from_array(lanes))
    }
}

impl From<Spectrum> for [f32; 4] {
    #[inline]
    fn from(s: Spectrum) -> [f32; 4] {
        s.0.to_array()
    }
}

impl Index<usize> for Spectrum {
    type Output = f32;
    #[inline]
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

impl Sum for Spectrum {
    fn sum<I: Iterator<Item = Spectrum>>(terms: I) -> Spectrum {
        terms.fold(Spectrum::BLACK, Add::add)
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

impl MulAssign<f32> for Spectrum {
    #[inline]
    fn mul_assign(&mut self, factor: f32) {
        self.0 *= factor;
    }
}

impl Div for Spectrum {
    type Output = Spectrum;
    #[inline]
    fn div(self, other: Spectrum) -> Spectrum {
        Spectrum(self.0 / other.0)
    }
}

impl Div<f32> for Spectrum {
    type Output = Spectrum;
    #[inline]
    fn div(self, divisor: f32) -> Spectrum {
        Spectrum(self.0 / divisor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_colour_keeps_its_spare_lane_empty() {
        let s = Spectrum::rgb(0.2, 0.4, 0.6);
        let absorbed = s * Spectrum::rgb(-1.0, 0.0, -3.0).exp();
        for v in [s + s, s * Spectrum::WHITE, absorbed, s.lerp(s * 0.5, 0.3), s * 2.0 - s, s.sqrt()] {
            assert_eq!(v[3], 0.0);
        }
        assert!((Spectrum::WHITE.luminance() - 1.0).abs() < 1e-6);
        assert_eq!(s * Spectrum::WHITE, s);
    }

    #[test]
    fn a_factor_fills_all_lanes() {
        assert_eq!(<[f32; 4]>::from(Spectrum::grey(0.25)), [0.25; 4]);
        assert_eq!(Spectrum::from([4.0, 1.0, 9.0, 16.0]).sqrt(), Spectrum::from([2.0, 1.0, 3.0, 4.0]));
        assert_eq!(Spectrum::BLACK.exp(), Spectrum::WHITE);
        assert_eq!(Spectrum::from([1.0, 2.0, 3.0, 6.0]).mean(), 3.0);
        assert_eq!(Spectrum::from([1.0, 2.0, 3.0, 6.0]).max_lane(), 6.0);
        assert_eq!(
            Spectrum::from([-1.0, 0.5, 3.0, 1.0]).clamp(0.0, 1.0),
            Spectrum::from([0.0, 0.5, 1.0, 1.0])
        );
    }

    #[test]
    fn the_classic_magnitude_is_that_of_a_vector_of_three() {
        assert_eq!(Spectrum::rgb(2.0, 3.0, 6.0).magnitude(), 7.0);
        assert_eq!(Spectrum::WHITE.magnitude(), 3.0f32.sqrt());
    }

    #[test]
    fn zero_over_zero_is_zero() {
        let s = Spectrum::from([1.0, 0.0, 3.0, 4.0]).safe_div(Spectrum::from([2.0, 0.0, 0.0, -2.0]));
        assert_eq!(s, Spectrum::from([0.5, 0.0, 0.0, -2.0]));
        let terms = [Spectrum::grey(1.0), Spectrum::grey(2.0)];
        assert_eq!(terms.into_iter().sum::<Spectrum>() / 2.0, Spectrum::grey(1.5));
    }
}
