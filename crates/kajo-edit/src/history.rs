//! What was done, to be undone and done again.

use super::texts::Change;
use super::{FileId, NodeId};

/// Where nodes begin, and what they are known by.
pub(super) type Known = Vec<(FileId, usize, NodeId)>;

/// One step back or forth.
#[derive(Clone, Debug)]
pub(super) struct Step {
    /// What was done, in a few words.
    pub label: String,
    pub change: Change,
    /// Nodes whose text the change takes away, by their places before it.
    pub lost: Known,
    /// Nodes whose text it brings, by their places after it.
    pub gained: Known,
}

impl Step {
    /// The step back.
    fn reversed(self) -> Step {
        Step { label: self.label, change: self.change.inverse(), lost: self.gained, gained: self.lost }
    }
}

/// Steps done and undone, each without limit.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    /// Steps that lead back, the latest last.
    undo: Vec<Step>,
    /// Steps that lead forth again, the next one last.
    redo: Vec<Step>,
}

impl History {
    /// Keeps what was just done. What had been undone cannot be done again.
    pub fn push(&mut self, step: Step) {
        self.redo.clear();
        self.undo.push(step.reversed());
    }

    /// The step back, to be applied.
    pub fn back(&mut self) -> Option<Step> {
        let step = self.undo.pop()?;
        self.redo.push(step.clone().reversed());
        Some(step)
    }

    /// The step forth, to be applied.
    pub fn forth(&mut self) -> Option<Step> {
        let step = self.redo.pop()?;
        self.undo.push(step.clone().reversed());
        Some(step)
    }

    /// What would be undone.
    pub fn undo_label(&self) -> Option<&str> {
        self.undo.last().map(|step| &*step.label)
    }

    /// What would be done again.
    pub fn redo_label(&self) -> Option<&str> {
        self.redo.last().map(|step| &*step.label)
    }

    /// Forgets everything if any step changes another file than this.
    pub fn retain_file(&mut self, file: FileId) {
        if self.undo.iter().chain(&self.redo).any(|step| !step.change.is_only_in(file)) {
            self.clear();
        }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = History::default();
    }
}
