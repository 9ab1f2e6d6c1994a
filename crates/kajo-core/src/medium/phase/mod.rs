//! Phase functions: where a medium scatters light to.
//!
//! `p(wo, wi)` is a density per solid angle of `wi`, symmetric in both, and depends on the angle between the way that light
//! came and the way that it goes on alone. Following a path back from the camera it came along `-wo` and goes on along
//! `wi`, both unit vectors, so `cos = -wo · wi` is 1 for what is not turned at all.
//!
//! They are drawn by their own density exactly, so the weight of a sample is always 1.

mod draine;
mod henyey_greenstein;
mod isotropic;
mod mie;
mod rayleigh;
mod table;

use std::sync::Arc;

use kajo_math::{Frame, Vec2, Vec3, fmath};

pub use draine::Draine;
pub use henyey_greenstein::HenyeyGreenstein;
pub use mie::MiePhase;
pub use table::{PhaseAngle, PhaseTable, PhaseTableError, parse_phase_pairs};

/// A phase function.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Phase {
    /// To all sides alike.
    #[default]
    Isotropic,
    /// More forwards or more backwards.
    HenyeyGreenstein(HenyeyGreenstein),
    /// As particles do that are much smaller than the wavelength.
    Rayleigh,
    /// As droplets of water do.
    Mie(MiePhase),
    /// By numbers.
    Table(Arc<PhaseTable>),
}

/// A direction drawn by a phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseSample {
    /// Unit direction that the path goes on in.
    pub wi: Vec3,
    /// Density per solid angle, which is the value of the phase function too.
    pub pdf: f32,
}

impl Phase {
    /// The phase function and its density, per solid angle.
    ///
    /// * `wo`, `wi`: unit vectors away from the point
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.at(-wo.dot(wi))
    }

    /// The phase function for a cosine of the angle by which light is turned.
    #[inline]
    pub fn at(&self, cos: f32) -> f32 {
        match self {
            Phase::Isotropic => isotropic::VALUE,
            Phase::HenyeyGreenstein(lobe) => lobe.at(cos),
            Phase::Rayleigh => rayleigh::at(cos),
            Phase::Mie(droplets) => droplets.at(cos),
            Phase::Table(table) => table.at(cos),
        }
    }

    /// Draws a direction.
    ///
    /// * `wo`: unit vector back along the path
    /// * `u`: uniform in [0, 1)²
    #[inline]
    pub fn sample(&self, wo: Vec3, u: Vec2) -> PhaseSample {
        let cos = match self {
            Phase::Isotropic => isotropic::sample(u.x),
            Phase::HenyeyGreenstein(lobe) => lobe.sample(u.x),
            Phase::Rayleigh => rayleigh::sample(u.x),
            Phase::Mie(droplets) => droplets.sample(u.x),
            Phase::Table(table) => table.sample(u.x),
        };
        let cos = cos.clamp(-1.0, 1.0);
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (sin_phi, cos_phi) = fmath::sin_cos(std::f32::consts::TAU * u.y);
        let local = Vec3::new(sin * cos_phi, sin * sin_phi, cos);
        PhaseSample { wi: Frame::from_normal(-wo).to_world(local).normalize(), pdf: self.at(cos) }
    }

    /// The mean cosine of the angle by which light is turned.
    pub fn mean_cosine(&self) -> f32 {
        match self {
            Phase::Isotropic | Phase::Rayleigh => 0.0,
            Phase::HenyeyGreenstein(lobe) => lobe.g(),
            Phase::Mie(droplets) => droplets.mean_cosine(),
            Phase::Table(table) => table.mean_cosine(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &[(f32, f32)] =
        &[(0.0, 9.0), (5.0, 4.0), (60.0, 0.5), (130.0, 0.2), (142.0, 0.6), (180.0, 0.3)];
    const HOLES: &[(f32, f32)] = &[(0.0, 0.0), (40.0, 2.0), (80.0, 0.0), (100.0, 0.0), (180.0, 1.0)];

    fn table(pairs: &[(f32, f32)]) -> PhaseTable {
        PhaseTable::new(pairs, PhaseAngle::Degrees).unwrap()
    }

    fn droplets(diameter: f32) -> Phase {
        Phase::Mie(MiePhase::new(diameter).unwrap())
    }

    /// Simpson's rule over `t` in double precision, of cosines `1 - 2t⁴`, so that narrow lobes forwards have points enough.
    fn integral(f: impl Fn(f64) -> f64) -> f64 {
        let n = 20_000;
        let h = 1.0 / f64::from(n);
        let sum: f64 = (0..=n)
            .map(|i| {
                let weight = if i == 0 || i == n {
                    1.0
                } else if i % 2 == 1 {
                    4.0
                } else {
                    2.0
                };
                let t = h * f64::from(i);
                weight * 8.0 * t.powi(3) * f(1.0 - 2.0 * t.powi(4))
            })
            .sum();
        sum * h / 3.0
    }

    fn all() -> Vec<Phase> {
        let lobe = |g| Phase::HenyeyGreenstein(HenyeyGreenstein::new(g).unwrap());
        let mut all = vec![
            Phase::Isotropic,
            Phase::Rayleigh,
            lobe(0.0),
            lobe(1e-4),
            lobe(0.75),
            lobe(-0.5),
            lobe(0.95),
        ];
        all.extend([TABLE, HOLES].map(|pairs| Phase::Table(Arc::new(table(pairs)))));
        all
    }

    #[test]
    fn they_are_densities_with_their_mean_cosine() {
        for phase in all().into_iter().chain([5.0, 12.0, 50.0].map(droplets)) {
            // Cosines near 1 are too coarse for the narrowest lobes.
            let most = if phase.mean_cosine() > 0.85 { 1e-4 } else { 1e-5 };
            let p = |cos: f64| std::f64::consts::TAU * f64::from(phase.at(cos as f32));
            assert!((integral(p) - 1.0).abs() < most, "{phase:?}: {}", integral(p));
            let mean = integral(|cos| cos * p(cos));
            assert!((mean - f64::from(phase.mean_cosine())).abs() < most, "{phase:?}: {mean}");
        }
    }

    /// What is drawn with `u` has the share `u` of the whole before it.
    #[test]
    fn cosines_are_drawn_by_the_inverse_of_their_distribution() {
        for phase in all() {
            for i in 1..40 {
                let u = i as f32 / 40.0;
                let wi = phase.sample(Vec3::NEG_Z, Vec2::new(u, 0.3)).wi;
                let cos = f64::from(wi.z);
                let (n, mut below) = (40_000, 0.0);
                for k in 0..n {
                    let h = (cos + 1.0) / f64::from(n);
                    let middle = -1.0 + h * (f64::from(k) + 0.5);
                    below += std::f64::consts::TAU * h * f64::from(phase.at(middle as f32));
                }
                assert!((below - f64::from(u)).abs() < 1e-4, "{phase:?} {u}: {below}");
            }
        }
    }
}
