//! Keys as they are written: for whoever shows them, and changes the text.

use std::ops::Range;

use kajo_math::keyed::{Interpolation, Outside};

use crate::source::Span;

/// A block of keys in the text.
///
/// What stands in a `repeat` is there once, as in its first turn.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenKeys {
    /// From the word `keys` to the closing brace.
    pub span: Span,
    /// What the numbers belong to.
    pub owner: KeysOwner,
    /// How numbers go from key to key.
    pub interpolation: Interpolation,
    /// What holds before the first key and after the last.
    pub outside: Outside,
    /// The keys, in the order of time; at least one.
    pub keys: Vec<WrittenKey>,
    /// Whether it stands in a `repeat`, so that one text is read several times.
    pub is_repeated: bool,
}

/// What keys give numbers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeysOwner {
    /// Some of the numbers of an item.
    Item {
        /// The item's number.
        item: u32,
        /// The first of these numbers, among all of the item, from 0.
        first: u32,
    },
    /// A value that `let` names, by its place in [`SceneDesc::named_values`](crate::SceneDesc::named_values).
    Value(u32),
}

/// A key in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenKey {
    /// Its time, in seconds.
    pub time: f64,
    /// The bytes of its time, without the colon.
    pub time_place: Range<usize>,
    /// Its values, each with its bytes; as many as those of the first key, and at least one.
    pub values: Vec<(f64, Range<usize>)>,
}
