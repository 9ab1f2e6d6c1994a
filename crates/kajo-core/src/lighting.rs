//! What integrators that estimate integrals ask of a scene: how surfaces scatter, what they emit, which light arrives.
//!
//! Light that arrives directly at a receiver `x` is a sum over lights, estimated by one of them, chosen with the probability `P(i | x)`:
//!
//! ```text
//! L = sum over i of integral of f |cos| V Li  dwi   ~   f |cos| V Li(wi) / (P(i | x) p_i(wi))
//! ```
//!
//! with the density `p_i` per solid angle of the light's own draw ([`Scene::sample_li`]). [`Scene::pdf_li`] is the product `P p_i`, with which a
//! direction that scattering found is weighed against that draw. Paths from lights begin with [`Scene::sample_le`] and count over the choice of the
//! light times its densities of the position and the direction ([`Scene::pdf_le`]).

use crate::texture::TextureContext;
use kajo_color::{Emission, Spectrum, WavelengthChoice, Wavelengths};
use kajo_math::{Aabb, Ray, Vec2, Vec3, robust::offset_origin};

use crate::bsdf::Bsdf;
use crate::differential::SkyFootprint;
use crate::emission::{Leaving, VariedEmission};
use crate::ids::{LightIndex, VariedEmissionId};
use crate::interaction::{SurfacePoint, SurfaceUv, test_error};
use crate::light::{
    AreaLight, BoundingSphere, EmissionPdf, EmissiveSurfaces, LeNumbers, LeavingLight, LightHit,
    LightLeSample, LightLiSample, LightPoint, LightSelection, PowerLightSampler, Receiver,
};
use crate::material::{Interior, ShadingPoint};
use crate::scene::{Interaction, Scene, rarely};

impl Scene {
    /// How light is scattered at an interaction.
    ///
    /// * `eta_outside`: index of refraction on the side of the normal
    /// * `u`: uniform in [0, 1), chooses among the parts of a mixture; any number where it is none
    #[inline]
    pub fn bsdf(&self, at: &Interaction, wavelengths: &Wavelengths, eta_outside: f32, u: f32) -> Bsdf<'_> {
        let context = &self.texture_context(at);
        self.appearance.bsdf(at.material, &ShadingPoint { context, wavelengths, eta_outside, u })
    }

    /// Whether [`Scene::bsdf`] chooses among parts there, so that it needs a number.
    #[inline]
    pub fn is_mixture(&self, at: &Interaction) -> bool {
        self.appearance.materials.is_mixture(at.material)
    }

    /// The share of light that comes straight along a segment between two points in one medium: less than 1 through
    /// holes and panes, and 0 behind anything else. What the medium itself absorbs is left out.
    ///
    /// No estimate: the product over the surfaces crossed of [`Scene::passage`], which is `1 - opacity` of a surface with holes and the
    /// Fresnel transmittance of a pane.
    ///
    /// * `eta`: index of refraction of the medium
    #[inline]
    pub fn transmittance(&self, segment: &Ray, eta: f32, wavelengths: &Wavelengths) -> Spectrum {
        if !self.appearance.has_passages {
            return if self.occluded(segment) { Spectrum::BLACK } else { Spectrum::WHITE };
        }
        let mut passed = Spectrum::WHITE;
        let blocked = self.occluded_or(None, segment, |object, hit| {
            let at = self.interaction(segment, object, hit);
            passed *= self.passage(&at, eta, wavelengths, at.crossing_cosine(segment.d));
            passed.is_black()
        });
        if blocked { Spectrum::BLACK } else { passed }
    }

    /// The share of light that goes straight on through a surface: less than 1 through holes and panes, 0 elsewhere. Of a mixture it is
    /// the mean.
    ///
    /// * `eta`: index of refraction of the medium around
    /// * `cos`: of the angle between light and normal
    #[inline]
    pub fn passage(&self, at: &Interaction, eta: f32, wavelengths: &Wavelengths, cos: f32) -> Spectrum {
        let context = &self.texture_context(at);
        let point = ShadingPoint { context, wavelengths, eta_outside: eta, u: 0.0 };
        self.appearance.passage(at.material, &point, cos)
    }

    /// What is behind a surface that lets light through.
    ///
    /// * `u`: as for [`Scene::bsdf`]
    #[inline]
    pub fn interior(&self, at: &Interaction, wavelengths: &Wavelengths, u: f32) -> Option<Interior> {
        if self.may_transmit(at.object) {
            let context = &self.texture_context(at);
            self.appearance.interior(at.material, &ShadingPoint { context, wavelengths, eta_outside: 1.0, u })
        } else {
            None
        }
    }

    /// The emission of an interaction against the ray that found it.
    ///
    /// * `d`: direction of that ray
    #[inline(always)]
    pub fn surface_light(&self, at: &Interaction, d: Vec3, wavelengths: &Wavelengths) -> Option<LightHit> {
        // Nothing in nested instances has any.
        if !self.geometry.primitives.get(at.object.index())?.emits {
            return None;
        }
        self.emitter_light(at, d, wavelengths)
    }

    /// [`Scene::surface_light`] of an object that emits light.
    #[inline(never)]
    fn emitter_light(&self, at: &Interaction, d: Vec3, wavelengths: &Wavelengths) -> Option<LightHit> {
        let (light, area) = self.lighting.sampler.area(&self.lighting.lights, at.object, at.hit.part)?;
        let radiance = match area.varied {
            None => area.emission.at(wavelengths),
            Some(varied) => rarely(|| self.varied_radiance(varied, at, -d, wavelengths)),
        };
        let hit = || LightHit { light, group: self.lighting.sampler.group(light), radiance };
        area.sides.emit(-d.dot(at.point.ng)).then(hit)
    }

    /// The lights that a ray along the unit vector `d` hits when it leaves the scene, the background first.
    ///
    /// * `footprint`: of the pixel, for a path that no other way of finding these lights competes with
    #[inline]
    pub fn lights_at_infinity<'a>(
        &'a self,
        d: Vec3,
        footprint: &'a SkyFootprint,
        wavelengths: &'a Wavelengths,
    ) -> impl Iterator<Item = LightHit> {
        self.lighting.sampler.at_infinity(&self.lighting.lights, d, footprint, wavelengths)
    }

    /// Light of a light for a receiver, whether or not anything is in the way; its density leaves out the choice of the
    /// light.
    ///
    /// * `u`: uniform in [0, 1)²
    /// * `by`: how the light was chosen, which says whether scattering finds its light too
    #[inline]
    pub fn sample_li<'a>(
        &self,
        light: LightIndex,
        to: &Receiver,
        u: Vec2,
        wavelengths: &Wavelengths,
        by: impl Into<LightSelection<'a>>,
    ) -> Option<LightLiSample> {
        let (lights, id) = (&self.lighting.lights, self.lighting.sampler.id(light));
        match by.into().is_beside_scattering() {
            true => lights.sample_li_beside_scattering(id, to, u, wavelengths, self),
            false => lights.sample_li(id, to, u, wavelengths, self),
        }
    }

    /// Density with which a light is chosen for a receiver and the direction `wi` drawn to it, in the measure of
    /// [`Emitter::pdf_li`](crate::light::Emitter::pdf_li).
    ///
    /// * `at`: the point of the light in that direction
    #[inline]
    pub fn pdf_li<'a>(
        &self,
        light: LightIndex,
        to: &Receiver,
        at: &LightPoint,
        wi: Vec3,
        by: impl Into<LightSelection<'a>>,
    ) -> f32 {
        let by = by.into();
        let probability = self.lighting.sampler.pmf(light, to, by);
        if probability <= 0.0 {
            return 0.0;
        }
        let (lights, id) = (&self.lighting.lights, self.lighting.sampler.id(light));
        match by.is_beside_scattering() {
            true => probability * lights.pdf_li_beside_scattering(id, to, at, wi),
            false => probability * lights.pdf_li(id, to, at, wi),
        }
    }

    /// The emission of a surface that does not emit the same everywhere, at an interaction with it.
    fn varied_radiance(
        &self,
        emission: VariedEmissionId,
        at: &Interaction,
        leaving: Vec3,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        let varied: &VariedEmission = &self.lighting.varied_emissions[emission.index()];
        let uv = if varied.needs_uv() { self.geometry.surface_uv(at) } else { SurfaceUv::default() };
        let context = TextureContext {
            p: self.geometry.pattern_point(at),
            uv,
            tint: self.geometry.tint(at),
            n: self.geometry.pattern_normal(at),
            time: at.time,
            object_from_world: self.pattern_frame(at),
            ..TextureContext::default()
        };
        let leaving = Leaving { p: at.point.p, d: Some(leaving) };
        varied.at(&self.appearance.textures, &context, leaving, wavelengths)
    }

    /// The lights for paths to begin at.
    pub fn power_light_sampler(&self) -> PowerLightSampler {
        // Light from infinitely far away shines at everything that has bounds, air that is a medium among it.
        let air = self.lighting.air.and_then(|air| self.appearance.media.bounds(air));
        let bounds = air.into_iter().fold(self.geometry.bounds(), Aabb::union);
        PowerLightSampler::new(&self.lighting.sampler, &self.lighting.lights, &bounds)
    }

    /// How wavelengths are drawn so that spectral lines are found: by the spectra of all light and its power.
    pub fn wavelength_choice(&self) -> WavelengthChoice {
        let (world, white) = (BoundingSphere::around(&self.geometry.bounds()), Emission::from_rgb([1.0; 3]));
        let mut spectra = Vec::new();
        for &id in self.lighting.sampler.list() {
            let power = self.lighting.lights.power(id, &world);
            let Some(varied) = self.lighting.lights.varied_emission(id) else {
                spectra.push((power, self.lighting.lights.emission(id).unwrap_or(&white)));
                continue;
            };
            let varied = &self.lighting.varied_emissions[varied.index()];
            let all: f32 = varied.emissions().map(Emission::luminance).sum();
            spectra.extend(varied.emissions().map(|light| (power * light.luminance() / all, light)));
        }
        WavelengthChoice::by_lights(spectra)
    }

    /// A ray of light that leaves a light; its densities leave out the choice of the light.
    ///
    /// The power that leaves it is the integral of `Le |cos|` over positions and directions, estimated by that over the product of both densities.
    ///
    /// * `time`: moment within the shutter interval
    /// * `world`: what lights infinitely far away are aimed at, [`PowerLightSampler::world`]
    pub fn sample_le(
        &self,
        light: LightIndex,
        time: f32,
        u: LeNumbers,
        wavelengths: &Wavelengths,
        world: &BoundingSphere,
    ) -> Option<LightLeSample> {
        let id = self.lighting.sampler.id(light);
        let leaving = self.lighting.lights.sample_le(id, time, u, wavelengths, world, self)?;
        let density = leaving.pdf.position * leaving.pdf.direction;
        let usable = density > 0.0 && density.is_finite();
        // A plane without bounds may hide the disk that light from infinitely far passes before the scene.
        let hidden = leaving.at.is_infinite()
            && self.geometry.has_unbounded()
            && self.occluded(&Ray { time, ..Ray::new(leaving.at.p(), -leaving.d) });
        (usable && !hidden).then_some(leaving)
    }

    /// Densities with which [`Scene::sample_le`] draws light that leaves the point `at` along the unit vector `d`.
    pub fn pdf_le(
        &self,
        light: LightIndex,
        time: f32,
        at: &LightPoint,
        d: Vec3,
        world: &BoundingSphere,
    ) -> EmissionPdf {
        self.lighting.lights.pdf_le(self.lighting.sampler.id(light), time, at, d, world)
    }
}

impl EmissiveSurfaces for Scene {
    #[inline(never)]
    fn radiance(
        &self,
        light: &AreaLight,
        emission: VariedEmissionId,
        leaving: LeavingLight,
        time: f32,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        let LeavingLight { p, d } = leaving;
        let primitive = &self.geometry.primitives[light.object.index()];
        let own = self.geometry.transform_of(primitive, time).object_from_world.transform_point3(p);
        let own = self.geometry.at_opening(primitive.shape, light.part, own, time);
        let hit = self.geometry.shapes.hit_at(primitive.shape, light.part, own);
        let point = SurfacePoint { p, ..SurfacePoint::default() };
        let at = Interaction { point, hit, object: light.object, time, ..Interaction::default() };
        self.varied_radiance(emission, &at, d, wavelengths)
    }

    #[inline(never)]
    fn shows(&self, light: &AreaLight, p: Vec3, time: f32) -> bool {
        let primitive = &self.geometry.primitives[light.object.index()];
        let own = self.geometry.transform_of(primitive, time).object_from_world.transform_point3(p);
        self.geometry.shapes.shows(primitive.shape, light.part, own, time)
    }
}

impl SurfacePoint {
    /// The ray from this point along the unit vector `wi` to the far end of a connection, clear of both surfaces.
    ///
    /// Nothing between lies at its parameters in `(0, t_max)`.
    #[inline]
    pub fn ray_to(&self, end: &LightPoint, wi: Vec3, time: f32) -> Ray {
        let o = offset_origin(self.p, self.p_error, self.ng, wi);
        match *end {
            LightPoint::Surface { p, p_error, n } => {
                // Seen from here the surface is as uncertain as the distance is large.
                let seen_error = Vec3::splat(test_error((p - o).abs().max_element()));
                let end = offset_origin(p, p_error + seen_error, n, -wi);
                Ray { o, t_min: 0.0, d: end - o, t_max: 1.0, time }
            }
            LightPoint::Position(p) => Ray { o, t_min: 0.0, d: p - o, t_max: 1.0, time },
            LightPoint::Infinite { .. } => Ray { o, t_min: 0.0, d: wi, t_max: f32::INFINITY, time },
        }
    }
}

#[cfg(test)]
impl Scene {
    /// [`Scene::transmittance`] in air, in red, green and blue.
    pub(crate) fn transmittance_in_air(&self, segment: &Ray) -> Spectrum {
        self.transmittance(segment, 1.0, &Wavelengths::RGB)
    }
}
