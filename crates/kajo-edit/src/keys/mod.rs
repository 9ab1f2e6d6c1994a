//! Keys of values: which values have them, and what they are.
//!
//! A [`KeyRow`] is a block of keys in the text. It is known again after an edit by its [`KeyOwner`]: the numbers it
//! gives values to, or the name that `let` gives to its value.

mod edits;
mod motion_key;

use std::collections::HashSet;
use std::ops::Range;

use kajo_math::keyed::{Interpolation, Outside};
use kajo_scene::{Item, KeysOwner, WrittenKey, WrittenKeys};

use super::key_rows::{Key, KeyOwner, KeyRow, SAME};
use super::tree::Tree;
use super::{Document, FileId, Node};

pub use edits::Keying;

/// The operation that has keys of its own, each with operations.
const MOTION: &str = "Motion";

/// The word of one of them.
const KEY: &str = "key";

/// How the keys of a row are written.
#[derive(Clone, Copy)]
enum Written<'a> {
    /// As values at times.
    Values(&'a WrittenKeys),
    /// As the blocks of a `Motion`.
    Motion,
}

/// A row and its text.
struct Block<'a> {
    row: KeyRow,
    written: Written<'a>,
    /// The bytes of each key, and those of its time.
    pieces: Vec<(Range<usize>, Range<usize>)>,
}

impl Document {
    /// All keys of the texts, those of each value as a row, in the order of the text.
    pub fn key_rows(&self) -> Vec<KeyRow> {
        let mut rows: Vec<KeyRow> = self.tree.key_blocks().into_iter().map(|block| block.row).collect();
        rows.sort_by_key(|row| (row.span.0, row.span.1.start));
        rows
    }
}

impl Tree {
    /// All blocks of keys, each once.
    fn key_blocks(&self) -> Vec<Block<'_>> {
        let mut seen: HashSet<(FileId, usize)> = HashSet::new();
        let mut blocks: Vec<Block<'_>> = Vec::new();
        for keyed in self.desc.keyed() {
            let (file, range) = self.range_of(keyed.span);
            // One file may be included several times.
            if seen.insert((file, range.start)) {
                blocks.extend(self.block(keyed, &blocks));
            }
        }
        for node in self.outline.nodes().iter().filter(|node| &*node.keyword == MOTION) {
            if seen.insert((node.file, node.span.start))
                && let Some(row) = self.motion_row(node)
            {
                blocks.push(Block { row, written: Written::Motion, pieces: self.motion_pieces(node) });
            }
        }
        blocks
    }
}

impl Tree {
    /// * `others`: those of the blocks before, in the order of the text
    fn block<'a>(&'a self, keyed: &'a WrittenKeys, others: &[Block<'_>]) -> Option<Block<'a>> {
        let row = self.row(keyed, others)?;
        let end = |key: &WrittenKey| key.values.last().map_or(key.time_place.end, |(_, at)| at.end);
        let pieces = keyed.keys.iter().map(|key| (key.time_place.start..end(key), key.time_place.clone()));
        Some(Block { row, written: Written::Values(keyed), pieces: pieces.collect() })
    }

    fn row(&self, keyed: &WrittenKeys, others: &[Block<'_>]) -> Option<KeyRow> {
        let (owner, name) = match keyed.owner {
            KeysOwner::Item { item, first } => self.field_of(item, first as usize, keyed)?,
            KeysOwner::Value(index) => {
                let name = self.desc.named_values().nth(index as usize)?.0;
                let file = self.file_of(keyed.span.source);
                let is_same = |other: &&Block<'_>| other.row.owner.is_named(file, name);
                let nth = others.iter().filter(is_same).count();
                let owner = KeyOwner::Named { file, name: name.to_owned(), nth };
                (owner, format!("let {name}"))
            }
        };
        let key = |key: &WrittenKey| {
            let values = key.values.iter().map(|(value, _)| *value).collect();
            self.key(key.time, values)
        };
        Some(KeyRow {
            owner,
            name,
            span: self.range_of(keyed.span),
            interpolation: keyed.interpolation,
            outside: keyed.outside,
            keys: keyed.keys.iter().map(key).collect(),
            is_repeated: keyed.is_repeated,
        })
    }

    fn key(&self, seconds: f64, values: Vec<f64>) -> Key {
        let clock = self.desc.clock();
        Key { frame: clock.first_frame() as f64 + clock.in_frames(seconds), seconds, values }
    }

    /// The value that an item is, and its name for people.
    fn field_of(&self, item: u32, first: usize, keyed: &WrittenKeys) -> Option<(KeyOwner, String)> {
        let node = self.node_around(item)?;
        let owner = |key: &str, nth| KeyOwner::Field { node: node.id, key: key.to_owned(), nth, first };
        let value = self.desc.item(item)?;
        let block = match &node.name {
            Some(name) => name.to_string(),
            None => node.keyword.to_string(),
        };
        if node.item == item {
            return Some((owner("", 0), block));
        }
        let same = self.values_of(node).filter(|other| other.keyword() == value.keyword());
        let nth = same.take_while(|other| other.index() < item).count();
        let count = value.numbers().count();
        let width = keyed.keys.first().map_or(0, |key| key.values.len());
        let part = match (count, width) {
            (3, 1) => [" x", " y", " z"].get(first).copied().unwrap_or_default(),
            _ => "",
        };
        Some((owner(value.keyword(), nth), format!("{block} {}{part}", value.keyword())))
    }

    /// The keys of a `Motion`; `None` where it has none.
    fn motion_row(&self, node: &Node) -> Option<KeyRow> {
        let keys: Vec<Key> = self
            .motion_keys(node)
            .filter_map(|item| Some(self.key(item.numbers().next()?.0, Vec::new())))
            .collect();
        let holder = self.parent(node).map_or("", |parent| parent.name.as_deref().unwrap_or(&parent.keyword));
        (!keys.is_empty()).then(|| KeyRow {
            owner: KeyOwner::Motion(node.id),
            name: format!("{holder} motion"),
            span: (node.file, node.span.clone()),
            interpolation: Interpolation::Linear,
            outside: Outside::Hold,
            keys,
            is_repeated: false,
        })
    }

    /// The items of the keys of a `Motion`.
    fn motion_keys(&self, node: &Node) -> impl Iterator<Item = Item<'_>> {
        self.item(node).into_iter().flat_map(|item| item.children()).filter(|item| item.keyword() == KEY)
    }
}

#[cfg(test)]
mod tests;
