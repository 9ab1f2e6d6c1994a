//! The preview that the camera's own rays make, cast by another thread, from coarse to fine: for cameras whose picture no
//! matrix makes, and for scenes of more nested instances than triangles can show.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use kajo::{CameraPose, Scene};
use kajo_edit::preview::TracedPreview;

use super::tracer::Wake;
use super::worker::Worker;
use super::{Shown, Studio, Version};

/// Behind the scene in the preview, as shown.
pub const BACKGROUND: [u8; 3] = [42, 44, 48];

/// Pixels to a side for which there is one ray, in one picture after the other.
const COARSENESS: [u32; 3] = [8, 3, 1];

/// What a picture shows, and how fine.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wanted {
    scene: Version,
    camera: u64,
    /// Columns and rows of the camera's picture.
    picture: [u32; 2],
    /// Columns and rows of rays, at most.
    finest: [u32; 2],
    /// Index into [`COARSENESS`].
    step: usize,
}

struct Order {
    number: u64,
    wanted: Wanted,
    scene: Arc<Scene>,
    camera: CameraPose,
}

/// The picture on show and the one to come.
pub(super) struct Sight {
    worker: Worker<Order, Option<(Wanted, Arc<TracedPreview>)>>,
    /// The number of the newest order: older ones are not finished.
    newest: Arc<AtomicU64>,
    ordered: Option<Wanted>,
    seen: Option<(Wanted, Arc<TracedPreview>)>,
}

impl Sight {
    pub fn new(wake: Wake) -> Sight {
        let newest = Arc::new(AtomicU64::new(0));
        let current = Arc::clone(&newest);
        let work = move |Order { number, wanted, scene, camera }: Order| {
            let coarse = COARSENESS[wanted.step];
            let size = wanted.finest.map(|pixels| pixels.div_ceil(coarse));
            // While one flies about there is at least the coarse picture of a moment ago.
            let goes_on = || wanted.step == 0 || current.load(Ordering::Relaxed) == number;
            TracedPreview::of(&scene, &camera, wanted.picture, size, BACKGROUND, goes_on)
                .map(|seen| (wanted, Arc::new(seen)))
        };
        Sight { worker: Worker::new(wake, work), newest, ordered: None, seen: None }
    }

    /// Forgets what was seen.
    pub fn clear(&mut self) {
        self.newest.fetch_add(1, Ordering::Relaxed);
        self.ordered = None;
        self.seen = None;
    }
}

impl Studio {
    /// Whether the preview is what the graphics card draws, so that there is no [`Studio::sight`].
    pub fn is_drawn(&self) -> bool {
        self.camera.is_flat() && !self.preview.as_ref().is_some_and(|(_, preview)| preview.has_boxes)
    }

    /// What the camera sees, where the card cannot draw it; it may be coarse, or of a moment ago.
    pub fn sight(&self) -> Option<&Arc<TracedPreview>> {
        let is_of_scene = |wanted: &Wanted| wanted.scene.0 == self.opened;
        self.sight.seen.as_ref().filter(|(wanted, _)| is_of_scene(wanted)).map(|(_, seen)| seen)
    }

    /// Whether [`Studio::sight`] is what the camera sees now, as fine as it gets.
    pub fn sight_is_current(&self) -> bool {
        let last = self.wanted_sight(COARSENESS.len() - 1);
        self.sight.seen.as_ref().is_some_and(|(wanted, _)| Some(*wanted) == last)
    }

    fn wanted_sight(&self, step: usize) -> Option<Wanted> {
        self.scene().filter(|_| !self.is_drawn())?;
        let picture = self.picture_size();
        let finest = [0, 1].map(|side| picture[side].min(self.window[side].max(1)));
        Some(Wanted { scene: self.version(), camera: self.camera_version(), picture, finest, step })
    }

    /// Takes in what was seen, and has more cast where that is due.
    pub(super) fn look(&mut self) {
        if let Some(Some(seen)) = self.sight.worker.take_latest() {
            self.sight.seen = Some(seen);
        }
        if self.shown != Shown::Preview {
            return;
        }
        let seen = self.sight.seen.as_ref().map(|(wanted, _)| *wanted);
        let is_seen = |step: usize| seen.is_some() && seen == self.wanted_sight(step);
        let next = (0..COARSENESS.len()).find(|&step| is_seen(step)).map_or(0, |step| step + 1);
        let Some(wanted) = self.wanted_sight(next).filter(|_| next < COARSENESS.len()) else { return };
        let Some(scene) = self.scene().cloned().filter(|_| self.sight.ordered != Some(wanted)) else {
            return;
        };
        let number = self.sight.newest.fetch_add(1, Ordering::Relaxed) + 1;
        self.sight.ordered = Some(wanted);
        self.sight.worker.order(Order { number, wanted, scene, camera: self.camera.clone() });
    }
}
