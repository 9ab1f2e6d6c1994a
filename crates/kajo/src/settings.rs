//! What a render is asked to do: the command line wins over the scene, the scene over the defaults.

use kajo_color::Tone;
use kajo_core::camera::Camera;
use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_core::settings::{FilterChoice, IntegratorName, MapRules, Rules, Settings, SettingsKey};
use kajo_render::integrator::{
    self, Choice, Defaults, IntegratorSettings, IntegratorSpec, Prepare, Quantity, SettingsContext,
};
use kajo_render::{DepthMap, Filter, NormalMap, Rect};

use crate::reduction::SIDE;
use crate::{Development, Reduction};

mod idle;

/// Everything about a render but who runs it.
#[derive(Clone, Copy, Debug)]
pub struct RenderSettings {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Pattern and number of samples of each pixel.
    pub samples: (SamplerKind, u32),
    /// How samples become pixels.
    pub filter: Filter,
    /// The most that a sample brings of light that was scattered; `None` for any amount. See [`FilmSpec::clamp`](kajo_render::FilmSpec::clamp).
    pub clamp: Option<f32>,
    /// Seed of every random number.
    pub seed: u64,
    /// How light is followed.
    pub integrator: &'static IntegratorSpec,
    /// Why it is this one, where the scene has chosen.
    pub why: Option<&'static str>,
    /// The options of that integrator.
    pub integrator_settings: IntegratorSettings,
    /// Distances that are white and black in a depth picture; what the picture spans, where absent.
    pub depth_range: Option<[f32; 2]>,
    /// How depth, normals and numbers become pictures.
    pub maps: MapRules,
    /// How light becomes values; has no say in what is rendered.
    pub development: Development,
    /// Whether PNG and TGA files get an alpha channel of ones, as the course program writes them.
    pub opaque_alpha: bool,
    /// Three by three pixels become one when a picture is written; `size` counts them before.
    pub reduction: Option<Reduction>,
    /// The part of the picture that is rendered and shown; its pixels have the same bits as in the whole.
    pub crop: Option<Rect>,
}

/// Why a scene cannot be rendered as asked.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// A stereo cubemap is twelve squares in a row.
    #[error("a stereo cubemap needs a picture 12 times as wide as high, not {} x {}; ask for {} x {}",
        .0[0], .0[1], .0[1].saturating_mul(12), .0[1])]
    NotTwelveToOne([u32; 2]),
    /// Two eyes above each other.
    #[error("a stereo panorama needs an even height, one half for each eye, not {}", .0[1])]
    OddHeight([u32; 2]),
    /// A part of a picture lies outside of it.
    #[error("the part of {} x {} pixels from ({}, {}) on reaches beyond the picture of {} x {}",
        .part.width(), .part.height(), .part.x0, .part.y0, .size[0], .size[1])]
    Outside {
        /// The part that is to be rendered.
        part: Rect,
        /// Columns and rows of the picture.
        size: [u32; 2],
    },
    /// There is no integrator of that name; scenes and command lines are told so before.
    #[error("there is no integrator `{0}`")]
    NoIntegrator(IntegratorName),
}

impl RenderSettings {
    /// Puts together what `asked` says, what the scene says and the defaults.
    ///
    /// * `uv`: show the uv test picture
    ///
    /// # Errors
    /// [`SettingsError`] when the size does not suit the camera.
    pub fn resolve(
        scene: &Scene,
        asked: &Settings,
        defaults: Defaults,
        uv: bool,
    ) -> Result<RenderSettings, SettingsError> {
        let said = asked.or(&scene.output.settings);
        let is_course = defaults == Defaults::Classic;
        let size = said.size.unwrap_or_else(|| default_size(&scene.output.camera, defaults));
        check_size(&scene.output.camera, size)?;
        let (integrator, why) = match said.integrator {
            Some(integrator::AUTO) => {
                let Choice { integrator, why } = integrator::choose(scene);
                (integrator, Some(why))
            }
            Some(name) => (IntegratorSpec::named(name).ok_or(SettingsError::NoIntegrator(name))?, None),
            None => (integrator::DEFAULT, None),
        };
        let default_samples =
            if is_course { (SamplerKind::Regular, 1) } else { (SamplerKind::Jittered, integrator.samples) };
        let context = SettingsContext { said: &said, scene, size, defaults, uv };
        Ok(RenderSettings {
            size,
            samples: said.samples.unwrap_or(default_samples),
            filter: film_filter(said.filter.unwrap_or(FilterChoice::None), &scene.output.rules, integrator),
            clamp: said.clamp.filter(|&limit| limit > 0.0 && integrator.keys.contains(&SettingsKey::Clamp)),
            seed: said.seed.unwrap_or(0),
            integrator,
            why,
            integrator_settings: (integrator.settings)(&context),
            depth_range: said.depth_range,
            maps: scene.output.rules.maps,
            development: development(integrator, &said),
            opaque_alpha: is_course,
            reduction: None,
            crop: None,
        })
    }

    /// The same for a part of the picture alone.
    ///
    /// # Errors
    /// [`SettingsError::Outside`] when it is not within the picture, or has no pixels.
    pub fn cropped(self, part: Rect) -> Result<RenderSettings, SettingsError> {
        let [width, height] = self.size;
        let is_within = part.area() > 0 && part.intersection(&Rect::of_size(width, height)) == part;
        match is_within {
            true => Ok(RenderSettings { crop: Some(part), ..self }),
            false => Err(SettingsError::Outside { part, size: self.size }),
        }
    }

    /// Columns and rows of what is shown.
    pub fn shown_size(&self) -> [u32; 2] {
        let rendered = self.crop.map_or(self.size, |part| [part.width(), part.height()]);
        rendered.map(|n| if self.reduction.is_some() { n / SIDE } else { n })
    }

    /// What of the scene and of the settings the integrator leaves out, a sentence each.
    pub fn left_out(&self, scene: &Scene) -> Vec<&'static str> {
        let is_shading = self.integrator.quantity == Quantity::Shading;
        let is_light = self.integrator.quantity == Quantity::Radiance;
        let emitters = &scene.lighting.lights;
        let unfading = emitters.point.iter().any(|light| light.attenuation[2] == 0.0)
            || emitters.spots.iter().any(|light| light.point.attenuation[2] == 0.0);
        let notes = [
            (
                !is_shading && scene.lighting.fog.is_some(),
                "`Fog` is left out: only the classic integrator knows it",
            ),
            (
                is_light && !scene.lighting.ambient.is_black() && !scene.lighting.list.is_empty(),
                "`ambientLight` is left out: indirect light takes its place",
            ),
            (is_light && !scene.has_lights(), "nothing in this scene gives light, so the picture is black"),
            (
                is_light && unfading,
                "a light here does not fade with the square of the distance, as real ones do; give it an `intensity`",
            ),
            (
                !is_light && scene.lighting.groups.len() > 1,
                "groups of lights are not told apart here: only integrators that follow paths do so",
            ),
        ];
        let general = notes.into_iter().filter_map(|(applies, note)| applies.then_some(note));
        general.chain(self.integrator_settings.left_out(scene, self.size)).collect()
    }

    /// The same for a picture whose pixels are made of three by three each, of one ray.
    ///
    /// * `at_random`: each ray anywhere in its pixel of those
    pub fn reduced(self, reduction: Reduction, at_random: bool) -> RenderSettings {
        let kind = if at_random { SamplerKind::Jittered } else { SamplerKind::Regular };
        let size = self.size.map(|n| n.saturating_mul(SIDE));
        RenderSettings { size, samples: (kind, 1), filter: Filter::None, reduction: Some(reduction), ..self }
    }

    /// The values that hold for the keys of `Settings` that have a say in the light.
    pub fn values(&self) -> Settings {
        Settings {
            size: Some(self.size),
            integrator: Some(self.integrator.name),
            samples: Some(self.samples),
            tone: Some(self.development.tone),
            clamp: self.integrator.keys.contains(&SettingsKey::Clamp).then(|| self.clamp.unwrap_or(0.0)),
            ..self.integrator_settings.values()
        }
    }

    /// Where samples lie within a pixel.
    pub fn sampler(&self) -> Sampler {
        Sampler::new(self.samples.0, self.samples.1)
    }

    /// How distances become grey, where a range is given.
    pub(crate) fn depth_map(&self) -> DepthMap {
        let [min, max] = self.depth_range.unwrap_or([0.0, 1.0]);
        DepthMap { min, max, far_is_white: self.maps == MapRules::Direct }
    }

    /// How normals become colours.
    pub(crate) fn normal_map(&self) -> NormalMap {
        match self.maps {
            MapRules::Inverted => NormalMap::Absolute,
            MapRules::Direct => NormalMap::Biased,
        }
    }
}

/// The classic integrator's numbers are the picture's, as in the course; light is encoded for a display.
fn development(integrator: &IntegratorSpec, said: &Settings) -> Development {
    let tone = if integrator.quantity == Quantity::Shading { Tone::Linear } else { Tone::Srgb };
    Development {
        exposure: said.exposure.unwrap_or(0.0),
        white: said.white_balance,
        tone: said.tone.unwrap_or(tone),
        ..Development::default()
    }
}

/// A size that the camera's picture looks right in.
fn default_size(camera: &Camera, defaults: Defaults) -> [u32; 2] {
    match camera.natural_aspect() {
        Some(aspect) if aspect > 2.0 => [3072, 256],
        Some(aspect) if aspect > 1.0 => [1024, 512],
        Some(_) => [1024, 1024],
        None if defaults == Defaults::Classic => [100, 100],
        None => [800, 600],
    }
}

/// The size of a picture that suits a camera and is no larger than another size, if it can be.
pub fn suitable_size(camera: &Camera, within: [u32; 2]) -> [u32; 2] {
    let [width, height] = within.map(|pixels| pixels.max(1));
    match camera.cells() {
        [12, _] => {
            let side = (width / 12).clamp(1, height);
            [12 * side, side]
        }
        [_, 2] => [width, (height & !1).max(2)],
        _ => [width, height],
    }
}

fn check_size(camera: &Camera, size: [u32; 2]) -> Result<(), SettingsError> {
    let [width, height] = size;
    match camera.cells() {
        [12, _] if u64::from(width) != 12 * u64::from(height) => Err(SettingsError::NotTwelveToOne(size)),
        [_, 2] if height % 2 != 0 => Err(SettingsError::OddHeight(size)),
        _ => Ok(()),
    }
}

fn film_filter(choice: FilterChoice, rules: &Rules, integrator: &IntegratorSpec) -> Filter {
    match choice {
        // The sums of splats know products of profiles only.
        FilterChoice::Tent(radius) if rules.radial_tent && !integrator.splats => Filter::Cone { radius },
        FilterChoice::Gaussian(sigma) if rules.gaussian_of_whole_pixels => {
            Filter::gaussian_of_whole_pixels(sigma)
        }
        FilterChoice::None => Filter::None,
        FilterChoice::Box(radius) => Filter::Box { radius },
        FilterChoice::Tent(radius) => Filter::Tent { radius },
        FilterChoice::Gaussian(sigma) => Filter::gaussian(sigma),
        FilterChoice::Mitchell(radius) => Filter::Mitchell { radius },
        FilterChoice::Lanczos(radius) => Filter::Lanczos { radius },
    }
}

#[cfg(test)]
mod tests {
    use kajo_core::RayOffset;
    use kajo_core::settings::Shadows;

    use super::*;
    use crate::{LoadOptions, MemoryAssets, load_from};

    const CAMERA: &str = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";

    fn scene(text: &str) -> Scene {
        let assets = MemoryAssets::new().with("scene.txt", text);
        let loaded = load_from("scene.txt", &assets, &LoadOptions::default());
        assert!(loaded.scene.is_some(), "{}", loaded.report(false));
        loaded.scene.unwrap()
    }

    fn resolve(scene: &Scene, asked: &Settings, defaults: Defaults) -> RenderSettings {
        RenderSettings::resolve(scene, asked, defaults, false).unwrap()
    }

    #[test]
    fn the_command_line_wins_over_the_scene_and_the_scene_over_the_defaults() {
        let scene = scene(&format!("{CAMERA} Group {{}} Settings {{ size 40 30  bounces 7 }}"));
        let asked = Settings { bounces: Some(2), ..Settings::default() };
        let settings = resolve(&scene, &asked, Defaults::Modern);
        assert_eq!((settings.size, settings.values().bounces), ([40, 30], Some(2)));
        assert_eq!(settings.samples, (SamplerKind::Jittered, 16));
        assert_eq!(settings.values().shadows, Some(Shadows::Opaque));
    }

    #[test]
    fn classic_defaults_are_those_of_the_course() {
        let settings = resolve(&scene(CAMERA), &Settings::default(), Defaults::Classic);
        assert_eq!((settings.size, settings.samples), ([100, 100], (SamplerKind::Regular, 1)));
        let IntegratorSettings::Classic(classic) = settings.integrator_settings else {
            panic!("{settings:?}")
        };
        assert_eq!((classic.bounces, classic.shadows), (0, Shadows::Off));
        assert_eq!((settings.filter, classic.ray_offset), (Filter::None, RayOffset::Reference));
        assert!(classic.uv, "there is no group");
        let modern = resolve(&scene(CAMERA), &Settings::default(), Defaults::Modern);
        assert!(matches!(modern.integrator_settings, IntegratorSettings::Classic(classic) if !classic.uv));
    }

    #[test]
    fn a_scene_may_choose_its_integrator() {
        let world = "Fog { color 1 1 1 density 0.1 } Lights { PointLight { position 0 1 0 color 1 1 1 } }";
        let scene = scene(&format!("{CAMERA} Settings {{ integrator auto  branches 3 }} {world} Group {{}}"));
        let settings = resolve(&scene, &Settings::default(), Defaults::Modern);
        assert_eq!(settings.integrator.name.0, "classic");
        assert!(settings.why.is_some_and(|why| why.contains("classic formula")));
        let idle = settings.without_effect(&Settings::default(), &scene.output.settings).join("; ");
        assert!(idle.contains("`branches` has no effect with `integrator classic`"), "{idle}");
        let asked = Settings { integrator: Some(IntegratorName("path")), ..Settings::default() };
        assert_eq!(resolve(&scene, &asked, Defaults::Modern).why, None);
    }

    #[test]
    fn what_an_integrator_leaves_out_is_said() {
        let world = "Fog { color 1 1 1 density 0.1 } Background { color 0 0 0 ambientLight 1 1 1 }
            Lights { PointLight { position 0 1 0 color 1 1 1 } } Group {}";
        let scene = scene(&format!("{CAMERA} {world}"));
        let left_out = |integrator| {
            let asked = Settings { integrator: Some(IntegratorName(integrator)), ..Settings::default() };
            resolve(&scene, &asked, Defaults::Modern).left_out(&scene).join("; ")
        };
        assert_eq!(left_out("classic"), "");
        let path = left_out("path");
        let expected = ["`Fog`", "`ambientLight`", "does not fade"];
        assert!(expected.iter().all(|word| path.contains(word)) && !path.contains("black"), "{path}");
        assert!(!left_out("light").contains("does not find"));
        assert_eq!(left_out("occlusion").matches("left out").count(), 1);
    }

    #[test]
    fn integrators_that_do_not_tell_groups_of_lights_apart_say_so() {
        let world = "Lights { PointLight { position 0 1 0 intensity 1 group key } } Group {}";
        let scene = scene(&format!("{CAMERA} {world}"));
        for (integrator, tells) in [
            ("path", true),
            ("bidirectional", true),
            ("vcm", true),
            ("light", false),
            ("photon", false),
            ("sppm", false),
            ("irradiance", false),
            ("mlt", false),
            ("mmlt", false),
            ("classic", false),
        ] {
            let asked = Settings { integrator: Some(IntegratorName(integrator)), ..Settings::default() };
            let left_out = resolve(&scene, &asked, Defaults::Modern).left_out(&scene).join("; ");
            assert_eq!(left_out.contains("of lights"), !tells, "{integrator}: {left_out}");
        }
    }

    #[test]
    fn what_is_fast_is_followed_by_paths_and_said_to_be_left_out_by_others() {
        let world = "Materials { Matte emitter { color 0 0 0 emission 1 } }
            Group { MaterialIndex emitter Lorentz { velocity 0.5 0 0 Sphere { center 0 0 0 radius 1 } } }";
        let scene = scene(&format!("{CAMERA} {world}"));
        let left_out = |integrator, spectral| {
            let integrator = Some(IntegratorName(integrator));
            let asked = Settings { integrator, spectral: Some(spectral), ..Settings::default() };
            resolve(&scene, &asked, Defaults::Modern).left_out(&scene).join("; ")
        };
        assert_eq!(left_out("path", true), "");
        assert!(left_out("direct", false).contains("Doppler"));
        assert!(left_out("distribution", true).contains("one path"));
        for integrator in
            ["classic", "bidirectional", "light", "mlt", "mmlt", "photon", "sppm", "vcm", "occlusion"]
        {
            assert!(left_out(integrator, false).contains("`Lorentz`"), "{integrator}");
        }
    }

    #[test]
    fn light_from_lights_finds_no_rolling_shutter_while_things_move() {
        let found = |keys: &str, motion: &str| {
            let camera = format!(
                "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30  shutter 0 1  {keys} }}"
            );
            let world = format!(
                "Materials {{ Matte grey {{ color 0.5 0.5 0.5 }} }}
                Group {{ MaterialIndex grey Transform {{ {motion} Sphere {{ center 0 0 0 radius 1 }} }} }}"
            );
            let scene = scene(&format!("{camera} {world}"));
            let asked = Settings { integrator: Some(IntegratorName("light")), ..Settings::default() };
            !resolve(&scene, &asked, Defaults::Modern).left_out(&scene).join("; ").contains("does not find")
        };
        let motion = "Motion { key 0 { } key 1 { Translate 1 0 0 } }";
        assert!(!found("rollingShutter 0.5", motion));
        assert!(found("rollingShutter 0.5", "") && found("", motion));
    }

    #[test]
    fn light_is_encoded_for_a_display_and_classic_numbers_are_not() {
        let scene = scene(&format!("{CAMERA} Group {{}} Settings {{ exposure 1.5 }}"));
        let tone = |integrator, tone| {
            let asked =
                Settings { integrator: Some(IntegratorName(integrator)), tone, ..Settings::default() };
            resolve(&scene, &asked, Defaults::Modern).development.tone
        };
        assert_eq!(tone("classic", None), Tone::Linear);
        assert_eq!(tone("path", None), Tone::Srgb);
        assert_eq!(tone("path", Some(Tone::Agx)), Tone::Agx);
        assert_eq!(resolve(&scene, &Settings::default(), Defaults::Modern).development.exposure, 1.5);
    }

    #[test]
    fn the_size_must_suit_the_camera() {
        let basis = "center 0 0 0 direction 0 0 -1 up 0 1 0";
        let cubes = scene(&format!("StereoCubemapCamera {{ {basis} }}"));
        let panorama = scene(&format!("PanoramaCamera {{ {basis} stereo omnidirectional }}"));
        assert_eq!(resolve(&cubes, &Settings::default(), Defaults::Classic).size, [3072, 256]);
        assert_eq!(resolve(&panorama, &Settings::default(), Defaults::Modern).size, [1024, 1024]);
        let with_size = |scene, size| {
            let asked = Settings { size: Some(size), ..Settings::default() };
            RenderSettings::resolve(scene, &asked, Defaults::Classic, false).map(|settings| settings.size)
        };
        assert_eq!(with_size(&cubes, [120, 10]), Ok([120, 10]));
        assert_eq!(with_size(&cubes, [100, 100]), Err(SettingsError::NotTwelveToOne([100, 100])));
        assert_eq!(with_size(&panorama, [10, 11]), Err(SettingsError::OddHeight([10, 11])));
        let message = with_size(&cubes, [100, u32::MAX]).unwrap_err().to_string();
        assert!(message.contains("12 times as wide"), "{message}");
    }
}
