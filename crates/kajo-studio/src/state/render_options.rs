//! What the window asks of a trace, beyond what the scene says.

use kajo::{Defaults, RenderSettings, Scene, Settings, SettingsError, suitable_size};
use serde::{Deserialize, Serialize};

/// How large traced pictures are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PictureSize {
    /// As many pixels as the viewport has.
    #[default]
    Window,
    /// What the scene says.
    Scene,
    /// Columns and rows.
    Fixed([u32; 2]),
}

/// Everything about traces that the window has a widget for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderOptions {
    /// Wins over the scene; what is absent is as the scene says.
    pub asked: Settings,
    /// Shows the coordinates of the picture instead of the scene.
    pub uv: bool,
    /// What is kept from one start of the program to the next.
    pub habits: Habits,
}

/// Options that belong to the user rather than to a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Habits {
    /// Number of threads; 0 for one a core.
    pub threads: usize,
    /// The first picture of a trace has this many times fewer columns and rows; where nothing refines it, it is
    /// the only one.
    pub downscale: u32,
    /// Whether pictures are refined while one looks.
    pub progressive: bool,
    /// Whether a change starts the trace anew.
    pub live: bool,
    /// Whether samples are added without end.
    pub endless: bool,
    /// Whether a trace starts from the records of irradiance of the one before, where only the camera moved.
    pub keep_records: bool,
    /// Whether a trace records layers that are not shown.
    pub all_layers: bool,
    /// Size of the picture.
    pub size: PictureSize,
    /// Number of pictures of a turntable.
    pub turntable_frames: u32,
}

impl Default for Habits {
    fn default() -> Habits {
        Habits {
            threads: 0,
            downscale: 8,
            progressive: true,
            live: true,
            endless: false,
            keep_records: true,
            all_layers: false,
            size: PictureSize::Window,
            turntable_frames: 36,
        }
    }
}

impl RenderOptions {
    /// What a trace is to do.
    ///
    /// * `window`: pixels of the viewport, of which the picture takes as many as suit the camera
    ///
    /// # Errors
    /// When the size does not suit the camera.
    pub fn resolve(&self, scene: &Scene, window: [u32; 2]) -> Result<RenderSettings, SettingsError> {
        let mut asked = self.asked.clone();
        asked.size = match self.habits.size {
            PictureSize::Window => Some(suitable_size(&scene.output.camera, window)),
            PictureSize::Scene => None,
            PictureSize::Fixed(size) => Some(size.map(|pixels| pixels.max(1))),
        };
        let mut settings = RenderSettings::resolve(scene, &asked, Defaults::Modern, self.uv)?;
        if !self.habits.progressive {
            let coarse = settings.size.map(|pixels| pixels.div_ceil(self.habits.downscale.max(1)));
            settings.size = suitable_size(&scene.output.camera, coarse);
        }
        Ok(settings)
    }

    /// The options without those that change only how a picture is shown, or what else it shows.
    pub fn of_light(&self) -> RenderOptions {
        let asked = Settings { exposure: None, tone: None, white_balance: None, ..self.asked.clone() };
        let habits = Habits { all_layers: false, turntable_frames: 0, ..self.habits.clone() };
        RenderOptions { asked, habits, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo::{LoadOptions, MemoryAssets};

    fn scene(text: &str) -> Scene {
        let assets = MemoryAssets::new().with("scene.txt", text);
        kajo::load_from("scene.txt", &assets, &LoadOptions::default()).scene.expect("a scene")
    }

    const CAMERA: &str = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 } Group {}";

    #[test]
    fn the_size_is_that_of_the_window_the_scene_or_the_user() {
        let scene = scene(&format!("{CAMERA} Settings {{ size 40 30 }}"));
        let mut options = RenderOptions::default();
        let size = |options: &RenderOptions| options.resolve(&scene, [640, 0]).map(|settings| settings.size);
        assert_eq!(size(&options), Ok([640, 1]));
        options.habits.size = PictureSize::Scene;
        assert_eq!(size(&options), Ok([40, 30]));
        options.habits.size = PictureSize::Fixed([7, 0]);
        assert_eq!(size(&options), Ok([7, 1]));
    }

    #[test]
    fn without_refinement_the_coarse_picture_is_the_whole_one() {
        let mut options = RenderOptions::default();
        options.habits.progressive = false;
        let size = |options: &RenderOptions| options.resolve(&scene(CAMERA), [641, 480]).map(|s| s.size);
        assert_eq!(size(&options), Ok([81, 60]));
        options.habits.downscale = 0;
        assert_eq!(size(&options), Ok([641, 480]));
    }

    #[test]
    fn pictures_of_two_eyes_fit_into_the_window() {
        let basis = "center 0 0 0 direction 0 0 -1 up 0 1 0";
        let cubes = scene(&format!("StereoCubemapCamera {{ {basis} }} Group {{}}"));
        let panorama = scene(&format!("PanoramaCamera {{ {basis} stereo omnidirectional }} Group {{}}"));
        let mut options = RenderOptions::default();
        let size = |options: &RenderOptions, scene| options.resolve(scene, [641, 481]).map(|s| s.size);
        assert_eq!(size(&options, &cubes), Ok([636, 53]));
        assert_eq!(size(&options, &panorama), Ok([641, 480]));
        options.habits.progressive = false;
        assert_eq!(size(&options, &cubes), Ok([72, 6]));
        assert_eq!(size(&options, &panorama), Ok([81, 60]));
    }

    #[test]
    fn exposure_does_not_change_the_light() {
        let mut options = RenderOptions::default();
        let before = options.of_light();
        options.asked.exposure = Some(1.0);
        options.habits.all_layers = true;
        options.habits.turntable_frames = 7;
        assert_eq!(options.of_light(), before);
        options.asked.bounces = Some(1);
        assert_ne!(options.of_light(), before);
    }
}
