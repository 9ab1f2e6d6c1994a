//! A point of a path where light is scattered, met from the emitter or from the camera.
//!
//! With the direction `wo` to the camera and `wi` to the light the point contributes the factor
//!
//! ```text
//! f(wo, wi) |wi . n| / |wi . ng|
//! ```
//!
//! with the shading normal `n` where the geometric one is `ng`: so does path tracing, which has the cosine with `n`
//! where light arrives. A path from the emitter scatters by `f |wo . n|` and needs the correction
//!
//! ```text
//! |wi . n| |wo . ng| / (|wi . ng| |wo . n|)                             [Veach 1997, 5.3.2]
//! ```
//!
//! The frame of the scattering is decided by the direction to the camera, see [`Shading`].

use kajo_color::Spectrum;

use kajo_core::bsdf::{Bsdf, Transport};
use kajo_core::interaction::SurfacePoint;
use kajo_core::lighting::Receiver;
use kajo_core::shading::Shading;
use kajo_math::{Frame, Vec3};

use super::rivals::Rivals;

/// A point of a path.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Place and normals.
    pub at: SurfacePoint,
    /// The directions that scattering goes by.
    pub shading: Shading,
    /// Scattering there.
    pub bsdf: Bsdf,
    /// Unit direction to the point before.
    pub back: Vec3,
    /// Light that arrives, for a path from the emitter; for one from the camera, what light from here is multiplied by.
    pub beta: Spectrum,
    /// The other ways to find what is found here.
    pub rivals: Rivals,
    /// Absorption per unit length on the side of `back` and on the other.
    pub absorption: [Spectrum; 2],
    /// Index of refraction on these sides.
    pub eta: [f32; 2],
    /// Whether only one wavelength got here.
    pub is_single: bool,
    /// The group of the light of a path from there.
    pub group: u8,
}

/// Directions in the frame of the scattering.
pub struct Local {
    pub frame: Frame,
    /// The direction that decided the frame.
    pub wo: Vec3,
}

impl Vertex {
    /// The frame for light that goes to `wo`, or from there for a path that comes from the emitter.
    pub fn local(&self, wo: Vec3) -> Local {
        let frame = self.shading.frame(wo);
        Local { wo: frame.to_local(wo), frame }
    }

    /// Whether a direction is on the same side by the true surface as in the frame.
    pub fn agrees(&self, world: Vec3, local: Vec3) -> bool {
        world.dot(self.at.ng) * local.z > 0.0
    }

    /// Who is lit, for the choice of a light: the same whichever end the path began at.
    pub fn receiver(&self, time: f32) -> Receiver {
        Receiver { p: self.at.p, n: self.shading.n, time }
    }

    /// Cosine with the true surface.
    pub fn cosine(&self, w: Vec3) -> f32 {
        self.at.ng.dot(w).abs()
    }

    /// Scattering of light from `wi` back along a path from the camera, with the cosine of `wi`.
    pub fn gathered(&self, wi: Vec3) -> Spectrum {
        let Local { frame, wo } = self.local(self.back);
        let local = frame.to_local(wi);
        if self.agrees(wi, local) { self.bsdf.eval(wo, local, Transport::Radiance) } else { Spectrum::BLACK }
    }

    /// Scattering of light of a path from the emitter to `wo`, with the cosine of `wo`.
    pub fn passed_on(&self, wo: Vec3) -> Spectrum {
        let Local { frame, wo: local } = self.local(wo);
        let wi = frame.to_local(self.back);
        if !self.agrees(self.back, wi) {
            return Spectrum::BLACK;
        }
        self.bsdf.eval(wi, local, Transport::Importance) * self.correction([wi, local], wo)
    }

    /// The factor for shading normals of light that goes from the emitter to `wo`.
    ///
    /// * `local`: directions to the light and to the camera in the frame
    pub fn correction(&self, [wi, local]: [Vec3; 2], wo: Vec3) -> f32 {
        let factor = wi.z.abs() * self.cosine(wo) / (self.cosine(self.back) * local.z.abs());
        if factor.is_finite() { factor } else { 0.0 }
    }

    /// Density per solid angle with which a path that comes from `from` goes on to `to`.
    pub fn pdf(&self, from: Vec3, to: Vec3) -> f32 {
        let Local { frame, wo } = self.local(from);
        let local = frame.to_local(to);
        if self.agrees(to, local) { self.bsdf.pdf(wo, local) } else { 0.0 }
    }

    /// 0 for the side of `back`, 1 for the other.
    fn side(&self, w: Vec3) -> usize {
        usize::from(w.dot(self.at.ng) * self.back.dot(self.at.ng) < 0.0)
    }

    /// Index of refraction on the side of `w`.
    pub fn eta(&self, w: Vec3) -> f32 {
        self.eta[self.side(w)]
    }

    /// The share of light that passes the body on the side of `w` over a distance.
    pub fn transmittance(&self, w: Vec3, distance: f32) -> Spectrum {
        let absorption = self.absorption[self.side(w)];
        if absorption.is_black() || distance.is_infinite() {
            Spectrum::WHITE
        } else {
            (absorption * -distance).exp()
        }
    }
}
