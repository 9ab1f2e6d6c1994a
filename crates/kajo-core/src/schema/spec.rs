//! The description of a field.

use std::fmt;
use std::ops::{Bound, RangeBounds, RangeInclusive};

use super::{Block, Constant, FieldValue};
use crate::scene::Scene;
use crate::settings::{Dialect, Rules, Settings};

/// The type of a field's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldKind {
    /// A number within bounds; `f64::MIN` and `f64::MAX` stand for none, and a least of `f64::MIN_POSITIVE` for above zero.
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
    /// How many members a list has, or objects a group.
    Count,
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
    /// Linear red, green and blue, each within a range.
    Color(NumberRange),
    /// A position of a ramp, and the linear red, green and blue there, each from 0 to 1.
    ColorStop,
    /// Linear red, green and blue; or a file or `spectrum` with its numbers.
    Reflectance,
    /// Linear red, green and blue, one number for white, or a light source's name with its factor.
    Emission,
    /// `on` or `off`.
    Flag,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// One of these words, and then at most one number.
    ChoiceAndNumber(&'static [&'static str], NumberRange),
    /// One of these words, and then a whole number.
    ChoiceAndWhole(&'static [&'static str], NumberRange),
    /// Numbers with these ranges, or fewer.
    Numbers(&'static [NumberRange]),
    /// Whole numbers with these ranges.
    Wholes(&'static [NumberRange]),
    /// Numbers in groups with these ranges, any number of groups.
    Groups(&'static [NumberRange]),
    /// The name of a file.
    File,
    /// A word or some text.
    Text,
    /// The name of a picture.
    Picture,
    /// A function of the place behind an equals sign, or a number.
    Function,
    /// The name or number of a material.
    Material,
    /// The name of an integrator. The facade, which has their list, puts a [`FieldKind::Choice`] in its place.
    Integrator,
}

impl FieldKind {
    /// Any number.
    pub const NUMBER: FieldKind = FieldKind::Number { min: f64::MIN, max: f64::MAX };
    /// A number above zero.
    pub const POSITIVE: FieldKind = FieldKind::Number { min: f64::MIN_POSITIVE, max: f64::MAX };
    /// A part of a whole.
    pub const SHARE: FieldKind = FieldKind::Number { min: 0.0, max: 1.0 };
    /// Any colour.
    pub const COLOR: FieldKind = FieldKind::Color(NumberRange::ANY);

    /// A value to begin with where nothing better is known; none for what has to be typed.
    pub fn plain(self) -> FieldValue {
        match self {
            FieldKind::Number { min, max }
            | FieldKind::Whole { min, max }
            | FieldKind::Angle { min, max } => FieldValue::numbers([1f64.clamp(min, max)]),
            FieldKind::Count => FieldValue::numbers([1.0]),
            FieldKind::Point | FieldKind::Vector => FieldValue::numbers([0.0, 1.0, 0.0]),
            FieldKind::Color(_) | FieldKind::Reflectance | FieldKind::Emission => {
                FieldValue::numbers([1.0; 3])
            }
            FieldKind::ColorStop => FieldValue::numbers([1.0; 4]),
            FieldKind::Flag => FieldValue::flag(true),
            FieldKind::Choice(words)
            | FieldKind::ChoiceAndNumber(words, _)
            | FieldKind::ChoiceAndWhole(words, _) => {
                words.first().map_or_else(FieldValue::default, |word| FieldValue::word(*word))
            }
            FieldKind::Numbers(ranges) | FieldKind::Wholes(ranges) => {
                FieldValue::numbers(ranges.iter().map(|range| 1f64.clamp(range.min, range.max)))
            }
            FieldKind::Groups(_)
            | FieldKind::File
            | FieldKind::Text
            | FieldKind::Picture
            | FieldKind::Function
            | FieldKind::Material
            | FieldKind::Integrator => FieldValue::default(),
        }
    }

    /// The bounds of a number; none of what is no single number.
    pub fn bounds(self) -> (Bound<f64>, Bound<f64>) {
        self.range(0).bounds()
    }

    /// The range of one of its numbers, counted from 0; of groups the first one tells.
    pub fn range(self, index: usize) -> NumberRange {
        match self {
            FieldKind::Number { min, max }
            | FieldKind::Whole { min, max }
            | FieldKind::Angle { min, max } => NumberRange { min, max },
            FieldKind::Color(range)
            | FieldKind::ChoiceAndNumber(_, range)
            | FieldKind::ChoiceAndWhole(_, range) => range,
            FieldKind::Numbers(ranges) | FieldKind::Wholes(ranges) | FieldKind::Groups(ranges) => {
                ranges.get(index).copied().unwrap_or(NumberRange::ANY)
            }
            FieldKind::ColorStop if index > 0 => NumberRange::SHARE,
            _ => NumberRange::ANY,
        }
    }
}

impl fmt::Display for FieldKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            FieldKind::Number { min, max } => write!(f, "number{}", NumberRange { min, max }),
            FieldKind::Whole { min, max } => write!(f, "whole number{}", NumberRange { min, max }),
            FieldKind::Count => f.write_str("whole number ≥ 0"),
            FieldKind::Angle { min, max } => write!(f, "degrees{}", NumberRange { min, max }),
            FieldKind::Point | FieldKind::Vector => f.write_str("x y z"),
            FieldKind::Color(range) => write!(f, "r g b{range}"),
            FieldKind::ColorStop => f.write_str("a number, then r g b from 0 to 1"),
            FieldKind::Reflectance => f.write_str("r g b, or a file or spectrum"),
            FieldKind::Emission => f.write_str("r g b, or another light value"),
            FieldKind::Flag => f.write_str("on or off"),
            FieldKind::Choice(words) => f.write_str(&one_of(words)),
            FieldKind::ChoiceAndNumber(words, range) => write!(f, "{}; then a number{range}", one_of(words)),
            FieldKind::ChoiceAndWhole(words, range) => {
                write!(f, "{}; then a whole number{range}", one_of(words))
            }
            FieldKind::Numbers(ranges) => write!(f, "{} numbers{}", ranges.len(), of_each(ranges)),
            FieldKind::Wholes(ranges) => write!(f, "{} whole numbers{}", ranges.len(), of_each(ranges)),
            FieldKind::Groups(ranges @ [_]) => write!(f, "numbers{}", of_each(ranges)),
            FieldKind::Groups(ranges) => {
                write!(f, "numbers in groups of {}{}", ranges.len(), of_each(ranges))
            }
            FieldKind::File => f.write_str("file"),
            FieldKind::Text => f.write_str("word or text"),
            FieldKind::Picture => f.write_str("picture"),
            FieldKind::Function => f.write_str("= function of x, y, z"),
            FieldKind::Material => f.write_str("name or number"),
            FieldKind::Integrator => f.write_str("name of an integrator"),
        }
    }
}

/// "a, b or c".
fn one_of(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [word] => (*word).to_owned(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    }
}

/// The ranges of some numbers behind what they are: once where they are alike.
fn of_each(ranges: &[NumberRange]) -> String {
    match ranges {
        [first, rest @ ..] if rest.iter().all(|range| range == first) => first.to_string(),
        _ => {
            let each = ranges.iter().map(|range| match *range {
                NumberRange::ANY => "any".to_owned(),
                range => range.to_string().trim_start().to_owned(),
            });
            format!(": {}", each.collect::<Vec<_>>().join(", "))
        }
    }
}

/// What a number may be; `f64::MIN` and `f64::MAX` stand for no bound, and a least of `f64::MIN_POSITIVE` for above zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberRange {
    /// The least.
    pub min: f64,
    /// The most.
    pub max: f64,
}

impl NumberRange {
    /// Any number.
    pub const ANY: NumberRange = NumberRange { min: f64::MIN, max: f64::MAX };
    /// A number that is not negative.
    pub const NOT_NEGATIVE: NumberRange = NumberRange { min: 0.0, max: f64::MAX };
    /// A number above zero.
    pub const POSITIVE: NumberRange = NumberRange { min: f64::MIN_POSITIVE, max: f64::MAX };
    /// A part of a whole.
    pub const SHARE: NumberRange = NumberRange { min: 0.0, max: 1.0 };

    /// Its bounds.
    pub fn bounds(self) -> (Bound<f64>, Bound<f64>) {
        let low = match self.min {
            f64::MIN => Bound::Unbounded,
            f64::MIN_POSITIVE => Bound::Excluded(0.0),
            min => Bound::Included(min),
        };
        (low, if self.max == f64::MAX { Bound::Unbounded } else { Bound::Included(self.max) })
    }

    /// The whole numbers within it.
    pub fn wholes(self) -> RangeInclusive<i64> {
        self.min.ceil() as i64..=self.max as i64
    }

    /// Whether it has a number.
    pub fn contains(self, number: f64) -> bool {
        self.bounds().contains(&number)
    }
}

impl fmt::Display for NumberRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let NumberRange { min, max } = *self;
        match (min == f64::MIN, max == f64::MAX) {
            (true, true) => Ok(()),
            (false, true) if min == f64::MIN_POSITIVE => f.write_str(" > 0"),
            (false, true) => write!(f, " ≥ {min}"),
            (true, false) => write!(f, " ≤ {max}"),
            (false, false) => write!(f, " from {min} to {max}"),
        }
    }
}

/// What is around a field.
pub struct Around<'a> {
    /// The value that holds for a key of the same block.
    pub value: &'a dyn Fn(&str) -> Option<FieldValue>,
    /// Whether a key is written in the same block.
    pub is_written: &'a dyn Fn(&str) -> bool,
    /// The scene that the text makes, where there is one.
    pub scene: Option<&'a Scene>,
    /// The default settings of a render of that scene, where they influence a value.
    pub render: &'a dyn Fn() -> Option<Settings>,
}

impl Around<'_> {
    /// The first number of the value that holds for a key.
    pub fn number(&self, key: &str) -> Option<f64> {
        (self.value)(key)?.numbers.first().copied()
    }

    /// A colour, unless it is a spectrum or a picture.
    pub fn color(&self, key: &str) -> Option<FieldValue> {
        (self.value)(key).filter(|value| value.word.is_none() && value.numbers.len() == 3)
    }

    /// The conventions of the scene's dialect.
    pub fn rules(&self) -> Rules {
        self.scene.map_or_else(|| Dialect::default().rules(), |scene| scene.output.rules)
    }
}

/// What holds while a field is absent.
#[derive(Clone, Copy, Debug)]
pub enum Absent {
    /// Nothing does: the block is an error without it.
    Required,
    /// This value.
    Value(Constant),
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
    /// Where a texture may stand in place of its value: what may be written in the block behind that.
    pub texture: Option<&'static Block>,
    /// What its numbers count; empty where that is no unit.
    pub unit: &'static str,
    /// The range in which it is mostly tried, of a number or of the length of a vector: that of a slider. By powers where it is all positive.
    pub slider: Option<[f64; 2]>,
    /// What holds while it is absent.
    pub absent: Absent,
    /// A field without which it has no effect, or is an error.
    pub needs: Option<&'static str>,
    /// Fields beside which it is an error.
    pub excludes: &'static [&'static str],
    /// The key whose other spelling this is: the two are one field.
    pub same_as: Option<&'static str>,
    /// A field that is an error without this one, and this one without it: both are set, and taken out, together.
    pub pair: Option<&'static str>,
    /// Whether there may be any number of it, in an order that counts.
    pub repeats: bool,
    /// What it says, in a few words.
    pub about: &'static str,
}

impl FieldSpec {
    /// A field that must be there and of which nothing else is known yet.
    pub const fn new(key: &'static str, kind: FieldKind) -> FieldSpec {
        FieldSpec {
            key,
            kind,
            texture: None,
            unit: "",
            slider: None,
            absent: Absent::Required,
            needs: None,
            excludes: &[],
            same_as: None,
            pair: None,
            repeats: false,
            about: "",
        }
    }

    /// The same for a field that may be a texture, behind whose name `block` says more.
    pub const fn or_texture(self, block: &'static Block) -> FieldSpec {
        FieldSpec { texture: Some(block), ..self }
    }

    /// The same for a field that has no effect, or is an error, where `key` is not written.
    pub const fn only_beside(self, key: &'static str) -> FieldSpec {
        FieldSpec { needs: Some(key), ..self }
    }

    /// The same for a field that is an error where any of `keys` is written.
    pub const fn not_beside(self, keys: &'static [&'static str]) -> FieldSpec {
        FieldSpec { excludes: keys, ..self }
    }

    /// The same as another spelling of `key`.
    pub const fn spelling_of(self, key: &'static str) -> FieldSpec {
        FieldSpec { same_as: Some(key), ..self }
    }

    /// The same for a field that has no effect without the one called `key`, which has no effect without this one.
    pub const fn together_with(self, key: &'static str) -> FieldSpec {
        FieldSpec { pair: Some(key), ..self }
    }

    /// The key that stands for all spellings of this field.
    pub fn main_key(&self) -> &'static str {
        self.same_as.unwrap_or(self.key)
    }

    /// What may be written, with its range and its unit, for people.
    pub fn values(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(", {}", self.unit) };
        let texture = if self.texture.is_some() { ", or a texture" } else { "" };
        format!("{}{unit}{texture}", self.kind)
    }

    /// What holds while it is absent, for people.
    pub fn absence(&self) -> String {
        match self.absent {
            Absent::Required => "required".to_owned(),
            Absent::Value(constant) => FieldValue::from(constant).text(),
            Absent::Rule { means: "", .. } => "by what is beside it".to_owned(),
            Absent::Rule { means, .. } | Absent::Nothing { means, .. } => means.to_owned(),
        }
    }
}
