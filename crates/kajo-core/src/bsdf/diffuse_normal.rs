//! Diffuse scattering about another normal than that of the shading frame.
//!
//! A relief may lean so far that mirrors on it would send light into the surface; the frame is then made for a normal that is held
//! up towards the viewer (see `shading.rs`). What scatters evenly has no mirror direction and no need of that: a matt
//! surface of the normal `n` has the radiance
//!
//! ```text
//! L(wo) = R/π integral of  Li(wi) max(0, n·wi) dwi
//! ```
//!
//! for every viewer. So the diffuse part of a [`Bsdf`] is evaluated about the normal of the relief itself, whichever
//! frame the rest of it is in.

use kajo_color::Spectrum;
use kajo_math::{Frame, Vec2, Vec3};

use super::{Bsdf, BsdfSample, Lambert, OrenNayar, Transport};

/// The viewer is taken to stand at least this cosine above a surface whose normal leans away.
const LEAST_COSINE: f32 = 1e-3;

/// The least `1 + z` that a projection is divided by.
const LEAST_DENOMINATOR: f32 = 1e-6;

/// The unit normal `n` of diffuse scattering in the shading frame.
///
/// Kept as its stereographic projection `(x, y)/(1 + z)`, so that a [`Bsdf`] has room for it; normals within 0.1 degrees of
/// the negative z axis are approximate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseNormal(Vec2);

impl DiffuseNormal {
    /// The one of the shading frame.
    pub const SAME: DiffuseNormal = DiffuseNormal(Vec2::ZERO);

    fn new(n: Vec3) -> DiffuseNormal {
        DiffuseNormal(n.truncate() / (1.0 + n.z).max(LEAST_DENOMINATOR))
    }

    /// The normal `n` as lobes see it that turn `wo` to be above.
    fn above(n: Vec3, wo: Vec3) -> DiffuseNormal {
        let DiffuseNormal(projected) = DiffuseNormal::new(n);
        DiffuseNormal(if wo.z < 0.0 { -projected } else { projected })
    }

    fn frame(self) -> Frame {
        let s = self.0.length_squared();
        Frame::from_normal((2.0 * self.0).extend(1.0 - s) / (1.0 + s))
    }

    /// What a diffuse lobe scatters, `value(wo, wi)` about its own normal with the cosine of the light's direction `wi`.
    #[inline]
    pub(super) fn eval(
        self,
        wo: Vec3,
        wi: Vec3,
        mode: Transport,
        value: impl FnOnce(Vec3, Vec3) -> Spectrum,
    ) -> Spectrum {
        if self == DiffuseNormal::SAME {
            return value(wo, wi);
        }
        let (viewer, light, scale) = match mode {
            Transport::Radiance => (wo, wi, 1.0),
            Transport::Importance => (wi, wo, (wi.z / wo.z).abs()),
        };
        self.directions(viewer, light).map_or(Spectrum::BLACK, |(wo, wi)| value(wo, wi) * scale)
    }

    /// Directions of the shading frame about this normal; `None` where both normals differ about the side of `wi`, so that no light
    /// comes from there.
    #[inline]
    pub(super) fn directions(self, wo: Vec3, wi: Vec3) -> Option<(Vec3, Vec3)> {
        if self == DiffuseNormal::SAME {
            return Some((wo, wi));
        }
        let frame = self.frame();
        let (o, i) = (viewer(&frame, wo), frame.to_local(wi));
        (i.z * wi.z > 0.0).then_some((o, i))
    }

    /// A direction of the shading frame drawn by `sample`, which is given the direction `wo` about this normal.
    #[inline]
    pub(super) fn sample(
        self,
        wo: Vec3,
        sample: impl FnOnce(Vec3) -> Option<BsdfSample>,
    ) -> Option<BsdfSample> {
        if self == DiffuseNormal::SAME {
            return sample(wo);
        }
        let frame = self.frame();
        let drawn = sample(viewer(&frame, wo))?;
        let wi = frame.to_world(drawn.wi);
        (wi.z * drawn.wi.z > 0.0).then_some(BsdfSample { wi, ..drawn })
    }
}

/// The direction to the viewer, who is on the same side of both normals.
fn viewer(frame: &Frame, wo: Vec3) -> Vec3 {
    let o = frame.to_local(wo);
    Vec3::new(o.x, o.y, o.z.abs().max(LEAST_COSINE).copysign(wo.z))
}

/// A diffuse surface with a normal of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BumpedDiffuse {
    lobe: Diffuse,
    normal: DiffuseNormal,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Diffuse {
    Lambert(Lambert),
    OrenNayar(OrenNayar),
}

impl BumpedDiffuse {
    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: Transport) -> Spectrum {
        self.normal.eval(wo, wi, mode, |wo, wi| match self.lobe {
            Diffuse::Lambert(lobe) => lobe.eval(wo, wi),
            Diffuse::OrenNayar(lobe) => lobe.eval(wo, wi),
        })
    }

    #[inline]
    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let density = |(wo, wi)| match self.lobe {
            Diffuse::Lambert(lobe) => lobe.pdf(wo, wi),
            Diffuse::OrenNayar(lobe) => lobe.pdf(wo, wi),
        };
        self.normal.directions(wo, wi).map_or(0.0, density)
    }

    pub(super) fn sample(&self, wo: Vec3, u: Vec2, uc: f32, mode: Transport) -> Option<BsdfSample> {
        let sample = self.normal.sample(wo, |wo| match self.lobe {
            Diffuse::Lambert(lobe) => lobe.sample(wo, u, uc),
            Diffuse::OrenNayar(lobe) => lobe.sample(wo, u, uc),
        })?;
        let weight = self.eval(wo, sample.wi, mode) * (1.0 / sample.pdf);
        BsdfSample::new(sample.wi, weight, sample.pdf, sample.kind)
    }

    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        match self.lobe {
            Diffuse::Lambert(lobe) => lobe.albedo(),
            Diffuse::OrenNayar(lobe) => lobe.albedo(wo),
        }
    }

    /// As [`Bsdf::lambertian_reflectance`]; black for none.
    pub(super) fn lambertian_reflectance(&self) -> Spectrum {
        match self.lobe {
            Diffuse::Lambert(lobe) => lobe.reflectance,
            Diffuse::OrenNayar(_) => Spectrum::BLACK,
        }
    }

    /// What it reflects evenly; `None` where it does not.
    pub(super) fn without_transmission(&self) -> Option<BumpedDiffuse> {
        match self.lobe {
            Diffuse::Lambert(lobe) => {
                Some(BumpedDiffuse { lobe: Diffuse::Lambert(lobe.without_transmission()), ..*self })
            }
            Diffuse::OrenNayar(_) => None,
        }
    }

    pub(super) fn transmits(&self) -> bool {
        matches!(self.lobe, Diffuse::Lambert(lobe) if !lobe.transmittance.is_black())
    }
}

impl<'s> Bsdf<'s> {
    /// The same with its diffuse part about the unit normal `n` of the shading frame; `None` where it has none.
    ///
    /// * `wo`: direction to the viewer, whom the shading frame was made for
    pub fn with_diffuse_normal(&self, n: Vec3, wo: Vec3) -> Option<Bsdf<'s>> {
        let bumped = |lobe| Some(Bsdf::BumpedDiffuse(BumpedDiffuse { lobe, normal: DiffuseNormal::new(n) }));
        match *self {
            Bsdf::Lambert(lobe) => bumped(Diffuse::Lambert(lobe)),
            Bsdf::OrenNayar(lobe) => bumped(Diffuse::OrenNayar(lobe)),
            Bsdf::Phong(lobes) => {
                lobes.has_diffuse().then(|| Bsdf::Phong(lobes.bumped(DiffuseNormal::above(n, wo))))
            }
            Bsdf::Principled(layers) => {
                layers.has_diffuse().then(|| Bsdf::Principled(layers.bumped(DiffuseNormal::above(n, wo))))
            }
            Bsdf::Subsurface(layers) => Some(Bsdf::Subsurface(layers.bumped(DiffuseNormal::new(n)))),
            Bsdf::BumpedDiffuse(_)
            | Bsdf::Conductor(_)
            | Bsdf::Dielectric(_)
            | Bsdf::ThinDielectric(_)
            | Bsdf::Btf(_)
            | Bsdf::Measured(_)
            | Bsdf::Deflector(_)
            | Bsdf::Null => None,
        }
    }
}
