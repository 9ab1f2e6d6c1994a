//! Fields of blocks with their types: from one line come the description of a field and the value that is read.
//!
//! ```text
//! keys! {
//!     DiskKeys {
//!         center: Vec3 = point("center").required("its middle"),
//!         inner_radius: f32 = number("innerRadius").or(0.0, "radius of the hole"),
//!     }
//! }
//! ```
//!
//! is a struct with these members, a list `DiskKeys::FIELDS` of their descriptions, and [`Keys::read`], which takes kind,
//! range and default of each from its description. A member whose type differs from that of its field does not compile,
//! and a key that is in no list has no member to be read into.

mod colors;
mod media;
mod picture_keys;
mod picture_sequence;
mod pictures;
mod values;

use std::marker::PhantomData;

use kajo_color::{Emission, Reflectance};
use kajo_math::{Vec2, Vec3};
use kajo_scene::{Args, Diagnostic, Diagnostics, Item, Params};

use super::spectra::Written;
use crate::light::LightGroups;
use crate::schema::{Absent, Around, Block, Constant, FieldKind, FieldSpec, FieldValue};
use crate::settings::Rules;
use crate::texture::{ColorTexture, FloatTexture};

pub(super) use colors::{
    Absorption, GROUP, Textured, absorption, classic_light, color, color_texture, emission, float_texture,
    light_group, reflectance, share,
};
pub(super) use media::{Inside, MediumNames, inside, named_medium};
pub(super) use picture_keys::{
    COLORS, ChannelKeys, CutoffKeys, HEIGHTS, HOLES, HeightKeys, NORMALS, NormalKeys, PICTURE, SLIDE,
    SlideKeys,
};
pub(super) use pictures::{TextureReader, is_picture, name_with};
pub(super) use values::{
    At, Choice, Direction, FileName, Given, any_angle, at_least, between, choice, choices, count, degrees,
    direction, file, flag, function, number, pair, point, positive, triple, vector, whole, words,
};

/// What values may need besides their text.
pub(super) struct Sources<'a> {
    /// What reads light, colours and pictures.
    pub textures: TextureReader<'a>,
    /// Groups of lights met so far.
    pub groups: &'a mut LightGroups,
    /// Media by their names.
    pub media: &'a MediumNames,
    /// The conventions of the dialect.
    pub rules: Rules,
    /// Names of the integrators that there are.
    pub integrators: &'static [&'static str],
}

/// A value that can be read where it is written.
pub(super) trait Value<'t>: Sized {
    /// The value of an item; `None` when a mistake was reported.
    fn read(
        spec: &FieldSpec,
        item: Item<'t>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<Self>;
}

/// A value that is read from the numbers and the word after its key.
pub(super) trait Plain<'t>: Sized {
    /// Takes the value.
    fn parse(spec: &FieldSpec, args: &mut Args<'t>, sources: &mut Sources<'_>) -> Result<Self, Diagnostic>;
}

impl<'t, V: Plain<'t>> Value<'t> for V {
    fn read(
        spec: &FieldSpec,
        item: Item<'t>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<V> {
        Args::read(item, diagnostics, |args| V::parse(spec, args, sources))
    }
}

/// A value that a description can state as a default.
pub(super) trait Stated: Sized {
    /// The value of a constant; `None` for one of another type.
    fn of(constant: Constant) -> Option<Self>;
}

/// A field of which is known what its value is, not yet what holds without it.
pub(super) struct Typed<V> {
    spec: FieldSpec,
    value: PhantomData<fn() -> V>,
}

impl<V> Typed<V> {
    /// A field of a kind of its own.
    pub const fn new(key: &'static str, kind: FieldKind) -> Typed<V> {
        Typed { spec: FieldSpec::new(key, kind), value: PhantomData }
    }

    const fn with(spec: FieldSpec) -> Typed<V> {
        Typed { spec, value: PhantomData }
    }

    /// The same with what its numbers count.
    pub const fn unit(self, unit: &'static str) -> Typed<V> {
        Typed::with(FieldSpec { unit, ..self.spec })
    }

    /// The same for a field that is mostly tried between two values; see [`FieldSpec::slider`].
    pub const fn sliding(self, slider: [f64; 2]) -> Typed<V> {
        Typed::with(FieldSpec { slider: Some(slider), ..self.spec })
    }

    /// The same for a field that may be a texture as well, behind whose name `block` says more.
    pub const fn textured(self, block: &'static Block) -> Typed<V> {
        Typed::with(self.spec.or_texture(block))
    }

    /// The same for a field that has no effect, or is an error, where `key` is not written.
    pub const fn only_beside(self, key: &'static str) -> Typed<V> {
        Typed::with(self.spec.only_beside(key))
    }

    /// The same for a field that is an error where any of `keys` is written.
    pub const fn not_beside(self, keys: &'static [&'static str]) -> Typed<V> {
        Typed::with(self.spec.not_beside(keys))
    }

    /// The same as another spelling of `key`.
    pub const fn spelling_of(self, key: &'static str) -> Typed<V> {
        Typed::with(self.spec.spelling_of(key))
    }

    /// The same for a field that has no effect without the one called `key`, which has no effect without this one.
    pub const fn together_with(self, key: &'static str) -> Typed<V> {
        Typed::with(self.spec.together_with(key))
    }

    /// The same with the place where the value stands.
    pub const fn placed<'t>(self) -> Typed<At<'t, V>> {
        Typed::with(self.spec)
    }

    /// A field that must be there.
    pub const fn required(self, about: &'static str) -> Required<V> {
        Required(Typed::with(FieldSpec { absent: Absent::Required, about, ..self.spec }))
    }

    /// A field whose absence is another thing than any value; `start` is a usual one to begin with.
    pub const fn unlike(self, means: &'static str, start: &'static str, about: &'static str) -> Optional<V> {
        Optional(Typed::with(FieldSpec { absent: Absent::Nothing { means, start }, about, ..self.spec }))
    }

    /// A field with a name that may be absent: then there is no such thing.
    pub const fn option(self, about: &'static str) -> Optional<V> {
        self.unlike("none", "", about)
    }

    /// A field whose default depends on what is around it, and is the reader's to find.
    pub const fn ruled(
        self,
        value: fn(&Around<'_>) -> Option<FieldValue>,
        means: &'static str,
        about: &'static str,
    ) -> Optional<V> {
        Optional(Typed::with(FieldSpec { absent: Absent::Rule { value, means }, about, ..self.spec }))
    }

    /// A field with the value that holds without it, whose reader distinguishes that it is absent.
    pub const fn presumed(self, constant: Constant, about: &'static str) -> Optional<V> {
        Optional(Typed::with(FieldSpec { absent: Absent::Value(constant), about, ..self.spec }))
    }

    /// A field with the value that holds without it.
    pub const fn otherwise(self, constant: Constant, about: &'static str) -> Defaulted<V> {
        Defaulted(Typed::with(FieldSpec { absent: Absent::Value(constant), about, ..self.spec }))
    }
}

impl Typed<f32> {
    pub const fn or(self, default: f32, about: &'static str) -> Defaulted<f32> {
        self.otherwise(Constant::Number(default as f64), about)
    }
}

impl Typed<Vec2> {
    pub const fn or(self, [x, y]: [f32; 2], about: &'static str) -> Defaulted<Vec2> {
        self.otherwise(Constant::Pair([x as f64, y as f64]), about)
    }
}

impl Typed<bool> {
    pub const fn or(self, default: bool, about: &'static str) -> Defaulted<bool> {
        self.otherwise(Constant::Word(if default { "on" } else { "off" }), about)
    }
}

impl Typed<i32> {
    pub const fn or(self, default: i32, about: &'static str) -> Defaulted<i32> {
        self.otherwise(Constant::Number(default as f64), about)
    }
}

impl Typed<u32> {
    pub const fn or(self, default: u32, about: &'static str) -> Defaulted<u32> {
        self.otherwise(Constant::Number(default as f64), about)
    }
}

impl Typed<FloatTexture> {
    pub const fn or(self, default: f32, about: &'static str) -> Defaulted<FloatTexture> {
        self.otherwise(Constant::Number(default as f64), about)
    }
}

impl Typed<ColorTexture> {
    pub const fn or(self, default: [f32; 3], about: &'static str) -> Defaulted<ColorTexture> {
        self.otherwise(triple_of(default), about)
    }
}

impl Typed<Absorption> {
    pub const fn or(self, default: [f32; 3], about: &'static str) -> Defaulted<Absorption> {
        self.otherwise(triple_of(default), about)
    }
}

impl Typed<Written<Emission>> {
    pub const fn or(self, default: [f32; 3], about: &'static str) -> Defaulted<Written<Emission>> {
        self.otherwise(triple_of(default), about)
    }
}

impl Typed<Written<Reflectance>> {
    /// A factor that is the same for all wavelengths.
    pub const fn or_grey(self, default: f32, about: &'static str) -> Defaulted<Written<Reflectance>> {
        self.otherwise(triple_of([default; 3]), about)
    }
}

impl Typed<Vec3> {
    pub const fn or(self, default: [f32; 3], about: &'static str) -> Defaulted<Vec3> {
        self.otherwise(triple_of(default), about)
    }
}

impl Typed<[f32; 3]> {
    pub const fn or(self, default: [f32; 3], about: &'static str) -> Defaulted<[f32; 3]> {
        self.otherwise(triple_of(default), about)
    }
}

impl Typed<Direction> {
    pub const fn or(self, default: [f32; 3], about: &'static str) -> Defaulted<Direction> {
        self.otherwise(triple_of(default), about)
    }
}

const fn triple_of([x, y, z]: [f32; 3]) -> Constant {
    Constant::Triple([x as f64, y as f64, z as f64])
}

/// A field that must be there.
pub(super) struct Required<V>(Typed<V>);

/// A field that may be absent, with the value that holds then.
pub(super) struct Defaulted<V>(Typed<V>);

/// A field that may be absent.
pub(super) struct Optional<V>(Typed<V>);

impl<V> Required<V> {
    pub const fn spec(self) -> FieldSpec {
        self.0.spec
    }
}

impl<V> Defaulted<V> {
    /// The same with the place where it is written.
    pub const fn given<'t>(self) -> Defaulted<Given<'t, V>> {
        Defaulted(Typed::with(self.0.spec))
    }

    /// The same where a texture may be a factor of white.
    pub const fn or_texture(self) -> Defaulted<Textured<V>> {
        Defaulted(Typed::with(self.0.spec.or_texture(&COLORS)))
    }

    pub const fn spec(self) -> FieldSpec {
        self.0.spec
    }
}

impl<V> Optional<V> {
    /// The same where a texture may be a factor of white.
    pub const fn or_texture(self) -> Optional<Textured<V>> {
        Optional(Typed::with(self.0.spec.or_texture(&COLORS)))
    }

    pub const fn spec(self) -> FieldSpec {
        self.0.spec
    }
}

/// A field that can be read from a block.
pub(super) trait Field<'t>: Sized {
    /// What is read.
    type Output;

    /// The value of those items alone that `is_meant` knows; others are left to be asked for. `None` when a mistake was
    /// reported that leaves no value.
    fn read_where(
        self,
        params: &mut Params<'t, '_>,
        sources: &mut Sources<'_>,
        is_meant: impl Fn(Item<'t>) -> bool,
    ) -> Option<Self::Output>;

    /// The value, as [`Field::read_where`] of all items.
    fn read(self, params: &mut Params<'t, '_>, sources: &mut Sources<'_>) -> Option<Self::Output> {
        self.read_where(params, sources, |_| true)
    }
}

impl<'t, V: Value<'t>> Field<'t> for Required<V> {
    type Output = V;

    fn read_where(
        self,
        params: &mut Params<'t, '_>,
        sources: &mut Sources<'_>,
        is_meant: impl Fn(Item<'t>) -> bool,
    ) -> Option<V> {
        let spec = self.0.spec;
        match params.block_where(spec.key, is_meant) {
            Some(item) => V::read(&spec, item, params.diagnostics(), sources),
            None => {
                params.report_missing(spec.key);
                None
            }
        }
    }
}

impl<'t, V: Value<'t> + Stated> Field<'t> for Defaulted<V> {
    type Output = V;

    fn read_where(
        self,
        params: &mut Params<'t, '_>,
        sources: &mut Sources<'_>,
        is_meant: impl Fn(Item<'t>) -> bool,
    ) -> Option<V> {
        let spec = self.0.spec;
        let item = params.block_where(spec.key, is_meant);
        let written = item.and_then(|item| V::read(&spec, item, params.diagnostics(), sources));
        let Absent::Value(constant) = spec.absent else { return written };
        written.or_else(|| V::of(constant))
    }
}

impl<'t, V: Value<'t>> Field<'t> for Optional<V> {
    type Output = Option<V>;

    fn read_where(
        self,
        params: &mut Params<'t, '_>,
        sources: &mut Sources<'_>,
        is_meant: impl Fn(Item<'t>) -> bool,
    ) -> Option<Option<V>> {
        let spec = self.0.spec;
        let item = params.block_where(spec.key, is_meant);
        Some(item.and_then(|item| V::read(&spec, item, params.diagnostics(), sources)))
    }
}

/// The keys of a block, or of a part that several kinds of blocks share.
pub(super) trait Keys<'t>: Sized {
    /// Reads all of them; `None` when one that must be there is absent or wrong, which was reported.
    fn read(params: &mut Params<'t, '_>, sources: &mut Sources<'_>) -> Option<Self>;
}

/// Declares a struct of fields that are read together; see the head of this module. A visibility is that of its members.
macro_rules! keys {
    (@struct [$($life:lifetime)?] $(#[$doc:meta])* $vis:vis $name:ident { $($member:ident: $type:ty = $field:expr,)* }) => {
        $(#[$doc])*
        pub(in crate::compile) struct $name$(<$life>)? {
            $($vis $member: $type,)*
        }

        impl<'t> $crate::compile::fields::Keys<'t> for keys!(@type [$($life)?] $name) {
            fn read(
                params: &mut kajo_scene::Params<'t, '_>,
                sources: &mut $crate::compile::fields::Sources<'_>,
            ) -> Option<Self> {
                use $crate::compile::fields::Field;
                // One pattern for all: a member may have the name of a function that makes fields.
                let ($($member,)*) = ($($field.read(params, sources),)*);
                Some($name { $($member: $member?,)* })
            }
        }
    };
    (@type [] $name:ident) => { $name };
    (@type [$life:lifetime] $name:ident) => { $name<'t> };
    ($(#[$doc:meta])* $vis:vis $name:ident<$life:lifetime> { $($member:ident: $type:ty = $field:expr),* $(,)? }) => {
        keys!(@struct [$life] $(#[$doc])* $vis $name { $($member: $type = $field,)* });

        impl $name<'_> {
            /// The descriptions of these fields.
            pub const FIELDS: &'static [$crate::schema::FieldSpec] = &[$($field.spec()),*];
        }
    };
    ($(#[$doc:meta])* $vis:vis $name:ident { $($member:ident: $type:ty = $field:expr),* $(,)? }) => {
        keys!(@struct [] $(#[$doc])* $vis $name { $($member: $type = $field,)* });

        impl $name {
            /// The descriptions of these fields.
            pub const FIELDS: &'static [$crate::schema::FieldSpec] = &[$($field.spec()),*];
        }
    };
}

pub(super) use keys;

/// Reports keys of a list that are there although `key` is, beside which they are an error.
pub(super) fn report_beside(params: &mut Params<'_, '_>, fields: &[FieldSpec], key: &str) {
    for spec in fields.iter().filter(|spec| spec.excludes.contains(&key)) {
        params.refuse(spec.key, &format!("beside `{key}`"));
    }
}

/// Reports keys of a list that are there although `key`, which they need, is not.
pub(super) fn report_without(params: &mut Params<'_, '_>, fields: &[FieldSpec], key: &str) {
    for spec in fields.iter().filter(|spec| spec.needs == Some(key)) {
        params.refuse(spec.key, &format!("without `{key}`"));
    }
}
