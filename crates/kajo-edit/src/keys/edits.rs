//! Keys set, moved and taken out, as edits of the text.
//!
//! A key is a piece of text: its time, a colon and its values; of a `Motion` it is the whole block. Pieces change places where
//! the order of time asks for it, what stands between them stays where it is, and of a number that stays no byte changes.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use kajo_core::schema::{FieldKind, FieldValue, Kind, number_text};
use kajo_math::keyed::{Interpolation, Outside};
use kajo_scene::{Item, KeysOwner, Span, TokenKind, apply_edits, tokens};

use super::{Block, KEY, KeyOwner, MOTION, SAME, Written};
use crate::fields::{fields_of, is_same_number};
use crate::tree::Tree;
use crate::{Document, EditRefused, FileId, Node, NodeId, TextEdit, layout};

/// Whether a value has keys, or could have some.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Keying {
    /// It has none, and could.
    Still,
    /// It has some.
    Keyed {
        /// Whether one of them is at the frame on show: that one is edited, and otherwise a new one is set.
        at_frame: bool,
    },
    /// It cannot have any that are set here, and why, for people.
    Fixed(String),
}

/// Names that are looked at, at most: every turn of a `repeat` has one.
const NAMES: usize = 1000;

/// Digits behind the point of a time that is written.
const DIGITS: usize = 12;

impl Document {
    /// Whether a value has keys, or could have some.
    ///
    /// * `nth`: which of several with this word
    pub fn keying(&self, id: NodeId, key: &str, nth: usize) -> Keying {
        self.node(id).map_or_else(
            || Keying::Fixed("it is no longer there".to_owned()),
            |node| self.tree.keying(node, key, nth),
        )
    }

    /// The keys that a value has at the frame on show, by their places in their rows.
    ///
    /// * `nth`: which of several with this word
    pub fn keys_here(&self, id: NodeId, key: &str, nth: usize) -> Vec<(KeyOwner, usize)> {
        let item = self.node(id).and_then(|node| self.tree.value_item(node, key, Some(nth)));
        let blocks = item.map_or_else(Vec::new, |item| self.tree.blocks_of(item));
        let here = |(_, block): (Range<usize>, Block<'_>)| {
            let index = block.row.key_at(block.row.within(self.tree.now()))?;
            Some((block.row.owner, index))
        };
        blocks.into_iter().filter_map(here).collect()
    }
}

impl Tree {
    fn keying(&self, node: &Node, key: &str, nth: usize) -> Keying {
        let item = self.value_item(node, key, Some(nth));
        let blocks = item.map_or_else(Vec::new, |item| self.blocks_of(item));
        if !blocks.is_empty() {
            let is_at = |block: &Block<'_>| block.row.key_at(block.row.within(self.now())).is_some();
            return Keying::Keyed { at_frame: blocks.iter().all(|(_, block)| is_at(block)) };
        }
        match self.refusal(node, key, item) {
            Some(why) => Keying::Fixed(why),
            None => Keying::Still,
        }
    }

    /// Why a value cannot have keys, if so.
    fn refusal(&self, node: &Node, key: &str, item: Option<Item<'_>>) -> Option<String> {
        let is_number = match kind_of_field(node, key) {
            Some(
                FieldKind::Flag
                | FieldKind::Choice(_)
                | FieldKind::File
                | FieldKind::Text
                | FieldKind::Picture
                | FieldKind::Function
                | FieldKind::Material
                | FieldKind::Integrator,
            ) => item.is_some_and(|item| item.numbers().len() > 0 && item.word().is_none()),
            _ => item.is_none_or(|item| item.numbers().len() > 0),
        };
        if node.kind == Kind::Animation {
            return Some("the frames of a scene are the same at all times".to_owned());
        }
        if &*node.keyword == "Model" && key == "animation" {
            return Some(
                "the keys of a model's own animation are in its file; `animationTime` can have some"
                    .to_owned(),
            );
        }
        if !is_number {
            return Some("only numbers can have keys".to_owned());
        }
        let timed = item?
            .numbers()
            .map(|(_, span)| self.desc.sources().text(span))
            .find(|text| self.is_timed(text))?;
        Some(format!("it is written as `{timed}`: change that in the text"))
    }

    /// Whether an expression names the time, or a value that changes with it.
    fn is_timed(&self, expression: &str) -> bool {
        if !expression.contains(|c: char| c.is_ascii_alphabetic()) {
            return false;
        }
        let definitions = self.definitions();
        let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
        // Each name is followed once, however often others stand for it.
        let (mut followed, mut texts) = (HashSet::new(), vec![expression]);
        while let Some(text) = texts.pop() {
            for word in text.split(|c| !is_letter(c)).filter(|word| !word.is_empty()) {
                if matches!(word, "time" | "frame" | "keys") {
                    return true;
                }
                if followed.insert(word) {
                    texts.extend(definitions.get(word).into_iter().flatten());
                }
            }
        }
        false
    }

    /// What values that are no plain numbers are written as, by their names: what stands behind each, to the end of its line, as far as
    /// there is no block.
    fn definitions(&self) -> HashMap<&str, Vec<&str>> {
        let mut known = HashSet::new();
        let mut definitions: HashMap<&str, Vec<&str>> = HashMap::new();
        // Those of a repeated block are named once for each turn.
        let values = self.desc.named_values().take(NAMES).filter(|(_, value)| value.literal.is_none());
        for (name, value) in values {
            let (file, range) = self.range_of(value.name);
            if known.insert((file, range.end)) {
                let behind = &self.text(file)[range.end..];
                let end = behind.find(['\n', '\r', '{', '}']).unwrap_or(behind.len());
                definitions.entry(name).or_default().push(&behind[..end]);
            }
        }
        definitions
    }

    /// The frame on show.
    fn now(&self) -> f64 {
        self.desc.clock().frame() as f64
    }

    /// The blocks of keys that say numbers of an item, each with the bytes of these numbers: the keys themselves, or the name of
    /// a value that has them.
    fn blocks_of(&self, item: Item<'_>) -> Vec<(Range<usize>, Block<'_>)> {
        let mut places: Vec<Span> = item.numbers().map(|(_, span)| span).collect();
        places.dedup();
        let block = |place: Span| Some((place.range(), self.block_at(place)?));
        if self.desc.keyed().is_empty() { Vec::new() } else { places.into_iter().filter_map(block).collect() }
    }

    /// The keys that a number is written as, or that the value has whose name it is written as.
    fn block_at(&self, place: Span) -> Option<Block<'_>> {
        let at = self.range_of(place);
        if let Some(keyed) = self.desc.keyed().iter().find(|keyed| self.range_of(keyed.span) == at) {
            return self.block(keyed, &[]);
        }
        let text = self.desc.sources().text(place);
        let values = self.desc.keyed().iter().filter_map(|keyed| match keyed.owner {
            KeysOwner::Value(index) => Some((keyed, self.desc.named_values().nth(index as usize)?)),
            KeysOwner::Item { .. } => None,
        });
        let same: Vec<_> = values.filter(|(_, (name, _))| *name == text).collect();
        if same.is_empty() {
            return None;
        }
        let (_, named) = self.desc.expressions().find(|(span, _)| *span == place)?;
        let (keyed, _) =
            same.into_iter().rfind(|(_, (_, value))| Some(value.name) == named.map(|named| named.name))?;
        let span = self.range_of(keyed.span);
        self.key_blocks().into_iter().find(|block| block.row.span == span)
    }

    /// Whether any number of an item has keys.
    pub(crate) fn has_keys(&self, item: Item<'_>) -> bool {
        self.blocks_of(item).iter().any(|(number, block)| block.row.span.1 == *number)
    }

    fn block_of(&self, owner: &KeyOwner) -> Result<Block<'_>, EditRefused> {
        let gone = || EditRefused::new("these keys are no longer there");
        self.key_blocks().into_iter().find(|block| block.row.owner == *owner).ok_or_else(gone)
    }

    /// Gives numbers to an item: those that have keys get one at the frame on show.
    pub(crate) fn set_values_of(
        &self,
        item: Item<'_>,
        value: &FieldValue,
    ) -> Result<Vec<TextEdit>, EditRefused> {
        let blocks = self.blocks_of(item);
        if blocks.is_empty() {
            return Ok(self.replace_values(item, value));
        }
        let numbers: Vec<(f64, Range<usize>)> = item.numbers().map(|(n, span)| (n, span.range())).collect();
        let same_word = item.word().map(|word| word.text().into_owned()) == value.word;
        if numbers.len() != value.numbers.len() || !same_word {
            return Err(EditRefused::new(format!(
                "`{}` has keys, and those have other numbers: take it out first",
                item.keyword()
            )));
        }
        let file = self.range(item).0;
        let mut edits = Vec::new();
        let mut at = 0;
        for run in numbers.chunk_by(|a, b| a.1 == b.1) {
            let new = &value.numbers[at..at + run.len()];
            at += run.len();
            let is_same = run.iter().zip(new).all(|((old, _), new)| is_same_number(*old, *new));
            match blocks.iter().find(|(number, _)| *number == run[0].1) {
                _ if is_same => {}
                Some((_, block)) => edits.extend(self.set_key(block, new)?),
                None => {
                    let changed = run.iter().zip(new).filter(|((old, _), new)| !is_same_number(*old, **new));
                    edits.extend(changed.map(|((_, range), new)| TextEdit {
                        file,
                        range: range.clone(),
                        new: number_text(*new),
                    }));
                }
            }
        }
        once(edits)
    }

    /// Gives values to the key at the frame on show, or sets one there.
    fn set_key(&self, block: &Block<'_>, values: &[f64]) -> Result<Vec<TextEdit>, EditRefused> {
        let (row, file) = (&block.row, block.row.span.0);
        let frame = row.within(self.now());
        let Written::Values(keyed) = block.written else { return Err(not_of_a_motion()) };
        if let Some(index) = row.key_at(frame) {
            let mut edits = Vec::new();
            for ((old, range), &new) in keyed.keys[index].values.iter().zip(values) {
                if !is_same_number(*old, new) {
                    self.check_literal(file, range)?;
                    edits.push(TextEdit { file, range: range.clone(), new: number_text(new) });
                }
            }
            return Ok(edits);
        }
        let numbers: Vec<String> = values.iter().map(|&value| number_text(single(value))).collect();
        let piece = format!("{}: {}", self.time_text(frame), numbers.join(" "));
        Ok(vec![self.inserted_key(block, frame, &piece)])
    }

    /// Sets a key at the frame on show that changes nothing there.
    pub(crate) fn insert_key(&self, owner: &KeyOwner) -> Result<Vec<TextEdit>, EditRefused> {
        let block = self.block_of(owner)?;
        let frame = block.row.within(self.now());
        if block.row.key_at(frame).is_some() {
            return Err(EditRefused::new("there is a key at this frame already"));
        }
        match (&block.written, owner) {
            (Written::Motion, KeyOwner::Motion(id)) => {
                let node = self.outline.get(*id).ok_or_else(|| EditRefused::new("it is no longer there"))?;
                let piece = self.motion_key_text(node, frame)?;
                Ok(vec![self.inserted_key(&block, frame, &piece)])
            }
            _ => self.set_key(&block, &block.row.values_at(frame)),
        }
    }

    /// Puts the text of a key where its time asks for it.
    fn inserted_key(&self, block: &Block<'_>, frame: f64, piece: &str) -> TextEdit {
        let file = block.row.span.0;
        let text = self.text(file);
        let before = block.row.keys.iter().rposition(|key| key.frame < frame);
        let (at, new) = match before {
            Some(index) => layout::after(text, &block.pieces[index].0, piece),
            None => layout::before(text, block.pieces[0].0.start, piece),
        };
        TextEdit::insert(file, at, new)
    }

    /// Sets keys at the frame on show for all numbers of a value, which may have none yet.
    pub(crate) fn key_field(
        &self,
        node: &Node,
        key: &str,
        nth: Option<usize>,
        value: Option<&FieldValue>,
    ) -> Result<Vec<TextEdit>, EditRefused> {
        let item = self.value_item(node, key, nth);
        let blocks = item.map_or_else(Vec::new, |item| self.blocks_of(item));
        if blocks.is_empty()
            && let Some(why) = self.refusal(node, key, item)
        {
            return Err(EditRefused::new(why));
        }
        let mode = match kind_of_field(node, key) {
            Some(FieldKind::Whole { .. } | FieldKind::Wholes(_) | FieldKind::ChoiceAndWhole(..)) => "step ",
            _ => "",
        };
        let Some(item) = item else {
            let value = value.cloned().unwrap_or_else(|| self.start(node, key));
            if value.word.is_some() || value.numbers.is_empty() {
                return Err(EditRefused::new("only numbers can have keys"));
            }
            return self.insert_text(node, key, &self.keys_text(mode, &value.text()));
        };
        let numbers: Vec<(f64, Range<usize>)> = item.numbers().map(|(n, span)| (n, span.range())).collect();
        let new =
            value.map_or_else(|| numbers.iter().map(|(n, _)| *n).collect(), |value| value.numbers.clone());
        if new.len() != numbers.len() {
            return Err(EditRefused::new("keys have as many numbers as the value"));
        }
        let file = self.range(item).0;
        let block_at = |range: &Range<usize>| blocks.iter().find(|(number, _)| number == range);
        let mut edits = Vec::new();
        let mut at = 0;
        // Numbers of one block of keys, or numbers that stand side by side without any.
        for run in numbers.chunk_by(|a, b| match (block_at(&a.1), block_at(&b.1)) {
            (Some(_), _) | (_, Some(_)) => a.1 == b.1,
            (None, None) => true,
        }) {
            let new = &new[at..at + run.len()];
            at += run.len();
            match block_at(&run[0].1) {
                Some((_, block)) => edits.extend(self.set_key(block, new)?),
                None => edits.push(self.first_key(file, run, new, mode)?),
            }
        }
        once(edits)
    }

    /// Keys with one at the frame on show.
    fn keys_text(&self, mode: &str, numbers: &str) -> String {
        format!("keys {mode}{{ {}: {numbers} }}", self.time_text(self.now()))
    }

    /// Puts keys in the place of numbers that stand side by side.
    fn first_key(
        &self,
        file: FileId,
        run: &[(f64, Range<usize>)],
        new: &[f64],
        mode: &str,
    ) -> Result<TextEdit, EditRefused> {
        let text = self.text(file);
        if let Some((_, timed)) = run.iter().find(|(_, range)| self.is_timed(&text[range.clone()])) {
            return Err(written_so(&text[timed.clone()]));
        }
        let range = run[0].1.start..run[run.len() - 1].1.end;
        let numbers = self.with_numbers(file, run, new)?;
        Ok(TextEdit { file, range, new: self.keys_text(mode, &numbers) })
    }

    /// The text of numbers that stand side by side, with other values where these differ.
    fn with_numbers(
        &self,
        file: FileId,
        run: &[(f64, Range<usize>)],
        new: &[f64],
    ) -> Result<String, EditRefused> {
        // Such as `#ff8000`, which stands for three.
        if run.windows(2).any(|pair| pair[0].1 == pair[1].1) {
            return Ok(new.iter().map(|&value| number_text(value)).collect::<Vec<_>>().join(" "));
        }
        let start = run[0].1.start;
        let text = &self.text(file)[start..run[run.len() - 1].1.end];
        let differing = run.iter().zip(new).filter(|((old, _), new)| !is_same_number(*old, **new));
        let edits: Vec<_> = differing
            .map(|((_, range), new)| (range.start - start..range.end - start, number_text(*new)))
            .collect();
        Ok(apply_edits(text, &edits)?)
    }

    /// Moves keys by a number of frames, onto whole ones. A key that stands where one comes to gives way to it.
    pub(crate) fn move_keys(
        &self,
        keys: &[(KeyOwner, usize)],
        frames: f64,
    ) -> Result<Vec<TextEdit>, EditRefused> {
        let mut edits = Vec::new();
        for (owner, moved) in by_owner(keys) {
            let block = self.block_of(owner)?;
            edits.extend(self.moved_within(&block, &moved, frames)?);
        }
        Ok(edits)
    }

    fn moved_within(
        &self,
        block: &Block<'_>,
        moved: &[usize],
        frames: f64,
    ) -> Result<Vec<TextEdit>, EditRefused> {
        let (file, text) = (block.row.span.0, self.text(block.row.span.0));
        let mut there: Vec<f64> = Vec::new();
        // When each key will be, and its text.
        let mut pieces: Vec<(f64, usize, String)> = Vec::new();
        for (index, key) in block.row.keys.iter().enumerate() {
            let (piece, time) = &block.pieces[index];
            if !moved.contains(&index) {
                pieces.push((key.frame, index, text[piece.clone()].to_owned()));
                continue;
            }
            self.check_literal(file, time)?;
            let frame = (key.frame + frames).round();
            if there.contains(&frame) {
                return Err(EditRefused::new(format!("two keys cannot both be at frame {frame}")));
            }
            there.push(frame);
            let within = time.start - piece.start..time.end - piece.start;
            let new = apply_edits(&text[piece.clone()], &[(within, self.time_text(frame))])?;
            pieces.push((frame, index, new));
        }
        let gives_way = |&(frame, index, _): &(f64, usize, String)| {
            !moved.contains(&index) && there.iter().any(|&other| (frame - other).abs() < SAME)
        };
        let gone: Vec<usize> = pieces.iter().filter(|piece| gives_way(piece)).map(|piece| piece.1).collect();
        pieces.retain(|piece| !gone.contains(&piece.1));
        check_rest(block, pieces.len())?;
        pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
        let places = (0..block.pieces.len()).filter(|index| !gone.contains(index));
        let mut edits = self.without_pieces(block, &gone);
        for (place, (_, index, new)) in places.zip(pieces) {
            let (piece, time) = &block.pieces[place];
            if text[piece.clone()] == *new {
                continue;
            }
            edits.push(match place == index {
                // Nothing but its time.
                true => {
                    let rest = piece.end - time.end;
                    let new = new[time.start - piece.start..new.len() - rest].to_owned();
                    TextEdit { file, range: time.clone(), new }
                }
                false => TextEdit { file, range: piece.clone(), new },
            });
        }
        Ok(edits)
    }

    /// Takes keys out. A value whose keys all go is from then on what it is at the frame on show.
    pub(crate) fn delete_keys(&self, keys: &[(KeyOwner, usize)]) -> Result<Vec<TextEdit>, EditRefused> {
        let mut edits = Vec::new();
        for (owner, gone) in by_owner(keys) {
            let block = self.block_of(owner)?;
            let rest = (0..block.pieces.len()).filter(|index| !gone.contains(index)).count();
            if rest == 0 && matches!(block.written, Written::Values(_)) {
                let values = block.row.values_at(self.now());
                let numbers: Vec<String> = values.into_iter().map(|v| number_text(single(v))).collect();
                let (file, range) = block.row.span.clone();
                edits.push(TextEdit { file, range, new: numbers.join(" ") });
                continue;
            }
            check_rest(&block, rest)?;
            edits.extend(self.without_pieces(&block, &gone));
        }
        Ok(edits)
    }

    /// Takes the text of keys out.
    fn without_pieces(&self, block: &Block<'_>, gone: &[usize]) -> Vec<TextEdit> {
        let file = block.row.span.0;
        let mut edits: Vec<TextEdit> = Vec::new();
        for (index, (piece, _)) in block.pieces.iter().enumerate() {
            if !gone.contains(&index) {
                continue;
            }
            let range = layout::removal(self.text(file), piece);
            match edits.last_mut().filter(|last| last.range.end >= range.start) {
                Some(last) => last.range.end = last.range.end.max(range.end),
                None => edits.push(TextEdit { file, range, new: String::new() }),
            }
        }
        edits
    }

    /// Says how values go from key to key, and what holds outside of the keys; `None` for what stays.
    pub(crate) fn set_key_modes(
        &self,
        owner: &KeyOwner,
        interpolation: Option<Interpolation>,
        outside: Option<Outside>,
    ) -> Result<Vec<TextEdit>, EditRefused> {
        let block = self.block_of(owner)?;
        let Written::Values(_) = block.written else {
            return Err(EditRefused::new(
                "a `Motion` goes steadily from key to key, and stands still outside of them",
            ));
        };
        let (file, span) = block.row.span.clone();
        let text = &self.text(file)[span.clone()];
        let head = tokens(text).take_while(|token| token.kind != TokenKind::OpenBrace);
        let words: Vec<Range<usize>> =
            head.filter(|token| token.kind == TokenKind::Word).map(|token| token.range()).collect();
        let behind = words.first().map_or(0, |keys| keys.end);
        let interpolation = interpolation.filter(|new| *new != block.row.interpolation);
        let outside = outside.filter(|new| *new != block.row.outside);
        let mut edits = Vec::new();
        let mut inserted = String::new();
        let mut set = |names: Vec<(&'static str, bool)>| {
            let Some((name, _)) = names.iter().find(|(_, is_new)| *is_new) else { return };
            let is_of_these =
                |range: &&Range<usize>| names.iter().any(|(name, _)| text[(*range).clone()] == **name);
            match words.iter().skip(1).rfind(is_of_these) {
                Some(word) => edits.push(TextEdit {
                    file,
                    range: span.start + word.start..span.start + word.end,
                    new: (*name).to_owned(),
                }),
                None => inserted.push_str(&format!(" {name}")),
            }
        };
        set(Interpolation::NAMES.iter().map(|(name, mode)| (*name, Some(*mode) == interpolation)).collect());
        set(Outside::NAMES.iter().map(|(name, mode)| (*name, Some(*mode) == outside)).collect());
        if !inserted.is_empty() {
            edits.push(TextEdit::insert(file, span.start + behind, inserted));
        }
        Ok(edits)
    }

    /// The time of a frame in seconds, with as many digits as it takes to be that of the frame.
    pub(super) fn time_text(&self, frame: f64) -> String {
        let clock = self.desc.clock();
        let seconds = (frame - clock.first_frame() as f64) / clock.fps();
        let meant = clock.in_frames(seconds);
        let rounded = (0..=DIGITS).map(|digits| format!("{seconds:.digits$}"));
        let exact = rounded
            .into_iter()
            .find(|text| text.parse().is_ok_and(|read: f64| clock.in_frames(read) == meant));
        let text = exact.unwrap_or_else(|| number_text(seconds));
        if text == "-0" { "0".to_owned() } else { text }
    }

    /// Refuses what is no plain number.
    fn check_literal(&self, file: FileId, range: &Range<usize>) -> Result<(), EditRefused> {
        let written = &self.text(file)[range.clone()];
        match written.parse::<f64>() {
            Ok(_) => Ok(()),
            Err(_) => Err(written_so(written)),
        }
    }

    /// The pieces of text of the keys of a `Motion`, each with its time.
    pub(super) fn motion_pieces(&self, node: &Node) -> Vec<(Range<usize>, Range<usize>)> {
        debug_assert_eq!(&*node.keyword, MOTION);
        let time = |item: &Item<'_>| item.numbers().next().map(|(_, span)| span.range());
        self.motion_keys(node).filter_map(|item| Some((item.span().range(), time(&item)?))).collect()
    }
}

fn kind_of_field(node: &Node, key: &str) -> Option<FieldKind> {
    fields_of(node).find(|spec| spec.key == key).map(|spec| spec.kind)
}

/// A `Motion` has two keys at least, and a value one.
fn check_rest(block: &Block<'_>, rest: usize) -> Result<(), EditRefused> {
    let is_enough = rest >= 2 || matches!(block.written, Written::Values(_));
    is_enough.then_some(()).ok_or_else(|| {
        EditRefused::new(format!("a `{MOTION}` has two keys at least, each a `{KEY}`: take out all of it"))
    })
}

fn not_of_a_motion() -> EditRefused {
    EditRefused::new(format!("the keys of a `{MOTION}` are blocks of operations: write them in the text"))
}

/// Keys by what they belong to.
fn by_owner(keys: &[(KeyOwner, usize)]) -> Vec<(&KeyOwner, Vec<usize>)> {
    let mut all: Vec<(&KeyOwner, Vec<usize>)> = Vec::new();
    for (owner, index) in keys {
        match all.iter_mut().find(|(other, _)| *other == owner) {
            Some((_, indices)) => indices.push(*index),
            None => all.push((owner, vec![*index])),
        }
    }
    all
}

fn written_so(text: &str) -> EditRefused {
    EditRefused::new(format!("it is written as `{text}`: change that in the text"))
}

/// Edits of which some may be one, for a name that stands several times.
///
/// # Errors
/// When one key would have to be two.
fn once(edits: Vec<TextEdit>) -> Result<Vec<TextEdit>, EditRefused> {
    let mut all: Vec<TextEdit> = Vec::with_capacity(edits.len());
    for edit in edits {
        match all.iter().find(|other| other.file == edit.file && other.range == edit.range) {
            Some(other) if other.new == edit.new => {}
            Some(_) => {
                return Err(EditRefused::new(
                    "one value with keys stands for several numbers, which would differ",
                ));
            }
            None => all.push(edit),
        }
    }
    Ok(all)
}

/// In the precision of scenes.
fn single(value: f64) -> f64 {
    if value.fract() == 0.0 { value } else { f64::from(value as f32) }
}
