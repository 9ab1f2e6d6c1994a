//! The frames of a scene that changes with time.

use std::sync::Arc;

/// What a scene says about its frames, and which of them it shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Animation {
    /// Frames of a second, above 0.
    pub fps: f64,
    /// The first frame, which is at time 0, and the last one, not before it; `None` where the scene does not say it.
    pub frames: Option<[i64; 2]>,
    /// The frame that the scene shows.
    pub frame: i64,
}

/// The animation that a model of the scene has in its file.
#[derive(Clone, Debug, PartialEq)]
pub struct AnimatedModel {
    /// The item of the text that places the model.
    pub item: u32,
    /// The animation's name, if it has one.
    pub name: Option<Arc<str>>,
    /// When it has keys, in seconds from the first frame, each later than the one before. What follows the last is said by the model.
    pub key_times: Arc<[f64]>,
}

impl Animation {
    /// The frame at time 0.
    pub fn first_frame(&self) -> i64 {
        self.frames.map_or(1, |[first, _]| first)
    }

    /// Seconds from time 0 to the frame.
    pub fn seconds(&self) -> f64 {
        (self.frame - self.first_frame()) as f64 / self.fps
    }
}
