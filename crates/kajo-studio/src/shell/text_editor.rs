//! The text of the scene to be typed in: what is typed is an edit like any other, mistakes are marked at their places.

use std::collections::HashMap;
use std::sync::Arc;

use egui::text::{CCursor, CCursorRange, LayoutJob, TextFormat};
use egui::text_edit::TextEditState;
use egui::{
    Align2, Color32, FontId, Galley, Id, Key, Margin, Modifiers, Pos2, Rect, ScrollArea, Stroke, TextBuffer,
    TextEdit, Ui, vec2,
};
use kajo::{TokenKind, tokens};
use kajo_edit::{Document, FileId, NodeId, SceneFile};

use super::completion::{Chosen, CompletionList};
use super::{problems_panel, theme};
use crate::state::{Action, Problem, Selection, SourcePosition, line_ends};

/// Room for the numbers of lines, in points.
const GUTTER: i8 = 46;

const FONT: FontId = FontId::monospace(12.5);

/// What the editor remembers between frames.
#[derive(Default)]
pub struct TextEditor {
    /// The text of the file that is shown, and its bytes of then.
    shown: String,
    of: Option<(FileId, Arc<str>)>,
    /// The node whose lines were brought into view.
    visited: Option<NodeId>,
    caret: Option<usize>,
    completions: CompletionList,
    colored: Option<(String, bool, LayoutJob)>,
}

/// Which widget has the focus while one types in the scene.
pub fn id() -> Id {
    Id::unique("text of the scene")
}

impl TextEditor {
    /// The text of one file.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        document: &Document,
        (id, file): (FileId, &SceneFile),
        selection: &Selection,
        problems: &[Problem],
        actions: &mut Vec<Action>,
    ) {
        self.take_over(id, file);
        let has_focus = ui.memory(|memory| memory.has_focus(self::id()));
        let chosen = if has_focus { self.completions.take_keys(ui) } else { None };
        let is_asked = has_focus && ui.input_mut(|input| input.consume_key(Modifiers::CTRL, Key::Space));
        let mut is_completed = chosen.is_some();
        if let Some(chosen) = chosen {
            self.complete(ui, &chosen);
        }
        let mut colored = self.colored.take();
        let mut layouter = |ui: &Ui, text: &dyn TextBuffer, _: f32| galley(ui, text.as_str(), &mut colored);
        ScrollArea::both().id_salt(id).auto_shrink(false).show(ui, |ui| {
            let margin = Margin { left: GUTTER, ..Margin::symmetric(0, 2) };
            let editor = TextEdit::multiline(&mut self.shown)
                .id(self::id())
                .code_editor()
                .frame(egui::Frame::NONE.inner_margin(margin))
                .desired_width(f32::INFINITY)
                .layouter(&mut layouter)
                .show(ui);
            if ui.is_rect_visible(editor.response.rect) {
                number_lines(ui, &editor.galley, editor.galley_pos);
            }
            let rows = Rows { galley: &editor.galley, origin: editor.galley_pos };
            rows.mark_all(ui, problems, &file.name);
            self.visit(ui, &rows, document, (id, file), selection);
            let caret = editor.cursor_range.map(|range| range.primary.index.0);
            let is_typed = editor.response.changed();
            let at = caret.filter(|_| editor.response.has_focus()).map(|caret| byte_of(&self.shown, caret));
            self.completions.follow(ui, &self.shown, at, is_typed && !is_completed, is_asked);
            let below = caret.filter(|_| at.is_some()).map(|caret| {
                let cursor = editor.galley.pos_from_cursor(CCursor::new(caret));
                editor.galley_pos + cursor.left_bottom().to_vec2()
            });
            if let Some(chosen) = self.completions.show(ui, below) {
                self.complete(ui, &chosen);
                is_completed = true;
            }
            let changed = is_typed || is_completed;
            if changed {
                self.type_into(id, file, actions);
            } else if editor.response.lost_focus() || caret != self.caret {
                actions.push(Action::EndTyping);
            }
            self.caret = caret;
            if editor.response.clicked() && !changed {
                self.select_at_caret(document, (id, file), selection, actions);
            }
        });
        self.colored = colored;
    }

    /// Types what is shown into the file; a line that begins or ends is a step of its own.
    fn type_into(&self, id: FileId, file: &SceneFile, actions: &mut Vec<Action>) {
        let text = line_ends::edited(&file.text, &self.shown);
        let lines = |text: &str| text.matches('\n').count();
        let is_new_line = lines(&text) != lines(&file.text);
        actions.push(Action::Type { file: id, text });
        if is_new_line {
            actions.push(Action::EndTyping);
        }
    }

    /// Puts a word that was chosen into the text, and the caret behind it.
    fn complete(&mut self, ui: &Ui, chosen: &Chosen) {
        let Chosen { range, word } = chosen;
        if self.shown.get(range.clone()).is_none() {
            return;
        }
        let gap = if self.shown[range.end..].starts_with(char::is_whitespace) { "" } else { " " };
        self.shown.replace_range(range.clone(), &format!("{word}{gap}"));
        let caret = self.shown[..range.start].chars().count() + word.chars().count() + 1;
        let mut state = TextEditState::load(ui.ctx(), id()).unwrap_or_default();
        state.cursor.set_char_range(Some(CCursorRange::one(CCursor::new(caret))));
        state.store(ui.ctx(), id());
        ui.memory_mut(|memory| memory.request_focus(id()));
    }

    /// Shows what the file says, if that has changed.
    fn take_over(&mut self, id: FileId, file: &SceneFile) {
        let is_same = |(shown, text): &(FileId, Arc<str>)| *shown == id && Arc::ptr_eq(text, &file.text);
        if !self.of.as_ref().is_some_and(is_same) {
            self.shown = line_ends::shown(&file.text);
            self.of = Some((id, Arc::clone(&file.text)));
        }
    }

    /// Marks the lines of what is selected, and brings them into view once.
    fn visit(
        &mut self,
        ui: &Ui,
        rows: &Rows<'_>,
        document: &Document,
        (id, file): (FileId, &SceneFile),
        selection: &Selection,
    ) {
        let node = selection.main().and_then(|node| document.node(node)).filter(|node| node.file == id);
        let Some(node) = node else {
            self.visited = None;
            return;
        };
        let line = |at: usize| file.text.get(..at).map_or(0, |before| before.matches('\n').count());
        let lines = rows.rect(line(node.span.start)).union(rows.rect(line(node.span.end)));
        let bar = Rect::from_min_max(lines.left_top() - vec2(8.0, 0.0), lines.left_bottom() - vec2(5.0, 0.0));
        ui.painter().rect_filled(bar, 1.0, theme::accent(ui));
        if self.visited != Some(node.id) {
            self.visited = Some(node.id);
            ui.scroll_to_rect(lines, None);
        }
    }

    /// Selects the block that the caret was put into.
    fn select_at_caret(
        &mut self,
        document: &Document,
        (id, file): (FileId, &SceneFile),
        selection: &Selection,
        actions: &mut Vec<Action>,
    ) {
        let Some(caret) = self.caret else { return };
        let at = line_ends::in_file(&file.text, byte_of(&self.shown, caret));
        let Some(node) = document.outline().at_byte(id, at).map(|node| node.id) else { return };
        if selection.main() != Some(node) {
            // It is in view where it was clicked.
            self.visited = Some(node);
            actions.push(Action::Select(vec![node]));
        }
    }
}

/// The byte of a letter, counted from 0.
fn byte_of(text: &str, letter: usize) -> usize {
    text.char_indices().nth(letter).map_or(text.len(), |(at, _)| at)
}

/// The lines of a laid out text; none of them is wrapped.
struct Rows<'a> {
    galley: &'a Galley,
    origin: Pos2,
}

impl Rows<'_> {
    /// Where a line is, counted from 0; the last one for lines beyond.
    fn rect(&self, line: usize) -> Rect {
        let row = self.galley.rows.get(line).or(self.galley.rows.last());
        row.map_or(Rect::NOTHING, |row| row.rect()).translate(self.origin.to_vec2())
    }

    /// Marks all problems of a file, those of one line one behind the other.
    fn mark_all(&self, ui: &mut Ui, problems: &[Problem], file: &str) {
        let mut ends = HashMap::new();
        for problem in problems {
            let Some(place) = problem.place.as_ref().filter(|at| at.file == file) else { continue };
            let end = ends.entry(place.line).or_insert_with(|| self.rect(place.line - 1).right());
            *end = self.mark(ui, problem, place, *end);
        }
    }

    /// Underlines the place of a problem and says behind its line what it is; returns where the words end.
    ///
    /// * `after`: where the line ends, and what is said there already
    fn mark(&self, ui: &mut Ui, problem: &Problem, place: &SourcePosition, after: f32) -> f32 {
        let color = problems_panel::color(ui, problem.severity);
        let row = self.rect(place.line - 1);
        let first = self.galley.rows.iter().take(place.line - 1);
        let start = first.map(|row| row.char_count_including_newline().0).sum::<usize>() + place.column - 1;
        let x = |at: usize| self.origin.x + self.galley.pos_from_cursor(CCursor::new(at)).left();
        ui.painter().hline(x(start)..=x(start + place.width), row.bottom() - 1.0, Stroke::new(1.5, color));
        let text = egui::RichText::new(&problem.message).color(color).font(FONT);
        let at = Pos2::new(after + 24.0, row.top());
        let space = Rect::from_min_size(at, vec2(f32::INFINITY, row.height()));
        let builder = egui::UiBuilder::new().max_rect(space);
        let label = ui.scope_builder(builder, |ui| ui.add(egui::Label::new(text).extend())).inner;
        let end = label.rect.right();
        if let Some(help) = &problem.help {
            label.on_hover_text(help);
        }
        end
    }
}

fn number_lines(ui: &Ui, galley: &Galley, origin: Pos2) {
    let visible = ui.clip_rect().y_range();
    let right = origin.x - 14.0;
    for (number, row) in (1..).zip(&galley.rows) {
        let top = origin.y + row.pos.y;
        if visible.contains(top) || visible.contains(top + row.size.y) {
            let at = Pos2::new(right, top);
            ui.painter().text(at, Align2::RIGHT_TOP, number, FONT, theme::quiet(ui));
        }
    }
}

/// The text in colours, laid out; kept while neither text nor theme changes.
fn galley(ui: &Ui, text: &str, kept: &mut Option<(String, bool, LayoutJob)>) -> Arc<Galley> {
    let is_dark = ui.visuals().dark_mode;
    let is_same = |(of, dark, _): &(String, bool, LayoutJob)| of == text && *dark == is_dark;
    if !kept.as_ref().is_some_and(is_same) {
        *kept = Some((text.to_owned(), is_dark, colored(ui, text)));
    }
    let job = kept.as_ref().map(|(_, _, job)| job.clone()).unwrap_or_default();
    ui.fonts_mut(|fonts| fonts.layout_job(job))
}

fn colored(ui: &Ui, text: &str) -> LayoutJob {
    let mut job = LayoutJob::default();
    job.wrap.max_width = f32::INFINITY;
    for token in tokens(text) {
        let piece = &text[token.range()];
        let color = color_of(ui, token.kind, piece);
        job.append(piece, 0.0, TextFormat { font_id: FONT, color, ..TextFormat::default() });
    }
    job
}

fn color_of(ui: &Ui, kind: TokenKind, piece: &str) -> Color32 {
    match kind {
        TokenKind::Comment => theme::good(ui).gamma_multiply(0.8),
        TokenKind::Error(_) => theme::error(ui),
        TokenKind::String => theme::accent(ui),
        // Blocks begin with a capital letter, fields do not.
        TokenKind::Word if piece.starts_with(|c: char| c.is_uppercase()) => theme::keyword(ui),
        TokenKind::Number(_) => ui.visuals().strong_text_color(),
        _ => ui.visuals().text_color(),
    }
}
