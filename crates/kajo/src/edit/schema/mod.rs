//! What the blocks of the language are, and which fields they have, for those who show and edit them.
//!
//! The compiler alone decides what a scene means. These tables say the same for people: the type and range of each
//! value, what holds when it is absent, and a few words about it. Tests ask the compiler for every key it knows in every
//! block, so that the two cannot differ.

mod rules;
mod surroundings;

use kajo_core::compile;
pub use kajo_core::schema::{Absent, Around, Block, FieldKind, FieldSpec, Kind};

use kajo_core::schema::Constant;

use super::FieldValue;

const ANY: f64 = f64::MAX;

/// A field that may be absent, with its default.
const fn field(key: &'static str, kind: FieldKind, default: &'static str, about: &'static str) -> FieldSpec {
    FieldSpec { absent: Absent::Value(Constant::Text(default)), about, ..FieldSpec::new(key, kind) }
}

/// A field whose default depends on what is around it.
const fn ruled(
    key: &'static str,
    kind: FieldKind,
    value: fn(&Around<'_>) -> Option<FieldValue>,
    means: &'static str,
    about: &'static str,
) -> FieldSpec {
    FieldSpec { absent: Absent::Rule { value, means }, about, ..FieldSpec::new(key, kind) }
}

/// A field whose absence is another thing than any value.
const fn unlike(
    key: &'static str,
    kind: FieldKind,
    means: &'static str,
    start: &'static str,
    about: &'static str,
) -> FieldSpec {
    FieldSpec { absent: Absent::Nothing { means, start }, about, ..FieldSpec::new(key, kind) }
}

/// A field with a name that may be absent: then there is no such thing.
const fn option(key: &'static str, kind: FieldKind, about: &'static str) -> FieldSpec {
    unlike(key, kind, "none", "", about)
}

/// A field that must be there.
const fn required(key: &'static str, kind: FieldKind, about: &'static str) -> FieldSpec {
    FieldSpec { about, ..FieldSpec::new(key, kind) }
}

const fn number() -> FieldKind {
    FieldKind::Number { min: -ANY, max: ANY }
}

const fn at_least(min: f64) -> FieldKind {
    FieldKind::Number { min, max: ANY }
}

const fn between(min: f64, max: f64) -> FieldKind {
    FieldKind::Number { min, max }
}

const fn whole(min: f64, max: f64) -> FieldKind {
    FieldKind::Whole { min, max }
}

/// The group of lights that something is seen in.
const LIGHT_GROUP: FieldSpec = option("group", FieldKind::Text, "name of the lights it is seen among");

/// Above zero.
const POSITIVE: FieldKind = at_least(f64::MIN_POSITIVE);

/// A block without a reader beside it.
macro_rules! block {
    ($keyword:expr, $kind:expr, $fields:expr $(,)?) => {
        Block { keyword: $keyword, kind: $kind, about: "", groups: &[$fields] }
    };
}

use block;

/// All kinds of blocks that have fields or hold others.
fn blocks() -> impl Iterator<Item = &'static Block> {
    compile::blocks().chain(surroundings::BLOCKS)
}

/// What a block with this keyword is, within a block of kind `parent`.
pub(super) fn kind_of(keyword: &str, parent: Option<Kind>) -> Kind {
    match parent {
        Some(Kind::Lights) => Kind::Light,
        Some(Kind::Materials) => Kind::Material,
        Some(parent) if !parent.holds_objects() => Kind::Part,
        _ => blocks().find(|block| block.keyword == keyword).map_or(Kind::Part, |block| block.kind),
    }
}

/// The description of the block with this keyword.
pub fn block_of(keyword: &str) -> Option<&'static Block> {
    blocks().find(|block| block.keyword == keyword)
}

/// The fields that a block with this keyword may have.
pub fn fields_of(keyword: &str) -> impl Iterator<Item = &'static FieldSpec> + Clone + use<> {
    block_of(keyword).into_iter().flat_map(Block::fields)
}

/// All spellings of a key in a block with this keyword, the usual one first.
pub(super) fn spellings_of(keyword: &str, key: &str) -> impl Iterator<Item = &'static str> + use<> {
    block_of(keyword).into_iter().flat_map(|block| block.spellings_of(key)).collect::<Vec<_>>().into_iter()
}

/// The words of all blocks of a kind, in the order in which they are offered.
pub fn keywords_of(kind: Kind) -> impl Iterator<Item = &'static str> {
    blocks().filter(move |block| block.kind == kind).map(|block| block.keyword)
}

#[cfg(test)]
mod tests;
