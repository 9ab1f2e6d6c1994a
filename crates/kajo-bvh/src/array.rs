//! Arrays of a fixed length, large ones in huge pages.
//!
//! Every step of a ray through a large tree touches another page of memory, and a processor
//! remembers where a few thousand pages lie. With pages of 2 MiB that is all of the tree; the
//! system also fills them faster than many small ones. So large arrays are mapped on their
//! own, with the advice to use huge pages where the system knows it.

use std::fmt;
use std::ops::{Deref, DerefMut};

use bytemuck::Pod;
use memmap2::MmapMut;

/// Arrays of at least so many bytes are mapped on their own.
const LARGE: usize = 1 << 20;

/// An array whose length is known when it is made.
pub(crate) struct Array<T>(Store<T>);

enum Store<T> {
    Heap(Vec<T>),
    /// Whole items, suitably aligned: a mapping begins with a page.
    Pages(MmapMut),
}

impl<T> Array<T> {
    pub(crate) const EMPTY: Array<T> = Array(Store::Heap(Vec::new()));
}

impl<T: Pod> Array<T> {
    /// `len` items, all of whose bytes are zero.
    pub(crate) fn zeroed(len: usize) -> Array<T> {
        Array(match len.checked_mul(size_of::<T>()).and_then(pages) {
            Some(pages) => Store::Pages(pages),
            None => Store::Heap(vec![T::zeroed(); len]),
        })
    }
}

/// Memory of its own for `bytes` bytes, if that is worth it and the system has it.
fn pages(bytes: usize) -> Option<MmapMut> {
    if bytes < LARGE {
        return None;
    }
    let map = MmapMut::map_anon(bytes).ok()?;
    // Only advice: small pages work as well.
    #[cfg(target_os = "linux")]
    let _ = map.advise(memmap2::Advice::HugePage);
    Some(map)
}

impl<T: Pod> Deref for Array<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        match &self.0 {
            Store::Heap(items) => items,
            Store::Pages(pages) => bytemuck::cast_slice(pages),
        }
    }
}

impl<T: Pod> DerefMut for Array<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        match &mut self.0 {
            Store::Heap(items) => items,
            Store::Pages(pages) => bytemuck::cast_slice_mut(pages),
        }
    }
}

impl<T: Pod> Clone for Array<T> {
    fn clone(&self) -> Array<T> {
        let mut copy = Array::zeroed(self.len());
        copy.copy_from_slice(self);
        copy
    }
}

impl<T: Pod + PartialEq> PartialEq for Array<T> {
    fn eq(&self, other: &Array<T>) -> bool {
        **self == **other
    }
}

impl<T: Pod + fmt::Debug> fmt::Debug for Array<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_and_large_arrays_are_zero_and_keep_what_is_written() {
        for len in [0, 1, 1000, LARGE / 8 - 1, LARGE / 8, LARGE] {
            let mut array = Array::<[u32; 2]>::zeroed(len);
            assert!(array.len() == len && array.iter().all(|x| *x == [0, 0]));
            assert_eq!(matches!(array.0, Store::Pages(_)), len >= LARGE / 8);
            array.iter_mut().zip(0..).for_each(|(x, i)| *x = [i, !i]);
            let copy = array.clone();
            assert!(array == copy && copy.iter().zip(0..).all(|(x, i)| *x == [i, !i]));
        }
        assert_eq!(Array::<()>::zeroed(1 << 40).len(), 1 << 40);
    }
}
