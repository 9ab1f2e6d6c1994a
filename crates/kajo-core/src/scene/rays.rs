//! Rays through a scene: what is the nearest surface, is anything in the way, which are all the crossings.
//!
//! The [`Aggregate`](super::accel::Aggregate) finds the objects that a ray comes near; here they are tested.

use kajo_math::Ray;

use super::accel::{Aggregate, ClosestQuery, Visitor};
use super::{Interaction, Primitive, RayEvent, Scene, rarely};
use crate::family::Pooled;
use crate::ids::{ObjectId, PoseId};
use crate::interaction::Hit;
use crate::item_buffer::ItemBuffer;
use crate::nested::Leaf;
use crate::shape::{Plane, Sphere, Surface};

impl Scene {
    /// Follows a ray to the first surface it meets.
    ///
    /// Of surfaces at the same distance the one that stands first in the file is met.
    #[inline]
    pub fn trace(&self, ray: &Ray) -> RayEvent {
        self.trace_from(None, ray)
    }

    /// [`Scene::trace`] for a ray that starts at the apex of a buffer, which makes it faster.
    #[inline]
    pub fn trace_from(&self, apex: Option<&ItemBuffer>, ray: &Ray) -> RayEvent {
        let mut at = Interaction::default();
        if self.trace_into(apex, ray, &mut at) { RayEvent::Surface(at) } else { RayEvent::Escaped }
    }

    /// [`Scene::trace_from`] for the innermost loops: writes where the ray ends into `at`, or returns `false` and
    /// leaves something in it.
    ///
    /// An [`RayEvent`] is copied twice right after it was written, field by field, which processors are slow at.
    #[inline]
    pub fn trace_into(&self, apex: Option<&ItemBuffer>, ray: &Ray, at: &mut Interaction) -> bool {
        if !self.closest(apex, ray, at) {
            return false;
        }
        self.complete(ray, at);
        true
    }

    /// [`Scene::trace_into`] for a ray that starts at the surface met last, which `at` still holds, and goes on inside
    /// of it.
    ///
    /// The far side of a sphere is looked for first: few other things are nearer.
    #[inline]
    pub fn trace_inwards(&self, ray: &Ray, at: &mut Interaction) -> bool {
        let met = self.geometry.primitives.get(at.object.index()).map(|primitive| self.plain(primitive));
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
        self.geometry.aggregate.any(apex, ray, &mut Blockers { scene: self, ray })
    }

    /// [`Scene::occluded`] by what stands in one of several trees.
    pub(super) fn occluded_within(&self, aggregate: &Aggregate, ray: &Ray) -> bool {
        aggregate.any(None, ray, &mut Blockers { scene: self, ray })
    }

    /// [`Scene::occluded_or`] by what stands in one of several trees.
    pub(super) fn occluded_within_or(
        &self,
        aggregate: &Aggregate,
        ray: &Ray,
        visit: impl FnMut(ObjectId, Hit) -> bool,
    ) -> bool {
        aggregate.any(None, ray, &mut Passages { scene: self, ray, visit })
    }

    /// Finds the nearest hit of what stands in one of several trees, and writes it and its primitive into `at`; `false` when there is
    /// none.
    pub(super) fn closest_within_tree(&self, aggregate: &Aggregate, ray: &Ray, at: &mut Interaction) -> bool {
        at.object = ObjectId::NONE;
        let mut nearest = Nearest { scene: self, ahead: *ray, at };
        aggregate.closest(None, ray, ray.t_max, &mut nearest);
        nearest.at.object != ObjectId::NONE
    }

    /// Visits every crossing with things that light may pass through within the ray's range, in no
    /// particular order; `true` as soon as anything else is in the way or `visit` says so.
    ///
    /// A ray that ends at the apex of a buffer is faster with it.
    pub fn occluded_or(
        &self,
        apex: Option<&ItemBuffer>,
        ray: &Ray,
        visit: impl FnMut(ObjectId, Hit) -> bool,
    ) -> bool {
        self.geometry.aggregate.any(apex, ray, &mut Passages { scene: self, ray, visit })
    }

    fn leaf_blocks(&self, leaf: &Leaf, ray: &Ray) -> bool {
        leaf.in_object(ray, |ray| self.geometry.shapes.blocks(leaf.shape, ray))
    }

    /// The nearest hit of one object within the ray's range.
    pub(super) fn hit_of(&self, object: ObjectId, ray: &Ray) -> Option<Hit> {
        if object.index() < self.geometry.primitives.len() {
            return self.hit(object, ray);
        }
        let leaf = self.geometry.leaf(object)?;
        leaf.in_object(ray, |ray| self.geometry.shapes.hit(leaf.shape, ray))
    }

    /// Visits every crossing within the ray's range: the objects in no particular order and each once, with all of its
    /// crossings one after the other.
    pub fn crossings(&self, ray: &Ray, visit: impl FnMut(ObjectId, Hit)) {
        self.geometry.aggregate.each(ray, &mut Crossings { scene: self, ray, visit });
    }

    /// Position, normals and material at a crossing.
    #[inline]
    pub fn interaction(&self, ray: &Ray, object: ObjectId, hit: Hit) -> Interaction {
        let mut at = Interaction { object, hit, ..Interaction::default() };
        self.complete(ray, &mut at);
        at
    }

    /// Works out position, normals and material where `at` has the primitive and the hit.
    #[inline]
    pub(super) fn complete(&self, ray: &Ray, at: &mut Interaction) {
        let Some(placed) = self.geometry.primitives.get(at.object.index()) else {
            return rarely(|| self.complete_nested(ray, at));
        };
        if let Plain::Sphere(sphere) = self.plain(placed) {
            at.point = sphere.surface_at(ray, &at.hit);
        } else if placed.pose.is_identity() {
            at.point = self.geometry.shapes.surface_at(placed.shape, ray, &at.hit);
        } else {
            at.point = self.geometry.transform_at(placed.pose, ray.time, |transform| {
                self.geometry
                    .shapes
                    .surface_at(placed.shape, &transform.ray_in_object(ray), &at.hit)
                    .transformed(transform)
            });
        }
        at.material = self.material_at(placed.shape, placed.material, &at.hit);
        at.time = ray.time;
    }

    /// The same for an object in a nested instance.
    fn complete_nested(&self, ray: &Ray, at: &mut Interaction) {
        if let Some(leaf) = self.geometry.leaf(at.object) {
            at.point = leaf.surface_at(&self.geometry.shapes, ray, &at.hit);
            at.material = self.material_at(leaf.shape, leaf.material.unwrap_or_default(), &at.hit);
            at.time = ray.time;
        }
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
            t_max = nearest.object(within, t_max);
        }
        self.geometry.aggregate.closest(apex, ray, t_max, &mut nearest);
        nearest.at.object != ObjectId::NONE
    }

    /// The nearest hit of a primitive.
    #[inline(always)]
    fn hit(&self, object: ObjectId, ray: &Ray) -> Option<Hit> {
        let primitive = &self.geometry.primitives[object.index()];
        match self.plain(primitive) {
            Plain::Sphere(sphere) => sphere.hit(ray),
            Plain::Plane(plane) => plane.hit(ray),
            Plain::Neither => self.hit_any(primitive, ray),
        }
    }

    /// Whether a primitive is in the way.
    #[inline(always)]
    fn blocks(&self, object: ObjectId, ray: &Ray) -> bool {
        let primitive = &self.geometry.primitives[object.index()];
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
        if let Some(sphere) = Sphere::find(&self.geometry.shapes, primitive.shape) {
            return Plain::Sphere(sphere);
        }
        Plane::find(&self.geometry.shapes, primitive.shape).map_or(Plain::Neither, Plain::Plane)
    }

    #[inline(never)]
    fn hit_any(&self, primitive: &Primitive, ray: &Ray) -> Option<Hit> {
        self.in_object(primitive, ray, |ray| self.geometry.shapes.hit(primitive.shape, ray))
    }

    #[inline(never)]
    fn blocked_by_any(&self, primitive: &Primitive, ray: &Ray) -> bool {
        self.in_object(primitive, ray, |ray| self.geometry.shapes.blocks(primitive.shape, ray))
    }

    /// Visits every crossing with a primitive.
    #[inline]
    fn each_crossing(&self, object: ObjectId, ray: &Ray, visit: &mut dyn FnMut(Hit)) {
        let primitive = &self.geometry.primitives[object.index()];
        self.in_object(primitive, ray, |ray| self.geometry.shapes.crossings(primitive.shape, ray, visit));
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
        self.geometry.transform_at(pose, ray.time, |map| map.ray_in_object(ray))
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

impl ClosestQuery for Nearest<'_> {
    #[inline(always)]
    fn object(&mut self, object: ObjectId, t_max: f32) -> f32 {
        if object == self.at.object {
            return t_max; // It was tried before all others.
        }
        let hit = self.scene.hit(object, &self.ahead);
        self.offer(object, hit, t_max)
    }

    fn leaf(&mut self, leaf: &Leaf, t_max: f32) -> f32 {
        let hit = leaf.in_object(&self.ahead, |ray| self.scene.geometry.shapes.hit(leaf.shape, ray));
        self.offer(self.scene.geometry.object_of(leaf), hit, t_max)
    }

    fn t_max(&self, ray: &Ray) -> f32 {
        if self.at.object == ObjectId::NONE { ray.t_max } else { self.at.hit.t }
    }
}

impl Nearest<'_> {
    /// Keeps a hit that comes before the one so far.
    #[inline(always)]
    fn offer(&mut self, object: ObjectId, hit: Option<Hit>, t_max: f32) -> f32 {
        let Some(hit) = hit else { return t_max };
        if self.at.object < object && hit.t == self.at.hit.t {
            return t_max;
        }
        (self.at.object, self.at.hit) = (object, hit);
        self.ahead.t_max = hit.t.next_up();
        hit.t
    }
}

/// Whatever is in the way of a ray.
struct Blockers<'a> {
    scene: &'a Scene,
    ray: &'a Ray,
}

impl Visitor for Blockers<'_> {
    #[inline(always)]
    fn object(&mut self, object: ObjectId) -> bool {
        self.scene.blocks(object, self.ray)
    }

    fn leaf(&mut self, leaf: &Leaf) -> bool {
        self.scene.leaf_blocks(leaf, self.ray)
    }
}

/// Whatever is in the way of a ray, and all crossings with what light may pass through.
struct Passages<'a, F> {
    scene: &'a Scene,
    ray: &'a Ray,
    /// Called with each crossing; returns whether nothing passes there.
    visit: F,
}

impl<F: FnMut(ObjectId, Hit) -> bool> Visitor for Passages<'_, F> {
    #[inline(always)]
    fn object(&mut self, object: ObjectId) -> bool {
        let Passages { scene, ray, visit } = self;
        if !scene.geometry.primitives[object.index()].transmits {
            return scene.blocks(object, ray);
        }
        let mut blocked = false;
        scene.each_crossing(object, ray, &mut |hit| blocked = blocked || visit(object, hit));
        blocked
    }

    fn leaf(&mut self, leaf: &Leaf) -> bool {
        let Passages { scene, ray, visit } = self;
        if !scene.leaf_transmits(leaf) {
            return scene.leaf_blocks(leaf, ray);
        }
        let (mut blocked, object) = (false, scene.geometry.object_of(leaf));
        let mut visit = |hit| blocked = blocked || visit(object, hit);
        leaf.in_object(ray, |ray| scene.geometry.shapes.crossings(leaf.shape, ray, &mut visit));
        blocked
    }
}

/// All crossings.
struct Crossings<'a, F> {
    scene: &'a Scene,
    ray: &'a Ray,
    visit: F,
}

impl<F: FnMut(ObjectId, Hit)> Visitor for Crossings<'_, F> {
    #[inline]
    fn object(&mut self, object: ObjectId) -> bool {
        let visit = &mut self.visit;
        self.scene.each_crossing(object, self.ray, &mut |hit| visit(object, hit));
        false
    }

    fn leaf(&mut self, leaf: &Leaf) -> bool {
        let (object, visit) = (self.scene.geometry.object_of(leaf), &mut self.visit);
        let shapes = &self.scene.geometry.shapes;
        leaf.in_object(self.ray, |ray| shapes.crossings(leaf.shape, ray, &mut |hit| visit(object, hit)));
        false
    }
}
