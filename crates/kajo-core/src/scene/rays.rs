//! Rays through a scene: what is the nearest surface, is anything in the way, which are all the crossings.
//!
//! Whatever has bounds stands in a tree of boxes, or for rays from and to one point in its [`ItemBuffer`]; what moves and
//! what is nested have trees of their own, and what has no bounds is tried one by one.

use kajo_math::Ray;

use super::{Event, Interaction, Primitive, Scene, rarely};
use crate::family::Pooled;
use crate::ids::{ObjectId, PoseId};
use crate::interaction::Hit;
use crate::item_buffer::{Between, ItemBuffer};
use crate::nested::Leaf;
use crate::shape::{Plane, Sphere, Surface};

impl Scene {
    /// Follows a ray to the first surface it meets.
    ///
    /// Of surfaces at the same distance the one that stands first in the file is met.
    #[inline]
    pub fn trace(&self, ray: &Ray) -> Event {
        self.trace_from(None, ray)
    }

    /// [`Scene::trace`] for a ray that starts at the apex of a buffer, which makes it faster.
    #[inline]
    pub fn trace_from(&self, apex: Option<&ItemBuffer>, ray: &Ray) -> Event {
        let mut at = Interaction::default();
        if self.trace_into(apex, ray, &mut at) { Event::Surface(at) } else { Event::Escaped }
    }

    /// [`Scene::trace_from`] for the innermost loops: writes where the ray ends into `at`, or returns `false` and
    /// leaves something in it.
    ///
    /// An [`Event`] is copied twice right after it was written, field by field, which processors are slow at.
    #[inline]
    pub fn trace_into(&self, apex: Option<&ItemBuffer>, ray: &Ray, at: &mut Interaction) -> bool {
        if !self.closest(apex, ray, at) {
            return false;
        }
        self.complete(ray, at);
        true
    }

    /// [`Scene::trace_into`] for a ray that starts at the surface met last, which `at` still knows, and goes on inside
    /// of it.
    ///
    /// The far side of a sphere is looked for first: few other things are nearer.
    #[inline]
    pub fn trace_inwards(&self, ray: &Ray, at: &mut Interaction) -> bool {
        let met = self.primitives.get(at.object.index()).map(|primitive| self.plain(primitive));
        let within = if matches!(met, Some(Plain::Sphere(_))) { at.object } else { ObjectId::NONE };
        if !self.closest_within(within, None, ray, at) {
            return false;
        }
        self.complete(ray, at);
        true
    }

    /// Whether anything lies within the ray's range.
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_towards(None, ray)
    }

    /// [`Scene::occluded`] for a ray that ends at the apex of a buffer, which makes it faster.
    pub fn occluded_towards(&self, apex: Option<&ItemBuffer>, ray: &Ray) -> bool {
        let blocked = self.any(
            apex,
            ray,
            #[inline(always)]
            |i| self.blocks(i, ray),
        );
        blocked || self.any_nested(ray, |leaf| self.leaf_blocks(leaf, ray))
    }

    /// Visits every crossing with things that light may pass through within the ray's range, in no
    /// particular order; `true` as soon as anything else is in the way or `visit` says so.
    ///
    /// A ray that ends at the apex of a buffer is faster with it.
    pub fn occluded_or(
        &self,
        apex: Option<&ItemBuffer>,
        ray: &Ray,
        mut visit: impl FnMut(ObjectId, Hit) -> bool,
    ) -> bool {
        let mut visit_all = |i: ObjectId| {
            let mut blocked = false;
            self.each_crossing(i, ray, |hit| blocked = blocked || visit(i, hit));
            blocked
        };
        let blocked = self.any(
            apex,
            ray,
            #[inline(always)]
            |i| if self.primitives[i.index()].transmits { visit_all(i) } else { self.blocks(i, ray) },
        );
        blocked
            || self.any_nested(ray, |leaf| {
                if !self.leaf_transmits(leaf) {
                    return self.leaf_blocks(leaf, ray);
                }
                let (mut blocked, object) = (false, self.object_of(leaf));
                let visit = |hit| blocked = blocked || visit(object, hit);
                leaf.in_object(ray, |ray| self.shapes.crossings(leaf.shape, ray, visit));
                blocked
            })
    }

    fn leaf_blocks(&self, leaf: &Leaf, ray: &Ray) -> bool {
        leaf.in_object(ray, |ray| self.shapes.blocks(leaf.shape, ray))
    }

    /// Whether `blocks` is true of any object in nested instances that the ray may meet.
    #[inline]
    fn any_nested(&self, ray: &Ray, blocks: impl FnMut(&Leaf) -> bool) -> bool {
        self.nested.as_ref().is_some_and(|nested| rarely(|| nested.any(ray, blocks)))
    }

    /// Visits every crossing within the ray's range, in no particular order.
    pub fn crossings(&self, ray: &Ray, mut visit: impl FnMut(ObjectId, Hit)) {
        let mut each = |i: ObjectId| self.each_crossing(i, ray, |hit| visit(i, hit));
        self.unbounded.iter().for_each(|&i| each(i));
        self.bvh.each(ray, |i| each(ObjectId::from_index(i)));
        if let Some(moving) = &self.moving {
            moving.each(ray, |i| each(ObjectId::from_index(i)));
        }
        self.any_nested(ray, |leaf| {
            let object = self.object_of(leaf);
            leaf.in_object(ray, |ray| self.shapes.crossings(leaf.shape, ray, |hit| visit(object, hit)));
            false
        });
    }

    /// Position, normals and material at a crossing.
    #[inline]
    pub fn interaction(&self, ray: &Ray, object: ObjectId, hit: Hit) -> Interaction {
        let mut at = Interaction { object, hit, ..Interaction::default() };
        self.complete(ray, &mut at);
        at
    }

    /// Works out position, normals and material where `at` knows the primitive and the hit.
    #[inline]
    fn complete(&self, ray: &Ray, at: &mut Interaction) {
        let Some(placed) = self.primitives.get(at.object.index()) else {
            return rarely(|| self.complete_nested(ray, at));
        };
        if let Plain::Sphere(sphere) = self.plain(placed) {
            at.point = sphere.surface_at(ray, &at.hit);
        } else if placed.pose.is_identity() {
            at.point = self.shapes.surface_at(placed.shape, ray, &at.hit);
        } else {
            at.point = self.transform_at(placed.pose, ray.time, |transform| {
                self.shapes
                    .surface_at(placed.shape, &transform.ray_in_object(ray), &at.hit)
                    .transformed(transform)
            });
        }
        at.material = self.material_at(placed.shape, placed.material, &at.hit);
        at.time = ray.time;
    }

    /// The same for an object in a nested instance.
    fn complete_nested(&self, ray: &Ray, at: &mut Interaction) {
        if let Some(leaf) = self.leaf(at.object) {
            at.point = leaf.surface_at(&self.shapes, ray, &at.hit);
            at.material = self.material_at(leaf.shape, leaf.material.unwrap_or_default(), &at.hit);
            at.time = ray.time;
        }
    }

    /// Whether `blocks` is true of any primitive that the ray may meet, or it is known to be blocked.
    #[inline]
    fn any(&self, apex: Option<&ItemBuffer>, ray: &Ray, mut blocks: impl FnMut(ObjectId) -> bool) -> bool {
        let between = apex.and_then(|apex| apex.between(ray));
        if matches!(between, Some(Between::Blocked)) || self.unbounded.iter().any(|&i| blocks(i)) {
            return true;
        }
        let blocked = match between {
            Some(Between::Items(items, farthest)) => {
                let mut nearer = items.iter().take_while(|item| item.near <= farthest);
                nearer.any(|item| blocks(item.object))
            }
            _ => self.bvh.any(ray, |i| blocks(ObjectId::from_index(i))),
        };
        blocked
            || self
                .moving
                .as_ref()
                .is_some_and(|moving| rarely(|| moving.any(ray, |i| blocks(ObjectId::from_index(i)))))
    }

    /// Finds the nearest hit and writes it and its primitive into `at`; `false` when there is none.
    #[inline]
    fn closest(&self, apex: Option<&ItemBuffer>, ray: &Ray, at: &mut Interaction) -> bool {
        self.closest_within(ObjectId::NONE, apex, ray, at)
    }

    /// As [`Scene::closest`]; the primitive `within` is tried before all others.
    #[inline]
    fn closest_within(
        &self,
        within: ObjectId,
        apex: Option<&ItemBuffer>,
        ray: &Ray,
        at: &mut Interaction,
    ) -> bool {
        at.object = ObjectId::NONE;
        let mut nearest = Nearest { scene: self, ahead: *ray, at };
        let mut t_max = ray.t_max;
        if within != ObjectId::NONE {
            t_max = nearest.consider(within, t_max);
        }
        t_max = self.unbounded.iter().fold(t_max, |t_max, &i| nearest.consider(i, t_max));
        match apex.and_then(|apex| apex.seen_along(ray)) {
            Some(items) => {
                for item in items {
                    if item.near > t_max {
                        break;
                    }
                    t_max = nearest.consider(item.object, t_max);
                }
            }
            None => self.bvh.closest(&ray.over(ray.t_min, t_max), |i, t_max| {
                nearest.consider(ObjectId::from_index(i), t_max)
            }),
        }
        if let Some(moving) = &self.moving {
            let ahead = ray.over(ray.t_min, nearest.t_max(ray));
            rarely(|| moving.closest(&ahead, |i, t_max| nearest.consider(ObjectId::from_index(i), t_max)));
        }
        if let Some(nested) = &self.nested {
            let ahead = ray.over(ray.t_min, nearest.t_max(ray));
            rarely(|| nested.closest(&ahead, |leaf, t_max| nearest.consider_leaf(leaf, t_max)));
        }
        nearest.at.object != ObjectId::NONE
    }

    /// The nearest hit of a primitive.
    #[inline(always)]
    fn hit(&self, object: ObjectId, ray: &Ray) -> Option<Hit> {
        let primitive = &self.primitives[object.index()];
        match self.plain(primitive) {
            Plain::Sphere(sphere) => sphere.hit(ray),
            Plain::Plane(plane) => plane.hit(ray),
            Plain::Neither => self.hit_any(primitive, ray),
        }
    }

    /// Whether a primitive is in the way.
    #[inline(always)]
    fn blocks(&self, object: ObjectId, ray: &Ray) -> bool {
        let primitive = &self.primitives[object.index()];
        match self.plain(primitive) {
            Plain::Sphere(sphere) => sphere.blocks(ray),
            Plain::Plane(plane) => plane.blocks(ray),
            Plain::Neither => self.blocked_by_any(primitive, ray),
        }
    }

    #[inline(always)]
    fn plain(&self, primitive: &Primitive) -> Plain<'_> {
        if !primitive.pose.is_identity() {
            return Plain::Neither;
        }
        if let Some(sphere) = Sphere::find(&self.shapes, primitive.shape) {
            return Plain::Sphere(sphere);
        }
        Plane::find(&self.shapes, primitive.shape).map_or(Plain::Neither, Plain::Plane)
    }

    #[inline(never)]
    fn hit_any(&self, primitive: &Primitive, ray: &Ray) -> Option<Hit> {
        self.in_object(primitive, ray, |ray| self.shapes.hit(primitive.shape, ray))
    }

    #[inline(never)]
    fn blocked_by_any(&self, primitive: &Primitive, ray: &Ray) -> bool {
        self.in_object(primitive, ray, |ray| self.shapes.blocks(primitive.shape, ray))
    }

    /// Visits every crossing with a primitive.
    #[inline]
    fn each_crossing(&self, object: ObjectId, ray: &Ray, visit: impl FnMut(Hit)) {
        let primitive = &self.primitives[object.index()];
        self.in_object(primitive, ray, |ray| self.shapes.crossings(primitive.shape, ray, visit));
    }

    /// `f` of the ray in the space of a primitive.
    #[inline]
    fn in_object<T>(&self, primitive: &Primitive, ray: &Ray, f: impl FnOnce(&Ray) -> T) -> T {
        let own;
        let ray = if primitive.pose.is_identity() {
            ray
        } else {
            own = self.ray_in_object(primitive.pose, ray);
            &own
        };
        // Called in one place only, `f` is compiled into its caller.
        f(ray)
    }

    #[inline(never)]
    fn ray_in_object(&self, pose: PoseId, ray: &Ray) -> Ray {
        self.transform_at(pose, ray.time, |map| map.ray_in_object(ray))
    }
}

/// The shapes whose tests are worth a place in the innermost loops, where they stand in the world as they are.
enum Plain<'a> {
    Sphere(&'a Sphere),
    Plane(&'a Plane),
    Neither,
}

/// The nearest hit of a ray so far.
struct Nearest<'a> {
    scene: &'a Scene,
    /// The ray up to one step beyond that hit, so that an equally near object that stands earlier can still win.
    ahead: Ray,
    /// Its primitive and hit are those of the nearest one so far.
    at: &'a mut Interaction,
}

impl Nearest<'_> {
    /// Tries a primitive; returns the parameter up to which hits are of interest from here on, which is `t_max` or
    /// less.
    #[inline(always)]
    fn consider(&mut self, i: ObjectId, t_max: f32) -> f32 {
        if i == self.at.object {
            return t_max; // It was tried before all others.
        }
        let hit = self.scene.hit(i, &self.ahead);
        self.offer(i, hit, t_max)
    }

    /// Tries an object in a nested instance.
    fn consider_leaf(&mut self, leaf: &Leaf, t_max: f32) -> f32 {
        let hit = leaf.in_object(&self.ahead, |ray| self.scene.shapes.hit(leaf.shape, ray));
        self.offer(self.scene.object_of(leaf), hit, t_max)
    }

    /// Keeps a hit that comes before the one so far.
    #[inline(always)]
    fn offer(&mut self, i: ObjectId, hit: Option<Hit>, t_max: f32) -> f32 {
        let Some(hit) = hit else { return t_max };
        if self.at.object < i && hit.t == self.at.hit.t {
            return t_max;
        }
        (self.at.object, self.at.hit) = (i, hit);
        self.ahead.t_max = hit.t.next_up();
        hit.t
    }

    /// Up to where hits are of interest along `ray`.
    fn t_max(&self, ray: &Ray) -> f32 {
        if self.at.object == ObjectId::NONE { ray.t_max } else { self.at.hit.t }
    }
}
