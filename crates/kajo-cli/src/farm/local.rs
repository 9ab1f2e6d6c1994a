//! `kajo render --farm local:N`: workers that are processes of this machine.

use std::process::Command;
use std::sync::Mutex;
use std::thread;
use std::time::Instant;

use kajo::{Picture, Pieces, Progress, RayCounters, RenderRequest, RenderStats};
use kajo_farm::{FarmError, Job as Folder, Merged, ProcessWorkers, Watch, coordinate};

use super::{folder, refuse};
use crate::console;
use crate::failure::Failure;
use crate::interrupt::{Interrupt, Work};
use crate::job::{Done, Job, Voice, has_errors};
use crate::progress::{Meter, Watched};

/// A render by workers of this machine.
struct Local<'a> {
    job: &'a Job,
    workers: u16,
    interrupt: &'a Interrupt,
    meter: &'a Meter,
    quiet: bool,
}

/// Does all of a job with so many workers.
///
/// # Errors
/// [`Failure`]; what is finished stays in the folder of the job.
pub fn render(
    job: &Job,
    workers: u16,
    meter: &Meter,
    interrupt: &Interrupt,
    voice: &mut Voice<'_>,
) -> Result<Done, Failure> {
    refuse(job)?;
    let mut loaded = job.load_scene(meter, None)?;
    if !loaded.diagnostics.is_empty() {
        (voice.say)(&loaded.report(voice.color));
    }
    let Some(scene) = loaded.scene.take() else { return Err(has_errors(&job.scene, &loaded)) };
    let settings = job.settings(&scene, voice)?;
    job.check_outputs(settings.size, &loaded.files)?;
    let outputs = job.recorded();
    let request = RenderRequest::new(&scene, &settings, &outputs).with(job.resources);
    let pieces = Pieces::new(&request, &job.passes.goal(), Job::scene_digest(&loaded)?)?;
    let folder = folder(job, &pieces, &loaded, std::env::args_os().skip(1).collect())?;
    let lock = folder.lock()?;
    let local = Local { job, workers, interrupt, meter, quiet: voice.quiet };
    let picture = local.picture(&folder, &pieces)?;
    let done = job.write(picture, &loaded.files, interrupt, voice)?;
    drop(lock);
    if job.farm.job.is_none() {
        // The picture is there; a folder that stays does no harm.
        let _ = std::fs::remove_dir_all(folder.folder());
    }
    Ok(done)
}

impl Local<'_> {
    /// Renders what is missing and puts all together.
    fn picture(&self, folder: &Folder, pieces: &Pieces<'_>) -> Result<Picture, Failure> {
        let started = Instant::now();
        let ((result, [samples, rays]), stopped) = self.interrupt.during(Work::Render, || {
            let watch = Watcher {
                progress: self.meter.watched(self.interrupt),
                pixels: pieces.sampled().area(),
                quiet: self.quiet,
                taken: Mutex::new([0; 2]),
            };
            let result = self.stages(folder, pieces, &watch);
            self.meter.finish();
            (result, watch.taken.into_inner().unwrap_or_default())
        });
        if stopped {
            console::line(format!(
                "what is finished is kept in `{}`; the same command goes on with it",
                folder.folder().display()
            ));
            return Err(self.interrupt.failure());
        }
        let stats = RenderStats {
            samples,
            rays: RayCounters { camera: rays, ..RayCounters::default() },
            seconds: started.elapsed().as_secs_f64(),
            threads: self.threads() * usize::from(self.workers),
            ..RenderStats::default()
        };
        Ok(pieces.picture(result?, stats))
    }

    fn stages(
        &self,
        folder: &Folder,
        pieces: &Pieces<'_>,
        watch: &dyn Watch,
    ) -> Result<kajo::Film, FarmError> {
        /// Times that units are found damaged after they were finished, before something is wrong with the disk.
        const MOST_REPAIRS: usize = 3;
        let program = std::env::current_exe().map_err(|error| FarmError::Input(error.to_string()))?;
        let threads = self.threads().to_string();
        let command = |_| {
            let mut command = Command::new(&program);
            command.args(["worker", "--stdio", "--threads", &threads]);
            command
        };
        let start = ProcessWorkers { plan: folder.text().to_owned(), command };
        let mut repairs = 0;
        loop {
            coordinate(folder, pieces, self.workers.into(), &start, watch)?;
            match folder.merge(pieces) {
                Ok(Merged::Complete(film)) => return Ok(*film),
                Ok(Merged::Next(_)) => {}
                Err(FarmError::NotYet(_)) if repairs < MOST_REPAIRS => repairs += 1,
                Err(error) => return Err(error),
            }
        }
    }

    /// Threads of each worker: its share of the cores.
    fn threads(&self) -> usize {
        let cores = match self.job.resources.threads {
            0 => thread::available_parallelism().map_or(1, |n| n.get()),
            threads => threads,
        };
        cores.div_ceil(self.workers.into()).max(1)
    }
}

struct Watcher<'a> {
    progress: Watched<'a>,
    pixels: u64,
    quiet: bool,
    /// Samples and rays.
    taken: Mutex<[u64; 2]>,
}

impl Watch for Watcher<'_> {
    fn done(&self, units: u64, of: u64, samples: u64, rays: u64) {
        if let Ok(mut taken) = self.taken.lock() {
            *taken = [taken[0].max(samples), taken[1].max(rays)];
        }
        let pixels = (self.pixels as f64 * units as f64 / of.max(1) as f64) as u64;
        self.progress.done(pixels, self.pixels, rays);
    }

    fn note(&self, text: &str) {
        if !self.quiet {
            console::warning(text.lines().next().unwrap_or_default());
        }
    }

    fn cancelled(&self) -> bool {
        self.progress.cancelled()
    }
}
