//! Tracing in the background, from coarse to fine, with each state of the picture to be shown.
//!
//! A [`Session`] has a thread of its own that renders the [`Job`] it was given last. It begins with small pictures
//! of the whole, goes on with passes over the full one, and leaves a [`Frame`] after each:
//!
//! ```text
//! 1/8 -> 1/4 -> 1/2 -> 1 sample -> 2 -> 4 -> ... -> all samples
//! ```
//!
//! No call waits for the rendering: [`Session::start`] drops what runs, within some hundred camera rays of each
//! render thread, and [`Session::frame`] hands out what there is. A finished frame has the bits of
//! [`render`](crate::render()) with the same settings, and its files are written by the same code.
//!
//! ```
//! # let text = "
//! #     PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }
//! #     Materials { Material {} }  Group { MaterialIndex 0  Sphere { center 0 0 0  radius 1 } }";
//! # let assets = kajo::MemoryAssets::new().with("ball.txt", text);
//! # let scene = kajo::load_from("ball.txt", &assets, &Default::default()).scene.unwrap();
//! use kajo::session::{Job, Session, Status};
//! use kajo::{Defaults, RenderSettings, Settings};
//!
//! let settings = RenderSettings::resolve(&scene, &Settings::default(), Defaults::Classic, false)?;
//! let session = Session::new(0, || { /* ask the window to draw itself again */ });
//! session.start(Job::new(scene.into(), settings));
//! while let Status::Running { .. } = session.status() {
//!     if let Some(frame) = session.frame() {
//!         println!("{:?} with {} samples", frame.size(), frame.samples());
//!     }
//! #   std::thread::yield_now();
//! }
//! # Ok::<(), kajo::SettingsError>(())
//! ```

mod frame;
mod worker;

use std::sync::atomic::Ordering;
use std::sync::{Arc, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

use kajo_core::sampler::SamplerKind;
use kajo_core::scene::Scene;

use crate::{CameraPose, RenderError, RenderSettings, View};
pub use frame::Frame;
use worker::{Shared, State};

/// Samples of each pixel of a job without an end.
const ENDLESS: u32 = 1 << 16;

/// What is to be rendered.
#[derive(Clone, Debug)]
pub struct Job {
    /// The scene.
    pub scene: Arc<Scene>,
    /// Where it is looked at from; by its own camera, where absent.
    pub camera: Option<CameraPose>,
    /// Size, samples, integrator and all the rest.
    pub settings: RenderSettings,
    /// What frames are to show beside the light.
    pub views: Vec<View>,
    /// What the coarse frames before them are to show beside the light: they are there the sooner, the less it is.
    pub coarse_views: Vec<View>,
    /// Sides of the first picture are shorter by this factor, and of the next by half of it; 1 begins at full size.
    pub downscale: u32,
    /// Whether the whole picture starts from the records of irradiance of those before, where they had the same scene and settings; coarse ones
    /// always do.
    pub keeps_state: bool,
}

impl Job {
    /// The scene through its own camera, coarse and nothing but light at first, then with all views that cost little.
    pub fn new(scene: Arc<Scene>, settings: RenderSettings) -> Job {
        use View::{Depth, Material, Normals, Object, Samples, Uv, Variance};
        let views = vec![Depth, Normals, Uv, Object, Material, Samples, Variance];
        Job {
            scene,
            camera: None,
            settings,
            views,
            coarse_views: Vec::new(),
            downscale: 8,
            keeps_state: false,
        }
    }

    /// The same from another place.
    pub fn through(self, camera: CameraPose) -> Job {
        Job { camera: Some(camera), ..self }
    }

    /// The same with samples as long as nobody stops it; patterns with a fixed number give way to Sobol points.
    pub fn without_end(mut self) -> Job {
        let kind = self.settings.samples.0;
        let kind = crate::render::fixed_pattern(kind).map_or(kind, |_| SamplerKind::Sobol);
        self.settings.samples = (kind, ENDLESS);
        self
    }
}

/// What a session is doing.
#[derive(Clone, Debug)]
pub enum Status {
    /// Nothing was started yet.
    Idle,
    /// Rendering.
    Running {
        /// The share of the job's samples that is taken.
        progress: f32,
    },
    /// The last job is finished.
    Finished,
    /// The last job was cancelled.
    Cancelled,
    /// The last job failed.
    Failed(Arc<RenderError>),
}

/// A thread that renders what it was told last.
pub struct Session {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Session {
    /// A session that waits for its first job.
    ///
    /// * `threads`: render threads; 0 for one on each core
    /// * `wake`: called from the session's thread after each new frame and whenever the status changes
    pub fn new(threads: usize, wake: impl Fn() + Send + Sync + 'static) -> Session {
        Session::prepared(threads, wake, || ())
    }

    /// As [`Session::new`], with something for the session's thread to do first, such as to lower its own priority.
    ///
    /// * `prepare`: called once, from the session's thread, which then starts all render threads; on Linux they have
    ///   its priority
    pub fn prepared(
        threads: usize,
        wake: impl Fn() + Send + Sync + 'static,
        prepare: impl FnOnce() + Send + 'static,
    ) -> Session {
        let shared = Arc::new(Shared::new(threads, Box::new(wake)));
        let worker = Arc::clone(&shared);
        let work = move || {
            prepare();
            worker.work();
        };
        let thread = thread::Builder::new().name("session".to_owned()).spawn(work).ok();
        Session { shared, thread }
    }

    /// Drops what runs and starts anew. The last frame stays until there is one of this job.
    ///
    /// Returns the number of the job, which its frames carry.
    pub fn start(&self, job: Job) -> u64 {
        let mut state = self.lock();
        let number = self.shared.current.fetch_add(1, Ordering::Relaxed) + 1;
        self.shared.set_progress(0.0);
        state.status = Status::Running { progress: 0.0 };
        state.next = Some((number, job));
        self.shared.changed.notify_all();
        if self.thread.is_none() {
            state.next = None;
            let error = RenderError::panicked("the system gives no thread to render with");
            state.status = Status::Failed(Arc::new(error));
        }
        number
    }

    /// Stops rendering; the frame stays.
    pub fn cancel(&self) {
        let mut state = self.lock();
        self.shared.current.fetch_add(1, Ordering::Relaxed);
        state.next = None;
        if let Status::Running { .. } = state.status {
            state.status = Status::Cancelled;
        }
        self.shared.changed.notify_all();
    }

    /// The newest picture.
    pub fn frame(&self) -> Option<Arc<Frame>> {
        self.lock().frame.clone()
    }

    /// What the session is doing.
    pub fn status(&self) -> Status {
        match self.lock().status.clone() {
            Status::Running { .. } => Status::Running { progress: self.shared.progress() },
            other => other,
        }
    }

    /// Whether a job is being rendered.
    pub fn is_running(&self) -> bool {
        matches!(self.status(), Status::Running { .. })
    }

    /// Waits until nothing is being rendered; for programs without a window.
    pub fn wait(&self) -> Status {
        let mut state = self.lock();
        while let Status::Running { .. } = state.status {
            state = self.shared.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        state.status.clone()
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.shared.lock()
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        {
            let mut state = self.lock();
            self.shared.current.fetch_add(1, Ordering::Relaxed);
            state.is_over = true;
            self.shared.changed.notify_all();
        }
        if let Some(thread) = self.thread.take() {
            // It reports its own failures, and has no way to panic besides.
            let _ = thread.join();
        }
    }
}

impl std::fmt::Debug for Session {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Session").field("status", &self.status()).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
