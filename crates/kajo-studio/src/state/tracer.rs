//! The trace that the window shows: when it is started anew, and what there is to see of it.

use std::sync::Arc;

use kajo::session::{Frame, Job, Session, Status};

use super::{CameraState, RenderOptions, Version, priority};

/// Wakes the window up; may be called by any thread.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// What decides how a traced picture comes out. Two equal requests give the same picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The version of the scene.
    pub scene: Version,
    /// Counts the places of the camera.
    pub camera: u64,
    /// Without what only changes how light is shown.
    pub options: RenderOptions,
    /// Pixels of the viewport.
    pub window: [u32; 2],
}

impl Request {
    /// Whether the two ask for the same picture, larger or smaller.
    pub fn is_like(&self, other: &Request) -> bool {
        *self == Request { window: self.window, ..other.clone() }
    }
}

/// Traces in the background.
pub struct Tracer {
    session: Session,
    threads: usize,
    wake: Wake,
    last: Option<Request>,
    /// Where the camera stood for it.
    pose: Option<CameraState>,
    job: u64,
}

impl Tracer {
    /// Nothing runs yet.
    pub fn new(wake: Wake) -> Tracer {
        Tracer { session: session(0, &wake), threads: 0, wake, last: None, pose: None, job: 0 }
    }

    /// Drops what runs and traces this.
    ///
    /// * `pose`: where the camera stands
    pub fn start(&mut self, request: Request, job: Job, pose: CameraState) {
        let threads = request.options.habits.threads;
        if threads != self.threads {
            self.session = session(threads, &self.wake);
            self.threads = threads;
        }
        self.job = self.session.start(job);
        self.last = Some(request);
        self.pose = Some(pose);
    }

    /// Whether this was asked for last, whatever became of it.
    pub fn was_asked_for(&self, request: &Request) -> bool {
        self.last.as_ref() == Some(request)
    }

    /// Remembers a request that could not even be begun, so that it is not tried again and again.
    pub fn give_up(&mut self, request: Request) {
        self.session.cancel();
        self.last = Some(request);
    }

    /// Stops; the picture stays.
    pub fn cancel(&self) {
        self.session.cancel();
    }

    /// Stops, and starts what was asked for anew when it is asked for once more.
    pub fn forget(&mut self) {
        self.session.cancel();
        self.last = None;
    }

    /// Forgets the picture, as for another scene.
    pub fn clear(&mut self) {
        self.session = session(self.threads, &self.wake);
        self.last = None;
    }

    /// The newest picture; one of an earlier trace while there is none of this one.
    pub fn frame(&self) -> Option<Arc<Frame>> {
        self.session.frame()
    }

    /// The newest picture of the trace that was started last, and what it shows.
    pub fn newest(&self) -> Option<(Arc<Frame>, Request)> {
        let frame = self.frame().filter(|frame| self.is_of_last(frame))?;
        Some((frame, self.last.clone()?))
    }

    /// The same once the trace has come to its end.
    pub fn finished(&self) -> Option<(Arc<Frame>, Request)> {
        // Only a finished trace leaves its last picture before it says so.
        matches!(self.status(), Status::Finished).then(|| self.newest()).flatten()
    }

    /// Where the camera stood for the trace that was started last.
    pub fn camera_state(&self) -> Option<CameraState> {
        self.pose.clone()
    }

    /// Whether the picture belongs to the trace that was started last.
    pub fn is_of_last(&self, frame: &Frame) -> bool {
        frame.job() == self.job
    }

    /// What it is doing.
    pub fn status(&self) -> Status {
        self.session.status()
    }
}

fn session(threads: usize, wake: &Wake) -> Session {
    let wake = Arc::clone(wake);
    Session::prepared(threads, move || wake(), priority::give_way)
}
