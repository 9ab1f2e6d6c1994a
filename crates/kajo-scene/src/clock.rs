//! The moments for which a scene text is evaluated.
//!
//! Times are counted in frames, on a grid so fine that nobody sees it: so a period that is a whole number of frames
//! is one in all arithmetic, and a loop closes to the bit.

/// Steps of the grid of a frame.
const GRID: f64 = (1u64 << 24) as f64;

/// The rate of frames where nothing else is said.
pub const USUAL_FPS: f64 = 24.0;

/// When a scene text is evaluated: what `time` and `frame` are in its expressions.
///
/// The first moment is that of the frame, at which every number has the value that the scene is made of. At the others
/// numbers that change with time are evaluated besides (see [`Item::at_moment`](crate::Item::at_moment)).
#[derive(Clone, Debug, PartialEq)]
pub struct Clock {
    fps: f64,
    first_frame: i64,
    /// In frames since time 0.
    moments: Vec<f64>,
}

impl Default for Clock {
    /// Time 0, which is frame 1, and no other moment.
    fn default() -> Clock {
        Clock::new(USUAL_FPS, 1, 1)
    }
}

impl Clock {
    /// The time of a frame.
    ///
    /// * `fps`: frames of a second, above 0
    /// * `first_frame`: the one at time 0
    pub fn new(fps: f64, first_frame: i64, frame: i64) -> Clock {
        Clock { fps, first_frame, moments: vec![(frame - first_frame) as f64] }
    }

    /// The same with further moments.
    ///
    /// * `offsets`: in frames, from that of the frame
    pub fn with_moments(mut self, offsets: impl IntoIterator<Item = f64>) -> Clock {
        let now = self.moments[0];
        self.moments.truncate(1);
        self.moments.extend(offsets.into_iter().map(|offset| on_grid(now + offset)));
        self
    }

    /// Frames of a second.
    pub fn fps(&self) -> f64 {
        self.fps
    }

    /// The frame at time 0.
    pub fn first_frame(&self) -> i64 {
        self.first_frame
    }

    /// The number of the frame.
    pub fn frame(&self) -> i64 {
        self.first_frame + self.moments[0] as i64
    }

    /// Seconds from time 0 to the frame.
    pub fn seconds(&self) -> f64 {
        self.seconds_at(0)
    }

    /// How many moments there are, that of the frame among them.
    pub fn len(&self) -> usize {
        self.moments.len()
    }

    /// Whether there are other moments than that of the frame, so that things may move.
    pub fn is_film(&self) -> bool {
        self.len() > 1
    }

    /// Never: that of the frame is always there.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Frames from the clock's own to a moment.
    pub fn offset(&self, moment: usize) -> f64 {
        self.moments[moment] - self.moments[0]
    }

    /// Frames from that at time 0 to a moment.
    pub(crate) fn frames_at(&self, moment: usize) -> f64 {
        self.moments[moment]
    }

    pub(crate) fn seconds_at(&self, moment: usize) -> f64 {
        self.moments[moment] / self.fps
    }

    /// The number of the frame at a moment, with its fraction.
    pub(crate) fn frame_at(&self, moment: usize) -> f64 {
        self.first_frame as f64 + self.moments[moment]
    }

    /// A time in seconds, counted in frames.
    pub fn in_frames(&self, seconds: f64) -> f64 {
        on_grid(seconds * self.fps)
    }
}

fn on_grid(frames: f64) -> f64 {
    let scaled = frames * GRID;
    // Beyond this every double is on the grid.
    if scaled.abs() < 9e15 { scaled.round() / GRID } else { frames }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_frames_and_periods_are_exact() {
        for fps in [24.0, 25.0, 30.0, 24000.0 / 1001.0] {
            for frame in [1, 2, 25, 1_000_001] {
                let clock = Clock::new(fps, 1, frame).with_moments([0.0, 0.3, 0.5]);
                assert_eq!(clock.frame(), frame);
                // As somebody writes the time of the frame.
                assert_eq!(clock.in_frames((frame - 1) as f64 / fps), clock.frames_at(0));
                assert_eq!(clock.frames_at(1), (frame - 1) as f64);
                // A moment within the frame is the same in all of them.
                let same = Clock::new(fps, 1, 1).with_moments([0.3]).frames_at(1);
                assert_eq!(clock.frames_at(2) - clock.frames_at(0), same);
            }
        }
        let clock = Clock::new(24.0, 5, 17).with_moments([0.5]);
        assert_eq!((clock.seconds(), clock.seconds_at(1), clock.frame_at(1)), (0.5, 12.5 / 24.0, 17.5));
        assert!(Clock::default().in_frames(1e300).is_finite());
    }
}
