//! The session's own thread.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, Instant};

use kajo_core::camera::Camera;
use kajo_core::sampler::SamplerKind;
use kajo_core::scene::Scene;
use kajo_image::Format;
use kajo_render::integrator::Prepare;
use kajo_render::{
    Film, FilmSpec, Filter, Goal, Layer, LayerSet, Position, Progress, RenderError as PassError, RenderStats,
    panic_message,
};

use super::{Frame, Job, Status};
use crate::checkpoint::camera_digest;
use crate::render::{BYTES_TO_ENCODE, check_memory, film_spec, integrator, schedule};
use crate::{IntegratorSettings, KeptState, RenderError, RenderSettings, Resources, View};

/// Longest time between two frames, as far as a sample of each pixel allows.
const FRAME_INTERVAL: Duration = Duration::from_millis(250);

/// A coarse picture is left out when the full one is expected within this time.
const BLINK: Duration = Duration::from_millis(30);

/// The largest factor by which the first picture may be smaller.
const LARGEST_DOWNSCALE: u32 = 64;

/// What a session and its thread share.
pub(super) struct Shared {
    state: Mutex<State>,
    /// Told of every change of the state.
    pub changed: Condvar,
    /// Number of the job that is wanted; a thread that renders another one stops.
    pub current: AtomicU64,
    /// Bits of the share of samples taken.
    progress: AtomicU32,
    threads: usize,
    wake: Box<dyn Fn() + Send + Sync>,
}

/// What there is to know about a session.
pub(super) struct State {
    /// The job to be rendered next, and its number.
    pub next: Option<(u64, Job)>,
    pub status: Status,
    pub frame: Option<Arc<Frame>>,
    /// Frames that were shown before, and that callers may still hold.
    retired: Vec<Arc<Frame>>,
    /// Whether the thread is to end.
    pub is_over: bool,
}

impl Shared {
    pub fn new(threads: usize, wake: Box<dyn Fn() + Send + Sync>) -> Shared {
        let state =
            State { next: None, status: Status::Idle, frame: None, retired: Vec::new(), is_over: false };
        Shared {
            state: Mutex::new(state),
            changed: Condvar::new(),
            current: AtomicU64::new(0),
            progress: AtomicU32::new(0),
            threads,
            wake,
        }
    }

    pub fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn progress(&self) -> f32 {
        f32::from_bits(self.progress.load(Ordering::Relaxed))
    }

    pub fn set_progress(&self, share: f32) {
        self.progress.store(share.to_bits(), Ordering::Relaxed);
    }

    /// Frees the frames that no caller holds any more. Films are large enough for that to take longer than a window may
    /// stand still, so this thread does it, after it has told of a newer frame.
    fn free_retired(&self) {
        let unheld: Vec<_> =
            self.lock().retired.extract_if(.., |frame| Arc::strong_count(frame) == 1).collect();
        drop(unheld);
    }

    /// Renders one job after the other until the session is over.
    pub fn work(&self) {
        let mut last: Option<KeptOfScene> = None;
        while let Some((number, job)) = self.next() {
            last = last.filter(|last| last.suit(&job));
            let kept = last.get_or_insert_with(|| KeptOfScene::new(&job)).seen_from(camera_of(&job));
            let run = Run { shared: self, number, start: Instant::now(), kept };
            let outcome = catch_unwind(AssertUnwindSafe(|| run.render(&job)));
            let outcome = outcome.unwrap_or_else(|panic| Err(RenderError::panicked(panic_message(&*panic))));
            run.end(outcome);
        }
    }

    /// The next job, when there is one; `None` when the session is over.
    fn next(&self) -> Option<(u64, Job)> {
        let mut state = self.lock();
        loop {
            if state.is_over {
                return None;
            }
            if let Some(next) = state.next.take() {
                return Some(next);
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// The rendering of one job.
struct Run<'a> {
    shared: &'a Shared,
    number: u64,
    start: Instant,
    kept: &'a KeptOfScene,
}

/// The camera of a job.
fn camera_of(job: &Job) -> &Camera {
    job.camera.as_ref().map_or(&job.scene.output.camera, |pose| pose.camera())
}

/// What jobs leave to those after them, and what it is of.
struct KeptOfScene {
    /// It may go when nobody else holds it.
    scene: Weak<Scene>,
    settings: IntegratorSettings,
    /// Of whole pictures through other cameras.
    full: KeptState,
    /// The last one, by what it sees.
    camera: String,
    /// Of the coarse ones before them, which no whole picture starts from: so the first is that of any other program.
    coarse: KeptState,
}

impl KeptOfScene {
    fn new(job: &Job) -> KeptOfScene {
        let settings = job.settings.integrator_settings;
        KeptOfScene {
            scene: Arc::downgrade(&job.scene),
            settings,
            full: KeptState::default(),
            camera: String::new(),
            coarse: KeptState::default(),
        }
    }

    /// The same for a picture through a camera: one through the same camera as the last begins anew, and has the bits of any other program.
    fn seen_from(&mut self, camera: &Camera) -> &KeptOfScene {
        let camera = camera_digest(camera);
        if self.camera == camera {
            self.full = KeptState::default();
        }
        self.camera = camera;
        self
    }

    /// Whether it is good for a job: nothing but its camera may be another one.
    fn suit(&self, job: &Job) -> bool {
        Weak::ptr_eq(&self.scene, &Arc::downgrade(&job.scene))
            && self.settings.values() == job.settings.integrator_settings.values()
    }
}

/// Whether a job came to its end.
enum Outcome {
    Finished,
    Cancelled,
}

impl Run<'_> {
    fn render(&self, job: &Job) -> Result<Outcome, RenderError> {
        let camera = camera_of(job);
        let layers = layers(&job.scene, &job.views, &job.settings);
        let resources = Resources { threads: self.shared.threads, ..Resources::default() };
        check_memory(&film_spec(camera, &job.settings, layers), BYTES_TO_ENCODE, &resources)?;
        let coarse_layers = self::layers(&job.scene, &job.coarse_views, &job.settings);
        // State would be made for each of the smaller pictures, unless they hand it on.
        let mut first = integrator(&job.scene, camera, &job.settings, coarse_layers);
        let is_coarse_first = first.samples_per_state().is_none() || first.keep_state(&self.kept.coarse);
        drop(first);
        for factor in downscales(if is_coarse_first { job.downscale } else { 1 }) {
            let began = Instant::now();
            let settings = coarse(&job.settings, camera, factor);
            if let Outcome::Cancelled = self.passes(job, camera, settings, coarse_layers, &resources, true)? {
                return Ok(Outcome::Cancelled);
            }
            if began.elapsed().mul_f64(f64::from(factor * factor)) < BLINK {
                break;
            }
        }
        self.passes(job, camera, job.settings, layers, &resources, false)
    }

    /// All samples of one picture, with a frame after each pass.
    fn passes(
        &self,
        job: &Job,
        camera: &Camera,
        settings: RenderSettings,
        layers: LayerSet,
        resources: &Resources,
        is_coarse: bool,
    ) -> Result<Outcome, RenderError> {
        let spec = FilmSpec { halves: false, ..film_spec(camera, &settings, layers) };
        let film = Arc::new(Film::new(spec, u64::MAX).map_err(RenderError::Film)?);
        let mut integrator = integrator(&job.scene, camera, &settings, layers);
        if is_coarse {
            integrator.keep_state(&self.kept.coarse);
        } else if job.keeps_state {
            integrator.keep_state(&self.kept.full);
        }
        let schedule = schedule(&settings, resources);
        let goal = Goal { interval: Some(FRAME_INTERVAL), ..Goal::default() };
        let show = &mut |_: &Film, position: &Position, stats: &RenderStats| {
            let stats = RenderStats { seconds: self.start.elapsed().as_secs_f64(), ..*stats };
            let samples = if is_coarse { 0 } else { position.samples() };
            self.publish(Frame::new(
                self.number,
                Arc::clone(&film),
                Arc::clone(&job.scene.lighting.groups),
                settings,
                job.settings.size,
                samples,
                stats,
            ));
            ControlFlow::Continue(())
        };
        let watch = Watch { run: self, is_coarse };
        let result = kajo_render::render_passes(
            &*integrator,
            &film,
            &schedule,
            &goal,
            &mut Position::default(),
            &watch,
            show,
        );
        match result {
            Ok(_) => Ok(Outcome::Finished),
            Err(PassError::Cancelled(_)) => Ok(Outcome::Cancelled),
            Err(PassError::Unprepared { message, .. }) => Err(RenderError::Unprepared(message)),
            Err(error @ PassError::Panicked { .. }) => Err(RenderError::panicked(error.to_string())),
        }
    }

    fn is_wanted(&self) -> bool {
        self.shared.current.load(Ordering::Relaxed) == self.number
    }

    /// Shows a frame, unless another job is wanted by now.
    fn publish(&self, frame: Option<Frame>) {
        {
            let mut state = self.shared.lock();
            let Some(frame) = frame.filter(|_| self.is_wanted()) else { return };
            let before = state.frame.replace(Arc::new(frame));
            state.retired.extend(before);
        }
        (self.shared.wake)();
        self.shared.free_retired();
    }

    fn end(&self, outcome: Result<Outcome, RenderError>) {
        {
            let mut state = self.shared.lock();
            if self.is_wanted() {
                state.status = match outcome {
                    Ok(Outcome::Finished) => Status::Finished,
                    Ok(Outcome::Cancelled) => Status::Cancelled,
                    Err(error) => Status::Failed(Arc::new(error)),
                };
            }
            self.shared.changed.notify_all();
        }
        (self.shared.wake)();
    }
}

/// Keeps the session's progress, and stops a run that is no longer needed.
struct Watch<'a> {
    run: &'a Run<'a>,
    is_coarse: bool,
}

impl Progress for Watch<'_> {
    fn done(&self, pixels_done: u64, pixels_total: u64, _rays: u64) {
        if !self.is_coarse && self.run.is_wanted() {
            self.run.shared.set_progress((pixels_done as f64 / pixels_total.max(1) as f64) as f32);
        }
    }

    fn cancelled(&self) -> bool {
        !self.run.is_wanted()
    }
}

/// The factors by which the first pictures are smaller: `first`, half of it, and so on above 1.
fn downscales(first: u32) -> impl Iterator<Item = u32> {
    std::iter::successors(Some(first.min(LARGEST_DOWNSCALE)), |factor| Some(factor / 2))
        .take_while(|&factor| factor > 1)
}

/// The settings of a smaller picture: one sample in the middle of each pixel.
fn coarse(settings: &RenderSettings, camera: &Camera, factor: u32) -> RenderSettings {
    let cells = camera.cells();
    let size = [0, 1].map(|axis| (settings.size[axis] / cells[axis] / factor).max(1) * cells[axis]);
    RenderSettings { size, samples: (SamplerKind::Regular, 1), filter: Filter::None, ..*settings }
}

/// What films must record for these views, as pictures and as numbers.
fn layers(scene: &Scene, views: &[View], settings: &RenderSettings) -> LayerSet {
    let pairs = views.iter().flat_map(|&view| [Format::Png, Format::Exr].map(|format| (view, format)));
    let of = |(view, format): (View, Format)| view.layers(format, settings, scene.lighting.groups.len());
    let layers: Vec<Layer> = pairs.flat_map(of).chain([Layer::Color]).collect();
    LayerSet::of(&layers)
}
