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

use kajo_color::Spectrum;
use kajo_core::medium::PhaseAtWavelengths;
use kajo_core::scene::Scene;
use kajo_core::space::Space;

use crate::integrator::photon_map::Photon;
use crate::integrator::transport::{PathState, homogeneous_medium};

/// A ray through a homogeneous medium.
pub struct QueryBeam<'a, 's> {
    /// The path at its start.
    pub start: PathState<'s>,
    phase: PhaseAtWavelengths<'a>,
    sigma_s: Spectrum,
    /// What is lost on the way, per unit length: to the medium, and to the body that it fills.
    loss: Spectrum,
}

impl<'a, 's> QueryBeam<'a, 's> {
    /// The ray that a path is about to follow; `None` where no homogeneous medium that scatters is alone around it, and in bodies that light
    /// is scattered in many times, where no photons are kept.
    pub fn of(scene: &'a Scene, path: &PathState<'s>) -> Option<QueryBeam<'a, 's>> {
        let coefficients = homogeneous_medium(scene, path).filter(|medium| !medium.is_subsurface())?;
        if scene.space() == Space::Curved && path.media.curved(scene).is_some() {
            return None;
        }
        let sigma_s = coefficients.sigma_s(&path.wavelengths);
        let sigma_t = sigma_s + coefficients.sigma_a(&path.wavelengths);
        let loss = sigma_t + path.media.absorption().unwrap_or(Spectrum::BLACK);
        let phase = coefficients.phase().at(&path.wavelengths);
        Some(QueryBeam { start: *path, phase, sigma_s, loss })
    }

    /// What a photon of the power `Φ` adds to the radiance at the start of the ray: `T sigma_s p Φ / (pi r^2)`.
    ///
    /// * `t`: parameter of the point of the ray that is nearest to it
    /// * `r`: radius of the cylinder there
    pub fn scattered(&self, photon: &Photon, t: f32, r: f32) -> Spectrum {
        let phase = self.phase.eval(-self.start.ray.d, photon.wi());
        // [Jarosz et al. 2008, eq. 13]
        let scattered = (self.loss * -t).exp() * self.sigma_s * photon.power() * (phase.pdf / (PI * r * r));
        phase.colors.map_or(scattered, |colors| scattered * colors)
    }
}
