//! Expressions at the moments of a [`Clock`]: `time`, `frame` and what is made of them.

use std::cell::Cell;

use super::Parser;
use super::scope::Scope;
use crate::clock::Clock;
use crate::expression::{Around, Evaluated, ExpressionError, evaluate};
use crate::source::Span;

const TIME: &str = "time";
const FRAME: &str = "frame";

/// Whether a name stands for the time, unless a value has that name.
pub(super) fn is_time(name: &str) -> bool {
    name == TIME || name == FRAME
}

/// What names are worth at a moment.
pub(super) struct Moment<'a> {
    pub scope: &'a Scope,
    pub clock: &'a Clock,
    /// Which moment of the clock.
    pub moment: usize,
    /// Set when something was asked for that changes with time.
    pub has_changed: &'a Cell<bool>,
}

impl Moment<'_> {
    pub fn value(&self, name: &str) -> Option<f64> {
        if let Some((value, changing)) = self.scope.at_moments(name) {
            let Some(values) = changing else { return Some(value) };
            self.has_changed.set(true);
            return Some(values.get(self.moment).copied().unwrap_or(value));
        }
        let value = match name {
            TIME => self.clock.seconds_at(self.moment),
            FRAME => self.clock.frame_at(self.moment),
            _ => return None,
        };
        self.has_changed.set(true);
        Some(value)
    }
}

/// A number at all moments of the clock.
pub(super) struct Changing {
    /// As it is at the frame, and where it is written.
    pub evaluated: Evaluated,
    /// Its value at each moment; empty for one that is the same at all.
    pub values: Vec<f64>,
}

impl Parser<'_> {
    /// The value of an expression at each moment of the clock; see [`evaluate`].
    pub(super) fn evaluate_changing(
        &self,
        text: &str,
        start: usize,
        around: Around,
    ) -> Result<Changing, ExpressionError> {
        let has_changed = Cell::new(false);
        let (scope, clock) = (&self.scope, &self.clock);
        let at = |moment| {
            let values = Moment { scope, clock, moment, has_changed: &has_changed };
            evaluate(text, start, around, &|name, _| values.value(name))
        };
        let evaluated = at(0)?;
        if !has_changed.get() {
            return Ok(Changing { evaluated, values: Vec::new() });
        }
        let values = (0..clock.len()).map(|moment| at(moment).map(|found| found.value));
        Ok(Changing { evaluated, values: values.collect::<Result<_, _>>()? })
    }

    /// Gives a number to an item, which may change with time.
    pub(super) fn add_value(&mut self, taker: u32, span: Span, value: f64, values: Vec<f64>) {
        if values.is_empty() {
            return self.add_number(taker, span, value);
        }
        self.desc.changes = true;
        self.add_changing(taker, span, values);
    }

    /// Gives a number to an item, with its values at all moments of the clock.
    pub(super) fn add_changing(&mut self, taker: u32, span: Span, values: Vec<f64>) {
        let index = self.desc.numbers.len() as u32;
        self.add_number(taker, span, values[0]);
        if values.len() > 1 {
            self.desc.changing.push((index, values));
        }
    }
}
