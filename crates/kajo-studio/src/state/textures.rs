//! The textures of the preview, evaluated finely by another thread once the coarse ones are on show.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use kajo::Scene;
use kajo_edit::preview::Atlas;

use super::tracer::Wake;
use super::worker::Worker;
use super::{Shown, Studio, Version};

struct Order {
    number: u64,
    version: Version,
    scene: Arc<Scene>,
    coarse: Arc<Atlas>,
}

/// The fine textures on show and those to come.
pub(super) struct FineTextures {
    worker: Worker<Order, Option<(Version, Arc<Atlas>)>>,
    /// The number of the newest order: older ones are not finished.
    newest: Arc<AtomicU64>,
    ordered: Option<Version>,
    made: Option<(Version, Arc<Atlas>)>,
}

impl FineTextures {
    pub fn new(wake: Wake) -> FineTextures {
        let newest = Arc::new(AtomicU64::new(0));
        let current = Arc::clone(&newest);
        let work = move |Order { number, version, scene, coarse }: Order| {
            let goes_on = || current.load(Ordering::Relaxed) == number;
            coarse.refined(&scene, goes_on).map(|atlas| (version, Arc::new(atlas)))
        };
        FineTextures { worker: Worker::new(wake, work), newest, ordered: None, made: None }
    }
}

impl Studio {
    /// The fine textures of [`Studio::preview`], once they are there.
    pub fn fine_textures(&self) -> Option<&Arc<Atlas>> {
        let (shown, _) = self.preview.as_ref()?;
        self.textures.made.as_ref().filter(|(version, _)| version == shown).map(|(_, atlas)| atlas)
    }

    /// Whether finer textures of the preview are still to come.
    pub fn is_refining_textures(&self) -> bool {
        let has_textures = self.preview.as_ref().is_some_and(|(_, preview)| preview.atlas.is_some());
        self.is_drawn() && has_textures && self.fine_textures().is_none()
    }

    /// Takes in fine textures, and has them made where that is due.
    pub(super) fn refine_textures(&mut self) {
        if let Some(Some(made)) = self.textures.worker.take_latest() {
            self.textures.made = Some(made);
        }
        let Some((version, preview)) =
            self.preview.as_ref().filter(|(version, _)| *version == self.version())
        else {
            return;
        };
        let version = *version;
        if self.textures.ordered == Some(version) || self.shown != Shown::Preview || !self.is_drawn() {
            return;
        }
        let (Some(scene), Some(coarse)) = (self.scene().cloned(), preview.atlas.clone()) else { return };
        let number = self.textures.newest.fetch_add(1, Ordering::Relaxed) + 1;
        self.textures.ordered = Some(version);
        self.textures.worker.order(Order { number, version, scene, coarse });
    }
}
