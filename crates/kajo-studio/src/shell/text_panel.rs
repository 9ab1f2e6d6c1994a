//! The text of the scene as it is now, mistakes marked at their lines, what is selected lit up.

use std::ops::Range;

use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, FontId, ScrollArea, Ui};
use kajo::edit::Document;

use super::{problems_panel, theme};
use crate::state::{Problem, Selection};

const ROW: f32 = 16.0;

/// The whole panel.
pub fn show(ui: &mut Ui, document: &Document, selection: &Selection, problems: &[Problem]) {
    let Some((_, file)) = document.files().next() else { return };
    let text: &str = &file.text;
    let starts: Vec<usize> = line_starts(text);
    let chosen = chosen_lines(document, selection, &starts);
    let id = ui.scope_id().with("shown");
    let mistake =
        problems.iter().filter_map(|problem| problem.place.as_ref()).find(|at| at.file == file.name);
    let first = mistake.map(|at| at.line - 1).or(chosen.as_ref().map(|lines| lines.start));
    let mut area = ScrollArea::both().auto_shrink(false);
    if first != ui.data(|data| data.get_temp::<Option<usize>>(id)).flatten() {
        ui.data_mut(|data| data.insert_temp(id, first));
        if let Some(line) = first {
            area = area.vertical_scroll_offset((line as f32 - 2.0).max(0.0) * ROW);
        }
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    area.show_rows(ui, ROW, starts.len(), |ui, range| {
        for line in range {
            let end = starts.get(line + 1).copied().unwrap_or(text.len());
            let content = text[starts[line]..end].trim_end_matches(['\n', '\r']);
            let problem = problems.iter().find(|problem| {
                problem.place.as_ref().is_some_and(|at| at.line == line + 1 && at.file == file.name)
            });
            let is_chosen = chosen.as_ref().is_some_and(|lines| lines.contains(&line));
            let job = row(line + 1, content, is_chosen, problem);
            ui.add(egui::Label::new(job).extend());
        }
    });
}

/// A line with its number, and what is wrong with it.
fn row(number: usize, content: &str, is_chosen: bool, problem: Option<&Problem>) -> LayoutJob {
    let mut job = LayoutJob::default();
    let format = |color| TextFormat { font_id: FontId::monospace(12.5), color, ..TextFormat::default() };
    let color = if is_chosen { theme::ACCENT } else { Color32::from_gray(205) };
    job.append(&format!("{number:>5}  "), 0.0, format(theme::QUIET));
    let (code, comment) = content.split_at(comment_start(content));
    let mut code_format = format(color);
    if let Some(problem) = problem {
        code_format.underline = egui::Stroke::new(1.0, problems_panel::color(problem.severity));
    }
    job.append(code, 0.0, code_format);
    job.append(comment, 0.0, format(theme::GOOD.gamma_multiply(0.7)));
    if let Some(problem) = problem {
        job.append(
            &format!("    <- {}", problem.message),
            0.0,
            format(problems_panel::color(problem.severity)),
        );
    }
    job
}

/// Where a comment to the end of the line begins.
fn comment_start(line: &str) -> usize {
    let hash = line.find('#').filter(|&at| line[..at].trim().is_empty());
    line.find("//").or(hash).unwrap_or(line.len())
}

fn line_starts(text: &str) -> Vec<usize> {
    std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect()
}

/// The lines of the node that was selected last, from 0.
fn chosen_lines(document: &Document, selection: &Selection, starts: &[usize]) -> Option<Range<usize>> {
    let node = document.node(selection.main()?)?;
    let (first_file, _) = document.files().next()?;
    if node.file != first_file {
        return None;
    }
    let line = |at: usize| starts.partition_point(|&start| start <= at).saturating_sub(1);
    Some(line(node.span.start)..line(node.span.end.saturating_sub(1)) + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_found_by_their_starts() {
        assert_eq!(line_starts("a\nbc\n"), [0, 2, 5]);
        assert_eq!(line_starts(""), [0]);
    }

    #[test]
    fn comments_are_told_from_code() {
        assert_eq!(comment_start("Sphere {} // a ball"), 10);
        assert_eq!(comment_start("  # a comment"), 2);
        assert_eq!(comment_start("a #1"), 4);
    }

    #[test]
    fn a_mistake_stands_behind_its_line() {
        let problem = Problem {
            severity: kajo::Severity::Error,
            message: "no such shape".into(),
            help: None,
            place: None,
        };
        let text = row(7, "Sphre {}", false, Some(&problem)).text;
        assert_eq!(text, "    7  Sphre {}    <- no such shape");
    }
}
