//! What a surface does with light at one point, as a small value.
//!
//! Directions are unit vectors in the local frame whose z axis is the shading normal; `wo` points to where the
//! path came from and `wi` to where it goes, both away from the surface. [`Bsdf::eval`] includes the cosine:
//!
//! ```text
//! eval(wo, wi)    f(wo, wi) |cos θi|
//! pdf(wo, wi)     density of the directions of sample(), per solid angle
//! sample(wo, u)   wi, with weight = eval / pdf
//! ```
//!
//! Lobes that scatter into single directions have neither value nor density there: they are met by
//! sampling only, and then `pdf` is the probability of that direction. Radiance and its adjoint differ at boundaries of
//! media, where rays are squeezed: see [`Transport`].
//!
//! [`Phong`] is apart from these: the classic shading model, which is no density of anything.

mod broad;
mod brushed_clear;
mod brushed_metal;
mod btf;
pub mod conductor;
mod deflector;
mod dielectric;
mod diffuse_normal;
mod energy;
mod energy_tables;
pub mod fresnel;
mod fuzz;
mod gloss;
mod lambert;
mod lambertian;
mod measured;
pub mod microfacet;
mod oren_nayar;
mod phong;
mod phong_lobes;
mod principled;
mod subsurface;
mod thin;
mod widened;

pub use btf::BtfLobe;
pub use conductor::{Conductor, MetalFresnel};
pub use deflector::Deflector;
pub use dielectric::Dielectric;
pub use diffuse_normal::{BumpedDiffuse, DiffuseNormal};
pub use lambert::Lambert;
pub use measured::MeasuredLobe;
pub use microfacet::Microfacets;
pub use oren_nayar::OrenNayar;
pub use phong::{Highlight, Phong};
pub use phong_lobes::PhongLobes;
pub use principled::{Base, Principled, Specular};
pub use subsurface::Subsurface;
pub(crate) use thin::POLISHED;
pub use thin::ThinDielectric;

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3};

/// Scattering at one point of a surface.
#[derive(Clone, Copy, Debug)]
pub enum Bsdf<'s> {
    /// Ideal diffusion.
    Lambert(Lambert),
    /// Rough diffusion.
    OrenNayar(OrenNayar),
    /// Either of these about a normal that is not that of the frame.
    BumpedDiffuse(BumpedDiffuse),
    /// Metal.
    Conductor(Conductor),
    /// The boundary of two clear media.
    Dielectric(Dielectric),
    /// A pane without thickness, polished or frosted.
    ThinDielectric(ThinDielectric),
    /// Phong's model, normalised.
    Phong(PhongLobes),
    /// Layers of coat and fuzz on a metal, a diffuse base or a glass.
    Principled(Principled),
    /// Layers of coat and fuzz on a body that light enters.
    Subsurface(Subsurface),
    /// A texel of a bidirectional texture function.
    Btf(BtfLobe<'s>),
    /// A measured BRDF.
    Measured(MeasuredLobe<'s>),
    /// A plane that turns light.
    Deflector(Deflector),
    /// Nothing is there: light goes straight on.
    Null,
}

/// What a path carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Paths from the camera, which gather radiance. Across a boundary it is scaled by the square of the index.
    Radiance,
    /// Paths from the lights, which carry power.
    Importance,
}

impl Transport {
    /// Factor for light refracted where the index beyond, on the side of `wi`, is `eta` times that on the side of `wo`.
    #[inline]
    fn scale(self, eta: f32) -> f32 {
        match self {
            Transport::Radiance => 1.0 / (eta * eta),
            Transport::Importance => 1.0,
        }
    }
}

/// How a sampled direction was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScatterKind {
    /// Whether it goes to the other side of the surface.
    pub transmission: bool,
    /// Whether it is a single direction, which other strategies cannot find.
    pub delta: bool,
    /// Whether it goes on as it came, `wi = -wo`.
    pub straight: bool,
}

impl ScatterKind {
    const REFLECTION: ScatterKind = ScatterKind { transmission: false, delta: false, straight: false };
    const TRANSMISSION: ScatterKind = ScatterKind { transmission: true, delta: false, straight: false };
    const MIRROR: ScatterKind = ScatterKind { transmission: false, delta: true, straight: false };
    const DEFLECTED: ScatterKind = ScatterKind { transmission: true, delta: true, straight: false };
    const STRAIGHT: ScatterKind = ScatterKind { transmission: true, delta: true, straight: true };
}

/// A direction chosen by [`Bsdf::sample`].
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Unit direction, local.
    pub wi: Vec3,
    /// Value over density, the cosine included.
    pub weight: Spectrum,
    /// Density per solid angle, or the probability of a single direction.
    pub pdf: f32,
    /// How it was found.
    pub kind: ScatterKind,
    /// Index of refraction on the side of `wi` over that on the side of `wo`: 1 unless refracted.
    pub eta: f32,
}

impl BsdfSample {
    /// A sample that is not refracted; `None` when density or weight are not usable numbers.
    #[inline]
    fn new(wi: Vec3, weight: Spectrum, pdf: f32, kind: ScatterKind) -> Option<BsdfSample> {
        let usable = pdf > 0.0 && pdf.is_finite() && weight.is_finite();
        usable.then_some(BsdfSample { wi, weight, pdf, kind, eta: 1.0 })
    }
}

impl Bsdf<'_> {
    /// Scattered share of the light from `wi` that leaves to `wo`, per solid angle, times `|cos θi|`.
    ///
    /// Zero for lobes that scatter into single directions.
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3, mode: Transport) -> Spectrum {
        match self {
            Bsdf::Lambert(lobe) => lobe.eval(wo, wi),
            Bsdf::OrenNayar(lobe) => lobe.eval(wo, wi),
            Bsdf::BumpedDiffuse(lobe) => lobe.eval(wo, wi, mode),
            Bsdf::Conductor(lobe) => lobe.eval(wo, wi),
            Bsdf::Dielectric(lobe) => lobe.eval(wo, wi, mode),
            Bsdf::Phong(lobe) => lobe.eval(wo, wi, mode),
            Bsdf::Principled(lobe) => lobe.eval(wo, wi, mode),
            Bsdf::Subsurface(lobe) => lobe.eval(wo, wi, mode),
            Bsdf::ThinDielectric(lobe) => lobe.eval(wo, wi),
            Bsdf::Btf(lobe) => lobe.eval(wo, wi, mode),
            Bsdf::Measured(lobe) => lobe.eval(wo, wi, mode),
            Bsdf::Deflector(_) | Bsdf::Null => Spectrum::BLACK,
        }
    }

    /// Density of `wi`, per solid angle, among the directions that [`sample`](Self::sample) chooses for `wo`.
    ///
    /// Zero for lobes that scatter into single directions. The integral over the sphere is the probability of
    /// a sample that is of another kind.
    #[inline]
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        match self {
            Bsdf::Lambert(lobe) => lobe.pdf(wo, wi),
            Bsdf::OrenNayar(lobe) => lobe.pdf(wo, wi),
            Bsdf::BumpedDiffuse(lobe) => lobe.pdf(wo, wi),
            Bsdf::Conductor(lobe) => lobe.pdf(wo, wi),
            Bsdf::Dielectric(lobe) => lobe.pdf(wo, wi),
            Bsdf::Phong(lobe) => lobe.pdf(wo, wi),
            Bsdf::Principled(lobe) => lobe.pdf(wo, wi),
            Bsdf::Subsurface(lobe) => lobe.pdf(wo, wi),
            Bsdf::ThinDielectric(lobe) => lobe.pdf(wo, wi),
            Bsdf::Btf(lobe) => lobe.pdf(wo, wi),
            Bsdf::Measured(lobe) => lobe.pdf(wo, wi),
            Bsdf::Deflector(_) | Bsdf::Null => 0.0,
        }
    }

    /// Whether [`Bsdf::sample`] chooses among lobes, so that it needs a number for it.
    #[inline]
    pub fn is_choosy(&self) -> bool {
        match self {
            Bsdf::Lambert(_) => self.transmits(),
            Bsdf::Conductor(_) | Bsdf::Deflector(_) | Bsdf::Null => false,
            _ => true,
        }
    }

    /// Chooses a direction for `wo`, or none: then the path ends, its light lost.
    ///
    /// * `u`: uniform in [0, 1)²
    /// * `uc`: uniform in [0, 1), chooses among lobes; any such number where [`Bsdf::is_choosy`] is false
    #[inline]
    pub fn sample(&self, wo: Vec3, u: Vec2, uc: f32, mode: Transport) -> Option<BsdfSample> {
        match self {
            Bsdf::Lambert(lobe) => lobe.sample(wo, u, uc),
            Bsdf::OrenNayar(lobe) => lobe.sample(wo, u, uc),
            Bsdf::BumpedDiffuse(lobe) => lobe.sample(wo, u, uc, mode),
            Bsdf::Conductor(lobe) => lobe.sample(wo, u),
            Bsdf::Dielectric(lobe) => lobe.sample(wo, u, uc, mode),
            Bsdf::ThinDielectric(lobe) => lobe.sample(wo, u, uc),
            Bsdf::Phong(lobe) => lobe.sample(wo, u, uc, mode),
            Bsdf::Principled(lobe) => lobe.sample(wo, u, uc, mode),
            Bsdf::Subsurface(lobe) => lobe.sample(wo, u, uc, mode),
            Bsdf::Btf(lobe) => lobe.sample(wo, u, uc, mode),
            Bsdf::Measured(lobe) => lobe.sample(wo, u, uc, mode),
            Bsdf::Deflector(lobe) => lobe.sample(wo),
            Bsdf::Null => BsdfSample::new(-wo, Spectrum::WHITE, 1.0, ScatterKind::STRAIGHT),
        }
    }

    /// What a path counts that goes straight on here, through a hole or a pane, as shadow rays do; `None` where it is
    /// scattered, of a pane by a mirror that is put in its place.
    ///
    /// * `at_pane`: the cosine of the angle with the normal and a uniform number in [0, 1), asked for at panes only
    #[inline]
    pub fn cross(&mut self, at_pane: impl FnOnce() -> (f32, f32)) -> Option<Spectrum> {
        match self {
            Bsdf::Null => Some(Spectrum::WHITE),
            Bsdf::ThinDielectric(pane) if pane.is_polished() => {
                let (cos, u) = at_pane();
                pane.cross(cos, u).map_err(|mirror| *self = Bsdf::Conductor(mirror)).ok()
            }
            _ => None,
        }
    }

    /// Whether light is scattered into single directions only, so that there is nothing to be had by choosing a
    /// direction in another way.
    #[inline]
    pub fn is_delta(&self) -> bool {
        match self {
            Bsdf::Lambert(_)
            | Bsdf::OrenNayar(_)
            | Bsdf::BumpedDiffuse(_)
            | Bsdf::Principled(_)
            | Bsdf::Subsurface(_)
            | Bsdf::Btf(_)
            | Bsdf::Measured(_) => false,
            Bsdf::Conductor(lobe) => lobe.is_smooth(),
            Bsdf::Dielectric(lobe) => lobe.is_smooth(),
            Bsdf::Phong(lobe) => lobe.is_delta(),
            Bsdf::ThinDielectric(lobe) => lobe.is_polished(),
            Bsdf::Deflector(_) | Bsdf::Null => true,
        }
    }

    /// Whether light is scattered to the other side into more than single directions.
    #[inline]
    pub fn transmits(&self) -> bool {
        match self {
            Bsdf::Lambert(lobe) => !lobe.transmittance.is_black(),
            Bsdf::BumpedDiffuse(lobe) => lobe.transmits(),
            Bsdf::Dielectric(lobe) => !lobe.is_smooth(),
            Bsdf::ThinDielectric(lobe) => !lobe.is_polished(),
            Bsdf::Principled(lobe) => lobe.base == Base::Glass,
            Bsdf::Subsurface(_) => true,
            _ => false,
        }
    }

    /// Share of the light arriving from everywhere alike that leaves to `wo`, an estimate where there is no closed
    /// form: for layers that guide a denoiser, and to decide how long a path is worth following.
    #[inline]
    pub fn albedo(&self, wo: Vec3) -> Spectrum {
        match self {
            Bsdf::Lambert(lobe) => lobe.albedo(),
            Bsdf::OrenNayar(lobe) => lobe.albedo(wo),
            Bsdf::BumpedDiffuse(lobe) => lobe.albedo(wo),
            Bsdf::Conductor(lobe) => lobe.albedo(wo),
            Bsdf::Dielectric(lobe) => lobe.albedo(wo),
            Bsdf::ThinDielectric(lobe) => lobe.albedo(wo),
            Bsdf::Phong(lobe) => lobe.albedo(),
            Bsdf::Principled(lobe) => lobe.albedo(wo),
            Bsdf::Subsurface(lobe) => lobe.albedo(wo),
            Bsdf::Btf(lobe) => lobe.albedo(wo),
            Bsdf::Measured(lobe) => lobe.albedo(wo),
            Bsdf::Deflector(_) | Bsdf::Null => Spectrum::WHITE,
        }
    }
}

/// Whether both directions are on the same side of the surface, neither along it.
#[inline]
fn same_side(wo: Vec3, wi: Vec3) -> bool {
    wo.z * wi.z > 0.0
}

/// Both directions mirrored, if need be, so that `wo` is above the surface.
#[inline]
fn upright(wo: Vec3, wi: Vec3) -> (Vec3, Vec3) {
    let side = wo.z.signum();
    (Vec3::new(wo.x, wo.y, side * wo.z), Vec3::new(wi.x, wi.y, side * wi.z))
}

#[cfg(test)]
pub(crate) mod tests;
