//! Instances of shapes with their transforms, and the trees over them.

use std::ops::Range;

use kajo_bvh::BuildSettings;
use kajo_math::{Aabb, Affine3, Affine3A, Transform, Vec2, Vec3, Vec4};

use super::accel::Aggregate;
use super::event::Interaction;
use super::rarely;
use crate::family::Pooled;
use crate::ids::{ObjectId, PoseId};
use crate::interaction::{SurfaceUv, Tangents};
use crate::item_buffer::{BufferedObject, ItemBuffer};
use crate::material::MaterialId;
use crate::motion::MovingTransform;
use crate::nested::{Leaf, Nested, NestedElement};
use crate::objects::{Object, Objects};
use crate::shape::{ShapeId, Shapes, Sphere};

/// A shape at its place in the world, with its material.
#[derive(Clone, Copy, Debug)]
pub struct Primitive {
    /// The geometry.
    pub shape: ShapeId,
    /// Where it stands.
    pub pose: PoseId,
    /// The material of parts that bring none of their own.
    pub material: MaterialId,
    /// Whether light may pass through any part.
    pub transmits: bool,
    /// Whether any part gives light.
    pub emits: bool,
}

/// Primitives beyond which [`Geometry::item_buffer`] would take longer than it saves.
const MOST_ITEMS: usize = 1 << 16;

/// All shapes of a scene at their places.
#[derive(Debug)]
pub struct Geometry {
    /// Shapes, each in its own space.
    pub shapes: Shapes,
    /// Maps from object to world space; the first is the identity.
    pub transforms: Vec<Transform>,
    /// Maps that may change while the shutter is open.
    pub motions: Vec<MovingTransform>,
    /// Shapes at their places, in the order of the file. Object `i + 1` of the id layers is primitive `i`; numbers past
    /// the end are those of objects in nested instances.
    pub primitives: Vec<Primitive>,
    /// The user's words for each primitive; see [`Geometry::object`].
    pub objects: Objects,
    /// Whether light may pass through any object.
    pub transmits: bool,
    /// Whether any mesh has colours at its corners.
    pub has_vertex_colors: bool,
    pub(crate) aggregate: Aggregate,
}

impl Default for Geometry {
    /// Nothing, and the identity among the transforms.
    fn default() -> Geometry {
        Geometry {
            shapes: Shapes::default(),
            transforms: vec![Transform::IDENTITY],
            motions: Vec::new(),
            primitives: Vec::new(),
            objects: Objects::default(),
            transmits: false,
            has_vertex_colors: false,
            aggregate: Aggregate::default(),
        }
    }
}

impl Geometry {
    /// Builds the trees over all objects, which rays need.
    ///
    /// * `nested`: instances that are kept nested, if there are any
    /// * `stands`: whether an object stands in these trees, and not in those of another frame
    pub(crate) fn build_trees(
        &mut self,
        nested: Option<Nested>,
        stands: impl Fn(ObjectId) -> bool,
        settings: &BuildSettings,
    ) {
        let bounds = self.bounds_of_those(stands);
        let is_moving: Vec<bool> = self.primitives.iter().map(|p| self.is_moving(p)).collect();
        let moving_bounds = |i: usize, part| self.moving_bounds(&self.primitives[i], part);
        self.aggregate = Aggregate::build(&bounds, &is_moving, moving_bounds, nested, settings);
    }

    /// The bounds of all objects, empty ones of those that stand elsewhere.
    fn bounds_of_those(&self, stands: impl Fn(ObjectId) -> bool) -> Vec<Aabb> {
        let bounds = |(object, p)| if stands(object) { self.world_bounds(p) } else { Aabb::EMPTY };
        ObjectId::all(self.primitives.len()).zip(&self.primitives).map(bounds).collect()
    }

    /// Trees over the objects of another frame than the world's, none of which moves in it or is nested.
    ///
    /// * `stands`: whether an object is one of them
    pub(super) fn frame_trees(
        &self,
        stands: impl Fn(ObjectId) -> bool,
        settings: &BuildSettings,
    ) -> Aggregate {
        let bounds = self.bounds_of_those(stands);
        let is_moving = vec![false; bounds.len()];
        Aggregate::build(&bounds, &is_moving, |_, _| [Aabb::EMPTY; 2], None, settings)
    }

    /// The map of a primitive from its own space to the world's.
    ///
    /// * `time`: moment within the shutter interval
    pub fn transform_of(&self, primitive: &Primitive, time: f32) -> Transform {
        self.transform_at(primitive.pose, time, |map| *map)
    }

    /// Whether a primitive moves while the shutter is open.
    pub(crate) fn is_moving(&self, primitive: &Primitive) -> bool {
        self.motion(primitive.pose).is_some_and(MovingTransform::moves)
    }

    /// The shape of an object.
    pub fn shape(&self, object: ObjectId) -> Option<ShapeId> {
        match self.primitives.get(object.index()) {
            Some(primitive) => Some(primitive.shape),
            None => self.leaf(object).map(|leaf| leaf.shape),
        }
    }

    /// The user's words for an object.
    pub fn object(&self, object: ObjectId) -> Option<Object<'_>> {
        match self.primitives.get(object.index()) {
            Some(_) => self.objects.get(object.index()),
            None => self.leaf(object).and_then(|leaf| self.objects.words(leaf.label, leaf.placed_by)),
        }
    }

    /// How many objects there are, those in nested instances included, each as often as it stands somewhere.
    pub fn object_count(&self) -> u64 {
        let nested = self.aggregate.nested().map_or(0, |nested| nested.count);
        self.primitives.len() as u64 + u64::from(nested)
    }

    /// Boxes around all nested instances, none of which [`Geometry::primitives`] holds.
    pub fn nested_bounds(&self) -> impl Iterator<Item = Aabb> {
        self.aggregate.nested().into_iter().flat_map(|nested| nested.placement_bounds(&self.shapes))
    }

    /// What stands in nested instances, which [`Geometry::primitives`] does not hold, in elements.
    ///
    /// * `cost`: of showing a shape; a box costs 12
    /// * `budget`: what the elements may cost together. The largest instances are taken apart first, and what is left is
    ///   boxes; of more than a twelfth of the budget some are left out
    pub fn nested_elements(&self, cost: impl Fn(ShapeId) -> usize, budget: usize) -> Vec<NestedElement> {
        let first = self.first_nested();
        let nested = self.aggregate.nested();
        nested.map_or_else(Vec::new, |nested| nested.elements(&self.shapes, first, cost, budget))
    }

    /// The objects in nested instances that items of the text put into the scene, in order.
    ///
    /// * `is_wanted`: whether it is about what the item of this number places; see [`Object::placed_by`]
    pub fn nested_objects(&self, is_wanted: impl Fn(u32) -> bool) -> Vec<Range<ObjectId>> {
        let first = self.first_nested();
        self.aggregate.nested().map_or_else(Vec::new, |nested| nested.objects(first, is_wanted))
    }

    /// The first object in a nested instance.
    pub(super) fn first_nested(&self) -> ObjectId {
        ObjectId::from_index(self.primitives.len() as u32)
    }

    /// An object in a nested instance.
    pub(super) fn leaf(&self, object: ObjectId) -> Option<Leaf> {
        self.aggregate.nested()?.find(object.since(self.first_nested())?)
    }

    /// The name of an object in a nested instance among all.
    pub(super) fn object_of(&self, leaf: &Leaf) -> ObjectId {
        self.first_nested().after(leaf.number)
    }

    /// The motion that a pose names, if it names one.
    #[inline]
    pub(super) fn motion(&self, pose: PoseId) -> Option<&MovingTransform> {
        pose.moving_in(&self.motions)
    }

    /// The motion of an object; what is in nested instances has none.
    #[inline]
    pub(super) fn motion_of(&self, object: ObjectId) -> Option<&MovingTransform> {
        self.motion(self.primitives.get(object.index())?.pose)
    }

    /// What lies in which direction from a point, of what neither moves nor is nested; `None` where the trees do better,
    /// as for very large scenes.
    ///
    /// * `cells`: how many directions to tell apart, about; the more, the faster it answers, and the longer it
    ///   takes to be made
    pub fn item_buffer(&self, apex: Vec3, cells: usize) -> Option<ItemBuffer> {
        if self.primitives.len() > MOST_ITEMS {
            return None;
        }
        let body = |(object, p): (ObjectId, &Primitive)| {
            let bounds = self.world_bounds(p);
            let untransformed = p.pose.is_identity();
            let sphere = Sphere::find(&self.shapes, p.shape).filter(|_| untransformed).copied();
            let bounded = bounds.is_finite() && !bounds.is_empty() && !self.is_moving(p);
            bounded.then_some(BufferedObject { object, bounds, sphere, opaque: !p.transmits })
        };
        let bodies: Vec<BufferedObject> =
            ObjectId::all(self.primitives.len()).zip(&self.primitives).filter_map(body).collect();
        ItemBuffer::new(apex, &bodies, cells)
    }

    /// Where patterns in world space are evaluated for an interaction: at the point itself, or where that was at
    /// time 0 if it belongs to something that moves.
    #[inline]
    pub(crate) fn pattern_point(&self, at: &Interaction) -> Vec3 {
        if self.motions.is_empty() {
            return at.point.p;
        }
        match self.motion_of(at.object) {
            None => at.point.p,
            Some(motion) => match self.part_motion(motion, at) {
                None => motion.painted(at.point.p, at.time),
                Some(inner) => motion.painted_part(inner, at.point.p, at.time),
            },
        }
    }

    /// How what was met moves within its object, which moves by `motion`.
    #[inline]
    fn part_motion(&self, motion: &MovingTransform, at: &Interaction) -> Option<&MovingTransform> {
        if !motion.holds_moving() {
            return None;
        }
        let shape = self.primitives.get(at.object.index())?.shape;
        self.shapes.part_motion(shape, at.hit.part)
    }

    /// Where a point of a part of a shape was when the shutter opened, in the shape's space.
    ///
    /// * `p`: where it is at a ray's time
    pub(crate) fn at_opening(&self, shape: ShapeId, part: u32, p: Vec3, time: f32) -> Vec3 {
        self.shapes.part_motion(shape, part).map_or(p, |motion| motion.carried(p, [time, 0.0]))
    }

    /// The normal at [`Geometry::pattern_point`].
    #[inline]
    pub(crate) fn pattern_normal(&self, at: &Interaction) -> Vec3 {
        let n = at.point.n;
        if self.motions.is_empty() {
            return n;
        }
        match self.motion_of(at.object) {
            None => n,
            Some(motion) => motion.painted_normal(self.part_motion(motion, at), n, at.time),
        }
    }

    /// From the space of [`Geometry::pattern_point`] to that in which the shape of an interaction is written.
    pub(crate) fn pattern_frame(&self, at: &Interaction) -> Affine3 {
        let map = match self.primitives.get(at.object.index()) {
            Some(&Primitive { pose, .. }) => match self.motion(pose) {
                Some(motion) => motion.object_from_painted(),
                None => self.transform_at(pose, at.time, |map| map.object_from_world),
            },
            None => self
                .leaf(at.object)
                .map_or(Affine3A::IDENTITY, |leaf| leaf.world_from_object().object_from_world),
        };
        Affine3::from(map)
    }

    /// The colour of the corners around an interaction with a mesh that has some.
    #[inline]
    pub(crate) fn tint(&self, at: &Interaction) -> Option<Vec4> {
        let of = |shape| self.shapes.color_at(shape, &at.hit);
        if self.has_vertex_colors { rarely(|| self.shape(at.object).and_then(of)) } else { None }
    }

    /// Where the point of an interaction is at another moment within the shutter interval.
    pub fn point_at(&self, at: &Interaction, time: f32) -> Vec3 {
        match self.motion_of(at.object) {
            None => at.point.p,
            Some(motion) => {
                let own = motion.at(at.time).object_from_world.transform_point3(at.point.p);
                let inner = self.part_motion(motion, at);
                motion.at(time).point(inner.map_or(own, |inner| inner.carried(own, [at.time, time])))
            }
        }
    }

    /// What the surface says of the place of an interaction.
    pub(crate) fn surface_uv(&self, at: &Interaction) -> SurfaceUv {
        let Some((shape, p)) = self.own_point(at) else { return SurfaceUv::default() };
        let first = self.shapes.uv_at(shape, &at.hit, p);
        let second = self.shapes.second_uv_at(shape, &at.hit, p);
        SurfaceUv { first, second: second.unwrap_or(first) }
    }

    /// Surface coordinates at an interaction.
    pub fn uv(&self, at: &Interaction) -> Vec2 {
        self.own_point(at).map_or(Vec2::ZERO, |(shape, p)| self.shapes.uv_at(shape, &at.hit, p))
    }

    /// The shape of an interaction, and the point in its space; of a part that moves within it when the shutter opens.
    #[inline]
    fn own_point(&self, at: &Interaction) -> Option<(ShapeId, Vec3)> {
        let own = |map: &Transform| map.object_from_world.transform_point3(at.point.p);
        match self.primitives.get(at.object.index()) {
            Some(&Primitive { shape, pose, .. }) => {
                let p = match pose.still_in(&self.transforms) {
                    Some(map) => own(map),
                    None => rarely(|| {
                        let p = self.transform_at(pose, at.time, own);
                        self.at_opening(shape, at.hit.part, p, at.time)
                    }),
                };
                Some((shape, p))
            }
            None => self.leaf(at.object).map(|leaf| (leaf.shape, own(&leaf.world_from_object()))),
        }
    }

    /// A box around an object, at any time while the shutter is open; empty for one that is not there.
    pub fn object_bounds(&self, object: ObjectId) -> Aabb {
        match self.primitives.get(object.index()) {
            Some(primitive) => self.world_bounds(primitive),
            None => self
                .leaf(object)
                .map_or(Aabb::EMPTY, |leaf| leaf.world_from_object().bounds(&self.shapes.bounds(leaf.shape))),
        }
    }

    pub(crate) fn world_bounds(&self, primitive: &Primitive) -> Aabb {
        let bounds = self.shapes.bounds(primitive.shape);
        if primitive.pose.is_identity() {
            return bounds;
        }
        match primitive.pose.still_in(&self.transforms) {
            Some(transform) => transform.bounds(&bounds),
            None => {
                let motion = self.motion(primitive.pose);
                motion.map_or(Aabb::EMPTY, |motion| motion.bounds_of_all_times(&bounds))
            }
        }
    }

    /// Boxes of a moving primitive at the ends of a part of the shutter's interval; empty for any other, and for
    /// unbounded ones.
    pub(crate) fn moving_bounds(&self, primitive: &Primitive, part: [f64; 2]) -> [Aabb; 2] {
        let bounds = self.shapes.bounds_during(primitive.shape, part);
        match self.motion(primitive.pose) {
            Some(motion) if motion.moves() && bounds.is_finite() => motion.bounds(&bounds, part),
            _ => [Aabb::EMPTY; 2],
        }
    }

    /// How the position at an interaction changes with surface coordinates, in world space.
    pub fn tangents(&self, at: &Interaction) -> Tangents {
        let tangents = self.tangents_by(at, |shape, p| Some(self.shapes.tangents_at(shape, &at.hit, p)));
        tangents.unwrap_or_default()
    }

    /// The same by the second set of surface coordinates; `None` where there is none.
    #[inline(never)]
    pub(super) fn second_tangents(&self, at: &Interaction) -> Option<Tangents> {
        self.tangents_by(at, |shape, p| self.shapes.second_tangents_at(shape, &at.hit, p))
    }

    /// Tangents at an interaction in world space, by those at a point of its shape.
    #[inline(always)]
    fn tangents_by(
        &self,
        at: &Interaction,
        tangents: impl Fn(ShapeId, Vec3) -> Option<Tangents>,
    ) -> Option<Tangents> {
        let of = |shape: ShapeId, map: &Transform| {
            let own = map.object_from_world.transform_point3(at.point.p);
            Some(tangents(shape, own)?.transformed(map))
        };
        match self.primitives.get(at.object.index()) {
            Some(&Primitive { shape, pose, .. }) => match pose.still_in(&self.transforms) {
                Some(map) => of(shape, map),
                None => rarely(|| self.moving_tangents(at, shape, pose, &tangents)),
            },
            None => {
                let leaf = self.leaf(at.object)?;
                of(leaf.shape, &leaf.world_from_object())
            }
        }
    }

    /// The same of something that has a motion.
    fn moving_tangents(
        &self,
        at: &Interaction,
        shape: ShapeId,
        pose: PoseId,
        tangents: impl Fn(ShapeId, Vec3) -> Option<Tangents>,
    ) -> Option<Tangents> {
        self.transform_at(pose, at.time, |map| {
            let own = map.object_from_world.transform_point3(at.point.p);
            let opening = self.at_opening(shape, at.hit.part, own, at.time);
            let tangents = tangents(shape, opening)?;
            let inner = self.shapes.part_motion(shape, at.hit.part);
            let carried =
                inner.map_or(tangents, |inner| tangents.transformed(&inner.between([0.0, at.time])));
            Some(carried.transformed(map))
        })
    }

    /// A box around everything that has bounds, at any time while the shutter is open.
    pub fn bounds(&self) -> Aabb {
        self.primitives
            .iter()
            .map(|p| self.world_bounds(p))
            .chain(self.nested_bounds())
            .filter(Aabb::is_finite)
            .fold(Aabb::EMPTY, Aabb::union)
    }

    /// Whether anything has no bounds.
    pub(crate) fn has_unbounded(&self) -> bool {
        self.aggregate.has_unbounded()
    }

    /// Bytes of geometry and its trees.
    pub fn bytes(&self) -> usize {
        let shapes: usize = self.shapes.ids().map(|id| self.shapes.heap_bytes(id)).sum();
        let placed = size_of_val(&*self.primitives) + size_of_val(&*self.transforms);
        shapes + self.aggregate.bytes() + placed + self.objects.bytes()
    }

    /// `f` of the map of a primitive at a time.
    #[inline]
    pub(super) fn transform_at<T>(&self, pose: PoseId, time: f32, f: impl FnOnce(&Transform) -> T) -> T {
        let moved;
        let map = match pose.still_in(&self.transforms) {
            Some(map) => map,
            None => {
                moved = rarely(|| self.motion(pose).map_or(Transform::IDENTITY, |motion| motion.at(time)));
                &moved
            }
        };
        f(map)
    }
}
