//! Phase functions: where a medium scatters light to.
//!
//! `p(wo, wi)` is a density per solid angle of `wi`, symmetric in both, and depends on the angle between the way that light
//! came and the way that it goes on alone. Following a path back from the camera it came along `-wo` and goes on along
//! `wi`, both unit vectors, so `cos = -wo · wi` is 1 for what is not turned at all.
//!
//! They are drawn by their own density exactly. Where they are alike for all wavelengths the weight of a sample is therefore
//! always 1; where they are not, one lane of a path draws, and the others have other densities, which [`PhaseValue`] tells.

mod color_table;
mod draine;
mod henyey_greenstein;
mod isotropic;
mod mie;
mod rayleigh;
mod rows;
mod table;

use std::sync::Arc;

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::{Frame, Vec2, Vec3, fmath};

pub use color_table::ColorPhaseTable;
pub use draine::Draine;
pub use henyey_greenstein::HenyeyGreenstein;
pub use mie::MiePhase;
pub use rows::{PhaseRows, PhaseTableError};
pub use table::{PhaseAngle, PhaseTable};

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
    /// By numbers that differ between colours or wavelengths.
    ColorTable(Arc<ColorPhaseTable>),
}

/// A phase function at the wavelengths of a path.
#[derive(Clone, Copy, Debug)]
pub struct PhaseAtWavelengths<'a> {
    phase: &'a Phase,
    /// In nm; all zero where lanes are red, green and blue.
    nm: [f32; 4],
}

/// The value of a phase function for one angle, per solid angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseValue {
    /// The mean over the lanes that paths begin with, whether or not they are followed yet: a density that paths from both ends agree on.
    pub pdf: f32,
    /// Value and density of each lane over that; `None` where all are the same.
    pub colors: Option<Spectrum>,
}

impl PhaseValue {
    /// Of values by lanes.
    ///
    /// * `mean`: over the lanes that paths begin with
    #[inline]
    fn by_lanes(lanes: Spectrum, mean: f32) -> PhaseValue {
        PhaseValue { pdf: mean, colors: (mean > 0.0).then(|| lanes * (1.0 / mean)) }
    }

    /// The value by lanes.
    #[inline]
    pub fn value(&self) -> Spectrum {
        self.colors.map_or(Spectrum::grey(self.pdf), |colors| colors * self.pdf)
    }
}

/// A direction drawn by a phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseSample {
    /// Unit direction that the path goes on in.
    pub wi: Vec3,
    /// The phase function there. The direction was drawn with the value of the lane that drew.
    pub value: PhaseValue,
}

impl Phase {
    /// By numbers: one table where all columns are alike, however many there are.
    ///
    /// * `columns`: what they are, as many as `rows` have
    ///
    /// # Errors
    /// [`PhaseTableError`].
    pub fn by_numbers(
        columns: &PhaseColumns,
        rows: &PhaseRows,
        angle: PhaseAngle,
    ) -> Result<Phase, PhaseTableError> {
        let table = match columns {
            PhaseColumns::One => return Ok(Phase::Table(Arc::new(PhaseTable::new(&rows.column(0), angle)?))),
            PhaseColumns::Rgb => ColorPhaseTable::of_colors(rows, angle)?,
            PhaseColumns::Wavelengths(nm) => ColorPhaseTable::by_wavelength(nm, rows, angle)?,
        };
        Ok(match table.alike() {
            Some(alike) => Phase::Table(Arc::new(alike.clone())),
            None => Phase::ColorTable(Arc::new(table)),
        })
    }

    /// The phase function at the wavelengths of a path.
    #[inline]
    pub fn at(&self, wavelengths: &Wavelengths) -> PhaseAtWavelengths<'_> {
        PhaseAtWavelengths { phase: self, nm: wavelengths.nm().unwrap_or_default() }
    }

    /// The mean cosine of the angle by which light is turned; over red, green and blue where these differ.
    pub fn mean_cosine(&self) -> f32 {
        match self {
            Phase::Isotropic | Phase::Rayleigh => 0.0,
            Phase::HenyeyGreenstein(lobe) => lobe.g(),
            Phase::Mie(droplets) => droplets.mean_cosine(),
            Phase::Table(table) => table.mean_cosine(),
            Phase::ColorTable(table) => table.mean_cosine(),
        }
    }
}

/// What the values of a row are.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum PhaseColumns {
    /// One value for all wavelengths.
    #[default]
    One,
    /// Red, green and blue.
    Rgb,
    /// One for each of these wavelengths in nm.
    Wavelengths(Vec<f32>),
}

impl PhaseColumns {
    /// Values in a row.
    pub fn count(&self) -> usize {
        match self {
            PhaseColumns::One => 1,
            PhaseColumns::Rgb => 3,
            PhaseColumns::Wavelengths(nm) => nm.len(),
        }
    }
}

impl PhaseAtWavelengths<'_> {
    /// The phase function and its density, per solid angle.
    ///
    /// * `wo`, `wi`: unit vectors away from the point
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> PhaseValue {
        self.at(-wo.dot(wi))
    }

    /// The phase function for a cosine of the angle by which light is turned.
    #[inline]
    pub fn at(&self, cos: f32) -> PhaseValue {
        let pdf = match self.phase {
            Phase::Isotropic => isotropic::VALUE,
            Phase::HenyeyGreenstein(lobe) => lobe.at(cos),
            Phase::Rayleigh => rayleigh::at(cos),
            Phase::Mie(droplets) => droplets.at(cos),
            Phase::Table(table) => table.at(cos),
            Phase::ColorTable(table) => return self.by_lanes(table.at(cos, self.nm)),
        };
        PhaseValue { pdf, colors: None }
    }

    fn by_lanes(&self, lanes: Spectrum) -> PhaseValue {
        let rgb = || (lanes[0] + lanes[1] + lanes[2]) * (1.0 / 3.0);
        PhaseValue::by_lanes(lanes, if self.nm[0] == 0.0 { rgb() } else { lanes.mean() })
    }

    /// Draws a direction.
    ///
    /// * `wo`: unit vector back along the path
    /// * `u`: uniform in [0, 1)²
    /// * `hero`: the lane that draws, less than 4; less than 3 where lanes are red, green and blue
    #[inline]
    pub fn sample(&self, wo: Vec3, u: Vec2, hero: u32) -> PhaseSample {
        let cos = match self.phase {
            Phase::Isotropic => isotropic::sample(u.x),
            Phase::HenyeyGreenstein(lobe) => lobe.sample(u.x),
            Phase::Rayleigh => rayleigh::sample(u.x),
            Phase::Mie(droplets) => droplets.sample(u.x),
            Phase::Table(table) => table.sample(u.x),
            Phase::ColorTable(table) => table.sample(u.x, self.nm, hero as usize),
        };
        let cos = cos.clamp(-1.0, 1.0);
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (sin_phi, cos_phi) = fmath::sin_cos(std::f32::consts::TAU * u.y);
        let local = Vec3::new(sin * cos_phi, sin * sin_phi, cos);
        PhaseSample { wi: Frame::from_normal(-wo).to_world(local).normalize(), value: self.at(cos) }
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
            let p =
                |cos: f64| std::f64::consts::TAU * f64::from(phase.at(&Wavelengths::RGB).at(cos as f32).pdf);
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
                let phase = phase.at(&Wavelengths::RGB);
                let wi = phase.sample(Vec3::NEG_Z, Vec2::new(u, 0.3), 0).wi;
                let cos = f64::from(wi.z);
                let (n, mut below) = (40_000, 0.0);
                for k in 0..n {
                    let h = (cos + 1.0) / f64::from(n);
                    let middle = -1.0 + h * (f64::from(k) + 0.5);
                    below += std::f64::consts::TAU * h * f64::from(phase.at(middle as f32).pdf);
                }
                assert!((below - f64::from(u)).abs() < 1e-4, "{phase:?} {u}: {below}");
            }
        }
    }
}
