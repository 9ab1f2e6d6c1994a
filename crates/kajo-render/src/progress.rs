//! Observers of a render's progress.

/// An observer of how far a render is, which may stop it. Called from every thread.
pub trait Progress: Sync {
    /// `pixels_done` of `pixels_total` are finished, by the share of samples taken, and `rays` have been
    /// cast so far. Reports of different threads may arrive out of order.
    fn done(&self, pixels_done: u64, pixels_total: u64, rays: u64);

    /// Whether to stop. Asked by each thread after 256 camera rays or 8192 rays of any kind, and before each unit; within
    /// a sample only where its paths fork. A sample that is given up so is not in the film.
    fn cancelled(&self) -> bool;

    /// `done` of `tasks` are finished by which an integrator prepares what its samples share; see [`Setup::tasks`](crate::Setup::tasks). It may
    /// have more than one such list of tasks.
    fn prepared(&self, _done: u32, _tasks: u32) {}

    /// A note on how the picture is made, a sentence for the user.
    fn note(&self, _sentence: &str) {}
}

/// No observer.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn done(&self, _: u64, _: u64, _: u64) {}

    fn cancelled(&self) -> bool {
        false
    }
}
