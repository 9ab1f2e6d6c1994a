//! The bar at the top: menus, and the two things one does all the time.

use std::path::PathBuf;

use egui::{Align, Button, Label, Layout, MenuBar, RichText, Ui};
use kajo::session::Status;

use super::keys::Command;
use super::theme;
use crate::state::{Action, GIZMOS, Shown, Studio};

/// The whole bar; what was chosen goes into `commands`.
///
/// * `recent`: the scenes opened last
pub fn show(ui: &mut Ui, studio: &Studio, recent: &[PathBuf], commands: &mut Vec<Command>) {
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| {
            item(ui, "New", "Ctrl+N", commands, Command::Do(Action::New));
            item(ui, "Open...", "L", commands, Command::ChooseScene);
            recent_menu(ui, recent, commands);
            item(ui, "Read again", "Ctrl+R", commands, Command::Do(Action::Reload));
            ui.separator();
            item(ui, "Save", "Ctrl+S", commands, Command::Save);
            item(ui, "Save as...", "Ctrl+Shift+S", commands, Command::SaveAs);
            item(ui, "Write picture...", "Ctrl+E", commands, Command::Export);
            item(ui, "Write turntable...", "", commands, Command::Turntable);
            ui.separator();
            item(ui, "Recover edits...", "", commands, Command::Do(Action::Recover));
            item(ui, "Quit", "Ctrl+Q", commands, Command::Do(Action::Close));
        });
        ui.menu_button("Edit", |ui| edit_menu(ui, studio, commands));
        ui.menu_button("Camera", |ui| {
            item(ui, "Frame", "F", commands, Command::Do(Action::Frame));
            item(ui, "Back a step", "Alt+Left", commands, Command::Do(Action::StepCamera(true)));
            item(ui, "Forth a step", "Alt+Right", commands, Command::Do(Action::StepCamera(false)));
            item(ui, "Back to the scene's", "Home", commands, Command::Do(Action::ResetCamera));
            item(
                ui,
                "Write this view into the scene",
                "Ctrl+Shift+C",
                commands,
                Command::Do(Action::StoreCamera),
            );
        });
        ui.menu_button("Trace", |ui| {
            item(ui, "Trace", "Enter", commands, Command::Do(Action::Trace));
            item(ui, "Stop", "Esc", commands, Command::Do(Action::Stop));
            item(ui, "Keep the picture", "", commands, Command::Do(Action::KeepPicture));
            item(ui, "Debug ray at the pointer", "E", commands, Command::DebugRay);
        });
        ui.menu_button("Window", |ui| {
            item(ui, "Panels", "P", commands, Command::Panels);
            item(ui, "Time line", "T", commands, Command::TimeLine);
            let theme = if ui.visuals().dark_mode { "Light colours" } else { "Dark colours" };
            item(ui, theme, "", commands, Command::Theme);
            item(ui, "Keys and mouse", "F1", commands, Command::Help);
        });
        ui.separator();
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            trace_button(ui, studio, commands);
            ui.add_space(6.0);
            shown_switch(ui, studio, commands);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| middle(ui, studio, commands));
        });
    });
}

/// Undo, and what is done with the selection.
fn edit_menu(ui: &mut Ui, studio: &Studio, commands: &mut Vec<Command>) {
    let document = studio.document.as_ref();
    let undo = document.and_then(|document| document.undo_label()).map(|label| format!("Undo {label}"));
    let redo = document.and_then(|document| document.redo_label()).map(|label| format!("Redo {label}"));
    item(ui, undo.as_deref().unwrap_or("Undo"), "Ctrl+Z", commands, Command::Do(Action::Undo));
    item(ui, redo.as_deref().unwrap_or("Redo"), "Ctrl+Shift+Z", commands, Command::Do(Action::Redo));
    ui.separator();
    item(ui, "Cut", "Ctrl+X", commands, Command::Cut);
    item(ui, "Copy", "Ctrl+C", commands, Command::Copy);
    item(ui, "Paste", "Ctrl+V", commands, Command::AskForPaste);
    ui.separator();
    item(ui, "Duplicate", "Ctrl+D", commands, Command::Do(Action::Duplicate));
    item(ui, "Delete", "Del", commands, Command::Do(Action::Delete));
}

/// The name of the scene, and the buttons of the gizmos where there is room for them.
fn middle(ui: &mut Ui, studio: &Studio, commands: &mut Vec<Command>) {
    /// Widths that the buttons and a name take, in points.
    const BUTTONS: f32 = 190.0;
    const NAME: f32 = 90.0;
    let has_room = ui.available_width() > BUTTONS + NAME;
    let dirty = studio.document.as_ref().is_some_and(|document| document.is_dirty());
    let title = if dirty { format!("{} •", studio.title()) } else { studio.title() };
    let hint = if dirty { "Changed since it was saved" } else { "As it is on disk" };
    ui.scope(|ui| {
        let buttons = if has_room { BUTTONS } else { 0.0 };
        ui.set_max_width((ui.available_width() - buttons).max(0.0));
        ui.add(Label::new(RichText::new(title).strong()).truncate()).on_hover_text(hint);
    });
    if !has_room {
        return;
    }
    ui.separator();
    for ((name, mode), key) in GIZMOS.into_iter().zip(1..) {
        let hint = format!("Handles that {} what is selected ({key})", name.to_lowercase());
        if ui.selectable_label(studio.gizmo == Some(mode), name).on_hover_text(hint).clicked() {
            commands.push(Command::Do(Action::Gizmo(Some(mode))));
        }
    }
}

fn item(ui: &mut Ui, text: &str, keys: &str, commands: &mut Vec<Command>, command: Command) {
    let button = if keys.is_empty() { Button::new(text) } else { Button::new(text).shortcut_text(keys) };
    if ui.add(button).clicked() {
        commands.push(command);
    }
}

fn recent_menu(ui: &mut Ui, recent: &[PathBuf], commands: &mut Vec<Command>) {
    ui.add_enabled_ui(!recent.is_empty(), |ui| {
        ui.menu_button("Recent", |ui| {
            for path in recent {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                    commands.push(Command::Do(Action::Open(path.clone())));
                }
            }
        });
    });
}

fn trace_button(ui: &mut Ui, studio: &Studio, commands: &mut Vec<Command>) {
    if matches!(studio.tracer.status(), Status::Running { .. }) {
        if ui.button("Stop").on_hover_text("Esc").clicked() {
            commands.push(Command::Do(Action::Stop));
        }
        return;
    }
    let text = RichText::new("Trace").color(theme::on_accent(ui)).strong();
    let button = ui.add_enabled(studio.scene().is_some(), Button::new(text).fill(theme::accent(ui)));
    if button.on_hover_text("Trace from the current view (Enter)").clicked() {
        commands.push(Command::Do(Action::Trace));
    }
}

fn shown_switch(ui: &mut Ui, studio: &Studio, commands: &mut Vec<Command>) {
    let mut switch = |ui: &mut Ui, shown, text| {
        let chosen = studio.shown == shown;
        if ui.selectable_label(chosen, text).on_hover_text("Space switches").clicked() && !chosen {
            commands.push(Command::Do(Action::ToggleShown));
        }
    };
    // From right to left.
    switch(ui, Shown::Traced, "Traced");
    switch(ui, Shown::Preview, "Preview");
}
