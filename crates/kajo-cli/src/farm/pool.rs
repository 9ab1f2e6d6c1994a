//! Renders by the workers of a pool, whoever has it: the folder of the job, its stages, and the picture in the end.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use kajo::output::Target;
use kajo::{
    Film, Format, Loaded, Picture, Progress, RayCounters, RenderRequest, RenderStats, SplitRender, View,
};
use kajo_farm::{FarmError, HostShare, Job as Folder, Merged, Watch};

use super::{folder, line_of, refuse};
use crate::console;
use crate::failure::Failure;
use crate::interrupt::{Interrupt, Work};
use crate::job::{Done, Job, Voice, has_errors};
use crate::progress::{Meter, Watched, in_short};

/// Workers that render units: processes of this machine, or machines of a cluster.
pub trait WorkerPool {
    /// Reads the scene.
    ///
    /// # Errors
    /// [`Failure`]; what is wrong with a scene is in [`Loaded`].
    fn load(&self, job: &Job, meter: &Meter) -> Result<Loaded, Failure> {
        job.load_scene(meter, None)
    }

    /// Hears of the job before its first stage.
    ///
    /// # Errors
    /// [`Failure`]
    fn begin(&self, _folder: &Folder) -> Result<(), Failure> {
        Ok(())
    }

    /// Renders what is missing of a stage.
    ///
    /// # Errors
    /// As [`kajo_farm::coordinate`].
    fn stage(&self, folder: &Folder, split: &SplitRender<'_>, watch: &dyn Watch) -> Result<(), FarmError>;

    /// Threads that render, as far as that is known.
    fn threads(&self) -> usize;
}

/// A render by the workers of a pool.
struct PooledRender<'a> {
    job: &'a Job,
    pool: &'a dyn WorkerPool,
    interrupt: &'a Interrupt,
    meter: &'a Meter,
    quiet: bool,
}

/// Does all of a job.
///
/// # Errors
/// [`Failure`]; what is finished stays in the folder of the job.
pub fn render(
    job: &Job,
    pool: &dyn WorkerPool,
    meter: &Meter,
    interrupt: &Interrupt,
    voice: &mut Voice<'_>,
) -> Result<Done, Failure> {
    refuse(job)?;
    let mut loaded = pool.load(job, meter)?;
    if !loaded.diagnostics.is_empty() {
        (voice.say)(&loaded.report(voice.color));
    }
    let Some(scene) = loaded.scene.take() else { return Err(has_errors(&job.scene, &loaded)) };
    let settings = job.settings(&scene, voice)?;
    job.check_outputs(settings.size, &loaded.files)?;
    let preview = job.farm.preview.as_deref().map(|path| Preview::new(path, &loaded)).transpose()?;
    let outputs = job.recorded();
    let request = RenderRequest::new(&scene, &settings, &outputs).with(job.resources);
    let split = SplitRender::new(&request, &job.passes.goal(), Job::scene_digest(&loaded)?)?;
    let folder = folder(job, &split, &loaded, line_of(job))?;
    let lock = folder.lock()?;
    pool.begin(&folder)?;
    let render = PooledRender { job, pool, interrupt, meter, quiet: voice.quiet };
    let picture = render.picture(&folder, &split, preview.as_ref())?;
    let done = job.write(picture, &loaded.files, interrupt, voice)?;
    drop(lock);
    if job.farm.job.is_none() {
        // The picture is there; a folder that stays does no harm.
        let _ = std::fs::remove_dir_all(folder.folder());
    }
    Ok(done)
}

impl PooledRender<'_> {
    /// Renders what is missing and puts all together.
    fn picture(
        &self,
        folder: &Folder,
        split: &SplitRender<'_>,
        preview: Option<&Preview>,
    ) -> Result<Picture, Failure> {
        let (started, every) = (Instant::now(), self.job.farm.preview_every);
        let ((result, [samples, rays]), stopped) = self.interrupt.during(Work::Render, || {
            let watch = Watcher {
                progress: self.meter.watched(self.interrupt),
                meter: self.meter,
                pixels: split.sampled().area(),
                quiet: self.quiet,
                taken: Mutex::new([0; 2]),
                hosts: Mutex::default(),
            };
            let result = thread::scope(|scope| {
                let (over, heard) = channel::<()>();
                if let Some(preview) = preview {
                    let show = move || preview.show(&heard, every, folder, split);
                    // Without a thread there is no preview.
                    let _ = thread::Builder::new().name("preview".to_owned()).spawn_scoped(scope, show);
                }
                let result = self.stages(folder, split, &watch);
                drop(over);
                result
            });
            self.meter.finish();
            watch.tell_hosts();
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
            threads: self.pool.threads(),
            ..RenderStats::default()
        };
        Ok(split.picture(result?, stats))
    }

    fn stages(&self, folder: &Folder, split: &SplitRender<'_>, watch: &dyn Watch) -> Result<Film, FarmError> {
        /// Times that units are found damaged after they were finished, before something is wrong with the disk.
        const MOST_REPAIRS: usize = 3;
        let mut repairs = 0;
        loop {
            self.pool.stage(folder, split, watch)?;
            match folder.merge(split) {
                Ok(Merged::Complete(film)) => return Ok(*film),
                Ok(Merged::Next(_)) => {}
                Err(FarmError::NotYet(_)) if repairs < MOST_REPAIRS => repairs += 1,
                Err(error) => return Err(error),
            }
        }
    }
}

/// A file that shows the picture so far.
struct Preview {
    target: Target,
    format: Format,
}

impl Preview {
    fn new(path: &Path, loaded: &Loaded) -> Result<Preview, Failure> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().into_owned());
        let format = ending.as_deref().and_then(Format::from_extension).ok_or_else(|| {
            Failure::Input(format!(
                "`{}` names no format of pictures: end it in .png or .exr",
                path.display()
            ))
        })?;
        Ok(Preview { target: Target::check(path, &loaded.files)?, format })
    }

    /// Writes the picture so far until `over` is closed.
    fn show(&self, over: &Receiver<()>, every: Duration, folder: &Folder, split: &SplitRender<'_>) {
        while let Err(RecvTimeoutError::Timeout) = over.recv_timeout(every.max(Duration::from_millis(100))) {
            // What cannot be shown now will be shown later, or never: it is a look and no result.
            let Ok(film) = folder.so_far(split) else { continue };
            let picture = split.picture(film, RenderStats::default());
            let views = &[View::Color];
            if let Ok(bytes) = picture.encode(views, self.format, kajo::BitDepth::Eight) {
                let _ = self.target.write(&bytes);
            }
        }
    }
}

struct Watcher<'a> {
    progress: Watched<'a>,
    meter: &'a Meter,
    pixels: u64,
    quiet: bool,
    /// Samples and rays.
    taken: Mutex<[u64; 2]>,
    hosts: Mutex<BTreeMap<String, HostShare>>,
}

impl Watcher<'_> {
    /// One line for each host.
    fn tell_hosts(&self) {
        let Ok(hosts) = self.hosts.lock() else { return };
        if !self.quiet {
            hosts.iter().for_each(|(host, share)| console::line(format!("{host}: {}", in_words(share))));
        }
    }
}

/// "12 units, 1.2 M samples/s"
fn in_words(share: &HostShare) -> String {
    let rate = in_short(share.samples as f64 / share.seconds.max(1e-3));
    format!("{} unit{}, {rate} samples/s", share.units, if share.units == 1 { "" } else { "s" })
}

impl Watch for Watcher<'_> {
    fn done(&self, units: u64, of: u64, samples: u64, rays: u64) {
        if let Ok(mut taken) = self.taken.lock() {
            *taken = [taken[0].max(samples), taken[1].max(rays)];
        }
        let pixels = (self.pixels as f64 * units as f64 / of.max(1) as f64) as u64;
        self.progress.done(pixels, self.pixels, rays);
    }

    fn hosts(&self, hosts: &BTreeMap<String, HostShare>) {
        let told: Vec<String> =
            hosts.iter().take(4).map(|(host, share)| format!("{host} {}", in_words(share))).collect();
        let more = if hosts.len() > 4 { format!("; {} hosts", hosts.len()) } else { String::new() };
        self.meter.tell(&format!("{}{more}", told.join("; ")));
        if let Ok(mut kept) = self.hosts.lock() {
            kept.clone_from(hosts);
        }
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
