//! A scene as a uniform tree of items, each with its place.
//!
//! An item is a keyword, at most one word or string, numbers, and a block of
//! further items. The compiler interprets keywords. Items lie in one
//! array in pre-order and know where their subtree ends; numbers lie in
//! another. Text is not copied: words are spans of the kept sources.

use crate::clock::Clock;
use crate::edit::format_number;
use crate::source::{SourceId, Sources, Span};
use crate::written_keys::WrittenKeys;
use kajo_math::tape::Tape;
use std::borrow::Cow;
use std::sync::Arc;

/// The items of a scene and the texts they came from.
#[derive(Clone, Debug, Default)]
pub struct SceneDesc {
    pub(crate) sources: Sources,
    pub(crate) nodes: Vec<Node>,
    pub(crate) numbers: Vec<Number>,
    /// The values that have names.
    pub(crate) values: Vec<NamedValue>,
    /// The numbers that are written as expressions.
    pub(crate) expressions: Vec<Expression>,
    /// The functions, in the order of their items.
    pub(crate) functions: Vec<Function>,
    /// The blocks of keys, in the order of the text.
    pub(crate) keyed: Vec<WrittenKeys>,
    /// The moments for which it was evaluated.
    pub(crate) clock: Clock,
    /// Whether anything in it depends on the time.
    pub(crate) changes: bool,
    /// Numbers that change with time, by their index, with their values at all moments; empty once they are settled.
    pub(crate) changing: Vec<(u32, Vec<f64>)>,
    /// The items with such numbers, in order, and where in `numbers` theirs at the second moment begin; those at the
    /// further moments follow.
    pub(crate) changing_items: Vec<(u32, u32)>,
}

/// A function of the place.
#[derive(Clone, Debug)]
pub(crate) struct Function {
    /// The item whose value it is.
    pub node: u32,
    pub tape: Arc<Tape>,
    /// The named values in its text.
    pub inserts: Vec<Insert>,
}

/// A named value in the text of a function.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Insert {
    pub start: u32,
    pub end: u32,
    pub value: f64,
}

/// A value with a name.
#[derive(Clone, Copy, Debug)]
pub struct NamedValue {
    /// Where `let` or `repeat` gives it the name.
    pub name: Span,
    /// Where it is written, if as a number: the one place that decides it.
    pub literal: Option<Span>,
}

/// A number that is written as an expression.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Expression {
    pub span: Span,
    /// The value that it names, if it is a name and nothing else.
    pub value: Option<u32>,
}

/// An item in the array; spans are bytes of `source`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub source: SourceId,
    pub keyword: (u32, u32),
    /// The word or string after the keyword, or a function with its equals sign; empty when there is none.
    pub word: (u32, u32),
    /// One past the last byte of the item.
    pub end: u32,
    /// Range in [`SceneDesc::numbers`].
    pub numbers: (u32, u32),
    /// Index of the first item after this one's subtree.
    pub next: u32,
    pub has_block: bool,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Number {
    pub value: f64,
    pub start: u32,
    pub end: u32,
}

impl SceneDesc {
    /// The items that stand in no block, in order.
    pub fn roots(&self) -> Items<'_> {
        Items { desc: self, next: 0, end: self.nodes.len() as u32, moment: 0 }
    }

    /// All items in the order of the text: a block's item, then its content.
    pub fn items(&self) -> impl Iterator<Item = Item<'_>> {
        (0..self.nodes.len() as u32).map(|index| Item { desc: self, index, moment: 0 })
    }

    /// The item with this number in the order of [`SceneDesc::items`].
    pub fn item(&self, index: u32) -> Option<Item<'_>> {
        (index < self.nodes.len() as u32).then_some(Item { desc: self, index, moment: 0 })
    }

    /// The number of items, at all depths.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no item.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The values that `let` and `repeat` name, in the order of the text; those in a repeated block once for each turn.
    pub fn named_values(&self) -> impl Iterator<Item = (&str, NamedValue)> {
        self.values.iter().map(|&value| (self.sources.text(value.name), value))
    }

    /// The numbers that are written as expressions, where they stand, and the named value where they are its name alone.
    pub fn expressions(&self) -> impl Iterator<Item = (Span, Option<NamedValue>)> {
        self.expressions.iter().map(|found| (found.span, found.value.map(|i| self.values[i as usize])))
    }

    /// The blocks of keys, in the order of the text.
    pub fn keyed(&self) -> &[WrittenKeys] {
        &self.keyed
    }

    /// The moments for which it was evaluated.
    pub fn clock(&self) -> &Clock {
        &self.clock
    }

    /// Whether anything in it depends on the time, so that for another time it would have to be read again.
    pub fn changes(&self) -> bool {
        self.changes
    }

    /// The same tree at other moments.
    ///
    /// # Panics
    /// When something in it depends on the time.
    pub fn set_clock(&mut self, clock: Clock) {
        assert!(!self.changes, "the text has to be read again");
        self.clock = clock;
    }

    /// Puts the numbers of items that change behind all others, a run for each moment.
    pub(crate) fn settle_moments(&mut self, clock: &Clock) {
        self.clock = clock.clone();
        let changing = std::mem::take(&mut self.changing);
        let mut rest = changing.as_slice();
        while let Some(&(number, _)) = rest.first() {
            // Ranges of numbers are in the order of the items, and those of items without numbers are empty.
            let index = self.nodes.partition_point(|node| node.numbers.1 <= number);
            let Some(&Node { numbers: (start, end), .. }) = self.nodes.get(index) else { break };
            let own = rest.partition_point(|(number, _)| *number < end);
            self.changing_items.push((index as u32, self.numbers.len() as u32));
            for moment in 1..clock.len() {
                let first = self.numbers.len();
                self.numbers.extend_from_within(start as usize..end as usize);
                for (number, values) in &rest[..own] {
                    self.numbers[first + (number - start) as usize].value = values[moment];
                }
            }
            rest = &rest[own..];
        }
    }

    /// The texts that spans point into.
    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// As [`SceneDesc::sources`], to add excerpts of other files for messages.
    pub fn sources_mut(&mut self) -> &mut Sources {
        &mut self.sources
    }
}

/// One item of a [`SceneDesc`].
#[derive(Clone, Copy)]
pub struct Item<'a> {
    desc: &'a SceneDesc,
    index: u32,
    /// At which moment of the clock its numbers are taken.
    moment: u32,
}

impl<'a> Item<'a> {
    /// The word the item starts with.
    pub fn keyword(&self) -> &'a str {
        self.text(self.node().keyword)
    }

    /// Where the keyword stands.
    pub fn keyword_span(&self) -> Span {
        self.span_of(self.node().keyword)
    }

    /// The whole item, with its block.
    pub fn span(&self) -> Span {
        self.span_of((self.node().keyword.0, self.node().end))
    }

    /// The keyword and the values that stand before the block.
    pub fn head_span(&self) -> Span {
        let node = self.node();
        if node.has_block {
            let end = if node.word.1 > 0 { node.word.1 } else { node.keyword.1 };
            return self.span_of((node.keyword.0, end));
        }
        self.span()
    }

    /// The word, string or function after the keyword.
    pub fn word(&self) -> Option<Word<'a>> {
        let range = self.node().word;
        (range.0 < range.1).then(|| Word { raw: self.text(range), span: self.span_of(range) })
    }

    /// The function of the place that is its value, of `x`, `y` and `z`.
    pub fn function(&self) -> Option<&'a Arc<Tape>> {
        self.function_record().map(|function| &function.tape)
    }

    /// The text of its function, with its equals sign, and numbers in place of named values.
    pub fn function_text(&self) -> Option<String> {
        let function = self.function_record()?;
        let (mut at, end) = self.node().word;
        let mut text = String::new();
        for insert in &function.inserts {
            let number = format_number(insert.value);
            text.push_str(self.text((at, insert.start)));
            text.push_str(&if insert.value < 0.0 { format!("({number})") } else { number });
            at = insert.end;
        }
        text.push_str(self.text((at, end)));
        Some(text)
    }

    fn function_record(&self) -> Option<&'a Function> {
        let functions = &self.desc.functions;
        functions.binary_search_by_key(&self.index, |function| function.node).ok().map(|i| &functions[i])
    }

    /// The numbers after the keyword and the word, or first in the block.
    pub fn numbers(&self) -> impl ExactSizeIterator<Item = (f64, Span)> + use<'a> {
        let source = self.node().source;
        self.number_slice().iter().map(move |n| (n.value, Span { source, start: n.start, end: n.end }))
    }

    /// The values: a word or string, if any, and then the numbers.
    pub fn values(&self) -> impl Iterator<Item = (Value<'a>, Span)> + use<'a> {
        let word = self.word().map(|w| (w.value(), w.span));
        word.into_iter().chain(self.numbers().map(|(value, span)| (Value::Number(value), span)))
    }

    /// Whether the item has neither value nor block; the parser has reported it.
    pub fn is_bare(&self) -> bool {
        let node = self.node();
        !node.has_block && node.word.1 == 0 && node.numbers.0 == node.numbers.1
    }

    /// Its number in the order of [`SceneDesc::items`]; items of its block have the next ones.
    pub fn index(&self) -> u32 {
        self.index
    }

    /// One past the number of the last item of its block.
    pub fn next_index(&self) -> u32 {
        self.node().next
    }

    /// Whether braces follow the values.
    pub fn has_block(&self) -> bool {
        self.node().has_block
    }

    /// The items of the block, in order.
    pub fn children(&self) -> Items<'a> {
        Items { desc: self.desc, next: self.index + 1, end: self.node().next, moment: self.moment }
    }

    /// The same item, and all in its block, with the numbers of a moment of the tree's [`Clock`].
    ///
    /// * `moment`: below [`Clock::len`]; 0 is the frame
    pub fn at_moment(self, moment: usize) -> Item<'a> {
        debug_assert!(moment < self.desc.clock.len());
        Item { moment: moment as u32, ..self }
    }

    /// Whether a number of it or in its block changes from one moment of the clock to another.
    pub fn changes(&self) -> bool {
        let items = &self.desc.changing_items;
        let next = items.partition_point(|&(item, _)| item < self.index);
        items.get(next).is_some_and(|&(item, _)| item < self.node().next)
    }

    /// The tree the item belongs to.
    pub fn desc(&self) -> &'a SceneDesc {
        self.desc
    }

    /// The name of the file the item stands in.
    pub fn path(&self) -> &'a str {
        self.desc.sources.get(self.node().source).path()
    }

    fn node(&self) -> &'a Node {
        &self.desc.nodes[self.index as usize]
    }

    pub(crate) fn number_slice(&self) -> &'a [Number] {
        let (mut start, end) = self.node().numbers;
        let count = end - start;
        let items = &self.desc.changing_items;
        if self.moment > 0
            && let Ok(found) = items.binary_search_by_key(&self.index, |&(item, _)| item)
        {
            start = items[found].1 + (self.moment - 1) * count;
        }
        &self.desc.numbers[start as usize..(start + count) as usize]
    }

    fn text(&self, range: (u32, u32)) -> &'a str {
        self.desc.sources.text(self.span_of(range))
    }

    pub(crate) fn span_of(&self, (start, end): (u32, u32)) -> Span {
        Span { source: self.node().source, start, end }
    }
}

impl std::fmt::Debug for Item<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let values: Vec<_> = self.values().map(|(value, _)| value).collect();
        f.debug_struct("Item")
            .field("keyword", &self.keyword())
            .field("values", &values)
            .finish_non_exhaustive()
    }
}

/// Sibling items in order.
#[derive(Clone)]
pub struct Items<'a> {
    desc: &'a SceneDesc,
    next: u32,
    end: u32,
    moment: u32,
}

impl<'a> Iterator for Items<'a> {
    type Item = Item<'a>;

    fn next(&mut self) -> Option<Item<'a>> {
        if self.next >= self.end {
            return None;
        }
        let item = Item { desc: self.desc, index: self.next, moment: self.moment };
        self.next = item.node().next;
        Some(item)
    }
}

/// The word or string after a keyword.
#[derive(Clone, Copy, Debug)]
pub struct Word<'a> {
    /// As written, with quotes and escapes.
    pub raw: &'a str,
    /// Where it stands.
    pub span: Span,
}

impl<'a> Word<'a> {
    /// The text meant: without quotes, with `\"` and `\\` resolved.
    pub fn text(&self) -> Cow<'a, str> {
        self.value().text().unwrap_or_default()
    }

    /// As a value.
    pub fn value(&self) -> Value<'a> {
        match self.raw.strip_prefix('"') {
            Some(rest) => Value::String(unescape(rest.strip_suffix('"').unwrap_or(rest))),
            None if self.raw.starts_with('=') => Value::Function(self.raw),
            None => Value::Word(self.raw),
        }
    }
}

/// A value of an item.
#[derive(Clone, Debug, PartialEq)]
pub enum Value<'a> {
    /// A finite number.
    Number(f64),
    /// A bare word.
    Word(&'a str),
    /// A string, unescaped.
    String(Cow<'a, str>),
    /// A function of the place, as it is written behind an equals sign, which is there too.
    Function(&'a str),
}

impl<'a> Value<'a> {
    /// The text of a word, string or function.
    pub fn text(self) -> Option<Cow<'a, str>> {
        match self {
            Value::Number(_) => None,
            Value::Word(text) | Value::Function(text) => Some(Cow::Borrowed(text)),
            Value::String(string) => Some(string),
        }
    }
}

fn unescape(inner: &str) -> Cow<'_, str> {
    if !inner.contains('\\') {
        return Cow::Borrowed(inner);
    }
    let mut out = String::with_capacity(inner.len());
    let mut chars = inner.chars().peekable();
    while let Some(c) = chars.next() {
        let escaped = if c == '\\' { chars.next_if(|next| matches!(next, '"' | '\\')) } else { None };
        out.push(escaped.unwrap_or(c));
    }
    Cow::Owned(out)
}
