//! What integrators that estimate integrals ask of a scene: how surfaces scatter, what glows, which light to ask.

use kajo_color::{Emission, Spectrum, WavelengthChoice, Wavelengths};
use kajo_math::{Ray, Vec2, Vec3, robust::offset_origin};

use crate::bsdf::Bsdf;
use crate::glow::VariedEmission;
use crate::interaction::{SurfacePoint, SurfaceUv, test_error};
use crate::light::{AreaLight, Ball, Departures, EmissionPdf, Emitted, LightChoice, LightSample, Target};
use crate::material::{Interior, MaterialPoint, ShadingPoint};
use crate::scene::{Interaction, Scene, rarely};

/// A disc in the sky that a ray meets.
#[derive(Clone, Copy, Debug)]
pub struct Sun {
    /// Radiance from there.
    pub radiance: Spectrum,
    /// The light's group, an index into [`Scene::light_groups`].
    pub group: u8,
    /// The number of the light.
    pub light: u32,
}

/// A place of a surface that gives light.
#[derive(Clone, Copy, Debug)]
pub struct Glow<'a> {
    /// Radiance towards the viewer.
    pub radiance: Spectrum,
    /// The light's group, an index into [`Scene::light_groups`].
    pub group: u8,
    /// The number of the light.
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
        let point = ShadingPoint { place: self.material_point(at), wavelengths, eta_outside, u };
        self.materials.bsdf(at.material, &self.materials, &self.textures, &point)
    }

    /// Whether [`Scene::bsdf`] chooses among parts there, so that it needs a number.
    #[inline]
    pub fn is_mixture(&self, at: &Interaction) -> bool {
        self.materials.is_mixture(at.material)
    }

    /// The share of light that comes straight along a ray: less than 1 through holes and panes, and 0 behind anything
    /// else.
    ///
    /// * `eta_outside`: index of refraction of the medium that the ray runs in
    #[inline]
    pub fn visibility(&self, ray: &Ray, wavelengths: &Wavelengths, eta_outside: f32) -> Spectrum {
        if !self.has_passages {
            return if self.occluded(ray) { Spectrum::BLACK } else { Spectrum::WHITE };
        }
        let mut visible = Spectrum::WHITE;
        let blocked = self.occluded_or(None, ray, |primitive, hit| {
            let at = self.interaction(ray, primitive, hit);
            let point = ShadingPoint { place: self.material_point(&at), wavelengths, eta_outside, u: 0.0 };
            let cos = at.crossing_cosine(ray.d);
            visible *= self.materials.passage(at.material, &self.materials, &self.textures, &point, cos);
            visible.is_black()
        });
        if blocked { Spectrum::BLACK } else { visible }
    }

    /// What is behind a surface that lets light through.
    ///
    /// * `u`: as for [`Scene::bsdf`]
    #[inline]
    pub fn interior(&self, at: &Interaction, wavelengths: &Wavelengths, u: f32) -> Option<Interior> {
        if self.may_transmit(at.primitive) {
            let point = ShadingPoint { place: self.material_point(at), wavelengths, eta_outside: 1.0, u };
            self.materials.interior(at.material, &self.materials, &self.textures, &point)
        } else {
            None
        }
    }

    /// The light that an interaction itself sends against the ray that found it.
    ///
    /// * `d`: direction of that ray
    #[inline]
    pub fn glow(&self, at: &Interaction, d: Vec3, wavelengths: &Wavelengths) -> Option<Glow<'_>> {
        // Nothing in nested instances does.
        if !self.primitives.get(at.primitive as usize)?.glows {
            return None;
        }
        let (number, light) = self.emitters.area(&self.lights, at.primitive, at.hit.part)?;
        let radiance = match light.varied {
            None => light.emission.at(wavelengths),
            Some(varied) => rarely(|| self.varied_radiance(varied, at, wavelengths)),
        };
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

    /// The directional lights that a ray along the unit vector `d` meets when it leaves the scene; the background is none
    /// of them.
    #[inline]
    pub fn suns<'a>(&'a self, d: Vec3, wavelengths: &'a Wavelengths) -> impl Iterator<Item = Sun> {
        let met = self.emitters.discs(&self.lights, d, wavelengths);
        met.map(|(light, radiance)| Sun { radiance, group: self.emitters.group(light), light })
    }

    /// Light drawn for a receiver, whether or not anything is in the way.
    ///
    /// * `u`: uniform in [0, 1), chooses the light; `place`: chooses the place on it
    #[inline]
    pub fn light_towards(
        &self,
        to: &Receiver,
        u: f32,
        place: Vec2,
        wavelengths: &Wavelengths,
        choice: LightChoice,
    ) -> Option<LightSample> {
        let mut drawn =
            self.emitters.sample(&self.lights, [to.p, to.n], to.time, u, place, wavelengths, choice);
        if let Some(sample) = &mut drawn
            && let Some(varied) = self.emitters.varied(&self.lights, sample.light)
        {
            sample.radiance = self.radiance_of_place(varied, &sample.target, to.time, wavelengths);
        }
        drawn
    }

    /// The radiance of a place of a piece whose places differ.
    #[inline(never)]
    fn radiance_of_place(
        &self,
        (light, varied): (&AreaLight, u32),
        place: &Target,
        time: f32,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        let Target::Surface { p, .. } = *place else { return light.emission.at(wavelengths) };
        let primitive = &self.primitives[light.primitive as usize];
        let own = self.place(primitive, time).object_from_world.transform_point3(p);
        let hit = self.shapes.hit_at(primitive.shape, light.part, own);
        let point = SurfacePoint { p, ..SurfacePoint::default() };
        let at = Interaction { point, hit, primitive: light.primitive, time, ..Interaction::default() };
        self.varied_radiance(varied, &at, wavelengths)
    }

    /// The light of this number at a place.
    fn varied_radiance(&self, varied: u32, at: &Interaction, wavelengths: &Wavelengths) -> Spectrum {
        let varied: &VariedEmission = &self.varied_emissions[varied as usize];
        let uv = if varied.needs_uv() { self.surface_uv(at) } else { SurfaceUv::default() };
        let place = MaterialPoint { p: self.pattern_point(at), uv, tint: self.tint(at) };
        varied.at(&self.textures, &place, wavelengths)
    }

    /// Density per solid angle with which [`Scene::light_towards`] draws this light and the way to a place of it; for a
    /// light without extent the probability of its choice.
    ///
    /// * `at`: the place and its unit geometric normal, of effect where the light has a surface
    /// * `wi`: unit direction to it
    pub fn light_pdf(
        &self,
        emitter: u32,
        to: &Receiver,
        at: [Vec3; 2],
        wi: Vec3,
        choice: LightChoice,
    ) -> f32 {
        let probability = self.emitters.probability(emitter, [to.p, to.n], choice);
        if probability > 0.0 {
            probability * self.emitters.way_pdf(&self.lights, emitter, (to.p, to.time), at, wi)
        } else {
            0.0
        }
    }

    /// The lights for paths to begin at.
    pub fn departures(&self) -> Departures {
        Departures::new(&self.emitters, &self.lights, &self.bounds())
    }

    /// How wavelengths are drawn so that the lines of emitters are found: by the spectra of all light and its power.
    pub fn wavelength_choice(&self) -> WavelengthChoice {
        let (world, white) = (Ball::around(&self.bounds()), Emission::from_rgb([1.0; 3]));
        let mut emitters = Vec::new();
        for (number, &id) in (0..).zip(self.emitters.list()) {
            let power = self.lights.power(id, &world);
            let Some((_, varied)) = self.emitters.varied(&self.lights, number) else {
                emitters.push((power, self.lights.emission(id).unwrap_or(&white)));
                continue;
            };
            let varied = &self.varied_emissions[varied as usize];
            let all: f32 = varied.emissions().map(Emission::luminance).sum();
            emitters.extend(varied.emissions().map(|light| (power * light.luminance() / all, light)));
        }
        WavelengthChoice::by_lights(emitters)
    }

    /// A ray of light that leaves an emitter drawn by its power, the number of the emitter, and the probability of its choice,
    /// which the densities leave out.
    ///
    /// * `time`: moment within the shutter interval
    /// * `u`: uniform in [0, 1), chooses the light; `ways`: choose place and direction
    pub fn emit(
        &self,
        departures: &Departures,
        time: f32,
        u: f32,
        ways: [Vec2; 2],
        wavelengths: &Wavelengths,
    ) -> Option<(Emitted, u32, f32)> {
        let emitter = departures.choose(u)?;
        let mut emitted =
            self.lights.emit(self.emitters.id(emitter), time, ways, wavelengths, departures.world())?;
        if let Some(varied) = self.emitters.varied(&self.lights, emitter) {
            emitted.radiance = self.radiance_of_place(varied, &emitted.origin, time, wavelengths);
        }
        let density = emitted.pdf.place * emitted.pdf.direction;
        let usable = density > 0.0 && density.is_finite();
        // A plane without bounds may hide the disk that light from infinitely far passes before the scene.
        let hidden = emitted.is_infinite()
            && !self.unbounded.is_empty()
            && self.occluded(&Ray { time, ..Ray::new(emitted.p, -emitted.d) });
        (usable && !hidden).then(|| (emitted, emitter, departures.probability(emitter)))
    }

    /// Densities with which an emitter sends light along the unit vector `d`, once it is chosen.
    ///
    /// * `time`: moment within the shutter interval
    /// * `at`: where light leaves, or any point on its way from infinitely far; and the unit normal there, of effect where
    ///   the light has a surface
    pub fn emission_pdf(
        &self,
        departures: &Departures,
        emitter: u32,
        time: f32,
        at: [Vec3; 2],
        d: Vec3,
    ) -> EmissionPdf {
        self.lights.emission_pdf(self.emitters.id(emitter), time, at, d, departures.world())
    }
}

impl Glow<'_> {
    /// The number of the light.
    pub fn emitter(&self) -> u32 {
        self.number
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
        self.ray_to(&sample.target, sample.wi, time)
    }

    /// The ray from this point along the unit vector `wi` to the end of the way, clear of both surfaces.
    #[inline]
    pub fn ray_to(&self, end: &Target, wi: Vec3, time: f32) -> Ray {
        let o = offset_origin(self.p, self.p_error, self.ng, wi);
        match *end {
            Target::Surface { p, p_error, n } => {
                // Seen from here the surface is as uncertain as the distance is large.
                let seen_error = Vec3::splat(test_error((p - o).abs().max_element()));
                let end = offset_origin(p, p_error + seen_error, n, -wi);
                Ray { o, t_min: 0.0, d: end - o, t_max: 1.0, time }
            }
            Target::Point(p) => Ray { o, t_min: 0.0, d: p - o, t_max: 1.0, time },
            Target::Infinity => Ray { o, t_min: 0.0, d: wi, t_max: f32::INFINITY, time },
        }
    }
}
