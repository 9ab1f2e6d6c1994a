//! Light that photons, or beams of them, bring to a whole ray through a medium [Jarosz, Zwicker and Jensen 2008; Jarosz et al. 2011].
//!
//! What a homogeneous medium scatters into a ray from the camera on its way of the length `s`,
//!
//! ```text
//! L = integral over t from 0 to s  of  T(t) sigma_s (integral of p(wo, wi) Li(wi) dwi) dt,      T(t) = exp(-sigma_t t)
//! ```
//!
//! needs no collision to be drawn. Photons are distributed by volume, and each is taken to be spread over a disk of radius `r` across the
//! ray, so that those in a cylinder around it count, with the parameter `t_j` of the point of the ray that is nearest to photon `j`:
//!
//! ```text
//! L = 1/(pi r^2)  sum over photons in the cylinder  of  T(t_j) sigma_s p(wo, wi_j) Φ_j / sigma_s(x_j)        [Jarosz et al. 2008, eq. 13]
//! ```
//!
//! A ball is blurred in three dimensions, the cylinder in two: of `N` paths its radius is `N^(-1/2)` of the scene's size, where that of a ball
//! which holds as many photons is `N^(-1/3)`. And every sample of a pixel sees all photons along its ray, not those around one point of it.
//!
//! A photon is left where a collision happens to be; a beam stands for the whole ray of a path from a light, with the power `Φ_j` at its
//! start. Where its line passes the ray at the distance `d < r`, at the lengths `t_j` along the ray and `u_j` along the beam, under the
//! angle `θ_j`, it brings
//!
//! ```text
//! L = 1/(2 r)  sum over the beams that pass  of  T(t_j) sigma_s p(wo, wi_j) T(u_j) Φ_j / sin θ_j        [Jarosz et al. 2011]
//! ```
//!
//! blurred in one dimension only. That is worth it in thin media, where few photons are left and every ray passes many beams; in dense
//! ones beams are short, and photons are many. With `n` photons and `m` beams in the volume `V`, and the mean free path `l`, which is how far
//! light on beams reaches, a length of 1 of a ray has
//!
//! ```text
//! n pi r^2 / V  photons within r,      m l 2 r (pi/4) / V  beams,  where beams of all directions are, whose mean sine is pi/4
//! ```
//!
//! so that beams are taken where `l > 2 r n / m`. Of beams that are all but parallel to a ray few pass it, each of a large weight, and of
//! parallel ones none: light of these directions is taken from photons.

use std::f32::consts::PI;

use kajo_color::Spectrum;
use kajo_core::medium::{Coefficients, PhaseAtWavelengths};
use kajo_core::scene::Scene;
use kajo_core::space::Space;

use super::beam_map::{BeamCrossing, PhotonBeam};
use crate::integrator::photon_map::Photon;
use crate::integrator::transport::{PathState, homogeneous_medium};

/// Sine of the angle between a ray and light that photons bring to it in place of beams: the weight of a beam is at most ten times the least.
pub const LEAST_SINE: f32 = 0.1;

/// Optical depth beyond which nothing is left of a beam.
const MOST_DEPTH: f32 = 16.0;

/// A straight ray through a homogeneous medium that scatters and is alone around it.
#[derive(Clone, Copy)]
pub struct HomogeneousRay<'a> {
    coefficients: &'a Coefficients,
    sigma_s: Spectrum,
    /// What is lost on the way, per unit length: to the medium, and to the body that it fills.
    loss: Spectrum,
    /// By the mean over the wavelengths of what is lost.
    pub mean_free_path: f32,
}

impl<'a> HomogeneousRay<'a> {
    /// The ray that a path is about to follow, or has followed to a collision; `None` where it is no such ray, and in bodies that light is
    /// scattered in many times, where no photons are kept.
    pub fn of(scene: &'a Scene, path: &PathState<'_>) -> Option<HomogeneousRay<'a>> {
        let coefficients = homogeneous_medium(scene, path).filter(|medium| !medium.is_subsurface())?;
        if scene.space() == Space::Curved && path.media.curved(scene).is_some() {
            return None;
        }
        let sigma_s = coefficients.sigma_s(&path.wavelengths);
        let sigma_t = sigma_s + coefficients.sigma_a(&path.wavelengths);
        let loss = sigma_t + path.media.absorption().unwrap_or(Spectrum::BLACK);
        let mean_free_path = path.wavelengths.mean(loss).recip();
        Some(HomogeneousRay { coefficients, sigma_s, loss, mean_free_path })
    }

    /// How far light goes that will be scattered, finite.
    ///
    /// * `extent`: length to the next surface
    pub fn reach(&self, extent: f32) -> f32 {
        let of_lane = |i: usize| if self.sigma_s[i] > 0.0 { self.loss[i] } else { f32::INFINITY };
        let least = (0..4).map(of_lane).fold(f32::INFINITY, f32::min);
        extent.min(MOST_DEPTH / least).min(f32::MAX)
    }
}

/// A ray of a path from the camera, to be compared with photons and beams.
pub struct QueryBeam<'a, 's> {
    /// The path at its start.
    pub start: PathState<'s>,
    pub ray: HomogeneousRay<'a>,
    phase: PhaseAtWavelengths<'a>,
}

impl<'a, 's> QueryBeam<'a, 's> {
    /// The ray that a path is about to follow; `None` where photons are not looked for all along it.
    pub fn of(scene: &'a Scene, path: &PathState<'s>) -> Option<QueryBeam<'a, 's>> {
        let ray = HomogeneousRay::of(scene, path)?;
        Some(QueryBeam { start: *path, ray, phase: ray.coefficients.phase().at(&path.wavelengths) })
    }

    /// What a photon of the power `Φ` adds to the radiance at the start of the ray: `T sigma_s p Φ / (pi r^2)`.
    ///
    /// * `t`: parameter of the point of the ray that is nearest to it
    /// * `r`: radius of the cylinder there
    pub fn scattered(&self, photon: &Photon, t: f32, r: f32) -> Spectrum {
        let phase = self.phase.eval(-self.start.ray.d, photon.wi());
        // [Jarosz et al. 2008, eq. 13]
        let scattered =
            (self.ray.loss * -t).exp() * self.ray.sigma_s * photon.power() * (phase.pdf / (PI * r * r));
        phase.colors.map_or(scattered, |colors| scattered * colors)
    }

    /// What a beam of the power `Φ` at its start adds to that radiance: `T(t) sigma_s p T(u) Φ / (2 r sin θ)`.
    ///
    /// * `at`: where it passes
    pub fn scattered_from(&self, beam: &PhotonBeam, at: &BeamCrossing) -> Spectrum {
        let phase = self.phase.eval(-self.start.ray.d, -beam.d);
        // [Jarosz et al. 2011]
        let left = (self.ray.loss * -(at.t + at.along)).exp();
        let scattered = left * self.ray.sigma_s * beam.power * (phase.pdf / (2.0 * at.r * at.sine));
        phase.colors.map_or(scattered, |colors| scattered * colors)
    }
}
