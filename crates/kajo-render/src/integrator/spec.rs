//! The description of an integrator, from which all lists of integrators are made.

use std::fmt;

use kajo_core::camera::Camera;
use kajo_core::light::LightChoice;
use kajo_core::scene::Scene;
use kajo_core::settings::{IntegratorName, Settings, SettingsKey};
use kajo_core::space::Space;

use super::scatterings::most_scatterings;
use super::{INTEGRATORS, IntegratorSettings};
use crate::{LayerSet, PixelIntegrator};

/// An integrator of the language: one way to use one of the types that take samples.
#[derive(Clone, Copy)]
pub struct IntegratorSpec {
    /// Its name in `Settings` and on the command line.
    pub name: IntegratorName,
    /// What it is, in a few words.
    pub about: &'static str,
    /// What the numbers of its picture are.
    pub quantity: Quantity,
    /// Whether it finds light for any position of the picture, and not only for the pixel that asks.
    pub splats: bool,
    /// Jittered samples of each pixel, unless others are asked for.
    pub samples: u32,
    /// The keys of `Settings` that it has a use for.
    pub keys: &'static [SettingsKey],
    /// Its settings, made of what is said and of its own defaults.
    pub settings: fn(&SettingsContext<'_>) -> IntegratorSettings,
}

impl IntegratorSpec {
    /// The integrator of that name.
    pub fn named(name: IntegratorName) -> Option<&'static IntegratorSpec> {
        INTEGRATORS.into_iter().find(|spec| spec.name == name)
    }
}

/// Says the name, which stands for the rest.
impl fmt::Debug for IntegratorSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("IntegratorSpec").field(&self.name.0).finish()
    }
}

/// What the numbers of a picture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Values of the classic formula, which are those of pixels.
    Shading,
    /// Radiance, of light that is followed along paths.
    Radiance,
    /// How things lie to each other; lights have no part in it.
    Geometry,
}

/// The defaults of a render that neither the scene nor the user overrides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Defaults {
    /// The course program's: 100 × 100 pixels, one ray through the middle of each, no bounces, no shadows,
    /// rays that start 0.001 off surfaces. A scene without a `Group` shows the uv test picture.
    Classic,
    /// What one wants to see: 800 × 600 pixels with 16 jittered rays each, shadows, four bounces, rays that
    /// start as close as rounding allows.
    Modern,
}

/// What an integrator's settings are made of.
#[derive(Clone, Copy, Debug)]
pub struct SettingsContext<'a> {
    /// What the user says, and what the scene says where the user says nothing.
    pub said: &'a Settings,
    /// The scene, for the rules of its dialect.
    pub scene: &'a Scene,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// What holds where nothing is said.
    pub defaults: Defaults,
    /// Whether the uv test picture is asked for in place of the scene.
    pub uv: bool,
}

impl SettingsContext<'_> {
    /// Paths from lights for a pass, unless something else is said: so many for each pixel, but from 10,000 to a million.
    ///
    /// * `each`: at least 1
    pub fn paths_for_pixels(&self, each: u32) -> u32 {
        let [width, height] = self.size;
        let [least, most] = PATHS_OF_PASS;
        width.saturating_mul(height).saturating_mul(each).clamp(least, most)
    }
}

/// The fewest and the most paths from lights for a pass whose number follows the size of the picture.
const PATHS_OF_PASS: [u32; 2] = [10_000, 1_000_000];

/// How often light is scattered by integrators that follow paths from the camera in a scene, unless something else is said: light leaves a
/// dense body after hundreds of collisions, and some of it after thousands.
///
/// * `without`: in scenes without such bodies
pub fn bounces_of_paths(scene: &Scene, without: u32) -> u32 {
    if scene.appearance.has_subsurface { 15_000 } else { without }
}

/// How often light is scattered in a scene with participating media by integrators that join paths from both ends, or look photons up,
/// unless something else is said.
const BOUNCES_IN_MEDIA: u32 = 64;

/// The same where bodies are filled with what light is scattered in many times, and in media that hold it for longer than that.
const BOUNCES_IN_BODIES: u32 = 256;

/// How often light is scattered by such integrators in a scene, unless something else is said.
///
/// * `without`: in scenes without media
pub fn bounces_from_both_ends(scene: &Scene, without: u32) -> u32 {
    match scene.has_media() {
        true if scene.appearance.has_subsurface || most_scatterings(scene) > BOUNCES_IN_MEDIA => {
            BOUNCES_IN_BODIES
        }
        true => BOUNCES_IN_MEDIA,
        false => without,
    }
}

/// The note of integrators that leave participating media out.
pub const WITHOUT_MEDIA: &str = "media are left out: what scatters or absorbs light between surfaces is carried by the \
     integrators that follow paths, such as `path` and `bidirectional`";

/// Why media are not shown, where a scene has any.
pub fn without_media(scene: &Scene) -> Option<&'static str> {
    scene.has_media().then_some(WITHOUT_MEDIA)
}

/// The note of integrators that leave out that bodies bend light.
pub const WITHOUT_CURVES: &str = "light goes straight through bodies and lenses that bend it: the integrators that follow paths, such as \
     `path`, bend it";

/// Why light is not bent, where a scene has bodies that do.
pub fn without_curves(scene: &Scene) -> Option<&'static str> {
    let materials = &scene.appearance.materials;
    let has_lens = materials.ids().any(|id| materials.is_thin_lens(id));
    (scene.space() == Space::Curved || has_lens).then_some(WITHOUT_CURVES)
}

/// The note of integrators that leave out speeds near that of light.
const WITHOUT_FRAMES: &str = "what a `Lorentz` holds is left out, and the camera's `velocity`: light at such speeds is followed by \
     `path`, `direct` and `distribution`";

/// Why things that move that fast are not shown, where a scene has any.
pub fn without_frames(scene: &Scene) -> Option<&'static str> {
    scene.relativity.is_some().then_some(WITHOUT_FRAMES)
}

/// The note of integrators that do not learn which lights arrive.
const WITHOUT_LEARNING: &str = "lights are chosen as by `lightChoice tree`: which of them arrive is learned by `path`, `direct` and \
     `distribution`, not with `caustics manifold` and not at speeds near that of light";

/// Why lights are not chosen by what is learned, where that is asked for.
pub fn without_learning(values: &Settings) -> Option<&'static str> {
    (values.light_choice == Some(LightChoice::Learned)).then_some(WITHOUT_LEARNING)
}

/// The settings of an integrator, of which it is made: what each variant of [`IntegratorSettings`] does.
pub trait Prepare: Copy {
    /// The integrator, ready to take samples of a picture of `size` pixels with these `layers`.
    ///
    /// * `camera`: the scene's, or another one
    fn prepare<'a>(
        self,
        scene: &'a Scene,
        camera: &'a Camera,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Box<dyn PixelIntegrator + 'a>;

    /// The values that hold for the keys of `Settings` which it listens to.
    fn values(&self) -> Settings;

    /// Whether it follows light between inertial frames, [`kajo_core::scene::Relativity`].
    fn follows_frames(&self) -> bool {
        false
    }

    /// Whether it can choose lights by what is learned of them before, [`LightChoice::Learned`].
    fn learns_lights(&self, _scene: &Scene) -> bool {
        false
    }

    /// What it leaves out of a scene, a sentence each, beyond what follows from its [`Quantity`], from
    /// [`Prepare::follows_frames`] and [`Prepare::learns_lights`].
    ///
    /// * `size`: columns and rows of the picture
    fn left_out(&self, _scene: &Scene, _size: [u32; 2]) -> Vec<&'static str> {
        Vec::new()
    }
}
