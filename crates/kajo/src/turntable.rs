//! Pictures from all around: the camera is carried once around a centre, level all the time.

use std::path::{Path, PathBuf};

use kajo_core::scene::Scene;
use kajo_image::{BitDepth, Format, ImageError};
use kajo_math::DVec3;
use kajo_render::Progress;

use crate::output::{OutputError, Target};
use crate::{CameraPose, KeptState, RenderError, RenderRequest, RenderSettings, Resources, View, render};

/// The frames of a turntable.
#[derive(Clone, Debug)]
pub struct Turntable {
    /// The camera of the first frame.
    pub start: CameraPose,
    /// What it goes around, in world space.
    pub center: DVec3,
    /// How many pictures the turn is divided into.
    pub frames: u32,
    /// What they show.
    pub view: View,
}

/// Why the pictures are not all there.
#[derive(Debug, thiserror::Error)]
pub enum TurntableError {
    /// A picture could not be rendered, or somebody stopped it.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A picture does not fit into its file.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A file could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

impl Turntable {
    /// The cameras of all frames; the first is the one it starts from.
    pub fn cameras(&self) -> impl Iterator<Item = CameraPose> {
        (0..self.frames).map(|frame| {
            let mut camera = self.start.clone();
            if frame > 0 {
                let turn = std::f64::consts::TAU * f64::from(frame) / f64::from(self.frames);
                camera.orbit(self.center, turn, 0.0);
            }
            camera
        })
    }

    /// The files of all frames: `path` with the number of the frame, from 0, before the ending.
    pub fn files(&self, path: &Path) -> Vec<PathBuf> {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let ending =
            path.extension().map(|ending| format!(".{}", ending.to_string_lossy())).unwrap_or_default();
        let digits = self.frames.saturating_sub(1).to_string().len().max(3);
        let name = |frame: u32| path.with_file_name(format!("{stem}_{frame:0digits$}{ending}"));
        (0..self.frames).map(name).collect()
    }

    /// Renders all frames and writes them to [`Turntable::files`]; returns their paths.
    ///
    /// Each frame starts from the records of irradiance of those before.
    ///
    /// * `inputs`: real paths of files that must not be overwritten
    /// * `progress`: told of all frames together
    ///
    /// # Errors
    /// [`TurntableError`]. All files are checked before the first picture is rendered; those that were finished
    /// stay.
    pub fn write(
        &self,
        scene: &Scene,
        settings: &RenderSettings,
        path: &Path,
        inputs: &[PathBuf],
        resources: &Resources,
        progress: &dyn Progress,
    ) -> Result<Vec<PathBuf>, TurntableError> {
        let files = self.files(path);
        let targets = Target::check_all(&files, inputs)?;
        let ending = path.extension().map(|ending| ending.to_string_lossy());
        let format = ending.and_then(|ending| Format::from_extension(&ending)).unwrap_or(Format::Png);
        let kept = KeptState::default();
        for ((frame, camera), target) in (0..).zip(self.cameras()).zip(&targets) {
            let part = Part { progress, frame, frames: self.frames };
            let outputs = [(self.view, format)];
            let request = RenderRequest::new(scene, settings, &outputs).through(&camera).with(*resources);
            let picture = render(&request.keeping(&kept), &part)?;
            target.write(&picture.encode(&[self.view], format, BitDepth::Eight)?)?;
        }
        Ok(files)
    }
}

/// Progress over all frames.
struct Part<'a> {
    progress: &'a dyn Progress,
    frame: u32,
    frames: u32,
}

impl Progress for Part<'_> {
    fn done(&self, pixels_done: u64, pixels_total: u64, rays: u64) {
        let before = u64::from(self.frame) * pixels_total;
        self.progress.done(before + pixels_done, u64::from(self.frames) * pixels_total, rays);
    }

    fn cancelled(&self) -> bool {
        self.progress.cancelled()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use kajo_core::settings::Settings;

    use super::*;
    use crate::{Defaults, LoadOptions, MemoryAssets, Silent, load_from, probe, render};

    fn scene() -> Scene {
        let text = "PerspectiveCamera { center 0 2 9 direction 0 -0.2 -1 up 0 1 0 angle 40 }
            Background { ambientLight 1 1 1 }
            Materials { Material { diffuseColor 1 0 0 } Material { diffuseColor 0 0 1 } }
            Group { MaterialIndex 0 Sphere { center 2 0 0 radius 1 }
                    MaterialIndex 1 Sphere { center -2 0 0 radius 1 } }";
        let loaded = load_from("a.txt", &MemoryAssets::new().with("a.txt", text), &LoadOptions::default());
        loaded.scene.unwrap()
    }

    fn settings(scene: &Scene) -> RenderSettings {
        let asked = Settings { size: Some([40, 30]), ..Settings::default() };
        RenderSettings::resolve(scene, &asked, Defaults::Classic, false).unwrap()
    }

    fn turntable(scene: &Scene, frames: u32) -> Turntable {
        Turntable { start: CameraPose::of(scene), center: DVec3::ZERO, frames, view: View::Color }
    }

    #[test]
    fn half_a_turn_swaps_left_and_right() {
        let scene = scene();
        let size = [400, 300];
        let seen = |camera: &CameraPose, x: f64| {
            let place = camera.project(DVec3::new(x, 0.0, 0.0), size).unwrap();
            (probe::pick(&scene, camera, place, size).unwrap().object, place.x)
        };
        let cameras: Vec<_> = turntable(&scene, 8).cameras().collect();
        assert_eq!(cameras.len(), 8);
        let (first, opposite) = (&cameras[0], &cameras[4]);
        assert!(seen(first, 2.0).1 > 200.0 && seen(opposite, 2.0).1 < 200.0);
        assert_eq!((seen(first, 2.0).0, seen(opposite, 2.0).0), (1, 1));
        for camera in &cameras {
            assert!((camera.eye().length() - first.eye().length()).abs() < 1e-9);
            assert!((camera.eye().y - 2.0).abs() < 1e-9);
        }
    }

    #[test]
    fn frames_are_written_and_the_first_is_the_scenes_own() {
        let scene = scene();
        let settings = settings(&scene);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("turn.png");
        let done = AtomicU64::new(0);
        struct Watch<'a>(&'a AtomicU64);
        impl Progress for Watch<'_> {
            fn done(&self, pixels_done: u64, pixels_total: u64, _: u64) {
                assert_eq!(pixels_total, 3 * 40 * 30);
                self.0.fetch_max(pixels_done, Ordering::Relaxed);
            }
            fn cancelled(&self) -> bool {
                false
            }
        }
        let files = turntable(&scene, 3)
            .write(&scene, &settings, &path, &[], &Resources::default(), &Watch(&done))
            .unwrap();
        let names: Vec<_> = files.iter().map(|file| file.file_name().unwrap().to_str().unwrap()).collect();
        assert_eq!(names, ["turn_000.png", "turn_001.png", "turn_002.png"]);
        assert_eq!(done.into_inner(), 3 * 40 * 30);
        let outputs = [(View::Color, Format::Png)];
        let own = render(&RenderRequest::new(&scene, &settings, &outputs), &Silent).unwrap();
        let own = own.encode(&[View::Color], Format::Png, BitDepth::Eight).unwrap();
        let written: Vec<_> = files.iter().map(|file| std::fs::read(file).unwrap()).collect();
        assert!(written[0] == own && written[1] != own && written[2] != written[1]);
    }

    #[test]
    fn nothing_is_rendered_for_a_file_that_cannot_be_written() {
        let scene = scene();
        let path = Path::new("/nowhere/at/all.png");
        let result =
            turntable(&scene, 3).write(&scene, &settings(&scene), path, &[], &Resources::default(), &Silent);
        assert!(matches!(result, Err(TurntableError::Output(_))));
    }
}
