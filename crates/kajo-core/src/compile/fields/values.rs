//! Values of fields that are numbers, words, places and names.

use std::ops::RangeInclusive;
use std::sync::Arc;

use kajo_math::tape::Tape;
use kajo_math::{Vec2, Vec3};
use kajo_scene::{Args, Diagnostic, Diagnostics, Item};

use super::{Defaulted, Plain, Sources, Stated, Typed, Value};
use crate::schema::{Constant, FieldKind, FieldSpec, NumberRange};

/// A value, and where it stands.
pub(in crate::compile) struct At<'t, V> {
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
pub(in crate::compile) struct Given<'t, V> {
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
pub(in crate::compile) const fn number(key: &'static str) -> Typed<f32> {
    Typed::new(key, FieldKind::NUMBER)
}

/// A number that is not less than `min`.
pub(in crate::compile) const fn at_least(key: &'static str, min: f64) -> Typed<f32> {
    between(key, min, f64::MAX)
}

/// A number from `min` to `max`.
pub(in crate::compile) const fn between(key: &'static str, min: f64, max: f64) -> Typed<f32> {
    Typed::new(key, FieldKind::Number { min, max })
}

/// A number above zero.
pub(in crate::compile) const fn positive(key: &'static str) -> Typed<f32> {
    Typed::new(key, FieldKind::POSITIVE)
}

/// An angle in degrees from `min` to `max`.
pub(in crate::compile) const fn degrees(key: &'static str, min: f64, max: f64) -> Typed<f32> {
    Typed::new(key, FieldKind::Angle { min, max })
}

/// Any angle in degrees.
pub(in crate::compile) const fn any_angle(key: &'static str) -> Typed<f32> {
    degrees(key, f64::MIN, f64::MAX)
}

/// A whole number within the bounds of its field, and within those of its type.
fn whole_in(spec: &FieldSpec, args: &mut Args<'_>, range: RangeInclusive<i64>) -> Result<i64, Diagnostic> {
    match spec.kind {
        FieldKind::Whole { min, max } => {
            args.int_in((min as i64).max(*range.start())..=(max as i64).min(*range.end()))
        }
        _ => args.int_in(range),
    }
}

impl Plain<'_> for i64 {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<i64, Diagnostic> {
        whole_in(spec, args, i64::MIN..=i64::MAX)
    }
}

impl Plain<'_> for u32 {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<u32, Diagnostic> {
        whole_in(spec, args, 0..=u32::MAX.into()).map(|n| n as u32)
    }
}

impl Stated for u32 {
    fn of(constant: Constant) -> Option<u32> {
        f32::of(constant).map(|n| n as u32)
    }
}

impl Plain<'_> for i32 {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<i32, Diagnostic> {
        whole_in(spec, args, i32::MIN.into()..=i32::MAX.into()).map(|n| n as i32)
    }
}

impl Stated for i32 {
    fn of(constant: Constant) -> Option<i32> {
        f32::of(constant).map(|n| n as i32)
    }
}

/// A whole number from `min` to `max`.
pub(in crate::compile) const fn whole(key: &'static str, min: i32, max: i32) -> Typed<i32> {
    Typed::new(key, FieldKind::Whole { min: min as f64, max: max as f64 })
}

/// How many of something.
pub(in crate::compile) const fn count(key: &'static str, min: u32, max: u32) -> Typed<u32> {
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
pub(in crate::compile) const fn pair(key: &'static str) -> Typed<Vec2> {
    Typed::new(key, FieldKind::Numbers(&[NumberRange::ANY; 2]))
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
pub(in crate::compile) const fn flag(key: &'static str) -> Typed<bool> {
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
pub(in crate::compile) const fn triple(key: &'static str) -> Typed<[f32; 3]> {
    Typed::new(key, FieldKind::Numbers(&[NumberRange::ANY; 3]))
}

/// A place: three numbers.
pub(in crate::compile) const fn point(key: &'static str) -> Typed<Vec3> {
    Typed::new(key, FieldKind::Point)
}

/// A vector: three numbers.
pub(in crate::compile) const fn vector(key: &'static str) -> Typed<Vec3> {
    Typed::new(key, FieldKind::Vector)
}

/// A value that is one of a few words.
pub(in crate::compile) trait Choice: Copy + 'static {
    /// The words with what they stand for.
    const NAMES: &'static [(&'static str, Self)];
    /// The words alone.
    const WORDS: &'static [&'static str];
    /// Words that are understood as well, and listed nowhere.
    const SYNONYMS: &'static [(&'static str, Self)] = &[];
}

/// The words of a table.
pub(in crate::compile) const fn words<T: Copy, const N: usize>(
    table: &[(&'static str, T); N],
) -> [&'static str; N] {
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

pub(in crate::compile) use choices;

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
pub(in crate::compile) const fn choice<C: Choice>(key: &'static str) -> Typed<C> {
    Typed::new(key, FieldKind::Choice(C::WORDS))
}

/// A unit vector, written with any length but zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::compile) struct Direction(pub Vec3);

impl Plain<'_> for Direction {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Direction, Diagnostic> {
        let direction = args.vec3()?.try_normalize();
        direction.map(Direction).ok_or_else(|| args.error(format!("`{}` must not be zero", spec.key)))
    }
}

impl Stated for Direction {
    fn of(constant: Constant) -> Option<Direction> {
        Vec3::of(constant)?.try_normalize().map(Direction)
    }
}

/// A direction, which must not be zero.
pub(in crate::compile) const fn direction(key: &'static str) -> Typed<Direction> {
    Typed::new(key, FieldKind::Vector)
}

/// The name of a file, as it is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::compile) struct FileName(pub String);

impl Plain<'_> for FileName {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<FileName, Diagnostic> {
        args.text().map(|name| FileName(name.into_owned()))
    }
}

/// The name of a file.
pub(in crate::compile) const fn file(key: &'static str) -> Typed<FileName> {
    Typed::new(key, FieldKind::File)
}

impl Plain<'_> for Arc<Tape> {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Arc<Tape>, Diagnostic> {
        args.function()
    }
}

/// A function of x, y and z.
pub(in crate::compile) const fn function(key: &'static str) -> Typed<Arc<Tape>> {
    Typed::new(key, FieldKind::Function)
}
