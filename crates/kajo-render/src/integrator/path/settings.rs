//! The integrators that are path tracing with other settings.

use kajo_core::camera::Camera;
use kajo_core::light::{LightChoice, LightSelection};
use kajo_core::scene::Scene;
use kajo_core::settings::{Caustics, Directions, IntegratorName, Settings, SettingsKey, Technique};
use kajo_core::space::Space;

use crate::integrator::{
    IntegratorSettings, IntegratorSpec, Prepare, Quantity, SettingsContext, bounces_of_paths,
};
use crate::{LayerSet, PixelIntegrator};

/// Options of [`Path`](super::Path).
#[derive(Clone, Copy, Debug)]
pub struct PathSettings {
    /// How often light is scattered on its way from one surface to another; 0 shows what lights light themselves.
    pub bounces: u32,
    /// Mirrors and clear boundaries that a path may meet before any other surface without a bounce being counted.
    pub free_mirrors: u32,
    /// Whether paths go on from mirrors and glass only, so that nothing but direct light is seen.
    pub only_mirrors: bool,
    /// How direct light is estimated.
    pub technique: Technique,
    /// How lights are chosen.
    pub light_choice: LightChoice,
    /// How directions are drawn.
    pub directions: Directions,
    /// Paths that go on from the first surface that is no mirror: more than one is distribution ray tracing
    /// [Cook et al. 1984].
    pub branches: u32,
    /// Whether paths of little weight end at random.
    pub roulette: bool,
    /// Whether light is followed by wavelength.
    pub spectral: bool,
    /// How lights behind glass are found.
    pub caustics: Caustics,
    /// Whether directions are drawn by where light has come from, too [Müller, Gross and Novák 2017].
    pub guiding: bool,
    /// Samples of each pixel by which that is learned.
    pub training: u32,
}

impl PathSettings {
    /// What holds where nothing is said.
    pub const DEFAULT: PathSettings = PathSettings {
        bounces: 16,
        free_mirrors: 0,
        only_mirrors: false,
        technique: Technique::Combined,
        light_choice: LightChoice::Tree,
        directions: Directions::Scattering,
        branches: 1,
        roulette: true,
        spectral: false,
        caustics: Caustics::Scattering,
        guiding: false,
        training: 16,
    };
}

impl Default for PathSettings {
    fn default() -> PathSettings {
        PathSettings::DEFAULT
    }
}

/// How often light is scattered in a scene with media, unless something else is said.
const BOUNCES_IN_MEDIA: u32 = 1000;

/// Samples of each pixel, unless others are asked for.
const PATH_SAMPLES: u32 = 64;

/// Samples of a picture for each by which a guide learns, unless something else is said.
const TRAINED: u32 = 4;

/// Samples of each pixel by which a guide learns at most, unless more are asked for.
const MOST_TRAINING: u32 = 64;

/// Path tracing.
pub const PATH: IntegratorSpec = IntegratorSpec {
    name: IntegratorName("path"),
    about: "light along paths of any length",
    quantity: Quantity::Radiance,
    splats: false,
    samples: PATH_SAMPLES,
    keys: &{
        let [bounces, technique, directions, light_choice, roulette, clamp, spectral] = KEYS;
        let [caustics, guiding, training] =
            [SettingsKey::Caustics, SettingsKey::Guiding, SettingsKey::Training];
        [bounces, technique, directions, light_choice, caustics, roulette, clamp, spectral, guiding, training]
    },
    settings: |context| {
        let path = PathSettings::default();
        // Light in clouds is scattered hundreds of times before it gets out, and with fewer they would be grey.
        let bounces = if context.scene.has_media() { BOUNCES_IN_MEDIA } else { path.bounces };
        let bounces = bounces_of_paths(context.scene, bounces);
        let caustics = context.said.caustics.unwrap_or(path.caustics);
        let guiding = context.said.guiding.unwrap_or(path.guiding);
        // A number that is not used is no reason why a render could not go on to more samples.
        let training = match context.said.samples {
            Some((_, samples)) if guiding => (samples / TRAINED).clamp(1, MOST_TRAINING),
            _ => PATH_SAMPLES / TRAINED,
        };
        IntegratorSettings::Path(PathSettings {
            caustics,
            guiding,
            training: context.said.training.unwrap_or(training),
            ..said(context, PathSettings { bounces, ..path })
        })
    },
};

/// Direct light.
pub const DIRECT: IntegratorSpec = IntegratorSpec {
    name: IntegratorName("direct"),
    about: "light that comes straight from emitters, and through mirrors and glass",
    settings: |context| {
        let default = PathSettings { only_mirrors: true, ..PathSettings::default() };
        IntegratorSettings::Path(said(context, default))
    },
    keys: &KEYS,
    ..PATH
};

/// Distribution ray tracing.
pub const DISTRIBUTION: IntegratorSpec = IntegratorSpec {
    name: IntegratorName("distribution"),
    about: "many rays from the first surface that is no mirror",
    samples: 16,
    keys: &{
        let [bounces, technique, directions, light_choice, roulette, clamp, spectral] = KEYS;
        [bounces, technique, directions, light_choice, roulette, clamp, spectral, SettingsKey::Branches]
    },
    settings: |context| {
        let path = PathSettings::default();
        // What is behind glass has its indirect light too.
        let free_mirrors = path.bounces;
        let default = PathSettings { bounces: 1, free_mirrors, roulette: false, ..path };
        let branches = context.said.branches.unwrap_or(16);
        IntegratorSettings::Path(PathSettings { branches, ..said(context, default) })
    },
    ..PATH
};

/// What is said of walks where light bends or is scattered on its way.
pub const WITHOUT_WALKS: &str = "`caustics manifold` has no effect in scenes with media, bodies that bend light, or speeds near that of light";

/// What is said of bodies that bend light in a scene with inertial frames.
const WITHOUT_CURVES_AMONG_FRAMES: &str =
    "between things that move nearly as fast as light it goes straight through bodies that bend it";

/// The note for a render in which `guiding` has no effect.
const WITHOUT_GUIDE: &str = "`guiding` has no effect: directions are guided where they are drawn by scattering alone, and `directions` or `caustics` asks for another rule";

/// What all of them listen to.
const KEYS: [SettingsKey; 7] = [
    SettingsKey::Bounces,
    SettingsKey::Technique,
    SettingsKey::Directions,
    SettingsKey::LightChoice,
    SettingsKey::Roulette,
    SettingsKey::Clamp,
    SettingsKey::Spectral,
];

/// What is said for the keys that all of them listen to, and `default` where nothing is.
fn said(context: &SettingsContext<'_>, default: PathSettings) -> PathSettings {
    let said = context.said;
    PathSettings {
        bounces: said.bounces.unwrap_or(default.bounces),
        technique: said.technique.unwrap_or(default.technique),
        directions: said.directions.unwrap_or(default.directions),
        light_choice: said.light_choice.unwrap_or(default.light_choice),
        roulette: said.roulette.unwrap_or(default.roulette),
        spectral: said.spectral.unwrap_or(default.spectral),
        ..default
    }
}

impl PathSettings {
    /// Whether lights are drawn in a scene that shine through glass or by way of mirrors: between these light has to go straight and
    /// unscattered.
    pub(in crate::integrator) fn walks_in(&self, scene: &Scene) -> bool {
        self.caustics == Caustics::Manifold && !lacks_segments(scene)
    }

    /// How lights are chosen, without what is known of a scene.
    pub(super) fn light_selection(&self) -> LightSelection<'static> {
        self.selection(LightSelection::from(self.light_choice))
    }

    /// A choice of lights, beside scattering or alone.
    pub(super) fn selection<'v>(&self, by: LightSelection<'v>) -> LightSelection<'v> {
        if self.technique == Technique::Lights { by.alone() } else { by }
    }

    /// Whether there is anything that a guide could do.
    pub(super) fn is_guided(&self) -> bool {
        self.guiding && self.directions == Directions::Scattering && self.branches == 1 && self.bounces > 0
    }
}

/// Whether light is scattered or bent between surfaces.
fn lacks_segments(scene: &Scene) -> bool {
    scene.has_media() || scene.space() == Space::Curved || scene.relativity.is_some()
}

impl Prepare for PathSettings {
    fn prepare<'a>(
        self,
        scene: &'a Scene,
        camera: &'a Camera,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Box<dyn PixelIntegrator + 'a> {
        super::integrator_of(camera, scene, self, size, layers)
    }

    fn values(&self) -> Settings {
        Settings {
            bounces: Some(self.bounces),
            technique: Some(self.technique),
            directions: Some(self.directions),
            light_choice: Some(self.light_choice),
            roulette: Some(self.roulette),
            spectral: Some(self.spectral),
            branches: Some(self.branches),
            caustics: Some(self.caustics),
            guiding: Some(self.guiding),
            training: Some(self.training),
            ..Settings::default()
        }
    }

    fn follows_frames(&self) -> bool {
        true
    }

    fn learns_lights(&self, scene: &Scene) -> bool {
        // A light in a bulb is to be drawn all the same where its glass is followed.
        scene.relativity.is_none() && !self.walks_in(scene)
    }

    fn left_out(&self, scene: &Scene, _size: [u32; 2]) -> Vec<&'static str> {
        let walks = self.caustics == Caustics::Manifold && lacks_segments(scene);
        let walks = walks.then_some(WITHOUT_WALKS).into_iter();
        if scene.relativity.is_none() {
            let is_idle = self.guiding && (self.directions != Directions::Scattering || self.walks_in(scene));
            return walks.chain(is_idle.then_some(WITHOUT_GUIDE)).collect();
        }
        let notes = [
            (self.guiding, "paths between things that move nearly as fast as light are not guided"),
            (
                !self.spectral,
                "the Doppler effect makes colours brighter or darker and leaves their hue: with `spectral on` they are shifted",
            ),
            (
                self.branches > 1 || self.directions != Directions::Scattering,
                "between things that move nearly as fast as light each sample follows one path, in directions drawn by scattering",
            ),
            (scene.has_media(), "media are left out between things that move nearly as fast as light"),
        ];
        let notes = notes.into_iter().filter_map(|(applies, note)| applies.then_some(note));
        walks
            .chain(notes)
            .chain((scene.space() == Space::Curved).then_some(WITHOUT_CURVES_AMONG_FRAMES))
            .collect()
    }
}
