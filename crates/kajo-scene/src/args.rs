//! Reading the values of one item, in order and with their types.

use crate::diagnostic::{Diagnostic, Diagnostics, quoted};
use crate::lexer::looks_like_number;
use crate::nearest::nearest;
use crate::source::Span;
use crate::tree::{Item, Number, Value, Word};
use kajo_math::tape::{Node, Tape, TapeBuilder};
use kajo_math::{Vec2, Vec3};
use std::borrow::Cow;
use std::ops::{Bound, RangeBounds, RangeInclusive};
use std::sync::Arc;

/// The values of an item, taken one after the other.
///
/// Every method takes the next value or values, or says what stands there
/// instead. Values left over when the reader is done are an error too.
///
/// ```
/// use kajo_scene::{Args, Diagnostics, SceneDesc};
/// let parsed = SceneDesc::parse_str("samples jittered 16");
/// let mut diagnostics = Diagnostics::new();
/// let samples = Args::read(parsed.desc.roots().next().unwrap(), &mut diagnostics, |args| {
///     Ok((args.word_of(&["regular", "jittered"])?, args.int_in(1..=65536)?))
/// });
/// assert_eq!(samples, Some(("jittered", 16)));
/// ```
pub struct Args<'a> {
    item: Item<'a>,
    word: Option<Word<'a>>,
    numbers: &'a [Number],
    /// Numbers taken so far.
    taken: usize,
}

impl<'a> Args<'a> {
    /// Reads all values of `item` with `reader`; on a mistake reports it and returns `None`.
    pub fn read<T>(
        item: Item<'a>,
        diagnostics: &mut Diagnostics,
        reader: impl FnOnce(&mut Args<'a>) -> Result<T, Diagnostic>,
    ) -> Option<T> {
        Self::read_head(item, diagnostics, |args| {
            let value = reader(args)?;
            args.no_block()?;
            Ok(value)
        })
    }

    /// As [`Args::read`], for an item whose block is read by others.
    pub fn read_head<T>(
        item: Item<'a>,
        diagnostics: &mut Diagnostics,
        reader: impl FnOnce(&mut Args<'a>) -> Result<T, Diagnostic>,
    ) -> Option<T> {
        if item.is_bare() {
            return None; // The parser has reported it.
        }
        let mut args = Args { item, word: item.word(), numbers: item.number_slice(), taken: 0 };
        match reader(&mut args).and_then(|value| args.end().map(|()| value)) {
            Ok(value) => Some(value),
            Err(diagnostic) => {
                diagnostics.push(diagnostic);
                None
            }
        }
    }

    /// The item whose values these are.
    pub fn item(&self) -> Item<'a> {
        self.item
    }

    /// How many numbers are left.
    pub fn numbers_left(&self) -> usize {
        self.numbers.len() - self.taken
    }

    /// Whether the next value is a word or string.
    pub fn is_word(&self) -> bool {
        self.word.is_some()
    }

    /// A number that a 32-bit float can hold.
    pub fn number(&mut self) -> Result<f32, Diagnostic> {
        self.numbers().map(|[x]| x)
    }

    /// A number within a range, such as `0.0..=180.0` or `0.0..`.
    pub fn number_in(&mut self, range: impl RangeBounds<f64>) -> Result<f32, Diagnostic> {
        let [number] = self.take()?;
        if !range.contains(&number.value) {
            return Err(self.out_of_range(number, &describe(&range)));
        }
        self.single(number)
    }

    /// A number above zero.
    pub fn positive(&mut self) -> Result<f32, Diagnostic> {
        self.number_in((Bound::Excluded(0.0), Bound::Unbounded))
    }

    /// A number in full precision.
    pub fn double(&mut self) -> Result<f64, Diagnostic> {
        self.take().map(|[number]| number.value)
    }

    /// A whole number within a range.
    pub fn int_in(&mut self, range: RangeInclusive<i64>) -> Result<i64, Diagnostic> {
        let [number] = self.take()?;
        // Every i64 up to 2^53 is a double; the cast saturates beyond.
        let value = number.value as i64;
        if value as f64 == number.value && range.contains(&value) {
            return Ok(value);
        }
        let wanted = format!("a whole number from {} to {}", range.start(), range.end());
        Err(self.out_of_range(number, &wanted))
    }

    /// Exactly `N` numbers.
    pub fn numbers<const N: usize>(&mut self) -> Result<[f32; N], Diagnostic> {
        let numbers = self.take::<N>()?;
        let mut out = [0.0; N];
        for (out, number) in out.iter_mut().zip(numbers) {
            *out = self.single(number)?;
        }
        Ok(out)
    }

    /// Two numbers.
    pub fn vec2(&mut self) -> Result<Vec2, Diagnostic> {
        self.numbers().map(Vec2::from_array)
    }

    /// Three numbers: a point, a direction or a colour.
    pub fn vec3(&mut self) -> Result<Vec3, Diagnostic> {
        self.numbers().map(Vec3::from_array)
    }

    /// All numbers left, as points of three numbers each.
    pub fn points(&mut self) -> Result<Vec<Vec3>, Diagnostic> {
        let left = self.numbers_left();
        if !left.is_multiple_of(3) || self.word.is_some() {
            let found = self.found();
            return Err(self.mismatch("numbers in groups of three", &found));
        }
        (0..left / 3).map(|_| self.vec3()).collect()
    }

    /// A word or string of the table, and what it stands for there.
    pub fn choice<T: Copy>(&mut self, table: &[(&'static str, T)]) -> Result<T, Diagnostic> {
        self.choice_or(table, &[])
    }

    /// The same where further words are understood, of which messages say nothing.
    pub fn choice_or<T: Copy>(
        &mut self,
        table: &[(&'static str, T)],
        synonyms: &[(&'static str, T)],
    ) -> Result<T, Diagnostic> {
        let text = self.word.map(|word| word.text());
        let found = text.and_then(|text| table.iter().chain(synonyms).find(|(name, _)| *name == text));
        let Some(&(_, value)) = found else {
            let words: Vec<_> = table.iter().map(|&(word, _)| word).collect();
            return Err(self.none_of(&words));
        };
        self.word = None;
        Ok(value)
    }

    /// One of the given words.
    pub fn word_of(&mut self, choices: &[&'static str]) -> Result<&'static str, Diagnostic> {
        let table: Vec<_> = choices.iter().map(|&word| (word, word)).collect();
        self.choice(&table)
    }

    /// `on`, `true`, `yes`, `1`, or `off`, `false`, `no`, `0`.
    pub fn flag(&mut self) -> Result<bool, Diagnostic> {
        let word = self.word.map(|word| word.text());
        let value = match (word.as_deref(), self.numbers) {
            (Some("on" | "true" | "yes"), _) => true,
            (Some("off" | "false" | "no"), _) => false,
            (None, [number, ..]) if number.value == 1.0 || number.value == 0.0 => {
                self.taken += 1;
                return Ok(number.value == 1.0);
            }
            _ => {
                let found = self.found();
                return Err(self.mismatch("on or off", &found));
            }
        };
        self.word = None;
        Ok(value)
    }

    /// A word or string, such as a name or a path.
    pub fn text(&mut self) -> Result<Cow<'a, str>, Diagnostic> {
        match self.word.take_if(|word| !matches!(word.value(), Value::Function(_))) {
            Some(word) => Ok(word.text()),
            None => {
                let found = self.found();
                Err(self.mismatch("a word or a string in quotes", &found))
            }
        }
    }

    /// A function of the place; a number is one that is the same everywhere.
    pub fn function(&mut self) -> Result<Arc<Tape>, Diagnostic> {
        if let Some(function) = self.item.function() {
            self.word = None;
            return Ok(function.clone());
        }
        if self.word.is_none() && self.numbers_left() == 1 {
            let value = self.double()?;
            return Ok(Arc::new(TapeBuilder::new().finish(Node::Constant(value))));
        }
        let found = self.found();
        let error = self.mismatch("`=` and a function of x, y and z", &found);
        Err(error.help(format!("write `{} = x^2 + y^2 + z^2 - 1`", self.key())))
    }

    /// An error about this item's values, placed at them.
    pub fn error(&self, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(message).label(self.item.head_span(), "")
    }

    fn take<const N: usize>(&mut self) -> Result<[Number; N], Diagnostic> {
        if let Some(word) = self.word {
            return Err(self.word_for_number(word, N));
        }
        let Some(numbers) = self.numbers[self.taken..].first_chunk::<N>() else {
            let found = self.numbers.len().to_string();
            return Err(self.mismatch(&count(self.taken + N), &found));
        };
        self.taken += N;
        Ok(*numbers)
    }

    /// All values must have been taken.
    fn end(&self) -> Result<(), Diagnostic> {
        if let Some(word) = self.word {
            let message = format!("unexpected {} after `{}`", quoted(&word.text()), self.key());
            return Err(Diagnostic::error(message).label(word.span, "expected no word here"));
        }
        if let [first, .., last] | [first @ last] = &self.numbers[self.taken..] {
            let message = format!(
                "expected {} after `{}`, found {}",
                count(self.taken),
                self.key(),
                self.numbers.len()
            );
            let span = self.item.span_of((first.start, last.end));
            return Err(Diagnostic::error(message).label(span, "too many"));
        }
        Ok(())
    }

    /// That what stands there is none of the words of a table.
    fn none_of(&self, words: &[&str]) -> Diagnostic {
        let Some(word) = self.word else {
            let found = self.found();
            return self.mismatch(&one_of(words), &found);
        };
        let text = word.text();
        let meant = nearest(&text, words.iter().copied()).map(|near| format!("did you mean `{near}`?"));
        let message = format!("expected {} after `{}`, found {}", one_of(words), self.key(), quoted(&text));
        Diagnostic::error(message).label(word.span, "not one of them").maybe_help(meant)
    }

    fn no_block(&self) -> Result<(), Diagnostic> {
        let Some(child) = self.item.children().next() else { return Ok(()) };
        let message = format!("`{}` takes no block", self.key());
        Err(Diagnostic::error(message).label(child.keyword_span(), "expected a number or `}`"))
    }

    fn key(&self) -> &'a str {
        self.item.keyword()
    }

    fn single(&self, number: Number) -> Result<f32, Diagnostic> {
        let value = number.value as f32;
        if value.is_finite() {
            return Ok(value);
        }
        Err(self.out_of_range(number, "between -3.4e38 and 3.4e38"))
    }

    fn out_of_range(&self, number: Number, wanted: &str) -> Diagnostic {
        let span = self.item.span_of((number.start, number.end));
        let found = self.item.desc().sources().text(span);
        Diagnostic::error(format!("`{}` must be {wanted}, found {found}", self.key()))
            .label(span, "out of range")
    }

    fn word_for_number(&self, word: Word<'_>, n: usize) -> Diagnostic {
        if let Value::Function(_) = word.value() {
            let message =
                format!("expected {} after `{}`, found a function of the place", count(n), self.key());
            return Diagnostic::error(message).label(word.span, "expected no `x`, `y` or `z` here");
        }
        let text = word.text();
        let found = match text.parse::<f64>() {
            // The lexer takes any number that a float can hold.
            Ok(_) => format!("{}, which is too large", quoted(&text)),
            Err(_) if looks_like_number(&text) => format!("{}, which is not a number", quoted(&text)),
            Err(_) => quoted(&text),
        };
        let message = format!("expected {} after `{}`, found {found}", count(n), self.key());
        Diagnostic::error(message).label(word.span, "expected a number such as 1, -0.5 or 2e3")
    }

    /// What there is, for a message.
    fn found(&self) -> String {
        match (self.word, self.numbers.len()) {
            (Some(word), _) => quoted(&word.text()),
            (None, 0) => "nothing".to_owned(),
            (None, n) => count(n),
        }
    }

    fn mismatch(&self, expected: &str, found: &str) -> Diagnostic {
        Diagnostic::error(format!("expected {expected} after `{}`, found {found}", self.key()))
            .label(self.values_span(), format!("found {found}"))
    }

    /// The values there are, or the keyword when there are none.
    fn values_span(&self) -> Span {
        let spans = || self.item.values().map(|(_, span)| span);
        match (spans().next(), spans().last()) {
            (Some(first), Some(last)) => first.to(last),
            _ => self.item.keyword_span(),
        }
    }
}

fn count(n: usize) -> String {
    match n {
        0 => "no number".to_owned(),
        1 => "1 number".to_owned(),
        n => format!("{n} numbers"),
    }
}

/// "`a`, `b` or `c`".
pub(crate) fn one_of(words: &[&str]) -> String {
    let words: Vec<String> = words.iter().map(|word| format!("`{word}`")).collect();
    match words.split_last() {
        None => "nothing".to_owned(),
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
    }
}

fn describe(range: &impl RangeBounds<f64>) -> String {
    let low = match range.start_bound() {
        Bound::Included(x) => Some(format!("at least {x}")),
        Bound::Excluded(x) => Some(format!("more than {x}")),
        Bound::Unbounded => None,
    };
    let high = match range.end_bound() {
        Bound::Included(x) => Some(format!("at most {x}")),
        Bound::Excluded(x) => Some(format!("less than {x}")),
        Bound::Unbounded => None,
    };
    [low, high].into_iter().flatten().collect::<Vec<_>>().join(" and ")
}
