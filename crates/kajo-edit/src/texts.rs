//! The texts a scene is made of, and changes to them that can be taken back.
//!
//! A change is a list of replacements. It holds the bytes before and after, so that it can be turned round: applied
//! to what it made, the inverse gives the old bytes again, whatever they were.

use std::ops::Range;
use std::sync::Arc;

use kajo_scene::{EditError, apply_edits};

use super::difference::{hunks_of, lines};

/// Which text of a document.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FileId(pub(super) u32);

/// One of the files a document consists of: the scene, or what it includes.
#[derive(Clone, Debug)]
pub struct SceneFile {
    /// The name shown in messages, by which the scene's places refer to it.
    pub name: String,
    /// The text as it is now.
    pub text: Arc<str>,
    /// The text on disk, as far as is known; `None` for one that was never saved.
    pub(super) saved: Option<Arc<str>>,
}

impl SceneFile {
    /// Whether the text differs from what is on disk.
    pub fn is_dirty(&self) -> bool {
        self.saved.as_ref() != Some(&self.text)
    }
}

/// A range of text to be replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextEdit {
    /// The text.
    pub file: FileId,
    /// Bytes to be taken out; empty to insert.
    pub range: Range<usize>,
    /// What comes in their place.
    pub new: String,
}

impl TextEdit {
    /// Puts `new` before byte `at`.
    pub fn insert(file: FileId, at: usize, new: impl Into<String>) -> TextEdit {
        TextEdit { file, range: at..at, new: new.into() }
    }
}

/// A replaced range, with its text before and after.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Replacement {
    file: FileId,
    /// First byte, in the text before the change.
    at: usize,
    old: String,
    new: String,
}

/// A change of texts that can be turned round.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Change {
    /// Sorted by file and place.
    replacements: Vec<Replacement>,
}

impl Change {
    /// The change that `edits` make to `files`. Insertions at one place keep their order.
    ///
    /// # Errors
    /// When two edits overlap or one does not fit.
    pub fn of(files: &[SceneFile], mut edits: Vec<TextEdit>) -> Result<Change, EditError> {
        edits.sort_by_key(|edit| (edit.file, edit.range.start, edit.range.end));
        let mut replacements: Vec<Replacement> = Vec::with_capacity(edits.len());
        for edit in edits {
            let text = files.get(edit.file.0 as usize).map_or("", |file| &*file.text);
            let old = text.get(edit.range.clone()).ok_or(EditError::OutOfRange(edit.range.clone()))?;
            if old == edit.new {
                continue;
            }
            let replacement =
                Replacement { file: edit.file, at: edit.range.start, old: old.to_owned(), new: edit.new };
            match replacements.last_mut().filter(|last| last.file == replacement.file) {
                // What is inserted before a replacement becomes part of its new text.
                Some(last) if last.at == replacement.at && last.old.is_empty() => {
                    last.new.push_str(&replacement.new);
                    last.old = replacement.old;
                }
                // What is taken out side by side is one replacement: the way back has one position for all of it.
                Some(last)
                    if replacement.at == last.at + last.old.len()
                        && last.new.is_empty()
                        && replacement.new.is_empty() =>
                {
                    last.old.push_str(&replacement.old);
                }
                Some(last) if replacement.at < last.at + last.old.len() => {
                    return Err(EditError::Overlap(last.range(), replacement.range()));
                }
                _ => replacements.push(replacement),
            }
        }
        Ok(Change { replacements })
    }

    /// The one change between two versions of a text: all between their common beginning and end.
    pub fn between(file: FileId, old: &str, new: &str) -> Change {
        let start = common_prefix(old, new);
        let end = common_suffix(&old[start..], &new[start..]);
        let replacement = Replacement {
            file,
            at: start,
            old: old[start..old.len() - end].to_owned(),
            new: new[start..new.len() - end].to_owned(),
        };
        Change { replacements: if old == new { Vec::new() } else { vec![replacement] } }
    }

    /// The change between two versions of a text, as other programs make them: a replacement for each few words that differ,
    /// among the lines that differ.
    pub fn by_words(file: FileId, old: &str, new: &str) -> Change {
        let mut replacements = Vec::new();
        each_hunk(&lines(old), &lines(new), |start, old, new| {
            each_hunk(&words(&old), &words(&new), |offset, old, new| {
                replacements.push(Replacement { file, at: start + offset, old, new });
            });
        });
        Change { replacements }
    }

    pub fn is_empty(&self) -> bool {
        self.replacements.is_empty()
    }

    /// Whether it changes no other file.
    pub fn is_only_in(&self, file: FileId) -> bool {
        self.replacements.iter().all(|replacement| replacement.file == file)
    }

    /// The change as edits.
    pub fn edits(self) -> impl Iterator<Item = TextEdit> {
        self.replacements.into_iter().map(|p| TextEdit { file: p.file, range: p.range(), new: p.new })
    }

    /// The change back.
    pub fn inverse(&self) -> Change {
        let mut replacements = Vec::with_capacity(self.replacements.len());
        let mut shift = (FileId(0), 0_isize);
        for replacement in &self.replacements {
            if replacement.file != shift.0 {
                shift = (replacement.file, 0);
            }
            let at = replacement.at.saturating_add_signed(shift.1);
            replacements.push(Replacement {
                file: replacement.file,
                at,
                old: replacement.new.clone(),
                new: replacement.old.clone(),
            });
            shift.1 += replacement.new.len() as isize - replacement.old.len() as isize;
        }
        Change { replacements }
    }

    /// Changes the texts. They must be those that the change was made for.
    ///
    /// # Errors
    /// When they are not, as far as that shows; then nothing has changed.
    pub fn apply(&self, files: &mut [SceneFile]) -> Result<(), EditError> {
        let mut changed = Vec::new();
        for replacements in self.replacements.chunk_by(|a, b| a.file == b.file) {
            let index = replacements[0].file.0 as usize;
            let text = files.get(index).map_or("", |file| &*file.text);
            if let Some(replacement) = replacements.iter().find(|p| text.get(p.range()) != Some(&*p.old)) {
                return Err(EditError::OutOfRange(replacement.range()));
            }
            let edits: Vec<_> = replacements
                .iter()
                .map(|replacement| (replacement.range(), replacement.new.clone()))
                .collect();
            changed.push((index, apply_edits(text, &edits)?));
        }
        for (index, text) in changed {
            files[index].text = text.into();
        }
        Ok(())
    }

    /// Where something that begins at byte `at` begins afterwards; `None` when it is taken out.
    ///
    /// What is inserted at `at` comes before it.
    pub fn carry(&self, file: FileId, at: usize) -> Option<usize> {
        let mut shift = 0_isize;
        for replacement in self.replacements.iter().filter(|replacement| replacement.file == file) {
            let end = replacement.at + replacement.old.len();
            if at < replacement.at {
                break;
            }
            if at < end {
                let stays = at == replacement.at && !replacement.new.is_empty();
                return stays.then(|| at.saturating_add_signed(shift));
            }
            shift += replacement.new.len() as isize - replacement.old.len() as isize;
        }
        Some(at.saturating_add_signed(shift))
    }
}

impl Replacement {
    fn range(&self) -> Range<usize> {
        self.at..self.at + self.old.len()
    }
}

/// Calls `take` with the byte where each hunk begins in the old text, and with the old and the new text of it.
fn each_hunk(old: &[&str], new: &[&str], mut take: impl FnMut(usize, String, String)) {
    let (mut at, mut start) = (0, 0);
    for hunk in hunks_of(old, new) {
        let bytes = |range: Range<usize>| old[range].iter().map(|part| part.len()).sum::<usize>();
        start += bytes(at..hunk.old.start);
        take(start, old[hunk.old.clone()].concat(), new[hunk.new].concat());
        start += bytes(hunk.old.clone());
        at = hunk.old.end;
    }
}

/// The words of a text, each with the blank after it.
fn words(text: &str) -> Vec<&str> {
    text.split_inclusive(char::is_whitespace).collect()
}

fn common_prefix(a: &str, b: &str) -> usize {
    let equal = a.bytes().zip(b.bytes()).take_while(|(a, b)| a == b).count();
    (0..=equal).rev().find(|&i| a.is_char_boundary(i) && b.is_char_boundary(i)).unwrap_or(0)
}

fn common_suffix(a: &str, b: &str) -> usize {
    let equal = a.bytes().rev().zip(b.bytes().rev()).take_while(|(a, b)| a == b).count();
    let fits = |n: usize| a.is_char_boundary(a.len() - n) && b.is_char_boundary(b.len() - n);
    (0..=equal).rev().find(|&n| fits(n)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn files(texts: &[&str]) -> Vec<SceneFile> {
        let file = |text: &&str| SceneFile { name: "f".to_owned(), text: (*text).into(), saved: None };
        texts.iter().map(file).collect()
    }

    fn edit(file: u32, range: Range<usize>, new: &str) -> TextEdit {
        TextEdit { file: FileId(file), range, new: new.to_owned() }
    }

    #[test]
    fn a_change_is_made_and_taken_back() {
        let mut texts = files(&["abcdef", "xyz"]);
        let edits = vec![
            edit(1, 3..3, "!"),
            edit(0, 4..5, ""),
            edit(0, 1..2, "BBB"),
            edit(0, 0..0, "<"),
            edit(0, 0..0, "["),
        ];
        let change = Change::of(&texts, edits).unwrap();
        change.apply(&mut texts).unwrap();
        assert_eq!((&*texts[0].text, &*texts[1].text), ("<[aBBBcdf", "xyz!"));
        assert!(change.apply(&mut texts).is_err(), "not the text it was made for");
        change.inverse().apply(&mut texts).unwrap();
        assert_eq!((&*texts[0].text, &*texts[1].text), ("abcdef", "xyz"));
        assert!(Change::of(&texts, vec![edit(0, 0..3, ""), edit(0, 2..4, "")]).is_err());
        assert!(Change::of(&texts, vec![edit(1, 2..4, "")]).is_err());
    }

    #[test]
    fn places_are_carried_along() {
        let texts = files(&["aa bb cc"]);
        let edits = vec![edit(0, 0..2, "A"), edit(0, 3..3, "new "), edit(0, 6..8, "")];
        let change = Change::of(&texts, edits).unwrap();
        let carried = [0, 1, 3, 6, 8].map(|at| change.carry(FileId(0), at));
        assert_eq!(carried, [Some(0), None, Some(6), None, Some(9)], "`A new bb `");
    }

    proptest! {
        #[test]
        fn the_change_between_two_texts_leads_from_one_to_the_other(old in "[aé€ ]{0,8}", new in "[aé€ ]{0,8}") {
            let mut texts = files(&[&old]);
            let change = Change::between(FileId(0), &old, &new);
            change.apply(&mut texts).unwrap();
            prop_assert_eq!(&*texts[0].text, &new);
            change.inverse().apply(&mut texts).unwrap();
            prop_assert_eq!(&*texts[0].text, &old);
        }

        #[test]
        fn so_does_the_change_by_words(old in "[aé \r\n]{0,12}", new in "[aé \r\n]{0,12}") {
            let mut texts = files(&[&old]);
            let change = Change::by_words(FileId(0), &old, &new);
            change.apply(&mut texts).unwrap();
            prop_assert_eq!(&*texts[0].text, &new);
            change.inverse().apply(&mut texts).unwrap();
            prop_assert_eq!(&*texts[0].text, &old);
        }
    }

    #[test]
    fn what_other_programs_change_leaves_the_rest_of_its_line() {
        let (old, new) = ("x\nSphere { r 1 }\ny\nBox { a 2 }\n", "Sphere { r 5 }\ny\nz\nBox { a 3 }\n");
        let change = Change::by_words(FileId(0), old, new);
        let at = |text: &str, word: &str| text.find(word).unwrap();
        for word in ["y\n", "Box"] {
            assert_eq!(change.carry(FileId(0), at(old, word)), Some(at(new, word)), "{word}");
        }
        let change =
            Change::by_words(FileId(0), "Sphere { r 1 }\nBox { a 2 }\n", "Sphere { r 5 }\nBox { a 3 }\n");
        assert_eq!(change.replacements.len(), 2);
    }
}
