//! Reconstruction filters: how much a sample counts for the pixels around it.
//!
//! Every filter but the cone is the product of one profile `f` in x and y, `w(dx, dy) = f(dx) f(dy)`, where `dx` is
//! the sample's position less the pixel centre's, in pixels. The support is the half-open square
//! [-r, r)², so that a box of radius ½ is exactly the pixel. A picture is `Σ w v / Σ w`, so the scale
//! of `f` does not matter.
//!
//! * box: 1
//! * tent: `1 - |x|/r`
//! * cone: `1 - sqrt(dx² + dy²)/r`, the tent of the course programs of 2004
//! * Gaussian: `exp(-x²/2σ²)`, cut off at `r = 2σ`; the course programs of 2004 cut it off where whole pixels end
//! * Mitchell: the cubic with B = C = 1/3, its radius of 2 scaled to `r`
//!   [Mitchell and Netravali 1988, eq. 8]
//! * Lanczos: `sinc(x) sinc(x/r)` with `sinc(x) = sin(πx)/πx` [Duchon 1979]
//!
//! Mitchell and Lanczos have negative lobes: sharper edges, at the price of values outside the range
//! of the samples.
//!
//! Scene: `Settings { filter gaussian 0.5 }`

use std::f32::consts::PI;

use kajo_math::fmath;

/// A reconstruction filter; radii and `sigma` are in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// The plain average: every sample counts for the pixel it was taken for and for no other, even
    /// when the sampler put it beyond that pixel.
    None,
    /// The average of the samples in a square; radius ½ is the pixel itself.
    Box {
        /// Half the side of the square.
        radius: f32,
    },
    /// Falls linearly to zero at the radius.
    Tent {
        /// Half the side of the support.
        radius: f32,
    },
    /// Falls linearly with the distance to zero at the radius.
    Cone {
        /// Radius of the support.
        radius: f32,
    },
    /// A bell; see [`Filter::gaussian`].
    Gaussian {
        /// Standard deviation.
        sigma: f32,
        /// Half the side of the support, where the bell is cut off.
        radius: f32,
    },
    /// The cubic of Mitchell and Netravali.
    Mitchell {
        /// Half the side of the support; 2 is its natural scale.
        radius: f32,
    },
    /// The windowed sinc.
    Lanczos {
        /// Half the side of the support and width of the window; usually 2 or 3.
        radius: f32,
    },
}

impl Filter {
    /// Box of the size of the pixel.
    pub const BOX: Filter = Filter::Box { radius: 0.5 };
    /// Mitchell at its natural scale.
    pub const MITCHELL: Filter = Filter::Mitchell { radius: 2.0 };
    /// Lanczos with three lobes.
    pub const LANCZOS: Filter = Filter::Lanczos { radius: 3.0 };

    /// A Gaussian that is cut off at twice its standard deviation.
    pub const fn gaussian(sigma: f32) -> Filter {
        Filter::Gaussian { sigma, radius: 2.0 * sigma }
    }

    /// A Gaussian that weighs whole pixels, as in the course programs of 2004: the pixel itself and those which begin within
    /// twice the standard deviation of its centre, to their far borders.
    pub fn gaussian_of_whole_pixels(sigma: f32) -> Filter {
        Filter::Gaussian { sigma, radius: (2.0 * sigma - 0.5).ceil().max(0.0) + 0.5 }
    }

    /// Largest radius that a film accepts, in pixels.
    pub const LARGEST_RADIUS: f32 = 64.0;

    /// Half the side of the support in pixels, or `None` where samples count for their own pixel only.
    #[inline]
    pub fn radius(&self) -> Option<f32> {
        match *self {
            Filter::None => None,
            Filter::Box { radius }
            | Filter::Tent { radius }
            | Filter::Cone { radius }
            | Filter::Gaussian { radius, .. }
            | Filter::Mitchell { radius }
            | Filter::Lanczos { radius } => Some(radius),
        }
    }

    /// Whether the radius is a number in (0, [`Filter::LARGEST_RADIUS`]].
    pub fn is_valid(&self) -> bool {
        self.radius().is_none_or(|r| r > 0.0 && r <= Filter::LARGEST_RADIUS)
    }

    /// Weight of a sample that lies `dx` right of and `dy` below a pixel's centre, in pixels.
    ///
    /// Of magnitude at most 1. For [`Filter::None`] the weight in the sample's own pixel: 1.
    pub fn weight(&self, dx: f32, dy: f32) -> f32 {
        match *self {
            Filter::Cone { radius } => (1.0 - (dx * dx + dy * dy).sqrt() / radius).max(0.0),
            _ => self.profile(dx) * self.profile(dy),
        }
    }

    /// Whether the weight is a product of profiles.
    #[inline]
    pub fn is_separable(&self) -> bool {
        !matches!(self, Filter::Cone { .. })
    }

    /// One factor of the weight, `f(x)`; zero outside [-r, r). Of the cone it is its section.
    #[inline]
    pub fn profile(&self, x: f32) -> f32 {
        let Some(r) = self.radius() else { return 1.0 };
        if x < -r || x >= r {
            return 0.0;
        }
        match *self {
            Filter::None | Filter::Box { .. } => 1.0,
            Filter::Tent { radius } | Filter::Cone { radius } => 1.0 - x.abs() / radius,
            Filter::Gaussian { sigma, .. } => fmath::exp(-0.5 * (x / sigma) * (x / sigma)),
            Filter::Mitchell { radius } => mitchell(2.0 * x.abs() / radius),
            Filter::Lanczos { radius } => sinc(x) * sinc(x / radius),
        }
    }
}

/// The cubic with B = C = 1/3 for `x` in [0, 2]. [Mitchell and Netravali 1988, eq. 8]
#[inline]
fn mitchell(x: f32) -> f32 {
    if x < 1.0 {
        ((7.0 * x - 12.0) * x * x + 16.0 / 3.0) / 6.0
    } else {
        (((-7.0 / 3.0 * x + 12.0) * x - 20.0) * x + 32.0 / 3.0) / 6.0
    }
}

#[inline]
fn sinc(x: f32) -> f32 {
    let angle = PI * x;
    // Below this the series 1 - angle²/6 is 1 to the last bit.
    if angle.abs() < 1e-4 { 1.0 } else { fmath::sin(angle) / angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Filter; 9] = [
        Filter::Cone { radius: 1.5 },
        Filter::None,
        Filter::BOX,
        Filter::Box { radius: 1.3 },
        Filter::Tent { radius: 1.0 },
        Filter::gaussian(0.5),
        Filter::Gaussian { sigma: 0.4, radius: 1.5 },
        Filter::MITCHELL,
        Filter::LANCZOS,
    ];

    #[test]
    fn values_by_hand() {
        let close = |a: f32, b: f32| assert!((a - b).abs() < 1e-6, "{a} is not {b}");
        close(Filter::Tent { radius: 2.0 }.weight(0.5, -1.0), 0.375);
        close(Filter::gaussian(0.5).weight(0.5, 0.5), 0.367_879_44);
        // A pixel begins half a pixel before its middle: within 0.8 the first, within 1.6 the second, within 0.5 none.
        for (sigma, radius) in [(0.4, 1.5), (0.8, 2.5), (0.25, 0.5), (0.1, 0.5), (1.0, 2.5)] {
            assert_eq!(Filter::gaussian_of_whole_pixels(sigma), Filter::Gaussian { sigma, radius });
        }
        close(Filter::Cone { radius: 2.0 }.weight(0.6, -0.8), 0.5);
        close(Filter::Cone { radius: 1.0 }.weight(0.8, 0.8), 0.0);
        // Mitchell: 8/9 at 0, 1/18 at 1 and 0 at 2, with slopes that meet.
        close(Filter::MITCHELL.profile(0.0), 8.0 / 9.0);
        close(Filter::MITCHELL.profile(1.0), 1.0 / 18.0);
        close(Filter::MITCHELL.profile(-1.999_999), 0.0);
        close(Filter::Mitchell { radius: 4.0 }.profile(2.0), 1.0 / 18.0);
        // Lanczos 3 at ½: sin(π/2)/(π/2) · sin(π/6)/(π/6).
        close(Filter::LANCZOS.profile(0.5), 0.607_927_1);
        close(Filter::LANCZOS.profile(1.0), 0.0);
        close(Filter::LANCZOS.profile(0.0), 1.0);
    }

    #[test]
    fn the_support_is_half_open_and_even_inside() {
        for filter in ALL {
            let Some(r) = filter.radius() else { continue };
            assert_eq!(filter.profile(r), 0.0, "{filter:?}");
            assert_eq!(filter.profile((-r).next_down()), 0.0);
            assert_eq!(filter.weight(0.0, r), 0.0);
            for i in 0..100 {
                let x = r * (i as f32 + 0.5) / 100.0;
                assert_eq!(filter.profile(x), filter.profile(-x));
                assert!(filter.profile(x).abs() <= 1.0);
            }
        }
        assert_eq!(Filter::BOX.profile(-0.5), 1.0);
        assert_eq!(Filter::gaussian(0.5).profile(0.999_999), fmath::exp(-2.0 * 0.999_998));
    }

    #[test]
    fn mitchell_is_a_partition_of_unity() {
        for i in 0..=20 {
            let x = i as f32 / 20.0;
            let sum: f32 = (-2..=2).map(|k| Filter::MITCHELL.profile(x - k as f32)).sum();
            assert!((sum - 1.0).abs() < 1e-6, "{sum} at {x}");
        }
    }

    #[test]
    fn radii_that_make_no_sense_are_not_valid() {
        for filter in ALL {
            assert!(filter.is_valid(), "{filter:?}");
        }
        for radius in [0.0, -1.0, 64.1, f32::NAN, f32::INFINITY] {
            assert!(!Filter::Box { radius }.is_valid(), "{radius}");
            assert!(!Filter::gaussian(radius).is_valid(), "{radius}");
        }
    }
}
