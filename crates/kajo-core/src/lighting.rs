//! What integrators that estimate integrals ask of a scene: how surfaces scatter, what glows, which lamp to ask.

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::{Ray, Vec2, Vec3, robust::offset_origin};

use crate::bsdf::Bsdf;
use crate::interaction::SurfacePoint;
use crate::light::{AreaLight, LightChoice, LightSample, Target};
use crate::material::{Interior, ShadingPoint};
use crate::scene::{Interaction, Scene};

/// A place of a surface that gives light.
#[derive(Clone, Copy, Debug)]
pub struct Glow<'a> {
    /// Radiance towards the viewer.
    pub radiance: Spectrum,
    /// The lamp's group, an index into [`Scene::light_groups`].
    pub group: u8,
    /// The number of the lamp.
    number: u32,
    light: &'a AreaLight,
}

impl Scene {
    /// How light is scattered at an interaction.
    ///
    /// * `eta_outside`: index of refraction on the side of the normal
    /// * `u`: uniform in [0, 1), chooses among the parts of a mixture; any number where it is none
    #[inline]
    pub fn bsdf(&self, at: &Interaction, wavelengths: &Wavelengths, eta_outside: f32, u: f32) -> Bsdf {
        let point = ShadingPoint { p: self.pattern_point(at), wavelengths, eta_outside, u };
        self.materials.bsdf(at.material, &self.materials, &self.textures, &point)
    }

    /// Whether [`Scene::bsdf`] chooses among parts there, so that it needs a number.
    #[inline]
    pub fn is_mixture(&self, at: &Interaction) -> bool {
        self.materials.is_mixture(at.material)
    }

    /// What is behind a surface that lets light through.
    #[inline]
    pub fn interior(&self, at: &Interaction, wavelengths: &Wavelengths) -> Option<Interior> {
        if self.primitives[at.primitive as usize].transmits {
            self.materials.interior(at.material, wavelengths)
        } else {
            None
        }
    }

    /// The light that an interaction itself sends against the ray that found it.
    ///
    /// * `d`: direction of that ray
    #[inline]
    pub fn glow(&self, at: &Interaction, d: Vec3, wavelengths: &Wavelengths) -> Option<Glow<'_>> {
        if !self.primitives[at.primitive as usize].glows {
            return None;
        }
        let (number, light) = self.emitters.area(&self.lights, at.primitive, at.hit.part)?;
        let radiance = light.emission.at(wavelengths);
        let glow = || Glow { radiance, group: self.emitters.group(number), number, light };
        light.sides.emit(-d.dot(at.point.ng)).then(glow)
    }

    /// Density per solid angle with which [`Scene::light_towards`] draws the place of a glow.
    #[inline]
    pub fn glow_pdf(&self, glow: &Glow<'_>, at: &Interaction, from: &Receiver, choice: LightChoice) -> f32 {
        let place = [at.point.p, at.point.ng];
        self.emitters.area_pdf((glow.number, glow.light), [from.p, from.n], place, from.time, choice)
    }

    /// Density per solid angle with which [`Scene::light_towards`] draws a direction to the background.
    #[inline]
    pub fn sky_pdf(&self, from: &Receiver, wi: Vec3, choice: LightChoice) -> f32 {
        self.emitters.sky_pdf(&self.lights, [from.p, from.n], wi, choice)
    }

    /// Light drawn for a receiver, whether or not anything is in the way.
    ///
    /// * `u`: uniform in [0, 1), chooses the lamp; `place`: chooses the place on it
    #[inline]
    pub fn light_towards(
        &self,
        to: &Receiver,
        u: f32,
        place: Vec2,
        wavelengths: &Wavelengths,
        choice: LightChoice,
    ) -> Option<LightSample> {
        self.emitters.sample(&self.lights, [to.p, to.n], to.time, u, place, wavelengths, choice)
    }
}

/// Who is lit.
#[derive(Clone, Copy, Debug, Default)]
pub struct Receiver {
    /// The point.
    pub p: Vec3,
    /// Its unit normal, or zero where there is none.
    pub n: Vec3,
    /// Moment within the shutter interval, 0 to 1.
    pub time: f32,
}

impl SurfacePoint {
    /// The ray from this point to the far end of a light sample, clear of both surfaces.
    ///
    /// Nothing between lies at its parameters in `(0, t_max)`.
    #[inline]
    pub fn ray_to_light(&self, sample: &LightSample, time: f32) -> Ray {
        let o = offset_origin(self.p, self.p_error, self.ng, sample.wi);
        match sample.target {
            Target::Surface { p, p_error, n } => {
                let end = offset_origin(p, p_error, n, -sample.wi);
                Ray { o, t_min: 0.0, d: end - o, t_max: 1.0, time }
            }
            Target::Point(p) => Ray { o, t_min: 0.0, d: p - o, t_max: 1.0, time },
            Target::Infinity => Ray { o, t_min: 0.0, d: sample.wi, t_max: f32::INFINITY, time },
        }
    }
}
