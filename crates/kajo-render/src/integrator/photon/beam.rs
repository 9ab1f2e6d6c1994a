//! Light that photons bring to a whole ray through a medium: the beam radiance estimate [Jarosz, Zwicker and Jensen 2008].
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

use std::f32::consts::PI;

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::medium::{Coefficients, MediumId};
use kajo_core::scene::Scene;
use kajo_core::space::Space;
use kajo_math::Ray;

use crate::integrator::photon_map::Photon;
use crate::integrator::transport::{MediumStack, PathState};

/// A ray through a homogeneous medium, and the path that it belongs to.
pub struct QueryBeam<'a> {
    scene: &'a Scene,
    coefficients: &'a Coefficients,
    sigma_t: Spectrum,
    media: MediumStack,
    /// Of unit direction, from 0 on.
    pub ray: Ray,
    /// The throughput at its start.
    pub beta: Spectrum,
    /// What the lanes of `beta` stand for.
    pub wavelengths: Wavelengths,
    /// How often the path was scattered before.
    pub scatterings: u32,
}

impl<'a> QueryBeam<'a> {
    /// The ray that a path is about to follow; `None` where no homogeneous medium that scatters is alone around it.
    pub fn of(scene: &'a Scene, path: &PathState<'_>) -> Option<QueryBeam<'a>> {
        let medium = path.media.medium().filter(|_| !path.media.overlaps())?;
        let coefficients = scattering(scene, medium)?;
        if scene.space() == Space::Curved && path.media.curved(scene).is_some() {
            return None;
        }
        let PathState { ray, beta, wavelengths, media, scatterings, .. } = *path;
        let sigma_t = coefficients.sigma_s(&wavelengths) + coefficients.sigma_a(&wavelengths);
        Some(QueryBeam { scene, coefficients, sigma_t, media, ray, beta, wavelengths, scatterings })
    }

    /// What a photon of the power `Φ` adds to the radiance at the start of the ray: `T sigma_s p Φ / (pi r^2)`.
    ///
    /// * `t`: parameter of the point of the ray that is nearest to it
    /// * `r`: radius of the cylinder there
    pub fn scattered(&self, photon: &Photon, t: f32, r: f32) -> Spectrum {
        let phase = self.coefficients.phase().eval(-self.ray.d, photon.wi());
        let sigma_s = self.media.scattering(self.scene, self.ray.at(t), &self.wavelengths);
        let passed = (self.sigma_t * -t).exp() * self.media.transmittance(t);
        // [Jarosz et al. 2008, eq. 13]
        passed * sigma_s * photon.power() * (phase / (PI * r * r))
    }
}

/// What a medium does to light that beams are asked in: one that scatters and is the same everywhere, but not a body that light is
/// scattered in many times, where photons are not kept.
fn scattering(scene: &Scene, medium: MediumId) -> Option<&Coefficients> {
    let media = &scene.appearance.media;
    let coefficients = media.coefficients(medium);
    let is_meant = media.is_homogeneous(medium) && coefficients.scatters() && !coefficients.is_subsurface();
    is_meant.then_some(coefficients)
}
