//! Pictures from all around, written in the background.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use kajo::turntable::Turntable;
use kajo::{Progress, RenderSettings, Resources, Scene};

use super::{Studio, priority};

/// What is to be written.
pub struct TurntableOrder {
    turntable: Turntable,
    scene: Arc<Scene>,
    settings: RenderSettings,
    path: PathBuf,
    inputs: Vec<PathBuf>,
    threads: usize,
    stop: Arc<AtomicBool>,
}

/// Ends the work once it is cancelled.
struct Stoppable(Arc<AtomicBool>);

impl Progress for Stoppable {
    fn done(&self, _: u64, _: u64, _: u64) {}

    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

impl TurntableOrder {
    /// Renders and writes all pictures, on a thread of its own; returns a message.
    pub fn carry_out(self) -> Result<String, String> {
        priority::give_way();
        let resources = Resources { threads: self.threads, ..Resources::default() };
        let TurntableOrder { turntable, scene, settings, path, inputs, stop, .. } = self;
        let progress = Stoppable(stop);
        let written = turntable.write(&scene, &settings, &path, &inputs, &resources, &progress);
        written.map(|files| format!("Wrote {} pictures.", files.len())).map_err(|error| error.to_string())
    }
}

impl Studio {
    /// The files that [`Action::Turntable`](super::Action::Turntable) would write.
    pub(super) fn turntable_files(&self, path: &Path) -> Vec<PathBuf> {
        self.whole_turn().files(path)
    }

    fn whole_turn(&self) -> Turntable {
        let selection = self.selection_bounds();
        let center = selection.map_or(self.navigation.center, |bounds| bounds.center().as_dvec3());
        let frames = self.options.habits.turntable_frames.max(1);
        Turntable { start: self.camera.clone(), center, frames, view: self.view }
    }

    /// Whether pictures from all around are being written.
    pub fn is_writing(&self) -> bool {
        self.turntable.is_busy()
    }

    /// Begins to write pictures from all around what the camera turns around.
    pub(super) fn turn(&mut self, path: &Path) {
        let (Some(scene), Some(Ok(settings))) = (self.scene().cloned(), self.settings()) else {
            self.say("Open a scene first.", false);
            return;
        };
        let turntable = self.whole_turn();
        let frames = turntable.frames;
        let stop = Arc::new(AtomicBool::new(false));
        self.stop_turntable = Arc::clone(&stop);
        let inputs = self.document.as_ref().and_then(|document| document.path()).map(Path::to_owned);
        self.turntable.order(TurntableOrder {
            turntable,
            scene,
            settings,
            path: path.to_owned(),
            inputs: inputs.into_iter().collect(),
            threads: self.options.habits.threads,
            stop,
        });
        self.say(&format!("Writing {frames} pictures; Esc stops."), false);
    }
}
