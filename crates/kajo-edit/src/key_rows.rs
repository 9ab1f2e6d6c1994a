//! Keys as rows: for each value the times at which it has one.

use std::ops::Range;

use kajo_math::keyed::{Interpolation, KeyedNumbers, Outside};

use super::{FileId, NodeId};

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
    /// Whether it is a value with this name.
    pub(super) fn is_named(&self, of: FileId, word: &str) -> bool {
        matches!(self, KeyOwner::Named { file, name, .. } if *file == of && name == word)
    }

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
pub(super) const SAME: f64 = 1e-4;

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

    /// The frame among the keys at which values are as at a frame: itself, but for keys that go on and on.
    pub fn within(&self, frame: f64) -> f64 {
        match (&*self.keys, self.outside) {
            (_, Outside::Hold) | ([] | [_], _) => frame,
            ([first, .., last], _) => self.outside.within(frame, [first.frame, last.frame]),
        }
    }

    /// The values at a frame; none of a `Motion`.
    pub fn values_at(&self, frame: f64) -> Vec<f64> {
        let keys: Vec<(f64, Vec<f64>)> =
            self.keys.iter().map(|key| (key.frame, key.values.clone())).collect();
        KeyedNumbers::new(&keys, self.interpolation, self.outside)
            .map_or_else(|_| Vec::new(), |curve| curve.at(frame))
    }
}
