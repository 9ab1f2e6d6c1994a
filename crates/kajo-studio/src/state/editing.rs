//! Actions that change the text of the scene, or choose what they are about.

use std::path::Path;

use kajo::output::Target;
use kajo::{BitDepth, Format, View};
use kajo_edit::{Document, Edit, Field, FieldValue, Keying, Kind, NodeId, template};
use kajo_math::DVec3;

use super::long_texts::Task;
use super::{Action, Cause, Selection, Studio, load_options};

/// What a new scene says.
const NEW_SCENE: &str = "\
PerspectiveCamera { center 0 2 9  direction 0 -0.15 -1  up 0 1 0  angle 30 }
Background { color 0.35 0.45 0.6  ambientLight 0.15 0.15 0.15 }
Lights {
  DirectionalLight { direction -1 -2 -1  color 0.9 0.9 0.9 }
}
Materials {
  Material floor { diffuseColor 0.6 0.6 0.6 }
  Material ball { diffuseColor 0.8 0.3 0.2 }
}
Group {
  MaterialIndex floor
  Plane { normal 0 1 0  offset 0 }
  MaterialIndex ball
  Sphere { center 0 1 0  radius 1 }
}
";

impl Studio {
    pub(super) fn edit_action(&mut self, action: Action) {
        match action {
            Action::Save => self.save(None),
            Action::SaveAs(ref path) => {
                // To save a scene to its own file replaces nothing.
                let is_own = self.document.as_ref().is_some_and(|document| is_same(document.path(), path));
                let files = if is_own { Vec::new() } else { vec![path.clone()] };
                self.write(action, &files);
            }
            Action::Export(ref path) => {
                let files = [path.clone()];
                self.write(action, &files);
            }
            Action::StoreCamera => self.store_camera(),
            Action::Select(nodes) => self.select(nodes),
            Action::SelectToo(node) => {
                if let Some(document) = &self.document {
                    self.selection.toggle(node, document);
                }
            }
            Action::SelectNext(forward) => self.select_next(forward),
            Action::SetField { node, key, nth, value } => {
                self.begin_drag(node, &key, nth);
                self.edit(&Edit::Set { node, key, nth: Some(nth), value });
            }
            Action::SetFields { node, key, values } => {
                self.begin_drag(node, &key, 0);
                self.edit(&Edit::SetList { node, key, values });
            }
            Action::UnsetField { node, key, nth } => {
                self.end_drag();
                self.edit(&Edit::Unset { node, key, nth: Some(nth) });
            }
            Action::Type { file, text } => self.type_text(file, text),
            Action::EndTyping => self.end_typing(),
            Action::Paste(text) => self.paste(&text),
            // Said in every frame without a button held down; it can wait for a drag that is not yet seen to its end.
            Action::EndDrag if self.typing.is_none() && !self.long_texts.is_busy() => self.end_drag(),
            Action::Add(keyword) => self.add(keyword),
            Action::Duplicate => self.edit_selected(Edit::Duplicate),
            Action::Delete => self.edit_selected(Edit::Delete),
            Action::Rename(node, name) => self.edit_and_say(&Edit::Rename { node, name }),
            Action::Paint(material) => self.edit_selected(|node| Edit::Paint { node, material }),
            Action::MoveInto(node, into) => self.edit_and_say(&Edit::MoveInto { node, into }),
            Action::Undo if self.undo_camera(true) => self.say("Undid: a step of the camera.", false),
            Action::Redo if self.undo_camera(false) => self.say("Did again: a step of the camera.", false),
            Action::Undo => self.step("Undid", Document::undo_label, Document::undo),
            Action::Redo => self.step("Did again", Document::redo_label, Document::redo),
            _ => {}
        }
    }

    pub(super) fn begin_new(&mut self) {
        let folder = std::env::current_dir().unwrap_or_default();
        match Document::untitled(&folder, NEW_SCENE, load_options()) {
            Ok(mut document) => {
                document.compile();
                self.begin(document);
                self.say("A new scene.", false);
            }
            Err(error) => self.say(&error.to_string(), true),
        }
    }

    fn select(&mut self, nodes: Vec<NodeId>) {
        self.end_drag();
        self.time_line.choose_none();
        if let Some(document) = &self.document {
            self.selection.set(nodes, document);
        }
    }

    /// Goes from the node chosen last to its neighbour in the text.
    fn select_next(&mut self, forward: bool) {
        let Some(document) = &self.document else { return };
        let nodes = document.outline().nodes();
        let at = self.selection.main().and_then(|id| nodes.iter().position(|node| node.id == id));
        let next = match at {
            Some(at) if forward => at + 1,
            Some(at) => at.wrapping_sub(1),
            None => 0,
        };
        if let Some(id) = nodes.get(next).map(|node| node.id) {
            self.select(vec![id]);
        }
    }

    /// Does one thing and says so when it cannot be done. Returns the block it made.
    pub(super) fn edit(&mut self, edit: &Edit) -> Option<NodeId> {
        self.steps.edited();
        self.pictures.shown = None;
        let is_dragging = self.dragged.is_some() || self.grip.is_some() || self.time_line.is_dragging();
        if is_dragging && self.has_long_text() {
            self.do_beside(Task::Apply(edit.clone()));
            return None;
        }
        self.settle();
        let document = self.document.as_mut()?;
        match document.apply(edit) {
            Ok(applied) => {
                self.compile();
                applied.created
            }
            Err(refused) => {
                self.say(&refused.to_string(), true);
                None
            }
        }
    }

    pub(super) fn edit_and_say(&mut self, edit: &Edit) {
        self.end_drag();
        self.notice = None;
        self.edit(edit);
        if self.notice.is_none() {
            self.say(&format!("Done: {}.", edit.label()), false);
        }
    }

    /// Does the same to each selected node; new blocks are selected in their stead.
    fn edit_selected(&mut self, edit: impl Fn(NodeId) -> Edit) {
        let nodes = self.selection.nodes().to_vec();
        if nodes.is_empty() {
            self.say("Select something first: click on it.", false);
            return;
        }
        self.end_drag();
        let mut created = Vec::new();
        for node in nodes {
            created.extend(self.edit(&edit(node)));
        }
        if let Some(document) = self.document.as_ref().filter(|_| !created.is_empty()) {
            self.selection.set(created, document);
        }
    }

    fn add(&mut self, keyword: &'static str) {
        let extent = f64::from(self.bounds().extent().length());
        let at = self.navigation.center.to_array();
        let Some(block) = template(keyword, at, 0.08 * extent) else {
            self.say(&format!("There is no pattern for `{keyword}`."), true);
            return;
        };
        self.end_drag();
        let into = self.group_of_selection();
        if let Some(created) = self.edit(&Edit::Add { into, block })
            && let Some(document) = &self.document
        {
            self.selection.set(vec![created], document);
            self.say(&format!("Added {keyword}."), false);
        }
    }

    /// The group that new objects go to: the selected one, if it holds objects.
    pub(super) fn group_of_selection(&self) -> Option<NodeId> {
        let node = self.selection.main()?;
        let kind = self.document.as_ref()?.node(node)?.kind;
        kind.holds_objects().then_some(node)
    }

    fn step(&mut self, what: &str, label: fn(&Document) -> Option<&str>, take: fn(&mut Document) -> bool) {
        self.end_drag();
        let Some(document) = &mut self.document else { return };
        let Some(text) = label(document).map(str::to_owned) else {
            self.say("There is nothing left to step over.", false);
            return;
        };
        take(document);
        self.compile();
        self.say(&format!("{what}: {text}."), false);
    }

    /// Begins a drag of a field, unless it is under way.
    pub(super) fn begin_drag(&mut self, node: NodeId, key: &str, nth: usize) {
        if self.dragged.as_ref().is_some_and(|dragged| dragged.is(node, key, nth)) {
            return;
        }
        self.end_drag();
        if let Some(document) = &mut self.document {
            let mut fields = document.fields(node).into_iter();
            let was_absent = fields.any(|field| field.is(key, nth) && field.span.is_none());
            let keying = document.keying(node, key, nth);
            let is_keyed = matches!(keying, Keying::Keyed { .. });
            document.begin_gesture(format!("set {}{key}", if is_keyed { "a key of " } else { "" }));
            let frame = document.timing().frame;
            self.dragged = Some(DraggedField { node, key: key.to_owned(), nth, was_absent });
            if let Keying::Keyed { at_frame } = keying {
                let what = if at_frame { "Changes the" } else { "Sets a new" };
                self.say(&format!("{what} key of {key} at frame {frame}."), false);
            }
        }
    }

    pub(super) fn end_drag(&mut self) {
        self.settle();
        self.dragged = None;
        self.let_go_of_handle();
        self.typing = None;
        self.time_line.chosen.let_go();
        if let Some(document) = &mut self.document {
            document.end_gesture();
        }
    }

    pub(super) fn save(&mut self, path: Option<&Path>) {
        self.end_drag();
        if path.is_none() && self.ask_about(Cause::Saving) {
            return;
        }
        let Some(document) = &mut self.document else { return };
        if path.is_none() && !document.is_dirty() && document.changed_on_disk() {
            // There is nothing to save, and something to read.
            self.take_changes();
            return;
        }
        let result = match path {
            Some(path) => document.save_as(path),
            None => document.save(),
        };
        match result {
            Ok(()) => {
                // A new folder may change what the scene's files mean.
                self.compile();
                self.watch_files();
                self.say(&format!("Saved {}.", self.title()), false);
                self.go_on();
            }
            Err(error) => self.say(&error.to_string(), true),
        }
    }

    pub(super) fn export(&mut self, path: &Path) {
        match self.exported(path) {
            Ok(()) => self.say(&format!("Wrote {}.", path.display()), false),
            Err(problem) => self.say(&problem, true),
        }
    }

    fn exported(&self, path: &Path) -> Result<(), String> {
        let frame = self.picture().ok_or("There is no picture yet: press Enter to trace one.")?;
        let ending = path.extension().and_then(|ending| ending.to_str()).and_then(Format::from_extension);
        let format = ending.ok_or("Give the file a name that ends in .png, .exr, .tga or the like.")?;
        let is_there = |view: &View| frame.value(*view, 0, 0).is_some();
        let views = if format == Format::Exr {
            View::ALL.into_iter().filter(is_there).collect()
        } else {
            vec![self.view]
        };
        let development = match self.settings() {
            Some(Ok(settings)) => settings.development,
            _ => frame.settings().development,
        };
        let bytes = frame.encode(&views, format, BitDepth::Eight, &development).map_err(|e| e.to_string())?;
        let target = Target::check(path, &[]).map_err(|e| e.to_string())?;
        target.write(&bytes).map_err(|e| e.to_string())
    }

    fn store_camera(&mut self) {
        let Some(document) = &self.document else { return };
        let Some(node) = document.root(Kind::Camera) else {
            self.say("The scene has no camera block to write to.", true);
            return;
        };
        let fields = camera_fields(&self.camera);
        let keyword = document.node(node).map(|node| node.keyword.to_string()).unwrap_or_default();
        if keyword != self.camera.keyword() {
            self.say(&format!("The scene's camera is a {keyword}."), true);
            return;
        }
        let set =
            |(key, numbers): (&'static str, Vec<f64>)| Edit::set(node, key, FieldValue::numbers(numbers));
        let edit = Edit::Together(fields.into_iter().map(set).collect());
        self.end_drag();
        self.edit(&edit);
        self.say("The scene's camera looks from here now.", false);
    }

    /// Takes over a document and looks at it with its own camera.
    pub(super) fn begin(&mut self, document: Document) {
        self.opened += 1;
        self.document = Some(document);
        self.selection = Selection::default();
        self.dragged = None;
        self.grip = None;
        self.typing = None;
        self.preview = None;
        self.clear_rays();
        self.sight.clear();
        self.tracer.clear();
        self.shown = super::Shown::Preview;
        self.time_line = self.time_line.cleared();
        self.after_compile();
        self.view_action(Action::ResetCamera);
        self.steps.clear();
        self.watch_files();
    }
}

/// Whether two names are of one file.
fn is_same(own: Option<&Path>, other: &Path) -> bool {
    let real = |path: &Path| std::fs::canonicalize(path).ok();
    own.is_some_and(|own| own == other || real(own).is_some_and(|own| Some(own) == real(other)))
}

/// A field that is being dragged.
pub(super) struct DraggedField {
    node: NodeId,
    key: String,
    nth: usize,
    /// Whether it was absent before.
    was_absent: bool,
}

impl DraggedField {
    fn is(&self, node: NodeId, key: &str, nth: usize) -> bool {
        (self.node, self.key.as_str(), self.nth) == (node, key, nth)
    }
}

impl Studio {
    /// Whether a field counts as one that is set. One that a drag is just about to set does not: it stays where it is
    /// under the pointer.
    pub fn is_set(&self, node: NodeId, field: &Field) -> bool {
        let is_new = self.dragged.as_ref().is_some_and(|d| d.was_absent && d.is(node, &field.key, field.nth));
        field.required || field.span.is_some() && !is_new
    }
}

/// The fields of a camera's block that a flight changes, rounded to what one can see.
fn camera_fields(camera: &kajo::CameraPose) -> Vec<(&'static str, Vec<f64>)> {
    let vector = |v: DVec3| v.to_array().map(rounded).to_vec();
    let mut fields = vec![
        ("center", vector(camera.eye())),
        ("direction", vector(camera.forward())),
        ("up", vector(camera.up())),
    ];
    fields.extend(camera.angle().map(|angle| ("angle", vec![rounded(angle.to_degrees())])));
    fields.extend(camera.size().map(|size| ("size", vec![rounded(size)])));
    fields
}

/// To six digits behind the point.
fn rounded(v: f64) -> f64 {
    (v * 1e6).round() / 1e6
}
