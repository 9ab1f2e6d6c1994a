//! Unsaved edits, saved aside while one works and found again after a crash.
//!
//! ```text
//! folder/ID.lock   locked by a program as long as it runs
//! folder/ID.json   the edits of its document that are not on disk; not there while there are none
//! ```
//!
//! The system takes locks away from programs that end, however they end. So a record whose lock can be had was left
//! over. A record is written whole or not at all, by a thread of its own.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use kajo::output::Target;
use kajo_edit::{Document, Unsaved, UnsavedText};
use serde::{Deserialize, Serialize};

use super::tracer::Wake;
use super::worker::Worker;

/// What a document was when it was saved aside: its number, that of its text, and whether it had unsaved edits.
type State = (u64, u64, bool);

/// Saves the edits of one document aside.
pub struct Recovery {
    slot: Slot,
    writer: Worker<Order, Result<(), String>>,
    ordered: Option<State>,
}

/// Edits that a program left over when it ended.
pub struct LeftOver {
    slot: Slot,
    /// The edits.
    pub unsaved: Unsaved,
    /// When they were saved aside.
    pub when: SystemTime,
}

/// A record to be written, or taken away.
struct Order {
    record: PathBuf,
    unsaved: Option<Unsaved>,
}

/// A record that belongs to this program.
struct Slot {
    /// Held as long as the slot is.
    _lock: File,
    record: PathBuf,
}

/// A record as it is in its file.
#[derive(Serialize, Deserialize)]
struct Record {
    scene: Option<OsString>,
    texts: Vec<TextRecord>,
}

#[derive(Serialize, Deserialize)]
struct TextRecord {
    name: Option<String>,
    saved: Option<String>,
    text: String,
}

impl Recovery {
    /// Begins to save aside in a folder, which is made if need be.
    ///
    /// * `wake`: called when something was written
    ///
    /// # Errors
    /// When files cannot be made or locked there.
    pub fn begin(folder: &Path, wake: Wake) -> io::Result<Recovery> {
        make_private(folder)?;
        let slot = Slot::new(folder)?;
        Ok(Recovery { slot, writer: Worker::new(wake, Order::carry_out), ordered: None })
    }

    /// Saves aside what a document has that is not on disk, if that is not done or under way.
    ///
    /// * `opened`: the number of the document
    pub fn keep(&mut self, opened: u64, document: &Document) {
        let state = (opened, document.text_generation(), document.has_unsaved_edits());
        if self.ordered == Some(state) {
            return;
        }
        // Nothing to take away where nothing was ever written.
        if self.ordered.is_some() || state.2 {
            let record = self.slot.record.clone();
            self.writer.order(Order { record, unsaved: document.unsaved() });
        }
        self.ordered = Some(state);
    }

    /// What went wrong with the last record, if something did.
    pub fn problem(&mut self) -> Option<String> {
        self.writer.take_latest()?.err()
    }

    /// Waits until everything is written.
    pub fn settle(&mut self) {
        self.writer.wait();
    }

    /// Goes on with the record that another program left over.
    pub fn adopt(&mut self, left_over: LeftOver) -> Unsaved {
        self.settle();
        let own = std::mem::replace(&mut self.slot, left_over.slot);
        own.remove();
        self.ordered = None;
        left_over.unsaved
    }

    /// Forgets the edits, as the program is about to end.
    pub fn end(&mut self) {
        self.settle();
        self.slot.remove();
    }
}

impl Drop for Recovery {
    fn drop(&mut self) {
        self.settle();
        if !self.slot.record.exists() {
            self.slot.remove();
        }
    }
}

/// What other programs have left over in a folder, the newest first. Records of what is on disk by now are taken away.
pub fn left_over(folder: &Path) -> Vec<LeftOver> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut found = Vec::new();
    for path in entries.flatten().map(|entry| entry.path()) {
        let Some(slot) = Slot::claim(&path) else { continue };
        let when = fs::metadata(&slot.record).and_then(|about| about.modified());
        let (Ok(when), Ok(bytes)) = (when, fs::read(&slot.record)) else {
            // A lock without a record.
            slot.remove();
            continue;
        };
        // What this program cannot read may mean something to another version of it.
        let Ok(record) = serde_json::from_slice::<Record>(&bytes) else { continue };
        let unsaved = Unsaved::from(record);
        if is_on_disk(&unsaved) {
            slot.remove();
        } else {
            found.push(LeftOver { slot, unsaved, when });
        }
    }
    found.sort_by_key(|left_over| std::cmp::Reverse(left_over.when));
    found
}

/// Whether all texts are what their files say, as when a program ended right after saving.
fn is_on_disk(unsaved: &Unsaved) -> bool {
    let Some(path) = &unsaved.path else { return false };
    let folder = path.parent().unwrap_or(path);
    unsaved.texts.iter().all(|text| {
        let path = text.name.as_ref().map_or(path.clone(), |name| folder.join(name));
        fs::read(path).is_ok_and(|bytes| bytes == text.text.as_bytes())
    })
}

impl LeftOver {
    /// The name of the scene for people.
    pub fn title(&self) -> String {
        let name = self.unsaved.path.as_deref().and_then(Path::file_name);
        name.map_or("a scene without a file".to_owned(), |name| name.to_string_lossy().into_owned())
    }

    /// Forgets the edits.
    pub fn remove(self) {
        self.slot.remove();
    }
}

impl Order {
    fn carry_out(self) -> Result<(), String> {
        let Some(unsaved) = self.unsaved else {
            return match fs::remove_file(&self.record) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error.to_string()),
                _ => Ok(()),
            };
        };
        let bytes = serde_json::to_vec(&Record::from(unsaved)).map_err(|error| error.to_string())?;
        let target = Target::check(&self.record, &[]).map_err(|error| error.to_string())?;
        target.write(&bytes).map_err(|error| error.to_string())
    }
}

impl Slot {
    fn new(folder: &Path) -> io::Result<Slot> {
        for number in 0_u32.. {
            let lock = folder.join(format!("{}-{number}.lock", std::process::id()));
            if lock.exists() || lock.with_extension("json").exists() {
                continue;
            }
            // Nobody sees it before it is locked.
            let hidden = tempfile::Builder::new().prefix(".").suffix(".new").tempfile_in(folder)?;
            hidden.as_file().try_lock()?;
            match hidden.persist_noclobber(&lock) {
                Ok(file) => return Ok(Slot { _lock: file, record: lock.with_extension("json") }),
                Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error.error),
            }
        }
        Err(io::ErrorKind::AlreadyExists.into())
    }

    /// The slot of a lock or a record that no running program holds.
    fn claim(path: &Path) -> Option<Slot> {
        let ending = path.extension()?;
        let record = path.with_extension("json");
        // Where both are there, the lock stands for them.
        if ending != "lock" && (ending != "json" || path.with_extension("lock").exists()) {
            return None;
        }
        let file = File::options().create(true).append(true).open(path.with_extension("lock")).ok()?;
        file.try_lock().ok()?;
        Some(Slot { _lock: file, record })
    }

    /// Takes the record and the lock away.
    fn remove(&self) {
        // Should one of them stay, it is found and offered once more, or taken away then.
        let _ = fs::remove_file(&self.record);
        let _ = fs::remove_file(self.record.with_extension("lock"));
    }
}

impl From<Unsaved> for Record {
    fn from(unsaved: Unsaved) -> Record {
        let text = |text: UnsavedText| TextRecord {
            name: text.name,
            saved: text.saved.map(|saved| saved.to_string()),
            text: text.text.to_string(),
        };
        let absolute = |path: PathBuf| std::path::absolute(&path).unwrap_or(path).into_os_string();
        Record { scene: unsaved.path.map(absolute), texts: unsaved.texts.into_iter().map(text).collect() }
    }
}

impl From<Record> for Unsaved {
    fn from(record: Record) -> Unsaved {
        let text = |text: TextRecord| UnsavedText {
            name: text.name,
            saved: text.saved.map(Into::into),
            text: text.text.into(),
        };
        Unsaved { path: record.scene.map(PathBuf::from), texts: record.texts.into_iter().map(text).collect() }
    }
}

/// Makes a folder that others cannot look into.
fn make_private(folder: &Path) -> io::Result<()> {
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::DirBuilderExt;
        builder.mode(0o700);
    }
    builder.create(folder)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo::LoadOptions;
    use kajo_edit::{Edit, FileId};
    use std::sync::Arc;

    fn begin(folder: &Path) -> Recovery {
        Recovery::begin(folder, Arc::new(|| ())).unwrap()
    }

    fn rewrite(document: &mut Document, text: &str) {
        let file: FileId = document.files().next().unwrap().0;
        document.apply(&Edit::Rewrite { file, text: text.to_owned() }).unwrap();
    }

    fn names(folder: &Path) -> usize {
        fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn edits_are_found_once_their_program_has_ended_and_not_before() {
        let folder = tempfile::tempdir().unwrap();
        let (aside, scene) = (folder.path().join("a/b"), folder.path().join("scene.txt"));
        fs::write(&scene, "Group { }").unwrap();
        let mut document = Document::open(&scene, LoadOptions::default()).unwrap();
        let mut recovery = begin(&aside);
        recovery.keep(1, &document);
        recovery.settle();
        assert_eq!(names(&aside), 1, "there is nothing to keep yet");
        rewrite(&mut document, "Group { } // edited");
        recovery.keep(1, &document);
        recovery.settle();
        assert_eq!((recovery.problem(), names(&aside)), (None, 2));
        assert!(left_over(&aside).is_empty(), "the program still runs");

        drop(recovery);
        let mut found = left_over(&aside);
        assert_eq!(found.len(), 1);
        assert!(left_over(&aside).is_empty(), "they are offered by one program at a time");
        assert_eq!(found[0].title(), "scene.txt");
        let mut recovery = begin(&aside);
        let unsaved = recovery.adopt(found.remove(0));
        let document = Document::restore(&unsaved, &aside, LoadOptions::default()).unwrap();
        assert_eq!(document.text(), "Group { } // edited");

        // Whoever ends right after that loses nothing either.
        drop(recovery);
        let mut recovery = begin(&aside);
        recovery.adopt(left_over(&aside).remove(0));
        let mut document = document;
        recovery.keep(1, &document);
        document.save().unwrap();
        recovery.keep(1, &document);
        drop(recovery);
        assert_eq!(names(&aside), 0);
    }

    #[test]
    fn what_was_saved_in_the_end_is_not_offered() {
        let folder = tempfile::tempdir().unwrap();
        let (aside, scene) = (folder.path().join("aside"), folder.path().join("scene.txt"));
        fs::write(&scene, "Group { }").unwrap();
        let mut document = Document::open(&scene, LoadOptions::default()).unwrap();
        let mut recovery = begin(&aside);
        rewrite(&mut document, "Group { } // edited");
        recovery.keep(1, &document);
        recovery.settle();
        document.save().unwrap();
        drop(recovery);
        assert!(left_over(&aside).is_empty());
        assert_eq!(names(&aside), 0);
        fs::write(aside.join("7-0.json"), "{ no record").unwrap();
        assert!(left_over(&aside).is_empty());
        assert!(aside.join("7-0.json").exists(), "somebody else may be able to read it");
    }
}
