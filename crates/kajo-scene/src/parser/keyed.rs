//! Numbers that change with time: keys, and expressions of `time` and `frame`.
//!
//! ```text
//! 'keys' MODE* '{' (TIME ':' NUMBER+)* '}'      in the place of one or more numbers
//! ```
//!
//! A mode is how numbers go from key to key, or what holds outside of them. Times are in seconds. All keys of a block
//! have equally many numbers, which are evaluated at each moment of the [`Clock`](crate::Clock).

use std::ops::Range;

use kajo_math::keyed::{Interpolation, KeyedError, KeyedNumbers, Outside};

use super::Parser;
use super::moments::Changing;
use super::values::{ends_well, resume_after};
use crate::diagnostic::quoted;
use crate::expression::{Around, Evaluated, ExpressionError};
use crate::lexer::{TokenKind, Tokens};
use crate::nearest::nearest;
use crate::source::Span;
use crate::tree::Expression;
use crate::written_keys::{KeysOwner, WrittenKey, WrittenKeys};

pub(super) const KEYS: &str = "keys";

const USAGE: &str = "write `keys { 0: 0.5  2: 1 }`, each time in seconds before its values";

impl Parser<'_> {
    /// Reads keys that start at the word `keys`, where a number may stand.
    ///
    /// Returns where reading goes on; `None` when the word is only a word.
    pub(super) fn keys(&mut self, word: Span, text: &str) -> Option<u32> {
        let taker = self.number_taker()?;
        let keyword = self.desc.nodes[taker as usize].keyword;
        let is_value =
            text[keyword.0 as usize..keyword.1 as usize].starts_with(|c: char| c.is_ascii_lowercase());
        if !are_keys(text, word.end, is_value) {
            return None;
        }
        match self.read_keys(text, word.start as usize) {
            Ok(read) => {
                let span = Span { end: read.end as u32, ..word };
                let (first, end) = self.desc.nodes[taker as usize].numbers;
                let curve = self.note_keys(KeysOwner::Item { item: taker, first: end - first }, span, read);
                let frames = |moment| self.clock.frames_at(moment);
                let rows: Vec<Vec<f64>> = (0..self.clock.len()).map(|i| curve.at(frames(i))).collect();
                self.desc.changes = true;
                self.desc.expressions.push(Expression { span, value: None });
                for c in 0..curve.width() {
                    self.add_changing(taker, span, rows.iter().map(|row| row[c]).collect());
                }
                Some(span.end)
            }
            Err(error) => {
                let end = behind_block(text, word.end).unwrap_or(resume_after(
                    text,
                    word.start as usize,
                    error.at.end,
                ));
                self.expression_error(word.source, error);
                self.add_number(taker, Span { end, ..word }, 0.0);
                Some(end)
            }
        }
    }

    /// Keys of one number that stand where an expression may, and where they end; `None` when none stand there.
    /// They are those of the value that is named next.
    pub(super) fn one_key_curve(
        &mut self,
        text: &str,
        start: usize,
    ) -> Option<Result<Changing, ExpressionError>> {
        let is_word = crate::expression::name_at(&text[start..]) == Some(KEYS);
        if !is_word || !are_keys(text, (start + KEYS.len()) as u32, true) {
            return None;
        }
        Some(self.read_keys(text, start).and_then(|read| {
            let (end, width) = (read.end, read.curve.width());
            if width != 1 {
                let message = format!("one number is wanted here, and these keys have {width}");
                return Err(ExpressionError { message, at: start..end, help: None });
            }
            let owner = KeysOwner::Value(self.desc.values.len() as u32);
            let span = Span { source: self.source(), start: start as u32, end: end as u32 };
            let curve = self.note_keys(owner, span, read);
            let at = |moment| curve.one_at(self.clock.frames_at(moment), 0);
            let values: Vec<f64> = (0..self.clock.len()).map(at).collect();
            Ok(Changing { evaluated: Evaluated { value: values[0], end, is_name: false }, values })
        }))
    }

    /// Remembers where keys are written; returns their curves.
    fn note_keys(&mut self, owner: KeysOwner, span: Span, read: ReadKeys) -> KeyedNumbers {
        let ReadKeys { curve, rows: keys, interpolation, outside, .. } = read;
        if self.is_first_turn() {
            let is_repeated = !self.repeats.is_empty();
            self.desc.keyed.push(WrittenKeys { span, owner, interpolation, outside, keys, is_repeated });
        }
        curve
    }

    /// The curves of keys, their times in frames, and where the block ends.
    fn read_keys(&self, text: &str, start: usize) -> Result<ReadKeys, ExpressionError> {
        let mut tokens = Tokens::resume(text, (start + KEYS.len()) as u32);
        let (mut interpolation, mut outside) = (Interpolation::default(), Outside::default());
        let mut at = loop {
            let Some(token) = tokens.next_significant() else {
                return Err(unclosed(start..start + KEYS.len()));
            };
            match token.kind {
                TokenKind::OpenBrace => break token.end as usize,
                _ => read_mode(&text[token.range()], token.range(), &mut interpolation, &mut outside)?,
            }
        };
        let mut rows: Vec<WrittenKey> = Vec::new();
        loop {
            let next = Tokens::resume(text, at as u32).next_significant();
            let Some(next) = next else { return Err(unclosed(start..at)) };
            if next.kind == TokenKind::CloseBrace {
                let end = next.end as usize;
                let curve = self.curve(&rows, start..end, interpolation, outside)?;
                return Ok(ReadKeys { curve, rows, interpolation, outside, end });
            }
            at = self.key_number(text, next.start as usize, &mut rows)?;
        }
    }

    /// Reads a number of a block of keys, which may be the time of the next one; returns where it ends.
    fn key_number(
        &self,
        text: &str,
        start: usize,
        rows: &mut Vec<WrittenKey>,
    ) -> Result<usize, ExpressionError> {
        let Changing { evaluated: Evaluated { value, end, .. }, values } =
            self.evaluate_changing(text, start, Around::List)?;
        let at = start..end;
        if !values.is_empty() {
            let message = "keys are the same at all times".to_owned();
            let help = "a function of the time stands for itself: `radius (2 * time)`".to_owned();
            return Err(ExpressionError { message, at, help: Some(help) });
        }
        let rest = text[end..].trim_start();
        if rest.starts_with(':') {
            rows.push(WrittenKey { time: value, time_place: at, values: Vec::new() });
            return Ok(text.len() - rest.len() + 1);
        }
        ends_well(text, end)?;
        let Some(row) = rows.last_mut() else {
            let message = "a key begins with its time and `:`".to_owned();
            return Err(ExpressionError { message, at, help: Some(USAGE.to_owned()) });
        };
        row.values.push((value, at));
        Ok(end)
    }

    fn curve(
        &self,
        rows: &[WrittenKey],
        whole: Range<usize>,
        interpolation: Interpolation,
        outside: Outside,
    ) -> Result<KeyedNumbers, ExpressionError> {
        let numbers = |row: &WrittenKey| row.values.iter().map(|(value, _)| *value).collect();
        let keys: Vec<(f64, Vec<f64>)> =
            rows.iter().map(|row| (self.clock.in_frames(row.time), numbers(row))).collect();
        KeyedNumbers::new(&keys, interpolation, outside)
            .map_err(|error| {
                let usage = Some(USAGE.to_owned());
                let (message, at, help) = match error {
                    KeyedError::Empty => ("there is no key in these `keys`".to_owned(), whole, usage),
                    KeyedError::Order(i) => {
                        let before = rows[i.saturating_sub(1)].time;
                        let message =
                            format!("keys stand in the order of time, each later than the last ({before})");
                        (message, rows[i].time_place.clone(), None)
                    }
                    KeyedError::Values(i) => {
                        let (first, here) = (rows[0].values.len(), rows[i].values.len());
                        let message = format!("this key has {here} values, and the first one {first}");
                        (message, rows[i].time_place.clone(), None)
                    }
                };
                ExpressionError { message, at, help }
            })
            .and_then(|curve| {
                if curve.width() > 0 {
                    return Ok(curve);
                }
                let message = "a key has a value behind its time".to_owned();
                Err(ExpressionError { message, at: rows[0].time_place.clone(), help: Some(USAGE.to_owned()) })
            })
    }
}

/// What was read of a block of keys.
struct ReadKeys {
    curve: KeyedNumbers,
    rows: Vec<WrittenKey>,
    interpolation: Interpolation,
    outside: Outside,
    /// One past the closing brace.
    end: usize,
}

fn unclosed(at: Range<usize>) -> ExpressionError {
    ExpressionError {
        message: "the block of `keys` is not closed".to_owned(),
        at,
        help: Some(USAGE.to_owned()),
    }
}

/// Takes one of the words between `keys` and its block.
fn read_mode(
    word: &str,
    at: Range<usize>,
    interpolation: &mut Interpolation,
    outside: &mut Outside,
) -> Result<(), ExpressionError> {
    let named = Interpolation::NAMES.iter().find(|(name, _)| *name == word);
    let around = Outside::NAMES.iter().find(|(name, _)| *name == word);
    match (named, around) {
        (Some(found), _) => *interpolation = found.1,
        (_, Some(found)) => *outside = found.1,
        _ => {
            let names = || {
                let outside = Outside::NAMES.iter().map(|(name, _)| *name);
                Interpolation::NAMES.iter().map(|(name, _)| *name).chain(outside)
            };
            let help = match nearest(word, names()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("expected one of {}", names().collect::<Vec<_>>().join(", ")),
            };
            let message = format!("keys cannot be {}", quoted(word));
            return Err(ExpressionError { message, at, help: Some(help) });
        }
    }
    Ok(())
}

/// Whether a block of keys follows, and not that of an object with this name.
///
/// * `is_value`: whether the item is no block of the language
fn are_keys(text: &str, behind: u32, is_value: bool) -> bool {
    let mut tokens = Tokens::resume(text, behind);
    let mut modes = 0;
    loop {
        match tokens.next_significant() {
            Some(token) if token.kind == TokenKind::OpenBrace => {
                let content = &text[token.end as usize..];
                let Some(end) = content.find([':', '{', '}', '"']) else { return is_value };
                let is_empty = content[..end].trim().is_empty();
                return match content.as_bytes()[end] {
                    b':' => true,
                    b'}' => is_value || (is_empty && modes > 0),
                    _ => false,
                };
            }
            Some(token) if token.kind == TokenKind::Word && modes < 3 => modes += 1,
            _ => return false,
        }
    }
}

/// One past the brace that closes the next block, if it is closed.
fn behind_block(text: &str, from: u32) -> Option<u32> {
    let mut tokens = Tokens::resume(text, from);
    let mut depth = 0_usize;
    while let Some(token) = tokens.next_significant() {
        match token.kind {
            TokenKind::OpenBrace => depth += 1,
            TokenKind::CloseBrace if depth <= 1 => return (depth == 1).then_some(token.end),
            TokenKind::CloseBrace => depth -= 1,
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests;
