//! Nothing that somebody has made is lost, whatever is done and whenever the program is killed.
//!
//! A program without a window does random things to scenes: edits, opens, saves, closes, reads again, while another
//! program writes the same files. It notes in a log what it is about to do and what came of it. It is killed at a
//! random moment, and then the text that was on show must be there: saved aside, or in its file.

#![cfg(unix)]

mod common;

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use common::Dice;
use kajo_edit::{FieldValue, FileId};
use kajo_studio::state::{Action, Answer, Question, Studio};

const SCENE: &str = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }
Materials { Matte { } }
Group { MaterialIndex 0 Sphere ball { center 0 0 0 radius 1 } }
";

/// Where the program is to work, and what decides what it does.
const FOLDER: &str = "KAJO_SURVIVAL_FOLDER";
const SEED: &str = "KAJO_SURVIVAL_SEED";

/// Most things that are done before the program ends by itself.
const MOST_STEPS: usize = 40;

/// Starts this very test anew, again and again, as the program that is killed.
#[test]
fn nothing_is_lost_in_random_sequences() {
    if let Some(folder) = std::env::var_os(FOLDER) {
        return do_random_things(PathBuf::from(folder));
    }
    // All of them take minutes.
    sequences(if kajo_testkit::is_deep() { 0..1000 } else { 0..25 });
}

fn sequences(seeds: std::ops::Range<u64>) {
    let (mut recovered, mut killed) = (0, 0);
    for seed in seeds {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.txt", "b.txt"] {
            fs::write(folder.path().join(name), SCENE).unwrap();
        }
        let mut dice = Dice::new(seed);
        for life in 0..3 {
            killed += usize::from(live(folder.path(), 10 * seed + life, &mut dice));
            recovered += usize::from(check(folder.path(), seed));
        }
    }
    assert!(recovered > 0 && killed > recovered, "{recovered} of {killed} had something to recover");
}

/// Runs the program until it ends or is killed; whether it was.
fn live(folder: &Path, seed: u64, dice: &mut Dice) -> bool {
    let on_disk = ["a.txt", "b.txt", "c.txt"].into_iter().filter_map(|name| {
        let text = fs::read_to_string(folder.join(name)).ok()?;
        Some(format!("writes {name} {}\n", hash(&text)))
    });
    fs::write(folder.join("log"), on_disk.collect::<String>()).unwrap();
    let mut program = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "nothing_is_lost_in_random_sequences", "--nocapture"])
        .env(FOLDER, folder)
        .env(SEED, seed.to_string())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let steps = 1 + dice.below(MOST_STEPS);
    while fs::read_to_string(folder.join("log")).unwrap().matches("begin").count() < steps {
        if program.try_wait().unwrap().is_some() {
            break;
        }
        thread::sleep(Duration::from_millis(1));
    }
    thread::sleep(Duration::from_micros(dice.below(4000) as u64));
    program.kill().unwrap();
    let output = program.wait_with_output().unwrap();
    let is_killed = output.status.code().is_none();
    assert!(is_killed || output.status.success(), "seed {seed}: {}", String::from_utf8_lossy(&output.stderr));
    is_killed
}

/// Looks what is there after the end of the program; whether edits were recovered.
fn check(folder: &Path, seed: u64) -> bool {
    let log = fs::read_to_string(folder.join("log")).unwrap();
    // What may be on show: what was there when all was saved aside for the last time, and all since then.
    let mut shown: Vec<(String, String)> = Vec::new();
    let mut on_disk: Vec<(String, Vec<String>)> = Vec::new();
    let mut may_be_given_up = false;
    for line in log.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        match words.as_slice() {
            ["begin", ..] => {}
            ["gives-up"] => may_be_given_up = true,
            ["writes", name, hash] => match on_disk.iter_mut().find(|(file, _)| file == name) {
                Some((_, hashes)) => hashes.push((*hash).to_owned()),
                None => on_disk.push(((*name).to_owned(), vec![(*hash).to_owned()])),
            },
            ["wrote", name] => on_disk.iter_mut().filter(|(file, _)| file == name).for_each(|(_, hashes)| {
                hashes.drain(..hashes.len() - 1);
            }),
            ["made", name, hash] => shown.push(((*name).to_owned(), (*hash).to_owned())),
            ["kept"] => {
                shown.drain(..shown.len().saturating_sub(1));
                may_be_given_up = false;
            }
            // The last line may have been cut off.
            _ => {}
        }
    }
    for (name, hashes) in &on_disk {
        // It may not have come to the first write of this one.
        let Ok(text) = fs::read_to_string(folder.join(name)) else {
            assert_eq!(name, "c.txt", "seed {seed}: a file is gone");
            continue;
        };
        assert!(
            hashes.contains(&hash(&text)),
            "seed {seed}: {name} is none of what was written:\n{text}\n{log}"
        );
    }

    let mut studio = studio(folder);
    let recovered = matches!(studio.question(), Some(Question::Recover(_)));
    if recovered {
        studio.apply(Action::Answer(Answer::Recover(0)));
    }
    let is_there = |(name, wanted): &(String, String)| match recovered {
        true => state(&studio) == (name.clone(), wanted.clone()),
        // A scene without a file that nobody has edited is nothing to lose.
        false => {
            name == "untouched"
                || fs::read_to_string(folder.join(name)).is_ok_and(|text| hash(&text) == *wanted)
        }
    };
    let is_kept = shown.is_empty() || shown.iter().any(is_there) || may_be_given_up;
    assert!(is_kept, "seed {seed}: {:?} is none of {shown:?}\n{log}", recovered.then(|| state(&studio)));
    // It is to be found once more by the program that lives next.
    studio.settle_recovery();
    recovered
}

fn hash(text: &str) -> String {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    format!("{:x}", hasher.finish())
}

fn studio(folder: &Path) -> Studio {
    let mut studio = Studio::new(Arc::new(|| ()));
    studio.keep_edits_in(&folder.join("aside"));
    studio
}

/// The name of the file on show and the hash of its text.
fn state(studio: &Studio) -> (String, String) {
    let Some(document) = &studio.document else { return ("untouched".to_owned(), String::new()) };
    let name = match document.path().and_then(Path::file_name) {
        Some(name) => name.to_string_lossy().into_owned(),
        None if document.has_unsaved_edits() => "untitled".to_owned(),
        None => "untouched".to_owned(),
    };
    (name, hash(document.text()))
}

/// The program that is killed, or that ends by itself.
fn do_random_things(folder: PathBuf) {
    let seed = std::env::var(SEED).unwrap().parse().unwrap();
    let log = fs::File::options().append(true).open(folder.join("log")).unwrap();
    let mut user = User { studio: studio(&folder), folder, log, dice: Dice::new(seed), written: 0 };
    if user.studio.question().is_some() {
        user.studio.apply(Action::Answer(Answer::Recover(0)));
        user.studio.update();
    }
    user.keep();
    for step in 0..MOST_STEPS {
        user.note(&format!("begin {step}"));
        user.step();
        if user.studio.is_closing() {
            return;
        }
        user.keep();
    }
}

/// Somebody who does random things.
struct User {
    studio: Studio,
    folder: PathBuf,
    log: fs::File,
    dice: Dice,
    /// Counts texts.
    written: u32,
}

impl User {
    fn note(&mut self, line: &str) {
        // In one piece, so that only the last line can be cut off.
        self.log.write_all(format!("{line}\n").as_bytes()).unwrap();
    }

    fn note_state(&mut self) {
        let (mut name, hash) = state(&self.studio);
        let on_disk = self.path().and_then(|path| fs::read_to_string(path).ok());
        // What another program has replaced, and nobody has edited here, is not ours to keep.
        if !self.studio.has_unsaved_edits() && on_disk != Some(self.text()) {
            name = "untouched".to_owned();
        }
        self.note(&format!("made {name} {hash}"));
    }

    /// Lets everything be saved aside, as between two frames of a window.
    fn keep(&mut self) {
        self.note_state();
        self.studio.update();
        // That another program has written the file may be noticed at any time.
        self.decide_between();
        self.note_state();
        self.studio.apply(Action::EndDrag);
        self.studio.settle_recovery();
        self.note("kept");
    }

    fn path(&self) -> Option<PathBuf> {
        self.studio.document.as_ref().and_then(|document| document.path()).map(Path::to_owned)
    }

    fn text(&self) -> String {
        self.studio.document.as_ref().map_or(String::new(), |document| document.text().to_owned())
    }

    fn step(&mut self) {
        match self.dice.below(16) {
            0 => self.leave(Action::New),
            1 | 2 => {
                let path = self.folder.join(["a.txt", "b.txt"][self.dice.below(2)]);
                self.leave(Action::Open(path));
            }
            3 => self.leave(Action::Close),
            4 | 5 => self.save(),
            6 => self.save_as(),
            7 => self.write_from_elsewhere(),
            8 => self.read_again(),
            9 => self.studio.apply(Action::Undo),
            10 => self.studio.apply(Action::Redo),
            _ => self.edit(),
        }
    }

    fn edit(&mut self) {
        self.written += 1;
        let text = format!("{}// {}\n", self.text(), self.written);
        let Some(document) = &self.studio.document else { return };
        let file: FileId = document.files().next().unwrap().0;
        let ball =
            document.outline().nodes().iter().find(|node| &*node.keyword == "Sphere").map(|node| node.id);
        let value = FieldValue::numbers([f64::from(self.written)]);
        match (self.dice.below(3), ball) {
            (0, Some(node)) => {
                self.studio.apply(Action::SetField { node, key: "radius".into(), nth: 0, value });
                self.studio.apply(Action::EndDrag);
            }
            (1, _) => self.studio.apply(Action::Add("Box")),
            _ => {
                self.studio.apply(Action::Type { file, text });
                self.studio.apply(Action::EndTyping);
            }
        }
    }

    /// Notes what the file on show will say once it is saved.
    fn note_write(&mut self, path: &Path) {
        let (name, hash) = (path.file_name().unwrap().to_string_lossy().into_owned(), hash(&self.text()));
        self.note(&format!("writes {name} {hash}"));
    }

    fn save(&mut self) {
        let Some(path) = self.path() else { return };
        let on_disk = fs::read_to_string(&path).unwrap();
        self.note_write(&path);
        self.studio.apply(Action::Save);
        if let Some(Question::Conflict { conflicts, .. }) = self.studio.question() {
            assert_eq!(*conflicts[0].theirs, on_disk);
            assert_eq!(fs::read_to_string(&path).unwrap(), on_disk, "not before the question is answered");
            self.decide_between();
        } else {
            assert_eq!(fs::read_to_string(&path).unwrap(), self.text());
        }
        if fs::read_to_string(&path).unwrap() == self.text() {
            self.note_write(&path);
            self.note(&format!("wrote {}", path.file_name().unwrap().to_string_lossy()));
        }
    }

    fn save_as(&mut self) {
        if self.studio.document.is_none() {
            return;
        }
        let path = self.folder.join(["a.txt", "b.txt", "c.txt"][self.dice.below(3)]);
        let before = fs::read_to_string(&path).ok();
        self.note_write(&path);
        self.studio.apply(Action::SaveAs(path.clone()));
        if self.studio.question().is_some() {
            assert_eq!(fs::read_to_string(&path).ok(), before, "not before the question is answered");
            let answer = [Answer::Replace, Answer::Cancel][self.dice.below(2)];
            self.studio.apply(Action::Answer(answer));
        }
        assert!(self.studio.question().is_none());
    }

    /// Another program writes the file on show.
    fn write_from_elsewhere(&mut self) {
        let Some(path) = self.path() else { return };
        self.written += 1;
        let text = format!("{SCENE}// from elsewhere {}\n", self.written);
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        self.note(&format!("writes {name} {}", hash(&text)));
        // Without edits the file will be read again.
        if !self.studio.has_unsaved_edits() {
            self.note("gives-up");
        }
        let new = self.folder.join("new");
        fs::write(&new, text).unwrap();
        fs::rename(new, path).unwrap();
        self.note(&format!("wrote {name}"));
        if !self.studio.has_unsaved_edits() {
            self.studio.apply(Action::Reload);
            self.decide_between();
        }
    }

    fn read_again(&mut self) {
        let Some(path) = self.path() else { return };
        let mine = self.text();
        self.studio.apply(Action::Reload);
        if self.studio.question().is_some() {
            assert_eq!(self.text(), mine, "not before the question is answered");
            self.decide_between();
        } else {
            assert_eq!(self.text(), fs::read_to_string(path).unwrap());
        }
    }

    /// Answers a question about two texts; mine is never lost by that.
    fn decide_between(&mut self) {
        if !matches!(self.studio.question(), Some(Question::Conflict { .. })) {
            return;
        }
        let mine = self.text();
        match self.dice.below(3) {
            0 => {
                self.note("gives-up");
                self.studio.apply(Action::Answer(Answer::Theirs));
                let theirs = self.text();
                self.studio.apply(Action::Undo);
                assert!(self.text() == mine || theirs == mine, "undo brings mine back");
                self.studio.apply(Action::Redo);
                assert_eq!(self.text(), theirs);
            }
            1 => self.studio.apply(Action::Answer(Answer::Mine)),
            _ => self.studio.apply(Action::Answer(Answer::Cancel)),
        }
        assert!(self.studio.question().is_none());
    }

    /// Opens something else, or ends.
    fn leave(&mut self, action: Action) {
        let had_edits = self.studio.has_unsaved_edits();
        let before = state(&self.studio);
        if !had_edits {
            // It is in its file.
            self.note("gives-up");
        }
        self.studio.apply(action);
        assert_eq!(self.studio.question().is_some(), had_edits, "whoever has edits is asked");
        if had_edits {
            assert_eq!(state(&self.studio), before);
            match (self.dice.below(3), self.path()) {
                (0, Some(path)) => {
                    self.note_write(&path);
                    self.studio.apply(Action::Answer(Answer::Save));
                    self.decide_between_and_cancel();
                }
                (1, _) => {
                    self.note("gives-up");
                    self.studio.apply(Action::Answer(Answer::Drop));
                }
                _ => self.studio.apply(Action::Answer(Answer::Cancel)),
            }
        }
        while self.studio.is_loading() {
            thread::sleep(Duration::from_micros(200));
            self.studio.update();
        }
    }

    /// The same after a wish to save before something else.
    fn decide_between_and_cancel(&mut self) {
        if matches!(self.studio.question(), Some(Question::Conflict { .. })) {
            self.studio.apply(Action::Answer(Answer::Cancel));
        }
        if self.studio.question().is_some() {
            self.studio.apply(Action::Answer(Answer::Cancel));
        }
    }
}
