//! The named values that are in force where the parser stands.

use std::collections::HashMap;

/// The named values that are in force.
#[derive(Default)]
pub(super) struct Scope {
    /// For each name its values, the innermost last, with their places in the list of the tree.
    values: HashMap<String, Vec<(f64, u32)>>,
    /// Those that change with time, by their places: what they are at each moment.
    changing: HashMap<u32, Vec<f64>>,
    /// The names in the order in which they were given values.
    names: Vec<String>,
}

impl Scope {
    pub fn get(&self, name: &str) -> Option<f64> {
        self.find(name).map(|(value, _)| value)
    }

    pub fn find(&self, name: &str) -> Option<(f64, u32)> {
        self.values.get(name)?.last().copied()
    }

    /// The value of a name, and what it is at each moment if it changes.
    pub fn at_moments(&self, name: &str) -> Option<(f64, Option<&[f64]>)> {
        let (value, index) = self.find(name)?;
        Some((value, self.changing.get(&index).map(Vec::as_slice)))
    }

    /// Says what the value with this place in the list of the tree is at each moment.
    pub fn set_moments(&mut self, index: u32, values: Vec<f64>) {
        self.changing.insert(index, values);
    }

    /// How many values are in force, for [`Scope::forget`].
    pub fn len(&self) -> usize {
        self.names.len()
    }

    pub fn add(&mut self, name: &str, value: f64, index: u32) {
        self.values.entry(name.to_owned()).or_default().push((value, index));
        self.names.push(name.to_owned());
    }

    /// Forgets all values but the first `len`.
    pub fn forget(&mut self, len: usize) {
        for name in self.names.drain(len.min(self.names.len())..) {
            if let Some(values) = self.values.get_mut(&name)
                && let Some((_, index)) = values.pop()
                && !self.changing.is_empty()
            {
                self.changing.remove(&index);
            }
        }
    }
}
