//! The document: texts, their tree, the scene they make, and the steps between.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use kajo_core::compile::MeshStore;
use kajo_math::DAffine3;
use kajo_scene::{HEAD_BYTES, foreign_file};

use super::compiled::Compiled;
use super::history::{History, Step};
use super::outline::{Identities, missing_from, not_carried};
use super::texts::Change;
use super::tree::{Before, Tree};
use super::{Applied, Edit, EditRefused, Field, FieldValue, FileId, Node, NodeId, Outline, SceneFile};
use kajo::output::{OutputError, Target};
use kajo::{FsAssets, LoadOptions};
use kajo_core::schema::Kind;

/// Why a document could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum DocumentError {
    /// The scene's own file.
    #[error("cannot read `{}`: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A file that was to be saved.
    #[error(transparent)]
    Write(#[from] OutputError),
    /// A document without a name cannot be saved.
    #[error("the scene has no file name yet")]
    Untitled,
}

/// A scene that is being edited.
///
/// A clone shares all that is large, until one of the two is changed. So another thread can edit a copy of a long text, and
/// that take the place of the original; see [`Document::keep_scene_of`].
#[derive(Clone, Debug)]
pub struct Document {
    pub(super) path: Option<PathBuf>,
    pub(super) options: LoadOptions,
    pub(super) disk: Arc<FsAssets>,
    pub(super) files: Vec<SceneFile>,
    pub(super) stamps: HashMap<FileId, Stamp>,
    pub(super) tree: Arc<Tree>,
    pub(super) identities: Identities,
    history: History,
    gesture: Option<Gesture>,
    pub(super) generation: u64,
    /// How often another frame was shown.
    pub(super) frames_shown: u64,
    pub(super) compiled: Compiled,
    /// Meshes need not be read again for every edit.
    pub(super) meshes: Arc<MeshStore>,
}

/// What tells one state of a file on disk from another.
type Stamp = (SystemTime, u64);

/// Edits that will be one step: each starts from the same text.
#[derive(Clone, Debug)]
struct Gesture {
    label: String,
    /// Texts and tree before the first edit; `None` until there is one.
    base: Option<(Vec<SceneFile>, Arc<Tree>)>,
    change: Change,
}

impl Document {
    /// Opens a scene; of a model, the scene that shows it, which has no file yet. Mistakes in it are no errors here; see
    /// [`Document::diagnostics`].
    ///
    /// # Errors
    /// When the file cannot be read or is no text.
    pub fn open(path: &Path, options: LoadOptions) -> Result<Document, DocumentError> {
        if let Some(text) = kajo::model_text(path, &options) {
            let folder = path.parent().unwrap_or(Path::new(""));
            let options = LoadOptions { model_cameras_first: true, ..options };
            return Document::untitled(folder, &text, options);
        }
        let text = read_text(path)?;
        let saved = Some(text.clone());
        let mut document = Document::start(path, options, text, saved)?;
        document.path = Some(path.to_path_buf());
        document.stamp();
        Ok(document)
    }

    /// A scene that has no file yet. What it names is looked for in `folder`.
    ///
    /// # Errors
    /// When the folder cannot be entered.
    pub fn untitled(folder: &Path, text: &str, options: LoadOptions) -> Result<Document, DocumentError> {
        Document::start(&folder.join("untitled.txt"), options, text.into(), None)
    }

    pub(super) fn start(
        path: &Path,
        options: LoadOptions,
        text: Arc<str>,
        saved: Option<Arc<str>>,
    ) -> Result<Document, DocumentError> {
        let error = |reason| DocumentError::Read { path: path.to_path_buf(), reason };
        let disk = Arc::new(options.assets(path).map_err(error)?);
        let mut document = Document {
            path: None,
            options,
            files: vec![SceneFile { name: disk.scene_name().to_owned(), text, saved }],
            disk,
            stamps: HashMap::new(),
            tree: Arc::default(),
            identities: Identities::default(),
            history: History::default(),
            gesture: None,
            generation: 0,
            frames_shown: 0,
            compiled: Compiled::default(),
            meshes: Arc::default(),
        };
        let tree = document.parsed(&Tree::default(), &Change::default(), &[]);
        document.tree = Arc::new(tree);
        Ok(document)
    }

    /// The scene's file, if it has one.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// The scene's text.
    pub fn text(&self) -> &str {
        &self.files[0].text
    }

    /// The scene's text and those that it includes, the scene first.
    pub fn files(&self) -> impl Iterator<Item = (FileId, &SceneFile)> {
        (0..).map(FileId).zip(&self.files)
    }

    /// The blocks of the texts.
    pub fn outline(&self) -> &Outline {
        &self.tree.outline
    }

    /// The node with this identity, if it is still there.
    pub fn node(&self, id: NodeId) -> Option<&Node> {
        self.tree.outline.get(id)
    }

    /// The fields of a node: those that its kind may have, and whatever else is written there. None for a node that
    /// is gone.
    pub fn fields(&self, id: NodeId) -> Vec<Field> {
        self.node(id).map_or_else(Vec::new, |node| self.tree.fields(node, self.scene().map(Arc::as_ref)))
    }

    /// The value of a field that holds: the one written, or the default.
    pub fn value(&self, id: NodeId, key: &str) -> Option<FieldValue> {
        self.tree.value(self.node(id)?, key, self.scene().map(Arc::as_ref))
    }

    /// The map to the world from the space that a node's own numbers are in: what the transforms it stands in do.
    ///
    /// Something in a definition is taken to be where the first instance of that puts it. Things that move are where
    /// they are at time 0.
    pub fn placement(&self, id: NodeId) -> DAffine3 {
        self.node(id).map_or(DAffine3::IDENTITY, |node| self.tree.placement(node))
    }

    /// What the operations of a transform or an instance do; the identity for other nodes.
    pub fn own_map(&self, id: NodeId) -> DAffine3 {
        self.node(id).map_or(DAffine3::IDENTITY, |node| self.tree.own_map(node))
    }

    /// The material that an object is painted with, and the block of it, if both can be found.
    pub fn material_of(&self, id: NodeId) -> Option<NodeId> {
        self.tree.material_of(self.node(id)?).map(|node| node.id)
    }

    /// The block of the material with this number in the id layers, from 1.
    pub fn node_of_material(&self, number: u32) -> Option<NodeId> {
        let index = number.checked_sub(1)? as usize;
        self.tree.materials().nth(index).map(|node| node.id)
    }

    /// Grows with each change of the texts, and of the frame on show.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Whether any text differs from what is on disk.
    pub fn is_dirty(&self) -> bool {
        self.files.iter().any(SceneFile::is_dirty)
    }

    /// Whether there is anything that could be undone.
    pub(super) fn is_edited(&self) -> bool {
        let is_dragged = self.gesture.as_ref().is_some_and(|gesture| !gesture.change.is_empty());
        is_dragged || self.undo_label().is_some()
    }

    #[cfg(test)]
    fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The tree that the edits of the gesture under way start from; without one, the tree of the texts.
    pub(super) fn base_tree(&self) -> &Tree {
        let base = self.gesture.as_ref().and_then(|gesture| gesture.base.as_ref());
        base.map_or(&self.tree, |(_, tree)| tree)
    }
}

/// Edits and steps.
impl Document {
    /// Does one thing.
    ///
    /// In a gesture it takes the place of what the gesture did before: it starts from the text at the gesture's
    /// beginning.
    ///
    /// # Errors
    /// When it cannot be done; then nothing has changed.
    pub fn apply(&mut self, edit: &Edit) -> Result<Applied, EditRefused> {
        let edits = edit.plan(self.base_tree())?;
        let base = self.gesture.as_ref().and_then(|gesture| gesture.base.as_ref());
        let files = base.map_or(&self.files, |(files, _)| files);
        let change = Change::of(files, edits)?;
        let mut texts = files.clone();
        change.apply(&mut texts)?;
        let is_moved = matches!(edit, Edit::MoveInto { .. });
        if is_moved && self.base_tree().leaves_names_behind(&self.disk, &self.options, &texts) {
            return Err(EditRefused::new("values in it go by names that are known only where it stands"));
        }
        let changed = !change.is_empty();
        if texts.iter().zip(&self.files).all(|(new, now)| new.text == now.text) {
            // As in a drag that stands still.
            let created =
                missing_from(&self.tree.outline, &self.base_tree().outline).next().map(|node| node.id);
            return Ok(Applied { changed, created });
        }

        let gesture = self.gesture.take();
        let in_gesture = gesture.is_some();
        let (label, base) = match gesture {
            Some(gesture) => (gesture.label, gesture.base),
            None => (edit.label(), None),
        };
        let (files, tree) =
            base.unwrap_or_else(|| (std::mem::take(&mut self.files), std::mem::take(&mut self.tree)));
        self.files = texts;
        let mut new = self.parsed(&tree, &change, &[]);
        if let Some(moved) = edit.moves().filter(|_| changed) {
            new.outline.keep_identities(&tree.outline, moved);
        }
        let created = missing_from(&new.outline, &tree.outline).next().map(|node| node.id);
        if in_gesture {
            self.gesture = Some(Gesture { label, base: Some((files, tree)), change });
        } else if changed {
            self.history.push(step(label, change, &tree, &new));
        }
        self.tree = Arc::new(new);
        self.generation += 1;
        Ok(Applied { changed, created })
    }

    /// Begins a gesture, such as a drag: the edits up to its end become one step, and each starts from the text as it
    /// is now. A gesture under way ends.
    pub fn begin_gesture(&mut self, label: impl Into<String>) {
        self.end_gesture();
        self.gesture = Some(Gesture { label: label.into(), base: None, change: Change::default() });
    }

    /// Whether a gesture is under way.
    pub fn in_gesture(&self) -> bool {
        self.gesture.is_some()
    }

    /// Ends the gesture and keeps what it did as one step.
    pub fn end_gesture(&mut self) {
        let Some(Gesture { label, base: Some((_, tree)), change }) = self.gesture.take() else { return };
        if !change.is_empty() {
            self.history.push(step(label, change, &tree, &self.tree));
        }
    }

    /// Ends the gesture and takes back what it did.
    pub fn cancel_gesture(&mut self) {
        if let Some(Gesture { base: Some((files, tree)), .. }) = self.gesture.take() {
            self.files = files;
            self.tree = tree;
            self.generation += 1;
        }
    }

    /// Takes the latest step back. `false` when there is none.
    pub fn undo(&mut self) -> bool {
        self.end_gesture();
        let step = self.history.back();
        self.take(step)
    }

    /// Does the latest step that was taken back once more. `false` when there is none.
    pub fn redo(&mut self) -> bool {
        self.end_gesture();
        let step = self.history.forth();
        self.take(step)
    }

    /// What [`Document::undo`] would take back.
    pub fn undo_label(&self) -> Option<&str> {
        self.history.undo_label()
    }

    /// What [`Document::redo`] would do.
    pub fn redo_label(&self) -> Option<&str> {
        self.history.redo_label()
    }

    fn take(&mut self, step: Option<Step>) -> bool {
        let Some(step) = step else { return false };
        if step.change.apply(&mut self.files).is_err() {
            // The texts are not those that the steps were made for: none of them can be trusted.
            debug_assert!(false, "history does not fit the text");
            self.history.clear();
            return false;
        }
        let tree = std::mem::take(&mut self.tree);
        self.tree = Arc::new(self.parsed(&tree, &step.change, &step.gained));
        self.generation += 1;
        true
    }

    fn parsed(&mut self, old: &Tree, change: &Change, remembered: &[(FileId, usize, NodeId)]) -> Tree {
        let before = Before { outline: &old.outline, change, remembered };
        Tree::parse(&self.disk, &self.options, None, &mut self.files, before, &mut self.identities)
    }
}

/// What leads from one tree to the next.
fn step(label: String, change: Change, old: &Tree, new: &Tree) -> Step {
    let lost = not_carried(&old.outline, &change, &new.outline);
    let gained = not_carried(&new.outline, &change.inverse(), &old.outline);
    Step { label, change, lost, gained }
}

/// The scene and its materials.
impl Document {
    /// Numbers of the objects that a material's block is the material of, as [`Document::scene`] has them.
    pub fn objects_painted(&self, id: NodeId) -> Vec<u32> {
        let Some(scene) = self.scene() else { return Vec::new() };
        let Some(index) = self.tree.materials().position(|node| node.id == id) else { return Vec::new() };
        let numbers = (1..).zip(&scene.geometry.primitives);
        numbers
            .filter(|(_, p)| scene.appearance.number(p.material) == index as u32 + 1)
            .map(|(number, _)| number)
            .collect()
    }

    /// The last block of a kind that stands in no other: the one that counts.
    pub fn root(&self, kind: Kind) -> Option<NodeId> {
        self.tree.root(kind).map(|node| node.id)
    }
}

/// Files on disk.
impl Document {
    /// Writes every text that has changed, each whole or not at all.
    ///
    /// # Errors
    /// When there is no file name yet, or a file cannot be written.
    pub fn save(&mut self) -> Result<(), DocumentError> {
        if self.path.is_none() {
            return Err(DocumentError::Untitled);
        }
        self.end_gesture();
        for index in 0..self.files.len() {
            let id = FileId(index as u32);
            let Some(path) = self.real_path(id) else { return Err(DocumentError::Untitled) };
            // What somebody took away is written again.
            if !self.files[index].is_dirty() && path.exists() {
                continue;
            }
            Target::check(&path, &[])?.write(self.files[index].text.as_bytes())?;
            self.files[index].saved = Some(self.files[index].text.clone());
        }
        self.stamp();
        Ok(())
    }

    /// Writes the scene to another file, which is its file from now on. Files that it includes stay where they are,
    /// and are looked for beside the new one.
    ///
    /// # Errors
    /// When a file cannot be written; the document stays what it was.
    pub fn save_as(&mut self, path: &Path) -> Result<(), DocumentError> {
        self.end_gesture();
        Target::check(path, &[])?.write(self.files[0].text.as_bytes())?;
        let error = |reason| DocumentError::Read { path: path.to_path_buf(), reason };
        let disk = Arc::new(self.options.assets(path).map_err(error)?);
        for index in 1..self.files.len() {
            if let Some(path) = self.real_path(FileId(index as u32)).filter(|_| self.files[index].is_dirty())
            {
                Target::check(&path, &[])?.write(self.files[index].text.as_bytes())?;
            }
        }
        self.path = Some(path.to_path_buf());
        self.disk = disk;
        let text = self.files[0].text.clone();
        self.files = vec![SceneFile {
            name: self.disk.scene_name().to_owned(),
            text: text.clone(),
            saved: Some(text),
        }];
        // The history speaks of files by number: only steps of the scene's own text still mean something.
        self.history.retain_file(FileId(0));
        let tree = std::mem::take(&mut self.tree);
        self.tree = Arc::new(self.parsed(&tree, &Change::default(), &[]));
        self.generation += 1;
        self.stamp();
        Ok(())
    }

    /// Whether another program has changed one of the texts since they were read or saved.
    pub fn changed_on_disk(&self) -> bool {
        (0..self.files.len()).any(|index| {
            let id = FileId(index as u32);
            let Some(path) = self.real_path(id) else { return false };
            let stamp = stamp(&path);
            let known = self.stamps.get(&id).copied();
            // The same bytes, written once more, are no change.
            stamp.is_some() && stamp != known && read_text(&path).ok() != self.files[index].saved
        })
    }

    /// Takes over what is on disk, as one step that can be undone.
    ///
    /// # Errors
    /// When the scene's file cannot be read; then nothing has changed.
    pub fn reload(&mut self) -> Result<Applied, DocumentError> {
        self.take_from_disk(|_, _| true)
    }

    /// Takes over what other programs have written, as one step that can be undone. Files that they left alone keep
    /// the edits that were made in them here; where both have changed a file, theirs wins.
    ///
    /// # Errors
    /// As [`Document::reload`].
    pub fn take_theirs(&mut self) -> Result<Applied, DocumentError> {
        self.take_from_disk(|file, on_disk| file.saved.as_deref() != Some(on_disk))
    }

    /// Takes over the texts on disk of files that are `wanted`.
    fn take_from_disk(
        &mut self,
        wanted: impl Fn(&SceneFile, &str) -> bool,
    ) -> Result<Applied, DocumentError> {
        self.end_gesture();
        let mut texts = Vec::new();
        for index in 0..self.files.len() {
            let id = FileId(index as u32);
            let Some(path) = self.real_path(id) else { continue };
            match read_text(&path) {
                Ok(text) if wanted(&self.files[index], &text) => texts.push((id, text)),
                Err(error) if index == 0 => return Err(error),
                _ => {}
            }
        }
        for (id, text) in &texts {
            self.files[id.0 as usize].saved = Some(text.clone());
        }
        let applied = self.replace("reload", &texts);
        self.stamp();
        Ok(applied)
    }

    /// Makes these the texts of files, as one step. Blocks whose keywords stay remain what they are.
    pub(super) fn replace(&mut self, label: &str, texts: &[(FileId, Arc<str>)]) -> Applied {
        let changes = texts.iter().flat_map(|(id, text)| {
            Change::by_words(*id, &self.files[id.0 as usize].text, text).edits().collect::<Vec<_>>()
        });
        let change = Change::of(&self.files, changes.collect()).unwrap_or_default();
        let tree = std::mem::take(&mut self.tree);
        // Made of these very texts a moment ago, it fits them.
        let fits = change.apply(&mut self.files).is_ok();
        debug_assert!(fits);
        let new = self.parsed(&tree, &change, &[]);
        let changed = !change.is_empty();
        if changed {
            self.history.push(step(label.to_owned(), change, &tree, &new));
        }
        self.tree = Arc::new(new);
        // Meshes and pictures may have changed too.
        self.generation += 1;
        Applied { changed, created: None }
    }

    pub(super) fn real_path(&self, id: FileId) -> Option<PathBuf> {
        if id == FileId(0) { self.path.clone() } else { self.disk.real_path(&self.files[id.0 as usize].name) }
    }

    fn stamp(&mut self) {
        let paths = (0..self.files.len() as u32).map(FileId).filter_map(|id| Some((id, self.real_path(id)?)));
        let stamps: Vec<_> = paths.filter_map(|(id, path)| Some((id, stamp(&path)?))).collect();
        self.stamps = stamps.into_iter().collect();
    }
}

pub(super) fn stamp(path: &Path) -> Option<Stamp> {
    let metadata = fs::metadata(path).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}

pub(super) fn read_text(path: &Path) -> Result<Arc<str>, DocumentError> {
    let error = |reason: String| DocumentError::Read { path: path.to_path_buf(), reason };
    let bytes = fs::read(path).map_err(|e| error(e.to_string()))?;
    if let Some(foreign) = foreign_file(&bytes[..bytes.len().min(HEAD_BYTES)], &path.to_string_lossy()) {
        return Err(error(format!("it is {}, which kajo does not read; {}", foreign.what, foreign.advice)));
    }
    let text = String::from_utf8(bytes).map_err(|_| error("it is not text in UTF-8".to_owned()))?;
    Ok(text.into())
}

#[cfg(test)]
mod tests;
