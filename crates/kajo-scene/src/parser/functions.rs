//! Values behind an equals sign.
//!
//! ```text
//! KEYWORD = EXPRESSION
//! ```
//!
//! An expression without variables is a number. One with `x`, `y` or `z` in it is a function of the place; named values are
//! what they are where it stands.

use std::cell::{Cell, RefCell};
use std::sync::Arc;

use super::keyed::KEYS;
use super::moments::Moment;
use super::values::{ends_well, resume_after};
use super::{Expect, Parser};
use crate::expression::{Around, Formula, formula, name_at};
use crate::lexer::number;
use crate::source::Span;
use crate::tree::{Expression, Function, Insert};

impl Parser<'_> {
    /// Reads the expression behind an equals sign that stands where a value may; returns where reading goes on.
    pub(super) fn equals(&mut self, sign: u32, span: Span, text: &str) -> u32 {
        let start = sign as usize + 1;
        let start = text.len() - text[start..].trim_start().len();
        let node = self.desc.nodes.len() as u32 - 1;
        if text[start..].starts_with(KEYS) {
            let place = Span { start: start as u32, end: (start + KEYS.len()) as u32, ..span };
            if let Some(end) = self.keys(place, text) {
                return end;
            }
        }
        let inserts = RefCell::new(Vec::new());
        let has_changed = Cell::new(false);
        let at_frame = Moment { scope: &self.scope, clock: self.clock, moment: 0, has_changed: &has_changed };
        let found = formula(text, start, &|name, at| {
            let value = at_frame.value(name)?;
            inserts.borrow_mut().push(Insert { start: at.start as u32, end: at.end as u32, value });
            Some(value)
        });
        self.desc.changes |= has_changed.get();
        match found.and_then(|found| ends_well(text, found.1).map(|()| found)) {
            Ok((Formula::Number(value), end)) => {
                let place = Span { start: start as u32, end: end as u32, ..span };
                let written = &text[place.range()];
                if number(written).is_none() {
                    let value = self.scope.find(written).map(|(_, index)| index);
                    self.desc.expressions.push(Expression { span: place, value });
                }
                let values = if has_changed.get() {
                    // It has a value at the frame, so it is read to the same end at other moments.
                    self.evaluate_changing(text, start, Around::Nothing).map(|found| found.values)
                } else {
                    Ok(Vec::new())
                };
                match values {
                    Ok(values) => self.add_value(node, place, value, values),
                    Err(error) => {
                        self.expression_error(span.source, error);
                        self.add_number(node, place, 0.0);
                    }
                }
                end as u32
            }
            Ok((Formula::Function(tape), end)) => {
                self.desc.functions.push(Function { node, tape: Arc::new(tape), inserts: inserts.take() });
                self.take_word(sign, end as u32);
                end as u32
            }
            Err(error) => {
                let end = resume_after_operators(text, resume_after(text, start, error.at.end.max(start)));
                self.expression_error(span.source, error);
                self.add_number(node, Span { start: sign, end, ..span }, 0.0);
                end
            }
        }
    }

    /// The keyword of `radius=2`, which begins an item.
    pub(super) fn keyword_of_equation<'t>(&self, word: &'t str) -> Option<&'t str> {
        let name = name_at(word).filter(|_| self.expect != Expect::Value)?;
        word[name.len()..].starts_with('=').then_some(name)
    }

    /// Makes a piece of the text the word of the item last begun.
    pub(super) fn take_word(&mut self, start: u32, end: u32) {
        if let Some(node) = self.desc.nodes.last_mut() {
            node.word = (start, end);
            node.end = end;
        }
        self.expect = Expect::Number;
    }
}

/// Where reading goes on after a mistake before `at`: behind what operators join to it.
fn resume_after_operators(text: &str, mut at: u32) -> u32 {
    loop {
        let rest = text[at as usize..].trim_start();
        let joins = match rest.bytes().next() {
            Some(b'*' | b'%' | b'^') => true,
            Some(b'/') => !rest[1..].starts_with(['/', '*']),
            Some(b'+' | b'-') => rest[1..].starts_with(char::is_whitespace),
            _ => false,
        };
        if !joins {
            return at;
        }
        let operand = text.len() - rest[1..].trim_start().len();
        at = resume_after(text, operand, operand + 1);
    }
}

#[cfg(test)]
mod tests;
