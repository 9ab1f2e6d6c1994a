//! The `Lights` block.

use std::f32::consts::PI;
use std::sync::Arc;

use kajo_color::{Emission, Spectrum};
use kajo_math::{Frame, Vec3, fmath};
use kajo_scene::{Args, Assets, Diagnostic, Item, Params, read_ies, read_limited};

use super::Compiler;
use super::places::misplaced;
use super::spectra::{SpectrumReader, Written};
use crate::family::Pooled;
use crate::light::{
    Cone, DirectionalLight, LightId, Lights, PhotometricLight, Photometry, PointLight, SpotLight,
};

pub(super) const KEYWORDS: [&str; 3] = ["DirectionalLight", "PointLight", "SpotLight"];
/// Words of other programs for lights that are written elsewhere here, and where that is.
const ELSEWHERE: [(&str, &str); 3] = [
    ("AreaLight", "any object gives light whose material has an emission: `Matte emitter { emission 5 }`"),
    ("EnvironmentLight", "write it around the scene: `Background { environment \"sky.exr\" }`"),
    ("SunSky", "write it around the scene: `Background { sky { } }`"),
];

/// Bytes of the largest file of intensities.
const LARGEST_IES_FILE: u64 = 16 << 20;

impl Compiler<'_> {
    pub(super) fn lights(&mut self, item: Item<'_>) {
        let mut params = Params::new(item, self.diagnostics);
        let count = params.block("numLights");
        let lights = params.take(&KEYWORDS);
        params.elsewhere(written_elsewhere);
        params.elsewhere(|item| misplaced(item, Some("Lights")));
        params.finish();
        // A misspelt light was meant to be one.
        let n_blocks = item.children().filter(Item::has_block).count();
        self.check_count("numLights", count, n_blocks, "light");
        for light in lights {
            match light.keyword() {
                "DirectionalLight" => self.light(light, read_directional),
                "SpotLight" => self.light(light, read_spot),
                _ if light.children().any(|key| key.keyword() == "ies") => {
                    self.light(light, read_photometric);
                }
                _ => self.light(light, read_point),
            }
        }
    }

    /// Puts a light into its pool.
    fn light<L: Pooled<Lights, Handle = LightId>>(
        &mut self,
        item: Item<'_>,
        read: impl FnOnce(&mut Params<'_, '_>, SpectrumReader<'_>) -> Option<L>,
    ) {
        let spectra = self.spectra();
        let mut params = Params::new(item, self.diagnostics);
        let group = self.light_groups.read(&mut params);
        let light = read(&mut params, spectra);
        params.finish();
        if let Some(light) = light {
            self.add_light(light, group);
        }
    }

    /// Puts a light into its pool and its group.
    pub(super) fn add_light(&mut self, light: impl Pooled<Lights, Handle = LightId>, group: u8) {
        if let Some(id) = light.store(&mut self.lights) {
            self.light_list.push(id);
            self.groups_of_lights.push(group);
        }
    }
}

/// The error for a light of other programs.
fn written_elsewhere(item: Item<'_>) -> Option<Diagnostic> {
    let (word, place) = ELSEWHERE.iter().find(|(word, _)| *word == item.keyword())?;
    let error = Diagnostic::error(format!("`{word}` is no word of this language"));
    Some(error.label(item.keyword_span(), "not a light of its own").help(*place))
}

fn read_directional(params: &mut Params<'_, '_>, spectra: SpectrumReader<'_>) -> Option<DirectionalLight> {
    params.name();
    let direction = params.required("direction", unit_vector);
    params.either(&["color", "irradiance"], "a light");
    let (intensity, emission) = match params.optional("irradiance", |args| spectra.emission(args)) {
        Some(irradiance) => physical(irradiance),
        None => classic(params.required("color", |args| spectra.classic_light(args))?),
    };
    // The sun is half a degree wide.
    let width = params.or("angle", 0.0, |args| args.number_in(0.0..=180.0));
    let height = fmath::one_minus_cos(0.5 * width.to_radians());
    Some(DirectionalLight { to_light: -direction?, height, intensity, emission })
}

fn read_point(params: &mut Params<'_, '_>, spectra: SpectrumReader<'_>) -> Option<PointLight> {
    params.name();
    read_position_and_brightness(params, spectra, 1.0)
}

/// A point light whose intensities are in a file.
fn read_photometric(params: &mut Params<'_, '_>, spectra: SpectrumReader<'_>) -> Option<PhotometricLight> {
    params.name();
    let position = params.required("position", Args::vec3);
    let photometry = params.required("ies", |args| read_ies_file(args, spectra.assets));
    let axis = params.optional("direction", unit_vector).unwrap_or(Vec3::NEG_Y);
    let turn = params.or("rotate", 0.0, Args::number).to_radians();
    let scale = params.or("scale", 1.0, |args| args.number_in(0.0..));
    let tint = params.optional("color", |args| spectra.emission(args));
    let power = params.optional("power", |args| Ok((spectra.emission(args)?, args.item())));
    if let (Some(_), Some((_, item))) = (&tint, &power) {
        let error = Diagnostic::error("a luminaire has either `color` or `power`, not both");
        params.diagnostics().push(error.label(item.head_span(), "the other one is above or below"));
    }
    let photometry = photometry?;
    let (intensity, emission) = physical(match power {
        Some((power, _)) => power.scaled(scale * share_of_each(photometry.flux() as f32)),
        None => tint.unwrap_or_else(|| Emission::from_rgb([1.0; 3])).scaled(scale),
    });
    // Horizontal angles begin at the side of x, or of z where the axis is along x.
    let side = if axis.x.abs() < 0.999 { Vec3::X } else { Vec3::Z };
    let frame = Frame::from_tangent(axis, side);
    let (sin, cos) = fmath::sin_cos(turn);
    let frame = Frame::from_tangent(axis, frame.s * cos - frame.t * sin);
    Some(PhotometricLight {
        position: position?,
        frame,
        photometry: Arc::new(photometry),
        emission,
        intensity,
    })
}

/// The file that a key names.
fn read_ies_file(args: &mut Args<'_>, assets: &dyn Assets) -> Result<Photometry, Diagnostic> {
    let name = args.text()?;
    let bytes = assets.open(&name, args.item().path()).and_then(|file| read_limited(file, LARGEST_IES_FILE));
    let read = bytes.map_err(|e| e.to_string()).and_then(|bytes| read_ies(&bytes).map_err(|e| e.to_string()));
    read.map(Photometry::from).map_err(|reason| args.error(format!("cannot read `{name}`: {reason}")))
}

fn read_spot(params: &mut Params<'_, '_>, spectra: SpectrumReader<'_>) -> Option<SpotLight> {
    params.name();
    let direction = params.required("direction", unit_vector);
    let outer = params.required("angle", |args| args.number_in(0.0..=360.0));
    let widest = outer.unwrap_or(0.0);
    let inner = params.or("innerAngle", 0.75 * widest, |args| args.number_in(0.0..=360.0));
    if outer.is_some_and(|outer| inner > outer) {
        params.idle(&["innerAngle"], "beyond `angle`: the edge is sharp");
    }
    if outer == Some(0.0) {
        params.warn(
            "angle",
            "a cone of 0 degrees holds no light; `angle` is that of the whole cone",
            "no cone",
        );
    } else if outer == Some(360.0) {
        let message = "a cone of 360 degrees is no cone: `PointLight` shines in all directions";
        params.warn("angle", message, "all around");
    } else if widest > 180.0 {
        let message =
            "a cone of more than 180 degrees shines backwards too; `angle` is that of the whole cone";
        params.warn("angle", message, "beyond a half space");
    }
    let half = |degrees: f32| 0.5 * degrees.to_radians();
    let cone = Cone::new(half(inner.min(widest)), half(widest));
    let point = read_position_and_brightness(params, spectra, cone.share_of_sphere());
    outer?;
    Some(SpotLight { point: point?, axis: direction?, cone })
}

/// What each of so many units of solid angle or flux has of a whole; nothing where there are none.
fn share_of_each(units: f32) -> f32 {
    if units > 0.0 { 1.0 / units } else { 0.0 }
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
    params.either(&["color", "intensity", "power"], "a light");
    let power = params.optional("power", |args| spectra.emission(args));
    let intensity = match power {
        Some(power) => Some(power.scaled(share_of_each(4.0 * PI * share))),
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
    let (attenuation_key, falloff_key) = (attenuation.map(|(_, item)| item), falloff.map(|(_, item)| item));
    let coefficients = attenuation.map(|(c, _)| c).or(falloff.map(|(f, _)| [0.0, 0.0, f]));
    let attenuation = coefficients.unwrap_or([1.0, 0.0, 0.0]);
    let written = attenuation_key.or(falloff_key);
    if let Some(key) = written.filter(|_| attenuation == [0.0; 3]) {
        let error = Diagnostic::error(format!("`{}` of zero would divide the light by zero", key.keyword()));
        let error = error.label(key.span(), "only zeros");
        params.diagnostics().push(error.help("leave it out for light that does not fall off"));
        return None;
    }
    Some(PointLight { position: position?, intensity, emission, attenuation })
}

/// The factor of the classic formula, and the irradiance that makes a white surface just as bright.
fn classic(color: Written<Emission>) -> (Spectrum, Emission) {
    (color.rgb, color.value.scaled(PI))
}

/// The same from the physical quantity: a white surface under the irradiance `pi` has the radiance 1.
pub(super) fn physical(quantity: Emission) -> (Spectrum, Emission) {
    (Spectrum::from(Vec3::from(quantity.rgb()) / PI), quantity)
}

fn unit_vector(args: &mut Args<'_>) -> Result<Vec3, Diagnostic> {
    let direction = args.vec3()?;
    direction.try_normalize().ok_or_else(|| args.error("`direction` must not be zero"))
}

#[cfg(test)]
mod tests {
    use kajo_color::Wavelengths;
    use kajo_math::{Vec2, Vec3};
    use kajo_scene::{Diagnostics, MemoryAssets, SceneDesc};

    use crate::compile::{CompileOptions, compile};
    use crate::light::Emitter;
    use crate::scene::Scene;

    /// The scene with this light, or the errors.
    fn compiled(light: &str) -> Result<Scene, String> {
        let head = "TILT=NONE\n1 -1 1  2 3 1 2  0 0 0\n1 1 60\n0 180\n";
        let assets = MemoryAssets::new()
            .with("luminaire.ies", format!("{head}0 90 180\n100 100\n200 200\n300 300\n"))
            .with("bad.ies", format!("{head}0 90 180\n100 100\n"));
        let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";
        let mut parsed = SceneDesc::parse_str(&format!("{camera} Lights {{ {light} }}"));
        let mut diagnostics = Diagnostics::default();
        let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
        let said: Vec<_> = diagnostics.iter().map(|d| d.message.clone()).collect();
        scene.filter(|_| said.is_empty()).ok_or_else(|| said.join("; "))
    }

    /// Irradiance at the point `p` from a luminaire at the origin.
    fn irradiance(keys: &str, p: Vec3) -> f32 {
        let scene = compiled(&format!("PointLight {{ position 0 0 0  ies luminaire.ies  {keys} }}")).unwrap();
        scene.lights.photometric[0].sample(p, 0.0, Vec2::ZERO, &Wavelengths::RGB).unwrap().radiance[0]
    }

    #[test]
    fn luminaires_are_turned_tinted_and_scaled() {
        let near =
            |found: f32, expected: f32| assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        // Straight down, the angle 0 is at the side of x, and 90 at that of -z.
        near(irradiance("", 2.0 * Vec3::X), 25.0);
        near(irradiance("", 2.0 * Vec3::NEG_Z), 50.0);
        near(irradiance("rotate 90", Vec3::NEG_Z), 100.0);
        near(irradiance("rotate 90", Vec3::NEG_X), 200.0);
        near(irradiance("direction 0 0 -2", Vec3::X), 100.0);
        near(irradiance("direction 0 0 -2", Vec3::Y), 200.0);
        near(irradiance("direction 1 0 0", Vec3::Z), 100.0);
        near(irradiance("scale 0.5  color 0.5 0.1 0.1", Vec3::X), 25.0);
        // The mean of all directions is 200 candela.
        near(irradiance("power 4", Vec3::NEG_Z), 4.0 / (4.0 * std::f32::consts::PI));
        near(irradiance("power 4", Vec3::X), 2.0 / (4.0 * std::f32::consts::PI));
    }

    #[test]
    fn mistakes_in_luminaires_are_named() {
        let error = |keys: &str| compiled(&format!("PointLight {{ position 0 0 0  {keys} }}")).unwrap_err();
        assert_eq!(error("ies none.ies"), "cannot read `none.ies`: there is no such file");
        assert!(error("ies bad.ies").starts_with("cannot read `bad.ies`: line 6: the file ends"));
        assert!(error("ies luminaire.ies  intensity 3").contains("unknown word `intensity`"));
        assert!(error("ies luminaire.ies  scale -1").contains("at least 0"));
        assert!(error("ies luminaire.ies  power 3  color 1 1 1").contains("not both"));
    }
}
