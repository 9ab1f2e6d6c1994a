//! `kajo render --farm stdio`: the machines of the program that started this one.

use std::io::{self, BufReader};
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use kajo::output::Target;
use kajo::{LoadOptions, Loaded, SplitRender};
use kajo_farm::{Bundle, Engine, FarmError, Job as Folder, Recording, Watch};

use super::pool::WorkerPool;
use crate::failure::Failure;
use crate::job::Job;
use crate::progress::Meter;

/// The engine, and the scene that it is told of.
pub struct Machines {
    engine: Mutex<Engine>,
    /// The bytes of the scene's bundle, until they are in the folder of the job.
    bundle: Mutex<Vec<u8>>,
}

impl Machines {
    /// Talks to whoever started this program.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub fn new() -> Result<Machines, Failure> {
        let engine = Engine::new(BufReader::new(io::stdin()), io::stdout())?;
        Ok(Machines { engine: Mutex::new(engine), bundle: Mutex::default() })
    }
}

impl WorkerPool for Machines {
    fn load(&self, job: &Job, meter: &Meter) -> Result<Loaded, Failure> {
        let (loaded, bytes) = bundled(job, meter)?;
        *self.bundle.lock().unwrap_or_else(PoisonError::into_inner) = bytes;
        Ok(loaded)
    }

    fn begin(&self, folder: &Folder) -> Result<(), Failure> {
        let bytes = std::mem::take(&mut *self.bundle.lock().unwrap_or_else(PoisonError::into_inner));
        let path: PathBuf = folder.folder().join("scene.kbundle");
        Target::check(&path, &[])?.write(&bytes)?;
        Ok(self.engine.lock().unwrap_or_else(PoisonError::into_inner).begin(folder, &path)?)
    }

    fn stage(&self, folder: &Folder, split: &SplitRender<'_>, watch: &dyn Watch) -> Result<(), FarmError> {
        self.engine.lock().unwrap_or_else(PoisonError::into_inner).coordinate(folder, split, watch)
    }

    fn threads(&self) -> usize {
        let engine = self.engine.lock().unwrap_or_else(PoisonError::into_inner);
        engine.hosts().len().max(1)
    }
}

impl Drop for Machines {
    fn drop(&mut self) {
        self.engine.lock().unwrap_or_else(PoisonError::into_inner).end();
    }
}

/// Reads the scene, and puts all that it names into a bundle.
fn bundled(job: &Job, meter: &Meter) -> Result<(Loaded, Vec<u8>), Failure> {
    if Bundle::is_one(&job.scene) {
        let bytes = std::fs::read(&job.scene)
            .map_err(|error| Failure::Input(format!("cannot read `{}`: {error}", job.scene.display())))?;
        return Ok((job.load_scene(meter, None)?, bytes));
    }
    let options = LoadOptions { progress: meter.loading(), memory: job.resources.memory, ..job.load.clone() };
    if kajo::model_text(&job.scene, &options).is_some() {
        return Err(Failure::Input(format!(
            "a cluster renders scenes: `kajo convert {}` writes the one that shows this model",
            job.scene.display()
        )));
    }
    let assets = options.assets(&job.scene).map_err(Failure::Input)?;
    let recording = Recording::new(&assets, assets.scene_name());
    let loaded = kajo::load_from(assets.scene_name(), &recording, &options);
    let loaded = Loaded { files: assets.opened(), ..loaded };
    let bytes = recording.bundle().bytes()?;
    Ok((loaded, bytes))
}
