//! Asks for a file.
//!
//! The list is drawn by the window itself: it is there on every system, over a network and without a desktop, and
//! works by keyboard alone.

use std::fs;
use std::path::{Path, PathBuf};

use egui::{Context, Key, Modal, RichText, ScrollArea, TextEdit, Ui};

use super::theme;

/// What the file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A scene to be opened.
    OpenScene,
    /// Where the scene is to be saved.
    SaveScene,
    /// Where the picture is to be written.
    Export,
    /// Where pictures from all around are to be written.
    Turntable,
}

impl Purpose {
    fn title(self) -> &'static str {
        match self {
            Purpose::OpenScene => "Open a scene",
            Purpose::SaveScene => "Save the scene as",
            Purpose::Export => "Write the picture as",
            Purpose::Turntable => "Write pictures from all around as",
        }
    }

    fn button(self) -> &'static str {
        match self {
            Purpose::OpenScene => "Open",
            Purpose::SaveScene => "Save",
            Purpose::Export | Purpose::Turntable => "Write",
        }
    }

    /// Endings of the files that are listed; all, where there are none.
    fn endings(self) -> &'static [&'static str] {
        match self {
            Purpose::OpenScene => &["txt", "kajo", "glb", "gltf", "obj", "ply", "stl"],
            Purpose::SaveScene => &["txt", "kajo"],
            Purpose::Export | Purpose::Turntable => &["png", "exr", "tga", "bmp", "ppm", "pfm", "hdr", "jpg"],
        }
    }

    /// Whether the file must be there already.
    fn must_exist(self) -> bool {
        matches!(self, Purpose::OpenScene)
    }
}

/// What became of the question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ChooserAnswer {
    /// Still open.
    None,
    /// Closed without a file.
    Cancelled,
    /// This file.
    Chosen(PathBuf),
}

/// A question for a file.
pub struct Chooser {
    /// What it is for.
    pub purpose: Purpose,
    folder: PathBuf,
    /// What is typed: a name in the folder, or a path.
    typed: String,
    entries: Vec<Entry>,
    problem: Option<String>,
    is_new: bool,
}

struct Entry {
    name: String,
    is_folder: bool,
}

impl Chooser {
    /// Begins in the folder of `near`, or in the current one.
    ///
    /// * `name`: what is typed at first
    pub fn new(purpose: Purpose, near: Option<&Path>, name: &str) -> Chooser {
        let folder = near.map(|path| if path.is_dir() { path } else { path.parent().unwrap_or(path) });
        let folder = folder.filter(|folder| folder.is_dir()).map(Path::to_owned);
        let folder = folder.or_else(|| std::env::current_dir().ok()).unwrap_or_default();
        let mut chooser = Chooser {
            purpose,
            folder,
            typed: name.to_owned(),
            entries: Vec::new(),
            problem: None,
            is_new: true,
        };
        chooser.list();
        chooser
    }

    /// Shows the question; to be called in every frame until there is an answer.
    pub fn show(&mut self, ctx: &Context) -> ChooserAnswer {
        let mut answer = ChooserAnswer::None;
        let modal = Modal::new(egui::Id::unique("chooser")).show(ctx, |ui| {
            let room = ui.ctx().content_rect().size();
            ui.set_width((room.x - 60.0).clamp(200.0, 520.0));
            let height = (room.y - 210.0).clamp(60.0, 300.0);
            ui.heading(self.purpose.title());
            ui.add_space(4.0);
            self.folder_row(ui);
            if let Some(path) = self.list_rows(ui, height) {
                answer = self.enter(&path);
            }
            let entered = self.name_row(ui);
            ui.add_space(4.0);
            ui.horizontal(|ui| {
                let button =
                    egui::Button::new(RichText::new(self.purpose.button()).color(theme::on_accent(ui)));
                let chosen = ui.add(button.fill(theme::accent(ui))).clicked();
                if chosen || entered {
                    answer = self.enter(&self.folder.join(self.typed.trim()));
                }
                if ui.button("Cancel").clicked() {
                    answer = ChooserAnswer::Cancelled;
                }
                if let Some(problem) = &self.problem {
                    ui.label(RichText::new(problem).color(theme::error(ui)));
                }
            });
        });
        if modal.should_close() { ChooserAnswer::Cancelled } else { answer }
    }

    fn folder_row(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let up = ui.add_enabled(self.folder.parent().is_some(), egui::Button::new("Up"));
            if up.on_hover_text("The folder above").clicked()
                && let Some(parent) = self.folder.parent().map(Path::to_owned)
            {
                self.go(parent);
            }
            let folder = RichText::new(self.folder.display().to_string()).color(theme::quiet(ui));
            ui.add(egui::Label::new(folder).truncate());
        });
    }

    /// The files and folders; the path of the one that was double-clicked.
    fn list_rows(&mut self, ui: &mut Ui, height: f32) -> Option<PathBuf> {
        let mut entered = None;
        let mut typed = None;
        egui::Frame::new().fill(ui.visuals().extreme_bg_color).corner_radius(4.0).inner_margin(4.0).show(
            ui,
            |ui| {
                ScrollArea::vertical().max_height(height).auto_shrink(false).show(ui, |ui| {
                    ui.set_min_height(height);
                    for entry in &self.entries {
                        let chosen = self.typed == entry.name;
                        let row = ui.selectable_label(
                            chosen,
                            if entry.is_folder { format!("{}/", entry.name) } else { entry.name.clone() },
                        );
                        if row.clicked() {
                            typed = Some(entry.name.clone());
                        }
                        if row.double_clicked() {
                            entered = Some(self.folder.join(&entry.name));
                        }
                    }
                });
            },
        );
        if let Some(typed) = typed {
            self.typed = typed;
        }
        entered
    }

    /// The name; whether it was entered.
    fn name_row(&mut self, ui: &mut Ui) -> bool {
        let edit =
            TextEdit::singleline(&mut self.typed).hint_text("Name or path").desired_width(f32::INFINITY);
        let response = ui.add(edit).on_hover_text("A name in this folder, or a whole path");
        let response = response.accessible_name("File name");
        if std::mem::take(&mut self.is_new) {
            response.request_focus();
        }
        response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
    }

    /// Goes into a folder, or takes a file.
    fn enter(&mut self, path: &Path) -> ChooserAnswer {
        if path.is_dir() {
            self.go(path.to_owned());
            return ChooserAnswer::None;
        }
        if self.purpose.must_exist() && !path.is_file() {
            self.problem = Some("There is no such file.".to_owned());
            self.is_new = true;
            return ChooserAnswer::None;
        }
        if path.file_name().is_none() {
            return ChooserAnswer::None;
        }
        ChooserAnswer::Chosen(path.to_owned())
    }

    fn go(&mut self, folder: PathBuf) {
        self.folder = fs::canonicalize(&folder).unwrap_or(folder);
        self.typed.clear();
        self.is_new = true;
        self.list();
    }

    fn list(&mut self) {
        self.entries.clear();
        self.problem = None;
        let entries = match fs::read_dir(&self.folder) {
            Ok(entries) => entries,
            Err(error) => {
                self.problem = Some(error.to_string());
                return;
            }
        };
        for entry in entries.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let is_folder = entry.path().is_dir();
            if !name.starts_with('.') && (is_folder || self.is_listed(&name)) {
                self.entries.push(Entry { name, is_folder });
            }
        }
        self.entries.sort_by_key(|entry| (!entry.is_folder, entry.name.to_lowercase()));
    }

    fn is_listed(&self, name: &str) -> bool {
        let ending = Path::new(name).extension().map(|ending| ending.to_string_lossy().to_lowercase());
        let endings = self.purpose.endings();
        endings.is_empty() || ending.is_some_and(|ending| endings.contains(&ending.as_str()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_come_first_and_other_files_are_left_out() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.txt", "a.TXT", "c.png", ".hidden.txt"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        fs::create_dir(folder.path().join("zoo")).unwrap();
        let mut chooser = Chooser::new(Purpose::OpenScene, Some(&folder.path().join("b.txt")), "");
        let names: Vec<&str> = chooser.entries.iter().map(|entry| entry.name.as_str()).collect();
        assert_eq!(names, ["zoo", "a.TXT", "b.txt"]);
        assert_eq!(chooser.enter(&folder.path().join("zoo")), ChooserAnswer::None);
        assert!(chooser.folder.ends_with("zoo") && chooser.entries.is_empty());
        assert_eq!(chooser.enter(&folder.path().join("nothing.txt")), ChooserAnswer::None);
        assert!(chooser.problem.is_some());
        let file = folder.path().join("b.txt");
        assert_eq!(chooser.enter(&file), ChooserAnswer::Chosen(file.clone()));
    }
}
