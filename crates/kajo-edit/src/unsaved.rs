//! What is not on disk yet: edits to be kept through a crash, and files that two programs have changed.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::document::{read_text, stamp};
use super::{Document, DocumentError, FileId, SceneFile};
use kajo::LoadOptions;

/// All that it takes to open a document with its unsaved edits again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unsaved {
    /// The scene's file, if it has one.
    pub path: Option<PathBuf>,
    /// The texts that differ from what was on disk.
    pub texts: Vec<UnsavedText>,
}

/// A text that differs from what is on disk.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnsavedText {
    /// The name of its file among those of the document; none for the scene's own.
    pub name: Option<String>,
    /// What was on disk when it was read or saved last.
    pub saved: Option<Arc<str>>,
    /// What it says.
    pub text: Arc<str>,
}

/// A file that has been edited here and changed by another program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Conflict {
    /// The file.
    pub file: FileId,
    /// Its name among those of the document.
    pub name: String,
    /// Its text as it was edited here.
    pub mine: Arc<str>,
    /// What the other program has written.
    pub theirs: Arc<str>,
}

impl Document {
    /// Whether there are edits that would be lost if the document were closed now. A scene that was never saved has
    /// some once anything was done to it.
    pub fn has_unsaved_edits(&self) -> bool {
        match self.path {
            Some(_) => self.is_dirty(),
            None => self.is_edited(),
        }
    }

    /// What is to be kept so that the edits survive whatever happens to the program; `None` when all is on disk.
    pub fn unsaved(&self) -> Option<Unsaved> {
        if !self.has_unsaved_edits() {
            return None;
        }
        let texts = self.files().filter(|(_, file)| file.is_dirty()).map(|(id, file)| UnsavedText {
            name: (id != FileId(0)).then(|| file.name.clone()),
            saved: file.saved.clone(),
            text: file.text.clone(),
        });
        Some(Unsaved { path: self.path.clone(), texts: texts.collect() })
    }

    /// Opens a document with edits that were not saved, as steps that can be undone.
    ///
    /// * `folder`: where a scene without a file looks for what it names
    ///
    /// # Errors
    /// When its folder cannot be entered. A scene whose file is gone is there nevertheless.
    pub fn restore(
        unsaved: &Unsaved,
        folder: &Path,
        options: LoadOptions,
    ) -> Result<Document, DocumentError> {
        let own = unsaved.texts.iter().find(|text| text.name.is_none());
        let own_text = |text: &UnsavedText| text.text.clone();
        let mut document = match &unsaved.path {
            None => Document::untitled(folder, "", options)?,
            Some(path) => match Document::open(path, options.clone()) {
                Ok(document) => document,
                Err(error) => {
                    let Some(text) = own.map(own_text) else { return Err(error) };
                    let mut document = Document::start(path, options, text, None)?;
                    document.path = Some(path.clone());
                    document
                }
            },
        };
        // The scene's own text first: it says which files there are.
        document.replace(
            "recover edits",
            &own.map(|text| (FileId(0), own_text(text))).into_iter().collect::<Vec<_>>(),
        );
        let others = unsaved.texts.iter().filter_map(|text| {
            let name = text.name.as_ref()?;
            let (id, _) = document.files().find(|(id, file)| *id != FileId(0) && file.name == *name)?;
            Some((id, text))
        });
        let others: Vec<_> = others.collect();
        if !others.is_empty() {
            let texts: Vec<_> = others.iter().map(|(id, text)| (*id, text.text.clone())).collect();
            document.replace("recover edits", &texts);
        }
        // What has been written to a file since then is another program's, and to be asked about.
        for (id, text) in own.map(|text| (FileId(0), text)).into_iter().chain(others) {
            let file = &mut document.files[id.0 as usize];
            if text.saved.is_some() && file.saved.is_some() && file.saved != text.saved {
                file.saved.clone_from(&text.saved);
                document.stamps.remove(&id);
            }
        }
        Ok(document)
    }

    /// Files that have edits here which are not on disk, and what is there instead.
    pub fn differences(&self) -> Vec<Conflict> {
        let difference = |(file, scene_file): (FileId, &SceneFile)| {
            let theirs = read_text(&self.real_path(file)?).ok()?;
            let (name, mine) = (scene_file.name.clone(), scene_file.text.clone());
            (mine != theirs).then_some(Conflict { file, name, mine, theirs })
        };
        self.files().filter(|(_, file)| file.is_dirty()).filter_map(difference).collect()
    }

    /// Files that have edits here, and that another program has written since they were read or saved.
    pub fn conflicts(&self) -> Vec<Conflict> {
        let is_written = |conflict: &Conflict| {
            self.files[conflict.file.0 as usize].saved.as_ref() != Some(&conflict.theirs)
        };
        self.differences().into_iter().filter(is_written).collect()
    }

    /// Keeps the edits made here to files that another program has changed: saving replaces what that has written.
    pub fn keep_mine(&mut self, conflicts: &[Conflict]) {
        for conflict in conflicts {
            let stamp = self.real_path(conflict.file).and_then(|path| stamp(&path));
            if let Some(file) = self.files.get_mut(conflict.file.0 as usize) {
                file.saved = Some(conflict.theirs.clone());
                self.stamps.extend(stamp.map(|stamp| (conflict.file, stamp)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::{Edit, FieldValue, NodeId};

    const SCENE: &str = "Group {\n  Sphere ball { radius 1 }\n  include \"more.txt\"\n}\n";
    const MORE: &str = "Box { min 0 0 0 }\nCone { radius 2 }\n";

    fn folder() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.txt");
        fs::write(&path, SCENE).unwrap();
        fs::write(folder.path().join("more.txt"), MORE).unwrap();
        (folder, path)
    }

    fn open(path: &Path) -> Document {
        Document::open(path, LoadOptions::default()).unwrap()
    }

    fn find(document: &Document, keyword: &str) -> NodeId {
        document.outline().nodes().iter().find(|node| &*node.keyword == keyword).unwrap().id
    }

    fn set_radius(document: &mut Document, keyword: &str, radius: f64) {
        let edit = Edit::set(find(document, keyword), "radius", FieldValue::numbers([radius]));
        document.apply(&edit).unwrap();
    }

    fn texts(document: &Document) -> Vec<String> {
        document.files().map(|(_, file)| file.text.to_string()).collect()
    }

    #[test]
    fn unsaved_edits_come_back_and_can_be_undone() {
        let (_folder, path) = folder();
        let mut document = open(&path);
        assert_eq!(document.unsaved(), None);
        set_radius(&mut document, "Sphere", 3.0);
        set_radius(&mut document, "Cone", 4.0);
        let unsaved = document.unsaved().unwrap();
        let mut restored = Document::restore(&unsaved, Path::new("."), LoadOptions::default()).unwrap();
        assert_eq!(texts(&restored), texts(&document));
        assert_eq!(restored.unsaved(), Some(unsaved.clone()));
        assert!(restored.conflicts().is_empty() && !restored.changed_on_disk());
        while restored.undo() {}
        assert_eq!(texts(&restored), [SCENE, MORE]);
        assert!(!restored.has_unsaved_edits());

        // A scene whose file is gone is there all the same, and saving brings the file back.
        fs::remove_file(&path).unwrap();
        let mut restored = Document::restore(&unsaved, Path::new("."), LoadOptions::default()).unwrap();
        assert_eq!(texts(&restored), texts(&document));
        restored.save().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), document.text());
    }

    #[test]
    fn a_scene_without_a_file_has_something_to_lose_once_it_is_edited() {
        let folder = tempfile::tempdir().unwrap();
        let text = SCENE.replace("  include \"more.txt\"\n", "");
        let mut document = Document::untitled(folder.path(), &text, LoadOptions::default()).unwrap();
        assert!(!document.has_unsaved_edits());
        document.begin_gesture("drag");
        set_radius(&mut document, "Sphere", 3.0);
        assert!(document.has_unsaved_edits(), "in the middle of a drag too");
        document.end_gesture();
        let unsaved = document.unsaved().unwrap();
        let restored = Document::restore(&unsaved, folder.path(), LoadOptions::default()).unwrap();
        assert_eq!((restored.path(), restored.text()), (None, document.text()));
        assert!(restored.has_unsaved_edits());
        document.undo();
        assert!(!document.has_unsaved_edits());
    }

    #[test]
    fn a_file_that_two_have_changed_is_a_conflict_and_others_are_not() {
        let (folder, path) = folder();
        let mut document = open(&path);
        set_radius(&mut document, "Sphere", 3.0);
        let edited = document.text().to_owned();
        // The file beside it was changed: that is taken over, and the edits stay.
        fs::write(folder.path().join("more.txt"), MORE.replace("radius 2", "radius 2.5")).unwrap();
        assert!(document.conflicts().is_empty());
        let cone = find(&document, "Cone");
        document.take_theirs().unwrap();
        assert_eq!(document.text(), edited);
        assert!(texts(&document)[1].contains("radius 2.5") && document.node(cone).is_some());

        let theirs = SCENE.replace("radius 1", "radius 7");
        fs::write(&path, &theirs).unwrap();
        let conflicts = document.conflicts();
        assert_eq!((conflicts.len(), &*conflicts[0].mine, &*conflicts[0].theirs), (1, &*edited, &*theirs));
        let mut other = document.clone();
        let ball = find(&other, "Sphere");
        other.take_theirs().unwrap();
        assert_eq!(other.text(), theirs);
        assert!(other.node(ball).is_some(), "the block on the changed line is the same");
        other.undo();
        assert_eq!(other.text(), edited);

        document.keep_mine(&conflicts);
        assert!(document.conflicts().is_empty() && !document.changed_on_disk() && document.is_dirty());
        document.save().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), edited);
    }

    #[test]
    fn edits_that_come_back_to_a_file_that_was_changed_meanwhile_are_a_conflict() {
        let (_folder, path) = folder();
        let mut document = open(&path);
        set_radius(&mut document, "Sphere", 3.0);
        fs::write(&path, SCENE.replace("ball", "globe")).unwrap();
        let unsaved = document.unsaved().unwrap();
        let restored = Document::restore(&unsaved, Path::new("."), LoadOptions::default()).unwrap();
        assert!(restored.changed_on_disk());
        assert_eq!(restored.conflicts().len(), 1);
        assert_eq!(restored.text(), document.text());
    }
}
