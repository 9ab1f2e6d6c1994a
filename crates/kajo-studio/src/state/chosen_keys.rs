//! Keys that are chosen on the time line.

use kajo_edit::KeyOwner;

/// The keys that are chosen, each by its frame.
#[derive(Clone, Debug, Default)]
pub struct ChosenKeys {
    pub keys: Vec<(KeyOwner, f64)>,
    pub drag: Option<KeyDrag>,
}

/// Keys that are being dragged.
#[derive(Clone, Debug)]
pub struct KeyDrag {
    /// As they were when it began: their places in their rows, and their frames.
    pub keys: Vec<(KeyOwner, usize, f64)>,
    /// How far they are from there.
    pub by: i64,
}

impl ChosenKeys {
    /// What was dragged stays where it is.
    pub fn let_go(&mut self) {
        self.drag = None;
    }

    /// What was dragged is where it was.
    pub fn take_back(&mut self) {
        if let Some(drag) = self.drag.take() {
            self.keys = drag.keys.into_iter().map(|(owner, _, frame)| (owner, frame)).collect();
        }
    }
}

/// Whether two frames are one.
pub fn is_same_frame(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-4
}
