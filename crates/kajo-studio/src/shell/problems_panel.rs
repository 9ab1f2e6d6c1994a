//! What the reader of scenes has to say, each message with its line and a mark under the place.

use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, FontId, RichText, ScrollArea, Ui};
use kajo::Severity;

use super::theme;
use crate::state::{Problem, SourcePosition};

/// The whole list.
pub fn show(ui: &mut Ui, problems: &[Problem]) {
    if problems.is_empty() {
        ui.label(RichText::new("The scene has no mistakes.").color(theme::quiet(ui)));
        return;
    }
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        for problem in problems {
            ui.label(RichText::new(headline(problem)).color(color(ui, problem.severity)).strong());
            if let Some(place) = &problem.place {
                ui.label(excerpt(
                    place,
                    [theme::quiet(ui), ui.visuals().text_color(), color(ui, problem.severity)],
                ));
            }
            if let Some(help) = &problem.help {
                ui.label(RichText::new(format!("help: {help}")).color(theme::good(ui)));
            }
            ui.add_space(6.0);
        }
    });
}

/// `scene.txt:3:5: error: what`
fn headline(problem: &Problem) -> String {
    let place = problem.place.as_ref();
    let place = place.map_or(String::new(), |at| format!("{}:{}:{}: ", at.file, at.line, at.column));
    format!("{place}{}: {}", problem.severity.name(), problem.message)
}

/// The colour of how bad something is.
pub fn color(ui: &Ui, severity: Severity) -> Color32 {
    match severity {
        Severity::Error => theme::error(ui),
        Severity::Warning => theme::warning(ui),
        Severity::Note => theme::quiet(ui),
    }
}

/// The line, its number before it, and `^^^ label` under the place.
///
/// * `colors`: of the margin, of the line, of what is below it
fn excerpt(place: &SourcePosition, [quiet, text, color]: [Color32; 3]) -> LayoutJob {
    let number = format!("{:>5} | ", place.line);
    let margin = " ".repeat(number.len() - 2) + "| ";
    let tabless = place.text.replace('\t', " ");
    let below = format!("{}{} {}", " ".repeat(place.column - 1), "^".repeat(place.width), place.label);
    let font = FontId::monospace(12.5);
    let format = |color| TextFormat { font_id: font.clone(), color, ..TextFormat::default() };
    let mut job = LayoutJob::default();
    job.append(&number, 0.0, format(quiet));
    job.append(&tabless, 0.0, format(text));
    job.append("\n", 0.0, format(quiet));
    job.append(&margin, 0.0, format(quiet));
    job.append(below.trim_end(), 0.0, format(color));
    job
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mark_is_under_the_place() {
        let place = SourcePosition {
            file: "a.txt".into(),
            line: 12,
            column: 3,
            width: 5,
            text: "\t Sphre {".into(),
            label: "no such shape".into(),
        };
        let text = excerpt(&place, [Color32::RED; 3]).text;
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "   12 |   Sphre {");
        assert_eq!(lines[1], "      |   ^^^^^ no such shape");
        let problem =
            Problem { severity: Severity::Error, message: "what".into(), help: None, place: Some(place) };
        assert_eq!(headline(&problem), "a.txt:12:3: error: what");
    }
}
