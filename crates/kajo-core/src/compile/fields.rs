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

use std::marker::PhantomData;

use kajo_color::{Emission, Reflectance, Spectrum};
use kajo_math::{Vec2, Vec3};
use kajo_scene::{Args, Diagnostic, Diagnostics, Item, Params};

use super::light_groups;
use super::pictures::{TextureReader, is_picture};
use super::spectra::Written;
use crate::ids::LightGroup;
use crate::light::LightGroups;
use crate::schema::{Absent, Around, Constant, FieldKind, FieldSpec, FieldValue};
use crate::settings::Rules;
use crate::texture::{ColorTexture, FloatTexture};

/// What values may need besides their text.
pub(super) struct Sources<'a> {
    /// What reads light, colours and pictures.
    pub textures: TextureReader<'a>,
    /// Groups of lights met so far.
    pub groups: &'a mut LightGroups,
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

    /// The same for a field that may be a texture as well.
    pub const fn textured(self) -> Typed<V> {
        Typed::with(self.spec.or_texture())
    }

    /// The same for a field that says nothing, or is an error, where `key` is not written.
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

    /// The same for a field that says nothing without the one called `key`, which says nothing without this one.
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

    /// A field with the value that holds without it, whose reader wants to know that it is absent.
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
        Defaulted(Typed::with(self.0.spec.or_texture()))
    }

    pub const fn spec(self) -> FieldSpec {
        self.0.spec
    }
}

impl<V> Optional<V> {
    /// The same where a texture may be a factor of white.
    pub const fn or_texture(self) -> Optional<Textured<V>> {
        Optional(Typed::with(self.0.spec.or_texture()))
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
        pub(super) struct $name$(<$life>)? {
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

// ---- values ------------------------------------------------------------------------------------------------------

/// A value, and where it stands.
pub(super) struct At<'t, V> {
    pub value: V,
    pub item: Item<'t>,
}

impl<'t, V: Value<'t>> Value<'t> for At<'t, V> {
    fn read(
        spec: &FieldSpec,
        item: Item<'t>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<At<'t, V>> {
        V::read(spec, item, diagnostics, sources).map(|value| At { value, item })
    }
}

/// A value, and where it stands if it is written.
pub(super) struct Given<'t, V> {
    pub value: V,
    pub item: Option<Item<'t>>,
}

impl<'t, V: Value<'t>> Value<'t> for Given<'t, V> {
    fn read(
        spec: &FieldSpec,
        item: Item<'t>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<Given<'t, V>> {
        V::read(spec, item, diagnostics, sources).map(|value| Given { value, item: Some(item) })
    }
}

impl<V: Stated> Stated for Given<'_, V> {
    fn of(constant: Constant) -> Option<Self> {
        V::of(constant).map(|value| Given { value, item: None })
    }
}

impl Plain<'_> for f32 {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<f32, Diagnostic> {
        args.number_in(spec.kind.bounds())
    }
}

impl Stated for f32 {
    fn of(constant: Constant) -> Option<f32> {
        match constant {
            Constant::Number(number) => Some(number as f32),
            _ => None,
        }
    }
}

/// Any number.
pub(super) const fn number(key: &'static str) -> Typed<f32> {
    Typed::new(key, FieldKind::NUMBER)
}

/// A number that is not less than `min`.
pub(super) const fn at_least(key: &'static str, min: f64) -> Typed<f32> {
    between(key, min, f64::MAX)
}

/// A number from `min` to `max`.
pub(super) const fn between(key: &'static str, min: f64, max: f64) -> Typed<f32> {
    Typed::new(key, FieldKind::Number { min, max })
}

/// A number above zero.
pub(super) const fn positive(key: &'static str) -> Typed<f32> {
    Typed::new(key, FieldKind::POSITIVE)
}

/// An angle in degrees from `min` to `max`.
pub(super) const fn degrees(key: &'static str, min: f64, max: f64) -> Typed<f32> {
    Typed::new(key, FieldKind::Angle { min, max })
}

/// Any angle in degrees.
pub(super) const fn any_angle(key: &'static str) -> Typed<f32> {
    degrees(key, f64::MIN, f64::MAX)
}

impl Plain<'_> for i64 {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<i64, Diagnostic> {
        match spec.kind {
            FieldKind::Whole { min, max } => args.int_in(min as i64..=max as i64),
            _ => args.int_in(i64::MIN..=i64::MAX),
        }
    }
}

impl Plain<'_> for u32 {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, sources: &mut Sources<'_>) -> Result<u32, Diagnostic> {
        i64::parse(spec, args, sources).map(|n| n as u32)
    }
}

impl Stated for u32 {
    fn of(constant: Constant) -> Option<u32> {
        f32::of(constant).map(|n| n as u32)
    }
}

impl Plain<'_> for i32 {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, sources: &mut Sources<'_>) -> Result<i32, Diagnostic> {
        i64::parse(spec, args, sources).map(|n| n as i32)
    }
}

impl Stated for i32 {
    fn of(constant: Constant) -> Option<i32> {
        f32::of(constant).map(|n| n as i32)
    }
}

/// A whole number from `min` to `max`.
pub(super) const fn whole(key: &'static str, min: i32, max: i32) -> Typed<i32> {
    Typed::new(key, FieldKind::Whole { min: min as f64, max: max as f64 })
}

/// How many of something.
pub(super) const fn count(key: &'static str, min: u32, max: u32) -> Typed<u32> {
    Typed::new(key, FieldKind::Whole { min: min as f64, max: max as f64 })
}

impl Plain<'_> for Vec2 {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Vec2, Diagnostic> {
        args.vec2()
    }
}

impl Stated for Vec2 {
    fn of(constant: Constant) -> Option<Vec2> {
        match constant {
            Constant::Pair(numbers) => Some(Vec2::from(numbers.map(|x| x as f32))),
            _ => None,
        }
    }
}

/// Two numbers.
pub(super) const fn pair(key: &'static str) -> Typed<Vec2> {
    Typed::new(key, FieldKind::Numbers(2))
}

impl Plain<'_> for bool {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<bool, Diagnostic> {
        args.flag()
    }
}

impl Stated for bool {
    fn of(constant: Constant) -> Option<bool> {
        match constant {
            Constant::Word(word) => Some(word == "on"),
            _ => None,
        }
    }
}

/// `on` or `off`.
pub(super) const fn flag(key: &'static str) -> Typed<bool> {
    Typed::new(key, FieldKind::Flag)
}

impl Plain<'_> for Vec3 {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Vec3, Diagnostic> {
        args.vec3()
    }
}

impl Stated for Vec3 {
    fn of(constant: Constant) -> Option<Vec3> {
        match constant {
            Constant::Triple(numbers) => Some(Vec3::from(numbers.map(|x| x as f32))),
            _ => None,
        }
    }
}

impl Plain<'_> for [f32; 3] {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<[f32; 3], Diagnostic> {
        args.numbers()
    }
}

impl Stated for [f32; 3] {
    fn of(constant: Constant) -> Option<[f32; 3]> {
        Vec3::of(constant).map(|v| v.to_array())
    }
}

/// Three numbers that are neither a place nor a direction.
pub(super) const fn triple(key: &'static str) -> Typed<[f32; 3]> {
    Typed::new(key, FieldKind::Numbers(3))
}

/// A place: three numbers.
pub(super) const fn point(key: &'static str) -> Typed<Vec3> {
    Typed::new(key, FieldKind::Point)
}

/// A vector: three numbers.
pub(super) const fn vector(key: &'static str) -> Typed<Vec3> {
    Typed::new(key, FieldKind::Vector)
}

/// A value that is one of a few words.
pub(super) trait Choice: Copy + 'static {
    /// The words with what they stand for.
    const NAMES: &'static [(&'static str, Self)];
    /// The words alone.
    const WORDS: &'static [&'static str];
    /// Words that are understood as well, and listed nowhere.
    const SYNONYMS: &'static [(&'static str, Self)] = &[];
}

/// The words of a table.
pub(super) const fn words<T: Copy, const N: usize>(table: &[(&'static str, T); N]) -> [&'static str; N] {
    let mut words = [""; N];
    let mut i = 0;
    while i < N {
        words[i] = table[i].0;
        i += 1;
    }
    words
}

/// Declares the words of a [`Choice`].
macro_rules! choices {
    ($type:ty: $names:expr $(, or $synonyms:expr)?) => {
        impl $crate::compile::fields::Choice for $type {
            const NAMES: &'static [(&'static str, $type)] = &$names;
            const WORDS: &'static [&'static str] = &$crate::compile::fields::words(&$names);
            $(const SYNONYMS: &'static [(&'static str, $type)] = &$synonyms;)?
        }
    };
    ($type:ty { $($word:literal => $value:expr),* $(,)? }) => {
        impl $crate::compile::fields::Choice for $type {
            const NAMES: &'static [(&'static str, $type)] = &[$(($word, $value)),*];
            const WORDS: &'static [&'static str] = &[$($word),*];
        }
    };
}

pub(super) use choices;

impl<C: Choice> Plain<'_> for C {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<C, Diagnostic> {
        args.choice_or(C::NAMES, C::SYNONYMS)
    }
}

impl<C: Choice> Stated for C {
    fn of(constant: Constant) -> Option<C> {
        let Constant::Word(word) = constant else { return None };
        C::NAMES.iter().find(|(name, _)| *name == word).map(|(_, value)| *value)
    }
}

impl<C: Choice> Typed<C> {
    /// One of its words, which holds unless another is written; another word does not compile.
    pub const fn or_word(self, word: &'static str, about: &'static str) -> Defaulted<C> {
        assert!(contains(C::WORDS, word), "the default of a choice is one of its words");
        self.otherwise(Constant::Word(word), about)
    }
}

const fn contains(words: &[&str], word: &str) -> bool {
    let mut i = 0;
    while i < words.len() {
        let (a, b) = (words[i].as_bytes(), word.as_bytes());
        let mut same = a.len() == b.len();
        let mut j = 0;
        while same && j < a.len() {
            same = a[j] == b[j];
            j += 1;
        }
        if same {
            return true;
        }
        i += 1;
    }
    false
}

/// One of a few words.
pub(super) const fn choice<C: Choice>(key: &'static str) -> Typed<C> {
    Typed::new(key, FieldKind::Choice(C::WORDS))
}

/// A unit vector, written with any length but zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Direction(pub Vec3);

impl Plain<'_> for Direction {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Direction, Diagnostic> {
        let direction = args.vec3()?.try_normalize();
        direction.map(Direction).ok_or_else(|| args.error(format!("`{}` must not be zero", spec.key)))
    }
}

impl Stated for Direction {
    fn of(constant: Constant) -> Option<Direction> {
        Vec3::of(constant).map(Direction)
    }
}

/// A direction, which must not be zero.
pub(super) const fn direction(key: &'static str) -> Typed<Direction> {
    Typed::new(key, FieldKind::Vector)
}

impl Plain<'_> for Emission {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, sources: &mut Sources<'_>) -> Result<Emission, Diagnostic> {
        sources.textures.spectra.emission(args)
    }
}

/// Light that is not negative.
pub(super) const fn emission(key: &'static str) -> Typed<Emission> {
    Typed::new(key, FieldKind::Emission)
}

impl Plain<'_> for Written<Emission> {
    fn parse(
        _: &FieldSpec,
        args: &mut Args<'_>,
        sources: &mut Sources<'_>,
    ) -> Result<Written<Emission>, Diagnostic> {
        sources.textures.spectra.classic_light(args)
    }
}

impl Stated for Written<Emission> {
    fn of(constant: Constant) -> Option<Written<Emission>> {
        let rgb = Vec3::of(constant)?;
        Some(Written { rgb: rgb.into(), value: Emission::from_rgb(rgb.to_array()) })
    }
}

/// Light of the classic format, which may be negative.
pub(super) const fn classic_light(key: &'static str) -> Typed<Written<Emission>> {
    Typed::new(key, FieldKind::Emission)
}

impl Plain<'_> for Written<Reflectance> {
    fn parse(
        _: &FieldSpec,
        args: &mut Args<'_>,
        sources: &mut Sources<'_>,
    ) -> Result<Written<Reflectance>, Diagnostic> {
        sources.textures.spectra.reflectance(args)
    }
}

impl Stated for Written<Reflectance> {
    fn of(constant: Constant) -> Option<Written<Reflectance>> {
        let [grey, ..] = <[f32; 3]>::of(constant)?;
        Some(Written { rgb: Spectrum::WHITE * grey, value: Reflectance::from_rgb([grey; 3]) })
    }
}

/// The colour of a surface of the classic format, which may be anything.
pub(super) const fn reflectance(key: &'static str) -> Typed<Written<Reflectance>> {
    Typed::new(key, FieldKind::Reflectance)
}

/// A colour that is three numbers.
pub(super) const fn color(key: &'static str) -> Typed<Vec3> {
    Typed::new(key, FieldKind::Color)
}

/// Absorption per unit length, which is not negative.
pub(super) struct Absorption(pub [f32; 3]);

impl Plain<'_> for Absorption {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Absorption, Diagnostic> {
        let absorption = args.vec3()?;
        if absorption.min_element() < 0.0 {
            return Err(args.error("absorption is not negative"));
        }
        Ok(Absorption(absorption.to_array()))
    }
}

impl Stated for Absorption {
    fn of(constant: Constant) -> Option<Absorption> {
        Vec3::of(constant).map(|absorption| Absorption(absorption.to_array()))
    }
}

/// Absorption per unit length.
pub(super) const fn absorption(key: &'static str) -> Typed<Absorption> {
    Typed::new(key, FieldKind::Color)
}

impl Value<'_> for ColorTexture {
    fn read(
        _: &FieldSpec,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<ColorTexture> {
        sources.textures.color(item, diagnostics)
    }
}

impl Stated for ColorTexture {
    fn of(constant: Constant) -> Option<ColorTexture> {
        Vec3::of(constant).map(|color| ColorTexture::Constant(Reflectance::from_rgb(color.to_array())))
    }
}

/// A colour whose components are shares of light, a measured spectrum of such, or a texture.
pub(super) const fn color_texture(key: &'static str) -> Typed<ColorTexture> {
    Typed::new(key, FieldKind::Reflectance).textured()
}

/// A colour of the classic format, or a texture as a factor of white.
#[derive(Clone)]
pub(super) struct Textured<V> {
    pub value: V,
    pub texture: Option<ColorTexture>,
}

impl<V> From<V> for Textured<V> {
    fn from(value: V) -> Textured<V> {
        Textured { value, texture: None }
    }
}

impl<'t, V: Plain<'t> + Stated> Value<'t> for Textured<V> {
    fn read(
        spec: &FieldSpec,
        item: Item<'t>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<Textured<V>> {
        if !is_picture(item) {
            return V::read(spec, item, diagnostics, sources).map(Textured::from);
        }
        let texture = Some(sources.textures.color(item, diagnostics)?);
        V::of(triple_of([1.0; 3])).map(|value| Textured { value, texture })
    }
}

impl<V: Stated> Stated for Textured<V> {
    fn of(constant: Constant) -> Option<Textured<V>> {
        V::of(constant).map(Textured::from)
    }
}

impl Value<'_> for FloatTexture {
    fn read(
        spec: &FieldSpec,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<FloatTexture> {
        sources.textures.float(spec, item, diagnostics)
    }
}

impl Stated for FloatTexture {
    fn of(constant: Constant) -> Option<FloatTexture> {
        f32::of(constant).map(FloatTexture::Constant)
    }
}

/// A number from `min` to `max`, or a texture of such.
pub(super) const fn float_texture(key: &'static str, min: f64, max: f64) -> Typed<FloatTexture> {
    Typed::new(key, FieldKind::Number { min, max }).textured()
}

/// A number in [0, 1], or a texture of such.
pub(super) const fn share(key: &'static str) -> Typed<FloatTexture> {
    float_texture(key, 0.0, 1.0)
}

impl Plain<'_> for LightGroup {
    fn parse(
        _: &FieldSpec,
        args: &mut Args<'_>,
        sources: &mut Sources<'_>,
    ) -> Result<LightGroup, Diagnostic> {
        light_groups::read(args, sources.groups)
    }
}

/// The group of lights that something is seen in.
pub(super) const fn light_group(key: &'static str) -> Typed<LightGroup> {
    Typed::new(key, FieldKind::Text)
}

/// The group of lights that something is seen in.
pub(super) const GROUP: Optional<LightGroup> =
    light_group("group").option("name of the lights it is seen among");

/// The name of a file, as it is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct FileName(pub String);

impl Plain<'_> for FileName {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<FileName, Diagnostic> {
        args.text().map(|name| FileName(name.into_owned()))
    }
}

/// The name of a file.
pub(super) const fn file(key: &'static str) -> Typed<FileName> {
    Typed::new(key, FieldKind::File)
}
