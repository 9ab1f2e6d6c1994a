//! Memory of a file that is being read: taken from the scene's budget before lists grow.

use crate::memory_budget::{MemoryBudget, MemoryShare, OverBudget};
use crate::mesh_file_error::MeshFileError;

/// What lists of one reader hold; given back to the budget when the reader is done.
///
/// Lists grow by half of themselves, so that they are copied seldom and take little more than they need.
#[derive(Debug)]
pub(crate) struct ReadMemory {
    budget: MemoryBudget,
    share: Option<MemoryShare>,
}

impl ReadMemory {
    /// Nothing yet.
    pub fn new(budget: &MemoryBudget) -> ReadMemory {
        ReadMemory { budget: budget.clone(), share: None }
    }

    /// Makes room for `more` items of a list.
    #[inline]
    pub fn room<T>(&mut self, list: &mut Vec<T>, more: usize) -> Result<(), OverBudget> {
        if list.capacity() - list.len() >= more { Ok(()) } else { self.grow(list, more) }
    }

    /// Adds an item to a list.
    #[inline]
    pub fn push<T>(&mut self, list: &mut Vec<T>, item: T) -> Result<(), OverBudget> {
        self.room(list, 1)?;
        list.push(item);
        Ok(())
    }

    /// Takes bytes for what is no list.
    pub fn take(&mut self, bytes: usize) -> Result<(), OverBudget> {
        match &mut self.share {
            Some(share) => share.grow(bytes as u64),
            none => {
                *none = Some(self.budget.share(bytes as u64)?);
                Ok(())
            }
        }
    }

    #[cold]
    fn grow<T>(&mut self, list: &mut Vec<T>, more: usize) -> Result<(), OverBudget> {
        let (len, capacity) = (list.len(), list.capacity());
        let wanted = len.saturating_add(more.max(len / 2).max(16));
        let bytes = wanted.saturating_sub(capacity).saturating_mul(size_of::<T>());
        self.take(bytes)?;
        let whole = wanted.saturating_mul(size_of::<T>()) as u64;
        list.try_reserve_exact(wanted - len).map_err(|_| self.budget.exceeded(whole))
    }
}

impl MeshFileError {
    /// That a file cannot be read for want of memory.
    pub(crate) fn memory(path: &str, over: OverBudget) -> MeshFileError {
        MeshFileError::Memory { path: path.to_owned(), source: over }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_take_what_they_hold_and_give_it_back() {
        let budget = MemoryBudget::new(10_000);
        let mut memory = ReadMemory::new(&budget);
        let mut list: Vec<u64> = Vec::new();
        let full = (0..).find_map(|i| memory.push(&mut list, i).err()).unwrap();
        assert_eq!(budget.used(), 8 * list.capacity() as u64);
        assert!(list.len() == list.capacity() && 8 * list.len() > 6000, "{} {full:?}", list.len());
        assert!(budget.was_exceeded() && full.left == 10_000 - budget.used());
        assert_eq!(list.last(), Some(&(list.len() as u64 - 1)), "what did not fit is not there");
        drop(memory);
        assert_eq!(budget.used(), 0);
    }

    #[test]
    fn more_than_there_is_anywhere_is_refused() {
        let mut memory = ReadMemory::new(&MemoryBudget::default());
        let mut list: Vec<u64> = Vec::new();
        assert!(memory.room(&mut list, usize::MAX).is_err());
    }
}
