//! Scene text to [`SceneDesc`].
//!
//! ```text
//! file  := item*
//! item  := WORD (WORD | STRING)? NUMBER* ( '{' NUMBER* item* '}' )?
//!        | 'include' (WORD | STRING)            the items of that file
//!        | 'let' NAME '=' EXPRESSION            a value with a name
//!        | 'repeat' NAME EXPRESSION '{' item* '}'   the items several times
//! ```
//!
//! A NUMBER may be an expression (`values`), and change with time (`keyed`). No keywords but `include`, `let` and
//! `repeat` are known. After a mistake the parser goes on with the next token, so that one run shows all of them. Open
//! blocks and open files are kept on explicit stacks: deep nesting costs no program stack.

mod files;
mod functions;
mod hex_color;
mod keyed;
mod moments;
mod scope;
mod values;

use crate::assets::{Assets, MemoryAssets};
use crate::clock::Clock;
use crate::diagnostic::{Diagnostic, Diagnostics, Severity, quoted};
use crate::lexer::{LexError, TokenKind, Tokens, looks_like_number};
use crate::limits::Limits;
use crate::source::{SourceId, Span};
use crate::tree::{Node, Number, SceneDesc};
use keyed::KEYS;
use scope::Scope;
use std::collections::HashMap;
use values::{LET, REPEAT, Repeat};

/// Memory is taken for so many items at a time.
const ITEMS_AT_ONCE: usize = 1024;

/// Memory of an item with three numbers, in lists that grow.
const BYTES_PER_ITEM: usize = 2 * (size_of::<Node>() + 3 * size_of::<Number>());

/// What came of reading a scene: always a tree, complete unless there are errors.
#[derive(Debug, Default)]
pub struct Parsed {
    /// The items found.
    pub desc: SceneDesc,
    /// What was wrong.
    pub diagnostics: Diagnostics,
    /// Whether the tree holds every item of the text at its place, whatever is wrong with single
    /// values. If not, complaints about what is missing from it may only be consequences.
    pub whole: bool,
}

impl SceneDesc {
    /// Reads the scene that `assets` knows as `name`, and what it includes.
    pub fn load(name: &str, assets: &dyn Assets, limits: &Limits) -> Parsed {
        Self::load_at(name, assets, limits, &Clock::default())
    }

    /// As [`SceneDesc::load`], with what changes with time as it is at the moments of `clock`.
    pub fn load_at(name: &str, assets: &dyn Assets, limits: &Limits, clock: &Clock) -> Parsed {
        let mut parser = Parser::new(assets, limits, clock);
        match parser.read_source(name, None) {
            Ok(source) => parser.run(source),
            Err(diagnostic) => parser.damage(diagnostic),
        }
        parser.finish()
    }

    /// Reads a scene from a text; `path` is its name, from which includes are resolved.
    pub fn parse(path: &str, text: impl Into<String>, assets: &dyn Assets, limits: &Limits) -> Parsed {
        Self::parse_at(path, text, assets, limits, &Clock::default())
    }

    /// As [`SceneDesc::parse`], with what changes with time as it is at the moments of `clock`.
    pub fn parse_at(
        path: &str,
        text: impl Into<String>,
        assets: &dyn Assets,
        limits: &Limits,
        clock: &Clock,
    ) -> Parsed {
        let mut parser = Parser::new(assets, limits, clock);
        match parser.add_source(path, text.into().into_bytes(), None) {
            Ok(source) => parser.run(source),
            Err(diagnostic) => parser.damage(diagnostic),
        }
        parser.finish()
    }

    /// Reads a text that includes no other, within the default limits.
    pub fn parse_str(text: &str) -> Parsed {
        Self::parse("scene", text, &MemoryAssets::new(), &Limits::default())
    }
}

/// A file being read.
struct Frame {
    source: SourceId,
    /// Where its reading goes on.
    at: u32,
    /// Blocks that were open when it was included.
    outer_blocks: usize,
}

/// What a `{` belongs to.
#[derive(Clone, Copy)]
enum Block {
    /// The item with this number.
    Item(u32),
    /// No keyword: the content counts as that of the surroundings.
    Stray,
    /// A `repeat` at this place.
    Repeat(Span),
}

/// What the item last begun may still take.
#[derive(Clone, Copy, PartialEq)]
enum Expect {
    /// No item takes values here.
    Keyword,
    /// A word, string, number or block.
    Value,
    /// A number or block.
    Number,
    /// A number, first in the block of the innermost open item.
    BlockNumber,
}

struct Parser<'l> {
    assets: &'l dyn Assets,
    limits: &'l Limits,
    clock: &'l Clock,
    desc: SceneDesc,
    diagnostics: Diagnostics,
    /// Files open, the scene itself first.
    frames: Vec<Frame>,
    /// The blocks that are open, each with the number of values that were named outside of it.
    blocks: Vec<(Block, usize)>,
    /// The values that have names here.
    scope: Scope,
    /// Repeated blocks that are open, the innermost last.
    repeats: Vec<Repeat>,
    /// How many turns of repeated blocks there were.
    turns: usize,
    expect: Expect,
    includes: usize,
    by_path: HashMap<String, SourceId>,
    text_bytes: u64,
    /// See [`Parsed::whole`].
    whole: bool,
}

/// Reading cannot go on; the reason has been reported.
struct Stop;

impl<'l> Parser<'l> {
    fn new(assets: &'l dyn Assets, limits: &'l Limits, clock: &'l Clock) -> Self {
        Self {
            assets,
            limits,
            clock,
            desc: SceneDesc::default(),
            diagnostics: Diagnostics::new(),
            frames: Vec::new(),
            blocks: Vec::new(),
            scope: Scope::default(),
            repeats: Vec::new(),
            turns: 0,
            expect: Expect::Keyword,
            includes: 0,
            by_path: HashMap::new(),
            text_bytes: 0,
            whole: true,
        }
    }

    fn error(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// An error after which items are missing from the tree or stand in wrong blocks.
    fn damage(&mut self, diagnostic: Diagnostic) {
        self.whole = false;
        self.error(diagnostic);
    }

    fn run(&mut self, root: SourceId) {
        self.frames.push(Frame { source: root, at: 0, outer_blocks: 0 });
        while !self.frames.is_empty() {
            if let Err(Stop) = self.read_frame() {
                break;
            }
        }
    }

    fn finish(mut self) -> Parsed {
        while let Some((block, _)) = self.blocks.pop() {
            self.close(block, None);
        }
        self.desc.settle_moments(self.clock);
        Parsed { desc: self.desc, diagnostics: self.diagnostics, whole: self.whole }
    }

    /// Reads the innermost file up to its end or to an include.
    fn read_frame(&mut self) -> Result<(), Stop> {
        let Some(&Frame { mut source, at, outer_blocks }) = self.frames.last() else { return Err(Stop) };
        let text = self.desc.sources.get(source).shared_text();
        let mut tokens = Tokens::resume(&text, at);
        while let Some(token) = tokens.next_significant() {
            let span = Span { source, start: token.start, end: token.end };
            let word = &text[span.range()];
            match token.kind {
                TokenKind::Word if word == INCLUDE && self.expect != Expect::Value => {
                    return self.include_next(span, &mut tokens);
                }
                TokenKind::Word if word == LET && self.expect != Expect::Value => {
                    self.end_item();
                    self.let_value(span, &mut tokens, &text);
                }
                TokenKind::Word
                    if word == REPEAT && self.expect != Expect::Value && self.is_loop(&tokens, &text) =>
                {
                    self.end_item();
                    self.begin_repeat(span, &mut tokens, &text)?;
                    source = self.source();
                }
                TokenKind::Word if word.starts_with('=') && self.expect == Expect::Value => {
                    let end = self.equals(span.start, span, &text);
                    tokens = Tokens::resume(&text, end);
                }
                TokenKind::Word
                    if word == KEYS
                        && let Some(end) = self.keys(span, &text) =>
                {
                    tokens = Tokens::resume(&text, end);
                }
                TokenKind::Word => {
                    if let Some(end) = self.expression(span, &text) {
                        tokens = Tokens::resume(&text, end);
                        continue;
                    }
                    if let Some(end) = self.plain_word(span, &text)? {
                        tokens = Tokens::resume(&text, end);
                    }
                }
                TokenKind::String => self.string(span),
                TokenKind::Number(value) => self.number(span, word, value),
                TokenKind::OpenBrace => self.open_brace(span)?,
                TokenKind::CloseBrace => {
                    if let Some(body) = self.close_brace(span, outer_blocks)? {
                        tokens = Tokens::resume(&text, body);
                    }
                    source = self.source();
                }
                TokenKind::Error(error) => self.lex_error(span, error),
                TokenKind::Whitespace | TokenKind::Comment => {}
            }
            self.check_mistakes()?;
        }
        self.end_of_file(source, outer_blocks, text.len() as u32);
        Ok(())
    }

    /// Goes on in the file whose name follows the word for includes.
    fn include_next(&mut self, span: Span, tokens: &mut Tokens<'_>) -> Result<(), Stop> {
        self.end_item();
        let name = include_name(span.source, tokens);
        if let Some(frame) = self.frames.last_mut() {
            frame.at = tokens.offset();
        }
        self.include(span, name)
    }

    fn check_mistakes(&mut self) -> Result<(), Stop> {
        if self.diagnostics.count(Severity::Error) < self.limits.errors {
            return Ok(());
        }
        self.damage(Diagnostic::error("too many mistakes: the rest of the scene was not read"));
        Err(Stop)
    }

    /// A word that is no expression; where reading goes on, if that is not behind it.
    fn plain_word(&mut self, span: Span, text: &str) -> Result<Option<u32>, Stop> {
        let word = &text[span.range()];
        if let Some(keyword) = self.keyword_of_equation(word) {
            let end = span.start + keyword.len() as u32;
            self.word(Span { end, ..span }, keyword)?;
            return Ok(Some(end));
        }
        self.word(span, word)?;
        Ok(if self.expect == Expect::Value { self.hex_color(span, text) } else { None })
    }

    /// The source that is being read, or the turn of it.
    fn source(&self) -> SourceId {
        self.frames.last().map_or(SourceId(0), |frame| frame.source)
    }

    fn word(&mut self, span: Span, word: &str) -> Result<(), Stop> {
        if self.expect == Expect::Value
            && let Some(node) = self.desc.nodes.last_mut()
        {
            node.word = (span.start, span.end);
            node.end = span.end;
            self.expect = Expect::Number;
            return Ok(());
        }
        if looks_like_number(word) {
            self.bad_number(span, word);
            return Ok(());
        }
        self.begin_item(span)
    }

    fn begin_item(&mut self, span: Span) -> Result<(), Stop> {
        self.end_item();
        if self.desc.nodes.len() + self.turns >= self.limits.items {
            self.damage(
                Diagnostic::error(format!(
                    "the scene has more than {} items, files included by it counted",
                    self.limits.items
                ))
                .label(span, "this one is too many")
                .help("use a mesh file for large geometry, and include files fewer times"),
            );
            return Err(Stop);
        }
        self.memory_for_items(span)?;
        let index = self.desc.nodes.len() as u32;
        let first_number = self.desc.numbers.len() as u32;
        self.desc.nodes.push(Node {
            source: span.source,
            keyword: (span.start, span.end),
            word: (0, 0),
            end: span.end,
            numbers: (first_number, first_number),
            next: index + 1,
            has_block: false,
        });
        self.expect = Expect::Value;
        Ok(())
    }

    /// Takes memory for some more items and turns, every so many of them.
    fn memory_for_items(&mut self, span: Span) -> Result<(), Stop> {
        if (self.desc.nodes.len() + self.turns).is_multiple_of(ITEMS_AT_ONCE)
            && let Err(over) = self.limits.memory.take((ITEMS_AT_ONCE * BYTES_PER_ITEM) as u64)
        {
            let error = Diagnostic::error(format!("there is no memory for the rest of the scene: {over}"));
            self.damage(error.label(span, "from here on"));
            return Err(Stop);
        }
        Ok(())
    }

    /// The item last begun takes no more values.
    fn end_item(&mut self) {
        if self.expect == Expect::Value
            && let Some(node) = self.desc.nodes.last()
        {
            let span = Span { source: node.source, start: node.keyword.0, end: node.keyword.1 };
            let keyword = quoted(self.desc.sources.text(span));
            self.error(
                Diagnostic::error(format!("{keyword} has neither a value nor a block"))
                    .label(span, "expected numbers, a word or `{` after this"),
            );
        }
        self.expect = Expect::Keyword;
    }

    /// The item that takes numbers, if one does.
    fn number_taker(&self) -> Option<u32> {
        match self.expect {
            Expect::Value | Expect::Number => (self.desc.nodes.len() as u32).checked_sub(1),
            Expect::BlockNumber => match self.blocks.last() {
                Some(&(Block::Item(index), _)) => Some(index),
                _ => None,
            },
            Expect::Keyword => None,
        }
    }

    fn number(&mut self, span: Span, text: &str, value: f64) {
        let Some(taker) = self.number_taker() else {
            self.error(
                Diagnostic::error(format!("the number {} belongs to no keyword", quoted(text)))
                    .label(span, "expected a keyword or `}`"),
            );
            return;
        };
        if !value.is_finite() {
            self.error(
                Diagnostic::error(format!("{} is not a finite number", quoted(text)))
                    .label(span, "expected a finite number"),
            );
        }
        self.add_number(taker, span, if value.is_finite() { value } else { 0.0 });
    }

    /// Takes 0 for a misspelt number, so that the count of numbers stays right.
    fn bad_number(&mut self, span: Span, word: &str) {
        let help = ["//", "/*", "#"]
            .into_iter()
            .find(|start| word.contains(start))
            .map(|start| format!("write a blank before the comment's `{start}`"));
        // A number after all, but none that a float can hold.
        let (what, label) = match word.parse::<f64>() {
            Ok(_) => ("is too large", "numbers reach up to 1.8e308"),
            Err(_) => ("is not a number", "expected a number such as 1, -0.5 or 2e3, or a keyword"),
        };
        let error = Diagnostic::error(format!("{} {what}", quoted(word)));
        self.error(error.label(span, label).maybe_help(help));
        if let Some(taker) = self.number_taker() {
            self.add_number(taker, span, 0.0);
        }
    }

    fn add_number(&mut self, taker: u32, span: Span, value: f64) {
        self.desc.numbers.push(Number { value, start: span.start, end: span.end });
        let node = &mut self.desc.nodes[taker as usize];
        node.numbers.1 = self.desc.numbers.len() as u32;
        node.end = span.end;
        if self.expect == Expect::Value {
            self.expect = Expect::Number;
        }
    }

    fn string(&mut self, span: Span) {
        if self.expect == Expect::Value
            && let Some(node) = self.desc.nodes.last_mut()
        {
            node.word = (span.start, span.end);
            node.end = span.end;
            self.expect = Expect::Number;
            return;
        }
        let found = quoted(self.desc.sources.text(span));
        self.error(
            Diagnostic::error(format!("the string {found} belongs to no keyword"))
                .label(span, "expected a keyword or `}`")
                .help("a string stands right after a keyword, as in `obj_file \"my bunny.obj\"`"),
        );
    }

    /// One more block may be opened.
    fn room_for_block(&mut self, span: Span) -> Result<(), Stop> {
        if self.blocks.len() < self.limits.nesting {
            return Ok(());
        }
        self.damage(
            Diagnostic::error(format!("blocks are nested more than {} deep", self.limits.nesting))
                .label(span, "this block is too deep; the rest was not read"),
        );
        Err(Stop)
    }

    fn open_brace(&mut self, span: Span) -> Result<(), Stop> {
        self.room_for_block(span)?;
        let taker = if self.expect == Expect::BlockNumber { None } else { self.number_taker() };
        self.blocks.push((taker.map_or(Block::Stray, Block::Item), self.scope.len()));
        match taker {
            Some(index) => {
                let node = &mut self.desc.nodes[index as usize];
                node.has_block = true;
                node.end = span.end;
                self.expect = Expect::BlockNumber;
            }
            None => {
                self.expect = Expect::Keyword;
                self.damage(
                    Diagnostic::error("`{` without a keyword before it")
                        .label(span, "expected a keyword, as in `Group {`"),
                );
            }
        }
        Ok(())
    }

    /// Returns where reading goes on, if that is not behind the brace.
    fn close_brace(&mut self, span: Span, outer_blocks: usize) -> Result<Option<u32>, Stop> {
        self.end_item();
        if self.blocks.len() <= outer_blocks {
            self.damage(
                Diagnostic::error("`}` without a block to close")
                    .label(span, "no `{` of this file is open here")
                    .help("remove it, or add the missing `{`"),
            );
            return Ok(None);
        }
        match self.blocks.pop() {
            Some((Block::Repeat(_), scope)) => return self.end_turn(span, scope),
            Some((block, scope)) => {
                self.scope.forget(scope);
                self.close(block, Some(span.end));
            }
            None => {}
        }
        Ok(None)
    }

    /// Ends a block; `end` is where its brace ends, if there is one.
    fn close(&mut self, block: Block, end: Option<u32>) {
        let next = self.desc.nodes.len() as u32;
        if let Block::Item(index) = block {
            let node = &mut self.desc.nodes[index as usize];
            node.next = next;
            node.end = end.unwrap_or(node.end);
        }
    }

    fn end_of_file(&mut self, source: SourceId, outer_blocks: usize, end: u32) {
        self.end_item();
        while self.blocks.len() > outer_blocks {
            let Some((block, _)) = self.blocks.pop() else { break };
            self.close(block, Some(end));
            let end = Span { source, start: end, end };
            match block {
                Block::Item(index) => {
                    let node = self.desc.nodes[index as usize];
                    let (start, stop) = node.keyword;
                    self.unclosed(Span { source: node.source, start, end: stop }, end);
                }
                Block::Repeat(keyword) => {
                    self.repeats.pop();
                    self.unclosed(keyword, end);
                }
                Block::Stray => {}
            }
        }
        self.frames.pop();
    }

    fn unclosed(&mut self, keyword: Span, end: Span) {
        let name = quoted(self.desc.sources.text(keyword));
        self.damage(
            Diagnostic::error(format!("the block of {name} is not closed"))
                .label(keyword, "its `{` has no `}`")
                .label(end, "the file ends here")
                .help("add the missing `}`"),
        );
    }

    fn lex_error(&mut self, span: Span, error: LexError) {
        let start = Span { end: span.start + 1, ..span };
        self.damage(match error {
            LexError::UnterminatedString => Diagnostic::error("the string is not closed")
                .label(start, "no `\"` follows on this line")
                .help("end the string with `\"`; a quote inside it is written `\\\"`"),
            LexError::UnterminatedComment => Diagnostic::error("the comment is not closed")
                .label(Span { end: span.start + 2, ..span }, "no `*/` follows")
                .help("end the comment with `*/`"),
        });
        // A cut string still stands for its keyword's value.
        if error == LexError::UnterminatedString && self.expect == Expect::Value {
            self.string(span);
        }
    }
}

const INCLUDE: &str = "include";

/// The word or string that follows an `include`, if one does.
fn include_name(source: SourceId, tokens: &mut Tokens<'_>) -> Option<Span> {
    let mut ahead = tokens.clone();
    let token = ahead.next_significant()?;
    if !matches!(token.kind, TokenKind::Word | TokenKind::String) {
        return None;
    }
    *tokens = ahead;
    Some(Span { source, start: token.start, end: token.end })
}

#[cfg(test)]
mod tests;
