//! The list of keys.

use egui::{Align2, Context, RichText, Ui, Window, vec2};

use super::keys::{CLIPBOARD, MOVES, shortcuts};
use super::theme;

/// Shows the list while `open`.
pub fn show(ctx: &Context, open: &mut bool) {
    Window::new("Keys and mouse")
        .open(open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0))
        .show(ctx, |ui| {
            ui.columns_const(|[left, right]| {
                left.set_min_width(270.0);
                heading(left, "Moving");
                list(left, "moves", MOVES.iter().map(|(keys, about)| (keys.to_string(), *about)));
                right.set_min_width(330.0);
                heading(right, "Doing");
                let keys = shortcuts();
                let words = keys.iter().map(|shortcut| {
                    let keys = egui::KeyboardShortcut::new(shortcut.modifiers, shortcut.key);
                    (right.ctx().format_shortcut(&keys), shortcut.about)
                });
                let clipboard = std::iter::once((CLIPBOARD.0.to_owned(), CLIPBOARD.1));
                let words: Vec<_> = words.chain(clipboard).collect();
                list(right, "keys", words.into_iter());
            });
        });
}

fn heading(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).color(theme::accent(ui)).strong());
    ui.add_space(2.0);
}

fn list(ui: &mut Ui, name: &str, rows: impl Iterator<Item = (String, &'static str)>) {
    egui::Grid::new(name).num_columns(2).spacing([14.0, 5.0]).show(ui, |ui| {
        for (keys, about) in rows {
            ui.label(RichText::new(keys).strong());
            ui.label(about);
            ui.end_row();
        }
    });
}
