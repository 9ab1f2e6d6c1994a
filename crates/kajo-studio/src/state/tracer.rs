//! The trace that the window shows: when it is started anew, and what there is to see of it.

use std::sync::Arc;

use kajo::View;
use kajo::session::{Frame, Job, Session, Status};

use super::{RenderOptions, Version, priority};

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
    /// What is recorded beside the light.
    pub views: Vec<View>,
}

impl Request {
    /// Whether a trace for this one shows all that `other` asks for.
    fn answers(&self, other: &Request) -> bool {
        let alike = Request { views: self.views.clone(), ..other.clone() };
        *self == alike && other.views.iter().all(|view| self.views.contains(view))
    }
}

/// Traces in the background.
pub struct Tracer {
    session: Session,
    threads: usize,
    wake: Wake,
    last: Option<Request>,
    job: u64,
}

impl Tracer {
    /// Nothing runs yet.
    pub fn new(wake: Wake) -> Tracer {
        Tracer { session: session(0, &wake), threads: 0, wake, last: None, job: 0 }
    }

    /// Drops what runs and traces this.
    pub fn start(&mut self, request: Request, job: Job) {
        let threads = request.options.habits.threads;
        if threads != self.threads {
            self.session = session(threads, &self.wake);
            self.threads = threads;
        }
        self.job = self.session.start(job);
        self.last = Some(request);
    }

    /// Whether what was asked for last has all of this, whatever became of it.
    pub fn was_asked_for(&self, request: &Request) -> bool {
        self.last.as_ref().is_some_and(|last| last.answers(request))
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

    /// Forgets the picture, as for another scene.
    pub fn clear(&mut self) {
        self.session = session(self.threads, &self.wake);
        self.last = None;
    }

    /// The newest picture; one of an earlier trace while there is none of this one.
    pub fn frame(&self) -> Option<Arc<Frame>> {
        self.session.frame()
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
