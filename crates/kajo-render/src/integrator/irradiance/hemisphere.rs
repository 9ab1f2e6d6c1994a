//! The hemisphere over a point in strata of equal weight, and what its samples say of the irradiance there.
//!
//! With `M` rings and `N` azimuths, sample `(j, k)` has a uniform position `(u, v)` of its own stratum and the direction
//!
//! ```text
//! sin^2 theta = (j + u) / M,     phi = 2 pi (k + v) / N
//! ```
//!
//! so its density is `cos theta / pi`, and with the radiance `L` from there
//!
//! ```text
//! E = pi/(M N) sum of L                                                        [Ward and Heckbert 1992, eq. 3]
//! ```
//!
//! Directions are in the local frame whose z axis is the normal.

use std::f64::consts::{PI, TAU};

use kajo_math::fmath::{asin64, sincos64};
use kajo_math::{DVec2, DVec3};

/// Which strata the hemisphere is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strata {
    /// From the normal to the horizon.
    pub rings: usize,
    /// Around the normal.
    pub azimuths: usize,
}

/// What a ray into one stratum found.
#[derive(Clone, Copy, Debug)]
pub struct RayResult {
    /// Unit direction, local.
    pub d: DVec3,
    /// Linear RGB.
    pub radiance: [f64; 3],
    /// One over the distance of what the light comes from; 0 for the sky.
    pub inverse_distance: f64,
}

/// What the irradiance of a point is, and how it changes where the point moves within its plane or its normal turns.
#[derive(Clone, Copy, Debug, Default)]
pub struct Derivatives {
    /// Of each channel by the position, in the tangent plane.
    pub gradient: [DVec2; 3],
    /// Of the mean of the channels by the position: `xx`, `xy`, `yy`.
    pub hessian: [f64; 3],
}

/// The samples of a hemisphere, ring by ring.
pub struct Hemisphere {
    pub strata: Strata,
    pub rays: Vec<RayResult>,
}

impl Strata {
    /// About as wide as high [Ward and Heckbert 1992]: `N` is `pi M`.
    ///
    /// * `rays`: the most samples there may be
    pub fn of(rays: u32) -> Strata {
        let rings = ((f64::from(rays) / PI).sqrt() as usize).max(1);
        Strata { rings, azimuths: (rays as usize / rings).max(3) }
    }

    /// Samples of a hemisphere.
    pub fn len(self) -> usize {
        self.rings * self.azimuths
    }

    /// The direction of a sample.
    ///
    /// * `i`: number of the stratum, ring by ring from the normal on
    /// * `u`: position in it, in [0, 1)²
    pub fn direction(self, i: usize, u: [f64; 2]) -> DVec3 {
        let (j, k) = (i / self.azimuths, i % self.azimuths);
        let sin2 = ((j as f64 + u[0]) / self.rings as f64).min(1.0);
        let (sin, cos) = sincos64(TAU * (k as f64 + u[1]) / self.azimuths as f64);
        let r = sin2.sqrt();
        DVec3::new(r * cos, r * sin, (1.0 - sin2).sqrt())
    }

    /// `cos^2 theta` of the border between ring `j - 1` and ring `j`.
    fn border(self, j: usize) -> f64 {
        1.0 - j as f64 / self.rings as f64
    }
}

/// The smaller of two differences, if they have one sign; else 0 [Roe 1986].
fn minmod(a: f64, b: f64) -> f64 {
    if a * b <= 0.0 {
        return 0.0;
    }
    if a.abs() < b.abs() { a } else { b }
}

impl Hemisphere {
    /// The sample of ring `j` at azimuth `k`, counted around as often as one likes.
    pub fn at(&self, j: usize, k: usize) -> &RayResult {
        &self.rays[j * self.strata.azimuths + k % self.strata.azimuths]
    }

    /// One over the distance at the border of a sample's cell.
    ///
    /// Of a plane the inverse distance is linear in the direction, so it is continued by the smaller of the differences from both
    /// neighbours, as far as they have one sign.
    ///
    /// * `towards`: 1 for the border to the horizon, -1 for that to the normal and 0 for the middle; the same for higher and
    ///   lower azimuths
    pub fn continued(&self, j: usize, k: usize, towards: [f64; 2]) -> f64 {
        let Strata { rings, azimuths } = self.strata;
        let v = |j: usize, k: usize| self.at(j, k).inverse_distance;
        let here = v(j, k);
        let by_ring =
            if j == 0 || j + 1 == rings { 0.0 } else { minmod(here - v(j - 1, k), v(j + 1, k) - here) };
        let by_azimuth = minmod(here - v(j, k + azimuths - 1), v(j, k + 1) - here);
        here + 0.5 * (towards[0] * by_ring + towards[1] * by_azimuth)
    }

    /// What a sample counts in `E`: `pi / (M N)` for directions drawn in proportion to the cosine [Ward and Heckbert 1992, eq. 3].
    fn weight(&self) -> f64 {
        PI / self.strata.len() as f64
    }

    /// `E`.
    pub fn irradiance(&self) -> [f64; 3] {
        let sum = self.rays.iter().fold([0.0; 3], |sum, ray| [0, 1, 2].map(|i| sum[i] + ray.radiance[i]));
        sum.map(|sum| sum * self.weight())
    }

    /// The harmonic mean of the distances, infinite under an empty sky.
    pub fn mean_distance(&self) -> f64 {
        let sum: f64 = self.rays.iter().map(|ray| ray.inverse_distance).sum();
        self.rays.len() as f64 / sum
    }

    /// How the irradiance changes with the normal: a turned normal `n'` has the irradiance `E + n'·gradient`, to first order.
    ///
    /// ```text
    /// dE/dn = sum over j, k of  L_jk  2pi/N (cos phi_k, sin phi_k)  integral over ring j of sin^2 theta dtheta
    /// ```
    ///
    /// as [Ward and Heckbert 1992, eq. 4] with the integral in place of `tan theta` of the sample, which has no bound at the horizon.
    pub fn rotational_gradient(&self) -> [DVec2; 3] {
        let Strata { rings, azimuths } = self.strata;
        let step = TAU / azimuths as f64;
        let antiderivative = |j: usize| {
            let cos2 = self.strata.border(j);
            let (sin, cos) = ((1.0 - cos2).max(0.0).sqrt(), cos2.max(0.0).sqrt());
            0.5 * (asin64(sin.min(1.0)) - sin * cos)
        };
        let mut sum = [DVec2::ZERO; 3];
        for j in 0..rings {
            let factor = step * (antiderivative(j + 1) - antiderivative(j));
            for k in 0..azimuths {
                let (sin, cos) = sincos64(step * (k as f64 + 0.5));
                let towards = DVec2::new(cos, sin);
                for (sum, l) in sum.iter_mut().zip(self.at(j, k).radiance) {
                    *sum += factor * l * towards;
                }
            }
        }
        sum
    }

    /// How the irradiance changes with the position, from the differences of neighbouring strata.
    ///
    /// The border of two strata moves with the nearer of what is seen in them, at the distance `r`, and takes light from one to give
    /// it to the other:
    ///
    /// ```text
    /// dE/dx = sum over k of  e_k 2pi/N sum over j of sin cos^2 theta_j- / min(r_jk, r_j-1,k) (L_jk - L_j-1,k)
    ///                     +  e'_k- sum over j of (sin theta_j+ - sin theta_j-) / min(r_jk, r_j,k-1) (L_jk - L_j,k-1)
    /// ```
    ///
    /// with `e_k` towards the middle of azimuth `k`, `e'_k-` across its border [Ward and Heckbert 1992, eq. 5]. Distances are those at the
    /// border, see [`Hemisphere::continued`].
    pub fn gradient_of_strata(&self) -> [DVec2; 3] {
        let Strata { rings, azimuths } = self.strata;
        let step = TAU / azimuths as f64;
        let mut sum = [DVec2::ZERO; 3];
        let mut add = |direction: DVec2, factor: f64, [a, b]: [&RayResult; 2]| {
            for (i, sum) in sum.iter_mut().enumerate() {
                *sum += factor * (a.radiance[i] - b.radiance[i]) * direction;
            }
        };
        for k in 0..azimuths {
            let [(sin, cos), (sin_border, cos_border)] =
                [0.5, 0.0].map(|part| sincos64(step * (k as f64 + part)));
            let (along, across) = (DVec2::new(cos, sin), DVec2::new(-sin_border, cos_border));
            for j in 0..rings {
                let here = self.at(j, k);
                if j > 0 {
                    let cos2 = self.strata.border(j);
                    let near = self.continued(j, k, [-1.0, 0.0]).max(self.continued(j - 1, k, [1.0, 0.0]));
                    add(along, step * (1.0 - cos2).sqrt() * cos2 * near, [here, self.at(j - 1, k)]);
                }
                let before = k + azimuths - 1;
                let near = self.continued(j, k, [0.0, -1.0]).max(self.continued(j, before, [0.0, 1.0]));
                let [high, low] = [j, j + 1].map(|j| (1.0 - self.strata.border(j)).max(0.0).sqrt());
                add(across, (low - high) * near, [here, self.at(j, before)]);
            }
        }
        sum
    }
}
