//! Indirect light that is known where a path comes to a matt surface, so that no direction has to be drawn for it.
//!
//! Of the light that a surface sends back along the path,
//!
//! ```text
//! L(wo) = direct light  +  R/π E  +  integral of  f' |cos| Li,        f = R/π + f'
//! ```
//!
//! the middle term has the irradiance `E` of all light that was scattered before by more than mirrors and glass. The others are estimated as
//! always: a light is drawn, and one direction `wi` by the density `p` of all the scattering `f`. A light that is met there is one of two
//! estimates of direct light, one that is met by way of mirrors and glass a caustic. At the first surface that is neither, the path
//! is left with `f' |cos| / p`, and ends at random with what it loses there.

use kajo_color::{Spectrum, sensor};
use kajo_core::bsdf::Bsdf;
use kajo_core::light::{LightHit, LightId, LightPoint};
use kajo_core::shading::Shading;
use kajo_math::{Vec2, Vec3};

use super::casters::Casters;
use super::crossed::Crossed;
use super::{CameraPath, Part, PathTracer, Shaded};
use crate::integrator::transport::{LocalFrame, PathState, SurfaceInteraction};
use crate::trail::PathObserver;

/// A vertex whose surface reflects light evenly, among other things.
pub struct DiffuseVertex<'v, 's> {
    /// The path that has come there.
    pub state: &'v PathState<'s>,
    pub surface: &'v SurfaceInteraction,
    /// Unit normal on the side of the path, without relief.
    pub n: Vec3,
    /// Unit normal of the relief.
    pub relief: Vec3,
}

/// What is known of the indirect light of a vertex.
#[derive(Clone, Copy, Debug)]
pub enum Indirect {
    /// Nothing: it is sampled.
    Unknown,
    /// Its irradiance.
    Irradiance(Spectrum),
    /// Not needed: the path ends.
    Unwanted,
}

/// A source of indirect light.
pub trait IndirectLight {
    /// Whether anything is asked; where not, all of it is compiled away.
    const IS_ASKED: bool;

    /// Whether lights behind clear boundaries are drawn; where not, all of that is compiled away.
    const WALKS: bool = false;

    /// Where the path keeps what it has come through, if lights behind that are drawn.
    fn crossed(&mut self) -> Option<&mut Option<Crossed>> {
        None
    }

    /// The objects that light may come by way of, if there are any and lights are drawn so.
    fn casters(&self) -> Option<&Casters> {
        None
    }

    /// The indirect light of the first vertex that is no mirror, if it reflects evenly.
    fn irradiance(&mut self, _vertex: &DiffuseVertex<'_, '_>) -> Indirect {
        Indirect::Unknown
    }

    /// The path has come to a point, or with none to the sky, with so many bounces behind it.
    fn hit(&mut self, _bounces: u32, _p: Option<Vec3>) {}

    /// The path has come to what scatters light into more than single directions.
    fn scatters(&mut self) {}

    /// Whether lights count that are met now.
    fn counts_lights(&self) -> bool {
        true
    }

    /// Whether light may be found by scattering from a surface whose irradiance is known.
    fn scattering_finds_lights(&self) -> bool {
        true
    }

    /// The background, where its light is part of the irradiance that is known. Scattering alone finds it.
    fn even_sky(&self) -> Option<LightId> {
        None
    }

    /// Whether directions are drawn with the help of a guide; where not, all of what follows is compiled away.
    const GUIDES: bool = false;

    /// The path has come to a surface that reflects into more than single directions.
    ///
    /// * `n`: unit normal on the side of the path
    /// * `beta`: what the path carries
    fn comes_to(&mut self, _p: Vec3, _n: Vec3, _beta: Spectrum) {}

    /// The path has come to a surface at which no direction is guided.
    fn comes_to_unguided(&mut self) {}

    /// The share of directions that are drawn by scattering where the path is; `None` where no direction is guided.
    fn share_of_scattering(&self) -> Option<f32> {
        None
    }

    /// The density per solid angle with which the path goes on in a direction, and that of the guide.
    ///
    /// * `w`: unit direction in world space
    /// * `by_scattering`: density with which scattering goes there
    fn mixed(&self, _w: Vec3, by_scattering: f32) -> (f32, f32) {
        (by_scattering, 0.0)
    }

    /// A direction of the guide in world space, with its density.
    ///
    /// * `u`: uniform in [0, 1)²
    fn draw(&self, _u: Vec2) -> (Vec3, f32) {
        (Vec3::Z, 0.0)
    }

    /// The path goes on from where it has come to.
    fn leaves(&mut self, _by: &GuidedDirection) {}

    /// The path ends where it has come to: the direction that was drawn is none that light could come from.
    fn fails(&mut self, _beta: Spectrum) {}

    /// How many times less the path carries than if its directions had been drawn by scattering alone.
    fn gain(&self) -> f32 {
        1.0
    }

    /// What is to be done with the path where it has come to.
    fn worth(&self) -> Worth {
        Worth::Unknown
    }

    /// The path splits where it has come to.
    fn forks(&mut self) {}

    /// A branch of the last split begins.
    fn takes_branch(&mut self, _is_last: bool) {}

    /// The path has found light.
    fn finds(&mut self, _light: Spectrum) {}
}

/// What is to be done with a path that has come to a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Worth {
    /// Nothing is known of the light there.
    Unknown,
    /// It ends, but with this probability.
    Survives(f32),
    /// It goes on as so many branches, or as itself.
    Splits(u32),
}

/// A direction in which a path goes on from a surface at which it is guided.
#[derive(Clone, Copy, Debug)]
pub struct GuidedDirection {
    /// Unit direction in world space; none for single directions.
    pub w: Option<Vec3>,
    /// Density of the mixture; of a single direction the probability with which scattering was asked.
    pub p: f32,
    /// Density of scattering; of a single direction 1.
    pub p_scattering: f32,
    /// Density of the guide.
    pub p_guide: f32,
    /// What the path carried to the surface.
    pub beta: Spectrum,
}

/// No known indirect light: all is sampled.
pub struct Sampled;

impl IndirectLight for Sampled {
    const IS_ASKED: bool = false;
}

impl<'a: 's, 's, O: PathObserver, C: IndirectLight> PathTracer<'a, 's, O, C> {
    /// Takes indirect light from this source; `None` where it has none, else whether the path goes on.
    ///
    /// Takes the numbers of [`CameraPath::go_on`], and those of direct light.
    #[inline(never)]
    pub(super) fn take_indirect(
        &mut self,
        path: &mut CameraPath<'s>,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'s>,
        local: &LocalFrame,
        shading: &Shading,
    ) -> Option<bool> {
        if path.bounces != 0 || (self.settings.bounces == 0 && self.indirect.even_sky().is_none()) {
            return None;
        }
        let reflectance = bsdf.lambertian_reflectance()?;
        let wo = surface.wo;
        let towards = |n: Vec3, by: Vec3| if wo.dot(by) < 0.0 { -n } else { n };
        let n = Shading::plain(&surface.at.point).normal(wo);
        let n = towards(n, n);
        let relief = if shading.leans { towards(shading.n, surface.at.point.ng) } else { n };
        let vertex = DiffuseVertex { state: &path.state, surface, n, relief };
        let irradiance = match self.indirect.irradiance(&vertex) {
            Indirect::Unknown => return None,
            Indirect::Unwanted => return Some(false),
            Indirect::Irradiance(irradiance) => irradiance,
        };
        let light = path.state.beta * reflectance * irradiance * std::f32::consts::FRAC_1_PI;
        self.observer.found(|| sensor::to_rgb(light, &path.state.wavelengths));
        self.estimate.light += light;
        self.add_drawn_light(path, surface, bsdf, local);
        if bsdf.is_lambertian() && !self.indirect.scattering_finds_lights() {
            return Some(false);
        }
        let shaded = Shaded { surface, bsdf, local };
        if !path.go_on(self.scene(), self.settings, shaded, Part::All, self.observer) {
            return Some(false);
        }
        if path.state.connectable {
            let wi = local.to_local(path.state.ray.d);
            let beside = wi.map_or(Spectrum::BLACK, |wi| bsdf.beside_lambertian(local.wo, wi));
            self.beside = Some(beside);
        }
        Some(true)
    }

    /// The weight of light from infinitely far away that the path met; `None` where it does not count.
    ///
    /// An even sky that is part of the irradiance counts in full on the way from a record. On the way from a surface whose
    /// irradiance was known, only what is scattered unevenly counts.
    pub(super) fn weight_from_infinity(
        &self,
        path: &CameraPath<'s>,
        hit: &LightHit,
        at: &LightPoint,
        d: Vec3,
    ) -> Option<Spectrum> {
        if self.indirect.even_sky() == Some(self.scene().lighting.sampler.id(hit.light)) {
            return Some(self.beside.unwrap_or(Spectrum::WHITE));
        }
        self.indirect.counts_lights().then(|| Spectrum::WHITE * self.mis_weight(path, hit, at, d))
    }

    /// Leaves the path what it carries at a vertex that is no mirror, on its way from a surface whose indirect light was known; `false`
    /// where it ends.
    ///
    /// Takes a number at the first of them.
    pub(super) fn settle(&mut self, path: &mut CameraPath<'s>) -> bool {
        self.indirect.scatters();
        self.beside.take().is_none_or(|beside| path.state.keep(beside))
    }
}
