//! Questions that stand between a wish and what would be lost by it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kajo_edit::{Conflict, Document};

use super::recovery::{LeftOver, Recovery, left_over};
use super::{Action, Answer, Studio, load_options};

/// Something the user has to decide.
pub enum Question {
    /// The scene has edits that are not saved.
    Unsaved {
        /// What is done afterwards.
        then: Box<Action>,
    },
    /// A file is there already.
    Replace {
        /// The file, or the first of several.
        path: PathBuf,
        /// What replaces it.
        action: Box<Action>,
    },
    /// Files say one thing on disk and another here.
    Conflict {
        /// The files.
        conflicts: Vec<Conflict>,
        /// What brought it up.
        cause: Cause,
    },
    /// Edits were left over by a program that did not come to its end.
    Recover(Vec<LeftOver>),
}

/// How it came to light that a file and its edits have gone different ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Another program wrote it.
    Changed,
    /// It was to be saved.
    Saving,
    /// It was to be read again.
    Reloading,
}

/// What is being asked, and what was decided.
#[derive(Default)]
pub struct Asking {
    /// The newest last: it is to be answered first.
    questions: Vec<Question>,
    /// The edits that may be given up: a document's number and that of its text.
    given_up: Option<(u64, u64)>,
    is_closing: bool,
    recovery: Option<Recovery>,
    folder: PathBuf,
}

impl Studio {
    /// What the user is to decide next.
    pub fn question(&self) -> Option<&Question> {
        self.asking.questions.last()
    }

    /// Whether the program is to end.
    pub fn is_closing(&self) -> bool {
        self.asking.is_closing
    }

    /// Whether there are edits that are not saved.
    pub fn has_unsaved_edits(&self) -> bool {
        self.document.as_ref().is_some_and(Document::has_unsaved_edits) || self.long_texts.is_busy()
    }

    /// Saves unsaved edits aside in a folder from now on, and offers those that were left over there.
    pub fn keep_edits_in(&mut self, folder: &Path) {
        match Recovery::begin(folder, Arc::clone(&self.wake)) {
            Ok(recovery) => self.asking.recovery = Some(recovery),
            Err(error) => {
                self.say(&format!("Edits are not saved aside: {}: {error}.", folder.display()), true)
            }
        }
        self.asking.folder = folder.to_owned();
        self.offer_left_over();
    }

    /// Waits until all edits are saved aside.
    pub fn settle_recovery(&mut self) {
        self.settle();
        self.save_aside();
        if let Some(recovery) = &mut self.asking.recovery {
            recovery.settle();
        }
    }

    /// Saves edits aside, but those of a drag that goes on.
    pub(super) fn save_aside(&mut self) {
        let is_dragging = self.dragged.is_some() || self.grip.is_some() || self.long_texts.is_busy();
        let (Some(recovery), Some(document)) = (&mut self.asking.recovery, &self.document) else { return };
        if !is_dragging {
            recovery.keep(self.opened, document);
        }
        if let Some(problem) = recovery.problem() {
            self.say(&format!("Edits could not be saved aside: {problem}."), true);
        }
    }

    pub(super) fn offer_left_over(&mut self) {
        let found = left_over(&self.asking.folder);
        if !found.is_empty() {
            self.asking.questions.push(Question::Recover(found));
        }
    }

    /// Opens another scene or ends, once the edits of this one are saved or given up.
    pub(super) fn leave(&mut self, then: Action) {
        self.end_drag();
        if self.has_unsaved_edits() {
            self.asking.questions.retain(|question| !matches!(question, Question::Unsaved { .. }));
            self.asking.questions.push(Question::Unsaved { then: Box::new(then) });
            return;
        }
        self.go(then);
    }

    /// Whether the document on show may give way to another.
    pub(super) fn may_go(&self) -> bool {
        let text = self.document.as_ref().map_or(0, Document::text_generation);
        !self.has_unsaved_edits() || self.asking.given_up == Some((self.opened, text))
    }

    fn go(&mut self, action: Action) {
        match action {
            Action::Open(path) => self.opener.order(path),
            Action::New => self.begin_new(),
            Action::Close => {
                if let Some(recovery) = &mut self.asking.recovery {
                    recovery.end();
                }
                self.asking.is_closing = true;
            }
            Action::Recover => self.offer_left_over(),
            _ => {}
        }
    }

    /// Does something that writes a file, once that may be replaced if it is there.
    ///
    /// * `files`: all that would be written
    pub(super) fn write(&mut self, action: Action, files: &[PathBuf]) {
        match files.iter().find(|path| path.exists()) {
            Some(path) => {
                let (path, action) = (path.clone(), Box::new(action));
                self.asking.questions.push(Question::Replace { path, action });
            }
            None => self.write_now(action),
        }
    }

    fn write_now(&mut self, action: Action) {
        match action {
            Action::SaveAs(path) => self.save(Some(&path)),
            Action::Export(path) => self.export(&path),
            Action::Turntable(path) => self.turn(&path),
            _ => {}
        }
    }

    /// Asks what is to become of texts that differ from what is on disk; `false` when none do.
    pub(super) fn ask_about(&mut self, cause: Cause) -> bool {
        let Some(document) = &self.document else { return false };
        let conflicts = match cause {
            Cause::Reloading => document.differences(),
            _ => document.conflicts(),
        };
        let is_one = !conflicts.is_empty();
        // A newer state of the files takes the place of an older one.
        self.asking.questions.retain(|question| !matches!(question, Question::Conflict { .. }));
        if is_one {
            self.asking.questions.push(Question::Conflict { conflicts, cause });
        }
        is_one
    }

    /// Goes on with what had to wait for the edits to be saved.
    pub(super) fn go_on(&mut self) {
        if matches!(self.question(), Some(Question::Unsaved { .. }))
            && !self.has_unsaved_edits()
            && let Some(Question::Unsaved { then }) = self.asking.questions.pop()
        {
            self.go(*then);
        }
    }

    pub(super) fn answer(&mut self, answer: Answer) {
        let Some(question) = self.asking.questions.pop() else { return };
        match (question, answer) {
            (question @ Question::Unsaved { .. }, Answer::Save) => {
                self.asking.questions.push(question);
                self.save(None);
            }
            (Question::Unsaved { then }, Answer::Drop) => {
                let text = self.document.as_ref().map_or(0, Document::text_generation);
                self.asking.given_up = Some((self.opened, text));
                self.go(*then);
            }
            (Question::Replace { action, .. }, Answer::Replace) => self.write_now(*action),
            (Question::Conflict { cause, .. }, Answer::Theirs) => self.take_from_disk(cause),
            (Question::Conflict { conflicts, cause }, Answer::Mine) => {
                if let Some(document) = &mut self.document {
                    document.keep_mine(&conflicts);
                }
                if cause == Cause::Saving {
                    self.save(None);
                }
            }
            (Question::Recover(mut found), Answer::Recover(index)) if index < found.len() => {
                let one = found.remove(index);
                self.recover(one, !found.is_empty());
            }
            (Question::Recover(mut found), Answer::Forget(index)) if index < found.len() => {
                found.remove(index).remove();
                if !found.is_empty() {
                    self.asking.questions.push(Question::Recover(found));
                }
            }
            _ => {}
        }
        self.go_on();
    }

    /// Goes on with edits that were left over.
    fn recover(&mut self, left_over: LeftOver, are_more: bool) {
        let title = left_over.title();
        let folder = std::env::current_dir().unwrap_or_default();
        match Document::restore(&left_over.unsaved, &folder, load_options()) {
            Ok(mut document) => {
                if let Some(recovery) = &mut self.asking.recovery {
                    recovery.adopt(left_over);
                }
                document.compile();
                self.begin(document);
                let more = if are_more { " There are more: File, Recover edits." } else { "" };
                self.say(&format!("The edits of {title} are here again, not saved yet.{more}"), false);
            }
            Err(error) => self.say(&error.to_string(), true),
        }
    }
}
