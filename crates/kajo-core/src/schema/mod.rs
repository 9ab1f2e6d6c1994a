//! What the blocks of the language are, and which fields they have, as data.
//!
//! Each block describes its fields once, beside the code that reads it (`compile/blocks`), and is read by that
//! description. What a key may say, which unit and range it has, what holds while it is absent and what it is for are
//! therefore known here to everybody: to the editor, to `kajo help`, to the tables of the manual and to completion.

mod spec;
mod value;

pub use spec::{Absent, Around, FieldKind, FieldSpec, NumberRange};
pub use value::{Constant, FieldValue, number_text, quoted};

/// What a block describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// From where the picture is taken.
    Camera,
    /// How to render.
    Settings,
    /// The frames of a scene that changes.
    Animation,
    /// What rays see that hit nothing.
    Background,
    /// What fills the air.
    Fog,
    /// The list of lights.
    Lights,
    /// One light.
    Light,
    /// The list of media.
    Media,
    /// One medium.
    Medium,
    /// The list of materials.
    Materials,
    /// One material.
    Material,
    /// The list of textures that have names.
    Textures,
    /// One texture that has a name.
    Texture,
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
    /// What is said behind the name of a picture or of a texture.
    Picture,
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

/// A kind of block.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// The word it begins with.
    pub keyword: &'static str,
    /// What it describes.
    pub kind: Kind,
    /// What it is, in a few words.
    pub about: &'static str,
    /// Its fields: its own, and groups that it shares with other blocks.
    pub groups: &'static [&'static [FieldSpec]],
    /// Blocks that may stand within it, beside members of a family that it lists and objects that it holds.
    pub parts: &'static [&'static Block],
}

impl Block {
    /// Its fields, in the order in which they are shown.
    pub fn fields(&self) -> impl Iterator<Item = &'static FieldSpec> + Clone + use<> {
        self.groups.iter().copied().flatten()
    }

    /// The field called `key`.
    pub fn field(&self, key: &str) -> Option<&'static FieldSpec> {
        self.fields().find(|field| field.key == key)
    }

    /// The part with this keyword, or what may be said behind a picture that is the value of this key.
    pub fn part(&self, keyword: &str) -> Option<&'static Block> {
        let part = self.parts.iter().copied().find(|part| part.keyword == keyword);
        part.or_else(|| self.field(keyword)?.texture)
    }

    /// Whether a block may stand within it as one of a family or as an object.
    pub fn lists(&self, block: &Block) -> bool {
        match self.kind {
            Kind::Lights => block.kind == Kind::Light,
            Kind::Materials => block.kind == Kind::Material,
            Kind::Textures => block.kind == Kind::Texture,
            Kind::Media => block.kind == Kind::Medium,
            kind => kind.holds_objects() && (block.kind.is_object() || block.kind == Kind::Define),
        }
    }

    /// All spellings of a key, the usual one first; none for a key that it has not.
    pub fn spellings_of(&self, key: &str) -> impl Iterator<Item = &'static str> + use<> {
        let main = self.field(key).map(FieldSpec::main_key);
        self.fields().filter(move |field| Some(field.main_key()) == main).map(|field| field.key)
    }
}
