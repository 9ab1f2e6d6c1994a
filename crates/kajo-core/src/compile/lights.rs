//! The `Lights` block.

use std::f32::consts::PI;

use kajo_color::{Emission, Spectrum};
use kajo_math::{Vec3, fmath};
use kajo_scene::{Args, Diagnostic, Item, Params};

use super::Compiler;
use super::spectra::{SpectrumReader, Written};
use crate::family::Pooled;
use crate::light::{DirectionalLight, PointLight, SpotLight};

const KEYWORDS: [&str; 3] = ["DirectionalLight", "PointLight", "SpotLight"];
const LATER: [&str; 3] = ["AreaLight", "EnvironmentLight", "SunSky"];

impl Compiler<'_> {
    pub(super) fn lights(&mut self, item: Item<'_>) {
        let mut params = Params::new(item, self.diagnostics);
        params.later(&LATER);
        let count = params.block("numLights");
        let lights = params.take(&KEYWORDS);
        params.finish();
        // A misspelt light was meant to be one.
        let n_blocks = item.children().filter(Item::has_block).count();
        self.check_count("numLights", count, n_blocks, "light");
        let spectra = self.spectra();
        for light in lights {
            let id = match light.keyword() {
                "DirectionalLight" => self
                    .read(light, |params| read_directional(params, spectra))
                    .and_then(|light| light.store(&mut self.lights)),
                "SpotLight" => self
                    .read(light, |params| read_spot(params, spectra))
                    .and_then(|light| light.store(&mut self.lights)),
                _ => self
                    .read(light, |params| read_point(params, spectra))
                    .and_then(|light| light.store(&mut self.lights)),
            };
            self.light_list.extend(id);
        }
    }
}

fn read_directional(params: &mut Params<'_, '_>, spectra: SpectrumReader<'_>) -> Option<DirectionalLight> {
    params.name();
    let direction = params.required("direction", unit_vector);
    let (intensity, emission) = match params.optional("irradiance", |args| spectra.emission(args)) {
        Some(irradiance) => physical(irradiance),
        None => classic(params.required("color", |args| spectra.classic_light(args))?),
    };
    // The sun is half a degree wide.
    let width = params.or("angle", 0.0, |args| args.number_in(0.0..=180.0));
    let sin = fmath::sin(0.25 * width.to_radians());
    Some(DirectionalLight { to_light: -direction?, disc: 2.0 * sin * sin, intensity, emission })
}

fn read_point(params: &mut Params<'_, '_>, spectra: SpectrumReader<'_>) -> Option<PointLight> {
    params.name();
    read_position_and_brightness(params, spectra, 1.0)
}

fn read_spot(params: &mut Params<'_, '_>, spectra: SpectrumReader<'_>) -> Option<SpotLight> {
    params.name();
    let direction = params.required("direction", unit_vector);
    let outer = params.required("angle", |args| args.number_in(0.0..=360.0));
    let widest = outer.unwrap_or(0.0);
    let inner = params.or("innerAngle", 0.75 * widest, |args| args.number_in(0.0..=360.0));
    let cos_of_half = |degrees: f32| fmath::cos(0.5 * degrees.to_radians());
    let (cos_outer, cos_inner) = (cos_of_half(widest), cos_of_half(inner.min(widest)));
    let share = 0.5 * (1.0 - 0.5 * (cos_inner + cos_outer));
    let point = read_position_and_brightness(params, spectra, share);
    outer?;
    Some(SpotLight { point: point?, axis: direction?, cos_inner, cos_outer })
}

/// What point and spot lights have in common.
///
/// * `share`: the part of all directions that the light fills, for a light given by its power
fn read_position_and_brightness(
    params: &mut Params<'_, '_>,
    spectra: SpectrumReader<'_>,
    share: f32,
) -> Option<PointLight> {
    let position = params.required("position", Args::vec3);
    let attenuation = params.optional("attenuation", |args| Ok((args.numbers::<3>()?, args.item())));
    let falloff = params.optional("falloff", |args| Ok((args.number()?, args.item())));
    if let (Some(_), Some((_, item))) = (attenuation, falloff) {
        let error = Diagnostic::error("a light has either `attenuation` or `falloff`, not both");
        params.diagnostics().push(error.label(item.head_span(), "the other one is above or below"));
    }
    let power = params.optional("power", |args| spectra.emission(args));
    let intensity = match power {
        Some(power) => Some(power.scaled(1.0 / (4.0 * PI * share.max(f32::MIN_POSITIVE)))),
        None => params.optional("intensity", |args| spectra.emission(args)),
    };
    if let Some(intensity) = intensity {
        let place = attenuation.map(|(_, item)| item).or(falloff.map(|(_, item)| item));
        if let Some(place) = place {
            let message = "a light with `intensity` or `power` falls off with the square of the distance";
            let error = Diagnostic::error(message).label(place.head_span(), "leave this out");
            params.diagnostics().push(error.help("a light with a `color` has the falloff that is written"));
        }
        let (intensity, emission) = physical(intensity);
        return Some(PointLight { position: position?, intensity, emission, attenuation: [0.0, 0.0, 1.0] });
    }
    let (intensity, emission) = classic(params.required("color", |args| spectra.classic_light(args))?);
    let coefficients = attenuation.map(|(c, _)| c).or(falloff.map(|(f, _)| [0.0, 0.0, f]));
    let attenuation = coefficients.unwrap_or([1.0, 0.0, 0.0]);
    Some(PointLight { position: position?, intensity, emission, attenuation })
}

/// The factor of the classic formula, and the irradiance that makes a white surface just as bright.
fn classic(color: Written<Emission>) -> (Spectrum, Emission) {
    (color.rgb, color.value.scaled(PI))
}

/// The same from the physical quantity: a white surface under the irradiance `pi` has the radiance 1.
fn physical(quantity: Emission) -> (Spectrum, Emission) {
    (Spectrum::from(Vec3::from(quantity.rgb()) / PI), quantity)
}

fn unit_vector(args: &mut Args<'_>) -> Result<Vec3, Diagnostic> {
    let direction = args.vec3()?;
    direction.try_normalize().ok_or_else(|| args.error("`direction` must not be zero"))
}
