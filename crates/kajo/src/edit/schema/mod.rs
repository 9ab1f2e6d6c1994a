//! What the blocks of the language are, and which fields they have, for those who show and edit them.
//!
//! The compiler alone decides what a scene means. These tables say the same for people: the type and range of each
//! value, what holds when it is absent, and a few words about it. Tests ask the compiler for every key it knows in every
//! block, so that the two cannot differ.

mod lights;
mod materials;
mod rules;
mod shapes;
mod surroundings;

use super::FieldValue;
pub use rules::Around;

/// What a block describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// From where the picture is taken.
    Camera,
    /// How to render.
    Settings,
    /// What rays see that hit nothing.
    Background,
    /// What fills the air.
    Fog,
    /// The list of lights.
    Lights,
    /// One light.
    Light,
    /// The list of materials.
    Materials,
    /// One material.
    Material,
    /// Objects together.
    Group,
    /// Objects that are placed elsewhere.
    Define,
    /// Objects moved together.
    Transform,
    /// A definition put into its place.
    Instance,
    /// An object.
    Shape,
    /// A block within one of the others.
    Part,
}

impl Kind {
    /// Whether it takes part in the order of objects: all that may stand in a group, definitions aside.
    pub fn is_object(self) -> bool {
        matches!(self, Kind::Group | Kind::Transform | Kind::Instance | Kind::Shape)
    }

    /// Whether it may hold objects.
    pub fn holds_objects(self) -> bool {
        matches!(self, Kind::Group | Kind::Define | Kind::Transform)
    }
}

/// The type of a field's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldKind {
    /// A number within bounds; `f64::MIN` and `f64::MAX` stand for none.
    Number {
        /// The least.
        min: f64,
        /// The most.
        max: f64,
    },
    /// A whole number within bounds.
    Whole {
        /// The least.
        min: f64,
        /// The most.
        max: f64,
    },
    /// An angle in degrees within bounds.
    Angle {
        /// The least.
        min: f64,
        /// The most.
        max: f64,
    },
    /// A place: three numbers.
    Point,
    /// A direction of any length but zero, or an edge: three numbers.
    Vector,
    /// Linear red, green and blue.
    Color,
    /// Linear red, green and blue; or a file or `spectrum` with its numbers.
    Reflectance,
    /// Linear red, green and blue, one number for white, or a light's name with its factor.
    Emission,
    /// `on` or `off`.
    Flag,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// One of these words, and then at most one number.
    ChoiceAndNumber(&'static [&'static str]),
    /// One of these words, and then a whole number.
    ChoiceAndWhole(&'static [&'static str]),
    /// This many numbers, or fewer.
    Numbers(usize),
    /// This many whole numbers.
    Wholes(usize),
    /// The name of a file.
    File,
    /// A word or some text.
    Text,
    /// The name or number of a material.
    Material,
}

impl FieldKind {
    /// A value to begin with where nothing better is known; none for what has to be typed.
    pub(super) fn plain(self) -> FieldValue {
        match self {
            FieldKind::Number { min, max }
            | FieldKind::Whole { min, max }
            | FieldKind::Angle { min, max } => FieldValue::numbers([1f64.clamp(min, max)]),
            FieldKind::Point | FieldKind::Vector => FieldValue::numbers([0.0, 1.0, 0.0]),
            FieldKind::Color | FieldKind::Reflectance | FieldKind::Emission => FieldValue::numbers([1.0; 3]),
            FieldKind::Flag => FieldValue::flag(true),
            FieldKind::Choice(words)
            | FieldKind::ChoiceAndNumber(words)
            | FieldKind::ChoiceAndWhole(words) => {
                words.first().map_or_else(FieldValue::default, |word| FieldValue::word(*word))
            }
            FieldKind::Numbers(count) | FieldKind::Wholes(count) => {
                FieldValue::numbers(std::iter::repeat_n(1.0, count))
            }
            FieldKind::File | FieldKind::Text | FieldKind::Material => FieldValue::default(),
        }
    }
}

/// What holds while a field is absent.
#[derive(Clone, Copy, Debug)]
pub enum Absent {
    /// Nothing does: the block is an error without it.
    Required,
    /// This value, as it would be written.
    Value(&'static str),
    /// A value that depends on the rest of the block, or on the scene.
    Rule {
        /// The value; `None` where no value says what holds.
        value: fn(&Around<'_>) -> Option<FieldValue>,
        /// What holds in that case, in a word or two.
        means: &'static str,
    },
    /// Something that none of its values says.
    Nothing {
        /// What that is, in a word or two.
        means: &'static str,
        /// A usual value to begin with, as it would be written; empty for text that has to be typed.
        start: &'static str,
    },
}

/// What is known of a field before a scene is looked at.
#[derive(Clone, Copy, Debug)]
pub struct FieldSpec {
    /// The word it is written by.
    pub key: &'static str,
    /// The type of its value.
    pub kind: FieldKind,
    /// What holds while it is absent.
    pub absent: Absent,
    /// A field without which it says nothing, or is an error.
    pub needs: Option<&'static str>,
    /// Fields beside which it is an error.
    pub excludes: &'static [&'static str],
    /// The key whose other spelling this is: the two are one field.
    pub same_as: Option<&'static str>,
    /// A field that is an error without this one, and this one without it: both are set, and taken out, together.
    pub pair: Option<&'static str>,
    /// What it says, in a few words.
    pub about: &'static str,
}

impl FieldSpec {
    const fn new(key: &'static str, kind: FieldKind, absent: Absent, about: &'static str) -> FieldSpec {
        FieldSpec { key, kind, absent, needs: None, excludes: &[], same_as: None, pair: None, about }
    }

    /// The same for a field that says nothing, or is an error, where `key` is not written.
    const fn only_beside(self, key: &'static str) -> FieldSpec {
        FieldSpec { needs: Some(key), ..self }
    }

    /// The same as another spelling of `key`.
    const fn spelling_of(self, key: &'static str) -> FieldSpec {
        FieldSpec { same_as: Some(key), ..self }
    }

    /// The same for a field that says nothing without the one called `key`, which says nothing without this one.
    const fn together_with(self, key: &'static str) -> FieldSpec {
        FieldSpec { pair: Some(key), ..self }
    }

    /// The key that stands for all spellings of this field.
    pub(super) fn main_key(&self) -> &'static str {
        self.same_as.unwrap_or(self.key)
    }

    /// The same for a field that is an error where any of `keys` is written.
    const fn not_beside(self, keys: &'static [&'static str]) -> FieldSpec {
        FieldSpec { excludes: keys, ..self }
    }
}

const ANY: f64 = f64::MAX;

/// A field that may be absent, with its default.
const fn field(key: &'static str, kind: FieldKind, default: &'static str, about: &'static str) -> FieldSpec {
    FieldSpec::new(key, kind, Absent::Value(default), about)
}

/// A field whose default depends on what is around it.
const fn ruled(
    key: &'static str,
    kind: FieldKind,
    value: fn(&Around<'_>) -> Option<FieldValue>,
    means: &'static str,
    about: &'static str,
) -> FieldSpec {
    FieldSpec::new(key, kind, Absent::Rule { value, means }, about)
}

/// A field whose absence is another thing than any value.
const fn unlike(
    key: &'static str,
    kind: FieldKind,
    means: &'static str,
    start: &'static str,
    about: &'static str,
) -> FieldSpec {
    FieldSpec::new(key, kind, Absent::Nothing { means, start }, about)
}

/// A field with a name that may be absent: then there is no such thing.
const fn option(key: &'static str, kind: FieldKind, about: &'static str) -> FieldSpec {
    unlike(key, kind, "none", "", about)
}

/// A field that must be there.
const fn required(key: &'static str, kind: FieldKind, about: &'static str) -> FieldSpec {
    FieldSpec::new(key, kind, Absent::Required, about)
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
/// A share of light.
const SHARE: FieldKind = between(0.0, 1.0);

/// A kind of block.
pub(super) struct Block {
    pub keyword: &'static str,
    pub kind: Kind,
    pub fields: &'static [FieldSpec],
}

const fn block(keyword: &'static str, kind: Kind, fields: &'static [FieldSpec]) -> Block {
    Block { keyword, kind, fields }
}

/// All kinds of blocks that have fields or hold others.
fn blocks() -> impl Iterator<Item = &'static Block> {
    [shapes::BLOCKS, lights::BLOCKS, materials::BLOCKS, surroundings::BLOCKS].into_iter().flatten()
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

/// The fields that a block with this keyword may have.
pub fn fields_of(keyword: &str) -> &'static [FieldSpec] {
    blocks().find(|block| block.keyword == keyword).map_or(&[], |block| block.fields)
}

/// All spellings of a key in a block with this keyword, the usual one first.
pub(super) fn spellings_of<'a>(keyword: &str, key: &'a str) -> impl Iterator<Item = &'static str> + use<'a> {
    let specs = fields_of(keyword);
    let main = specs.iter().find(|spec| spec.key == key).map(FieldSpec::main_key);
    specs.iter().filter(move |spec| Some(spec.main_key()) == main).map(|spec| spec.key)
}

/// The words of all blocks of a kind, in the order in which they are offered.
pub fn keywords_of(kind: Kind) -> impl Iterator<Item = &'static str> {
    blocks().filter(move |block| block.kind == kind).map(|block| block.keyword)
}

#[cfg(test)]
mod tests;
