//! Maps that change with time.
//!
//! A map is given at some moments, its keys, and stays what it is before the first and after the last. Between two
//! keys the maps are taken apart by polar decomposition,
//!
//! ```text
//! M = T R S            translation, rotation, symmetric stretch
//! M(t) = T(t) R(t) S(t),   T and S linear in t,   R(t) = R0 exp(u [a]x),  u growing steadily to the angle
//! ```
//!
//! so that what is rigid at the keys is rigid in between: interpolated entries of a matrix would shrink what turns
//! [Shoemake and Duff 1992], [Shoemake 1985]. Keyed maps nest: each is evaluated at the time, and the product is
//! the map from the innermost space to the world.

mod bounds;
mod pose;

use std::sync::Arc;

pub use pose::{Pose, PoseSegment};

use crate::DAffine3;

/// Why keys make no motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyError {
    /// There are fewer than two.
    Few,
    /// The key of this number is not later than the one before it, or its time is no number.
    Order(usize),
    /// The map of the key of this number has no inverse.
    NoInverse(usize),
    /// The key of this number mirrors and the one before it does not, or the other way round.
    Mirrors(usize),
}

/// A map given at two moments or more.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframes {
    /// Moments, each later than the one before.
    times: Vec<f64>,
    /// The way from each key to the next.
    segments: Vec<PoseSegment>,
}

impl Keyframes {
    /// The map that is `keys[i].1` at the time `keys[i].0`.
    pub fn new(keys: &[(f64, DAffine3)]) -> Result<Keyframes, KeyError> {
        if keys.len() < 2 {
            return Err(KeyError::Few);
        }
        let times: Vec<f64> = keys.iter().map(|key| key.0).collect();
        let in_order = |i: &usize| times[*i].is_finite() && (*i == 0 || times[*i] > times[*i - 1]);
        if let Some(i) = (0..times.len()).find(|i| !in_order(i)) {
            return Err(KeyError::Order(i));
        }
        let mut poses = Vec::with_capacity(keys.len());
        for (i, (_, m)) in keys.iter().enumerate() {
            poses.push(Pose::of(m).ok_or(KeyError::NoInverse(i))?);
        }
        let mut segments = Vec::with_capacity(keys.len() - 1);
        for (i, ends) in poses.windows(2).enumerate() {
            segments.push(PoseSegment::between(&ends[0], &ends[1]).ok_or(KeyError::Mirrors(i + 1))?);
        }
        Ok(Keyframes { times, segments })
    }

    /// The map at a time.
    #[inline]
    pub fn at(&self, time: f64) -> DAffine3 {
        let i = self.segment_at(time);
        let (start, end) = (self.times[i], self.times[i + 1]);
        self.segments[i].at(((time - start) / (end - start)).clamp(0.0, 1.0))
    }

    /// Whether nothing is stretched, ever.
    pub fn is_rigid(&self) -> bool {
        self.segments.iter().all(PoseSegment::is_rigid)
    }

    /// The ways from key to key.
    pub fn segments(&self) -> &[PoseSegment] {
        &self.segments
    }

    /// The number of the segment that holds a time, or the one nearest to it.
    #[inline]
    fn segment_at(&self, time: f64) -> usize {
        self.times.partition_point(|&t| t <= time).clamp(1, self.segments.len()) - 1
    }

    /// Whether nothing changes from `open` to `close`.
    fn is_still_over(&self, [open, close]: [f64; 2]) -> bool {
        let apart = |i: usize| self.times[i + 1] <= open || self.times[i] >= close;
        open >= close || (0..self.segments.len()).all(|i| self.segments[i].is_still() || apart(i))
    }
}

/// A keyed map and the still one outside of it.
#[derive(Clone, Debug)]
struct Link {
    before: DAffine3,
    keys: Arc<Keyframes>,
}

/// A map from object to world space that may change with time: a product of still and keyed maps.
///
/// Copies share the keyed ones.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Outermost first; `None` for a map that never changes.
    links: Option<Arc<[Link]>>,
    /// What acts on the object first.
    still: DAffine3,
}

impl Motion {
    /// The map that is `m` at all times.
    pub fn still(m: DAffine3) -> Motion {
        Motion { links: None, still: m }
    }

    /// A keyed map.
    pub fn keyed(keys: Keyframes) -> Motion {
        let link = Link { before: DAffine3::IDENTITY, keys: Arc::new(keys) };
        Motion { links: Some(Arc::new([link])), still: DAffine3::IDENTITY }
    }

    /// The map itself if it never changes.
    #[inline]
    pub fn constant(&self) -> Option<&DAffine3> {
        if self.links.is_none() { Some(&self.still) } else { None }
    }

    /// The map at a time.
    #[inline]
    pub fn at(&self, time: f64) -> DAffine3 {
        let keyed = |outer: DAffine3, link: &Link| outer * link.before * link.keys.at(time);
        self.links().iter().fold(DAffine3::IDENTITY, keyed) * self.still
    }

    /// `inner` first and then this.
    pub fn then(&self, inner: &Motion) -> Motion {
        let still = self.still * inner.still;
        let links = match (&self.links, &inner.links) {
            (links, None) => return Motion { links: links.clone(), still },
            (None, Some(links)) if self.still == DAffine3::IDENTITY => Some(Arc::clone(links)),
            (_, Some(_)) => {
                let mut links = self.links().to_vec();
                links.extend(inner.links().iter().cloned());
                links[self.links().len()].before = self.still * inner.links()[0].before;
                Some(links.into())
            }
        };
        Motion { links, still: inner.still }
    }

    /// Bytes of the list of its keyed parts, which copies share.
    pub fn bytes(&self) -> usize {
        size_of_val(self.links())
    }

    /// Whether the map is the same from `open` to `close`.
    pub fn is_still_over(&self, interval: [f64; 2]) -> bool {
        self.links().iter().all(|link| link.keys.is_still_over(interval))
    }

    fn links(&self) -> &[Link] {
        self.links.as_deref().unwrap_or_default()
    }
}

/// Maps are equal when they share their keyed parts and agree in the still one.
impl PartialEq for Motion {
    fn eq(&self, other: &Motion) -> bool {
        let same_links = match (&self.links, &other.links) {
            (None, None) => true,
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            _ => false,
        };
        same_links && self.still == other.still
    }
}

#[cfg(test)]
mod tests;
