//! Values of fields as a scene writes them.

use std::borrow::Cow;

use kajo_scene::{Item, TokenKind, Value, format_number, tokens};

/// A value that a description states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Constant {
    /// One number.
    Number(f64),
    /// Two numbers.
    Pair([f64; 2]),
    /// Three numbers.
    Triple([f64; 3]),
    /// A word.
    Word(&'static str),
    /// A value as a scene writes it.
    Text(&'static str),
}

/// What stands after a key: at most one word, then numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FieldValue {
    /// A word, name or text, without quotes; or a function with its equals sign and a blank behind that.
    pub word: Option<String>,
    /// Numbers.
    pub numbers: Vec<f64>,
}

impl FieldValue {
    /// Numbers alone.
    pub fn numbers(numbers: impl IntoIterator<Item = f64>) -> FieldValue {
        FieldValue { word: None, numbers: numbers.into_iter().collect() }
    }

    /// A word alone.
    pub fn word(word: impl Into<String>) -> FieldValue {
        FieldValue { word: Some(word.into()), numbers: Vec::new() }
    }

    /// `on` or `off`.
    pub fn flag(on: bool) -> FieldValue {
        FieldValue::word(if on { "on" } else { "off" })
    }

    /// The first three numbers, if there are as many.
    pub fn vec3(&self) -> Option<[f64; 3]> {
        self.numbers.first_chunk().copied()
    }

    /// The value as a scene says it.
    pub fn text(&self) -> String {
        let word = self.word.as_deref().map(quoted);
        let numbers = self.numbers.iter().map(|&number| number_text(number));
        word.into_iter().map(Cow::into_owned).chain(numbers).collect::<Vec<_>>().join(" ")
    }

    /// The value that stands in an item.
    pub fn of(item: Item<'_>) -> FieldValue {
        FieldValue {
            word: item.word().map(|word| match word.value() {
                Value::Function(text) => format!("= {}", text[1..].trim_start()),
                _ => word.text().into_owned(),
            }),
            numbers: item.numbers().map(|(number, _)| number).collect(),
        }
    }

    /// The value that a text of a description stands for.
    pub fn parse(text: &str) -> FieldValue {
        let mut value = FieldValue::default();
        for word in text.split_whitespace() {
            match word.parse() {
                Ok(number) => value.numbers.push(number),
                Err(_) => value.word = Some(word.to_owned()),
            }
        }
        value
    }
}

impl From<Constant> for FieldValue {
    fn from(constant: Constant) -> FieldValue {
        match constant {
            Constant::Number(number) => FieldValue::numbers([number]),
            Constant::Pair(numbers) => FieldValue::numbers(numbers),
            Constant::Triple(numbers) => FieldValue::numbers(numbers),
            Constant::Word(word) => FieldValue::word(word),
            Constant::Text(text) => FieldValue::parse(text),
        }
    }
}

/// The shortest text of a number, in single precision where that is what it has.
pub fn number_text(number: f64) -> String {
    let single = number as f32;
    if f64::from(single) == number { format_number(single) } else { format_number(number) }
}

/// A word as it is written: in quotes where it needs them, which a function never does.
pub fn quoted(word: &str) -> Cow<'_, str> {
    if word.starts_with("= ") {
        return Cow::Borrowed(word);
    }
    let mut all = tokens(word);
    let is_word = all.next().is_some_and(|token| token.kind == TokenKind::Word) && all.next().is_none();
    if is_word && word != "include" {
        return Cow::Borrowed(word);
    }
    Cow::Owned(format!("\"{}\"", word.replace('\\', "\\\\").replace('"', "\\\"")))
}
