//! What the blocks of the language are, and which fields they have, for those who show and edit them.
//!
//! The compiler alone decides what a scene means. These tables say the same for people: the type and range of each
//! value, what holds when it is absent, and a few words about it. Tests ask the compiler for every key it knows in every
//! block, so that the two cannot differ.

mod lights;
mod materials;
mod shapes;
mod surroundings;

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
    /// Linear red, green and blue, one number for white, or a lamp's name with its factor.
    Emission,
    /// `on` or `off`.
    Flag,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// One of these words, and then at most one number.
    ChoiceAndNumber(&'static [&'static str]),
    /// This many numbers, or fewer.
    Numbers(usize),
    /// The name of a file.
    File,
    /// A word or some text.
    Text,
    /// The name or number of a material.
    Material,
}

/// What is known of a field before a scene is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldSpec {
    /// The word it is written by.
    pub key: &'static str,
    /// The type of its value.
    pub kind: FieldKind,
    /// What holds when it is absent, as it would be written; `None` when it must be there, or its absence means
    /// something that no value says.
    pub default: Option<&'static str>,
    /// Whether the block is an error without it.
    pub required: bool,
    /// What it says, in a few words.
    pub about: &'static str,
}

const ANY: f64 = f64::MAX;

/// A field that may be absent, with its default.
const fn field(key: &'static str, kind: FieldKind, default: &'static str, about: &'static str) -> FieldSpec {
    FieldSpec { key, kind, default: Some(default), required: false, about }
}

/// A field that may be absent, which is another thing than any value.
const fn option(key: &'static str, kind: FieldKind, about: &'static str) -> FieldSpec {
    FieldSpec { key, kind, default: None, required: false, about }
}

/// A field that must be there.
const fn required(key: &'static str, kind: FieldKind, about: &'static str) -> FieldSpec {
    FieldSpec { key, kind, default: None, required: true, about }
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

/// The words of all blocks of a kind, in the order in which they are offered.
pub fn keywords_of(kind: Kind) -> impl Iterator<Item = &'static str> {
    blocks().filter(move |block| block.kind == kind).map(|block| block.keyword)
}

#[cfg(test)]
mod tests;
