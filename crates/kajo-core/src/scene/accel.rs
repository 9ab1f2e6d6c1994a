//! Everything that rays can hit, behind three questions: what is closest, is there any, which are all.
//!
//! What rests and has bounds stands in a tree of boxes, or for rays from and to one point in its [`ItemBuffer`]; what moves and
//! what is nested have trees of their own, and what has no bounds is tried one by one. Trees hold boxes: the objects
//! that a ray comes near are tested by the caller.

use kajo_bvh::{BuildSettings, Bvh};
use kajo_math::{Aabb, Ray};

use super::rarely;
use crate::ids::ObjectId;
use crate::item_buffer::{Between, Item, ItemBuffer};
use crate::moving_tree::MovingTree;
use crate::nested::{Leaf, Nested};

/// All objects of a scene, each in one place.
#[derive(Debug, Default)]
pub(crate) struct Aggregate {
    /// What rests and has bounds.
    resting: Bvh,
    /// What moves.
    moving: Option<MovingTree>,
    /// Instances that are kept nested.
    nested: Option<Nested>,
    /// What has no bounds.
    unbounded: Vec<ObjectId>,
}

/// Asks for the closest hit of a ray.
pub(super) trait ClosestQuery {
    /// Tries an object; returns the parameter up to which hits are of interest from here on, which is `t_max` or less.
    fn object(&mut self, object: ObjectId, t_max: f32) -> f32;

    /// The same for an object in a nested instance.
    fn leaf(&mut self, leaf: &Leaf, t_max: f32) -> f32;

    /// Up to where hits are of interest along the ray.
    fn t_max(&self, ray: &Ray) -> f32;
}

/// Asks for the objects that a ray may hit.
pub(super) trait Visitor {
    /// Visits an object; `true` where no other one needs to be visited.
    fn object(&mut self, object: ObjectId) -> bool;

    /// The same for an object in a nested instance.
    fn leaf(&mut self, leaf: &Leaf) -> bool;
}

/// Whether the visitor is content with any of the items up to a distance from their apex, of which there are few.
#[inline(always)]
fn any_item(items: &[Item], farthest: f32, visitor: &mut impl Visitor) -> bool {
    // As `any` of an iterator this would not be compiled into its caller.
    for item in items {
        if item.near > farthest {
            return false;
        }
        if visitor.object(item.object) {
            return true;
        }
    }
    false
}

impl Aggregate {
    /// Puts objects into their trees.
    ///
    /// * `bounds`: world-space boxes of all objects, at any time while the shutter is open
    /// * `is_moving`: whether each of them moves
    /// * `moving_bounds`: boxes of one that moves, by its index, at both ends of a part of the shutter's interval; empty for
    ///   one without bounds
    /// * `nested`: instances that are kept nested, if there are any
    pub fn build(
        bounds: &[Aabb],
        is_moving: &[bool],
        moving_bounds: impl Fn(usize, [f64; 2]) -> [Aabb; 2],
        nested: Option<Nested>,
        settings: &BuildSettings,
    ) -> Aggregate {
        // Trees leave empty boxes out, so what moves and what has no bounds keeps its number and stands aside.
        let is_unbounded = |i: &ObjectId| !bounds[i.index()].is_finite() && !bounds[i.index()].is_empty();
        let unbounded = (0..bounds.len() as u32).map(ObjectId::from_index).filter(is_unbounded).collect();
        let rests = |b: &Aabb, moves: bool| b.is_finite() && !moves;
        let boxes: Vec<Aabb> = std::iter::zip(bounds, is_moving)
            .map(|(b, &moves)| if rests(b, moves) { *b } else { Aabb::EMPTY })
            .collect();
        let moving = is_moving.contains(&true).then(|| {
            let part = |i: usize, part| match bounds[i].is_finite() {
                true => moving_bounds(i, part),
                false => [Aabb::EMPTY; 2],
            };
            MovingTree::build(bounds.len(), part, settings)
        });
        Aggregate { resting: Bvh::build(&boxes, settings), moving, nested, unbounded }
    }

    /// Instances that are kept nested.
    pub fn nested(&self) -> Option<&Nested> {
        self.nested.as_ref()
    }

    /// Whether anything has no bounds.
    pub fn has_unbounded(&self) -> bool {
        !self.unbounded.is_empty()
    }

    /// Whether anything stands in the tree of what moves.
    #[cfg(test)]
    pub fn has_moving(&self) -> bool {
        self.moving.is_some()
    }

    /// Bytes of all trees.
    pub fn bytes(&self) -> usize {
        let moving = self.moving.as_ref().map_or(0, MovingTree::bytes);
        self.resting.stats().bytes + moving + self.nested.as_ref().map_or(0, Nested::bytes)
    }

    /// Tries all objects that may be hit closest, up to the parameter `t_max` of the ray.
    ///
    /// A ray that starts at the apex of a buffer is faster with it.
    #[inline(always)]
    pub(super) fn closest(
        &self,
        apex: Option<&ItemBuffer>,
        ray: &Ray,
        mut t_max: f32,
        query: &mut impl ClosestQuery,
    ) {
        t_max = self.unbounded.iter().fold(t_max, |t_max, &i| query.object(i, t_max));
        match apex.and_then(|apex| apex.seen_along(ray)) {
            Some(items) => {
                for item in items {
                    if item.near > t_max {
                        break;
                    }
                    t_max = query.object(item.object, t_max);
                }
            }
            None => self.resting.closest(&ray.over(ray.t_min, t_max), |i, t_max| {
                query.object(ObjectId::from_index(i), t_max)
            }),
        }
        if let Some(moving) = &self.moving {
            let ahead = ray.over(ray.t_min, query.t_max(ray));
            rarely(|| moving.closest(&ahead, |i, t_max| query.object(ObjectId::from_index(i), t_max)));
        }
        if let Some(nested) = &self.nested {
            let ahead = ray.over(ray.t_min, query.t_max(ray));
            rarely(|| nested.closest(&ahead, |leaf, t_max| query.leaf(leaf, t_max)));
        }
    }

    /// Whether the visitor is content with any object that the ray may hit, or it is known to be blocked.
    ///
    /// A ray that ends at the apex of a buffer is faster with it.
    #[inline(always)]
    pub(super) fn any(&self, apex: Option<&ItemBuffer>, ray: &Ray, visitor: &mut impl Visitor) -> bool {
        let between = apex.and_then(|apex| apex.between(ray));
        if matches!(between, Some(Between::Blocked)) {
            return true;
        }
        for &object in &self.unbounded {
            if visitor.object(object) {
                return true;
            }
        }
        let found = match between {
            Some(Between::Items(items, farthest)) => any_item(items, farthest, visitor),
            _ => self.resting.any(ray, |i| visitor.object(ObjectId::from_index(i))),
        };
        found
            || self
                .moving
                .as_ref()
                .is_some_and(|moving| rarely(|| moving.any(ray, |i| visitor.object(ObjectId::from_index(i)))))
            || self
                .nested
                .as_ref()
                .is_some_and(|nested| rarely(|| nested.any(ray, |leaf| visitor.leaf(leaf))))
    }

    /// Shows all objects that the ray may hit to the visitor, whatever it answers, in no particular order.
    #[inline]
    pub(super) fn each(&self, ray: &Ray, visitor: &mut impl Visitor) {
        let mut show = |i: ObjectId| {
            visitor.object(i);
        };
        self.unbounded.iter().for_each(|&i| show(i));
        self.resting.each(ray, |i| show(ObjectId::from_index(i)));
        if let Some(moving) = &self.moving {
            moving.each(ray, |i| show(ObjectId::from_index(i)));
        }
        if let Some(nested) = &self.nested {
            rarely(|| {
                nested.any(ray, |leaf| {
                    visitor.leaf(leaf);
                    false
                })
            });
        }
    }
}
