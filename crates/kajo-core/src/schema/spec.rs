//! The description of a field.

use std::fmt;
use std::ops::Bound;

use super::{Constant, FieldValue};
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
    /// Linear red, green and blue, one number for white, or a light source's name with its factor.
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
    /// A function of the place behind an equals sign, or a number.
    Function,
    /// The name or number of a material.
    Material,
    /// The name of an integrator. Whoever knows which there are puts a [`FieldKind::Choice`] in its place.
    Integrator,
}

impl FieldKind {
    /// Any number.
    pub const NUMBER: FieldKind = FieldKind::Number { min: f64::MIN, max: f64::MAX };
    /// A number above zero.
    pub const POSITIVE: FieldKind = FieldKind::Number { min: f64::MIN_POSITIVE, max: f64::MAX };
    /// A part of a whole.
    pub const SHARE: FieldKind = FieldKind::Number { min: 0.0, max: 1.0 };

    /// A value to begin with where nothing better is known; none for what has to be typed.
    pub fn plain(self) -> FieldValue {
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
            FieldKind::File
            | FieldKind::Text
            | FieldKind::Function
            | FieldKind::Material
            | FieldKind::Integrator => FieldValue::default(),
        }
    }

    /// The bounds of a number; none of what is no single number.
    pub fn bounds(self) -> (Bound<f64>, Bound<f64>) {
        let (FieldKind::Number { min, max } | FieldKind::Whole { min, max } | FieldKind::Angle { min, max }) =
            self
        else {
            return (Bound::Unbounded, Bound::Unbounded);
        };
        let low = match min {
            f64::MIN => Bound::Unbounded,
            f64::MIN_POSITIVE => Bound::Excluded(0.0),
            _ => Bound::Included(min),
        };
        (low, if max == f64::MAX { Bound::Unbounded } else { Bound::Included(max) })
    }
}

impl fmt::Display for FieldKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            FieldKind::Number { min, max } => write!(f, "number{}", Range { min, max }),
            FieldKind::Whole { min, max } => write!(f, "whole number{}", Range { min, max }),
            FieldKind::Angle { min, max } => write!(f, "degrees{}", Range { min, max }),
            FieldKind::Point | FieldKind::Vector => f.write_str("x y z"),
            FieldKind::Color => f.write_str("r g b"),
            FieldKind::Reflectance => f.write_str("r g b, or a file or spectrum"),
            FieldKind::Emission => f.write_str("r g b, or another light value"),
            FieldKind::Flag => f.write_str("on or off"),
            FieldKind::Choice(words) => f.write_str(&one_of(words)),
            FieldKind::ChoiceAndNumber(words) => write!(f, "{}; then a number", one_of(words)),
            FieldKind::ChoiceAndWhole(words) => write!(f, "{}; then a whole number", one_of(words)),
            FieldKind::Numbers(count) => write!(f, "{count} numbers"),
            FieldKind::Wholes(count) => write!(f, "{count} whole numbers"),
            FieldKind::File => f.write_str("file"),
            FieldKind::Text => f.write_str("word or text"),
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

/// The bounds of a number behind what it is.
struct Range {
    min: f64,
    max: f64,
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Range { min, max } = *self;
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
    /// What a render of that scene takes for the settings that have a say in it, when nobody asks for anything else.
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
    /// Whether a texture may stand in place of its value.
    pub texture: bool,
    /// What its numbers count; empty where that is no unit.
    pub unit: &'static str,
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
    /// A field that must be there and of which nothing else is known yet.
    pub const fn new(key: &'static str, kind: FieldKind) -> FieldSpec {
        FieldSpec {
            key,
            kind,
            texture: false,
            unit: "",
            absent: Absent::Required,
            needs: None,
            excludes: &[],
            same_as: None,
            pair: None,
            about: "",
        }
    }

    /// The same for a field that may be a texture.
    pub const fn or_texture(self) -> FieldSpec {
        FieldSpec { texture: true, ..self }
    }

    /// The same for a field that says nothing, or is an error, where `key` is not written.
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

    /// The same for a field that says nothing without the one called `key`, which says nothing without this one.
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
        let texture = if self.texture { ", or a texture" } else { "" };
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
