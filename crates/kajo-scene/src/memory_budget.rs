//! One number of bytes for everything that a scene is made of.
//!
//! Texts, pictures, meshes, objects and lights take what they are going to use before they use it, from a budget that
//! they share; what is left of it is for the film. A reservation that fails is an error that says what needed how much, with its place.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Bytes that a scene may take, shared by its clones.
///
/// ```
/// use kajo_scene::MemoryBudget;
/// let budget = MemoryBudget::new(1000);
/// budget.take(600).unwrap();
/// assert_eq!(budget.take(600).unwrap_err().to_string(), "it needs 600 bytes of memory, and 400 bytes are left");
/// assert_eq!(budget.left(), 400);
/// ```
#[derive(Clone, Debug)]
pub struct MemoryBudget {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    limit: u64,
    used: AtomicU64,
    was_exceeded: AtomicBool,
}

/// More memory was asked for than is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it needs {} of memory, and {} are left", in_words(u128::from(*needed)), in_words(u128::from(*left)))]
pub struct OverBudget {
    /// Bytes asked for.
    pub needed: u64,
    /// Bytes left.
    pub left: u64,
}

/// Bytes of a [`MemoryBudget`] that are given back when this goes away.
#[derive(Debug)]
pub struct MemoryShare {
    budget: MemoryBudget,
    bytes: u64,
}

impl MemoryShare {
    /// Takes more bytes for as long as these.
    ///
    /// # Errors
    /// As [`MemoryBudget::take`].
    pub fn grow(&mut self, bytes: u64) -> Result<(), OverBudget> {
        self.budget.take(bytes)?;
        self.bytes += bytes;
        Ok(())
    }

    /// Leaves a number of bytes taken for good, and gives back what else it has.
    ///
    /// # Errors
    /// As [`MemoryBudget::take`], where that is more than it has.
    pub fn keep(&mut self, bytes: u64) -> Result<(), OverBudget> {
        if let Some(more) = bytes.checked_sub(self.bytes) {
            self.budget.take(more)?;
            self.bytes = 0;
        } else {
            self.bytes -= bytes;
            let rest = std::mem::take(&mut self.bytes);
            self.budget.shared.used.fetch_sub(rest, Ordering::Relaxed);
        }
        Ok(())
    }
}

impl Drop for MemoryShare {
    fn drop(&mut self) {
        self.budget.shared.used.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

impl MemoryBudget {
    /// A budget of `limit` bytes.
    pub fn new(limit: u64) -> MemoryBudget {
        let (used, was_exceeded) = (AtomicU64::new(0), AtomicBool::new(false));
        MemoryBudget { shared: Arc::new(Shared { limit, used, was_exceeded }) }
    }

    /// Bytes taken.
    pub fn used(&self) -> u64 {
        self.shared.used.load(Ordering::Relaxed)
    }

    /// Bytes that can still be taken.
    pub fn left(&self) -> u64 {
        self.shared.limit.saturating_sub(self.used())
    }

    /// Whether a reservation has failed.
    pub fn was_exceeded(&self) -> bool {
        self.shared.was_exceeded.load(Ordering::Relaxed)
    }

    /// Takes bytes for good.
    ///
    /// # Errors
    /// [`OverBudget`]; then nothing is taken.
    pub fn take(&self, bytes: u64) -> Result<(), OverBudget> {
        let more = |used: u64| used.checked_add(bytes).filter(|&sum| sum <= self.shared.limit);
        match self.shared.used.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more) {
            Ok(_) => Ok(()),
            Err(_) => Err(self.exceeded(bytes)),
        }
    }

    /// Takes bytes for a while.
    ///
    /// # Errors
    /// As [`MemoryBudget::take`].
    pub fn share(&self, bytes: u64) -> Result<MemoryShare, OverBudget> {
        self.take(bytes).map(|()| MemoryShare { budget: self.clone(), bytes })
    }

    /// The error of something that found by itself that it needs more than is left.
    pub fn exceeded(&self, needed: u64) -> OverBudget {
        self.shared.was_exceeded.store(true, Ordering::Relaxed);
        OverBudget { needed, left: self.left() }
    }
}

/// No bound.
impl Default for MemoryBudget {
    fn default() -> MemoryBudget {
        MemoryBudget::new(u64::MAX)
    }
}

/// Of equal size, however much of them is used.
impl PartialEq for MemoryBudget {
    fn eq(&self, other: &MemoryBudget) -> bool {
        self.shared.limit == other.shared.limit
    }
}

impl Eq for MemoryBudget {}

/// 1536 as "1.5 kB".
pub fn in_words(bytes: u128) -> impl fmt::Display {
    const UNITS: [&str; 6] = ["kB", "MB", "GB", "TB", "PB", "EB"];
    if bytes < 1000 {
        return format!("{bytes} bytes");
    }
    let mut amount = bytes as f64 / 1000.0;
    let mut unit = 0;
    while amount >= 1000.0 && unit + 1 < UNITS.len() {
        amount /= 1000.0;
        unit += 1;
    }
    format!("{amount:.1} {}", UNITS[unit])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_taken_is_known_to_all_clones() {
        let budget = MemoryBudget::new(100);
        let clone = budget.clone();
        let share = clone.share(60).unwrap();
        assert_eq!((budget.used(), budget.left()), (60, 40));
        assert_eq!(budget.take(41), Err(OverBudget { needed: 41, left: 40 }));
        assert!(clone.was_exceeded());
        budget.take(40).unwrap();
        drop(share);
        assert_eq!(clone.left(), 60);
        assert_eq!(budget.take(u64::MAX).unwrap_err().left, 60, "a sum that overflows is refused too");
    }

    #[test]
    fn of_a_share_some_may_be_kept() {
        let budget = MemoryBudget::new(100);
        for (kept, used) in [(20, 20), (0, 20), (30, 50), (45, 95)] {
            let mut share = budget.share(30).unwrap_or_else(|_| budget.share(0).unwrap());
            share.keep(kept).unwrap();
            assert_eq!(budget.used(), used);
            drop(share);
            assert_eq!(budget.used(), used, "{kept}");
        }
        let mut share = budget.share(1).unwrap();
        assert!(share.keep(7).is_err());
        drop(share);
        assert_eq!(budget.used(), 95, "what was not kept is given back");
    }

    #[test]
    fn amounts_are_readable() {
        let said = [0, 999, 1536, 2_500_000, 3_100_000_000].map(|bytes| in_words(bytes).to_string());
        assert_eq!(said, ["0 bytes", "999 bytes", "1.5 kB", "2.5 MB", "3.1 GB"]);
    }
}
