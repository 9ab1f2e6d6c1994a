//! Edits of long texts, which take longer than a frame of the window may.
//!
//! Every edit has the text parsed anew, which takes about a second for a million lines. While something in such a text
//! is dragged, and when another program has written it, a thread does that on a copy of the document, and the copy
//! takes the document's place. Of the edits of a drag only the newest counts, since each starts from the text before the
//! drag, and of frames of an animation the newest. Whatever else is to be done to the document waits for the copy.

use std::thread;

use kajo_edit::{Document, Edit};

use super::Studio;
use super::tracer::Wake;
use super::worker::Worker;

/// Bytes of text that are parsed within a frame.
const LONG: usize = 1 << 20;

/// What is to be done to a copy of a document.
pub enum Task {
    /// A step of a drag.
    Apply(Edit),
    /// Reading its files again.
    Reload,
    /// Reading again what other programs have written.
    TakeTheirs,
    /// Showing it as it is at a frame.
    ShowFrame(i64),
}

impl Task {
    /// Does it.
    ///
    /// # Errors
    /// Why it cannot be done.
    pub fn carry_out(&self, document: &mut Document) -> Result<(), String> {
        match self {
            Task::Apply(edit) => document.apply(edit).map(drop).map_err(|refused| refused.to_string()),
            Task::Reload => document.reload().map(drop).map_err(|error| error.to_string()),
            Task::TakeTheirs => document.take_theirs().map(drop).map_err(|error| error.to_string()),
            Task::ShowFrame(frame) => {
                document.show_frame(*frame);
                Ok(())
            }
        }
    }
}

/// A document and what is to be done to it, or was done.
pub struct Copied {
    /// The number of the document.
    opened: u64,
    document: Document,
    task: Task,
    problem: Option<String>,
}

/// The thread, and what it is to do next.
pub struct LongTexts {
    worker: Worker<Copied, Copied>,
    next: Option<Task>,
}

impl LongTexts {
    /// Nothing to do yet.
    pub fn new(wake: Wake) -> LongTexts {
        LongTexts { worker: Worker::new(wake, Copied::carry_out), next: None }
    }

    /// Whether a copy is being edited.
    pub fn is_busy(&self) -> bool {
        self.worker.is_busy()
    }
}

impl Copied {
    fn carry_out(mut self) -> Copied {
        self.problem = self.task.carry_out(&mut self.document).err();
        self
    }
}

impl Studio {
    /// Whether the texts are so long that edits had better be made beside the window.
    pub(super) fn has_long_text(&self) -> bool {
        let bytes = |document: &Document| document.files().map(|(_, file)| file.text.len()).sum::<usize>();
        self.document.as_ref().is_some_and(|document| bytes(document) >= LONG)
    }

    /// Has something done to a copy of the document, now or once that is free.
    pub(super) fn do_beside(&mut self, task: Task) {
        if self.long_texts.is_busy() {
            self.long_texts.next = Some(task);
        } else if let Some(document) = &self.document {
            let (opened, document) = (self.opened, document.clone());
            self.long_texts.worker.order(Copied { opened, document, task, problem: None });
        }
    }

    /// Takes over a copy that is done.
    pub(super) fn take_copy(&mut self) {
        if let Some(copied) = self.long_texts.worker.take() {
            self.take_over(copied);
        }
    }

    /// Waits until nothing is left to be done to a copy.
    pub(super) fn settle(&mut self) {
        while let Some(copied) = self.long_texts.worker.wait() {
            self.take_over(copied);
        }
    }

    fn take_over(&mut self, copied: Copied) {
        let next = self.long_texts.next.take();
        let chosen = self.chosen();
        let Some(document) = self.document.as_mut().filter(|_| copied.opened == self.opened) else { return };
        let mut newer = copied.document;
        newer.keep_scene_of(document);
        let older = std::mem::replace(document, newer);
        // To free a million nodes takes a while too.
        thread::spawn(move || drop(older));
        self.compile();
        match (copied.problem, copied.task) {
            (Some(problem), _) => self.say(&problem, true),
            (None, Task::Reload | Task::TakeTheirs) => self.was_reloaded(&chosen),
            (None, Task::Apply(_) | Task::ShowFrame(_)) => {}
        }
        if let Some(task) = next {
            self.do_beside(task);
        }
    }
}
