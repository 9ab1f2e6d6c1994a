//! The list of keys.

use egui::{Align2, Context, RichText, ScrollArea, Ui, Window, vec2};

use super::keys::{CLIPBOARD, COMPLETION, MOVES, shortcuts};
use super::theme;

/// Points that the two columns take side by side.
const WIDTHS: [f32; 2] = [290.0, 360.0];

/// Shows the list while `open`, as large as the window allows.
pub fn show(ctx: &Context, open: &mut bool) {
    let room = ctx.content_rect().size() - vec2(40.0, 70.0);
    let is_wide = room.x > WIDTHS[0] + WIDTHS[1] + 20.0;
    Window::new("Keys and mouse")
        .open(open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0))
        .show(ctx, |ui| {
            ScrollArea::vertical().max_height(room.y).show(ui, |ui| match is_wide {
                true => ui.columns_const(|[left, right]| {
                    left.set_min_width(WIDTHS[0]);
                    moves(left);
                    right.set_min_width(WIDTHS[1]);
                    keys(right);
                }),
                false => {
                    moves(ui);
                    ui.add_space(8.0);
                    keys(ui);
                }
            });
        });
}

fn moves(ui: &mut Ui) {
    heading(ui, "Moving");
    list(ui, "moves", MOVES.iter().map(|(keys, about)| (keys.to_string(), *about)));
}

fn keys(ui: &mut Ui) {
    heading(ui, "Doing");
    let keys = shortcuts();
    let words = keys.iter().map(|shortcut| {
        let keys = egui::KeyboardShortcut::new(shortcut.modifiers, shortcut.key);
        (ui.ctx().format_shortcut(&keys), shortcut.about)
    });
    let clipboard = [CLIPBOARD, COMPLETION].into_iter().map(|(keys, about)| (keys.to_owned(), about));
    let words: Vec<_> = words.chain(clipboard).collect();
    list(ui, "keys", words.into_iter());
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
