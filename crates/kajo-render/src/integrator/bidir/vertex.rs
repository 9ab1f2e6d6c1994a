//! A point of a path where light is scattered, of a path from the light or from the camera.
//!
//! With the direction `wo` to the camera and `wi` to the light the point contributes the factor
//!
//! ```text
//! f(wo, wi) |wi . n| / |wi . ng|
//! ```
//!
//! with the shading normal `n` where the geometric one is `ng`: so does path tracing, which has the cosine with `n`
//! where light arrives. A path from the light scatters by `f |wo . n|` and needs the correction
//!
//! ```text
//! |wi . n| |wo . ng| / (|wi . ng| |wo . n|)                             [Veach 1997, 5.3.2]
//! ```
//!
//! The frame of the scattering is decided by the direction to the camera, see [`Shading`].
//!
//! In a medium the factor is the phase function for both directions, and no cosines are left.

use kajo_color::Spectrum;
use kajo_core::LightGroup;
use kajo_core::bsdf::{Bsdf, Transport};
use kajo_core::interaction::SurfacePoint;
use kajo_core::light::{LightPoint, Receiver};
use kajo_core::medium::PhaseAtWavelengths;
use kajo_core::shading::Shading;
use kajo_math::Vec3;

use super::partial_mis::PartialMis;
use super::volume::{NoMedia, Volume};
use crate::integrator::transport::LocalFrame;

/// A point of a path.
#[derive(Clone, Copy, Debug)]
pub struct Vertex<'s, V = NoMedia> {
    /// Position and normals; in a medium a position alone.
    pub at: SurfacePoint,
    /// The directions that scattering goes by.
    pub shading: Shading,
    /// Scattering there.
    pub bsdf: Bsdf<'s>,
    /// Unit direction to the vertex before.
    pub wo: Vec3,
    /// Light that arrives, for a path from the light; for one from the camera, what light from here is multiplied by.
    pub beta: Spectrum,
    /// Sums over the techniques that sample the path differently on this side.
    pub mis: PartialMis,
    /// Absorption per unit length on the side of `wo` and on the other.
    pub sigma_a: [Spectrum; 2],
    /// Index of refraction on these sides for a segment; `None` where light bends.
    pub eta: [Option<f32>; 2],
    /// Whether only one wavelength got here.
    pub secondary_terminated: bool,
    /// The light group of a path from there.
    pub group: LightGroup,
    /// Where paths from the other end may have a vertex of their own beside it; see `merge.rs`.
    pub merged_at: Option<Vec3>,
    /// Data for participating media.
    pub volume: V,
}

impl<'s, V: Volume<'s>> Vertex<'s, V> {
    /// Phase function at the vertex, if it is in a medium.
    #[inline(always)]
    pub fn phase(&self) -> Option<PhaseAtWavelengths<'s>> {
        self.volume.with_media()?.phase
    }

    /// Whether light is scattered into single directions alone.
    pub fn is_delta(&self) -> bool {
        self.phase().is_none() && self.bsdf.is_delta()
    }

    /// The sums of a vertex on a surface that scatters into a single direction: none of connections with it, but with
    /// merging at a vertex in a medium before.
    #[inline(always)]
    pub fn as_specular(&self) -> PartialMis {
        let mis = self.mis.without_connection();
        let merged = self.volume.with_media().map_or(0.0, |volume| volume.merged);
        PartialMis { d_vc: mis.d_vc + merged, ..mis }
    }

    /// The end of a segment that comes from elsewhere.
    pub fn end(&self) -> LightPoint {
        match self.phase() {
            Some(_) => LightPoint::Position(self.at.p),
            None => LightPoint::on(&self.at),
        }
    }

    /// The frame for light that goes to `wo`, or from there for a path that comes from the light.
    pub fn local(&self, wo: Vec3) -> LocalFrame {
        LocalFrame::new(&self.shading, wo)
    }

    /// The receiver, for the choice of a light: the same whichever end the path began at.
    pub fn receiver(&self, time: f32) -> Receiver {
        Receiver { p: self.at.p, n: self.shading.n, time }
    }

    /// Cosine with the true surface.
    pub fn cosine(&self, w: Vec3) -> f32 {
        if self.phase().is_some() {
            return 1.0;
        }
        self.at.ng.dot(w).abs()
    }

    /// Scattering of light from `wi` back along a path from the camera, with the cosine of `wi`.
    pub fn gathered(&self, wi: Vec3) -> Spectrum {
        if let Some(phase) = self.phase() {
            return phase.eval(self.wo, wi).value();
        }
        self.of_bsdf(wi, |bsdf, wo, wi| bsdf.eval(wo, wi, Transport::Radiance))
    }

    /// The part of [`Vertex::gathered`] that is no narrow lobe, of a surface.
    pub fn gathered_broadly(&self, wi: Vec3) -> Spectrum {
        self.of_bsdf(wi, Bsdf::broad_part)
    }

    /// The share of [`Vertex::gathered`] that belongs to narrow lobes, of a surface.
    pub fn narrow_share(&self, wi: Vec3) -> Spectrum {
        self.of_bsdf(wi, Bsdf::narrow_share)
    }

    /// What the surface says of light that comes from `wi` back along the path: by `wo` and `wi` in its own frame.
    fn of_bsdf(&self, wi: Vec3, asked: impl Fn(&Bsdf<'s>, Vec3, Vec3) -> Spectrum) -> Spectrum {
        let local = self.local(self.wo);
        let bumped = local.bumped(&self.bsdf);
        let bsdf = bumped.as_ref().unwrap_or(&self.bsdf);
        local.to_local(wi).map_or(Spectrum::BLACK, |wi| asked(bsdf, local.wo, wi))
    }

    /// Scattering of light of a path from the light to `wo`, with the cosine of `wo`.
    pub fn passed_on(&self, wo: Vec3) -> Spectrum {
        if let Some(phase) = self.phase() {
            return phase.eval(self.wo, wo).value();
        }
        let local = self.local(wo);
        let Some(wi) = local.to_local(self.wo) else { return Spectrum::BLACK };
        let bumped = local.bumped(&self.bsdf);
        let bsdf = bumped.as_ref().unwrap_or(&self.bsdf);
        bsdf.eval(wi, local.wo, Transport::Importance) * self.correction(wi, local.wo, wo)
    }

    /// The factor for shading normals of light that goes from the light to `wo` [Veach 1997, 5.3.2].
    ///
    /// * `local_wi`, `local_wo`: directions to the light and to the camera in the frame
    pub fn correction(&self, local_wi: Vec3, local_wo: Vec3, wo: Vec3) -> f32 {
        let factor = local_wi.z.abs() * self.cosine(wo) / (self.cosine(self.wo) * local_wo.z.abs());
        if factor.is_finite() { factor } else { 0.0 }
    }

    /// Density per solid angle with which a path that comes from `from` goes on to `to`.
    pub fn pdf(&self, from: Vec3, to: Vec3) -> f32 {
        if let Some(phase) = self.phase() {
            return phase.eval(from, to).pdf;
        }
        let local = self.local(from);
        let bumped = local.bumped(&self.bsdf);
        let bsdf = bumped.as_ref().unwrap_or(&self.bsdf);
        local.to_local(to).map_or(0.0, |to| bsdf.pdf(local.wo, to))
    }

    /// 0 for the side of `wo`, 1 for the other.
    pub fn side(&self, w: Vec3) -> usize {
        usize::from(w.dot(self.at.ng) * self.wo.dot(self.at.ng) < 0.0)
    }

    /// Index of refraction on the side of `w` for a segment; `None` where light bends.
    pub fn eta(&self, w: Vec3) -> Option<f32> {
        self.eta[self.side(w)]
    }

    /// The share of light that passes the medium on the side of `w` over a distance.
    pub fn transmittance(&self, w: Vec3, distance: f32) -> Spectrum {
        let sigma_a = self.sigma_a[self.side(w)];
        if sigma_a.is_black() || distance.is_infinite() {
            Spectrum::WHITE
        } else {
            (sigma_a * -distance).exp()
        }
    }
}
