//! Handles of what is selected, and what a drag of one does.

use kajo_edit::Document;
use kajo_edit::handles::{
    Axes, Eye, Handle, HandleLine, Mode, Snap, gizmo_of, handles_of, lines_of, pick, pivot_of,
};
use kajo_math::DVec2;

use super::{Action, Studio};

/// How near the pointer must come to a handle, in pixels.
const REACH: f64 = 10.0;

/// A handle that is being dragged.
#[derive(Clone, Debug)]
pub struct Grip {
    handle: Handle,
    /// Where it was grabbed, in pixels of the picture.
    from: DVec2,
    /// The keys that all values had then.
    keys: usize,
}

/// Everything about handles that is drawn.
pub struct Handles {
    /// The handles.
    pub all: Vec<Handle>,
    /// Lines between them.
    pub lines: Vec<HandleLine>,
}

impl Studio {
    /// The handles of what was selected last; none while nothing is.
    pub fn handles(&self) -> Handles {
        let none = Handles { all: Vec::new(), lines: Vec::new() };
        let (Some(document), Some(node)) = (&self.document, self.selection.main()) else { return none };
        let eye = self.eye_of_handles();
        let mut all = handles_of(document, node, &eye);
        if let Some(mode) = self.gizmo {
            all.extend(gizmo_of(document, node, &eye, mode, Axes::World));
        }
        let lines = pivot_of(document, node).map_or_else(Vec::new, |pivot| lines_of(&all, pivot));
        Handles { all, lines }
    }

    /// The index of the handle at a place of the picture.
    pub fn handle_at(&self, handles: &Handles, position: DVec2) -> Option<usize> {
        let found = pick(&handles.all, &self.eye_of_handles(), position, REACH)?;
        handles.all.iter().position(|handle| std::ptr::eq(handle, found))
    }

    /// Whether a handle is being dragged.
    pub fn has_grip(&self) -> bool {
        self.grip.is_some()
    }

    pub(super) fn handle_action(&mut self, action: Action) {
        match action {
            Action::Gizmo(mode) => self.gizmo = if self.gizmo == mode { None } else { mode },
            Action::Grab(position) => self.grab(position),
            Action::DragTo(position, in_steps) => self.drag(position, in_steps),
            Action::CancelDrag => {
                self.settle();
                self.grip = None;
                self.dragged = None;
                self.typing = None;
                self.time_line.chosen.take_back();
                if let Some(document) = &mut self.document {
                    document.cancel_gesture();
                }
                self.compile();
            }
            _ => {}
        }
    }

    fn grab(&mut self, position: DVec2) {
        let handles = self.handles();
        let Some(handle) =
            self.handle_at(&handles, position).and_then(|index| handles.all.get(index)).cloned()
        else {
            return;
        };
        self.end_drag();
        if let Some(document) = &mut self.document {
            document.begin_gesture(format!("drag {}", handle.about));
            self.grip = Some(Grip { handle, from: position, keys: count_of_keys(document) });
        }
    }

    /// Lets go of the handle, and says so where the drag set keys.
    pub(super) fn let_go_of_handle(&mut self) {
        let Some(grip) = self.grip.take() else { return };
        let keys = self.document.as_ref().map_or(0, count_of_keys);
        let frame = self.time_line.timing().map_or(0, |timing| timing.frame);
        match keys.saturating_sub(grip.keys) {
            0 => {}
            1 => self.say(&format!("A key was set at frame {frame}."), false),
            new => self.say(&format!("{new} keys were set at frame {frame}."), false),
        }
    }

    fn drag(&mut self, position: DVec2, in_steps: bool) {
        let Some(Grip { handle, from, .. }) = &self.grip else { return };
        let size = f64::from(self.bounds().extent().length());
        let snap = match in_steps {
            true => Snap { length: round_step(size / 40.0), degrees: 15.0, factor: 0.1 },
            false => Snap::default(),
        };
        let dragged = handle.drag(&self.eye_of_handles(), *from, position, &snap);
        if let Some(dragged) = dragged {
            self.edit(&dragged.edit);
        }
    }

    fn eye_of_handles(&self) -> Eye<'_> {
        Eye { pose: &self.camera, size: self.picture_size() }
    }
}

/// The keys of all values.
fn count_of_keys(document: &Document) -> usize {
    document.key_rows().iter().map(|row| row.keys.len()).sum()
}

/// The largest of 1, 2, 5 times a power of ten that is no larger.
fn round_step(size: f64) -> f64 {
    let mut power = 1e-6;
    while power * 10.0 <= size {
        power *= 10.0;
    }
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * power).find(|step| *step <= size).unwrap_or(power)
}

/// The name of a gizmo for people, and its key.
pub const GIZMOS: [(&str, Mode); 3] = [("Move", Mode::Move), ("Turn", Mode::Turn), ("Scale", Mode::Scale)];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        for (size, step) in [(0.7, 0.5), (0.2, 0.2), (1.9, 1.0), (30.0, 20.0)] {
            assert!((round_step(size) / step - 1.0).abs() < 1e-9, "{size}: {}", round_step(size));
        }
        assert!(round_step(0.0) > 0.0);
    }
}
