//! The thin disk of gas that a black hole accretes.
//!
//! Gas goes around on circular orbits of the equatorial plane and slowly inwards, down to the innermost orbit that is stable. What it
//! loses of energy it radiates at once, from both faces [Novikov and Thorne 1973]. With `x = sqrt(r/M)`, the spin `a` over the mass, and
//! `x₀` that of the innermost orbit, each face gives the flux [Page and Thorne 1974, eqs. 11b, 12 and 15n]
//!
//! ```text
//! F = Ṁ/(4π r) · 3/(2 M x²(x³ - 3x + 2a)) · [x - x₀ - 3/2 a ln(x/x₀) - Σᵢ 3 (xᵢ - a)²/(xᵢ (xᵢ - xⱼ)(xᵢ - xₖ)) ln((x - xᵢ)/(x₀ - xᵢ))]
//! ```
//!
//! where `xᵢ` are the roots of `x³ - 3x + 2a`. The temperature is that of a black body with this flux, `F = σ T⁴`.

use std::f64::consts::PI;

use crate::fmath::{acos64, cos64, ln64, pow64};

/// The disk around a hole of mass 1. Radii are in units of the mass, fluxes in units of the accretion rate over the square of the mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDisk {
    spin: f64,
    innermost: f64,
    /// The roots of `x³ - 3x + 2a`, and what the logarithm of each is multiplied by.
    roots: [(f64, f64); 3],
    /// Where the flux is largest, and how large.
    peak: (f64, f64),
}

/// Spins are held to this, since three roots meet at 1.
const LARGEST_SPIN: f64 = 1.0 - 1e-9;

impl ThinDisk {
    /// * `spin`: of the hole, in [-1, 1]; negative where the disk goes around against it
    pub fn new(spin: f64) -> ThinDisk {
        let a = spin.clamp(-LARGEST_SPIN, LARGEST_SPIN);
        let third = acos64(a) / 3.0;
        let x = [2.0 * cos64(third - PI / 3.0), 2.0 * cos64(third + PI / 3.0), -2.0 * cos64(third)];
        let weight = |i: usize| {
            let (xi, xj, xk) = (x[i], x[(i + 1) % 3], x[(i + 2) % 3]);
            // Without spin one root is zero, and so is its part: (x - a)² is of order a² there, x of order a.
            if xi.abs() < 1e-12 { 0.0 } else { 3.0 * (xi - a) * (xi - a) / (xi * (xi - xj) * (xi - xk)) }
        };
        let innermost = innermost_orbit(a);
        let roots = [0, 1, 2].map(|i| (x[i], weight(i)));
        let mut disk = ThinDisk { spin: a, innermost, roots, peak: (0.0, 0.0) };
        disk.peak = disk.largest_flux();
        disk
    }

    /// Radius of the innermost stable orbit.
    #[inline]
    pub fn innermost(&self) -> f64 {
        self.innermost
    }

    /// The radius at which the flux is largest, and that flux.
    #[inline]
    pub fn peak(&self) -> (f64, f64) {
        self.peak
    }

    /// Flux from one face in the frame of the gas; zero inside of the innermost stable orbit.
    pub fn flux(&self, r: f64) -> f64 {
        if r.is_nan() || r <= self.innermost {
            return 0.0;
        }
        let (x, x0, a) = (r.sqrt(), self.innermost.sqrt(), self.spin);
        let mut sum = x - x0 - 1.5 * a * ln64(x / x0);
        for (root, weight) in self.roots {
            if weight != 0.0 {
                sum -= weight * ln64((x - root) / (x0 - root));
            }
        }
        let torque = 1.5 * sum / (x * x * (x * x * x - 3.0 * x + 2.0 * a));
        (torque / (4.0 * PI * r)).max(0.0)
    }

    /// Temperature over that where the flux is largest, in [0, 1].
    pub fn relative_temperature(&self, r: f64) -> f64 {
        pow64((self.flux(r) / self.peak.1).clamp(0.0, 1.0), 0.25)
    }

    /// Energy at infinity of gas of mass 1 that goes around at a radius.
    pub fn orbital_energy(&self, r: f64) -> f64 {
        let a = self.spin / (r * r.sqrt());
        (1.0 - 2.0 / r + a) / (1.0 - 3.0 / r + 2.0 * a).sqrt()
    }

    /// The share of the mass that becomes light, as seen from far away: `1 - E` of the innermost orbit.
    pub fn efficiency(&self) -> f64 {
        1.0 - self.orbital_energy(self.innermost)
    }

    /// By bisection of an interval that the maximum is in by a golden section [Kiefer 1953].
    fn largest_flux(&self) -> (f64, f64) {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let (mut lo, mut hi) = (self.innermost, 4.0 * self.innermost);
        for _ in 0..100 {
            let [a, b] = [hi - GOLDEN * (hi - lo), lo + GOLDEN * (hi - lo)];
            if self.flux(a) < self.flux(b) { lo = a } else { hi = b }
        }
        let r = 0.5 * (lo + hi);
        (r, self.flux(r))
    }
}

/// Radius of the innermost stable circular orbit [Bardeen et al. 1972, eq. 2.21].
///
/// * `spin`: over the mass, in [-1, 1]; negative for orbits against it
pub fn innermost_orbit(spin: f64) -> f64 {
    let a2 = spin * spin;
    let cube_root = |v: f64| pow64(v.max(0.0), 1.0 / 3.0);
    let z1 = 1.0 + cube_root(1.0 - a2) * (cube_root(1.0 + spin) + cube_root(1.0 - spin));
    let z2 = (3.0 * a2 + z1 * z1).sqrt();
    let root = ((3.0 - z1) * (3.0 + z1 + 2.0 * z2)).max(0.0).sqrt();
    3.0 + z2 - if spin >= 0.0 { root } else { -root }
}

/// Radius of the circular orbit of light [Bardeen et al. 1972, eq. 2.18].
///
/// * `spin`: over the mass, in [-1, 1]; negative for orbits against it
pub fn photon_orbit(spin: f64) -> f64 {
    2.0 * (1.0 + cos64(2.0 / 3.0 * acos64(-spin.clamp(-1.0, 1.0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(found: f64, expected: f64, relative: f64) {
        assert!((found / expected - 1.0).abs() < relative, "{found} instead of {expected}");
    }

    #[test]
    fn orbits() {
        for (spin, r) in [(0.0, 6.0), (0.5, 4.233_003), (0.9, 2.320_883), (0.998, 1.236_971), (-1.0, 9.0)] {
            check(innermost_orbit(spin), r, 1e-6);
            let disk = ThinDisk::new(spin);
            check(disk.innermost(), r, 1e-6);
        }
        check(photon_orbit(0.9), 1.557_855, 1e-6);
        check(photon_orbit(-0.9), 3.910_268, 1e-6);
        check(photon_orbit(0.0), 3.0, 1e-14);
    }

    #[test]
    fn flux_without_spin() {
        let disk = ThinDisk::new(0.0);
        check(disk.peak().0, 9.551, 1e-4);
        check(disk.peak().1, 1.367_81e-5, 1e-5);
        check(disk.flux(7.0), 6.115_01e-6, 1e-5);
        check(disk.flux(20.0), 4.725_14e-6, 1e-5);
        assert_eq!([disk.flux(6.0), disk.flux(1.0), disk.flux(f64::NAN)], [0.0; 3]);
        check(disk.relative_temperature(disk.peak().0), 1.0, 1e-12);
        check(disk.efficiency(), 1.0 - (8.0f64 / 9.0).sqrt(), 1e-12);
    }

    #[test]
    fn all_that_is_lost_is_radiated() {
        // ∫ 4π r F E dr = 1 - E of the innermost orbit, for two faces [Page and Thorne 1974, eq. 15c integrated].
        for spin in [-0.9, -0.3, 0.0, 1e-6, 0.5, 0.9, 0.998] {
            let disk = ThinDisk::new(spin);
            let inner = disk.innermost();
            // With r = r₀/v² the integrand is smooth up to infinity, v = 0.
            let count = 4000;
            let integrand = |v: f64| {
                let r = inner / (v * v);
                4.0 * PI * r * disk.flux(r) * disk.orbital_energy(r) * 2.0 * r / v
            };
            let sum: f64 = (0..count).map(|i| integrand((f64::from(i) + 0.5) / f64::from(count))).sum();
            check(sum / f64::from(count), disk.efficiency(), 1e-5);
        }
    }

    #[test]
    fn flux_is_finite_for_the_fastest_hole() {
        let disk = ThinDisk::new(1.0);
        for i in 0..1000 {
            let flux = disk.flux(1.0 + 0.01 * f64::from(i));
            assert!(flux.is_finite() && flux >= 0.0, "{i}: {flux}");
        }
        assert!(disk.peak().1 > ThinDisk::new(0.9).peak().1);
    }
}
