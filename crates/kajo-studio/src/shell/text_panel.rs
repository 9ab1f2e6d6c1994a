//! The text of the scene, file by file: an editor, or, for texts that are too long for one, their lines to look at.

use egui::text::{LayoutJob, TextFormat};
use egui::{ComboBox, FontId, RichText, ScrollArea, Ui};
use kajo_edit::{Document, FileId};

use super::text_editor::TextEditor;
use super::theme;
use crate::state::{Action, Problem, Selection};

const ROW: f32 = 16.0;

/// Texts of more bytes are shown, not edited: laying them out for each key would take too long.
const LONGEST_EDITED: usize = 400_000;

/// The panel.
#[derive(Default)]
pub struct TextPanel {
    editor: TextEditor,
    chosen: Option<String>,
}

impl TextPanel {
    /// The whole panel; what it asks for goes into `actions`.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        document: &Document,
        selection: &Selection,
        problems: &[Problem],
        actions: &mut Vec<Action>,
    ) {
        self.choose(ui, document);
        let chosen = document.files().find(|(_, file)| Some(&file.name) == self.chosen.as_ref());
        let Some((id, file)) = chosen.or(document.files().next()) else { return };
        if file.text.len() > LONGEST_EDITED {
            ui.label(RichText::new("This text is too long to be edited here.").color(theme::quiet(ui)));
            lines(ui, id, &file.text);
            return;
        }
        self.editor.show(ui, document, (id, file), selection, problems, actions);
    }

    /// Which file, if there are several.
    fn choose(&mut self, ui: &mut Ui, document: &Document) {
        if document.files().nth(1).is_none() {
            return;
        }
        let first = document.files().next().map_or("", |(_, file)| &file.name);
        let shown = self.chosen.as_deref().unwrap_or(first).to_owned();
        ComboBox::from_id_salt("file of the scene").selected_text(shown).show_ui(ui, |ui| {
            for (_, file) in document.files() {
                ui.selectable_value(&mut self.chosen, Some(file.name.clone()), &file.name);
            }
        });
    }
}

/// The lines that are in view.
fn lines(ui: &mut Ui, id: FileId, text: &str) {
    let starts: Vec<usize> = line_starts(text);
    ui.spacing_mut().item_spacing.y = 0.0;
    let format = |color| TextFormat { font_id: FontId::monospace(12.5), color, ..TextFormat::default() };
    let [number_color, color] = [theme::quiet(ui), ui.visuals().text_color()];
    ScrollArea::both().id_salt(id).auto_shrink(false).show_rows(ui, ROW, starts.len(), |ui, range| {
        for line in range {
            let end = starts.get(line + 1).copied().unwrap_or(text.len());
            let content = text[starts[line]..end].trim_end_matches(['\n', '\r']);
            let mut job = LayoutJob::default();
            job.append(&format!("{:>7}  ", line + 1), 0.0, format(number_color));
            job.append(content, 0.0, format(color));
            ui.add(egui::Label::new(job).extend());
        }
    });
}

fn line_starts(text: &str) -> Vec<usize> {
    std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_found_by_their_starts() {
        assert_eq!(line_starts("a\nbc\n"), [0, 2, 5]);
        assert_eq!(line_starts(""), [0]);
    }
}
