//! What a path carries from one vertex to the next.

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::bsdf::Transport;
use kajo_core::differential::RayDifferential;
use kajo_core::sampler::SampleStream;
use kajo_core::scene::Interaction;
use kajo_math::{Ray, Vec3};

use super::{Interface, LaneMis, MediumStack};

/// A path in the making, all that any integrator has to know of it: plain data that can be copied, kept and taken up again.
#[derive(Clone, Copy, Debug)]
pub struct PathState<'s> {
    /// The ray to be followed next, whose direction has unit length.
    pub ray: Ray,
    /// What the lanes of `beta` stand for.
    pub wavelengths: Wavelengths,
    /// Throughput: what later light is multiplied by, or for a path from a light the power that it carries, each over
    /// the density of the path so far.
    pub beta: Spectrum,
    /// `beta * eta_scale` is the throughput relative to the initial one and without the factors `1/eta^2` of radiance
    /// at interfaces, which cancel when the path leaves the body again. Russian roulette goes by it.
    pub eta_scale: f32,
    /// Which end the path began at.
    pub mode: Transport,
    /// The media around the start of the ray.
    pub media: MediumStack,
    /// The random numbers that are left.
    pub draws: SampleStream<'s>,
    /// How often it was scattered.
    pub scatterings: u32,
    /// Number of rays traced for the path so far, at most [`MOST_SURFACES`](super::steps::MOST_SURFACES).
    pub surfaces: u32,
    /// Whether next-event estimation or a connection could have sampled the current segment: the last vertex is not specular, and no interface was
    /// crossed since that a [`super::connect`] does not pass. If not, emission that the segment hits counts in full.
    pub connectable: bool,
    /// How the ray differs from those of neighbouring samples, where textures ask for that: at its origin, and from a surface on
    /// until it is left at that surface.
    pub differential: Option<RayDifferential>,
    /// Whether media absorb and scatter it; else it goes through them as if they were nothing.
    pub carries_media: bool,
    /// Densities of the distances sampled in media, lane by lane.
    pub lanes: LaneMis,
    /// Emission of media along the path, times `beta`, since it was taken last.
    pub emitted: Spectrum,
    /// Length of the last ray to the next surface, infinite if there is none, also where a collision came before.
    pub extent: f32,
}

impl<'s> PathState<'s> {
    /// A path that begins with a ray.
    ///
    /// * `beta`: what the ray carries
    /// * `media`: around its start
    #[inline(always)]
    pub fn new(
        ray: Ray,
        wavelengths: Wavelengths,
        beta: Spectrum,
        mode: Transport,
        media: MediumStack,
        draws: SampleStream<'s>,
    ) -> PathState<'s> {
        PathState {
            ray,
            wavelengths,
            beta,
            eta_scale: 1.0 / wavelengths.max_lane(beta).max(f32::MIN_POSITIVE),
            mode,
            media,
            draws,
            scatterings: 0,
            surfaces: 0,
            connectable: false,
            differential: None,
            carries_media: false,
            lanes: LaneMis::default(),
            emitted: Spectrum::BLACK,
            extent: 0.0,
        }
    }

    /// Leaves the path a share of what it carries, by lane in [0, 1]; `false` where it ends, at random by what it loses.
    ///
    /// Takes a number.
    pub fn keep(&mut self, share: Spectrum) -> bool {
        let q = self.wavelengths.max_lane(share);
        if self.draws.next_1d() >= q {
            return false;
        }
        self.beta *= share * q.recip();
        true
    }
}

/// A vertex of a path on a surface.
#[derive(Clone, Copy, Debug, Default)]
pub struct SurfaceInteraction {
    /// Position, normals, object and material.
    pub at: Interaction,
    /// Unit direction back along the path.
    pub wo: Vec3,
    /// Length along the path since the last event, curved or straight.
    pub length: f32,
    /// Uniform in [0, 1), chooses among the parts of a mixture; 0 where there is none.
    pub u: f32,
    /// What lies on both sides, where light passes.
    pub interface: Option<Interface>,
}

impl SurfaceInteraction {
    /// Whether light is refracted here by wavelength, so that only one can be followed.
    pub fn is_dispersive(&self) -> bool {
        self.interface.is_some_and(|interface| interface.is_dispersive)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wavefronts keep one for each path, and branches copy one. Differentials take 52 bytes of it, lanes 48, the light
    /// of media and how far they reach 20, and the shift of its wavelengths 16.
    #[test]
    fn a_path_is_small() {
        assert!(size_of::<PathState<'_>>() <= 464, "{}", size_of::<PathState<'_>>());
    }
}
