//! Named values, expressions and repeated blocks.
//!
//! ```text
//! let NAME = EXPRESSION                   a value, up to the end of the block it stands in
//! repeat NAME EXPRESSION { item* }        the items again and again, with NAME 0, 1, 2, ...
//! ```
//!
//! A repeated block is read again for each turn, so its items are in the tree as if they had been written out; which
//! turn an item comes from is known by its source (see [`Sources::repetition`](crate::Sources::repetition)). Every turn
//! counts as an item, so that however repeats stand in each other, reading ends.

use super::moments::{Changing, is_time};
use super::{Block, Expect, Parser, Stop};
use crate::diagnostic::{Diagnostic, Severity, quoted};
use crate::expression::{self, Around, ExpressionError, evaluate, name_at};
use crate::lexer::{TokenKind, Tokens, looks_like_number, number};
use crate::source::{SourceId, Span};
use crate::tree::{Expression, NamedValue};

pub(super) const LET: &str = "let";
pub(super) const REPEAT: &str = "repeat";

/// A `repeat` whose block is open.
pub(super) struct Repeat {
    /// Its variable, among [`crate::source::Sources::add_turn`]'s names.
    variable: u32,
    name: String,
    name_span: Span,
    turn: u64,
    turns: u64,
    /// Where the block's content begins.
    body: u32,
    /// The source that surrounds it.
    outer: SourceId,
    /// Errors before this turn.
    errors: usize,
}

/// What a word after a keyword may be besides a word.
#[derive(PartialEq)]
enum Meaning {
    Word,
    /// The beginning of an expression.
    Expression,
    /// An operator that goes on from the last number.
    Operator,
}

impl Parser<'_> {
    /// Reads an expression that starts at a word, where a number may stand.
    ///
    /// Returns where reading goes on; `None` when the word is a word.
    pub(super) fn expression(&mut self, span: Span, text: &str) -> Option<u32> {
        let word = &text[span.range()];
        let taker = self.number_taker()?;
        let start = match self.meaning(word, &text[span.end as usize..]) {
            Meaning::Word => return None,
            Meaning::Expression => span.start,
            Meaning::Operator => {
                let last = self.desc.numbers.pop()?;
                self.desc.nodes[taker as usize].numbers.1 -= 1;
                if self.desc.changing.last().is_some_and(|last| last.0 as usize == self.desc.numbers.len()) {
                    self.desc.changing.pop();
                }
                last.start
            }
        };
        let found = self.evaluate_changing(text, start as usize, Around::List);
        let found = found.and_then(|found| {
            let end = found.evaluated.end;
            // A sign at the end of a block joins nothing.
            if end <= span.start as usize {
                let message = format!("expected a number after {}", quoted(word));
                return Err(ExpressionError { message, at: span.range(), help: None });
            }
            ends_well(text, end).map(|()| found)
        });
        match found {
            Ok(Changing { evaluated: found, values }) => {
                let whole = Span { start, end: found.end as u32, ..span };
                let name = &text[whole.range()];
                let value = self.scope.find(name).filter(|_| found.is_name).map(|(_, index)| index);
                self.desc.expressions.push(Expression { span: whole, value });
                self.add_value(taker, whole, found.value, values);
                Some(whole.end)
            }
            Err(error) => {
                let end = resume_after(text, start as usize, error.at.end.max(span.end as usize));
                self.expression_error(span.source, error);
                self.add_number(taker, Span { start, end, ..span }, 0.0);
                Some(end)
            }
        }
    }

    /// * `behind`: what follows the word
    fn meaning(&self, word: &str, behind: &str) -> Meaning {
        let is_value = self.expect == Expect::Value;
        let has_left = matches!(self.expect, Expect::Number | Expect::BlockNumber)
            && self.number_taker().is_some_and(|taker| {
                let (first, end) = self.desc.nodes[taker as usize].numbers;
                first < end && end as usize == self.desc.numbers.len()
            });
        if has_left && (matches!(word, "+" | "-") || word.starts_with(['*', '/', '%', '^'])) {
            return Meaning::Operator;
        }
        let unsigned = word.trim_start_matches(['-', '+']);
        if unsigned.starts_with('(') {
            // `(2).obj` names a file.
            let behind = closing(unsigned).map_or("", |at| &unsigned[at + 1..]);
            let goes_on = behind.starts_with(['*', '^', '%'])
                || behind
                    .strip_prefix('/')
                    .is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit() || c == '('));
            let is_name = is_value && !behind.is_empty() && !goes_on && !behind.ends_with(['}', '{', ')']);
            return if is_name { Meaning::Word } else { Meaning::Expression };
        }
        // A path has slashes too.
        let goes_on = |rest: &str| {
            rest.starts_with(['*', '^', '%'])
                || (!is_value && rest.starts_with('/') && !rest[1..].starts_with(['/', '*']))
        };
        if let Some(name) = name_at(unsigned) {
            let rest = &unsigned[name.len()..];
            let is_call = rest.starts_with('(') && expression::is_function(name);
            // After a keyword the time is a word unless it is a part of something.
            let is_part = || !is_value || goes_on(rest) || goes_on_with_numbers(behind);
            let is_known = (rest.is_empty() || goes_on(rest))
                && (self.scope.get(name).is_some() || (is_time(name) && is_part()));
            return if is_call || is_known { Meaning::Expression } else { Meaning::Word };
        }
        let digits = unsigned.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
        if looks_like_number(word) && goes_on(digits) { Meaning::Expression } else { Meaning::Word }
    }

    pub(super) fn expression_error(&mut self, source: SourceId, error: ExpressionError) {
        let span = Span { source, start: error.at.start as u32, end: error.at.end as u32 };
        self.error(Diagnostic::error(error.message).label(span, "").maybe_help(error.help));
    }

    /// Reads what follows a `let`, and moves `tokens` behind it.
    pub(super) fn let_value<'t>(&mut self, keyword: Span, tokens: &mut Tokens<'t>, text: &'t str) {
        let source = keyword.source;
        let wrong = |span: Span, label: &str| {
            Diagnostic::error("a `let` gives a name to a number")
                .label(span, label)
                .help("write `let r = 0.3`")
        };
        let mut ahead = tokens.clone();
        let Some(token) = ahead.next_significant() else {
            return self.damage(wrong(keyword, "expected a name after this"));
        };
        let span = Span { source, start: token.start, end: token.end };
        let Some(name) = name_at(&text[token.start as usize..]) else {
            return self.damage(wrong(span, "expected a name"));
        };
        let behind = token.start as usize + name.len();
        let rest = text[behind..].trim_start();
        let Some(expression) = rest.strip_prefix('=') else {
            *tokens = ahead;
            return self.damage(wrong(span, "expected `=` after the name"));
        };
        let start = text.len() - expression.trim_start().len();
        let name_span = Span { source, start: token.start, end: behind as u32 };
        let found = self.one_key_curve(text, start);
        let found = found.unwrap_or_else(|| self.evaluate_changing(text, start, Around::Nothing));
        let (mut literal, mut changing) = (None, Vec::new());
        let value = match found.and_then(|found| ends_well(text, found.evaluated.end).map(|()| found)) {
            Ok(Changing { evaluated: found, values }) => {
                changing = values;
                *tokens = Tokens::resume(text, found.end as u32);
                let is_literal = number(&text[start..found.end]).is_some();
                literal = is_literal.then_some(Span { source, start: start as u32, end: found.end as u32 });
                found.value
            }
            Err(error) => {
                *tokens = Tokens::resume(text, resume_after(text, start, error.at.end));
                self.expression_error(source, error);
                0.0
            }
        };
        if !changing.is_empty() {
            self.desc.changes = true;
            self.scope.set_moments(self.desc.values.len() as u32, changing);
        }
        self.name_value(NamedValue { name: name_span, literal }, name, value);
    }

    /// Gives a name to a value, up to the end of the innermost block.
    fn name_value(&mut self, named: NamedValue, name: &str, value: f64) {
        if expression::is_reserved(name) {
            let error = Diagnostic::error(format!("`{name}` has a meaning in expressions already"));
            self.error(error.label(named.name, "choose another name"));
        }
        self.scope.add(name, value, self.desc.values.len() as u32);
        self.desc.values.push(named);
    }

    /// Whether a `repeat` begins a repeated block; that of a picture is followed by a number.
    pub(super) fn is_loop(&self, tokens: &Tokens<'_>, text: &str) -> bool {
        let mut ahead = tokens.clone();
        let Some(token) = ahead.next_significant().filter(|token| token.kind == TokenKind::Word) else {
            return false;
        };
        let word = &text[token.range()];
        let is_name = name_at(word).is_some_and(|name| name.len() == word.len());
        if !is_name || self.scope.get(word).is_none() {
            return is_name && !expression::is_function(word);
        }
        // A picture may be repeated as often as a value says.
        let Some(count) = ahead.next_significant() else { return false };
        let scope = &self.scope;
        let found = evaluate(text, count.start as usize, Around::Nothing, &|name, _| scope.get(name));
        let mut ahead = Tokens::resume(text, found.map_or(count.end, |found| found.end as u32));
        count.kind == TokenKind::OpenBrace
            || ahead.next_significant().is_some_and(|token| token.kind == TokenKind::OpenBrace)
    }

    /// Reads the head of a repeated block, and moves `tokens` to its content.
    pub(super) fn begin_repeat<'t>(
        &mut self,
        keyword: Span,
        tokens: &mut Tokens<'t>,
        text: &'t str,
    ) -> Result<(), Stop> {
        const HELP: &str = "write `repeat i 100 { ... }`";
        let source = keyword.source;
        let Some(token) = tokens.next_significant() else { return Ok(()) };
        let name_span = Span { source, start: token.start, end: token.end };
        let name = text[token.range()].to_owned();
        let head = tokens.clone().next_significant();
        let count = head.filter(|token| !matches!(token.kind, TokenKind::OpenBrace | TokenKind::CloseBrace));
        let Some(count) = count else {
            let error = Diagnostic::error("this `repeat` does not say how often");
            self.damage(error.label(name_span, "expected a number after this").help(HELP));
            return Err(Stop);
        };
        let found = match self.evaluate_changing(text, count.start as usize, Around::Nothing) {
            Ok(Changing { evaluated, values }) => {
                self.desc.changes |= !values.is_empty();
                evaluated
            }
            Err(error) => {
                self.expression_error(source, error);
                self.whole = false;
                return Err(Stop);
            }
        };
        *tokens = Tokens::resume(text, found.end as u32);
        let count_span = Span { source, start: count.start, end: found.end as u32 };
        let brace = tokens.next_significant();
        let Some(brace) = brace.filter(|token| token.kind == TokenKind::OpenBrace) else {
            let error = Diagnostic::error("a `repeat` has a block");
            self.damage(error.label(count_span, "expected `{` after this").help(HELP));
            return Err(Stop);
        };
        let turns = self.turns(count_span, found.value)?;
        let open = Span { source, start: brace.start, end: brace.end };
        self.room_for_block(open)?;
        if turns == 0 {
            *tokens = Tokens::resume(text, self.skip_block(open, text)?);
            return Ok(());
        }
        let variable = self.desc.sources.add_variable(&name);
        let errors = self.diagnostics.count(Severity::Error);
        let repeat =
            Repeat { variable, name, name_span, turn: 0, turns, body: brace.end, outer: source, errors };
        self.blocks.push((Block::Repeat(keyword), self.scope.len()));
        self.begin_turn(&repeat);
        self.repeats.push(repeat);
        self.expect = Expect::Keyword;
        Ok(())
    }

    /// How often a block is repeated.
    fn turns(&mut self, span: Span, count: f64) -> Result<u64, Stop> {
        let most = self.limits.items as u64;
        if count.fract() != 0.0 || count < 0.0 {
            let error = Diagnostic::error(format!("a block cannot be repeated {count} times"));
            self.damage(error.label(span, "expected a whole number, at least 0"));
            return Err(Stop);
        }
        if count > most as f64 {
            let error = Diagnostic::error(format!("a block can be repeated {most} times at most"));
            self.damage(error.label(span, format!("this says {count}")));
            return Err(Stop);
        }
        Ok(count as u64)
    }

    /// Makes the names and places of a turn.
    fn begin_turn(&mut self, repeat: &Repeat) {
        let turn = self.desc.sources.add_turn(repeat.outer, repeat.variable, repeat.turn as f64);
        if let Some(frame) = self.frames.last_mut() {
            frame.source = turn;
        }
        let named = NamedValue { name: Span { source: turn, ..repeat.name_span }, literal: None };
        self.name_value(named, &repeat.name, repeat.turn as f64);
    }

    /// Ends a turn of the innermost repeat at its `}`.
    ///
    /// Returns where reading goes on for the next turn; `None` after the last one.
    pub(super) fn end_turn(&mut self, span: Span, scope: usize) -> Result<Option<u32>, Stop> {
        let Some(mut repeat) = self.repeats.pop() else { return Ok(None) };
        self.scope.forget(scope);
        self.count_turn(span)?;
        repeat.turn += 1;
        let has_failed = self.diagnostics.count(Severity::Error) > repeat.errors;
        // The other turns would only say the same.
        self.whole &= !has_failed || repeat.turn == repeat.turns;
        if has_failed || repeat.turn == repeat.turns {
            if let Some(frame) = self.frames.last_mut() {
                frame.source = repeat.outer;
            }
            return Ok(None);
        }
        let body = repeat.body;
        self.begin_turn(&repeat);
        self.blocks.push((Block::Repeat(span), scope));
        self.repeats.push(repeat);
        Ok(Some(body))
    }

    /// Whether no text around here was read before, in an earlier turn.
    pub(super) fn is_first_turn(&self) -> bool {
        self.repeats.iter().all(|repeat| repeat.turn == 0)
    }

    /// Counts a turn as an item.
    fn count_turn(&mut self, span: Span) -> Result<(), Stop> {
        self.turns += 1;
        if self.desc.nodes.len() + self.turns > self.limits.items {
            let error = Diagnostic::error(format!(
                "the scene has more than {} items, repeated ones and turns of `repeat` counted",
                self.limits.items
            ));
            self.damage(error.label(span, "in this block").help("repeat fewer times"));
            return Err(Stop);
        }
        self.memory_for_items(span)
    }

    /// Where reading goes on after a block that is not to be read.
    fn skip_block(&mut self, open: Span, text: &str) -> Result<u32, Stop> {
        let mut tokens = Tokens::resume(text, open.end);
        let mut depth = 1;
        while let Some(token) = tokens.next_significant() {
            match token.kind {
                TokenKind::OpenBrace => depth += 1,
                TokenKind::CloseBrace => depth -= 1,
                _ => {}
            }
            if depth == 0 {
                return Ok(token.end);
            }
        }
        self.damage(
            Diagnostic::error("the block of `repeat` is not closed")
                .label(open, "this `{` has no `}`")
                .help("add the missing `}`"),
        );
        Err(Stop)
    }
}

/// Whether what follows goes on with an expression that a name begins, or with further numbers.
fn goes_on_with_numbers(behind: &str) -> bool {
    let rest = behind.trim_start();
    match rest.bytes().next() {
        Some(b'0'..=b'9' | b'.' | b'(') => true,
        Some(b'+' | b'-') if rest[1..].starts_with(|c: char| c.is_ascii_digit() || c == '.') => true,
        Some(b'*' | b'%' | b'^') => true,
        Some(b'/') => !rest[1..].starts_with(['/', '*']),
        Some(b'+' | b'-') => rest[1..].starts_with(char::is_whitespace),
        _ => false,
    }
}

/// Where the parenthesis is closed that `text` begins with.
fn closing(text: &str) -> Option<usize> {
    let mut open = 0_usize;
    text.char_indices().find_map(|(at, c)| {
        match c {
            '(' => open += 1,
            ')' => open = open.saturating_sub(1),
            _ => {}
        }
        (open == 0).then_some(at)
    })
}

/// What stands right behind an expression must not look like a part of it.
pub(super) fn ends_well(text: &str, end: usize) -> Result<(), ExpressionError> {
    let rest = &text[end..];
    let Some(next) = rest.chars().next() else { return Ok(()) };
    if next.is_whitespace() || matches!(next, '{' | '}') || rest.starts_with("//") || rest.starts_with("/*") {
        return Ok(());
    }
    let message = format!("{} stands right behind an expression", quoted(&next.to_string()));
    let sign = matches!(next, '+' | '-');
    let help = if sign {
        format!("write blanks on both sides of `{next}`, or parentheses around it all")
    } else if next == '(' || next.is_alphabetic() {
        "write a blank between them, or `*` to multiply".to_owned()
    } else {
        "write a blank between them".to_owned()
    };
    Err(ExpressionError { message, at: end..end + next.len_utf8(), help: Some(help) })
}

/// Where reading goes on after an expression with a mistake that reaches up to `at`: behind its parentheses and its last
/// word, at the end of the line at the latest.
pub(super) fn resume_after(text: &str, start: usize, at: usize) -> u32 {
    let mut open = 0_usize;
    for (i, c) in text[start..].char_indices() {
        let here = start + i;
        let ends = matches!(c, '{' | '}' | '\n' | '\r' | '"') || (open == 0 && c.is_whitespace());
        if here >= at && ends {
            return here as u32;
        }
        match c {
            '(' => open += 1,
            ')' => open = open.saturating_sub(1),
            _ => {}
        }
    }
    text.len() as u32
}

#[cfg(test)]
mod tests;
