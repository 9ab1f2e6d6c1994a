//! The list of words that may be typed at the caret of the text.
//!
//! It opens while a key is typed, or for Ctrl+Space, and takes the arrows, Enter and Tab from the editor while it is open.

use std::ops::Range;

use egui::{Align, Area, Frame, Grid, Id, Key, Modifiers, Order, Pos2, Rect, RichText, ScrollArea, Ui};
use kajo_edit::{Completion, completion};

use super::theme;

/// Points of height at most; what does not fit is scrolled to.
const MOST_HEIGHT: f32 = 220.0;

/// A word that was chosen, and the bytes of the text in whose place it is put.
pub struct Chosen {
    pub range: Range<usize>,
    pub word: &'static str,
}

/// What may be typed, and what of it is marked.
struct Open {
    completion: Completion,
    marked: usize,
}

impl Open {
    fn chosen(&self) -> Option<Chosen> {
        let word = self.completion.suggestions.get(self.marked)?.word;
        Some(Chosen { range: self.completion.range.clone(), word })
    }
}

/// The list, which may be closed.
#[derive(Default)]
pub struct CompletionList {
    open: Option<Open>,
    /// The caret that the list is for, a byte of the text.
    caret: Option<usize>,
    /// Where it is drawn, and what it covered when it was drawn last.
    below: Pos2,
    covered: Option<Rect>,
    /// Whether the mark has moved since the list was drawn.
    is_moved: bool,
}

impl CompletionList {
    /// Takes the keys that are for the list, before the editor sees them. Returns what they choose.
    pub fn take_keys(&mut self, ui: &Ui) -> Option<Chosen> {
        let open = self.open.as_mut()?;
        let n = open.completion.suggestions.len();
        let pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
        if pressed(Key::ArrowDown) {
            (open.marked, self.is_moved) = ((open.marked + 1) % n, true);
        }
        if pressed(Key::ArrowUp) {
            (open.marked, self.is_moved) = ((open.marked + n - 1) % n, true);
        }
        if pressed(Key::Enter) || pressed(Key::Tab) {
            let chosen = open.chosen();
            self.open = None;
            return chosen;
        }
        None
    }

    /// Opens, narrows or closes the list.
    ///
    /// * `caret`: a byte of the text; `None` while nobody types in it
    /// * `is_typed`: whether the text has just been changed by typing
    /// * `is_asked`: whether the list was asked for
    pub fn follow(&mut self, ui: &Ui, text: &str, caret: Option<usize>, is_typed: bool, is_asked: bool) {
        let Some(caret) = caret else {
            // A click on the list takes the focus from the text.
            let pointer = ui.input(|input| input.pointer.interact_pos());
            let is_on_list = |covered: Rect| pointer.is_some_and(|pointer| covered.contains(pointer));
            if !self.covered.is_some_and(is_on_list) {
                self.open = None;
            }
            return;
        };
        let has_moved = self.caret.replace(caret) != Some(caret);
        if !(is_typed || is_asked || has_moved) {
            return;
        }
        let was_open = self.open.take().is_some();
        if !(is_typed || is_asked || was_open) {
            return;
        }
        let Some(completion) = completion(text, caret) else { return };
        let begun = &text[completion.range.start..caret];
        let is_whole = completion.suggestions.iter().any(|suggestion| suggestion.word == begun);
        // Between words, and behind a whole one, it would be in the way of who goes on.
        if is_asked || (!begun.is_empty() && !is_whole) {
            self.open = Some(Open { completion, marked: 0 });
            self.is_moved = true;
        }
    }

    /// Draws the list. Returns what is clicked.
    ///
    /// * `below`: the lower end of the caret, while there is one
    pub fn show(&mut self, ui: &Ui, below: Option<Pos2>) -> Option<Chosen> {
        self.covered = None;
        self.below = below.unwrap_or(self.below);
        let open = self.open.as_mut()?;
        let is_moved = std::mem::take(&mut self.is_moved);
        let area = Area::new(Id::unique("words to type")).order(Order::Foreground).fixed_pos(self.below);
        let mut clicked = false;
        let response = area.show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ScrollArea::vertical().max_height(MOST_HEIGHT).show(ui, |ui| {
                    Grid::new("words to type").num_columns(2).striped(true).show(ui, |ui| {
                        for (i, suggestion) in open.completion.suggestions.iter().enumerate() {
                            let word = RichText::new(suggestion.word).monospace();
                            let row = ui.selectable_label(i == open.marked, word);
                            if i == open.marked && is_moved {
                                row.scroll_to_me(Some(Align::Center));
                            }
                            if row.clicked() {
                                (open.marked, clicked) = (i, true);
                            }
                            let said = [suggestion.values.as_str(), suggestion.about];
                            let said: Vec<&str> = said.into_iter().filter(|said| !said.is_empty()).collect();
                            ui.label(RichText::new(said.join(": ")).small().color(theme::quiet(ui)));
                            ui.end_row();
                        }
                    });
                });
            });
        });
        self.covered = Some(response.response.rect);
        if !clicked {
            return None;
        }
        let chosen = open.chosen();
        self.open = None;
        chosen
    }
}
