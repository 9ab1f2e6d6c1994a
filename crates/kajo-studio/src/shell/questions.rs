//! Questions of the studio, each a dialog over the window that Esc cancels.

use std::time::SystemTime;

use egui::text::{LayoutJob, TextFormat};
use egui::{Button, Color32, Context, FontId, Modal, RichText, ScrollArea, Ui};
use kajo_edit::{Conflict, hunks};

use super::theme;
use crate::state::{Answer, Cause, LeftOver, Question};

/// Lines shown around those that differ.
const CONTEXT: usize = 2;

/// What the dialog needs beside the question.
#[derive(Default)]
pub struct Questions {
    /// Whether the difference of a conflict is shown.
    shows_difference: bool,
    /// Which dialog was shown in the last frame: the first button of a new one has the focus.
    shown: Option<String>,
}

impl Questions {
    /// Shows the question that stands, if one does.
    ///
    /// * `title`: the name of the scene
    /// * `problem`: what went wrong with the last answer
    pub fn show(
        &mut self,
        ctx: &Context,
        question: Option<&Question>,
        title: &str,
        problem: Option<&str>,
    ) -> Option<Answer> {
        let Some(question) = question else {
            *self = Questions::default();
            return None;
        };
        let mut answer = None;
        let modal = Modal::new(egui::Id::unique("question")).show(ctx, |ui| {
            let screen = ui.ctx().content_rect().size();
            ui.set_width((screen.x - 60.0).clamp(200.0, 560.0));
            let height = (screen.y - 190.0).max(60.0);
            ui.heading(headline(question, title));
            ui.add_space(6.0);
            answer = match question {
                Question::Unsaved { .. } => self.unsaved(ui),
                Question::Replace { path, .. } => {
                    ui.label(path.display().to_string());
                    ui.label("It will be lost if it is replaced.");
                    self.buttons(ui, &[("Replace", Answer::Replace), ("Cancel", Answer::Cancel)])
                }
                Question::Conflict { conflicts, cause } => self.conflict(ui, conflicts, *cause, height),
                Question::Recover(found) => self.recover(ui, found, height),
            };
            if let Some(problem) = problem {
                ui.label(RichText::new(problem).color(theme::error(ui)));
            }
        });
        answer.or(modal.should_close().then_some(Answer::Cancel))
    }

    fn unsaved(&mut self, ui: &mut Ui) -> Option<Answer> {
        ui.label("Without saving they are lost.");
        let all = [("Save", Answer::Save), ("Don't save", Answer::Drop), ("Cancel", Answer::Cancel)];
        self.buttons(ui, &all)
    }

    fn conflict(&mut self, ui: &mut Ui, conflicts: &[Conflict], cause: Cause, height: f32) -> Option<Answer> {
        ui.label(match cause {
            Cause::Changed | Cause::Saving => {
                "Another program has written it since, and there are edits here that are not saved. \
                 Theirs takes the file as it is on disk, and undo brings your edits back. Mine keeps the edits; \
                 saving replaces what is on disk."
            }
            Cause::Reloading => {
                "There are edits here that are not saved. Theirs takes the file as it is on disk, and undo brings \
                 your edits back."
            }
        });
        ui.add_space(4.0);
        let name = if self.shows_difference { "Hide the difference" } else { "Show the difference" };
        if ui.button(name).clicked() {
            self.shows_difference = !self.shows_difference;
            // The dialog has another size now, and is to be in the middle again.
            ui.ctx().request_repaint();
        }
        if self.shows_difference {
            egui::Frame::new().fill(ui.visuals().extreme_bg_color).inner_margin(6.0).show(ui, |ui| {
                ScrollArea::both().max_height(height - 60.0).auto_shrink([false, true]).show(ui, |ui| {
                    let colors = [theme::quiet(ui), theme::error(ui), theme::good(ui)];
                    for conflict in conflicts {
                        ui.add(egui::Label::new(difference(conflict, colors)).extend());
                    }
                });
            });
        }
        let mine = if cause == Cause::Saving { "Mine: save over it" } else { "Mine" };
        self.buttons(ui, &[("Theirs", Answer::Theirs), (mine, Answer::Mine), ("Cancel", Answer::Cancel)])
    }

    fn recover(&mut self, ui: &mut Ui, found: &[LeftOver], height: f32) -> Option<Answer> {
        ui.label("The studio did not come to its end. These edits were never saved:");
        ui.add_space(4.0);
        let mut answer = None;
        ScrollArea::vertical().max_height(height).auto_shrink([false, true]).show(ui, |ui| {
            for (index, one) in found.iter().enumerate() {
                ui.horizontal(|ui| {
                    let first = self.is_new(&format!("recover {}", found.len())) && index == 0;
                    let button = ui.add(accented(ui, "Recover"));
                    if first {
                        button.request_focus();
                    }
                    if button.clicked() {
                        answer = Some(Answer::Recover(index));
                    }
                    if ui.button("Forget").on_hover_text("These edits are lost then").clicked() {
                        answer = Some(Answer::Forget(index));
                    }
                    let path = one.unsaved.path.as_ref().map(|path| path.display().to_string());
                    ui.label(RichText::new(one.title()).strong()).on_hover_text(path.unwrap_or_default());
                    ui.label(RichText::new(ago(one.when)).color(theme::quiet(ui)));
                });
            }
        });
        ui.add_space(6.0);
        let later = ui.button("Later").on_hover_text("File, Recover edits, asks again").clicked();
        answer.or(later.then_some(Answer::Cancel))
    }

    /// A row of buttons, the first in the accent colour.
    fn buttons(&mut self, ui: &mut Ui, all: &[(&str, Answer)]) -> Option<Answer> {
        ui.add_space(8.0);
        let mut answer = None;
        ui.horizontal_wrapped(|ui| {
            for (index, (name, meaning)) in all.iter().enumerate() {
                let button = ui.add(if index == 0 { accented(ui, name) } else { Button::new(*name) });
                if index == 0 && self.is_new(name) {
                    button.request_focus();
                }
                if button.clicked() {
                    answer = Some(*meaning);
                }
            }
        });
        answer
    }

    /// Whether a dialog of this name was not shown in the last frame.
    fn is_new(&mut self, name: &str) -> bool {
        let is_new = self.shown.as_deref() != Some(name);
        self.shown = Some(name.to_owned());
        is_new
    }
}

fn accented(ui: &Ui, text: &str) -> Button<'static> {
    Button::new(RichText::new(text).color(theme::on_accent(ui)).strong()).fill(theme::accent(ui))
}

fn headline(question: &Question, title: &str) -> String {
    match question {
        Question::Unsaved { .. } => format!("Save the edits of {title}?"),
        Question::Replace { .. } => "There is such a file already".to_owned(),
        Question::Conflict { conflicts, .. } => match conflicts.as_slice() {
            [one] => format!("{} has changed on disk", short(&one.name)),
            all => format!("{} files have changed on disk", all.len()),
        },
        Question::Recover(_) => "Unsaved edits were found".to_owned(),
    }
}

fn short(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}

/// How long ago something was, in words.
fn ago(when: SystemTime) -> String {
    let seconds = SystemTime::now().duration_since(when).unwrap_or_default().as_secs();
    let (n, unit) = match seconds {
        0..60 => return "a moment ago".to_owned(),
        60..3600 => (seconds / 60, "minute"),
        3600..86400 => (seconds / 3600, "hour"),
        _ => (seconds / 86400, "day"),
    };
    format!("{n} {unit}{} ago", if n == 1 { "" } else { "s" })
}

/// The lines that differ, `-` before mine and `+` before theirs, and a few around them.
///
/// * `colors`: of lines that stay, of mine, of theirs
fn difference(conflict: &Conflict, [same, mine, theirs]: [Color32; 3]) -> LayoutJob {
    let mut job = LayoutJob::default();
    let mut line = |sign: &str, text: &str, color| {
        let format = TextFormat { font_id: FontId::monospace(12.5), color, ..TextFormat::default() };
        job.append(&format!("{sign} {}\n", text.trim_end_matches(['\n', '\r'])), 0.0, format);
    };
    line(" ", &format!("{}:  - mine   + theirs", short(&conflict.name)), same);
    let [old, new] = [&conflict.mine, &conflict.theirs].map(|text| text.lines().collect::<Vec<_>>());
    let hunks = hunks(&conflict.mine, &conflict.theirs);
    let mut shown = 0;
    for (index, hunk) in hunks.iter().enumerate() {
        let from = hunk.old.start.saturating_sub(CONTEXT).max(shown);
        if from > shown {
            line(" ", &format!("... line {}", from + 1), same);
        }
        old[from..hunk.old.start].iter().for_each(|text| line(" ", text, same));
        old[hunk.old.clone()].iter().for_each(|text| line("-", text, mine));
        new[hunk.new.clone()].iter().for_each(|text| line("+", text, theirs));
        let next = hunks.get(index + 1).map_or(old.len(), |next| next.old.start);
        shown = (hunk.old.end + CONTEXT).min(next);
        old[hunk.old.end..shown].iter().for_each(|text| line(" ", text, same));
    }
    job
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_edit::Document;
    use std::time::Duration;

    #[test]
    fn the_difference_shows_what_differs_and_a_little_more() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        let lines: String = (0..12).map(|i| format!("// {i}\n")).collect();
        std::fs::write(&path, &lines).unwrap();
        let mut document = Document::open(&path, kajo::LoadOptions::default()).unwrap();
        let text = lines.replace("// 1\n", "// one\n").replace("// 9\n", "");
        let file = document.files().next().unwrap().0;
        document.apply(&kajo_edit::Edit::Rewrite { file, text }).unwrap();
        let conflict = document.differences().remove(0);
        let text = difference(&conflict, [Color32::GRAY; 3]).text;
        let wanted = "  a.txt:  - mine   + theirs\n  // 0\n- // one\n+ // 1\n  // 2\n  // 3\n  ... line 8\n  // 7\n  \
                      // 8\n+ // 9\n  // 10\n  // 11\n";
        assert_eq!(text, wanted);
        document.reload().unwrap();
        assert!(document.differences().is_empty());
    }

    #[test]
    fn times_are_told_in_words() {
        let before = |seconds| ago(SystemTime::now() - Duration::from_secs(seconds));
        assert_eq!(
            [before(0), before(61), before(7300), before(90_000)],
            ["a moment ago", "1 minute ago", "2 hours ago", "1 day ago"]
        );
    }
}
