//! Keys of values: which values have them, and what they are.
//!
//! A [`KeyRow`] is a block of keys in the text. It is known again after an edit by its [`KeyOwner`]: the numbers it
//! gives values to, or the name that `let` gives to its value.

use std::collections::HashSet;
use std::ops::Range;

use kajo_math::keyed::{Interpolation, Outside};
use kajo_scene::{Item, KeysOwner, WrittenKeys};

use super::tree::Tree;
use super::{Document, FileId, Node, NodeId};

/// The operation that has keys of its own, each with operations.
const MOTION: &str = "Motion";

/// The word of one of them.
const KEY: &str = "key";

/// What keys give values to.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum KeyOwner {
    /// Numbers of a value of a block.
    Field {
        /// The block.
        node: NodeId,
        /// The word of the value; empty for numbers of the block's own.
        key: String,
        /// Which of several with this word, from 0.
        nth: usize,
        /// The first of its numbers that these keys say, from 0.
        first: usize,
    },
    /// A value that `let` names.
    Named {
        /// The file it stands in.
        file: FileId,
        /// Its name.
        name: String,
        /// Which of several with keys and this name in the file, from 0.
        nth: usize,
    },
    /// A `Motion`, whose keys are operations.
    Motion(NodeId),
}

impl KeyOwner {
    /// The block that it is about, if there is one.
    pub fn node(&self) -> Option<NodeId> {
        match self {
            KeyOwner::Field { node, .. } | KeyOwner::Motion(node) => Some(*node),
            KeyOwner::Named { .. } => None,
        }
    }
}

/// A block of keys.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyRow {
    /// What they give values to.
    pub owner: KeyOwner,
    /// What that is called: the words of the block and of the value.
    pub name: String,
    /// The bytes of all of it.
    pub span: (FileId, Range<usize>),
    /// How values go from key to key.
    pub interpolation: Interpolation,
    /// What holds before the first key and after the last.
    pub outside: Outside,
    /// The keys, in the order of time.
    pub keys: Vec<Key>,
    /// Whether it stands in a `repeat`: what is done to it is done to all turns.
    pub is_repeated: bool,
}

/// A value at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// When it is: the number of a frame, with a fraction where it falls between two.
    pub frame: f64,
    /// The same in seconds.
    pub seconds: f64,
    /// Its values; none for those of a `Motion`.
    pub values: Vec<f64>,
}

/// How far two times may be apart and be one, in frames.
const SAME: f64 = 1e-4;

impl Key {
    /// Whether it is at this frame.
    pub fn is_at(&self, frame: f64) -> bool {
        (self.frame - frame).abs() < SAME
    }
}

impl KeyRow {
    /// The index of the key at a frame, if there is one.
    pub fn key_at(&self, frame: f64) -> Option<usize> {
        self.keys.iter().position(|key| key.is_at(frame))
    }
}

impl Document {
    /// All keys of the texts, those of each value as a row, in the order of the text.
    pub fn key_rows(&self) -> Vec<KeyRow> {
        let tree = &self.tree;
        let mut seen: HashSet<(FileId, usize)> = HashSet::new();
        let mut rows = Vec::new();
        for keyed in tree.desc.keyed() {
            let (file, range) = tree.range_of(keyed.place);
            // One file may be included several times.
            if seen.insert((file, range.start)) {
                rows.extend(tree.row(keyed, &rows));
            }
        }
        for node in self.outline().nodes().iter().filter(|node| &*node.keyword == MOTION) {
            if seen.insert((node.file, node.span.start)) {
                rows.extend(tree.motion_row(node));
            }
        }
        rows.sort_by_key(|row| (row.span.0, row.span.1.start));
        rows
    }
}

impl Tree {
    fn row(&self, keyed: &WrittenKeys, others: &[KeyRow]) -> Option<KeyRow> {
        let (owner, name) = match keyed.owner {
            KeysOwner::Item { item, first } => self.field_of(item, first as usize, keyed)?,
            KeysOwner::Value(index) => {
                let name = self.desc.named_values().nth(index as usize)?.0;
                let file = self.file_of(keyed.place.source);
                let is_same = |row: &&KeyRow| matches!(&row.owner, KeyOwner::Named { file: f, name: n, .. } if *f == file && n == name);
                let nth = others.iter().filter(is_same).count();
                let owner = KeyOwner::Named { file, name: name.to_owned(), nth };
                (owner, format!("let {name}"))
            }
        };
        let key = |key: &kajo_scene::WrittenKey| {
            let values = key.values.iter().map(|(value, _)| *value).collect();
            self.key(key.time, values)
        };
        Some(KeyRow {
            owner,
            name,
            span: self.range_of(keyed.place),
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
