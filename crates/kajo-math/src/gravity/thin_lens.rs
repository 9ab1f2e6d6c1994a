//! Weak gravitational lenses: masses so far from everything that all their deflection may be put into one plane.
//!
//! Light that crosses the plane of a lens at the place `x` from its middle is turned towards that by the angle
//!
//! ```text
//! point mass          α = 4 M x / (x² + s²)                             [Einstein 1916], with a core
//! isothermal sphere   α = 4π σ² x / (s + sqrt(x² + s²))                 σ: dispersion of the velocities of its stars
//! isothermal ellipse  αx = b q/f atan(f x / (ψ + s)),   αy = b q/f artanh(f y / (ψ + q² s)),
//!                     f² = 1 - q²,   ψ² = q² (s² + x²) + y²,   b = 4π σ² / sqrt(q)       [Keeton 2001, section 4.1]
//! ```
//!
//! with the longer axis along x. The mass within an area does not depend on the ratio `q` of the axes [Kormann et al. 1994].

use std::f64::consts::PI;

use glam::DVec2;

use crate::fmath::{atan64, ln64};

/// A lens in a plane; lengths are those of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// Mass of a point.
    mass: f64,
    /// The angle `b` of the ellipse.
    bending: f64,
    /// Shorter over longer axis of the ellipse, in (0, 1].
    axis_ratio: f64,
    /// `f`: its eccentricity.
    eccentricity: f64,
    core: f64,
}

impl ThinLens {
    /// A point mass and an isothermal ellipsoid with one middle.
    ///
    /// * `mass`: that of the point as a length, half its Schwarzschild radius
    /// * `dispersion`: of velocities in the ellipsoid, over the speed of light
    /// * `axis_ratio`: shorter over longer axis of the ellipse, in (0, 1]
    /// * `core`: the radius within which both are spread out
    pub fn new([mass, dispersion]: [f64; 2], axis_ratio: f64, core: f64) -> ThinLens {
        let bending = 4.0 * PI * dispersion * dispersion / axis_ratio.sqrt();
        ThinLens { mass, bending, axis_ratio, eccentricity: (1.0 - axis_ratio * axis_ratio).sqrt(), core }
    }

    /// By how much light is turned that crosses the plane at a point, in radians along both axes of the ellipse.
    pub fn deflection(&self, x: DVec2) -> DVec2 {
        self.of_point(x) + self.of_ellipse(x)
    }

    fn of_point(&self, x: DVec2) -> DVec2 {
        let square = x.length_squared() + self.core * self.core;
        // In the middle of a point all directions are alike.
        if square > 0.0 { -4.0 * self.mass / square * x } else { DVec2::ZERO }
    }

    fn of_ellipse(&self, x: DVec2) -> DVec2 {
        let ThinLens { bending: b, axis_ratio: q, eccentricity: f, core: s, .. } = *self;
        let psi = (q * q * (s * s + x.x * x.x) + x.y * x.y).sqrt();
        let [along, across] = [psi + s, psi + q * q * s];
        if b == 0.0 || along == 0.0 {
            return DVec2::ZERO;
        }
        let [u, v] = [x.x / along, x.y / across];
        if f < 1e-6 {
            return -b * DVec2::new(u, v);
        }
        let artanh = |v: f64| 0.5 * ln64((1.0 + v) / (1.0 - v));
        -b * q / f * DVec2::new(atan64(f * u), artanh(f * v))
    }

    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        [self.mass, self.bending, self.axis_ratio, self.eccentricity, self.core].iter().all(|v| v.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn galaxy(axis_ratio: f64, core: f64) -> ThinLens {
        ThinLens::new([0.0, 0.1], axis_ratio, core)
    }

    fn point(mass: f64) -> ThinLens {
        ThinLens::new([mass, 0.0], 1.0, 0.0)
    }

    /// Derivatives of both parts by both coordinates, by differences.
    fn slopes(lens: &ThinLens, x: DVec2) -> [DVec2; 2] {
        let h = 1e-5;
        [DVec2::X, DVec2::Y].map(|e| (lens.deflection(x + h * e) - lens.deflection(x - h * e)) / (2.0 * h))
    }

    fn positions() -> impl Iterator<Item = DVec2> {
        (0..200).map(|i| {
            let (angle, r) = (2.399_963 * f64::from(i), 0.2 + 0.02 * f64::from(i));
            r * DVec2::new(angle.cos(), angle.sin())
        })
    }

    /// Deflections are the gradient of a potential, whose Laplacian is twice the density of mass in units of the critical one.
    #[test]
    fn deflections_come_from_the_mass() {
        for core in [0.0, 0.3] {
            for q in [0.25, 0.6, 0.999_999_9, 1.0] {
                let lens = galaxy(q, core);
                let b = 4.0 * PI * 0.01 / q.sqrt();
                for x in positions() {
                    let [by_x, by_y] = slopes(&lens, x);
                    assert!((by_x.y - by_y.x).abs() < 1e-8, "{q} {core} {x}: {by_x} {by_y}");
                    let density = 0.5 * b / (core * core + x.x * x.x + x.y * x.y / (q * q)).sqrt();
                    let found = -0.5 * (by_x.x + by_y.y);
                    assert!((found / density - 1.0).abs() < 1e-6, "{q} {core} {x}: {found} for {density}");
                }
            }
        }
    }

    /// All mass of a point is within its core, and none is elsewhere.
    #[test]
    fn points_turn_light_by_four_masses_over_the_distance() {
        let star = point(0.02);
        assert_eq!(star.deflection(DVec2::new(0.0, 0.5)), DVec2::new(0.0, -0.16));
        assert_eq!(star.deflection(DVec2::ZERO), DVec2::ZERO);
        for x in positions() {
            let [by_x, by_y] = slopes(&star, x);
            assert!((by_x.x + by_y.y).abs() < 1e-6 && (by_x.y - by_y.x).abs() < 1e-6, "{x}");
        }
        // The Sun's limb, in kilometres: 1.75 seconds of arc.
        let seconds = point(1.476_625).deflection(DVec2::new(695_700.0, 0.0)).x.to_degrees() * 3600.0;
        assert!((seconds + 1.751_2).abs() < 1e-3, "{seconds}");
    }

    /// A sphere turns light by the same angle everywhere.
    #[test]
    fn isothermal_spheres_turn_all_light_alike() {
        let sphere = galaxy(1.0, 0.0);
        for x in positions() {
            let turned = sphere.deflection(x);
            assert!(
                (turned.length() - 4.0 * PI * 0.01).abs() < 1e-12 && turned.dot(x) < 0.0,
                "{x}: {turned}"
            );
        }
        assert_eq!(galaxy(0.6, 0.0).deflection(DVec2::ZERO), DVec2::ZERO);
    }
}
